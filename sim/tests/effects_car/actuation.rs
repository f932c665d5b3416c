//! What follows from the effects on pedals, brakes and steering.

use asami_math::angle::wrap_rad;
use asami_sim::world::World;

use crate::drives::{car, car_with, hold, pedals, speed_m_per_s, until, with};

/// Speeds up to 6 m/s, then seconds to a stop.
fn stop_s(car: &mut asami_sim::robots::car::CarWorld) -> f64 {
    until(car, pedals(0.3, 0.0, 0.0), |car| speed_m_per_s(car) > 6.0);
    until(car, pedals(0.0, 0.25, 0.0), |car| speed_m_per_s(car) < 0.1)
}

/// A pedal pressed for less than the throttle is late moves the car only after it has been let go.
#[test]
fn a_late_throttle_pulls_after_the_foot_has_gone() {
    let mut late = car_with("throttle_delay", "delay_s", 0.8);
    let mut prompt = car(&with("throttle_delay", "delay_s", 0.0));
    for car in [&mut late, &mut prompt] {
        // Rolling at the speed at which it creeps.
        hold(car, pedals(0.0, 0.0, 0.0), 6.0);
        hold(car, pedals(0.4, 0.0, 0.0), 0.5);
    }
    assert!(speed_m_per_s(&prompt) > speed_m_per_s(&late) + 0.3, "{}", speed_m_per_s(&prompt));
    let before = speed_m_per_s(&late);
    hold(&mut late, pedals(0.0, 0.0, 0.0), 1.2);
    hold(&mut prompt, pedals(0.0, 0.0, 0.0), 1.2);
    assert!(speed_m_per_s(&late) > before + 0.3 && speed_m_per_s(&late) > speed_m_per_s(&prompt), "{before}");
    // Brakes are not late: from the same speed both slow down as much.
    let slowed = [late, prompt].map(|mut car| {
        hold(&mut car, pedals(0.0, 0.0, 0.0), 8.0);
        let before = speed_m_per_s(&car);
        hold(&mut car, pedals(0.0, 0.2, 0.0), 0.4);
        before - speed_m_per_s(&car)
    });
    assert!((slowed[0] - slowed[1]).abs() < 0.02 && slowed[0] > 0.2, "{slowed:?}");
}

/// A light foot does nothing, a heavy one nearly all.
#[test]
fn play_takes_all_of_a_light_foot_and_little_of_a_heavy_one() {
    let reached = |play: f64, throttle: f64| {
        let mut car = car_with("throttle_deadband", "play", play);
        hold(&mut car, pedals(throttle, 0.0, 0.0), 5.0);
        speed_m_per_s(&car)
    };
    let (idle, light, heavy) = (reached(0.0, 0.0), reached(0.0, 0.08), reached(0.0, 0.7));
    assert!(reached(0.1, 0.08) == idle && light > idle + 0.3, "{idle} {light}");
    let played = reached(0.1, 0.7);
    assert!(played > 0.9 * heavy && played < heavy, "{played} {heavy}");
}

/// A tired engine pulls less; with the foot off the throttle it brakes as a fresh one does.
#[test]
fn a_tired_engine_pulls_less_and_brakes_as_much() {
    let drive = |ratio: f64| {
        let mut car = car_with("engine_torque", "ratio", ratio);
        let pulled_s = until(&mut car, pedals(0.4, 0.0, 0.0), |car| speed_m_per_s(car) > 10.0);
        hold(&mut car, pedals(0.0, 0.0, 0.0), 1.0);
        let before = speed_m_per_s(&car);
        hold(&mut car, pedals(0.0, 0.0, 0.0), 2.0);
        (pulled_s, before - speed_m_per_s(&car))
    };
    let ((fresh_s, slowed), (tired_s, slowed_tired)) = (drive(1.0), drive(0.6));
    assert!(tired_s > 1.4 * fresh_s, "{tired_s} {fresh_s}");
    assert!((slowed_tired / slowed - 1.0).abs() < 0.1 && slowed > 0.5, "{slowed_tired} {slowed}");
}

#[test]
fn a_second_stop_on_fading_brakes_takes_longer_and_one_after_a_rest_less() {
    let mut plain = car_with("brake_fade", "fade_per_mj", 0.0);
    let plain = [stop_s(&mut plain), stop_s(&mut plain)];
    assert!((plain[0] - plain[1]).abs() < 0.06, "{plain:?}");
    let mut fading = car_with("brake_fade", "fade_per_mj", 10.0);
    let stops = [(); 4].map(|()| stop_s(&mut fading));
    assert!(stops[0] >= plain[0] && stops.windows(2).all(|pair| pair[1] > pair[0]), "{stops:?} {plain:?}");
    hold(&mut fading, pedals(0.0, 0.4, 0.0), 120.0);
    let rested = stop_s(&mut fading);
    assert!(rested < stops[3], "{rested} {stops:?}");
}

/// Hands off, the car goes round a circle and comes back to where it was.
#[test]
fn a_steering_offset_drives_a_circle_with_hands_off() {
    let mut car = car_with("steering_offset", "offset_rad", 0.1);
    hold(&mut car, pedals(0.0, 0.0, 0.0), 8.0);
    let start = car.pose();
    let (mut turned_rad, mut last_rad, mut farthest_m) = (0.0, start.theta_rad, 0.0_f64);
    for _ in 0..2400 {
        hold(&mut car, pedals(0.0, 0.0, 0.0), 0.05);
        let pose = car.pose();
        turned_rad += wrap_rad(pose.theta_rad - last_rad);
        last_rad = pose.theta_rad;
        let away_m = (pose.x_m - start.x_m).hypot(pose.y_m - start.y_m);
        farthest_m = farthest_m.max(away_m);
        if turned_rad > std::f64::consts::TAU {
            break;
        }
    }
    let back = car.pose();
    let missed_m = (back.x_m - start.x_m).hypot(back.y_m - start.y_m);
    assert!(turned_rad > 6.2 && farthest_m > 40.0 && missed_m < 0.5, "{turned_rad} {farthest_m} {missed_m}");
}

/// A gear that halves the angle doubles the circle, either way round.
#[test]
fn half_the_steering_is_twice_the_circle() {
    let curvature = |ratio: f64, steering: f64| {
        let mut car = car_with("steering_ratio", "ratio", ratio);
        hold(&mut car, pedals(0.0, 0.0, steering), 6.0);
        let before = car.pose();
        hold(&mut car, pedals(0.0, 0.0, steering), 1.0);
        wrap_rad(car.pose().theta_rad - before.theta_rad) / speed_m_per_s(&car)
    };
    for steering in [0.2, -0.2] {
        let (whole, half) = (curvature(1.0, steering), curvature(0.5, steering));
        assert!((half / whole - 0.5).abs() < 0.01 && whole * steering > 0.0, "{half} {whole}");
    }
}

/// Turned to and fro faster than it follows, lagging steering swings the car less; held, it turns it as much.
#[test]
fn lagging_steering_swings_less_and_turns_as_much() {
    let swings = |lag_s: f64| {
        let mut car = car_with("steering_lag", "lag_s", lag_s);
        hold(&mut car, pedals(0.0, 0.0, 0.0), 4.0);
        let mut headings = Vec::new();
        for half in 0..12 {
            let steering = if half % 2 == 0 { 0.3 } else { -0.3 };
            hold(&mut car, pedals(0.0, 0.0, steering), 0.5);
            headings.push(car.pose().theta_rad);
        }
        let swing = headings[6..].windows(2).map(|pair| wrap_rad(pair[1] - pair[0]).abs()).sum::<f64>();
        hold(&mut car, pedals(0.0, 0.0, 0.3), 4.0);
        let before = car.pose().theta_rad;
        hold(&mut car, pedals(0.0, 0.0, 0.3), 1.0);
        (swing, wrap_rad(car.pose().theta_rad - before))
    };
    let ((quick, turn), (slow, turn_late)) = (swings(0.0), swings(0.5));
    assert!(slow < 0.6 * quick, "{slow} {quick}");
    assert!((turn_late / turn - 1.0).abs() < 0.01, "{turn_late} {turn}");
}
