//! How late sightings are by capture's clock.

use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::ln_1p;
use asami_math::statistics::median;

use super::LEAST;
use super::sightings::view;

/// Latenesses that are tried, the least first: so many times so much, either way.
const MOST: i32 = 40;
const FINE_S: f64 = 0.01;
/// A bearing that is off by so much counts half.
const OFF_RAD: f64 = 0.02;
/// What fits no better than this is in time, in nats.
const TELLS_NATS: f64 = 10.0;

/// The time by which bearings are late: with it they fit the poses best, whatever they are all off by; 0 where there are too few.
pub(super) fn late_s(dataset: &Dataset, ahead_rad: f64) -> f64 {
    let track = &dataset.truth.track;
    let off_rad = |late_s: f64| {
        let of = |seen: &asami_dataset::Sighting| {
            let pose = pose_at(track, seen.t_s - late_s)?;
            let [_, bearing_rad] = view(&dataset.log.known, seen.landmark, &pose, ahead_rad)?;
            Some(wrap_rad(seen.bearing_rad - bearing_rad))
        };
        dataset.log.sightings.iter().filter_map(of).collect::<Vec<f64>>()
    };
    let cost = |late_s: f64| {
        let off_rad = off_rad(late_s);
        let middle = median(&off_rad).filter(|_| off_rad.len() >= LEAST)?;
        let each = |off: &f64| ln_1p(((off - middle) / OFF_RAD) * ((off - middle) / OFF_RAD));
        Some(off_rad.iter().map(each).fold(0.0, |sum, it| sum + it) / off_rad.len() as f64)
    };
    let Some(in_time) = cost(0.0) else { return 0.0 };
    let either = (1..=MOST).flat_map(|i| [FINE_S * f64::from(i), -FINE_S * f64::from(i)]);
    let tried = either.filter_map(|late_s| Some((late_s, cost(late_s)?)));
    let best = tried.reduce(|a, b| if b.1 < a.1 { b } else { a });
    let told = |(_, cost): &(f64, f64)| (in_time - cost) * dataset.log.sightings.len() as f64 > TELLS_NATS;
    best.filter(told).map_or(0.0, |(late_s, _)| late_s)
}

/// The same poses by the clock of sightings that are late.
pub(super) fn by_sightings(track: &[TruePose], late_s: f64) -> Vec<TruePose> {
    track.iter().map(|pose| TruePose { t_s: pose.t_s + late_s, ..*pose }).collect()
}
