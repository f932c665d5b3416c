//! What follows from the effects on tyres, resistance, ground and load.

use asami_math::elementary::asin;
use asami_sim::robots::car::CarWorld;
use asami_sim::world::World;
use nalgebra::Vector3;

use crate::drives::{car_with, hold, pedals, speed_m_per_s, until};

fn pitch_rad(car: &CarWorld) -> f64 {
    asin((car.sensor_pose().world_from_sensor * Vector3::y()).z)
}

/// From 8 m/s, the speed lost in a second of rolling less that of one at `slow`.
fn lost_m_per_s(car: &mut CarWorld, at: f64) -> f64 {
    until(car, pedals(0.5, 0.0, 0.0), |car| speed_m_per_s(car) > at + 1.5);
    until(car, pedals(0.0, 0.0, 0.0), |car| speed_m_per_s(car) < at);
    let before = speed_m_per_s(car);
    hold(car, pedals(0.0, 0.0, 0.0), 1.0);
    before - speed_m_per_s(car)
}

/// On soft tyres the body points into the bend at the same steering: the rear axle drifts outwards more.
#[test]
fn soft_tyres_drift_in_a_bend() {
    let drift = |ratio: f64| {
        let mut car = car_with("tyre_slip", "across_ratio", ratio);
        until(&mut car, pedals(0.3, 0.0, 0.0), |car| speed_m_per_s(car) > 7.0);
        hold(&mut car, pedals(0.05, 0.0, 0.15), 2.0);
        let motion = car.body().motion();
        // Of the rear axle's middle, in the body's axes.
        let rear = motion.origin_m + motion.rotation * Vector3::new(-1.166, 0.0, 0.0);
        let velocity = motion.rotation.inverse() * motion.velocity_at(rear);
        velocity.y / velocity.x
    };
    let (stiff, soft) = (drift(1.0), drift(0.3));
    // Outwards of a bend to the left is to the right.
    assert!(stiff < 0.0 && soft < 2.0 * stiff, "{soft} {stiff}");
}

/// Along, softer tyres slip more under the engine: the wheels turn faster than the road goes by.
#[test]
fn soft_tyres_slip_under_the_engine() {
    let slip = |ratio: f64| {
        let mut car = car_with("tyre_slip", "along_ratio", ratio);
        hold(&mut car, pedals(0.6, 0.0, 0.0), 3.0);
        car.body().wheels()[2].spin_rad_per_s() / speed_m_per_s(&car)
    };
    assert!(slip(0.2) > 1.05 * slip(1.0), "{} {}", slip(0.2), slip(1.0));
}

/// Both hold the car back; drag fades as it slows down, rolling resistance does not, and only the latter holds it on a
/// slope.
#[test]
fn drag_goes_with_speed_and_rolling_resistance_does_not() {
    let lost = |effect: &str, parameter: &str, value: f64, at: f64| {
        lost_m_per_s(&mut car_with(effect, parameter, value), at)
            - lost_m_per_s(&mut car_with(effect, parameter, 0.0), at)
    };
    let [fast, slow] = [9.0, 5.0].map(|at| lost("drag", "linear_n_s_per_m", 200.0, at));
    assert!(fast > 0.5 && (fast / slow - 9.0 / 5.0).abs() < 0.25, "{fast} {slow}");
    let [fast, slow] = [9.0, 5.0].map(|at| lost("drag", "square_n_s2_per_m2", 30.0, at));
    assert!(fast > 0.5 && (fast / slow - 81.0 / 25.0).abs() < 0.5, "{fast} {slow}");
    let [fast, slow] = [9.0, 5.0].map(|at| lost("rolling_resistance", "coefficient", 0.05, at));
    assert!((fast / slow - 1.0).abs() < 0.1 && fast > 0.3, "{fast} {slow}");
}

/// Without a foot on any pedal an engine that idles holds a car on a gentle slope, and a steeper one rolls it back;
/// facing down it rolls on by itself.
#[test]
fn a_grade_rolls_the_car_back_with_no_pedals() {
    let rolled = |slope: f64| {
        let mut car = car_with("road_grade", "y_slope", slope);
        hold(&mut car, pedals(0.0, 0.0, 0.0), 6.0);
        car.pose().y_m
    };
    let (up, level, down) = (rolled(0.15), rolled(0.0), rolled(-0.15));
    assert!(up < -2.0 && level > 2.0 && down > level + 5.0, "{up} {level} {down}");
    // Across the slope it goes neither way, but downhill aside.
    let mut car = car_with("road_grade", "x_slope", 0.15);
    hold(&mut car, pedals(0.0, 0.0, 0.0), 6.0);
    let pose = car.pose();
    assert!((pose.y_m - level).abs() < 0.2 * level && pose.x_m < -0.005, "{pose:?}");
    // And on its brake it stands.
    let mut car = car_with("road_grade", "y_slope", 0.15);
    hold(&mut car, pedals(0.0, 0.5, 0.0), 3.0);
    let before_m = car.pose().y_m;
    hold(&mut car, pedals(0.0, 0.5, 0.0), 10.0);
    assert!((car.pose().y_m - before_m).abs() < 1e-3, "{}", car.pose().y_m - before_m);
}

/// A full boot lifts the nose before the car has moved, lengthens the stop and loads the rear axle with all of itself
/// and more.
#[test]
fn a_load_lifts_the_nose_and_lengthens_the_stop() {
    let (mut empty, mut full) = (car_with("car_payload", "mass_kg", 0.0), car_with("car_payload", "mass_kg", 400.0));
    assert!(pitch_rad(&full) > pitch_rad(&empty) + 0.01, "{} {}", pitch_rad(&full), pitch_rad(&empty));
    for car in [&mut empty, &mut full] {
        hold(car, pedals(0.0, 0.5, 0.0), 4.0);
    }
    let [loads, more] = [&empty, &full].map(|car| car.body().wheels().each_ref().map(|wheel| wheel.load_n()));
    let rear = more[2] + more[3] - loads[2] - loads[3];
    assert!(rear > 400.0 * 9.81 && more[0] + more[1] < loads[0] + loads[1], "{loads:?} {more:?}");
    let total = more.iter().sum::<f64>() - loads.iter().sum::<f64>();
    assert!((total - 400.0 * 9.81).abs() < 20.0, "{total} {loads:?} {more:?}");
    let [light, heavy] = [&mut empty, &mut full].map(|car| {
        until(car, pedals(0.4, 0.0, 0.0), |car| speed_m_per_s(car) > 7.0);
        until(car, pedals(0.0, 0.2, 0.0), |car| speed_m_per_s(car) < 0.1)
    });
    assert!(heavy > 1.1 * light, "{heavy} {light}");
}
