//! Ranges out of depths: a camera that goes by the apparent size of what it sees measures along its axis, not along the
//! line of sight.

use asami_dataset::parameters::Fault;
use asami_dataset::{Log, Sighting, Size};
use asami_math::elementary::sin_cos;
use serde::{Deserialize, Serialize};

/// `[depths]`: what a recording calls ranges are depths along the camera's axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Depths {
    /// Bearing of the camera's axis, counter-clockwise from straight ahead: one, or one for each robot of the
    /// recording, in their order.
    pub axis_rad: Vec<f64>,
}

/// A camera does not see what lies further from its axis, rad.
const WIDEST_RAD: f64 = 1.4;

impl Depths {
    /// Adds a fault for everything that is wrong; `path` is the table's place in the file, `robots` how many the
    /// recording has.
    pub fn check(&self, path: &str, robots: usize, faults: &mut Vec<Fault>) {
        let mut fault = |message: String| faults.push(Fault { path: format!("{path}.axis_rad"), message });
        let found = self.axis_rad.len();
        if found != 1 && found != robots {
            fault(format!("axis_rad must have one angle, or one for each of {robots} robots, not {found}"));
        }
        for angle_rad in self.axis_rad.iter().filter(|angle_rad| !(-1.0..=1.0).contains(*angle_rad)) {
            fault(format!("axis_rad must lie in -1..=1 rad, not {angle_rad}"));
        }
    }

    /// The axis of the robot that stands at `place` in the recording's list.
    #[must_use]
    pub fn axis_of(&self, place: usize) -> f64 {
        self.axis_rad.get(place).or(self.axis_rad.first()).copied().unwrap_or_default()
    }
}

/// The log with each depth divided by the cosine of its bearing from the axis. Sightings of heights stay as they are,
/// and so do ranges of landmarks so far off the axis that no camera sees them.
#[must_use]
pub fn ranges(log: &Log, axis_rad: f64) -> Log {
    let range = |seen: &Sighting| match seen.size {
        Size::RangeM(depth_m) if (seen.bearing_rad - axis_rad).abs() < WIDEST_RAD => {
            let (_, cos) = sin_cos(seen.bearing_rad - axis_rad);
            Sighting { size: Size::RangeM(depth_m / cos), ..*seen }
        }
        _ => *seen,
    };
    let sightings: Vec<Sighting> = log.sightings.iter().map(range).collect();
    let mut known = (*log.known).clone();
    if let Some(sensor) = &mut known.range_bearing {
        let farthest_m = sightings.iter().map(|seen| seen.size.value()).fold(0.0, f64::max);
        sensor.max_range_m = sensor.max_range_m.max(farthest_m);
    }
    Log { known: known.into(), sightings: sightings.into(), ..log.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_wall_square_to_the_axis_have_one_depth() {
        // A wall 3 m ahead along an axis of 0.1 rad: every point of it has the depth 3.
        let (axis_rad, depth_m) = (0.1, 3.0);
        let seen = |step: i32| {
            let along_m: f64 = 0.3 * f64::from(step);
            let bearing_rad = axis_rad + (along_m / depth_m).atan();
            (Sighting { t_s: 0.0, landmark: 0, size: Size::RangeM(depth_m), bearing_rad }, depth_m.hypot(along_m))
        };
        let (sightings, true_m): (Vec<_>, Vec<_>) = (-5..=5).map(seen).unzip();
        let log = Log { sightings: sightings.into(), ..Log::default() };
        for (seen, true_m) in ranges(&log, axis_rad).sightings.iter().zip(true_m) {
            assert!((seen.size.value() - true_m).abs() < 1e-12);
        }
    }

    #[test]
    fn heights_and_what_no_camera_sees_stay_as_they_are() {
        let heights = vec![Sighting { t_s: 0.0, landmark: 0, size: Size::HeightPx(9.0), bearing_rad: 0.5 }];
        let behind = vec![Sighting { t_s: 0.0, landmark: 0, size: Size::RangeM(2.0), bearing_rad: 3.0 }];
        for sightings in [heights, behind] {
            let log = Log { sightings: sightings.into(), ..Log::default() };
            assert_eq!(ranges(&log, 0.0), log);
        }
    }

    #[test]
    fn one_axis_or_one_a_robot() {
        let faults = |axis_rad: Vec<f64>| {
            let mut faults = Vec::new();
            Depths { axis_rad }.check("depths", 5, &mut faults);
            faults.into_iter().map(|fault| fault.message).collect::<Vec<_>>()
        };
        assert!(faults(vec![0.1]).is_empty() && faults(vec![0.0; 5]).is_empty());
        assert_eq!(faults(vec![0.0; 2]), ["axis_rad must have one angle, or one for each of 5 robots, not 2"]);
        assert_eq!(faults(vec![57.3]), ["axis_rad must lie in -1..=1 rad, not 57.3"]);
        assert_eq!(Depths { axis_rad: vec![0.1, 0.2] }.axis_of(1), 0.2);
        assert_eq!(Depths { axis_rad: vec![0.1] }.axis_of(4), 0.1);
    }
}
