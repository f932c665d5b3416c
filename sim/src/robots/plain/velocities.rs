//! The true action model: which velocities an action leads to.

use asami_dataset::Seed;
use rand_distr::{Distribution, StandardNormal};

use super::config::Distortion;
use crate::drives::suite::{Suite, normalised};
use crate::knobs::MotorKnobs;

/// Right, forward, counter-clockwise.
pub type Velocity = [f64; 3];

/// From attempted velocities `u`, in units of the suite's greatest, to true ones:
/// `v_i = range_i (sum_j mix_ij u_j (1 - bend |u_j|) + |u| (bias_i + irregular_i(id)))`.
///
/// What comes on top shrinks with the attempted speed: a robot that attempts nothing stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Velocities {
    greatest: Velocity,
    bend: f64,
    mix: [[f64; 3]; 3],
    bias: [f64; 3],
    irregular: Vec<[f64; 3]>,
    range: [f64; 3],
}

impl Velocities {
    /// Draws a robot's own velocities for the actions of `suite`, their ranges exactly as `distortion` has
    /// them.
    #[must_use]
    pub fn new(distortion: &Distortion, suite: &Suite) -> Self {
        let mut rng = Seed(distortion.robot).stream("plain/velocities");
        let mut three = |sd: f64| -> [f64; 3] {
            std::array::from_fn(|_| {
                let normal: f64 = StandardNormal.sample(&mut rng);
                sd * normal
            })
        };
        let mut mix = [three(distortion.leak_sd), three(distortion.leak_sd), three(distortion.leak_sd)];
        for (i, row) in mix.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        let bias = three(distortion.bias_sd);
        let irregular = normalised().map(|_| three(distortion.irregular_sd)).collect();
        let greatest = [suite.max_right_m_per_s, suite.max_forward_m_per_s, suite.max_turn_rad_per_s];
        let wanted =
            [distortion.right_range_m_per_s, distortion.forward_range_m_per_s, distortion.turn_range_rad_per_s];
        let unscaled = Self { greatest, bend: distortion.bend, mix, bias, irregular, range: [1.0; 3] };
        let extents = unscaled.extents();
        Self { range: std::array::from_fn(|i| wanted[i] / extents[i]), ..unscaled }
    }

    /// Velocities of the action `id`, or of one without an id, that attempts `attempt`.
    ///
    /// Slower motors reach a part of the greatest attempt and no more. Torque is needed in proportion to speed: of
    /// what it lacks, half is lost in speed where an action attempts the greatest.
    #[must_use]
    pub fn of(&self, id: Option<u16>, attempt: Velocity, motors: &MotorKnobs) -> Velocity {
        let reach = if motors.speed_ratio < 1.0 { motors.speed_ratio } else { f64::INFINITY };
        let u = std::array::from_fn(|i| (attempt[i] / self.greatest[i]).clamp(-reach, reach));
        self.of_normalised(id, u, 0.5 * (1.0 - motors.mean_torque_ratio()))
    }

    /// `droop` comes on top of the bend.
    fn of_normalised(&self, id: Option<u16>, u: [f64; 3], droop: f64) -> Velocity {
        let bend = self.bend + droop;
        let speed = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt();
        let irregular = id.and_then(|id| self.irregular.get(usize::from(id))).copied().unwrap_or_default();
        std::array::from_fn(|i| {
            let mixed: f64 = self.mix[i].iter().zip(u).map(|(share, u)| share * u * (1.0 - bend * u.abs())).sum();
            self.range[i] * (mixed + speed * (self.bias[i] + irregular[i]))
        })
    }

    /// From least to greatest velocity over the 40 actions, in each direction.
    fn extents(&self) -> Velocity {
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (id, u) in (0..).zip(normalised()) {
            for (i, v) in self.of_normalised(Some(id), u, 0.0).into_iter().enumerate() {
                least[i] = if v < least[i] { v } else { least[i] };
                most[i] = if v > most[i] { v } else { most[i] };
            }
        }
        std::array::from_fn(|i| most[i] - least[i])
    }
}
