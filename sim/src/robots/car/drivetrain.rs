//! Engine, torque converter, automatic gearbox: from the throttle's opening to torque at the wheels.

use super::config::Engine;

/// Relative slip within which the converter's torque falls off towards equal speeds.
const COUPLING: f64 = 0.2;
/// How much throttle the governor gives for each rad/s below idle.
const GOVERNOR_S_PER_RAD: f64 = 0.02;

/// What the gearbox is in, or is changing to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gear {
    /// The first.
    First,
    /// The second.
    Second,
}

/// State of engine and gearbox.
#[derive(Clone, Debug)]
pub struct Drivetrain {
    config: Engine,
    /// Of crankshaft and impeller.
    pub engine_rad_per_s: f64,
    /// What the gearbox is changing to.
    wanted_ratio: f64,
    ratio: f64,
    /// How far the speed by which it changes gear is above the wheels' own.
    pub faster_m_per_s: f64,
    /// The gear that it is told to be in, if any.
    pub told: Option<Gear>,
}

impl Drivetrain {
    /// Idling, in first gear.
    #[must_use]
    pub fn new(config: Engine) -> Self {
        let (engine_rad_per_s, ratio) = (config.idle_rad_per_s, config.first_ratio);
        Self { config, engine_rad_per_s, wanted_ratio: ratio, ratio, faster_m_per_s: 0.0, told: None }
    }

    /// The gearbox' ratio, between two gears while it changes.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// What it is in, or is changing to.
    #[must_use]
    pub fn gear(&self) -> Gear {
        if self.wanted_ratio == self.config.second_ratio { Gear::Second } else { Gear::First }
    }

    /// Torque on all driven wheels together, one step on. `torque_ratio` is a factor on what the engine
    /// gives before its own friction.
    pub fn step(&mut self, throttle: f64, wheels_rad_per_s: f64, radius_m: f64, torque_ratio: f64, dt_s: f64) -> f64 {
        self.change(throttle, wheels_rad_per_s * radius_m + self.faster_m_per_s, dt_s);
        let geared = self.ratio * self.config.final_ratio;
        let engine = self.engine_rad_per_s;
        let slip = 1.0 - wheels_rad_per_s * geared / engine;

        // Falls off as the speeds become equal, and brakes when the wheels are the faster.
        let capacity = (slip / COUPLING).clamp(-1.0, 1.0);
        let impeller_n_m = self.config.converter_n_m_s2 * engine * engine * capacity;
        let stall = self.config.stall_ratio;
        // From its stall value to 1 where the pump's wheel begins to turn with the turbine's.
        let multiplied = (1.0 + (stall - 1.0) * (slip - COUPLING) / (1.0 - COUPLING)).clamp(1.0, stall);

        let torque_n_m = self.engine_n_m(throttle, torque_ratio) - impeller_n_m;
        let least = 0.3 * self.config.idle_rad_per_s;
        self.engine_rad_per_s = (engine + torque_n_m * dt_s / self.config.inertia_kg_m2).max(least);
        impeller_n_m * multiplied * geared * self.config.efficiency
    }

    /// Torque of the engine: a closed throttle starves it the more the faster it turns. `torque_ratio` is a factor on what it
    /// gives before its own friction.
    fn engine_n_m(&self, throttle: f64, torque_ratio: f64) -> f64 {
        let (config, engine) = (&self.config, self.engine_rad_per_s);
        let drag_n_m = config.drag_n_m + config.drag_n_m_s_per_rad * engine;
        let governor = (GOVERNOR_S_PER_RAD * (config.idle_rad_per_s - engine)).max(0.0);
        // What idling takes in neutral is let in past the throttle.
        let idle_n_m = config.drag_n_m + config.drag_n_m_s_per_rad * config.idle_rad_per_s;
        let bypass = idle_n_m / config.full_torque_n_m * config.idle_rad_per_s / config.full_breath_rad_per_s;
        let breath = (throttle + bypass + governor) * config.full_breath_rad_per_s / engine;
        let load = breath / (1.0 + breath * breath).sqrt();
        torque_ratio * config.full_torque_n_m * load - drag_n_m
    }

    fn change(&mut self, throttle: f64, speed_m_per_s: f64, dt_s: f64) {
        let config = &self.config;
        let up = speed_m_per_s > config.shift_up_m_per_s + config.shift_up_throttle_m_per_s * throttle;
        let by_itself =
            if up { Some(Gear::Second) } else { (speed_m_per_s < config.shift_down_m_per_s).then_some(Gear::First) };
        match self.told.or(by_itself) {
            Some(Gear::Second) => self.wanted_ratio = config.second_ratio,
            Some(Gear::First) => self.wanted_ratio = config.first_ratio,
            None => {}
        }
        self.ratio += (self.wanted_ratio - self.ratio) * dt_s / (config.shift_lag_s + dt_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(throttle: f64, wheels_rad_per_s: f64) -> (Drivetrain, f64) {
        let mut drivetrain = Drivetrain::new(Engine::default());
        let mut torque_n_m = 0.0;
        for _ in 0..4000 {
            torque_n_m = drivetrain.step(throttle, wheels_rad_per_s, 0.375, 1.0, 0.0025);
        }
        (drivetrain, torque_n_m)
    }

    #[test]
    fn idles_and_creeps_at_a_standstill() {
        let (drivetrain, torque_n_m) = settled(0.0, 0.0);
        assert!((drivetrain.engine_rad_per_s - 62.0).abs() < 4.0, "{}", drivetrain.engine_rad_per_s);
        // Gently: less than a tenth of the weight of two tonnes.
        assert!((100.0..0.1 * 2000.0 * 9.81 * 0.375).contains(&torque_n_m), "{torque_n_m}");
    }

    #[test]
    fn more_throttle_gives_more_torque_and_overrun_brakes() {
        let torques: Vec<f64> = (0..5).map(|i| settled(0.25 * f64::from(i), 10.0).1).collect();
        assert!(torques.is_sorted(), "{torques:?}");
        assert!(settled(0.0, 20.0).1 < 0.0);
    }

    /// By itself it is in the second gear at 10 m/s and in the first at 2 m/s.
    #[test]
    fn gears_are_those_it_is_told_whatever_the_speed() {
        for (wheels_rad_per_s, told) in [(10.0 / 0.375, Gear::First), (2.0 / 0.375, Gear::Second)] {
            let (mut drivetrain, _) = settled(0.1, wheels_rad_per_s);
            assert_ne!(drivetrain.gear(), told);
            drivetrain.told = Some(told);
            for _ in 0..4000 {
                drivetrain.step(0.1, wheels_rad_per_s, 0.375, 1.0, 0.0025);
            }
            let config = Engine::default();
            let wanted = if told == Gear::First { config.first_ratio } else { config.second_ratio };
            assert_eq!(drivetrain.gear(), told);
            assert!((drivetrain.ratio() - wanted).abs() < 1e-6);
        }
    }

    /// A stalled converter gives its impeller's torque, multiplied; the balance of torques at the impeller says how much.
    #[test]
    fn stalls_where_the_torques_balance() {
        let config = Engine::default();
        let (drivetrain, torque_n_m) = settled(1.0, 0.0);
        let engine = drivetrain.engine_rad_per_s;
        let impeller_n_m = drivetrain.engine_n_m(1.0, 1.0);
        assert!((impeller_n_m - config.converter_n_m_s2 * engine * engine).abs() < 1e-6);
        let wanted_n_m =
            impeller_n_m * config.stall_ratio * config.first_ratio * config.final_ratio * config.efficiency;
        assert!((torque_n_m - wanted_n_m).abs() < 1e-3 * wanted_n_m);
    }
}
