//! What motion capture shows of a wheeled robot: how its motion departs from its commands, and how its sightings depart from
//! where landmarks were.
//!
//! Motion is measured over windows of a second, of which truth is known throughout: the way forward in the robot's frame
//! against the commanded speed's integral, the turn against the commanded turning rate's integral and the way; commands act
//! some time later, all at once or as through a lag. Nothing here is given to a diagnosis.

use std::collections::BTreeMap;

use asami_dataset::truth::pose_at;
use asami_dataset::{Action, Command, Dataset, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, cos, exp, hypot, sin_cos};
use asami_math::statistics::median;

/// Length of a window.
const WINDOW_S: f64 = 1.0;
/// Truth and commands are looked at so often.
const STEP_S: f64 = 0.02;
/// Truth with a longer gap is none.
const MOST_GAP_S: f64 = 0.4;
/// Delays and lags that are tried.
const MOST_LATE_S: f64 = 0.8;
/// Between the wheels of a Create.
const BASE_M: f64 = 0.258;
/// Sightings farther off than so many times the median are of something else.
const OUTLIER: f64 = 6.0;
/// Rounds in which they are told.
const ROUNDS: usize = 5;
/// Fewer windows or sightings than this show nothing.
const LEAST: usize = 30;

/// What motion capture shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capture {
    /// Values, by `NAME.PARAM` of the effect that would bring them about.
    pub values: BTreeMap<String, f64>,
    /// How much of what motion is off each of the discrepancies explains alone, the largest first.
    pub shares: Vec<(&'static str, f64)>,
}

/// A window: the way forward and the turn that were commanded, by delay, and that were made.
struct Window {
    from_s: f64,
    forward_m: f64,
    turn_rad: f64,
}

/// What the truth of a wheeled robot's log shows; nothing where there is too little of it. `own_lag_s` is the time constant
/// that the nominal robot has by itself: an effect's is on top of it.
#[must_use]
pub fn capture(dataset: &Dataset, own_lag_s: f64) -> Capture {
    let mut capture = Capture::default();
    motion(dataset, own_lag_s, &mut capture);
    sightings(dataset, &mut capture);
    capture
}

fn windows(track: &[TruePose]) -> Vec<Window> {
    let (Some(first), Some(last)) = (track.first(), track.last()) else { return Vec::new() };
    let n = ((last.t_s - first.t_s) / WINDOW_S) as usize;
    (0..n).filter_map(|i| window(track, first.t_s + i as f64 * WINDOW_S)).collect()
}

fn window(track: &[TruePose], from_s: f64) -> Option<Window> {
    let within =
        track.partition_point(|pose| pose.t_s < from_s)..track.partition_point(|pose| pose.t_s <= from_s + WINDOW_S);
    let around = &track[within.start.saturating_sub(1)..(within.end + 1).min(track.len())];
    if around.windows(2).any(|pair| pair[1].t_s - pair[0].t_s > MOST_GAP_S) {
        return None;
    }
    let steps = (WINDOW_S / STEP_S).round() as usize;
    let (mut forward_m, mut turn_rad) = (0.0, 0.0);
    let mut before = pose_at(track, from_s)?;
    for i in 1..=steps {
        let pose = pose_at(track, from_s + i as f64 * STEP_S)?;
        let turned = wrap_rad(pose.theta_rad - before.theta_rad);
        let (sin, cos) = sin_cos(before.theta_rad + 0.5 * turned);
        forward_m += cos * (pose.y_m - before.y_m) - sin * (pose.x_m - before.x_m);
        turn_rad += turned;
        before = pose;
    }
    Some(Window { from_s, forward_m, turn_rad })
}

/// Commanded speed and turning rate, every so often from a time on.
struct Commanded {
    from_s: f64,
    /// Integrals from the beginning.
    sums: Vec<[f64; 2]>,
}

/// How commands come to act.
#[derive(Clone, Copy, PartialEq)]
enum Late {
    /// So long after they were given.
    Delay(f64),
    /// Through a lag of this time constant.
    Lag(f64),
}

impl Commanded {
    fn new(commands: &[Command], late: Late) -> Self {
        let (from_s, to_s) = commands.first().zip(commands.last()).map_or((0.0, 0.0), |(a, b)| (a.t_s, b.t_s));
        let steps = ((to_s - from_s + MOST_LATE_S) / STEP_S) as usize + 1;
        let (mut next, mut given, mut acting) = (0, [0.0; 2], [0.0; 2]);
        let mut sums = vec![[0.0; 2]];
        for i in 0..steps {
            let t_s = from_s + (i as f64 + 0.5) * STEP_S - if let Late::Delay(delay_s) = late { delay_s } else { 0.0 };
            while let Some(command) = commands.get(next).filter(|command| command.t_s <= t_s) {
                if let Action::Wheels { v_m_per_s, omega_rad_per_s, .. } = command.action {
                    given = [v_m_per_s, omega_rad_per_s];
                }
                next += 1;
            }
            let share = if let Late::Lag(lag_s) = late { 1.0 - exp(-STEP_S / lag_s.max(1e-6)) } else { 1.0 };
            let last = sums[i];
            for k in 0..2 {
                acting[k] += share * (given[k] - acting[k]);
            }
            sums.push([last[0] + STEP_S * acting[0], last[1] + STEP_S * acting[1]]);
        }
        Self { from_s, sums }
    }

    /// The integrals over a window.
    fn over(&self, from_s: f64) -> [f64; 2] {
        let at = |t_s: f64| {
            let step = ((t_s - self.from_s) / STEP_S).clamp(0.0, self.sums.len() as f64 - 1.0);
            let (i, share) = (step as usize, step.fract());
            let [a, b] = [i, i + 1].map(|i| self.sums[i.min(self.sums.len() - 1)]);
            [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
        };
        let (before, after) = (at(from_s), at(from_s + WINDOW_S));
        [after[0] - before[0], after[1] - before[1]]
    }
}

/// Sums of squares that are left of way and turn: with the speeds in proportion and a turn in proportion to the way where
/// these are free.
struct Left {
    late: Late,
    forward: f64,
    turn: f64,
    bend_rad_per_m: f64,
    squares: [f64; 2],
}

fn fit(commands: &[Command], windows: &[Window], late: Late, [scaled, bent]: [bool; 2]) -> Left {
    let commanded = Commanded::new(commands, late);
    let over: Vec<[f64; 2]> = windows.iter().map(|window| commanded.over(window.from_s)).collect();
    let [v, omega] = [0, 1].map(|k| over.iter().map(|it| it[k]).collect::<Vec<f64>>());
    let way: Vec<f64> = windows.iter().map(|window| window.forward_m).collect();
    let turned: Vec<f64> = windows.iter().map(|window| window.turn_rad).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
    // Least squares in two unknowns, of which either may be held.
    let (vv, oo, vo) = (dot(&v, &v), dot(&omega, &omega), dot(&v, &omega));
    let (vt, ot) = (dot(&v, &turned), dot(&omega, &turned));
    let forward = if scaled { dot(&v, &way) / vv.max(1e-12) } else { 1.0 };
    let (turn, bend) = match (scaled, bent) {
        (true, true) => {
            let determinant = (vv * oo - vo * vo).max(1e-18);
            ((ot * vv - vt * vo) / determinant, (vt * oo - ot * vo) / determinant)
        }
        (true, false) => (ot / oo.max(1e-12), 0.0),
        (false, true) => (1.0, (vt - vo) / vv.max(1e-12)),
        (false, false) => (1.0, 0.0),
    };
    let squares = (0..windows.len()).fold([0.0; 2], |sums, i| {
        let off = [way[i] - forward * v[i], turned[i] - turn * omega[i] - bend * v[i]];
        [sums[0] + off[0] * off[0], sums[1] + off[1] * off[1]]
    });
    // A robot that is never told to turn shows nothing of how it turns.
    let turn = if oo > 1e-9 { turn } else { f64::NAN };
    Left { late, forward, turn, bend_rad_per_m: bend, squares }
}

fn motion(dataset: &Dataset, own_lag_s: f64, capture: &mut Capture) {
    let (commands, windows) = (&dataset.log.commands, windows(&dataset.truth.track));
    if windows.len() < LEAST || !commands.iter().any(|it| matches!(it.action, Action::Wheels { .. })) {
        return;
    }
    let times_s = || (0..=(MOST_LATE_S / STEP_S) as usize).map(|i| i as f64 * STEP_S);
    let (delays, lags): (Vec<Late>, Vec<Late>) =
        (times_s().map(Late::Delay).collect(), times_s().map(Late::Lag).collect());
    let at_once = Late::Delay(0.0);
    // Ways and turns each in units of what is left of them at last.
    let scale = delays
        .iter()
        .chain(&lags)
        .map(|late| fit(commands, &windows, *late, [true, true]).squares)
        .fold([f64::INFINITY; 2], |least, squares| [least[0].min(squares[0]), least[1].min(squares[1])]);
    let off = |it: &Left| (0..2).map(|k| it.squares[k] / scale[k].max(1e-12)).sum::<f64>();
    let best = |free: [bool; 2], late: &[Late]| {
        let fits = late.iter().map(|late| fit(commands, &windows, *late, free));
        fits.reduce(|a, b| if off(&b) < off(&a) { b } else { a })
    };
    let (Some(delayed), Some(lagged)) = (best([true, true], &delays), best([true, true], &lags)) else { return };
    let found = if off(&lagged) < off(&delayed) { &lagged } else { &delayed };
    let none = fit(commands, &windows, at_once, [false, false]);
    let alone = |free: [bool; 2], late: &[Late]| {
        let left = best(free, late).map_or(f64::INFINITY, |it| off(&it));
        ((off(&none) - left) / (off(&none) - off(found)).max(1e-12)).clamp(0.0, 1.0)
    };
    capture.shares = vec![
        ("scale", alone([true, false], &[at_once])),
        ("bend", alone([false, true], &[at_once])),
        ("delay", alone([false, false], &delays)),
        ("lag", alone([false, false], &lags)),
    ];
    capture.shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut value = |name: &str, value: f64| {
        if value.is_finite() {
            capture.values.insert(name.to_owned(), value);
        }
    };
    value("command_scale.y_ratio", found.forward);
    value("command_scale.theta_ratio", found.turn);
    value("wheel_base.ratio", found.forward / found.turn);
    value("unequal_wheels.ratio", 1.0 + BASE_M * found.bend_rad_per_m / found.forward);
    for late in [delayed.late, lagged.late] {
        match late {
            Late::Delay(delay_s) => value("command_delay.delay_s", delay_s),
            Late::Lag(lag_s) => value("wheel_lag.lag_s", (lag_s - own_lag_s).max(0.0)),
        }
    }
}

/// Ranges against distances and depths, bearings against bearings.
fn sightings(dataset: &Dataset, capture: &mut Capture) {
    let log = &dataset.log;
    let [right_m, ahead_m] = log.known.range_bearing.as_ref().map_or([0.0; 2], |it| it.sensor_origin_m);
    let rows: Vec<([f64; 3], f64, f64)> = log
        .sightings
        .iter()
        .filter_map(|seen| {
            let Size::RangeM(range_m) = seen.size else { return None };
            let landmark = log.known.landmarks.iter().find(|it| it.id == seen.landmark)?;
            let pose = pose_at(&dataset.truth.track, seen.t_s)?;
            let (sin, cos_theta) = sin_cos(pose.theta_rad);
            let dx = landmark.x_m - pose.x_m - right_m * cos_theta + ahead_m * sin;
            let dy = landmark.y_m - pose.y_m - right_m * sin - ahead_m * cos_theta;
            let (distance_m, bearing_rad) = (hypot(dx, dy), wrap_rad(atan2(-dx, dy) - pose.theta_rad));
            let shortened_m = distance_m * (1.0 - cos(bearing_rad));
            Some(([1.0, distance_m, -shortened_m], range_m, wrap_rad(seen.bearing_rad - bearing_rad)))
        })
        .collect();
    if rows.len() < LEAST {
        return;
    }
    let mut kept: Vec<&([f64; 3], f64, f64)> = rows.iter().collect();
    let mut found = [0.0, 1.0, 0.0];
    for _ in 0..ROUNDS {
        let Some(solved) = least_squares(kept.iter().map(|row| (row.0, row.1))) else { return };
        found = solved;
        let off = |row: &([f64; 3], f64, f64)| (row.1 - (0..3).fold(0.0, |sum, k| sum + found[k] * row.0[k])).abs();
        let usual = median(&rows.iter().map(off).collect::<Vec<f64>>()).unwrap_or(0.0);
        kept = rows.iter().filter(|row| off(row) <= OUTLIER * usual).collect();
    }
    let offsets: Vec<f64> = kept.iter().map(|row| row.2).collect();
    let offset_rad = median(&offsets).unwrap_or(0.0);
    let values = [
        ("range_offset.offset_m", found[0]),
        ("range_scale.ratio", found[1]),
        ("depth_for_range.share", found[2] / found[1]),
        ("pan_offset.offset_rad", offset_rad),
    ];
    capture.values.extend(values.map(|(name, value)| (name.to_owned(), value)));
}

/// The solution of the normal equations in three unknowns; a column that is always 0 has none, and counts nothing.
fn least_squares(rows: impl Iterator<Item = ([f64; 3], f64)>) -> Option<[f64; 3]> {
    let mut a = vec![vec![0.0; 3]; 3];
    let mut b = vec![0.0; 3];
    for (row, y) in rows {
        for i in 0..3 {
            b[i] += row[i] * y;
            (0..3).for_each(|j| a[i][j] += row[i] * row[j]);
        }
    }
    (0..3).filter(|i| a[*i][*i] < 1e-9).collect::<Vec<_>>().into_iter().for_each(|i| a[i][i] = 1.0);
    let l = asami_math::decomposition::cholesky(&a)?;
    let solved = asami_math::decomposition::cholesky_solve(&l, &b);
    solved.try_into().ok()
}

#[cfg(test)]
mod tests {
    use asami_dataset::log::RangeBearing;
    use asami_dataset::{Beacon, Known, Log, Sighting, Truth};

    use super::*;

    /// A robot that goes 0.9 times as fast as told, turns 0.8 times as fast, bends to the left by 0.05 rad a metre, and does so
    /// some time late; its camera reports depths, 2 % and 0.1 m too long, 0.02 rad to the left.
    fn log(delay_s: f64) -> Dataset {
        let command = |i: i32| {
            let t_s = 2.5 * f64::from(i);
            let (v_m_per_s, omega_rad_per_s) =
                (0.1 + 0.05 * f64::from(i * 7 % 3), 0.3 * f64::from(i * 5 % 7 - 3) / 3.0);
            Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } }
        };
        let commands: Vec<Command> = (0..48).map(command).collect();
        let mut pose = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let landmark = Beacon { id: 7, x_m: 0.5, y_m: 12.0, height_m: None };
        let (mut track, mut sightings) = (vec![pose], Vec::new());
        for i in 0..12_000 {
            let at = commands.partition_point(|it| it.t_s <= pose.t_s - delay_s + 1e-9);
            let (v, omega) = match at.checked_sub(1).map(|at| commands[at].action) {
                Some(Action::Wheels { v_m_per_s, omega_rad_per_s, .. }) => (0.9 * v_m_per_s, 0.8 * omega_rad_per_s),
                _ => (0.0, 0.0),
            };
            let turned = 0.01 * (omega + 0.05 * v);
            let (sin, cos_theta) = sin_cos(pose.theta_rad + 0.5 * turned);
            (pose.x_m, pose.y_m) = (pose.x_m - 0.01 * v * sin, pose.y_m + 0.01 * v * cos_theta);
            (pose.t_s, pose.theta_rad) = (0.01 * f64::from(i + 1), wrap_rad(pose.theta_rad + turned));
            track.push(pose);
            let (sin, cos_theta) = sin_cos(pose.theta_rad);
            let (dx, dy) = (landmark.x_m - pose.x_m + 0.2 * sin, landmark.y_m - pose.y_m - 0.2 * cos_theta);
            let bearing_rad = wrap_rad(atan2(-dx, dy) - pose.theta_rad);
            if i % 50 == 0 && bearing_rad.abs() < 1.0 {
                let size = Size::RangeM(0.1 + 1.02 * hypot(dx, dy) * cos(bearing_rad));
                sightings.push(Sighting { t_s: pose.t_s, landmark: 7, size, bearing_rad: bearing_rad + 0.02 });
            }
        }
        let range_bearing = Some(RangeBearing { max_range_m: 20.0, sensor_origin_m: [0.0, 0.2] });
        let known = Known { robot: "create".into(), range_bearing, landmarks: vec![landmark], ..Known::default() };
        let log = Log { known: known.into(), commands: commands.into(), sightings: sightings.into(), ..Log::default() };
        Dataset { log, truth: Truth { track: track.into(), survey: None }, provenance: None }
    }

    #[test]
    fn what_was_put_in_is_shown() {
        let found = capture(&log(0.3), 0.0);
        let near = |name: &str, expected: f64, tolerance: f64| {
            let value = found.values[name];
            assert!((value - expected).abs() < tolerance, "{name}: {value}, not {expected}");
        };
        near("command_scale.y_ratio", 0.9, 0.005);
        near("command_scale.theta_ratio", 0.8, 0.01);
        near("wheel_base.ratio", 0.9 / 0.8, 0.015);
        near("unequal_wheels.ratio", 1.0 + 0.258 * 0.05, 0.001);
        near("command_delay.delay_s", 0.3, 0.021);
        near("range_scale.ratio", 1.02, 1e-6);
        near("range_offset.offset_m", 0.1, 1e-6);
        near("depth_for_range.share", 1.0, 1e-6);
        near("pan_offset.offset_rad", 0.02, 1e-9);
        let less = capture(&log(0.3), 0.03).values["wheel_lag.lag_s"];
        near("wheel_lag.lag_s", less + 0.03, 1e-9);
        let at_once = capture(&log(0.0), 0.0).shares;
        assert!(at_once[0].0 == "scale" && at_once[0].1 > 0.9, "{at_once:?}");
    }

    #[test]
    fn a_log_without_truth_shows_nothing() {
        let blind = Dataset { truth: Truth::default(), ..log(0.3) };
        assert_eq!(capture(&blind, 0.0), Capture::default());
        let mut short = log(0.3);
        short.truth.track = short.truth.track.window(&(0.0..5.0));
        short.log.sightings = short.log.sightings.window(&(0.0..5.0));
        assert_eq!(capture(&short, 0.0), Capture::default());
    }
}
