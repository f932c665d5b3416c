//! What motion capture shows of a wheeled robot: how its motion departs from its commands, and how its sightings depart from
//! where landmarks were.
//!
//! Motion is measured over windows of a second, of which truth is known throughout: the way forward in the robot's frame
//! against the commanded speed's integral, and that of the speed times the squared turning rate, the turn against the
//! commanded turning rate's integral and the way; commands act some time later, as through a lag, or both. Proportions are those of
//! stretches in which the same is told for long, where there are enough. The frame that
//! capture gives a robot hangs on how its markers were put on: ahead is where the robot goes when it is not turning, and it is where
//! it turns about. Windows
//! in which a robot does something else altogether (it is held up, or its own reflexes overrule what it is told) count for
//! nothing. Nothing here is given to a diagnosis.

mod camera;
pub mod errors;
mod late;
mod motion;
mod robust;
mod sightings;
mod starts;
mod steady;
pub mod steering;
mod steps;

use std::collections::BTreeMap;

use asami_dataset::truth::pose_at;
use asami_dataset::{Command, Dataset, TruePose, Truth};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, sin_cos};

use super::commanded::STEP_S;

/// Length of a window.
const WINDOW_S: f64 = 1.0;
/// Truth with a longer gap is none.
const MOST_GAP_S: f64 = 0.4;
/// Sightings, ways and turns farther off than so many times the median are of something else.
const OUTLIER: f64 = 6.0;
/// Rounds in which they are told.
const ROUNDS: usize = 5;
/// Fewer windows or sightings than this show nothing.
const LEAST: usize = 30;
/// A robot that turns by less, by the root of the windows' squares, shows nothing of where its axle is.
const TURNS_RAD: f64 = 1.0;

/// What motion capture shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capture {
    /// Values, by `NAME.PARAM` of the effect that would bring them about.
    pub values: BTreeMap<String, f64>,
    /// Those that differ where several effects are there.
    pub together: Vec<Together>,
    /// How much of what motion is off each of the discrepancies explains alone, the largest first.
    pub shares: Vec<(&'static str, f64)>,
}

/// Values that hold where all of some effects are there, and another is not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Together {
    /// Their names.
    pub of: &'static [&'static str],
    /// The other's.
    pub without: Option<&'static str>,
    /// The values, by `NAME.PARAM`.
    pub values: BTreeMap<String, f64>,
}

impl Capture {
    /// Has values be those beside what is named with them.
    pub fn suit(&mut self, named: &[&str]) {
        for mut together in std::mem::take(&mut self.together) {
            let there = |name: &&str| named.contains(name);
            if together.of.iter().all(there) && !together.without.iter().any(there) {
                self.values.append(&mut together.values);
            }
        }
    }
}

/// A window: the way that was made, in the robot's frame, and the turn.
struct Window {
    from_s: f64,
    forward_m: f64,
    left_m: f64,
    turn_rad: f64,
    /// Whether the way, and the turn, are of what was commanded.
    counts: [bool; 2],
}

impl Window {
    /// The way forward, 0, or the turn, 1.
    fn moved(&self, axis: usize) -> f64 {
        [self.forward_m, self.turn_rad][axis]
    }
}

/// The frame that capture gives a robot, which hangs on how its markers were put on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    /// Where the robot goes when it is not turning: to the left of its heading.
    ahead_rad: f64,
    /// How far ahead of the axle, about which a robot turns, it is.
    before_axle_m: f64,
}

impl Frame {
    /// By least squares in what is made to the left: a robot goes nowhere but ahead.
    fn of(windows: &[Window]) -> Self {
        let of = |a: fn(&Window) -> f64, b: fn(&Window) -> f64| windows.iter().fold(0.0, |sum, it| sum + a(it) * b(it));
        let (forward, left, turn) = (|it: &Window| it.forward_m, |it: &Window| it.left_m, |it: &Window| it.turn_rad);
        let (ff, ft, tt) = (of(forward, forward), of(forward, turn), of(turn, turn).max(1e-12));
        let (fl, tl) = (of(forward, left), of(turn, left));
        let by_way = (fl * tt - tl * ft) / (ff * tt - ft * ft).max(1e-12);
        let by_turn_m = if tt < TURNS_RAD * TURNS_RAD { 0.0 } else { (tl - by_way * ft) / tt };
        Self { ahead_rad: atan2(by_way, 1.0), before_axle_m: by_turn_m }
    }

    /// Where the axle is, and where ahead is of it.
    fn axle(self, pose: &TruePose) -> TruePose {
        let theta_rad = wrap_rad(pose.theta_rad + self.ahead_rad);
        let (sin, cos) = sin_cos(theta_rad);
        let (x_m, y_m) = (pose.x_m + self.before_axle_m * sin, pose.y_m - self.before_axle_m * cos);
        TruePose { x_m, y_m, theta_rad, ..*pose }
    }
}

/// Where a robot's axle is, and where ahead is of it, by the track that capture has of its markers: what a simulated robot's truth is.
#[must_use]
pub fn of_axle(track: &[TruePose]) -> Vec<TruePose> {
    let frame = Frame::of(&windows(track));
    track.iter().map(|pose| frame.axle(pose)).collect()
}

/// What the truth of a wheeled robot's log shows; nothing where there is too little of it. `given` are its commands as they were given,
/// whenever they were taken up: a rest that may not have been one is none. `own_lag_s` is the time constant that the nominal robot has by
/// itself: an effect's is on top of it.
#[must_use]
pub fn capture(dataset: &Dataset, given: &[Command], own_lag_s: f64) -> Capture {
    let mut capture = Capture::default();
    let track = of_axle(&dataset.truth.track);
    let mut windows = windows(&track);
    let dataset = &Dataset { truth: Truth { track: track.into(), survey: None }, ..dataset.clone() };
    let steady = steady::steady(dataset);
    if let Some(later_s) = steady.and_then(|does| starts::late_start(given, &dataset.truth.track, &does)) {
        capture.values.insert("late_start.start_s".to_owned(), later_s);
    }
    motion::motion(dataset, &mut windows, steady, own_lag_s, &mut capture);
    sightings::sightings(dataset, &mut capture);
    capture
}

fn windows(track: &[TruePose]) -> Vec<Window> {
    let (Some(first), Some(last)) = (track.first(), track.last()) else { return Vec::new() };
    let n = ((last.t_s - first.t_s) / WINDOW_S) as usize;
    (0..n).filter_map(|i| window(track, first.t_s + i as f64 * WINDOW_S, WINDOW_S)).collect()
}

fn window(track: &[TruePose], from_s: f64, length_s: f64) -> Option<Window> {
    let within =
        track.partition_point(|pose| pose.t_s < from_s)..track.partition_point(|pose| pose.t_s <= from_s + length_s);
    let around = &track[within.start.saturating_sub(1)..(within.end + 1).min(track.len())];
    if around.windows(2).any(|pair| pair[1].t_s - pair[0].t_s > MOST_GAP_S) {
        return None;
    }
    let steps = (length_s / STEP_S).round().max(1.0);
    let (mut forward_m, mut left_m, mut turn_rad) = (0.0, 0.0, 0.0);
    let mut before = pose_at(track, from_s)?;
    for i in 1..=steps as usize {
        let pose = pose_at(track, from_s + i as f64 * length_s / steps)?;
        let turned = wrap_rad(pose.theta_rad - before.theta_rad);
        let (sin, cos) = sin_cos(before.theta_rad + 0.5 * turned);
        let (dx_m, dy_m) = (pose.x_m - before.x_m, pose.y_m - before.y_m);
        forward_m += cos * dy_m - sin * dx_m;
        left_m -= cos * dx_m + sin * dy_m;
        turn_rad += turned;
        before = pose;
    }
    Some(Window { from_s, forward_m, left_m, turn_rad, counts: [true; 2] })
}

#[cfg(test)]
mod tests {
    use asami_dataset::log::RangeBearing;
    use asami_dataset::{Action, Beacon, Known, Log, Sighting, Size};
    use asami_math::elementary::hypot;

    use super::*;

    /// A robot that goes 0.9 times as fast as told, and slower in turns, turns 0.8 times as fast, bends to the left by 0.05
    /// rad a metre, and does so some time late; its camera reports depths, 2 % and 0.1 m too long, along an axis that
    /// is turned by 0.03 rad, 0.02 rad to the left; the capture has it look `markers_rad` to the left of where it goes.
    fn log(delay_s: f64, markers_rad: f64) -> Dataset {
        let command = |i: i32| {
            let t_s = 2.5 * f64::from(i);
            let (v_m_per_s, omega_rad_per_s) =
                (0.1 + 0.05 * f64::from(i * 7 % 3), 0.3 * f64::from(i * 5 % 7 - 3) / 3.0);
            Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } }
        };
        let commands: Vec<Command> = (0..48).map(command).collect();
        let mut pose = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let landmark = Beacon { id: 7, x_m: 0.5, y_m: 12.0, height_m: None };
        let (mut track, mut sightings) = (vec![TruePose { theta_rad: markers_rad, ..pose }], Vec::new());
        for i in 0..12_000 {
            let at = commands.partition_point(|it| it.t_s <= pose.t_s - delay_s + 1e-9);
            let (v, omega) = match at.checked_sub(1).map(|at| commands[at].action) {
                Some(Action::Wheels { v_m_per_s: v, omega_rad_per_s: omega, .. }) => {
                    (0.9 * v * (1.0 - 2.0 * omega * omega), 0.8 * omega)
                }
                _ => (0.0, 0.0),
            };
            let turned = 0.01 * (omega + 0.05 * v);
            let (sin, cos_theta) = sin_cos(pose.theta_rad + 0.5 * turned);
            (pose.x_m, pose.y_m) = (pose.x_m - 0.01 * v * sin, pose.y_m + 0.01 * v * cos_theta);
            (pose.t_s, pose.theta_rad) = (0.01 * f64::from(i + 1), wrap_rad(pose.theta_rad + turned));
            track.push(TruePose { theta_rad: wrap_rad(pose.theta_rad + markers_rad), ..pose });
            let (sin, cos_theta) = sin_cos(pose.theta_rad);
            let (dx, dy) = (landmark.x_m - pose.x_m + 0.2 * sin, landmark.y_m - pose.y_m - 0.2 * cos_theta);
            let bearing_rad = wrap_rad(atan2(-dx, dy) - pose.theta_rad);
            if i % 50 == 0 && bearing_rad.abs() < 1.0 {
                let (to_the_left, ahead) = sin_cos(bearing_rad);
                let size = Size::RangeM(0.1 + 1.02 * hypot(dx, dy) * (ahead - 0.03 * to_the_left));
                sightings.push(Sighting { t_s: pose.t_s, landmark: 7, size, bearing_rad: bearing_rad + 0.02 });
            }
        }
        let range_bearing = Some(RangeBearing { max_range_m: 20.0, sensor_origin_m: [0.0, 0.2] });
        let known = Known { robot: "create".into(), range_bearing, landmarks: vec![landmark], ..Known::default() };
        let log = Log { known: known.into(), commands: commands.into(), sightings: sightings.into(), ..Log::default() };
        Dataset { log, truth: Truth { track: track.into(), survey: None }, provenance: None }
    }

    fn shown(dataset: &Dataset, own_lag_s: f64) -> Capture {
        capture(dataset, &dataset.log.commands, own_lag_s)
    }

    #[test]
    fn what_was_put_in_is_shown() {
        let found = shown(&log(0.3, 0.0), 0.0);
        let near = |name: &str, expected: f64, tolerance: f64| {
            let value = found.values[name];
            assert!((value - expected).abs() < tolerance, "{name}: {value}, not {expected}");
        };
        near("command_scale.y_ratio", 0.9, 0.005);
        near("command_scale.theta_ratio", 0.8, 0.01);
        near("wheel_base.ratio", 1.0 / 0.8, 0.015);
        near("unequal_wheels.ratio", 1.0 + 0.258 * 0.05, 0.001);
        near("turn_slowing.loss_s2", 2.0, 0.05);
        near("command_delay.delay_s", 0.3, 0.021);
        near("range_scale.ratio", 1.02, 1e-6);
        near("range_offset.offset_m", 0.1, 1e-6);
        near("depth_for_range.share", 1.0, 1e-6);
        near("range_skew.share", -0.03, 1e-6);
        near("pan_offset.offset_rad", 0.02, 1e-4);
        let less = shown(&log(0.3, 0.0), 0.03).values["wheel_lag.lag_s"];
        near("wheel_lag.lag_s", less + 0.03, 1e-9);
        let at_once = shown(&log(0.0, 0.0), 0.0).shares;
        assert!(at_once[0].0 == "scale" && at_once[0].1 > 0.9, "{at_once:?}");
    }

    /// A delay and a lag that are both named have the sizes that they have together.
    #[test]
    fn what_is_named_has_the_sizes_that_suit_it() {
        let mut found = shown(&log(0.3, 0.0), 0.0);
        let (alone, together) = (found.values.clone(), found.together[0].values.clone());
        found.clone().suit(&["wheel_lag", "turn_slowing", "command_scale"]);
        assert_eq!(found.values, alone);
        found.suit(&["wheel_lag", "command_delay"]);
        assert_eq!(found.values["wheel_lag.lag_s"], together["wheel_lag.lag_s"]);
        assert!((found.values["command_delay.delay_s"] - 0.3).abs() < 0.021 && found.values["wheel_lag.lag_s"] < 0.03);
        assert!(alone["wheel_lag.lag_s"] > 0.1);
    }

    /// A scale of commands makes a robot that goes 0.9 times as fast as told turn so as well: beside it wheels are too close together by
    /// as much. Without one, what it lacks is taken for what it loses in turns.
    #[test]
    fn a_scale_that_is_named_or_not_is_counted_in() {
        let found = shown(&log(0.3, 0.0), 0.0);
        let named = |names: &[&str]| {
            let mut found = found.clone();
            found.suit(names);
            found.values
        };
        let scaled = named(&["wheel_base", "turn_slowing", "command_scale"]);
        assert!((scaled["wheel_base.ratio"] - 0.9 / 0.8).abs() < 0.015, "{scaled:?}");
        assert!((scaled["command_scale.theta_ratio"] - 0.9).abs() < 0.005, "{scaled:?}");
        assert!((scaled["turn_slowing.loss_s2"] - 2.0).abs() < 0.05, "{scaled:?}");
        let unscaled = named(&["wheel_base", "turn_slowing"]);
        assert!((unscaled["wheel_base.ratio"] - 1.0 / 0.8).abs() < 0.015, "{unscaled:?}");
        assert!(unscaled["turn_slowing.loss_s2"] > 2.5, "{unscaled:?}");
    }

    /// How markers were put on a robot says nothing of the robot.
    #[test]
    fn ahead_is_where_a_robot_goes_and_it_is_where_it_turns_about() {
        let straight = log(0.3, 0.0);
        let mut behind = log(0.3, -0.08);
        let put = |pose: &TruePose| {
            let (sin, cos) = sin_cos(pose.theta_rad + 0.08);
            TruePose { x_m: pose.x_m + 0.03 * sin, y_m: pose.y_m - 0.03 * cos, ..*pose }
        };
        behind.truth.track = behind.truth.track.iter().map(put).collect::<Vec<_>>().into();
        let [axle, same] = [&straight, &behind].map(|it| of_axle(&it.truth.track));
        for (a, b) in axle.iter().zip(&same) {
            let off_m = hypot(a.x_m - b.x_m, a.y_m - b.y_m);
            assert!(off_m < 1e-3 && wrap_rad(a.theta_rad - b.theta_rad).abs() < 1e-3, "{a:?} and {b:?}");
        }
        let straight = shown(&straight, 0.0);
        for other in [log(0.3, -0.08), behind] {
            let other = shown(&other, 0.0);
            for (name, value) in &straight.values {
                let other = other.values[name];
                assert!((value - other).abs() < 1e-4, "{name}: {other}, not {value}");
            }
        }
    }

    #[test]
    fn a_log_without_truth_shows_nothing() {
        let blind = Dataset { truth: Truth::default(), ..log(0.3, 0.0) };
        assert_eq!(shown(&blind, 0.0), Capture::default());
        let mut short = log(0.3, 0.0);
        short.truth.track = short.truth.track.window(&(0.0..5.0));
        short.log.sightings = short.log.sightings.window(&(0.0..5.0));
        assert_eq!(shown(&short, 0.0), Capture::default());
    }
}
