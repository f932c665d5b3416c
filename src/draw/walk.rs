//! A walking robot seen from the side: a strip of poses, and which foot stands when.

use std::fmt::Write as _;

use super::axis::{cover, drawable, number};
use super::figure::Figure;
use super::svg::{self, px};
use super::{FAINT, GRID, INK, PALETTE};

/// A part of a body in side view.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Corners in metres: forward, up. A closed outline if `solid`, else a chain of links.
    pub corners_m: Vec<[f64; 2]>,
    /// Whether it is an outline.
    pub solid: bool,
    /// Drawn fainter: on the far side of the body.
    pub far: bool,
}

/// The robot at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Seconds since the log began.
    pub t_s: f64,
    /// In order of drawing.
    pub parts: Vec<Part>,
    /// Points where a foot touches the ground, in metres: forward, up.
    pub contacts_m: Vec<[f64; 2]>,
}

/// Poses beside each other, all to one scale, each above its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Short name, unique in a report.
    pub name: String,
    /// What is seen, in a few words.
    pub title: String,
    /// What it shows, what is good, what to do about it if it is not.
    pub caption: String,
    /// In order of time.
    pub poses: Vec<Pose>,
}

const TOP_PX: f64 = 28.0;

impl Strip {
    /// Width in CSS pixels.
    pub const WIDTH_PX: u32 = 1120;

    /// The strip as an element of an HTML page. Each pose is centred on itself; the ground is at height 0.
    #[must_use]
    pub fn inline_svg(&self) -> String {
        let reach = |pose: &Pose| cover(corners(pose).map(|corner| corner[0])).unwrap_or((0.0, 0.0));
        let widest = self.poses.iter().map(|pose| reach(pose).1 - reach(pose).0).fold(0.05, keep_greater);
        let highest = self
            .poses
            .iter()
            .flat_map(corners)
            .map(|corner| corner[1])
            .filter(|up| drawable(*up))
            .fold(0.05, keep_greater);
        let width_px = f64::from(Self::WIDTH_PX);
        let cell = width_px / self.poses.len().max(1) as f64;
        let px_per_m = (cell * 0.86 / widest).min(300.0 / highest);
        let ground = TOP_PX + highest * px_per_m + 6.0;
        let height = (ground + 26.0).ceil();
        let mut out = svg::open(Self::WIDTH_PX, height as u32, &format!("{}: {}", self.name, self.title));
        let title = svg::escape(&self.title);
        let _ = write!(out, "<text class=\"ink\" x=\"0\" y=\"17\" font-weight=\"600\" fill=\"{INK}\">{title}</text>");
        let _ = write!(
            out,
            "<path class=\"grid\" d=\"M0 {0}H{width_px}\" stroke=\"{GRID}\" stroke-width=\"2\"/>",
            px(ground)
        );
        for (index, pose) in self.poses.iter().enumerate() {
            let centre = (index as f64 + 0.5) * cell;
            let middle = (reach(pose).0 + reach(pose).1) / 2.0;
            let at = |[forward, up]: [f64; 2]| (centre + (forward - middle) * px_per_m, ground - up * px_per_m);
            pose.parts.iter().for_each(|part| part_into(part, at, &mut out));
            for (x, y) in pose.contacts_m.iter().filter(|c| c.iter().all(|v| drawable(*v))).map(|contact| at(*contact))
            {
                let _ = write!(
                    out,
                    "<circle class=\"f1\" cx=\"{}\" cy=\"{}\" r=\"3.5\" fill=\"{}\"/>",
                    px(x),
                    px(y),
                    PALETTE[1]
                );
            }
            let (x, y) = (px(centre), px(ground + 18.0));
            let _ = write!(
                out,
                "<text class=\"faint\" x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" fill=\"{FAINT}\">{} s</text>",
                number(pose.t_s, 0.01)
            );
        }
        out.push_str("</svg>");
        out
    }

    /// The strip as an SVG file of its own.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::standalone(&self.inline_svg())
    }
}

fn keep_greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

fn corners(pose: &Pose) -> impl Iterator<Item = [f64; 2]> {
    pose.parts.iter().flat_map(|part| part.corners_m.iter().copied())
}

fn part_into(part: &Part, at: impl Fn([f64; 2]) -> (f64, f64), out: &mut String) {
    let drawn = part.corners_m.iter().filter(|corner| corner.iter().all(|value| drawable(*value)));
    let places: Vec<String> = drawn.map(|corner| at(*corner)).map(|(x, y)| format!("{} {}", px(x), px(y))).collect();
    if places.is_empty() {
        return;
    }
    let path = places.join("L");
    let (class, colour) = if part.far { ("far", "#b4bac3") } else { ("ink-stroke", INK) };
    let _ = if part.solid {
        write!(
            out,
            "<path class=\"body\" d=\"M{path}Z\" fill=\"#f4f5f7\" stroke=\"{colour}\" stroke-width=\"1.5\" stroke-linejoin=\"round\"/>"
        )
    } else {
        write!(
            out,
            "<path class=\"{class}\" d=\"M{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"3\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>"
        )
    };
}

/// When each foot (left fore, right fore, left hind, right hind) touches the ground: one row of bars a
/// foot, out of samples in order of time. Each sample holds until the next.
#[must_use]
pub fn contacts(name: &str, title: &str, samples: &[(f64, [bool; 4])]) -> Figure {
    const FEET: [&str; 4] = ["left fore", "right fore", "left hind", "right hind"];
    let rows = (0..4).rev().map(|foot| (FEET[foot], standing(samples, foot)));
    let mut figure = Figure::new(name, title).x("time", "s").size(1120, 210).rows(rows);
    // Feet 0 and 3, 1 and 2 are the diagonals of a trot: one colour each.
    for (row, series) in figure.series.iter_mut().enumerate() {
        series.colour = usize::from(row == 1 || row == 2);
    }
    figure
}

fn standing(samples: &[(f64, [bool; 4])], foot: usize) -> Vec<[f64; 2]> {
    let mut bars: Vec<[f64; 2]> = Vec::new();
    for pair in samples.windows(2) {
        let [(from_s, down), (to_s, _)] = [pair[0], pair[1]];
        if down[foot] {
            match bars.last_mut() {
                Some(bar) if bar[1] == from_s => bar[1] = to_s,
                _ => bars.push([from_s, to_s]),
            }
        }
    }
    bars
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foot_stands_from_touching_to_lifting() {
        let down = |foot: usize| std::array::from_fn(|i| i == foot);
        let samples = [(0.0, down(0)), (0.1, down(0)), (0.2, down(1)), (0.3, down(0)), (0.4, down(2))];
        assert_eq!(standing(&samples, 0), [[0.0, 0.2], [0.3, 0.4]]);
        assert_eq!(standing(&samples, 1), [[0.2, 0.3]]);
        assert!(standing(&samples, 3).is_empty() && standing(&[], 0).is_empty());
        // A trot stands on every diagonal half of the time: what is drawn adds up to what was sampled.
        let stood: f64 = (0..4).flat_map(|foot| standing(&samples, foot)).map(|[from, to]| to - from).sum();
        assert!((stood - 0.4).abs() < 1e-12);
    }

    #[test]
    fn odd_poses_draw_something_finite() {
        let part = |corners_m| Part { corners_m, solid: false, far: false };
        let poses = vec![
            Pose { t_s: 0.0, parts: vec![], contacts_m: vec![] },
            Pose { t_s: f64::NAN, parts: vec![part(vec![[f64::NAN, 0.0]])], contacts_m: vec![[f64::INFINITY, 0.0]] },
            Pose { t_s: 1.0, parts: vec![part(vec![[0.0, 0.1], [0.2, 0.0]])], contacts_m: vec![[0.2, 0.0]] },
        ];
        for poses in [poses, vec![]] {
            let svg = Strip { name: "s".into(), title: "t".into(), caption: String::new(), poses }.svg();
            assert!(!svg.contains("inf") && !svg.contains("d=\"MNaN"), "{svg}");
        }
    }
}
