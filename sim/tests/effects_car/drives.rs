//! Short drives on simple ground.

use asami_dataset::{Action, Seed};
use asami_sim::effects::Effects;
use asami_sim::robots::car::{CarConfig, CarWorld, Start};
use asami_sim::scenes::solid::Ground;
use asami_sim::world::{Record, World};

/// Pedals and steering.
pub fn pedals(throttle: f64, brake: f64, steering: f64) -> Action {
    Action::Pedals { throttle, brake, steering }
}

/// A car with effects that stands on a level plane.
pub fn car(effects: &Effects) -> CarWorld {
    let config = CarConfig::default();
    CarWorld::new(&config, &Ground::level(300.0), None, effects, Start::default(), Seed(1000)).expect("the shipped car")
}

/// A car with one effect of one parameter.
pub fn car_with(effect: &str, parameter: &str, value: f64) -> CarWorld {
    car(&with(effect, parameter, value))
}

/// One effect with one parameter set.
pub fn with(effect: &str, parameter: &str, value: f64) -> Effects {
    let mut effects = Effects::default();
    assert!(effects.set(effect, parameter, value), "{effect}.{parameter}");
    effects
}

/// Holds an action for a time.
pub fn hold(car: &mut CarWorld, action: Action, for_s: f64) {
    let mut record = Record::default();
    for _ in 0..(for_s / 0.05).round() as usize {
        car.tick(action, &mut record);
    }
}

/// Forward.
pub fn speed_m_per_s(car: &CarWorld) -> f64 {
    car.pose().v_m_per_s.expect("a simulated car knows its speed")
}

/// Seconds until `is` under an action, to a control tick; 20 at most.
pub fn until(car: &mut CarWorld, action: Action, is: impl Fn(&CarWorld) -> bool) -> f64 {
    let began_s = car.t_s();
    while !is(car) && car.t_s() < began_s + 20.0 {
        hold(car, action, 0.05);
    }
    car.t_s() - began_s
}
