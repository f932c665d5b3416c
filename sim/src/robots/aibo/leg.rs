//! Kinematics of one leg: rotator, elevator and knee.
//!
//! Hip frame, as in the URDF: x forward, z up; the second coordinate is *outward* from the body, so that
//! left and right legs share one set of equations.

use asami_math::elementary::{acos, asin, atan2, sin_cos};

/// Lengths and limits of a leg.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// From the torso's origin to the hip: forward, left, up.
    pub hip_m: [f64; 3],
    /// `+1` on the left, `-1` on the right.
    pub side: f64,
    /// `-1` where bending brings the foot forward (fore legs), `+1` where back (hind legs).
    pub bend: f64,
    /// Hip to knee.
    pub thigh_m: f64,
    /// Knee to the foot's centre.
    pub shank_m: f64,
    /// Least and greatest angle of rotator, elevator and knee.
    pub limits_rad: [[f64; 2]; 3],
}

impl Leg {
    /// Where joint angles put the foot: forward, outward and up of the hip.
    #[must_use]
    pub fn foot_m(&self, angles_rad: [f64; 3]) -> [f64; 3] {
        let [(sin_r, cos_r), (sin_e, cos_e), (sin_k, cos_k)] = angles_rad.map(sin_cos);
        let ahead_m = -self.shank_m * sin_k;
        let reach_m = self.thigh_m + self.shank_m * cos_k;
        let (outward_m, below_m) = (reach_m * sin_e, reach_m * cos_e);
        [cos_r * ahead_m - sin_r * below_m, outward_m, -sin_r * ahead_m - cos_r * below_m]
    }

    /// Joint angles that put the foot there, or as near as the joints' limits let each of them go.
    #[must_use]
    pub fn angles_rad(&self, foot_m: [f64; 3]) -> [f64; 3] {
        let [forward_m, outward_m, up_m] = foot_m;
        let (thigh_m, shank_m) = (self.thigh_m, self.shank_m);
        // Law of cosines in the plane of thigh and shank.
        let square_m2 = forward_m * forward_m + outward_m * outward_m + up_m * up_m;
        let cos_k = (square_m2 - thigh_m * thigh_m - shank_m * shank_m) / (2.0 * thigh_m * shank_m);
        let knee_rad = self.clamped(2, self.bend * acos(cos_k.clamp(-1.0, 1.0)));
        let (sin_k, cos_k) = sin_cos(knee_rad);
        let ahead_m = -shank_m * sin_k;
        let reach_m = thigh_m + shank_m * cos_k;
        let elevator_rad = self.clamped(1, asin((outward_m / reach_m).clamp(-1.0, 1.0)));
        let below_m = reach_m * sin_cos(elevator_rad).1;
        // The rotator turns (ahead, -below) into (forward, up).
        let rotator_rad = atan2(-up_m * ahead_m - forward_m * below_m, forward_m * ahead_m - up_m * below_m);
        [self.clamped(0, rotator_rad), elevator_rad, knee_rad]
    }

    fn clamped(&self, joint: usize, angle_rad: f64) -> f64 {
        let [least_rad, greatest_rad] = self.limits_rad[joint];
        angle_rad.clamp(least_rad, greatest_rad)
    }
}
