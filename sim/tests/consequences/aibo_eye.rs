//! What ails the Aibo's camera, neck and vision, and what stands elsewhere than it thinks.

use asami_dataset::truth::pose_at;
use asami_dataset::{Action, Dataset, Seed};
use asami_math::angle::wrap_rad;
use asami_sim::drives::hold::Hold;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, Start};
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::world::run;

use super::aibo_body::effects;

/// A robot on an even floor that turns to nothing.
fn config() -> AiboConfig {
    let mut config = AiboConfig::default();
    config.disturbance.friction_log_sd = 0.0;
    config.heading_hold.gain_per_s = 0.0;
    config
}

/// The same with a head that scans.
fn scanning() -> AiboConfig {
    let mut config = config();
    config.head.scan_amplitude_rad = 0.65;
    config
}

/// One beacon in the origin; the robot stands `distance_m` before it.
fn field() -> Field {
    let bands = [Colour::Pink, Colour::Yellow];
    let body = Cylinder { x_m: 0.0, y_m: 0.0, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands };
    Field { beacons: vec![Landmark { id: 0, body }], clutter: Vec::new() }
}

fn before(distance_m: f64) -> Start {
    Start { y_m: -distance_m, ..Start::default() }
}

fn log(config: &AiboConfig, effects: &Effects, start: Start, [forward, turn]: [f64; 2], until_s: f64) -> Dataset {
    let camera = CameraConfig { frame_rate_hz: 30.0, ..CameraConfig::default() };
    let mut world = AiboWorld::new(config, &field(), &camera, effects, start, Seed(1000)).expect("the shipped robot");
    let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: forward, atheta_rad_per_s: turn };
    run(&mut world, &mut Hold(action), until_s)
}

fn stood(config: &AiboConfig, effects: &Effects, distance_m: f64) -> Dataset {
    log(config, effects, before(distance_m), [0.0; 2], 2.5)
}

fn heights_px(dataset: &Dataset) -> Vec<f64> {
    dataset.log.sightings.iter().map(|sighting| sighting.size.value()).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn sd(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Of every sighting: how far left of the head's direction the beacon truly was, its height, and by how much its
/// bearing is off.
fn sights(dataset: &Dataset) -> Vec<[f64; 3]> {
    let frames = dataset.log.frames.as_deref().unwrap_or_default();
    let sight = |sighting: &asami_dataset::Sighting| {
        let pose = pose_at(&dataset.truth.track, sighting.t_s)?;
        let true_rad = wrap_rad(pose.x_m.atan2(-pose.y_m) - pose.theta_rad);
        let pan_rad = frames.iter().find(|frame| frame.t_s == sighting.t_s)?.head_pan_rad;
        Some([wrap_rad(true_rad - pan_rad), sighting.size.value(), wrap_rad(sighting.bearing_rad - true_rad)])
    };
    dataset.log.sightings.iter().filter_map(sight).collect()
}

/// Slope of the straight line of least squares.
fn slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let (xs, ys): (Vec<f64>, Vec<f64>) = points.unzip();
    let (x, y) = (mean(&xs), mean(&ys));
    let across: f64 = xs.iter().zip(&ys).map(|(a, b)| (a - x) * (b - y)).sum();
    across / xs.iter().map(|a| (a - x) * (a - x)).sum::<f64>()
}

/// A longer lens puts what is off the axis farther out than the vision thinks: bearings are off to the left on the left
/// and to the right on the right, and there is less in view.
#[test]
fn a_longer_lens_stretches_bearings_about_the_heads_direction() {
    let stretch = |ratio| {
        let dataset = stood(&scanning(), &effects(&[("focal_error", "ratio", ratio)]), 2.0);
        let sights = sights(&dataset);
        (slope(sights.iter().map(|[off, _, error]| (*off, *error))), sights.len())
    };
    let ((nominal, seen), (long, fewer), (short, more)) = (stretch(1.0), stretch(1.15), stretch(0.85));
    // d atan(ratio tan(off)) / d off at the middle, and a little less farther out.
    assert!((long - nominal - 0.15).abs() < 0.04 && (short - nominal + 0.15).abs() < 0.04, "{nominal} {long} {short}");
    assert!(fewer < seen && seen < more, "{fewer} sightings through a long lens, {seen}, {more} through a short one");
}

/// In a barrel the beacon shrinks towards the image's border; the vision makes up for a flat image only.
#[test]
fn a_barrel_shrinks_what_is_off_the_axis() {
    let ratio = |radial| {
        let dataset = stood(&scanning(), &effects(&[("lens_distortion", "radial", radial)]), 1.5);
        let sights = sights(&dataset);
        let of = |near: bool| -> Vec<f64> {
            let wanted = sights.iter().filter(|[off, ..]| if near { off.abs() < 0.1 } else { off.abs() > 0.35 });
            wanted.map(|[_, height_px, _]| *height_px).collect()
        };
        mean(&of(false)) / mean(&of(true))
    };
    let (barrel, flat, pincushion) = (ratio(-0.4), ratio(0.0), ratio(0.4));
    assert!((flat - 1.0).abs() < 0.03, "{flat}");
    assert!(barrel < flat - 0.03 && flat + 0.03 < pincushion, "{barrel} {flat} {pincushion}");
}

/// A near beacon fills the image's middle from top to bottom and is cut off by the border; a far one is not.
#[test]
fn a_camera_that_looks_up_cuts_off_near_beacons() {
    let seen = |pitch_rad, distance_m| {
        heights_px(&stood(&config(), &effects(&[("camera_pitch", "pitch_rad", pitch_rad)]), distance_m)).len()
    };
    let ([near, far], [near_up, far_up]) = ([0.75, 3.5].map(|at| seen(0.0, at)), [0.75, 3.5].map(|at| seen(0.34, at)));
    assert!(near > 60 && far > 60, "{near} and {far} sightings of a level camera");
    assert!(near_up == 0 && far_up > 60, "{near_up} near and {far_up} far ones of a raised camera");
}

/// The heading hold trusts the encoder: the robot believes that it faces the beacon, and walks past it.
#[test]
fn a_pan_offset_leads_the_robot_past_its_beacon() {
    let mut config = config();
    config.heading_hold.gain_per_s = 1.5;
    let dataset = log(&config, &effects(&[("pan_offset", "offset_rad", 0.2)]), before(3.0), [0.15, 0.0], 8.0);
    let late = |t_s: f64| t_s > 3.0;
    let reported: Vec<f64> = dataset.log.sightings.iter().filter(|it| late(it.t_s)).map(|it| it.bearing_rad).collect();
    let truly = dataset.truth.track.iter().filter(|pose| late(pose.t_s));
    let truly: Vec<f64> = truly.map(|pose| wrap_rad(pose.x_m.atan2(-pose.y_m) - pose.theta_rad)).collect();
    assert!(mean(&reported).abs() < 0.06, "it believes to see the beacon at {}", mean(&reported));
    assert!((mean(&truly) + 0.2).abs() < 0.06, "the beacon is at {}", mean(&truly));
}

/// Where the beacon was a moment ago, seen from a robot that has turned on since.
#[test]
fn a_late_image_of_a_turning_robot_shifts_bearings_by_rate_times_delay() {
    let delay_s = 0.1;
    let mean_error = |delay_s: f64, rate_rad_per_s: f64| {
        let start = Start { theta_rad: -0.3 * rate_rad_per_s.signum(), ..before(2.0) };
        let late = effects(&[("image_delay", "delay_s", delay_s)]);
        let dataset = log(&config(), &late, start, [0.0, rate_rad_per_s], 1.2);
        let errors: Vec<f64> = sights(&dataset).iter().skip(8).map(|[_, _, error]| *error).collect();
        let track = &dataset.truth.track;
        let pose = |t_s| pose_at(track, t_s).map_or(f64::NAN, |pose| pose.theta_rad);
        [mean(&errors), wrap_rad(pose(1.15) - pose(0.3)) / 0.85]
    };
    let shift = |rate| {
        let ([late, turned], [prompt, _]) = (mean_error(delay_s, rate), mean_error(0.0, rate));
        [late - prompt, turned]
    };
    for rate in [0.6, -0.6] {
        let [shift_rad, turned_rad_per_s] = shift(rate);
        let measured_s = shift_rad / turned_rad_per_s;
        assert!((measured_s - delay_s).abs() < 0.03, "{measured_s} s at {turned_rad_per_s} rad/s");
    }
}

/// Out of pixels come as many pixels as the rims have bloomed, near and far, on the average over a walk.
#[test]
fn blooming_adds_the_same_to_small_and_to_large_images() {
    let mean_px = |bias_px, at| {
        let bloom = effects(&[("height_bias", "bias_px", bias_px)]);
        mean(&heights_px(&log(&config(), &bloom, before(at), [0.15, 0.0], 3.0)))
    };
    for at in [1.6, 3.6] {
        let nominal_px = mean_px(0.0, at);
        for bias_px in [-1.0, 2.0] {
            let more_px = mean_px(bias_px, at) - nominal_px;
            assert!((more_px - bias_px).abs() < 0.25, "{more_px} px for {bias_px} px from {at} m");
        }
    }
}

#[test]
fn noisy_pixels_make_heights_noisy_and_hide_beacons() {
    let of = |ratio| heights_px(&stood(&config(), &effects(&[("vision_noise", "ratio", ratio)]), 1.5));
    let (clear, noisy) = (of(0.5), of(4.0));
    assert!(sd(&noisy) > 1.5 * sd(&clear), "{} px, {} px in clear light", sd(&noisy), sd(&clear));
    let far = |ratio| heights_px(&stood(&config(), &effects(&[("vision_noise", "ratio", ratio)]), 3.5)).len();
    assert!(far(4.0) < far(0.5), "{} of {} sightings", far(4.0), far(0.5));
}

/// The robot turns to where the beacon stands, not to where it thinks it does.
#[test]
fn a_robot_walks_to_where_its_beacon_stands() {
    let mut config = config();
    config.heading_hold.gain_per_s = 1.5;
    let moved = effects(&[
        ("landmark_moved", "distance_m", 0.6),
        ("landmark_moved", "towards_rad", -std::f64::consts::FRAC_PI_2),
    ]);
    let dataset = log(&config, &moved, before(2.5), [0.2, 0.0], 9.0);
    let (Some(first), Some(last)) = (dataset.truth.track.first(), dataset.truth.track.last()) else { panic!("empty") };
    // On the straight line from (0, -2.5) to (0.6, 0).
    let wanted_m = 0.6 * (last.y_m - first.y_m) / 2.5;
    assert!(last.y_m > -1.5 && (last.x_m - wanted_m).abs() < 0.1, "{last:?}, not {wanted_m} m to the right");
    assert_eq!((dataset.log.known.landmarks[0].x_m, dataset.log.known.landmarks[0].y_m), (0.0, 0.0));
}
