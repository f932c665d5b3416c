//! What a robot can know about itself. Closed enums: one scorer per variant.

use asami_math::polynomial::Polynomial;

/// A polynomial with the standard errors of its coefficients (empty: unknown).
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The curve.
    pub polynomial: Polynomial,
    /// One standard error per coefficient, in its unit; empty where the learner gives none.
    pub se: Vec<f64>,
}

impl From<Polynomial> for Curve {
    fn from(polynomial: Polynomial) -> Self {
        Self { polynomial, se: Vec::new() }
    }
}

/// Learned velocity of one discrete action in the robot frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Id of the action.
    pub action: u16,
    /// Rightward.
    pub vx_m_per_s: f64,
    /// Forward.
    pub vy_m_per_s: f64,
    /// Counter-clockwise.
    pub vtheta_rad_per_s: f64,
    /// Standard errors of the three.
    pub se: Option<[f64; 3]>,
}

/// From the action to the velocity.
#[derive(Clone, Debug, PartialEq)]
pub enum ActionModel {
    /// Forward speed as a polynomial of the commanded forward speed (chapter 3), m/s or, where the
    /// learner works without units, in units of its own.
    Polynomial(Curve),
    /// The sign of the commanded speed (Table 3.1's second starting model).
    Sign,
    /// A velocity for each discrete action (chapter 4).
    Table(Vec<Entry>),
    /// `a = c5 + c6 g + c7 v + c8 v b; omega = c9 v + c10 v s` (eqs 2.30 to 2.34).
    Car {
        /// c5 to c10.
        c: [f64; 6],
        /// Standard errors of the six.
        se: Option<[f64; 6]>,
        /// Actuator delay.
        delay_s: f64,
    },
}

impl ActionModel {
    /// Forward speed at a commanded forward speed; `None` for models of another kind.
    #[must_use]
    pub fn forward_at(&self, command_m_per_s: f64) -> Option<f64> {
        match self {
            ActionModel::Polynomial(curve) => Some(curve.polynomial.at(command_m_per_s)),
            // f64::signum has no zero.
            ActionModel::Sign if command_m_per_s == 0.0 => Some(0.0),
            ActionModel::Sign => Some(command_m_per_s.signum()),
            ActionModel::Table(_) | ActionModel::Car { .. } => None,
        }
    }
}

/// From the state to the observation, or the inverse.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorModel {
    /// Height in pixels of distance in metres (chapter 4's f).
    HeightOfDistance(Curve),
    /// Distance of the observation, height in pixels or range in metres (chapter 3's S).
    DistanceOfHeight(Curve),
    /// Measured range of true distance, both in metres.
    RangeOfDistance(Curve),
    /// theta_l + theta_b of each laser, in order of vertical angle, and their standard errors.
    Angles {
        /// One per laser.
        horizontal_angles_rad: Vec<f64>,
        /// One per laser, or empty.
        se_rad: Vec<f64>,
    },
}

/// Noise of the sensor and of the motion, as far as it was learned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Of the height.
    pub sigma1_px: Option<f64>,
    /// Of the range.
    pub sigma1_m: Option<f64>,
    /// Of the bearing.
    pub sigma2_rad: Option<f64>,
    /// Of the motion, in the robot frame: standard deviation rightward in m, forward in m, and of the turn
    /// in rad, a step of the learner (a frame of median length).
    pub motion_sd: Option<[f64; 3]>,
    /// Standard errors of these, as far as they are known.
    pub se: NoiseErrors,
}

/// Standard errors of what was learned of the noise, each in the unit of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseErrors {
    /// Of `sigma1_px` or `sigma1_m`.
    pub sigma1: Option<f64>,
    /// Of `sigma2_rad`.
    pub sigma2_rad: Option<f64>,
    /// Of `motion_sd`.
    pub motion_sd: Option<[f64; 3]>,
}

/// Learned or given models; a part that was not learned is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Models {
    /// Action model.
    pub action: Option<ActionModel>,
    /// Sensor model.
    pub sensor: Option<SensorModel>,
    /// Noise.
    pub noise: Noise,
}
