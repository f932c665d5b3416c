//! What follows from the effects on the Velodyne.

use asami_dataset::{Firings, Seed};
use asami_math::angle::wrap_rad;
use asami_sim::effects::Effects;
use asami_sim::scenes::town::Traffic;
use asami_sim::sensors::velodyne::{Velodyne, VelodyneConfig};
use asami_sim::world::{Record, World};

use crate::drives::{car, pedals, with};
use crate::scans::{Corners, along_y, block, boxes, exact, fan, scan, towards_m};

/// Walls 10 m to the left and to the right, 30 m ahead and 30 m behind.
fn court() -> [Corners; 4] {
    [
        [[-11.0, -31.0, 0.0], [-10.0, 31.0, 8.0]],
        [[10.0, -31.0, 0.0], [11.0, 31.0, 8.0]],
        [[-11.0, 30.0, 0.0], [11.0, 31.0, 8.0]],
        [[-11.0, -31.0, 0.0], [11.0, -30.0, 8.0]],
    ]
}

/// Leaning to the right, the ground to the left is farther than to the right; front up, the ground ahead is.
#[test]
fn a_leaning_base_sees_the_ground_nearer_on_one_side() {
    let sides = |effects: &Effects| {
        let firings = scan(exact(), fan(&[-12.0]), effects, &boxes(&[]), &along_y(0.0, 0.0, 0.2));
        [90.0, -90.0, 0.0, 180.0].map(|bearing_deg| towards_m(&firings, 0, bearing_deg))
    };
    let level = sides(&Effects::default());
    assert!(level.iter().all(|range_m| (range_m - 2.0 / 12.0_f64.to_radians().sin()).abs() < 0.01), "{level:?}");
    let [left, right, ahead, behind] = sides(&with("base_tilt", "roll_rad", 0.03));
    assert!(left > right + 2.0 && (ahead - behind).abs() < 0.05, "{left} {right} {ahead} {behind}");
    let [left, right, ahead, behind] = sides(&with("base_tilt", "pitch_rad", 0.03));
    assert!(ahead > behind + 2.0 && (left - right).abs() < 0.05, "{left} {right} {ahead} {behind}");
}

/// Where the nearest return of a turn's lowest laser is, to the left of straight ahead.
fn nearest_rad(firings: &Firings, turn: usize) -> f64 {
    let (per_turn, mut hits) = (2000, Vec::new());
    for i in turn * per_turn..(turn + 1) * per_turn {
        if firings.range_m(0, i).is_some_and(|range_m| range_m < 60.0) {
            hits.push(firings.theta_r_rad(i).expect("a firing"));
        }
    }
    // Middle of a pillar, which may straddle the wrap.
    let first = hits.first().copied().expect("the pillar is seen");
    first + hits.iter().map(|angle| wrap_rad(angle - first)).sum::<f64>() / hits.len() as f64
}

/// While the car turns left, a clock that is ahead says of what was seen that it was seen later: things seem to lie
/// farther to the left than they then did, by yaw rate times offset; straight on they stay where they are.
#[test]
fn a_clock_offset_turns_the_scan_of_a_turning_car() {
    let apart = |steering: f64| {
        let mut car = car(&Effects::default());
        let mut record = Record::default();
        for _ in 0..100 {
            car.tick(pedals(0.05, 0.0, steering), &mut record);
        }
        // Far to the left of the way, ahead: hardly moves but by turning.
        let scenery = boxes(&[block([-40.0, 40.0], -10.0), block([-40.0, 40.0], 0.0)]);
        let config = VelodyneConfig { firing_rate_hz: 20_000.0, ..exact() };
        let angle = |effects: &Effects| {
            let firings = scan(config.clone(), fan(&[0.0]), effects, &scenery, &record.sensor_poses);
            nearest_rad(&firings, 45)
        };
        let at = |t_s: f64| record.track.iter().find(|pose| pose.t_s >= t_s).expect("a pose").theta_rad;
        let turned = wrap_rad(at(4.55) - at(4.35));
        let shift = wrap_rad(angle(&with("clock_offset", "offset_s", 0.2)) - angle(&Effects::default()));
        [shift, turned]
    };
    let [shift, turned] = apart(0.5);
    assert!(turned > 0.05 && (shift / turned - 1.0).abs() < 0.15, "{shift} {turned}");
    let [shift, turned] = apart(0.0);
    assert!(turned.abs() < 1e-3 && shift.abs() < 0.015, "{shift} {turned}");
}

/// By the scanner's own table level ground falls away, the farther the deeper: beams that look higher than it says meet
/// the ground later.
#[test]
fn lasers_that_look_too_high_let_the_ground_fall_away() {
    let angles_deg = [-20.0, -10.0, -5.0];
    let effects = with("vertical_angle_bias", "bias_rad", 0.01);
    let firings = scan(exact(), fan(&angles_deg), &effects, &boxes(&[]), &along_y(0.0, 0.0, 0.1));
    let heights: Vec<f64> = (0..3)
        .map(|laser| {
            let range_m = towards_m(&firings, laser, 90.0);
            2.0 + range_m * angles_deg[laser].to_radians().sin()
        })
        .collect();
    assert!(heights[2] < 1.5 * heights[1] && heights[1] < 1.5 * heights[0] && heights[0] < -0.05, "{heights:?}");
}

/// Lasers that stand on either side of the axis see a near pillar in different directions, a far one in the same.
#[test]
fn lasers_off_the_axis_see_a_parallax() {
    let parallax = |distance_m: f64, aside_m: f64| {
        let config = VelodyneConfig { firing_rate_hz: 50_000.0, ..exact() };
        let effects = with("laser_origin_offsets", "aside_m", aside_m);
        let scenery = boxes(&[block([0.0, distance_m + 1.0], 0.0)]);
        let firings = scan(config, fan(&[-0.1, 0.1]), &effects, &scenery, &along_y(0.0, 0.0, 0.1));
        let middle = |laser: usize| {
            let seen = |i: &usize| firings.range_m(laser, *i).is_some_and(|range_m| range_m < 60.0);
            let angles: Vec<f64> = (0..firings.len()).filter(seen).filter_map(|i| firings.theta_r_rad(i)).collect();
            angles.iter().sum::<f64>() / angles.len() as f64
        };
        middle(0) - middle(1)
    };
    let (near, far) = (parallax(4.0, 0.05), parallax(40.0, 0.05));
    // The even one, on the left, sees the pillar ahead farther to its right.
    assert!(near < -0.8 * 0.1 / 4.0 && near > -1.2 * 0.1 / 4.0, "{near}");
    assert!(far.abs() < 0.2 * near.abs() && parallax(4.0, 0.0).abs() < 2e-4, "{far}");
    // The upper bank stands higher: its level beam passes above what the lower one meets.
    let effects = with("laser_origin_offsets", "apart_m", 0.3);
    let low = [[-5.0, 9.0, 0.0], [5.0, 10.0, 2.0]];
    let firings = scan(exact(), fan(&[0.0, 0.01]), &effects, &boxes(&[low]), &along_y(0.0, 0.0, 0.1));
    assert!((towards_m(&firings, 0, 0.0) - 9.0).abs() < 0.1 && towards_m(&firings, 1, 0.0).is_nan());
}

/// A court seems wider and longer by the same; single lasers disagree about all its walls alike.
#[test]
fn long_ranges_widen_a_court_and_lasers_disagree_about_every_wall_alike() {
    let seen = |effects: &Effects| {
        scan(exact(), fan(&[-1.0, 0.0, 1.0, 2.0]), effects, &boxes(&court()), &along_y(3.0, 0.0, 0.1))
    };
    let firings = seen(&with("range_bias", "bias_m", 0.2));
    let plain = seen(&Effects::default());
    let size = |firings: &Firings, a: f64, b: f64| towards_m(firings, 1, a) + towards_m(firings, 1, b);
    let (wider, longer) = (
        size(&firings, 90.0, -90.0) - size(&plain, 90.0, -90.0),
        size(&firings, 0.0, 180.0) - size(&plain, 0.0, 180.0),
    );
    assert!((wider - 0.4).abs() < 5e-3 && (longer - 0.4).abs() < 5e-3, "{wider} {longer}");
    let spread = seen(&with("range_bias", "spread_m", 0.1));
    let off = |laser: usize, bearing: f64| towards_m(&spread, laser, bearing) - towards_m(&plain, laser, bearing);
    let offs: Vec<[f64; 2]> = (0..4).map(|laser| [off(laser, 90.0), off(laser, 180.0)]).collect();
    assert!(offs.iter().all(|[left, behind]| (left - behind).abs() < 3e-3), "{offs:?}");
    assert!((offs[0][0] - offs[1][0]).abs() > 0.02, "{offs:?}");
}

/// Successive ranges of a wall scatter as the ratio says, about the same wall; what is left after losses is as it was.
#[test]
fn noise_scatters_and_losses_thin_out() {
    let noisy = VelodyneConfig { range_sd_m: 0.02, ..exact() };
    let seen =
        |effects: &Effects| scan(noisy.clone(), fan(&[1.0; 4]), effects, &boxes(&court()), &along_y(0.0, 0.0, 2.0));
    // Second differences of neighbours on the wall to the left: a line drops out, their variance is 6 of one.
    let scatter = |firings: &Firings| {
        let mut squares = (0.0, 0.0_f64);
        for i in 2..firings.len() {
            let bearing_rad = firings.theta_r_rad(i).expect("a firing");
            if (bearing_rad - std::f64::consts::FRAC_PI_2).abs() < 0.3 {
                let [a, b, c] = [i - 2, i - 1, i].map(|i| firings.range_m(0, i).expect("a return"));
                squares = (squares.0 + (a - 2.0 * b + c).powi(2), squares.1 + 6.0);
            }
        }
        (squares.0 / squares.1).sqrt()
    };
    let plain = seen(&Effects::default());
    let (one, three) = (scatter(&plain), scatter(&seen(&with("range_noise", "ratio", 3.0))));
    // Neighbouring second differences overlap: about 1500 of them count for half as many.
    assert!((one / 0.02 - 1.0).abs() < 0.1 && (three / 0.06 - 1.0).abs() < 0.1, "{one} {three}");
    let thin = seen(&with("dropouts", "share", 0.3));
    let pairs = plain.range_2mm.iter().flatten().zip(thin.range_2mm.iter().flatten());
    assert!(pairs.clone().all(|(full, thin)| *thin == 0 || thin == full));
    let (count, left) = pairs.fold((0.0, 0.0), |(n, kept), (_, thin)| (n + 1.0, kept + f64::from(u8::from(*thin > 0))));
    assert!((left / count - 0.7_f64).abs() < 5.0 * (0.21 / count).sqrt(), "{left} of {count}");
}

/// A head that turns faster comes round more often, and what it sees where stays as it is.
#[test]
fn a_faster_head_comes_round_more_often_and_sees_the_same() {
    let seen = |effects: &Effects| scan(exact(), fan(&[0.0]), effects, &boxes(&court()), &along_y(0.0, 0.0, 3.0));
    let (plain, fast) = (seen(&Effects::default()), seen(&with("spin_rate_error", "ratio", 1.1)));
    let turns = |firings: &Firings| firings.encoder_cdeg.windows(2).filter(|pair| pair[1] < pair[0]).count();
    assert_eq!([turns(&plain), turns(&fast)], [29, 32]);
    for bearing_deg in [0.0, 90.0, 180.0, -90.0] {
        let apart_m = towards_m(&plain, 0, bearing_deg) - towards_m(&fast, 0, bearing_deg);
        assert!(apart_m.abs() < 0.02, "{bearing_deg}: {apart_m}");
    }
}

/// Driving at a wall, each turn's returns from just before it ends and from just after the next begins are as far apart
/// as the car moves in a turn where sweeps are compensated, and continuous where they are not.
#[test]
fn compensated_sweeps_jump_from_turn_to_turn() {
    let speed_m_per_s = 8.0;
    let jump = |effects: &Effects| {
        let firings = scan(exact(), fan(&[0.0]), effects, &boxes(&court()), &along_y(-20.0, speed_m_per_s, 1.0));
        let wraps = (1..firings.len()).filter(|i| firings.encoder_cdeg[*i] < firings.encoder_cdeg[i - 1]);
        let jumps: Vec<f64> = wraps
            .map(|i| firings.range_m(0, i - 1).expect("the wall") - firings.range_m(0, i).expect("the wall"))
            .collect();
        assert!(jumps.len() >= 8);
        jumps.iter().sum::<f64>() / jumps.len() as f64
    };
    let (smeared, whole) = (jump(&Effects::default()), jump(&with("sweep_motion", "compensated", 1.0)));
    assert!(smeared.abs() < 0.01 && (whole - 0.1 * speed_m_per_s).abs() < 0.01, "{smeared} {whole}");
    let half = jump(&with("sweep_motion", "compensated", 0.5));
    assert!((half - 0.05 * speed_m_per_s).abs() < 0.01, "{half}");
}

/// A car that comes the other way passes: the street to the left is clear, then is not, then is again, for as long as a
/// car of its length takes at the two speeds together; and the stationary side to the right never changes.
#[test]
fn oncoming_traffic_hides_the_other_side_for_as_long_as_it_takes_to_pass() {
    // Straight, towards -y, 3 m to the left of the way; the one car starts within the first half of 200 m.
    let way = (0..200).map(|metre| [-3.0, 100.0 - f64::from(metre), 0.0]).collect();
    let traffic = Traffic::new(way, 1.0, &mut Seed(1000).stream("effect/moving_traffic"));
    let velodyne = Velodyne::new(exact(), fan(&[-20.0])).among(traffic);
    let speed_m_per_s = 5.0;
    let firings = velodyne.scan(&boxes(&[]), &along_y(-30.0, speed_m_per_s, 20.0), Seed(1000)).expect("a track");
    let ground_m = 2.0 / 20.0_f64.to_radians().sin();
    let hidden = |bearing_rad: f64| -> Vec<f64> {
        let across = |i: &usize| wrap_rad(firings.theta_r_rad(*i).expect("a firing") - bearing_rad).abs() < 0.02;
        let nearer = |i: &usize| firings.range_m(0, *i).expect("the ground") < ground_m - 0.1;
        (0..firings.len()).filter(across).filter(nearer).map(|i| firings.t_s[i]).collect()
    };
    let left_s = hidden(std::f64::consts::FRAC_PI_2);
    let (first_s, last_s) = (left_s[0], left_s[left_s.len() - 1]);
    // 4.2 m at 10 m/s, seen ten times a second.
    assert!(first_s > 0.5 && last_s < 19.5 && (0.2..0.55).contains(&(last_s - first_s)), "{first_s} {last_s}");
    assert!(hidden(-std::f64::consts::FRAC_PI_2).is_empty());
}
