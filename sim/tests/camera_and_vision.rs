//! What the vision makes of what the camera sees.

use asami_dataset::Seed;
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::sensors::camera::{Camera, CameraConfig};
use asami_sim::sensors::vision::{Glimpse, Neck, Pattern, Vision};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};

const EYE_M: f64 = 0.2;
const NECK: Neck = Neck { axis_ahead_m: 0.1, camera_ahead_m: 0.1 };

fn cylinder(x_m: f64, y_m: f64, bands: [Colour; 2]) -> Cylinder {
    Cylinder { x_m, y_m, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands }
}

fn beacon(y_m: f64) -> Landmark {
    Landmark { id: 3, body: cylinder(0.0, y_m, [Colour::Pink, Colour::Yellow]) }
}

/// The camera over the origin, turned left by `pan_rad`, nose up by `pitch_rad`, right side down by `roll_rad`.
fn camera_pose(pan_rad: f64, pitch_rad: f64, roll_rad: f64) -> Isometry3<f64> {
    // Columns: the camera's right, down and ahead when it looks along world +y.
    let ahead = Rotation3::from_matrix_unchecked(Matrix3::new(1., 0., 0., 0., 0., 1., 0., -1., 0.));
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, pan_rad)
        * UnitQuaternion::from_euler_angles(pitch_rad, 0.0, 0.0)
        * UnitQuaternion::from_euler_angles(0.0, roll_rad, 0.0)
        * UnitQuaternion::from_rotation_matrix(&ahead);
    Isometry3::from_parts(Translation3::new(0.0, 0.0, EYE_M), turn)
}

struct Eye {
    camera: Camera,
    vision: Vision,
}

impl Eye {
    fn on(field: &Field) -> Self {
        Self::with(&CameraConfig::default(), field)
    }

    fn with(config: &CameraConfig, field: &Field) -> Self {
        Self {
            camera: Camera::new(config, field, Seed(1).stream("camera")),
            vision: Vision::new(config, NECK, field.beacons.iter().map(Pattern::from).collect()),
        }
    }

    fn at(&mut self, pose: &Isometry3<f64>) -> Vec<Glimpse> {
        self.moving(pose, pose)
    }

    fn moving(&mut self, open: &Isometry3<f64>, close: &Isometry3<f64>) -> Vec<Glimpse> {
        self.vision.sight(self.camera.look(open, close), 0.0)
    }
}

fn field(beacons: Vec<Landmark>, clutter: Vec<Cylinder>) -> Field {
    Field { beacons, clutter }
}

/// Stronger 2008, section 2.5.1: 38388.7 / d, d in millimetres.
fn expected_px(distance_m: f64) -> f64 {
    38.3887 / distance_m
}

#[test]
fn heights_are_the_focal_length_times_the_beacon_over_the_distance() {
    for step in 0..33 {
        let distance_m = 1.0 + 0.1 * f64::from(step);
        let mut eye = Eye::on(&field(vec![beacon(distance_m)], vec![]));
        let mut sum_px = 0.0;
        const FRAMES: u32 = 40;
        for frame in 0..FRAMES {
            // Quarter pixels and odd ones: the ends come to lie everywhere between two rows.
            let seen = eye.at(&camera_pose(0.0, 0.00137 * f64::from(frame), 0.0));
            let [glimpse] = seen[..] else { panic!("one beacon at {distance_m} m, found {seen:?}") };
            let error_px = glimpse.height_px - expected_px(distance_m);
            // Each end is counted to half a pixel, so off by a quarter on average; noise moves the thresholds.
            assert!(error_px.abs() <= 0.65, "{error_px} px off at {distance_m} m");
            assert!(glimpse.bearing_rad.abs() < 0.003);
            sum_px += error_px;
        }
        let mean_px = sum_px / f64::from(FRAMES);
        // Two ends uniform over half a pixel: sd 0.2 px; four standard errors of the mean.
        assert!(
            mean_px.abs() <= 4.0 * 0.2 / f64::from(FRAMES).sqrt() + 0.05,
            "{mean_px} px off on average at {distance_m} m"
        );
    }
}

#[test]
fn a_tilted_body_changes_the_height_by_less_than_a_pixel() {
    for distance_m in [1.0, 1.7, 2.4, 3.6] {
        let mut eye = Eye::on(&field(vec![beacon(distance_m)], vec![]));
        for (pitch, roll) in [(5f64, 0f64), (-5.0, 0.0), (0.0, 4.0), (3.0, -3.0)] {
            let seen = eye.at(&camera_pose(0.0, pitch.to_radians(), roll.to_radians()));
            assert_eq!(seen.len(), 1, "at {distance_m} m, pitch {pitch}, roll {roll}");
            assert!((seen[0].height_px - expected_px(distance_m)).abs() < 1.0, "{seen:?} at {distance_m} m");
        }
    }
}

#[test]
fn a_nodding_head_stretches_what_it_reads_row_by_row() {
    let config = CameraConfig::default();
    for distance_m in [1.2, 2.4, 3.6] {
        let mut eye = Eye::on(&field(vec![beacon(distance_m)], vec![]));
        // Nose up, the beacon sinks in the image and meets later rows: the readout follows it downward.
        for nod_rad_per_s in [-1.5, -0.5, 0.0, 0.5, 1.5] {
            let rows_per_s = f64::from(config.height_px) / config.readout_s;
            let stretched_px = expected_px(distance_m) / (1.0 - config.focal_px * nod_rad_per_s / rows_per_s);
            let mut sum_px = 0.0;
            const FRAMES: u32 = 40;
            for frame in 0..FRAMES {
                let turned = |t_s: f64| camera_pose(1.0 * t_s, 0.00137 * f64::from(frame) + nod_rad_per_s * t_s, 0.0);
                let half_s = 0.5 * config.frame_s();
                let seen = eye.moving(&turned(-half_s), &turned(half_s));
                assert_eq!(seen.len(), 1, "at {distance_m} m, {nod_rad_per_s} rad/s");
                let error_px = seen[0].height_px - stretched_px;
                assert!(error_px.abs() < 0.8, "{error_px} px off at {distance_m} m, {nod_rad_per_s} rad/s");
                assert!(seen[0].bearing_rad.abs() < 0.02, "{:?}", seen[0]);
                sum_px += error_px;
            }
            let mean_px = sum_px / f64::from(FRAMES);
            assert!(mean_px.abs() < 0.2, "{mean_px} px off on average at {distance_m} m, {nod_rad_per_s} rad/s");
        }
    }
}

#[test]
fn a_blurred_beacon_is_as_tall_as_a_sharp_one() {
    let config = CameraConfig { readout_s: 0.0, ..CameraConfig::default() };
    for distance_m in [1.2, 2.4, 3.6] {
        let mut eye = Eye::with(&config, &field(vec![beacon(distance_m)], vec![]));
        for start in 0..20 {
            let pitch = 0.001 * f64::from(start);
            // 1 rad/s of pan and 1 rad/s of pitch over 5 ms: a pixel each.
            let seen = eye.moving(&camera_pose(0.0, pitch, 0.0), &camera_pose(0.005, pitch + 0.005, 0.0));
            assert_eq!(seen.len(), 1);
            assert!((seen[0].height_px - expected_px(distance_m)).abs() < 0.8, "{seen:?} at {distance_m} m");
        }
    }
}

#[test]
fn a_beacon_cut_by_the_border_is_not_seen() {
    for distance_m in [1.0, 1.5, 3.0] {
        let mut eye = Eye::on(&field(vec![beacon(distance_m)], vec![]));
        let (half_width_px, half_height_px) = (191.943 * 0.05 / distance_m, 0.5 * expected_px(distance_m));
        // Across the left border, and across the upper one.
        for step in 0..200 {
            let inside_px = 40.0 - 0.4 * f64::from(step);
            let left = (104.0 - inside_px) / 191.943;
            let seen = eye.at(&camera_pose(-f64::atan(left), 0.0, 0.0));
            assert!(seen.is_empty() || inside_px >= half_width_px - 1.0, "{seen:?} {inside_px} px inside");
            let up = (80.0 - inside_px) / 191.943;
            let high = eye.at(&camera_pose(0.0, -f64::atan(up), 0.0));
            assert!(high.is_empty() || inside_px >= half_height_px - 1.0, "{high:?} {inside_px} px inside");
            for glimpse in seen.iter().chain(&high) {
                // Off the centre vertically, heights grow by 1 / cos^2 of the elevation: 13 % at the border.
                let error_px = glimpse.height_px - expected_px(distance_m);
                assert!((-1.0..=1.0 + 0.2 * expected_px(distance_m)).contains(&error_px), "{error_px} px off");
            }
        }
        assert_eq!(eye.at(&camera_pose(0.0, 0.0, 0.0)).len(), 1);
    }
}

#[test]
fn what_stands_before_a_beacon_hides_it_or_changes_little() {
    for distance_m in [1.2, 2.0, 3.5] {
        let mut missed = 0;
        for step in -40..=40 {
            let x_m = 0.0025 * f64::from(step);
            // Halfway to the beacon and looking as wide: it hides the left part, all, the right part.
            let pole = Cylinder {
                radius_m: 0.025,
                base_m: 0.0,
                height_m: 0.5,
                ..cylinder(x_m, 0.5 * distance_m, [Colour::Grey; 2])
            };
            let seen = Eye::on(&field(vec![beacon(distance_m)], vec![pole])).at(&camera_pose(0.0, 0.0, 0.0));
            missed += usize::from(seen.is_empty());
            for glimpse in &seen {
                assert!((glimpse.height_px - expected_px(distance_m)).abs() < 1.0, "{glimpse:?} behind {x_m}");
            }
        }
        assert!(missed >= 15, "hidden by half or more for a third of the places, missed {missed} of 81");
        for top_m in [0.15, 0.2, 0.25] {
            // A box at half the distance hides what lies below the line from the camera over its top.
            let bar = Cylinder {
                radius_m: 0.2,
                base_m: 0.0,
                height_m: top_m,
                ..cylinder(0.0, 0.5 * distance_m, [Colour::Grey; 2])
            };
            let hidden_m = 2.0 * top_m - EYE_M - 0.1;
            let seen = Eye::on(&field(vec![beacon(distance_m)], vec![bar])).at(&camera_pose(0.0, 0.0, 0.0));
            assert_eq!(
                seen.is_empty(),
                hidden_m > 0.01,
                "{seen:?} with the lower {hidden_m} m hidden at {distance_m} m"
            );
        }
    }
}

#[test]
fn a_distractor_of_nearly_the_same_colour_is_no_beacon() {
    for bands in [
        [Colour::Orange, Colour::Yellow],
        [Colour::Pink, Colour::Orange],
        [Colour::Orange, Colour::Orange],
        [Colour::Yellow, Colour::Pink],
        [Colour::Pink, Colour::Pink],
    ] {
        for distance_m in [1.0, 1.3, 2.1, 3.4] {
            // The vision looks for the beacon, which stands behind the robot.
            let mut alone = Eye::on(&field(vec![beacon(-2.0)], vec![cylinder(0.0, distance_m, bands)]));
            // Both, the distractor touching the beacon on its left.
            let beside = field(vec![beacon(2.0)], vec![cylinder(-0.1 * distance_m / 2.0 - 0.05, distance_m, bands)]);
            let mut beside = Eye::on(&beside);
            for frame in 0..25 {
                let pose = camera_pose(0.0, 0.0021 * f64::from(frame), 0.0);
                assert!(alone.at(&pose).is_empty(), "{bands:?} at {distance_m} m");
                for glimpse in beside.at(&pose) {
                    assert!(
                        (glimpse.height_px - expected_px(2.0)).abs() < 1.0,
                        "{glimpse:?} beside {bands:?} at {distance_m} m"
                    );
                    assert!(glimpse.bearing_rad.abs() < 0.01, "{glimpse:?}");
                }
            }
        }
    }
}

#[test]
fn the_nearer_of_two_beacons_hides_the_farther() {
    let far = Landmark { id: 4, body: cylinder(0.0, 3.0, [Colour::Yellow, Colour::Pink]) };
    for step in 0..=60 {
        let x_m = 0.005 * f64::from(step);
        let near = Landmark { id: 3, body: cylinder(x_m, 1.5, [Colour::Pink, Colour::Yellow]) };
        let mut eye = Eye::on(&field(vec![near, far.clone()], vec![]));
        let seen = eye.at(&camera_pose(0.0, 0.0, 0.0));
        let of = |id: u16| seen.iter().find(|glimpse| glimpse.landmark == id);
        let range_m = f64::hypot(x_m, 1.5);
        let near = of(3).unwrap_or_else(|| panic!("the near one is in full sight, {x_m} m aside"));
        assert!((near.height_px - expected_px(range_m)).abs() < 1.0, "{near:?} {x_m} m aside");
        match of(4) {
            // Its axis hidden, its left half free at best.
            Some(far) if x_m < 0.05 => panic!("{far:?} behind the near one, {x_m} m aside"),
            Some(far) => assert!((far.height_px - expected_px(3.0)).abs() < 1.0, "{far:?} {x_m} m aside"),
            None => assert!(x_m < 0.09, "the far one is in full sight, {x_m} m aside"),
        }
    }
}

#[test]
fn bearings_are_from_the_body_s_centre() {
    for (pan_deg, distance_m) in [(0f64, 1.5), (40.0, 1.5), (-60.0, 2.5), (80.0, 1.2), (-15.0, 3.5)] {
        let pan_rad = pan_deg.to_radians();
        let mut eye = Eye::on(&field(vec![beacon(distance_m)], vec![]));
        for aside_rad in [-0.3, 0.0, 0.35] {
            // The body that holds its neck so that the camera stands over the origin, looking `aside_rad` to the
            // left of the beacon; the body itself faces `aside_rad - pan_rad`.
            let heading_rad: f64 = aside_rad - pan_rad;
            let ahead = |angle_rad: f64| [-angle_rad.sin(), angle_rad.cos()];
            let (body, head) = (ahead(heading_rad), ahead(aside_rad));
            let centre = [0, 1].map(|i| -NECK.axis_ahead_m * body[i] - NECK.camera_ahead_m * head[i]);
            let to_beacon = [-centre[0], distance_m - centre[1]];
            let bearing_rad = f64::atan2(-to_beacon[0], to_beacon[1]) - heading_rad;
            let pose = camera_pose(aside_rad, 0.0, 0.0);
            let seen = eye.vision.sight(eye.camera.look(&pose, &pose), pan_rad);
            assert_eq!(seen.len(), 1);
            // Half a pixel is 0.0026 rad.
            assert!((seen[0].bearing_rad - bearing_rad).abs() < 0.004, "{seen:?} for {bearing_rad}");
            assert!((seen[0].height_px - expected_px(distance_m)).abs() < 0.8, "{seen:?} off the centre");
        }
    }
}

#[test]
fn one_seed_gives_one_film() {
    let scene = field(vec![beacon(1.7)], vec![cylinder(0.3, 1.5, [Colour::Orange, Colour::White])]);
    let film = |seed: u64| {
        let mut camera = Camera::new(&CameraConfig::default(), &scene, Seed(seed).stream("camera"));
        let frames = (0..5).map(|i| camera_pose(0.01 * f64::from(i), 0.0, 0.0));
        frames.map(|pose| camera.look(&pose, &camera_pose(0.0, 0.0, 0.0)).clone()).collect::<Vec<_>>()
    };
    assert_eq!(film(1), film(1));
    assert_ne!(film(1), film(2), "the noise is the seed's");
}
