//! Truth about the models, measured "with a stopwatch and a tape measure" (Stronger 2008, 3.3.2).

/// Speed at one forward command, from line crossings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Commanded forward speed.
    pub command_m_per_s: f64,
    /// Mean measured speed over the timings.
    pub speed_m_per_s: f64,
    /// Standard deviation over the timings.
    pub sd_m_per_s: f64,
    /// How many timings.
    pub timings: u32,
}

/// Height of the beacon in the image at one distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// From the body's centre to the beacon.
    pub distance_m: f64,
    /// Mean over the readings.
    pub height_px: f64,
    /// Standard deviation over the readings.
    pub sd_px: f64,
    /// Standard deviation of the bearing over the readings.
    pub bearing_sd_rad: f64,
    /// How many readings.
    pub readings: u32,
}

/// Velocity of one discrete action in the robot frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    /// Id of the action.
    pub action: u16,
    /// Rightward.
    pub vx_m_per_s: f64,
    /// Forward.
    pub vy_m_per_s: f64,
    /// Counter-clockwise.
    pub vtheta_rad_per_s: f64,
}

/// `survey.toml`: truth about the models. Learners never see it. Lists that were not surveyed are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// In order of command.
    pub speed_by_command: Vec<Speed>,
    /// In order of distance.
    pub height_by_distance: Vec<Height>,
    /// In order of action.
    pub velocity_by_action: Vec<Velocity>,
    /// Sighting noise of the height.
    pub sigma1_px: Option<f64>,
    /// Sighting noise of the range.
    pub sigma1_m: Option<f64>,
    /// Sighting noise of the bearing.
    pub sigma2_rad: Option<f64>,
    /// Motion noise of one frame, right m, forward m, counter-clockwise rad.
    pub motion_sd: Option<[f64; 3]>,
    /// theta_l + theta_b of each laser, in order of vertical angle.
    pub horizontal_angles_rad: Vec<f64>,
    /// Angle of the laser scanner's base.
    pub theta_b_rad: Option<f64>,
}
