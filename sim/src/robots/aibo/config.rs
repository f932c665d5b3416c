//! Every number of the robot that a scenario may set.

use serde::{Deserialize, Serialize};

asami_dataset::parameters! {
    /// How the engine steps.
    pub struct Physics {
        /// Engine time step.
        time_step_s: f64 = 0.004, "s", 0.0005..=0.01;
        /// Engine steps in one control period.
        steps_per_tick: u32 = 2, "1", 1.0..=16.0;
        /// Solver iterations (substeps) of one step.
        solver_iterations: u32 = 1, "1", 1.0..=16.0;
        /// Projected Gauss-Seidel sweeps of one iteration; fewer let a standing robot creep.
        pgs_iterations: u32 = 4, "1", 1.0..=16.0;
        /// Size of a typical body, which scales the engine's tolerances.
        length_unit_m: f64 = 0.1, "m", 0.01..=1.0;
        /// Gravity.
        gravity_m_per_s2: f64 = 9.81, "m/s^2", 0.0..=20.0;
        /// Nominal Coulomb friction coefficient between robot and ground.
        friction: f64 = 0.8, "1", 0.01..=3.0;
        /// Standing still before the log begins.
        settle_s: f64 = 0.5, "s", 0.0..=5.0;
    }
}

/// How the engine holds the joints together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Joints {
    /// Reduced coordinates: joints cannot come apart.
    #[default]
    Multibody,
    /// Full coordinates with joint impulses; needs about 2 ms and 8 iterations.
    Impulse,
}

asami_dataset::parameters! {
    /// The virtual-wheel trot: diagonal pairs of legs, half-ellipse strides.
    pub struct Gait {
        /// One stride of a leg.
        period_s: f64 = 0.3636, "s", 0.1..=2.0;
        /// Share of the period that a foot is on the ground.
        duty: f64 = 0.5526, "1", 0.3..=0.9;
        /// Height of a full stride.
        lift_m: f64 = 0.034, "m", 0.0..=0.08;
        /// Fore hips above the fore feet's centres.
        fore_height_m: f64 = 0.1074, "m", 0.03..=0.14;
        /// Hind hips above the hind feet's centres.
        hind_height_m: f64 = 0.0866, "m", 0.03..=0.145;
        /// Fore feet at rest, before their hips.
        fore_offset_m: f64 = 0.0307, "m", -0.08..=0.08;
        /// Hind feet at rest, before their hips.
        hind_offset_m: f64 = -0.0282, "m", -0.08..=0.08;
        /// Feet at rest, outward of their hips.
        outward_offset_m: f64 = 0.0, "m", -0.01..=0.05;
        /// How a lifted foot moves forward: 0 at even speed, 1 starting and ending at rest.
        swing_easing: f64 = 0.1542, "1", 0.0..=1.0;
        /// Time constant with which the attempted velocity follows the command.
        command_lag_s: f64 = 0.12, "s", 0.0..=2.0;
        /// Attempted speed from which strides are lifted fully; below, the lift shrinks with it.
        full_lift_speed_m_per_s: f64 = 0.02, "m/s", 0.001..=0.3;
        /// Least share of a full lift: 0 stands still when told to stand, 1 steps in place.
        least_lift: f64 = 0.0, "1", 0.0..=1.0;
    }
}

asami_dataset::parameters! {
    /// The joints' servo motors.
    pub struct Servo {
        /// Torque for each radian of error.
        stiffness_n_m_per_rad: f64 = 15.0, "N.m/rad", 0.0..=200.0;
        /// Torque against each radian per second.
        damping_n_m_s_per_rad: f64 = 0.15, "N.m.s/rad", 0.0..=10.0;
        /// Inertia of the motor as the joint feels it (multibody joints only).
        armature_kg_m2: f64 = 2e-4, "kg.m^2", 0.0..=0.1;
        /// Factor on the body's joint speed limits.
        speed_limit_ratio: f64 = 1.0, "1", 0.1..=10.0;
        /// Standard deviation of the leg set-points about where the gait wants them, new each tick.
        set_point_jitter_rad: f64 = 0.0, "rad", 0.0..=0.1;
    }
}

asami_dataset::parameters! {
    /// Where the head is held.
    pub struct Head {
        /// Neck, leaning forward from upright in the stance. The head pans about the neck, so that only an
        /// upright one keeps a panning camera level.
        neck_lean_rad: f64 = 0.0, "rad", 0.0..=1.3;
        /// Camera above level.
        camera_pitch_rad: f64 = 0.0, "rad", -0.3..=0.3;
        /// Greatest pan either way while scanning; 0 looks straight ahead.
        scan_amplitude_rad: f64 = 0.0, "rad", 0.0..=1.6;
        /// From left to right and back.
        scan_period_s: f64 = 2.0, "s", 0.5..=20.0;
        /// The pan that a frame is paired with was read at some time of a span of this length about the exposure of the
        /// middle rows, new each frame: joints are read out in batches that keep no step with the camera.
        pan_reading_span_s: f64 = 0.0, "s", 0.0..=0.035;
    }
}

asami_dataset::parameters! {
    /// What differs from step to step in a real room.
    pub struct Disturbance {
        /// Standard deviation of the logarithm of each foot's friction.
        friction_log_sd: f64 = 0.15, "1", 0.0..=1.0;
        /// How long one draw of it lasts.
        friction_hold_s: f64 = 0.24, "s", 0.008..=10.0;
    }
}

asami_dataset::parameters! {
    /// Turning towards the field's first beacon, below the command and the log.
    pub struct HeadingHold {
        /// Turning rate for each radian of bearing; 0 switches it off.
        gain_per_s: f64 = 1.5, "1/s", 0.0..=10.0;
        /// Greatest turning rate it asks for.
        clip_rad_per_s: f64 = 0.6, "rad/s", 0.0..=2.0;
        /// It lets go when the beacon has not been seen for this long.
        memory_s: f64 = 1.0, "s", 0.0..=10.0;
    }
}

asami_dataset::tables! {
    /// The robot's tables in a scenario.
    pub struct AiboConfig {
        /// `[aibo.physics]`
        physics: Physics;
        /// `[aibo.gait]`
        gait: Gait;
        /// `[aibo.servo]`
        servo: Servo;
        /// `[aibo.head]`
        head: Head;
        /// `[aibo.disturbance]`
        disturbance: Disturbance;
        /// `[aibo.heading_hold]`
        heading_hold: HeadingHold;
    }
    keys {
        /// Kind of joints.
        joints: Joints;
    }
}

impl Physics {
    /// One control period.
    #[must_use]
    pub fn tick_s(&self) -> f64 {
        self.time_step_s * f64::from(self.steps_per_tick)
    }
}
