//! What inertial navigation shows of a car: how its front wheels must have stood for it to go round as it did, against how they
//! were told to.
//!
//! Over windows in which the car is under way the turn is held against the way by the wheelbase, times the angle: without slip they
//! are the same. The angle is what was commanded, through a lag, in proportion, and an angle on top.

use asami_dataset::{Action, Command, Dataset};
use asami_math::elementary::exp;
use asami_math::regression::Regression;
use asami_sim::robots::car::CarConfig;
use asami_sim::robots::car::blueprint::Blueprint;

use super::{Capture, LEAST, STEP_S, WINDOW_S, Window, windows};

/// Slower cars are not under way.
const UNDER_WAY_M_PER_S: f64 = 3.0;
/// Lags that are tried, so far apart.
const MOST_LAG_S: f64 = 1.2;
const FINE_S: f64 = 0.01;

/// Sums of squares of turns that are left, and what they are left by.
struct Left {
    offset_rad: f64,
    ratio: f64,
    squares: f64,
}

/// What the truth of a car's log shows of its steering; nothing where there is too little of it.
#[must_use]
pub fn of_car(dataset: &Dataset, car: &CarConfig) -> Capture {
    let Ok(body) = Blueprint::shipped(car.body) else { return Capture::default() };
    let under_way = |window: &Window| window.forward_m > UNDER_WAY_M_PER_S * WINDOW_S;
    let windows: Vec<Window> = windows(&dataset.truth.track).into_iter().filter(under_way).collect();
    let wheelbase_m = body.wheelbase_m();
    if windows.len() < LEAST {
        return Capture::default();
    }
    let told = |lag_s: f64| {
        let steered = Steered::new(&dataset.log.commands, car.steering.delay_s, lag_s, body.steering_rad);
        windows.iter().map(|it| steered.over(it.from_s)).collect::<Vec<f64>>()
    };
    let own = told(car.steering.lag_s);
    let as_told = squares((&windows, wheelbase_m), &own, 0.0, 1.0);
    let offset = left((&windows, wheelbase_m), &own, [true, false]);
    let ratio = left((&windows, wheelbase_m), &own, [false, true]);
    let lags: Vec<f64> = (0..=(MOST_LAG_S / FINE_S) as usize).map(|i| i as f64 * FINE_S).collect();
    let late = |frees: [bool; 2]| {
        let of = |lag_s: &f64| (*lag_s, left((&windows, wheelbase_m), &told(car.steering.lag_s + lag_s), frees));
        lags.iter().map(of).reduce(|a, b| if b.1.squares < a.1.squares { b } else { a })
    };
    let (Some((_, lag)), Some((lag_s, all))) = (late([false, false]), late([true, true])) else {
        return Capture::default();
    };
    let share = |left: &Left| 1.0 - left.squares / as_told.max(1e-12);
    let mut shares =
        vec![("steering offset", share(&offset)), ("steering ratio", share(&ratio)), ("steering lag", share(&lag))];
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let values = [
        ("steering_offset.offset_rad", all.offset_rad),
        ("steering_ratio.ratio", all.ratio),
        ("steering_lag.lag_s", lag_s),
    ];
    Capture {
        values: values.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        shares,
        ..Capture::default()
    }
}

/// What is left where an offset and a ratio are free, or not.
fn left((windows, wheelbase_m): (&[Window], f64), told: &[f64], [offset, ratio]: [bool; 2]) -> Left {
    let frees = [offset, ratio].into_iter().filter(|it| *it).count();
    let mut regression = Regression::new(frees);
    for (window, told) in windows.iter().zip(told) {
        let columns = [(offset, window.forward_m / wheelbase_m), (ratio, window.forward_m / wheelbase_m * told)];
        let row: Vec<f64> = columns.into_iter().filter(|it| it.0).map(|it| it.1).collect();
        let fixed = if ratio { 0.0 } else { window.forward_m / wheelbase_m * told };
        regression.observe(&row, window.turn_rad - fixed, 1.0);
    }
    let mut found = regression.solve().map_or_else(Vec::new, |fit| fit.coefficients.clone()).into_iter();
    let offset_rad = if offset { found.next().unwrap_or(0.0) } else { 0.0 };
    let ratio = if ratio { found.next().unwrap_or(1.0) } else { 1.0 };
    Left { offset_rad, ratio, squares: squares((windows, wheelbase_m), told, offset_rad, ratio) }
}

fn squares((windows, wheelbase_m): (&[Window], f64), told: &[f64], offset_rad: f64, ratio: f64) -> f64 {
    let off = |(it, told): (&Window, &f64)| it.turn_rad - it.forward_m / wheelbase_m * (offset_rad + ratio * told);
    windows.iter().zip(told).map(off).fold(0.0, |sum, off| sum + off * off)
}

/// The front wheels' angle as commanded, through a dead time and a lag.
struct Steered {
    from_s: f64,
    /// Integrals from the beginning, in steps.
    sums: Vec<f64>,
}

impl Steered {
    fn new(commands: &[Command], delay_s: f64, lag_s: f64, full_rad: f64) -> Self {
        let (from_s, to_s) = commands.first().zip(commands.last()).map_or((0.0, 0.0), |(a, b)| (a.t_s, b.t_s));
        let (mut next, mut given_rad, mut angle_rad, mut sum) = (0, 0.0, 0.0, 0.0);
        let follows = 1.0 - exp(-STEP_S / lag_s.max(1e-6));
        let mut sums = vec![0.0];
        for i in 0..((to_s - from_s) / STEP_S) as usize + 1 {
            let t_s = from_s + (i as f64 + 0.5) * STEP_S - delay_s;
            while let Some(command) = commands.get(next).filter(|command| command.t_s <= t_s) {
                if let Action::Pedals { steering, .. } = command.action {
                    given_rad = steering * full_rad;
                }
                next += 1;
            }
            angle_rad += follows * (given_rad - angle_rad);
            sum += STEP_S * angle_rad;
            sums.push(sum);
        }
        Self { from_s, sums }
    }

    /// The mean angle of a window.
    fn over(&self, from_s: f64) -> f64 {
        let at = |t_s: f64| {
            let step = ((t_s - self.from_s) / STEP_S).round().clamp(0.0, self.sums.len() as f64 - 1.0);
            self.sums[step as usize]
        };
        (at(from_s + WINDOW_S) - at(from_s)) / WINDOW_S
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Log, TruePose, Truth};
    use asami_math::angle::wrap_rad;
    use asami_math::elementary::{sin, sin_cos, tan};

    use super::*;

    /// A car whose wheels stand 0.004 rad to the left of 0.85 times what they are told, 0.25 s later than its own lag, and that
    /// rolls where they point.
    fn log(car: &CarConfig) -> Dataset {
        let body = Blueprint::shipped(car.body).unwrap();
        let command = |i: i32| {
            let t_s = 0.04 * f64::from(i);
            let steering = 0.03 * sin(0.31 * t_s) + 0.02 * sin(1.3 * t_s);
            Command { t_s, action: Action::Pedals { throttle: 0.1, brake: 0.0, steering } }
        };
        let commands: Vec<Command> = (0..5000).map(command).collect();
        let (mut angle_rad, mut track) = (0.0, Vec::new());
        let mut pose = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        for i in 0..20_000 {
            track.push(pose);
            let t_s = 0.01 * f64::from(i);
            let told_s = t_s + 0.005 - car.steering.delay_s;
            let told = commands[..].partition_point(|it| it.t_s <= told_s).checked_sub(1);
            let given = told.map_or(0.0, |i| match commands[i].action {
                Action::Pedals { steering, .. } => steering * body.steering_rad,
                _ => 0.0,
            });
            angle_rad += (1.0 - exp(-0.01 / (car.steering.lag_s + 0.25))) * (given - angle_rad);
            let turned = 0.01 * 15.0 * tan(0.004 + 0.85 * angle_rad) / body.wheelbase_m();
            let (sin, cos) = sin_cos(pose.theta_rad + 0.5 * turned);
            (pose.x_m, pose.y_m) = (pose.x_m - 0.15 * sin, pose.y_m + 0.15 * cos);
            (pose.t_s, pose.theta_rad) = (t_s + 0.01, wrap_rad(pose.theta_rad + turned));
        }
        let log = Log { commands: commands.into(), ..Log::default() };
        Dataset { log, truth: Truth { track: track.into(), survey: None }, provenance: None }
    }

    #[test]
    fn what_was_put_in_is_shown() {
        let car = CarConfig::default();
        let found = of_car(&log(&car), &car);
        let near = |name: &str, expected: f64, tolerance: f64| {
            let value = found.values[name];
            assert!((value - expected).abs() < tolerance, "{name}: {value}, not {expected}");
        };
        near("steering_offset.offset_rad", 0.004, 5e-5);
        near("steering_ratio.ratio", 0.85, 0.005);
        near("steering_lag.lag_s", 0.25, 0.015);
        assert!(found.shares[0].0 == "steering offset" && found.shares[0].1 > 0.5, "{:?}", found.shares);
    }

    #[test]
    fn a_log_without_truth_shows_nothing() {
        let car = CarConfig::default();
        let blind = Dataset { truth: Truth::default(), ..log(&car) };
        assert_eq!(of_car(&blind, &car), Capture::default());
    }
}
