//! A virtual-wheel trot: each foot circles a point fixed to the body as if it were the rim of a wheel
//! rolling on the ground at the attempted velocity.

use std::f64::consts::PI;

use asami_math::elementary::{asin, exp, hypot, sin_cos};

use super::config::Gait;
use super::leg::Leg;

/// Attempted velocity in the robot frame: rightward m/s, forward m/s, counter-clockwise rad/s.
pub type Attempt = [f64; 3];

/// A gait under way.
#[derive(Clone, Debug)]
pub struct Trot {
    gait: Gait,
    legs: [Leg; 4],
    phase: f64,
    attempt: Attempt,
    /// Torso above level, nose up, in the stance.
    pitch_rad: f64,
}

impl Trot {
    /// A gait at rest; `legs` in the order fore left, fore right, hind left, hind right, `phase` in
    /// `[0, 1)`.
    #[must_use]
    pub fn new(gait: Gait, legs: [Leg; 4], phase: f64) -> Self {
        let wheelbase_m = legs[0].hip_m[0] - legs[2].hip_m[0];
        let pitch_rad = asin(((gait.fore_height_m - gait.hind_height_m) / wheelbase_m).clamp(-1.0, 1.0));
        Self { gait, legs, phase, attempt: [0.0; 3], pitch_rad }
    }

    /// How far the torso is pitched nose up when all feet stand.
    #[must_use]
    pub fn pitch_rad(&self) -> f64 {
        self.pitch_rad
    }

    /// Moves on by one control period under `command`.
    pub fn step(&mut self, tick_s: f64, command: Attempt) {
        let lag_s = self.gait.command_lag_s;
        let follow = if lag_s > 0.0 { 1.0 - exp(-tick_s / lag_s) } else { 1.0 };
        for (attempt, command) in self.attempt.iter_mut().zip(command) {
            *attempt += follow * (command - *attempt);
        }
        self.phase = (self.phase + tick_s / self.gait.period_s).fract();
    }

    /// The legs' joint angles as they stand.
    #[must_use]
    pub fn angles_rad(&self) -> [[f64; 3]; 4] {
        std::array::from_fn(|i| self.legs[i].angles_rad(self.foot_m(i)))
    }

    /// Where foot `i` belongs: forward, outward, up of its hip in torso axes.
    fn foot_m(&self, i: usize) -> [f64; 3] {
        let (gait, leg) = (&self.gait, &self.legs[i]);
        let fore = leg.hip_m[0] > 0.0;
        let height_m = if fore { gait.fore_height_m } else { gait.hind_height_m };
        let offset_m = if fore { gait.fore_offset_m } else { gait.hind_offset_m };

        // The ground under the resting foot runs past at the attempted velocity, turning included.
        let [right, forward, turn] = self.attempt;
        let home_forward_m = leg.hip_m[0] + offset_m;
        let home_left_m = leg.hip_m[1] + leg.side * gait.outward_offset_m;
        let stance_s = gait.period_s * gait.duty;
        let stride_forward_m = (forward - turn * home_left_m) * stance_s;
        let stride_left_m = (-right + turn * home_forward_m) * stance_s;

        let (along, lift) = self.locus(i);
        let level = [
            offset_m + along * stride_forward_m,
            gait.outward_offset_m + leg.side * along * stride_left_m,
            -height_m + lift * gait.lift_m * self.liveliness(),
        ];
        // From level axes into the pitched torso's.
        let (sin, cos) = sin_cos(self.pitch_rad);
        [cos * level[0] + sin * level[2], level[1], -sin * level[0] + cos * level[2]]
    }

    /// Place of foot `i` on its path: along the stride in `[-1/2, 1/2]`, and lift in `[0, 1]`.
    fn locus(&self, i: usize) -> (f64, f64) {
        // Fore left trots with hind right.
        let phase = if i == 0 || i == 3 { self.phase } else { (self.phase + 0.5).fract() };
        let duty = self.gait.duty;
        if phase < duty {
            return (0.5 - phase / duty, 0.0);
        }
        let swung = (phase - duty) / (1.0 - duty);
        let (sin, cos) = sin_cos(PI * swung);
        let easing = self.gait.swing_easing;
        (-0.5 * cos * easing + (swung - 0.5) * (1.0 - easing), sin)
    }

    /// From 0 standing to 1 walking: strides shrink with the command, to nothing unless the gait steps in place.
    fn liveliness(&self) -> f64 {
        let [right, forward, turn] = self.attempt;
        let speed_m_per_s = hypot(right, forward) + (turn * self.legs[0].hip_m[0]).abs();
        (speed_m_per_s / self.gait.full_lift_speed_m_per_s).clamp(self.gait.least_lift, 1.0)
    }
}
