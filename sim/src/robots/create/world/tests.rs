use asami_dataset::{Dataset, Sighting};
use asami_math::elementary::{hypot, tan};

use super::*;
use crate::scenes::field::{Colour, Cylinder, Landmark};
use crate::world::{Drive, Seen, run};

/// One command for good.
struct Always(Action);

impl Drive for Always {
    fn act(&mut self, _t_s: f64, _seen: &Seen) -> Action {
        self.0
    }
}

/// A tenth of a second of turning from each whole second on.
struct NowAndThen;

impl Drive for NowAndThen {
    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let omega_rad_per_s = if (t_s + 1e-6).fract() < 0.1 { 0.4 } else { 0.0 };
        Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s }
    }
}

/// As fast as that, but for so long of a rest after four seconds.
struct StandsOnce {
    stands_s: f64,
    omega_rad_per_s: f64,
}

impl Drive for StandsOnce {
    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let stands = (4.0..4.0 + self.stands_s - 1e-6).contains(&(t_s + 1e-6));
        let [v_m_per_s, omega_rad_per_s] = if stands { [0.0; 2] } else { [0.2, self.omega_rad_per_s] };
        Action::Wheels { id: None, v_m_per_s, omega_rad_per_s }
    }
}

/// Without chance.
fn exact() -> CreateConfig {
    let mut config = CreateConfig::default();
    config.wheels.jitter_m_per_s = 0.0;
    config.sight.sigma1_m = 0.0;
    config.sight.sigma2_rad = 0.0;
    config.sight.recognised = 1.0;
    config
}

fn drive(config: &CreateConfig, effects: &Effects, [v_m_per_s, omega_rad_per_s]: [f64; 2], until_s: f64) -> Dataset {
    drive_by(config, effects, &mut Always(Action::Wheels { id: None, v_m_per_s, omega_rad_per_s }), until_s)
}

fn drive_by(config: &CreateConfig, effects: &Effects, by: &mut impl Drive, until_s: f64) -> Dataset {
    let bands = [Colour::Pink, Colour::Yellow];
    let body = Cylinder { x_m: 0.0, y_m: 5.0, radius_m: 0.05, base_m: 0.0, height_m: 0.2, bands };
    let field = Field { beacons: vec![Landmark { id: 6, body }], clutter: Vec::new() };
    let start = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
    let mut world = CreateWorld::new(config, &field, effects, start, Seed(1000)).unwrap();
    run(&mut world, by, until_s)
}

fn effects(of: &[(&str, &str, f64)]) -> Effects {
    let mut effects = Effects::default();
    assert!(of.iter().all(|(name, parameter, value)| effects.set(name, parameter, *value)));
    effects
}

/// Mean velocities from 2 s on: rightward, forward, turning.
fn velocity(log: &Dataset) -> [f64; 3] {
    let track: Vec<&TruePose> = log.truth.track.iter().filter(|pose| pose.t_s > 2.0).collect();
    let (mut sum, mut t_s) = ([0.0; 3], 0.0);
    for pair in track.windows(2) {
        let (dx, dy) = (pair[1].x_m - pair[0].x_m, pair[1].y_m - pair[0].y_m);
        let turned = wrap_rad(pair[1].theta_rad - pair[0].theta_rad);
        let (sin, cos) = asami_math::elementary::sin_cos(pair[0].theta_rad + 0.5 * turned);
        for (sum, moved) in sum.iter_mut().zip([dx * cos + dy * sin, dy * cos - dx * sin, turned]) {
            *sum += moved;
        }
        t_s += pair[1].t_s - pair[0].t_s;
    }
    sum.map(|it| it / t_s)
}

/// Rolling wheels make of commands what a differential drive does (Borenstein and Feng 1996), whatever the speed.
#[test]
fn the_robot_does_as_it_is_told() {
    for [v, omega] in [[0.3, 0.0], [0.1, 0.0], [-0.2, 0.0], [0.0, 0.8], [0.0, -0.4], [0.25, 0.5], [0.2, -0.6]] {
        let [right, forward, turn] = velocity(&drive(&exact(), &Effects::default(), [v, omega], 8.0));
        assert!(right.abs() < 5e-4, "{v} {omega}: slides sideways at {right}");
        assert!((forward - v).abs() < 5e-4 + 2e-3 * v.abs(), "{v} {omega}: {forward}");
        assert!((turn - omega).abs() < 1e-3 + 3e-3 * omega.abs(), "{v} {omega}: {turn}");
    }
}

#[test]
fn the_robot_weighs_what_its_urdf_says_and_stands_still() {
    let log = drive(&exact(), &Effects::default(), [0.0, 0.0], 10.0);
    let last = log.truth.track.last().unwrap();
    assert!(hypot(last.x_m, last.y_m) < 1e-3 && last.theta_rad.abs() < 1e-3, "{last:?}");
    let start = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
    let world = CreateWorld::new(&exact(), &Field::default(), &Effects::default(), start, Seed(1)).unwrap();
    assert!((world.body().mass_kg() - 4.1).abs() < 1e-4, "{}", world.body().mass_kg());
}

/// No wheel is faster than its motor: of a command for more, the turn is lost.
#[test]
fn a_command_beyond_the_wheels_limit_is_cut() {
    let [_, forward, _] = velocity(&drive(&exact(), &Effects::default(), [0.8, 0.0], 6.0));
    assert!((forward - 0.5).abs() < 5e-3, "{forward}");
}

/// A larger right wheel is faster: the robot bends to the left by the difference of the speeds over the base.
#[test]
fn unequal_wheels_make_an_arc_of_a_straight_line() {
    let [_, forward, turn] =
        velocity(&drive(&exact(), &effects(&[("unequal_wheels", "ratio", 1.02)]), [0.3, 0.0], 8.0));
    assert!((forward - 0.3).abs() < 3e-3, "{forward}");
    let expected = 0.3 * 0.02 / 1.01 / 0.258;
    assert!((turn - expected).abs() < 0.05 * expected, "{turn} {expected}");
}

/// Wheels farther apart than thought turn the robot less, and leave straight lines alone.
#[test]
fn a_wider_base_turns_less() {
    let wide = effects(&[("wheel_base", "ratio", 1.1)]);
    let [_, _, turn] = velocity(&drive(&exact(), &wide, [0.0, 0.5], 8.0));
    assert!((turn - 0.5 / 1.1).abs() < 0.01, "{turn}");
    let [_, forward, turn] = velocity(&drive(&exact(), &wide, [0.3, 0.0], 8.0));
    assert!((forward - 0.3).abs() < 3e-3 && turn.abs() < 2e-3, "{forward} {turn}");
}

/// After a rest the robot's speed comes later by as long as it is said to, but by no more than it was told to stand: it gets less far by that
/// much, half of its speed is there that much later, and it turns as it did.
#[test]
fn a_robot_that_starts_late_gets_less_far() {
    let driven = |[stands_s, omega_rad_per_s]: [f64; 2], start_s: f64| {
        let late = effects(&[("late_start", "start_s", start_s)]);
        drive_by(&exact(), &late, &mut StandsOnce { stands_s, omega_rad_per_s }, 8.0).truth.track
    };
    for (stands_s, start_s, later_s) in [(1.0, 0.1, 0.1), (1.0, 0.3, 0.3), (0.1, 0.3, 0.1)] {
        let [now_m, late_m] = [0.0, start_s].map(|start_s| driven([stands_s, 0.0], start_s).last().unwrap().y_m);
        assert!((now_m - late_m - 0.2 * later_s).abs() < 5e-3, "{stands_s} {start_s}: {now_m} {late_m}");
    }
    let [now_s, late_s] = [0.0, 0.3].map(|start_s| {
        let track = driven([1.0, 0.0], start_s);
        let goes = |it: &[TruePose]| it[0].t_s > 4.5 && it[1].y_m - it[0].y_m > 0.1 * (it[1].t_s - it[0].t_s);
        track.windows(2).find(|it| goes(it)).unwrap()[0].t_s
    });
    // The wheels' own servo overshoots a step, and so is 0.02 s nearer to what comes evenly.
    assert!((late_s - now_s - 0.3).abs() < 0.05, "{now_s} {late_s}");
    let [now_rad, late_rad] = [0.0, 0.3].map(|start_s| driven([1.0, 0.1], start_s).last().unwrap().theta_rad);
    // Were it late as well, 0.03 rad would be missed.
    assert!((late_rad - now_rad).abs() < 0.01, "{now_rad} {late_rad}");
}

/// Told the slightest turn the robot goes faster, and turns as it is told; straight on, on the spot and in sharp turns it does what it does.
#[test]
fn a_robot_told_a_slight_turn_is_quicker() {
    let quick = effects(&[("slight_turns", "gain_share", 0.1)]);
    for (told, made) in [([0.3, 0.0], 0.3), ([0.3, 0.005], 0.33), ([0.3, -0.09], 0.33), ([0.3, 0.2], 0.3)] {
        let [_, forward, turn] = velocity(&drive(&exact(), &quick, told, 8.0));
        assert!((forward - made).abs() < 3e-3 && (turn - told[1]).abs() < 3e-3, "{told:?}: {forward} {turn}");
    }
    let [_, forward, turn] = velocity(&drive(&exact(), &quick, [0.0, 0.05], 8.0));
    assert!(forward.abs() < 1e-3 && (turn - 0.05).abs() < 3e-3, "{forward} {turn}");
}

/// Told less than a step on its way the robot turns by a whole one, to the side that is told or, where that is hardly the left, to the right;
/// told none, more, or on the spot it does what it is told.
#[test]
fn a_robot_of_whole_steps_knows_no_slighter_turn() {
    let step = |share: f64| effects(&[("turn_step", "share", share)]);
    for (told, made) in [
        ([0.3, 0.01], 0.0328),
        ([0.3, 0.003], -0.0328),
        ([0.3, -0.02], -0.0328),
        ([0.3, 0.0], 0.0),
        ([0.3, 0.05], 0.05),
        ([0.3, -0.2], -0.2),
        ([0.0, 0.01], 0.01),
    ] {
        let [_, forward, turn] = velocity(&drive(&exact(), &step(1.0), told, 8.0));
        assert!((turn - made).abs() < 2e-3 && (forward - told[0]).abs() < 3e-3, "{told:?}: {forward} {turn}");
    }
    let [_, _, turn] = velocity(&drive(&exact(), &step(0.5), [0.3, 0.01], 8.0));
    assert!((turn - 0.0214).abs() < 2e-3, "{turn}");
}

/// Curves tighten: the way round is shorter, and the turn is whole. On the spot and straight on nothing is lost; at worst all is.
#[test]
fn a_robot_that_slows_down_in_turns_drives_tighter_circles() {
    let slows = |loss_s2: f64, command: [f64; 2]| {
        velocity(&drive(&exact(), &effects(&[("turn_slowing", "loss_s2", loss_s2)]), command, 8.0))
    };
    let [_, forward, turn] = slows(2.8, [0.2, 0.4]);
    let radius_m = 0.2 / 0.4 * (1.0 - 2.8 * 0.16);
    assert!((forward / turn - radius_m).abs() < 0.01 * radius_m && (turn - 0.4).abs() < 2e-3, "{forward} {turn}");
    for command in [[0.2, 0.0], [0.0, 0.4]] {
        let [_, forward, turn] = slows(2.8, command);
        assert!((forward - command[0]).abs() < 1e-3 && (turn - command[1]).abs() < 2e-3, "{forward} {turn}");
    }
    let [_, forward, _] = slows(20.0, [0.2, 0.6]);
    assert!(forward.abs() < 1e-3, "{forward}");
}

/// From rest, a time constant later 1 - 1/e of the speed is there.
#[test]
fn a_lag_takes_its_time() {
    let speed_at = |lag_s: f64, t_s: f64| {
        let log = drive(&exact(), &effects(&[("wheel_lag", "lag_s", lag_s)]), [0.3, 0.0], 3.0);
        let at = |t_s: f64| log.truth.track.iter().find(|pose| pose.t_s >= t_s - 1e-9).unwrap().y_m;
        (at(t_s + 0.04) - at(t_s - 0.04)) / 0.08
    };
    let (lag_s, own_s) = (0.4, CreateConfig::default().wheels.lag_s);
    let share = speed_at(lag_s, lag_s + own_s) / 0.3;
    assert!((share - 0.632).abs() < 0.05, "{share}");
}

/// On a slope of ice wheels hold nothing.
#[test]
fn without_grip_the_robot_slides_downhill() {
    let ice = effects(&[("ground_friction", "ratio", 0.1), ("slope", "pitch_rad", 0.14)]);
    let slid = drive(&exact(), &ice, [0.0, 0.0], 4.0);
    let grips = drive(&exact(), &effects(&[("slope", "pitch_rad", 0.14)]), [0.0, 0.0], 4.0);
    let down_m = |log: &Dataset| -log.truth.track.last().unwrap().y_m;
    assert!(down_m(&slid) > 0.5 && down_m(&grips).abs() < 0.1, "{} {}", down_m(&slid), down_m(&grips));
}

fn last(log: &Dataset) -> Sighting {
    *log.log.sightings.last().unwrap()
}

/// What is reported is where the landmark is from the sensor; each effect of the sensor in its own way.
#[test]
fn ranges_and_bearings_are_the_sensors() {
    let mut config = exact();
    config.sight.ahead_m = 0.2;
    config.sight.view_rad = 2.0;
    let turned = [0.0, 0.1];
    let nominal = drive(&config, &Effects::default(), turned, 6.0);
    let (pose, seen) = (nominal.truth.track.last().unwrap(), last(&nominal));
    let (sin, cos) = asami_math::elementary::sin_cos(pose.theta_rad);
    let (right_m, ahead_m) = (0.0 - pose.x_m + 0.2 * sin, 5.0 - pose.y_m - 0.2 * cos);
    let (range_m, bearing_rad) = (hypot(right_m, ahead_m), wrap_rad(atan2(-right_m, ahead_m) - pose.theta_rad));
    assert!((seen.size.value() - range_m).abs() < 1e-9 && (seen.bearing_rad - bearing_rad).abs() < 1e-9);
    assert!(bearing_rad < -0.4, "a bearing at which range and depth differ: {bearing_rad}");

    let with = |name, parameter, value| last(&drive(&config, &effects(&[(name, parameter, value)]), turned, 6.0));
    let depth = with("depth_for_range", "share", 1.0).size.value();
    assert!((depth - range_m * asami_math::elementary::cos(bearing_rad)).abs() < 1e-9);
    // A longer lens shows a landmark nearer, but no nearer to the axis: only its depth changes.
    let longer = effects(&[("focal_error", "ratio", 1.1), ("depth_for_range", "share", 1.0)]);
    let longer = last(&drive(&config, &longer, turned, 6.0));
    let aside_m = longer.size.value() * tan(longer.bearing_rad);
    assert!((longer.size.value() - depth / 1.1).abs() < 1e-9 && (aside_m - depth * tan(bearing_rad)).abs() < 1e-9);
    // Of depths, along an axis that is turned.
    let turned_axis = effects(&[("range_skew", "share", -0.04), ("depth_for_range", "share", 1.0)]);
    let along_m = range_m * asami_math::elementary::cos(bearing_rad + 0.04);
    let skewed = last(&drive(&config, &turned_axis, turned, 6.0));
    assert!((skewed.size.value() / along_m - 1.0).abs() < 1e-3 && (depth / along_m - 1.0).abs() > 0.01);
    assert!((with("range_scale", "ratio", 1.05).size.value() - 1.05 * range_m).abs() < 1e-9);
    assert!((with("range_offset", "offset_m", -0.1).size.value() - (range_m - 0.1)).abs() < 1e-9);
    assert!((with("pan_offset", "offset_rad", 0.1).bearing_rad - (bearing_rad + 0.1)).abs() < 1e-9);
    // The robot turned to the left by 0.1 rad/s: what is seen late is seen from farther right, farther to the left.
    let late = with("image_delay", "delay_s", 0.25).bearing_rad;
    assert!((late - (bearing_rad + 0.025)).abs() < 3e-3, "{late} {bearing_rad}");
    // A camera has no mirror, and a scanner no lens.
    let effect = |name, parameter, value| effects(&[(name, parameter, value)]);
    let of_mirrors = [effect("encoder_eccentricity", "share", 0.1), effect("bearing_scale", "ratio", 1.1)];
    let of_lenses = [effect("focal_error", "ratio", 1.1), effect("lens_distortion", "radial", -0.2)];
    let by = |config: &CreateConfig, effects: &Effects| last(&drive(config, effects, turned, 6.0));
    assert!(of_mirrors.iter().all(|it| by(&config, it) == seen) && of_lenses.iter().all(|it| by(&config, it) != seen));
    config.sight.view_rad = 4.0;
    assert!(of_lenses.iter().all(|it| by(&config, it) == seen));
    let bent_rad = [0.1 * (1.0 - asami_math::elementary::cos(bearing_rad)), 0.1 * bearing_rad];
    for (effects, bent_rad) in of_mirrors.iter().zip(bent_rad) {
        let read = by(&config, effects);
        assert!((read.bearing_rad - (bearing_rad + bent_rad)).abs() < 1e-9 && read.size == seen.size);
    }
}

/// While the robot turns, frames a tenth of a second apart and pictures 0.08 s apart show a landmark by turns where it is, and where it
/// was 0.02, 0.04 and 0.06 s before; at rest nothing changes.
#[test]
fn pictures_are_as_old_as_frames_and_they_fall_apart() {
    let bearings = |period_s: f64, omega_rad_per_s: f64| -> Vec<f64> {
        let mut config = exact();
        config.sight.view_rad = 6.0;
        let log =
            drive(&config, &effects(&[("stale_pictures", "period_s", period_s)]), [0.0, omega_rad_per_s], 6.0).log;
        log.sightings.iter().filter(|it| it.t_s > 3.0).map(|it| it.bearing_rad).collect()
    };
    let mut seen = [0; 4];
    for (stale, fresh) in bearings(0.08, 0.4).iter().zip(bearings(0.0, 0.4)) {
        let age = wrap_rad(stale - fresh) / (0.4 * 0.02);
        assert!((age - age.round()).abs() < 0.05, "{age}");
        seen[age.round() as usize] += 1;
    }
    assert!(seen.iter().all(|it| *it >= 7), "{seen:?}");
    assert!(bearings(0.08, 0.0).iter().zip(bearings(0.0, 0.0)).all(|(stale, fresh)| (stale - fresh).abs() < 1e-9));
}

/// Straight on, and in a turn on the spot, tyres turn at multiples of a step; what is told less than half of one rests.
#[test]
fn wheels_turn_at_multiples_of_a_step() {
    let stepped = effects(&[("speed_steps", "step_m_per_s", 0.01)]);
    let of = |told: [f64; 2]| {
        let track = drive(&exact(), &stepped, told, 8.0).truth.track;
        let [a, b] = [3.0, 7.0].map(|t_s| track[track.partition_point(|it| it.t_s < t_s)]);
        let s = b.t_s - a.t_s;
        [hypot(b.x_m - a.x_m, b.y_m - a.y_m) / s, wrap_rad(b.theta_rad - a.theta_rad) / s]
    };
    for (told, made) in [(0.064, 0.06), (0.066, 0.07), (0.021, 0.02), (0.004, 0.0), (-0.016, 0.02)] {
        let [v, omega] = of([told, 0.0]);
        assert!((v - made).abs() < 1e-3 && omega.abs() < 2e-3, "{told}: {v} m/s, {omega} rad/s");
    }
    let base_m = Blueprint::shipped().unwrap().base_m();
    let [_, omega] = of([0.0, 0.3]);
    // 0.0387 m/s are told at either side.
    assert!((omega - 0.08 / base_m).abs() < 0.01, "{omega}");
}

/// By software that looks for commands every 0.22 s a robot that is told to turn for a tenth of a second turns for 0.22 s where a look
/// falls into that, and else not at all; by software that always looks, for a tenth.
#[test]
fn a_turn_lasts_a_whole_cycle_or_none_of_it() {
    let turned_rad = |effects: &Effects| -> Vec<f64> {
        let track = drive_by(&exact(), effects, &mut NowAndThen, 10.0).truth.track;
        let heading_rad = |t_s: f64| track[track.partition_point(|it| it.t_s < t_s)].theta_rad;
        (1..9).map(f64::from).map(|t_s| wrap_rad(heading_rad(t_s + 0.9) - heading_rad(t_s - 0.1))).collect()
    };
    let prompt = turned_rad(&Effects::default());
    let whole = turned_rad(&effects(&[("command_cycle", "period_s", 0.22)]));
    let falls_into =
        |second: f64| (0..50).map(|look| 0.22 * f64::from(look)).any(|it| (second..second + 0.1).contains(&it));
    let expected: Vec<f64> = (1..9).map(|second| if falls_into(f64::from(second)) { 0.088 } else { 0.0 }).collect();
    assert!(prompt.iter().all(|it| (it - 0.04).abs() < 0.004), "{prompt:?}");
    assert!(whole.iter().zip(&expected).all(|(it, expected)| (it - expected).abs() < 0.006), "{whole:?} {expected:?}");
    assert!(expected.iter().filter(|it| **it > 0.0).count() == 3);
}

/// What a range is off lasts as long as it is told to: of a robot at rest ranges hang on those before by the share that lasts, and
/// less and less (Yule 1927). Of 1200 fadings the standard error is 0.04.
#[test]
fn what_ranges_are_off_lasts() {
    let correlated = |lasting_share: f64| {
        let mut config = exact();
        config.sight.sigma1_m = 0.1;
        (config.sight.lasting_share, config.sight.fades_s) = (lasting_share, 0.5);
        let log = drive(&config, &Effects::default(), [0.0, 0.0], 600.0).log;
        let off: Vec<f64> = log.sightings.iter().map(|it| (it.size.value() - 5.0) / 0.1).collect();
        let frame_s = log.sightings[1].t_s - log.sightings[0].t_s;
        let at = |s: f64| {
            let lag = (s / frame_s).round() as usize;
            let pairs = off.iter().zip(&off[lag..]);
            pairs.map(|(a, b)| a * b).sum::<f64>() / (off.len() - lag) as f64
        };
        [at(0.0), at(0.5), at(1.5)]
    };
    for share in [0.0, 0.8] {
        let e = std::f64::consts::E;
        let found = correlated(share);
        for (found, wanted) in found.into_iter().zip([1.0, share / e, share / (e * e * e)]) {
            assert!((found - wanted).abs() < 0.15, "{share}: {found} {wanted}");
        }
    }
}
