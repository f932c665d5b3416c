//! Every number of the car that a scenario may set and that its URDF does not hold.

use super::blueprint::Model;

asami_dataset::parameters! {
    /// How the engine steps.
    pub struct Physics {
        /// Engine time step.
        time_step_s: f64 = 0.0025, "s", 0.0005..=0.005;
        /// Engine steps in one control period.
        steps_per_tick: u32 = 20, "1", 1.0..=200.0;
        /// Engine steps from one recorded pose to the next.
        steps_per_pose: u32 = 4, "1", 1.0..=200.0;
        /// Gravity.
        gravity_m_per_s2: f64 = 9.81, "m/s^2", 0.0..=20.0;
        /// Nominal Coulomb friction coefficient between tyre and road.
        friction: f64 = 0.85, "1", 0.01..=2.0;
        /// Standing on the brake before the log begins.
        settle_s: f64 = 2.5, "s", 0.0..=10.0;
    }
}

asami_dataset::parameters! {
    /// Springs and dampers of one wheel.
    pub struct Suspension {
        /// Spring at a front wheel.
        front_stiffness_n_per_m: f64 = 36e3, "N/m", 5e3..=200e3;
        /// Spring at a rear wheel.
        rear_stiffness_n_per_m: f64 = 38e3, "N/m", 5e3..=200e3;
        /// Damper at either.
        damping_n_s_per_m: f64 = 3200.0, "N.s/m", 0.0..=20e3;
        /// Force on either side for each metre by which one side of an axle is compressed more.
        anti_roll_n_per_m: f64 = 14e3, "N/m", 0.0..=100e3;
        /// Spring of the stops at either end of the travel.
        stop_stiffness_n_per_m: f64 = 250e3, "N/m", 1e4..=1e6;
    }
}

asami_dataset::parameters! {
    /// One tyre, as a ring of bristles with a relaxation length.
    pub struct Tyre {
        /// Radial spring.
        radial_stiffness_n_per_m: f64 = 230e3, "N/m", 50e3..=1e6;
        /// Radial damper.
        radial_damping_n_s_per_m: f64 = 500.0, "N.s/m", 0.0..=5e3;
        /// Spring of the tread along the wheel; times its relaxation length it is the slip stiffness.
        along_stiffness_n_per_m: f64 = 280e3, "N/m", 1e4..=1e6;
        /// Spring of the tread across the wheel; times its relaxation length it is the cornering stiffness.
        across_stiffness_n_per_m: f64 = 130e3, "N/m", 1e4..=1e6;
        /// Damper of the tread.
        tread_damping_n_s_per_m: f64 = 1500.0, "N.s/m", 0.0..=1e4;
        /// Way over which a new slip builds up along the wheel.
        along_relaxation_m: f64 = 0.3, "m", 0.05..=2.0;
        /// Way over which a new slip angle builds up.
        across_relaxation_m: f64 = 0.5, "m", 0.05..=2.0;
        /// Rolling resistance as a share of the load.
        rolling_resistance: f64 = 0.014, "1", 0.0..=0.1;
    }
}

asami_dataset::parameters! {
    /// Engine, torque converter and automatic gearbox.
    pub struct Engine {
        /// From the command to the throttle's motor.
        throttle_delay_s: f64 = 0.06, "s", 0.0..=1.0;
        /// Time constant of the throttle's motor.
        throttle_lag_s: f64 = 0.12, "s", 0.001..=2.0;
        /// Torque at full load (230 lb.ft at 3000 rpm are 312 N.m).
        full_torque_n_m: f64 = 300.0, "N.m", 50.0..=1000.0;
        /// Speed up to which a fully open throttle lets the engine breathe freely.
        full_breath_rad_per_s: f64 = 850.0, "rad/s", 50.0..=3000.0;
        /// Friction and pumps.
        drag_n_m: f64 = 48.0, "N.m", 0.0..=100.0;
        /// Friction that grows with speed.
        drag_n_m_s_per_rad: f64 = 0.09, "N.m.s/rad", 0.0..=1.0;
        /// Idle speed held by its governor.
        idle_rad_per_s: f64 = 62.0, "rad/s", 40.0..=150.0;
        /// Of crankshaft and impeller.
        inertia_kg_m2: f64 = 0.25, "kg.m^2", 0.02..=2.0;
        /// Torque of the impeller for each (rad/s)^2 of its speed, while it slips.
        converter_n_m_s2: f64 = 0.0050, "N.m.s^2", 0.0005..=0.05;
        /// Factor on torque of the stalled converter.
        stall_ratio: f64 = 1.4, "1", 1.0..=3.0;
        /// First gear.
        first_ratio: f64 = 2.86, "1", 1.0..=6.0;
        /// Second gear; higher ones are beyond town speeds.
        second_ratio: f64 = 1.62, "1", 1.0..=6.0;
        /// Axles' ratio.
        final_ratio: f64 = 4.3, "1", 1.0..=8.0;
        /// Speed at which it changes up with a closed throttle.
        shift_up_m_per_s: f64 = 6.0, "m/s", 0.5..=20.0;
        /// How much later with an open one.
        shift_up_throttle_m_per_s: f64 = 9.0, "m/s", 0.0..=50.0;
        /// Speed at which it changes down.
        shift_down_m_per_s: f64 = 4.0, "m/s", 0.1..=20.0;
        /// Time constant of a change.
        shift_lag_s: f64 = 0.25, "s", 0.01..=2.0;
        /// Share of power that reaches the wheels.
        efficiency: f64 = 0.9, "1", 0.1..=1.0;
        /// Share of torque to the front axle.
        front_share: f64 = 0.15, "1", 0.0..=1.0;
        /// Air: half density times drag coefficient times area.
        air_drag_n_s2_per_m2: f64 = 0.75, "N.s^2/m^2", 0.0..=5.0;
    }
}

asami_dataset::parameters! {
    /// Brakes.
    pub struct Brake {
        /// From the command to the pedal's motor.
        delay_s: f64 = 0.05, "s", 0.0..=1.0;
        /// Time constant of motor and hydraulics.
        lag_s: f64 = 0.1, "s", 0.001..=2.0;
        /// Torque of all four at a fully pressed pedal.
        full_torque_n_m: f64 = 7200.0, "N.m", 500.0..=20e3;
        /// Share of it in front.
        front_share: f64 = 0.62, "1", 0.0..=1.0;
    }
}

asami_dataset::parameters! {
    /// Steering.
    pub struct Steering {
        /// From the command to the steering wheel's motor.
        delay_s: f64 = 0.05, "s", 0.0..=1.0;
        /// Time constant of the motor.
        lag_s: f64 = 0.1, "s", 0.001..=2.0;
    }
}

asami_dataset::tables! {
    /// The car's tables in a scenario.
    pub struct CarConfig {
        /// `[car.physics]`
        physics: Physics;
        /// `[car.suspension]`
        suspension: Suspension;
        /// `[car.tyre]`
        tyre: Tyre;
        /// `[car.engine]`
        engine: Engine;
        /// `[car.brake]`
        brake: Brake;
        /// `[car.steering]`
        steering: Steering;
    }
    keys {
        /// Whose body it has.
        body: Model;
    }
}
