//! Which numbers of a response among landmarks are which channel's, and the circumstances in which a gap may show.

use crate::columns::Group;
use crate::judge::{Channel, Regime};
use crate::shape::{CHANGING, Numbers, SPEEDS, Shape, speed_class};
use crate::view::Step;

/// The channels of such a response.
#[must_use]
pub fn channels(shape: &Shape) -> Vec<Channel> {
    let columns = &shape.columns;
    let noise = shape.range(Numbers::MotionNoise).start;
    let motion = |axis: usize, groups: &[Group]| -> Vec<usize> {
        let at = axis * columns.len();
        groups.iter().flat_map(|group| columns.range(*group)).map(|i| at + i).collect()
    };
    let own = [Group::Curve, Group::Heading, Group::Held, Group::Wear];
    let axis = |name, axis| Channel {
        name,
        means: motion(axis, &own),
        noise: (0..SPEEDS).map(|class| noise + 3 * class + axis).collect(),
    };
    let all = |group: Numbers| shape.range(group).collect::<Vec<_>>();
    let lingering =
        (0..3).flat_map(|axis| motion(axis, &[Group::Lingering, Group::Turning, Group::Starting])).collect();
    vec![
        axis("forward", 1),
        axis("sideways", 0),
        axis("turn", 2),
        Channel { name: "timing", means: lingering, noise: (0..3).map(|axis| noise + 3 * CHANGING + axis).collect() },
        Channel {
            name: if shape.ranges { "range_m" } else { "height_px" },
            means: all(Numbers::Size),
            noise: all(Numbers::SizeNoise),
        },
        Channel {
            name: "bearing_rad",
            means: [all(Numbers::Bearing), all(Numbers::Moved)].concat(),
            noise: all(Numbers::BearingNoise),
        },
        Channel {
            name: "detection",
            means: Vec::new(),
            noise: [all(Numbers::False), all(Numbers::Detection)].concat(),
        },
    ]
}

/// Circumstances of steps that follow one another.
#[must_use]
pub fn regimes(steps: &[Step]) -> Vec<Regime> {
    let speed = |class: usize| steps.iter().map(|step| speed_class(step.attempt) == class).collect::<Vec<_>>();
    let sign = |axis: usize, sign: f64| steps.iter().map(|step| step.attempt[axis] * sign > 1e-6).collect::<Vec<_>>();
    let mut since_s = 1e9;
    let mut last = [f64::NAN; 3];
    let changed: Vec<f64> = steps
        .iter()
        .map(|step| {
            let same = (0..3).all(|axis| (step.attempt[axis] - last[axis]).abs() < 1e-9);
            since_s = if same { since_s + step.dt_s } else { 0.0 };
            last = step.attempt;
            since_s
        })
        .collect();
    let half = steps.len() / 2;
    vec![
        ("standing", speed(0)),
        ("slow commands", speed(1)),
        ("fast commands", speed(2)),
        ("forward commands", sign(1, 1.0)),
        ("backward commands", sign(1, -1.0)),
        ("turning left", sign(2, 1.0)),
        ("turning right", sign(2, -1.0)),
        ("the first 0.5 s after a command", changed.iter().map(|since_s| *since_s < 0.5).collect()),
        ("the first half of the log", (0..steps.len()).map(|i| i < half).collect()),
        ("the second half of the log", (0..steps.len()).map(|i| i >= half).collect()),
    ]
}
