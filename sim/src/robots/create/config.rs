//! Every number of the robot that a scenario may set.

use asami_dataset::parameters::Fault;

asami_dataset::parameters! {
    /// How the engine steps.
    pub struct Physics {
        /// Engine time step.
        time_step_s: f64 = 0.005, "s", 0.001..=0.02;
        /// Engine steps in one control period.
        steps_per_tick: u32 = 4, "1", 1.0..=40.0;
        /// Solver iterations (substeps) of one step.
        solver_iterations: u32 = 1, "1", 1.0..=16.0;
        /// Projected Gauss-Seidel sweeps of one iteration.
        pgs_iterations: u32 = 4, "1", 1.0..=16.0;
        /// Gravity.
        gravity_m_per_s2: f64 = 9.81, "m/s^2", 0.0..=20.0;
        /// Nominal Coulomb friction coefficient between tyres and floor.
        friction: f64 = 0.9, "1", 0.01..=3.0;
        /// Standing still before the log begins.
        settle_s: f64 = 0.5, "s", 0.0..=5.0;
    }
}

asami_dataset::parameters! {
    /// From commanded velocities to turning wheels.
    pub struct Wheels {
        /// Time constant with which a wheel's wanted speed follows the command.
        lag_s: f64 = 0.03, "s", 0.001..=2.0;
        /// How fast that speed may change, at the tyre.
        most_m_per_s2: f64 = 2.0, "m/s^2", 0.05..=50.0;
        /// How fast a wheel is at most, at the tyre.
        most_m_per_s: f64 = 0.5, "m/s", 0.05..=5.0;
        /// The motor's torque for each rad/s that its wheel is too slow.
        gain_n_m_s_per_rad: f64 = 0.08, "N.m.s/rad", 0.001..=10.0;
        /// The same for each rad that its wheel has fallen behind.
        integral_n_m_per_rad: f64 = 0.2, "N.m/rad", 0.0..=100.0;
        /// Standard deviation of a wheel's speed about the wanted one, at the tyre, new each tick: gears, and grains on the
        /// floor.
        jitter_m_per_s: f64 = 0.01, "m/s", 0.0..=0.5;
    }
}

asami_dataset::parameters! {
    /// The sensor that finds landmarks, and how well it measures range and bearing.
    pub struct Sight {
        /// Control periods from one frame to the next.
        ticks_per_frame: u32 = 5, "1", 1.0..=100.0;
        /// The sensor ahead of the middle between the wheels.
        ahead_m: f64 = 0.0, "m", -0.5..=0.5;
        /// Width of what it sees: a camera, or more than half a circle, and it is a scanner.
        view_rad: f64 = 1.0, "rad", 0.1..=6.3;
        /// Landmarks nearer to the sensor are not recognised.
        near_m: f64 = 0.3, "m", 0.05..=50.0;
        /// Nor are landmarks farther from it.
        far_m: f64 = 8.0, "m", 0.5..=100.0;
        /// Share of the landmarks in view that are recognised.
        recognised: f64 = 0.5, "1", 0.0..=1.0;
        /// Standard deviation of ranges.
        sigma1_m: f64 = 0.03, "m", 0.0..=2.0;
        /// Share of their variance that is not new in each frame: what a landmark's range is off lasts, each landmark's by itself.
        lasting_share: f64 = 0.0, "1", 0.0..=1.0;
        /// It fades to 1/e in this time.
        fades_s: f64 = 4.0, "s", 0.01..=1000.0;
        /// Standard deviation of bearings.
        sigma2_rad: f64 = 0.02, "rad", 0.0..=1.0;
    }
}

asami_dataset::tables! {
    /// The robot's tables in a scenario.
    pub struct CreateConfig {
        /// `[create.physics]`
        physics: Physics;
        /// `[create.wheels]`
        wheels: Wheels;
        /// `[create.sight]`
        sight: Sight;
    }
    rule near_before_far
}

fn near_before_far(config: &CreateConfig, path: &str, faults: &mut Vec<Fault>) {
    let (near_m, far_m) = (config.sight.near_m, config.sight.far_m);
    if near_m >= far_m {
        let message = format!("near_m must be less than far_m ({far_m}), not {near_m}");
        faults.push(Fault { path: format!("{path}.sight.near_m"), message });
    }
}
