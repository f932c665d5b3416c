//! What a report shows of a walk: where the feet touch the ground, and the body's outline.

use nalgebra::{Isometry3, Point3};
use urdf_rs::Geometry;

use super::blueprint::{Blueprint, LEG_NAMES};
use super::engine::Engine;

/// Foot contacts and outlines recorded during a run. Truth: no part of a data set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Watch {
    /// One row a control tick.
    pub contacts: Vec<Contacts>,
    /// One a frame.
    pub outlines: Vec<Outline>,
}

/// Which feet pressed on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contacts {
    /// Seconds since the log began.
    pub t_s: f64,
    /// Fore left, fore right, hind left, hind right.
    pub down: [bool; 4],
}

/// The body as lines, to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Seconds since the log began.
    pub t_s: f64,
    /// Left legs, trunk, neck, head and right legs.
    pub lines: Vec<Line>,
}

/// One line of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// `fl`, `hl`, `torso`, `neck`, `head`, `fr` or `hr`.
    pub part: &'static str,
    /// Corners in the world; a box is given by its section through the middle, first corner repeated.
    pub points_m: Vec<[f64; 3]>,
}

/// The body's outline as it stands.
#[must_use]
pub fn outline(t_s: f64, body: &dyn Engine, blueprint: &Blueprint) -> Outline {
    let [fl, fr, hl, hr] = [0, 1, 2, 3].map(|i| leg(body, blueprint, i));
    let lines = [fl, hl, section(body, blueprint, "torso"), neck(body), section(body, blueprint, "head"), fr, hr];
    Outline { t_s, lines: lines.into_iter().flatten().collect() }
}

fn place(world_from_link: &Isometry3<f64>, [x, y, z]: [f64; 3]) -> [f64; 3] {
    (world_from_link * Point3::new(x, y, z)).coords.into()
}

/// Hip, knee and foot.
fn leg(body: &dyn Engine, blueprint: &Blueprint, i: usize) -> Option<Line> {
    let name = LEG_NAMES[i];
    let world_from_shoulder = body.world_from_link(&format!("{name}_shoulder"))?;
    let world_from_lower = body.world_from_link(&format!("{name}_lower"))?;
    let below_knee = [0.0, 0.0, -blueprint.legs[i].shank_m];
    let points_m = vec![
        place(&world_from_shoulder, [0.0; 3]),
        place(&world_from_lower, [0.0; 3]),
        place(&world_from_lower, below_knee),
    ];
    Some(Line { part: name, points_m })
}

fn neck(body: &dyn Engine) -> Option<Line> {
    let points_m = ["neck", "head"].map(|name| body.world_from_link(name).map(|pose| place(&pose, [0.0; 3])));
    let [Some(low), Some(high)] = points_m else { return None };
    Some(Line { part: "neck", points_m: vec![low, high] })
}

/// The section of a link's box along its middle plane.
fn section(body: &dyn Engine, blueprint: &Blueprint, part: &'static str) -> Option<Line> {
    let world_from_link = body.world_from_link(part)?;
    let link = blueprint.robot.links.iter().find(|link| link.name == part)?;
    link.collision.iter().find_map(|collision| {
        let Geometry::Box { size } = &collision.geometry else { return None };
        let ([x, y, z], [length, _, height]) = (*collision.origin.xyz, **size);
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]];
        let points_m = corners.map(|[a, b]| place(&world_from_link, [x + a * length, y, z + b * height]));
        Some(Line { part, points_m: points_m.to_vec() })
    })
}
