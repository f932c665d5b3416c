//! Sightings and where landmarks were.

use std::f64::consts::FRAC_PI_2;

use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, Sighting, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, cos, hypot, sin_cos};
use asami_math::statistics::median;

use super::robust::{Row, fitted, fitted_by};
use super::{Capture, LEAST, Together, camera};

/// Rates are taken over so long to both sides.
const RATES_S: f64 = 0.1;
/// What sees landmarks farther to the sides is a scanner.
const SCANNER_RAD: f64 = FRAC_PI_2;

/// Ranges scatter the more the farther: each of so many classes of distance by itself.
const CLASSES: usize = 10;

const ECCENTRICITY: &str = "encoder_eccentricity";
const SPREAD: &str = "bearing_scale.ratio";

/// A sighting beside where the landmark was; how fast that changed, for capture has a clock of its own.
pub(super) struct Seen {
    pub t_s: f64,
    pub distance_m: f64,
    pub bearing_rad: f64,
    pub read_m: f64,
    pub read_rad: f64,
    pub turning_rad_per_s: f64,
    pub parting_m_per_s: f64,
    pub swinging_rad_per_s: f64,
}

impl Seen {
    fn of(dataset: &Dataset, seen: &Sighting) -> Option<Self> {
        let Size::RangeM(read_m) = seen.size else { return None };
        let log = &dataset.log;
        let [right_m, ahead_m] = log.known.range_bearing.as_ref().map_or([0.0; 2], |it| it.sensor_origin_m);
        let landmark = log.known.landmarks.iter().find(|it| it.id == seen.landmark)?;
        let at = |t_s: f64| {
            let pose = pose_at(&dataset.truth.track, t_s)?;
            let (sin, cos_theta) = sin_cos(pose.theta_rad);
            let dx = landmark.x_m - pose.x_m - right_m * cos_theta + ahead_m * sin;
            let dy = landmark.y_m - pose.y_m - right_m * sin - ahead_m * cos_theta;
            Some([pose.theta_rad, hypot(dx, dy), wrap_rad(atan2(-dx, dy) - pose.theta_rad)])
        };
        let [_, distance_m, bearing_rad] = at(seen.t_s)?;
        let rates = match [-RATES_S, RATES_S].map(|by_s| at(seen.t_s + by_s)) {
            [Some(before), Some(after)] => std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * RATES_S)),
            _ => [0.0; 3],
        };
        let whole = |rate: f64| wrap_rad(rate * 2.0 * RATES_S) / (2.0 * RATES_S);
        let [turning_rad_per_s, parting_m_per_s, swinging_rad_per_s] = [whole(rates[0]), rates[1], whole(rates[2])];
        let read_rad = seen.bearing_rad;
        let t_s = seen.t_s;
        Some(Self {
            t_s,
            distance_m,
            bearing_rad,
            read_m,
            read_rad,
            turning_rad_per_s,
            parting_m_per_s,
            swinging_rad_per_s,
        })
    }

    fn off_rad(&self) -> f64 {
        wrap_rad(self.read_rad - self.bearing_rad)
    }

    /// Its range: an offset, the distance, what a depth lacks of it, how far the landmark lies to the left, how fast it parts.
    fn range(&self) -> Row<5> {
        let (sin, cos) = sin_cos(self.bearing_rad);
        let (shortened_m, to_the_left_m) = (self.distance_m * (1.0 - cos), self.distance_m * sin);
        ([1.0, self.distance_m, -shortened_m, to_the_left_m, self.parting_m_per_s], self.read_m)
    }

    /// What its bearing is off: where the sensor looks, how fast it swings, what a disc that is off its axis makes of it, how
    /// far it is spread.
    fn bend(&self) -> Row<4> {
        ([1.0, self.swinging_rad_per_s, 1.0 - cos(self.bearing_rad), self.bearing_rad], self.off_rad())
    }
}

/// Ranges against distances, depths and what lies to the left, bearings against bearings.
pub(super) fn sightings(dataset: &Dataset, capture: &mut Capture) {
    let sightings = dataset.log.sightings.iter();
    let all: Vec<Seen> = sightings.filter_map(|seen| Seen::of(dataset, seen)).collect();
    if all.len() < LEAST {
        return;
    }
    let rows: Vec<Row<5>> = all.iter().map(Seen::range).collect();
    let Some((ranges, kept)) = fitted_by(&rows, &classes(&all)) else { return };
    let offsets: Vec<f64> = all.iter().zip(kept).filter(|(_, kept)| *kept).map(|(seen, _)| seen.off_rad()).collect();
    let values = [
        ("range_offset.offset_m", ranges[0]),
        ("range_scale.ratio", ranges[1]),
        ("depth_for_range.share", ranges[2] / ranges[1]),
        ("range_skew.share", ranges[3] / ranges[1]),
        ("pan_offset.offset_rad", median(&offsets).unwrap_or(0.0)),
    ];
    capture.values.extend(values.map(|(name, value)| (name.to_owned(), value)));
    camera::image(&all, ranges[1], capture);
    angles(&all, capture);
}

/// How bearings of a scanner bend from side to side, and where it looks beside that.
fn angles(all: &[Seen], capture: &mut Capture) {
    if all.iter().filter(|it| it.bearing_rad.abs() > SCANNER_RAD).count() < LEAST {
        return;
    }
    let Some(([offset_rad, _, share, spread], _)) = fitted(&all.iter().map(Seen::bend).collect::<Vec<_>>()) else {
        return;
    };
    let values = [(format!("{ECCENTRICITY}.share"), share), (SPREAD.to_owned(), 1.0 + spread)];
    capture.values.extend(values);
    let values = [("pan_offset.offset_rad".to_owned(), offset_rad)].into();
    capture.together.push(Together { of: &[ECCENTRICITY], without: None, values });
}

/// As many of the nearest as of those that are next, and so on.
fn classes(all: &[Seen]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|a, b| all[*a].distance_m.total_cmp(&all[*b].distance_m));
    let mut class = vec![0; all.len()];
    order.into_iter().enumerate().for_each(|(place, i)| class[i] = CLASSES * place / all.len());
    class
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use asami_math::regression::least_squares;
    use rand::RngExt;
    use rand_distr::StandardNormal;

    use super::*;

    /// A scanner all around, 0.07 s late, whose disc is off its axis: neither its angles nor its ranges are taken for anything else.
    #[test]
    fn what_is_late_is_neither_far_nor_bent() {
        let of = |i: u16| {
            let bearing_rad = 0.1 * f64::from(i % 41) - 2.0;
            let (parting, swinging) = (0.1 * f64::from(i % 5) - 0.3, 0.2 * f64::from(i % 7) - 0.5);
            let distance_m = 1.0 + 0.3 * f64::from(i % 11);
            Seen {
                t_s: 0.1 * f64::from(i),
                distance_m,
                bearing_rad,
                read_m: 1.01 * distance_m - 0.04 - 0.07 * parting,
                read_rad: 1.002 * bearing_rad - 0.08 + 0.009 * (1.0 - cos(bearing_rad)) - 0.07 * swinging,
                turning_rad_per_s: -swinging,
                parting_m_per_s: parting,
                swinging_rad_per_s: swinging,
            }
        };
        let scanned: Vec<Seen> = (0..2000).map(of).collect();
        let (ranges, _) = fitted(&scanned.iter().map(Seen::range).collect::<Vec<_>>()).unwrap();
        let expected = [-0.04, 1.01, 0.0, 0.0, -0.07];
        assert!(ranges.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{ranges:?}");
        let mut capture = Capture::default();
        angles(&scanned, &mut capture);
        capture.suit(&["pan_offset", ECCENTRICITY]);
        for (name, expected) in
            [("encoder_eccentricity.share", 0.009), ("pan_offset.offset_rad", -0.08), (SPREAD, 1.002)]
        {
            assert!((capture.values[name] - expected).abs() < 1e-9, "{name}: {}", capture.values[name]);
        }
        // What sees no farther to the sides than this has no disc.
        let camera: Vec<Seen> = scanned.into_iter().filter(|it| it.bearing_rad.abs() < 1.0).collect();
        let mut capture = Capture::default();
        angles(&camera, &mut capture);
        assert_eq!(capture, Capture::default());
    }

    /// Ranges that scatter by the square of the distance, and a depth that is told by the near ones: as exact as the weights of
    /// their true scatter would have it, and not as all alike would.
    #[test]
    fn what_is_far_and_scatters_counts_for_less() {
        let depths = |seed: u64| {
            let mut rng = Seed(seed).stream("ranges that scatter");
            let seen = |i: u16| {
                let (bearing_rad, distance_m) = (0.1 * f64::from(i % 11) - 0.5, 1.0 + 0.5 * f64::from(i % 13));
                let normal: f64 = rng.sample(StandardNormal);
                let depth_m = distance_m * (1.0 - 0.9 * (1.0 - cos(bearing_rad)));
                Seen {
                    t_s: 0.1 * f64::from(i),
                    distance_m,
                    bearing_rad,
                    read_m: depth_m + 0.002 * distance_m * distance_m * normal,
                    read_rad: bearing_rad,
                    turning_rad_per_s: 0.0,
                    parting_m_per_s: 0.1 * f64::from(i % 5) - 0.2,
                    swinging_rad_per_s: 0.0,
                }
            };
            let all: Vec<Seen> = (0..1430).map(seen).collect();
            let rows: Vec<Row<5>> = all.iter().map(Seen::range).collect();
            let sds = all.iter().map(|it| 0.002 * it.distance_m * it.distance_m);
            let exact = rows.iter().zip(sds).map(|((x, y), sd)| (x.map(|x| x / sd).to_vec(), y / sd));
            let exact = least_squares(5, exact).solve().unwrap().coefficients;
            let share = |found: &[f64]| found[2] / found[1] - 0.9;
            let [weighed, alike] = [fitted_by(&rows, &classes(&all)), fitted(&rows)].map(|it| share(&it.unwrap().0));
            [weighed, alike, share(&exact)]
        };
        let all: Vec<[f64; 3]> = (0..60).map(depths).collect();
        let [weighed, alike, exact] = [0, 1, 2].map(|k| all.iter().map(|it| it[k] * it[k]).sum::<f64>().sqrt());
        assert!(weighed < 1.15 * exact && alike > 1.5 * exact, "{weighed} and {alike}, at best {exact}");
    }
}
