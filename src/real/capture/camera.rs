//! What a camera makes of where landmarks were: by a focal length that is another one, by a lens that is no pinhole, by both.
//!
//! Capture errs of where a robot looks, for seconds on end, and by as much as a lens bends what is at an image's edge: bearings count
//! beside others of the same few seconds.

use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, tan};
use asami_math::statistics::median;

use super::robust::{Row, fitted};
use super::sightings::Seen;
use super::{Capture, Together};

/// Farther off its axis no camera sees.
const WIDEST_RAD: f64 = 1.4;
/// For so long capture errs alike of where a robot looks.
const STRETCH_S: f64 = 3.0;
/// Farther off than others of its stretch a bearing is of something else.
const MISTAKEN_RAD: f64 = 0.15;
/// Steps of Gauss and Newton.
const STEPS: usize = 4;

const FOCAL: &str = "focal_error";
const LENS: &str = "lens_distortion";
const SCALE: &str = "range_scale";

/// How far from the image's middle landmarks seem. A camera of a shorter focal length takes things for smaller, and so for farther away.
pub(super) fn image(all: &[Seen], range_ratio: f64, capture: &mut Capture) {
    let seen = all.iter().filter(|it| it.bearing_rad.abs().max(it.read_rad.abs()) < WIDEST_RAD);
    let seen: Vec<&Seen> = seen.collect();
    let (Some(focal), Some(lens), Some(both)) = (
        Camera::told(&seen, |[focal, _, late]| [focal, late], |[by, _]| [by, 0.0]),
        Camera::told(&seen, |[_, radial, late]| [radial, late], |[by, _]| [0.0, by]),
        Camera::told(&seen, |slopes| slopes, |[focal, radial, _]| [focal, radial]),
    ) else {
        return;
    };
    let values = |values: &[(&str, f64)]| values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let beside = |of, all: &[(&str, f64)]| Together { of, without: None, values: values(all) };
    let [focal_ratio, lens_radial, scale_ratio] = ["focal_error.ratio", "lens_distortion.radial", "range_scale.ratio"];
    capture.values.append(&mut values(&[(focal_ratio, focal.ratio), (lens_radial, lens.radial)]));
    capture.together.extend([
        beside(&[FOCAL, LENS], &[(focal_ratio, both.ratio), (lens_radial, both.radial)]),
        beside(&[FOCAL, SCALE], &[(scale_ratio, range_ratio * focal.ratio)]),
        beside(&[FOCAL, LENS, SCALE], &[(scale_ratio, range_ratio * both.ratio)]),
    ]);
}

/// What becomes of the tangent `r` of a landmark's bearing: `ratio * (r + radial * r^3)`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Camera {
    ratio: f64,
    radial: f64,
}

impl Camera {
    /// The camera that bearings tell, by those of their slopes that are `asked` for; `by` is how far these have the focal length and the lens be
    /// off a pinhole's.
    fn told<const N: usize>(
        all: &[&Seen],
        asked: impl Fn([f64; 3]) -> [f64; N],
        by: impl Fn([f64; N]) -> [f64; 2],
    ) -> Option<Self> {
        let mut camera = Self { ratio: 1.0, radial: 0.0 };
        for _ in 0..STEPS {
            let row = |seen: &&Seen| {
                let (slopes, off_rad) = camera.off(seen);
                (seen.t_s, (asked(slopes), off_rad))
            };
            let (found, _) = fitted(&beside_their_stretch(&all.iter().map(row).collect::<Vec<_>>()))?;
            let [ratio, radial] = by(found);
            camera = Self { ratio: camera.ratio + ratio, radial: camera.radial + radial };
        }
        Some(camera)
    }

    /// What a bearing is off, in radians, and its slopes by the focal length, by the lens, and by how late the camera is.
    fn off(self, seen: &Seen) -> Row<3> {
        let r = tan(seen.bearing_rad);
        let cube = r * r * r;
        let image = self.ratio * (r + self.radial * cube);
        let by_image = 1.0 / (1.0 + image * image);
        let slopes = [by_image * (r + self.radial * cube), by_image * self.ratio * cube, seen.turning_rad_per_s];
        (slopes, wrap_rad(seen.read_rad - atan2(image, 1.0)))
    }
}

/// Rows less their stretch's mean, but for those of something else; in the order of time.
fn beside_their_stretch<const N: usize>(rows: &[(f64, Row<N>)]) -> Vec<Row<N>> {
    let stretch = |t_s: f64| (t_s / STRETCH_S).floor();
    let of_stretch = |rows: &[(f64, Row<N>)]| {
        let middle = median(&rows.iter().map(|it| it.1.1).collect::<Vec<_>>()).unwrap_or(0.0);
        let near = rows.iter().map(|it| it.1).filter(|it| (it.1 - middle).abs() < MISTAKEN_RAD);
        let near: Vec<Row<N>> = near.collect();
        let mean = |of: &dyn Fn(&Row<N>) -> f64| near.iter().map(of).sum::<f64>() / near.len() as f64;
        let (slopes, off_rad): ([f64; N], f64) = (std::array::from_fn(|k| mean(&|it| it.0[k])), mean(&|it| it.1));
        let beside = |it: &Row<N>| (std::array::from_fn(|k| it.0[k] - slopes[k]), it.1 - off_rad);
        near.iter().map(beside).collect::<Vec<_>>()
    };
    rows.chunk_by(|a, b| stretch(a.0) == stretch(b.0)).flat_map(of_stretch).collect()
}

#[cfg(test)]
mod tests {
    use asami_math::elementary::sin;

    use super::*;

    const FOCAL_RATIO: f64 = 0.97;
    const OFFSET_RAD: f64 = 0.01;

    /// Landmarks all over the image of a turning robot's camera, of which every tenth is taken for another one, with capture of its
    /// heading that is wrong for seconds, as much as this.
    fn seen(radial: f64, wrong_rad: f64) -> Vec<Seen> {
        let of = |i: u16| {
            let t_s = 0.1 * f64::from(i);
            // What is to the left is seen while capture is off to the one side, what is to the right while it is to the other.
            let side = sin(0.2 * t_s);
            let bearing_rad = 0.05 * f64::from(i % 13) - 0.3 + 0.3 * side;
            let turning_rad_per_s = 0.2 * f64::from(i % 7) - 0.6;
            let r = tan(bearing_rad);
            let read_rad = atan2(FOCAL_RATIO * (r + radial * r * r * r), 1.0);
            let mistaken_rad = if i.is_multiple_of(10) { 0.5 } else { 0.0 };
            let distance_m = 1.0 + 0.1 * f64::from(i % 11);
            Seen {
                t_s,
                distance_m,
                bearing_rad,
                read_m: distance_m / FOCAL_RATIO,
                read_rad: read_rad + OFFSET_RAD + 0.03 * turning_rad_per_s + mistaken_rad + wrong_rad * side,
                turning_rad_per_s,
                parting_m_per_s: 0.0,
                swinging_rad_per_s: -turning_rad_per_s,
            }
        };
        (0..2000).map(of).collect()
    }

    fn shown(seen: &[Seen], named: &[&str]) -> Capture {
        let mut capture = Capture::default();
        capture.values.insert("range_scale.ratio".to_owned(), 1.0 / FOCAL_RATIO);
        image(seen, 1.0 / FOCAL_RATIO, &mut capture);
        capture.suit(named);
        capture
    }

    /// A camera that takes landmarks for smaller has no wrong scale of ranges besides.
    #[test]
    fn a_focal_length_is_told_by_where_landmarks_are_in_the_image() {
        let near = |named: &[&str], name: &str, expected: f64| {
            let value = shown(&seen(0.0, 0.0), named).values[name];
            assert!((value - expected).abs() < 0.005, "{named:?} {name}: {value}, not {expected}");
        };
        near(&[FOCAL], "focal_error.ratio", FOCAL_RATIO);
        near(&[SCALE], "range_scale.ratio", 1.0 / FOCAL_RATIO);
        near(&[SCALE, FOCAL], "range_scale.ratio", 1.0);
    }

    /// What bends an image looks like a focal length where that alone is thought of.
    #[test]
    fn a_lens_is_told_from_a_focal_length_where_both_are_named() {
        let both = shown(&seen(-0.2, 0.0), &[FOCAL, LENS]).values;
        assert!((both["focal_error.ratio"] - FOCAL_RATIO).abs() < 0.005, "{both:?}");
        assert!((both["lens_distortion.radial"] + 0.2).abs() < 0.02, "{both:?}");
        let alone = shown(&seen(-0.2, 0.0), &[FOCAL]).values;
        assert!(alone["focal_error.ratio"] < FOCAL_RATIO - 0.02, "{alone:?}");
        let pinhole = shown(&seen(0.0, 0.0), &[FOCAL, LENS]).values;
        assert!(pinhole["lens_distortion.radial"].abs() < 0.02, "{pinhole:?}");
    }

    /// Capture that has a robot look elsewhere for seconds, the more so the farther to the side it sees, bends nothing.
    #[test]
    fn where_capture_errs_of_where_a_robot_looks_no_lens_does() {
        let found = shown(&seen(-0.2, 0.03), &[FOCAL, LENS]).values;
        assert!((found["focal_error.ratio"] - FOCAL_RATIO).abs() < 0.01, "{found:?}");
        assert!((found["lens_distortion.radial"] + 0.2).abs() < 0.04, "{found:?}");
    }
}
