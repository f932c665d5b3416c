//! Sightings of a landmark one after another: by how much its bearing turned, the robot did, but for what it went.

use std::collections::BTreeMap;
use std::ops::Range;

use asami_dataset::{Log, Sighting, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;

/// Sightings that are farther apart say little of the robot's turning.
const APART_S: Range<f64> = 0.02..0.6;

/// Two sightings of a landmark, none of which is between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The one before, and the one after.
    pub seen: [Sighting; 2],
}

impl Pair {
    /// Those of a log, by the second's time.
    #[must_use]
    pub fn all(log: &Log) -> Vec<Self> {
        let mut last: BTreeMap<u16, Sighting> = BTreeMap::new();
        let pair = |seen: &Sighting| {
            let before = last.insert(seen.landmark, *seen)?;
            APART_S.contains(&(seen.t_s - before.t_s)).then_some(Self { seen: [before, *seen] })
        };
        log.sightings.iter().filter_map(pair).collect()
    }

    /// When.
    #[must_use]
    pub fn at_s(&self) -> [f64; 2] {
        self.seen.map(|it| it.t_s)
    }

    /// By how much the bearing turned, counter-clockwise.
    #[must_use]
    pub fn turned_rad(&self) -> f64 {
        wrap_rad(self.seen[1].bearing_rad - self.seen[0].bearing_rad)
    }

    /// By how much it does where the robot goes straight on, with these forward speeds at either; heights in pixels do not say.
    #[must_use]
    pub fn aside_rad(&self, v_m_per_s: [f64; 2]) -> f64 {
        let [from_s, to_s] = self.at_s();
        let aside = |(seen, v): (&Sighting, f64)| match seen.size {
            Size::RangeM(range_m) => v * sin_cos(seen.bearing_rad).0 / range_m.max(0.1),
            Size::HeightPx(_) => 0.0,
        };
        0.5 * (to_s - from_s) * self.seen.iter().zip(v_m_per_s).map(aside).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use asami_math::elementary::{atan2, hypot};

    use super::*;

    fn seen(t_s: f64, landmark: u16, [right_m, ahead_m]: [f64; 2]) -> Sighting {
        let size = Size::RangeM(hypot(right_m, ahead_m));
        Sighting { t_s, landmark, size, bearing_rad: atan2(-right_m, ahead_m) }
    }

    /// Each landmark's by itself, and those only that are near in time.
    #[test]
    fn sightings_of_a_landmark_are_paired_with_the_next() {
        let all = [(0.0, 6), (0.2, 7), (0.3, 6), (0.31, 6), (0.5, 7), (1.2, 6), (1.5, 6)];
        let sightings: Vec<Sighting> = all.iter().map(|(t_s, landmark)| seen(*t_s, *landmark, [0.0, 2.0])).collect();
        let pairs = Pair::all(&Log { sightings: sightings.into(), ..Log::default() });
        let times: Vec<[f64; 2]> = pairs.iter().map(Pair::at_s).collect();
        assert_eq!(times, [[0.0, 0.3], [0.2, 0.5], [1.2, 1.5]]);
    }

    /// A robot that goes straight past a landmark sees it turn by as much.
    #[test]
    fn what_goes_straight_on_sees_bearings_turn() {
        let (v, dt_s) = (0.2, 0.25);
        let pair = Pair { seen: [seen(0.0, 6, [-1.0, 2.0]), seen(dt_s, 6, [-1.0, 2.0 - v * dt_s])] };
        assert!((pair.turned_rad() - pair.aside_rad([v; 2])).abs() < 1e-5 && pair.turned_rad() > 0.01);
        assert_eq!(pair.aside_rad([0.0; 2]), 0.0);
    }
}
