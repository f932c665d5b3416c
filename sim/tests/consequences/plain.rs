//! What ails the plain robot.

use asami_dataset::{Action, Dataset, Seed, Sighting, TruePose};
use asami_math::angle::wrap_rad;
use asami_sim::drives::hold::Hold;
use asami_sim::drives::suite::Suite;
use asami_sim::effects::Effects;
use asami_sim::robots::plain::{PlainConfig, PlainWorld};
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::world::{Drive, Seen, run};

use super::aibo_body::effects;

/// A robot that does what it is told, without noise, and sees everything in range.
fn exact() -> PlainConfig {
    let mut config = PlainConfig::default();
    let (motion, distortion, sight) = (&mut config.motion, &mut config.distortion, &mut config.sight);
    (motion.right_sd_m, motion.forward_sd_m, motion.turn_sd_rad) = (0.0, 0.0, 0.0);
    (distortion.leak_sd, distortion.bias_sd, distortion.irregular_sd) = (0.0, 0.0, 0.0);
    (sight.sigma1_px, sight.sigma2_rad, sight.recognised) = (0.0, 0.0, 1.0);
    (sight.near_m, sight.far_m) = (0.5, 20.0);
    config
}

/// Four beacons about a field of 3.6 m x 5.4 m.
const PLACES_M: [[f64; 2]; 4] = [[1.95, 1.35], [-1.95, 1.35], [-1.95, -1.35], [1.95, -1.35]];

fn log(config: &PlainConfig, effects: &Effects, drive: &mut dyn Drive, until_s: f64) -> Dataset {
    let beacons = (0..).zip(PLACES_M).map(|(id, [x_m, y_m])| Landmark {
        id,
        body: Cylinder { x_m, y_m, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands: [Colour::Pink, Colour::Blue] },
    });
    let field = Field { beacons: beacons.collect(), clutter: Vec::new() };
    let start = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
    run(&mut PlainWorld::new(config, &Suite::default(), &field, effects, start, Seed(1000)), drive, until_s)
}

fn legs([right, forward, turn]: [f64; 3]) -> Action {
    Action::Legs { id: None, ax_m_per_s: right, ay_m_per_s: forward, atheta_rad_per_s: turn }
}

/// Speeds of a walk straight on, at its beginning and over the last second of ten.
fn speeds_m_per_s(effects: &Effects, ay_m_per_s: f64) -> [f64; 2] {
    let track = log(&exact(), effects, &mut Hold(legs([0.0, ay_m_per_s, 0.0])), 10.0).truth.track;
    let speed = |from: usize, to: usize| (track[to].y_m - track[from].y_m) / (track[to].t_s - track[from].t_s);
    [speed(0, 1), speed(track.len() - 21, track.len() - 1)]
}

/// Share of the nominal speed at the log's beginning: of a run at the greatest attempt, and of a stroll at a quarter.
fn shares(settings: &[(&str, &str, f64)]) -> [f64; 2] {
    [0.4, 0.1].map(|attempt| speeds_m_per_s(&effects(settings), attempt)[0] / speeds_m_per_s(&effects(&[]), attempt)[0])
}

#[test]
fn what_slows_motors_slows_a_run_more_than_a_stroll() {
    let [run, stroll] = shares(&[("motor_weakness", "ratio", 0.6)]);
    assert!(run < stroll - 0.1 && stroll < 0.97, "{run} of a run, {stroll} of a stroll");
    let [run, stroll] = shares(&[("servo_speed_limit", "ratio", 0.8)]);
    assert!((0.75..0.9).contains(&run) && stroll == 1.0, "{run} of a run, {stroll} of a stroll");
    // What scales the command slows both alike, but for the bend.
    let [run, stroll] = shares(&[("command_scale", "y_ratio", 0.8)]);
    assert!((run - stroll).abs() < 0.03, "{run} of a run, {stroll} of a stroll");
}

#[test]
fn a_battery_sags_while_the_log_lasts() {
    let [first, last] = speeds_m_per_s(&effects(&[("battery_sag", "lost_per_s", 0.01)]), 0.4);
    let [fresh_first, fresh_last] = speeds_m_per_s(&effects(&[]), 0.4);
    assert!((first / fresh_first - 1.0).abs() < 1e-9 && (fresh_last / fresh_first - 1.0).abs() < 1e-9);
    assert!(last < 0.9 * first, "{first} m/s at first, {last} m/s at last");
}

/// Forward, then backward, for a second each.
struct ToAndFro;

impl Drive for ToAndFro {
    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let forward = (t_s + 1e-6).rem_euclid(2.0) < 1.0;
        legs([0.0, if forward { 0.3 } else { -0.3 }, 0.0])
    }
}

/// The way back does not make up for the way up: to and fro, the robot ends up downhill.
#[test]
fn to_and_fro_on_a_slope_ends_downhill() {
    let end = |settings: &[(&str, &str, f64)]| {
        let track = log(&exact(), &effects(settings), &mut ToAndFro, 20.0).truth.track;
        track.last().map(|pose| [pose.x_m, pose.y_m]).unwrap_or_default()
    };
    let [level_x, level_y] = end(&[]);
    assert!(level_x.abs() < 0.01 && level_y.abs() < 0.05, "{level_x} {level_y}");
    let [x_m, y_m] = end(&[("slope", "pitch_rad", 0.05)]);
    assert!(y_m < level_y - 0.2 && (x_m - level_x).abs() < 0.01, "{x_m} {y_m}");
    let [x_m, y_m] = end(&[("slope", "pitch_rad", 0.05), ("slope", "uphill_rad", std::f64::consts::FRAC_PI_2)]);
    assert!(x_m > level_x + 0.2 && (y_m - level_y).abs() < 0.01, "uphill is to the left: {x_m} {y_m}");
}

/// True distance and bearing of a sighting's beacon, as if it stood where it is said to, and the head's pan.
fn geometry(dataset: &Dataset, sighting: &Sighting) -> (f64, f64, f64) {
    let frames = dataset.log.frames.as_deref().unwrap_or_default();
    let at = frames.partition_point(|frame| frame.t_s < sighting.t_s);
    let (pose, [x_m, y_m]) = (dataset.truth.track[at], PLACES_M[usize::from(sighting.landmark)]);
    let (right_m, ahead_m) = (x_m - pose.x_m, y_m - pose.y_m);
    let bearing_rad = wrap_rad((-right_m).atan2(ahead_m) - pose.theta_rad);
    (right_m.hypot(ahead_m), bearing_rad, frames[at].head_pan_rad)
}

fn turning(settings: &[(&str, &str, f64)]) -> Dataset {
    log(&exact(), &effects(settings), &mut Hold(legs([0.0, 0.1, 0.5])), 20.0)
}

/// Slope of the straight line of least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / n, y + point.1 / n));
    let across: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    across / points.iter().map(|point| (point.0 - x) * (point.0 - x)).sum::<f64>()
}

/// Of every sighting: off the head's direction to the left, and by how much the bearing is off.
fn bearing_errors(dataset: &Dataset) -> Vec<(f64, f64)> {
    let of = |sighting: &Sighting| {
        let (_, true_rad, pan_rad) = geometry(dataset, sighting);
        (wrap_rad(true_rad - pan_rad), wrap_rad(sighting.bearing_rad - true_rad))
    };
    dataset.log.sightings.iter().map(of).collect()
}

/// Lenses leave the middle of the image alone and falsify its sides, one way on the left and the other on the right.
#[test]
fn lenses_falsify_bearings_at_the_images_sides() {
    for (settings, sign) in [
        (("focal_error", "ratio", 1.1), 1.0),
        (("focal_error", "ratio", 0.9), -1.0),
        (("lens_distortion", "radial", 0.4), 1.0),
        (("lens_distortion", "radial", -0.4), -1.0),
    ] {
        let errors = bearing_errors(&turning(&[settings]));
        assert!(errors.len() > 200 && sign * slope(&errors) > 0.02, "{settings:?}: {}", slope(&errors));
        let middle = errors.iter().filter(|(off, _)| off.abs() < 0.02).map(|(_, error)| error.abs());
        assert!(middle.fold(0.0, f64::max) < 0.004, "{settings:?}");
    }
}

/// The head turns on while the image is under way: bearings are off by the pan's rate times the delay, and the more the
/// faster it pans.
#[test]
fn a_late_image_falsifies_bearings_by_the_heads_rate() {
    let dataset = turning(&[("image_delay", "delay_s", 0.03)]);
    let frames = dataset.log.frames.clone().unwrap_or_default();
    let errors = bearing_errors(&dataset);
    let points = dataset.log.sightings.iter().zip(&errors).filter_map(|(sighting, (_, error))| {
        let at = frames.partition_point(|frame| frame.t_s < sighting.t_s);
        let pair = frames.get(at.checked_sub(1)?..=at)?;
        Some((wrap_rad(pair[1].head_pan_rad - pair[0].head_pan_rad) / 0.05, *error))
    });
    let measured_s = slope(&points.collect::<Vec<_>>());
    assert!((measured_s - 0.03).abs() < 0.003, "{measured_s} s");
}

/// Head and bearings lie together: only against the map does the robot find out.
#[test]
fn a_pan_offset_turns_the_world_and_leaves_angles_between_landmarks() {
    let mut config = exact();
    config.sight.view_rad = 2.5;
    let log = |settings| log(&config, &effects(settings), &mut Hold(legs([0.0, 0.1, 0.5])), 20.0).log;
    let (true_log, off) = (log(&[]), log(&[("pan_offset", "offset_rad", 0.1)]));
    assert_eq!(true_log.sightings.len(), off.sightings.len());
    let mut together = 0;
    for (pair, off) in true_log.sightings.windows(2).zip(off.sightings.windows(2)) {
        if pair[0].t_s == pair[1].t_s {
            let angle = |pair: &[Sighting]| wrap_rad(pair[1].bearing_rad - pair[0].bearing_rad);
            assert!(wrap_rad(angle(pair) - angle(off)).abs() < 1e-12);
            together += 1;
        }
        assert!((wrap_rad(off[0].bearing_rad - pair[0].bearing_rad) - 0.1).abs() < 1e-12);
    }
    assert!(together > 10, "{together}");
}

/// A constant of the image is none of the world: the farther away a beacon, the more it seems to come nearer.
#[test]
fn blooming_brings_far_beacons_nearer_than_near_ones() {
    let sight = exact().sight;
    let dataset = turning(&[("height_bias", "bias_px", 1.0)]);
    let nearer = dataset.log.sightings.iter().map(|sighting| {
        let (distance_m, ..) = geometry(&dataset, sighting);
        let seems_m = sight.height_px_m / (sighting.size.value() + sight.lost_px) + sight.camera_ahead_m;
        (distance_m, (distance_m - seems_m) / distance_m)
    });
    let nearer: Vec<(f64, f64)> = nearer.collect();
    assert!(nearer.iter().all(|(_, share)| *share > 0.0) && slope(&nearer) > 0.01, "{}", slope(&nearer));
}

/// Twice the noise is four times the variance, of heights and of bearings, and nothing else is drawn anew.
#[test]
fn noise_grows_and_everything_else_stays() {
    let mut config = exact();
    (config.sight.sigma1_px, config.sight.sigma2_rad) = (0.5, 0.1);
    let drive = || Hold(legs([0.0, 0.1, 0.5]));
    let clear = log(&config, &effects(&[]), &mut drive(), 60.0);
    let dim = log(&config, &effects(&[("vision_noise", "ratio", 2.0)]), &mut drive(), 60.0);
    assert!(clear.truth.track == dim.truth.track);
    assert_eq!(clear.log.sightings.len(), dim.log.sightings.len());
    let variance = |dataset: &Dataset| {
        let errors = bearing_errors(dataset);
        errors.iter().map(|(_, error)| error * error).sum::<f64>() / errors.len() as f64
    };
    let ratio = variance(&dim) / variance(&clear);
    assert!((ratio - 4.0).abs() < 1e-6, "{ratio}");
}

#[test]
fn what_is_not_missed_is_seen_as_ever() {
    let share = 0.3;
    let (all, some) = (turning(&[]).log.sightings, turning(&[("missed_sightings", "share", share)]).log.sightings);
    assert!(some.iter().all(|sighting| all.contains(sighting)), "a sighting of its own");
    let (n, kept) = (all.len() as f64, some.len() as f64);
    let sd = (n * share * (1.0 - share)).sqrt();
    assert!((kept - n * (1.0 - share)).abs() < 4.0 * sd, "{kept} of {n}");
}

/// Impostors are in view, but nowhere near where their landmark is to be seen; all the others are seen as ever.
#[test]
fn false_sightings_fit_no_pose() {
    let share = 0.1;
    let (all, mixed) = (turning(&[]), turning(&[("false_sightings", "share", share)]));
    let strange: Vec<&Sighting> =
        mixed.log.sightings.iter().filter(|sighting| !all.log.sightings.contains(sighting)).collect();
    let n = mixed.log.frames.as_deref().unwrap_or_default().len() as f64;
    let sd = (n * share * (1.0 - share)).sqrt();
    assert!((strange.len() as f64 - n * share).abs() < 4.0 * sd, "{} in {n} frames", strange.len());
    let far_off = strange.iter().filter(|sighting| {
        let (distance_m, bearing_rad, pan_rad) = geometry(&mixed, sighting);
        assert!(wrap_rad(sighting.bearing_rad - pan_rad).abs() <= 0.5 * exact().sight.view_rad);
        let wrong_px = sighting.size.value() - 38.3887 / (distance_m - 0.1) + 1.0;
        wrong_px.abs() > 2.0 || wrap_rad(sighting.bearing_rad - bearing_rad).abs() > 0.3
    });
    let far_off = far_off.count();
    assert!(10 * far_off > 8 * strange.len(), "{far_off} of {}", strange.len());
}

/// From where the robot truly is, heights and bearings of one landmark point to its new place, those of the others to
/// the old.
#[test]
fn sightings_point_to_where_a_landmark_stands() {
    let moved = [("landmark_moved", "distance_m", -0.4), ("landmark_moved", "number", 2.0)];
    let dataset = turning(&moved);
    let sight = exact().sight;
    let mut seen = [0; 4];
    for sighting in dataset.log.sightings.iter() {
        let at = dataset.truth.track.partition_point(|pose| pose.t_s < sighting.t_s);
        let pose = dataset.truth.track[at];
        let distance_m = sight.height_px_m / (sighting.size.value() + sight.lost_px) + sight.camera_ahead_m;
        let (sin, cos) = (pose.theta_rad + sighting.bearing_rad).sin_cos();
        let points_to = [pose.x_m - distance_m * sin, pose.y_m + distance_m * cos];
        let which = usize::from(sighting.landmark);
        let [x_m, y_m] = PLACES_M[which];
        let stands = if which == 2 { [x_m, y_m - 0.4] } else { [x_m, y_m] };
        assert!((points_to[0] - stands[0]).hypot(points_to[1] - stands[1]) < 1e-9, "{which}: {points_to:?}");
        let known = dataset.log.known.landmarks[which];
        assert_eq!([known.x_m, known.y_m], PLACES_M[which]);
        seen[which] += 1;
    }
    assert!(seen.iter().all(|times| *times > 10), "{seen:?}");
}
