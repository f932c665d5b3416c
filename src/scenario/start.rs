//! Models that learners are given: to start from, or as known.

use asami_dataset::models::Entry;
use asami_dataset::{ActionModel, Log, Models, Noise, SensorModel};
use asami_learners::line::Unit;
use asami_learners::plane::{Discrete, Plane};
use asami_learners::{CannotLearn, Needs};
use asami_math::polynomial::Polynomial;
use serde::{Deserialize, Serialize};

/// A model that a learner is given: to start from, or as known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// `A0(c) = c`: attempted velocities are correct (Stronger 2008, section 3.3.2).
    C,
    /// `A0(c) = Sgn(c)`: only the direction (section 3.3.3).
    Sgn,
    /// `A0(c) = 1`: nothing (section 3.3.3).
    One,
    /// The quartic that fits the surveyed speeds best, as given in section 3.3.3's degree selection.
    ReferenceQuartic,
    /// The cubic that fits the surveyed heights best, for learning an action model alone.
    ReferenceCubic,
    /// Chapter 4's: no action has an effect, f is poor and linear, the noise is far off (section 4.4.1).
    Published,
    /// The same, but the velocities are those attempted.
    Attempted,
    /// As published, f worse by one step.
    #[serde(rename = "f_worse_1")]
    FWorse1,
    /// As published, f worse by two steps.
    #[serde(rename = "f_worse_2")]
    FWorse2,
    /// As published, f worse by three steps.
    #[serde(rename = "f_worse_3")]
    FWorse3,
    /// As published, standard deviations of the motion halved.
    SigmaMHalf,
    /// As published, standard deviations of the motion doubled.
    SigmaMDouble,
    /// Chapter 5's: a good action model for the first guess of scan matching, the one that fits the reference's motions best.
    ReferenceCar,
    /// A poor one: the same with all coefficients halved.
    HalfCar,
}

impl Start {
    /// Chapter 4's, in the order of their table.
    pub const CHAPTER_4: [Start; 7] = [
        Start::Published,
        Start::Attempted,
        Start::FWorse1,
        Start::FWorse2,
        Start::FWorse3,
        Start::SigmaMHalf,
        Start::SigmaMDouble,
    ];

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Start::C => "c",
            Start::Sgn => "sgn",
            Start::One => "one",
            Start::ReferenceQuartic => "reference_quartic",
            Start::ReferenceCubic => "reference_cubic",
            Start::Published => "published",
            Start::Attempted => "attempted",
            Start::FWorse1 => "f_worse_1",
            Start::FWorse2 => "f_worse_2",
            Start::FWorse3 => "f_worse_3",
            Start::SigmaMHalf => "sigma_m_half",
            Start::SigmaMDouble => "sigma_m_double",
            Start::ReferenceCar => "reference_car",
            Start::HalfCar => "half_car",
        }
    }

    /// Whether a learner that needs `needs` can be given it.
    #[must_use]
    pub fn fits(self, needs: Needs) -> bool {
        match needs {
            Needs::Nothing => false,
            Needs::Firings => matches!(self, Start::ReferenceCar | Start::HalfCar),
            Needs::Action => matches!(self, Start::C | Start::Sgn | Start::One | Start::ReferenceQuartic),
            Needs::Sensor => self == Start::ReferenceCubic,
            Needs::Both => Start::CHAPTER_4.contains(&self),
        }
    }

    /// Chapter 3's action models, where they need no truth.
    #[must_use]
    pub fn models(self) -> Option<Models> {
        let action = match self {
            Start::C => ActionModel::Polynomial(Polynomial::plain(vec![0.0, 1.0]).into()),
            Start::Sgn => ActionModel::Sign,
            Start::One => ActionModel::Polynomial(Polynomial::plain(vec![1.0]).into()),
            _ => return None,
        };
        Some(Models { action: Some(action), ..Models::default() })
    }

    /// Steps by which f is worse than published.
    fn steps_worse(self) -> f64 {
        match self {
            Start::FWorse1 => 1.0,
            Start::FWorse2 => 2.0,
            Start::FWorse3 => 3.0,
            _ => 0.0,
        }
    }

    /// Factor on the standard deviations of the motion.
    fn motion_factor(self) -> f64 {
        match self {
            Start::SigmaMHalf => 0.5,
            Start::SigmaMDouble => 2.0,
            _ => 1.0,
        }
    }
}

asami_dataset::parameters! {
    /// Chapter 4's starting models in numbers. The dissertation shows its poor linear f in Figure 4.3 only:
    /// here f has `f_mid_px` at `mid_m` and falls by `f_fall_px_per_m`. One that is worse by n steps keeps its
    /// middle and loses `worse_share` of its fall n times: it flattens, and at last rises.
    pub struct Starting {
        /// Distance about which f turns as it gets worse.
        mid_m: f64 = 2.7, "m", 0.1..=100.0;
        /// f there, of heights.
        f_mid_px: f64 = 25.0, "px", 0.0..=1000.0;
        /// How fast f falls with the distance, of heights.
        f_fall_px_per_m: f64 = 5.0, "px/m", -100.0..=100.0;
        /// f in the middle, of ranges.
        f_mid_m: f64 = 3.5, "m", 0.0..=100.0;
        /// How fast f rises with the distance, of ranges.
        f_rise_m_per_m: f64 = 0.5, "1", -10.0..=10.0;
        /// Share of the slope that each step of `f_worse_n` takes away.
        worse_share: f64 = 0.5, "1", 0.0..=2.0;
        /// Standard deviation of heights.
        sigma1_px: f64 = 10.0, "px", 0.01..=100.0;
        /// Standard deviation of ranges.
        sigma1_m: f64 = 1.0, "m", 0.001..=10.0;
        /// Standard deviation of bearings.
        sigma2_rad: f64 = 0.2, "rad", 0.001..=3.0;
        /// Standard deviation of a step's rightward displacement.
        motion_right_sd_m: f64 = 0.01, "m", 0.00001..=1.0;
        /// Standard deviation of a step's forward displacement.
        motion_forward_sd_m: f64 = 0.01, "m", 0.00001..=1.0;
        /// Standard deviation of a step's turn.
        motion_turn_sd_rad: f64 = 0.1, "rad", 0.00001..=3.0;
    }
}

impl Starting {
    /// Chapter 4's starting models for a log: its discrete actions, its kind of sightings.
    ///
    /// # Errors
    /// What the log lacks.
    pub fn models(&self, start: Start, log: &Log) -> Result<Models, CannotLearn> {
        let plane = Plane::along_a_line(log).or_else(|_| Plane::try_from(log))?;
        let entry = |action: &Discrete| {
            let [vx_m_per_s, vy_m_per_s, vtheta_rad_per_s] =
                if start == Start::Attempted { action.attempted } else { [0.0; 3] };
            Some(Entry { action: action.id?, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s, se: None })
        };
        let motion = [self.motion_right_sd_m, self.motion_forward_sd_m, self.motion_turn_sd_rad];
        let noise = Noise {
            sigma2_rad: Some(self.sigma2_rad),
            motion_sd: Some(motion.map(|sd| sd * start.motion_factor())),
            ..Noise::default()
        };
        let noise = match plane.unit {
            Unit::HeightPx => Noise { sigma1_px: Some(self.sigma1_px), ..noise },
            Unit::RangeM => Noise { sigma1_m: Some(self.sigma1_m), ..noise },
        };
        let entries = plane.actions.iter().filter_map(entry).collect();
        let sensor = Some(self.sensor(start, plane.unit));
        Ok(Models { action: Some(ActionModel::Table(entries)), sensor, noise })
    }

    /// The linear f that a learner starts from.
    #[must_use]
    pub fn sensor(&self, start: Start, unit: Unit) -> SensorModel {
        let slope_share = 1.0 - self.worse_share * start.steps_worse();
        let line = |middle: f64, slope: f64| {
            let slope = slope * slope_share;
            Polynomial::plain(vec![middle - slope * self.mid_m, slope]).into()
        };
        match unit {
            Unit::HeightPx => SensorModel::HeightOfDistance(line(self.f_mid_px, -self.f_fall_px_per_m)),
            Unit::RangeM => SensorModel::RangeOfDistance(line(self.f_mid_m, self.f_rise_m_per_m)),
        }
    }
}

#[cfg(test)]
mod tests;
