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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::blueprint::Blueprint;
    use super::*;

    fn legs() -> [Leg; 4] {
        Blueprint::shipped().expect("the shipped body parses").legs
    }

    #[test]
    fn straight_leg_hangs_below_its_hip() {
        for leg in legs() {
            assert_eq!(leg.foot_m([0.0; 3]), [0.0, 0.0, -(leg.thigh_m + leg.shank_m)]);
        }
    }

    proptest! {
        #[test]
        fn inverse_kinematics_is_inverse(i in 0usize..4, forward in -0.05..0.05f64, outward in 0.0..0.04f64, up in -0.12..-0.075f64) {
            let leg = &legs()[i];
            let wanted = [forward, outward, up];
            let got = leg.foot_m(leg.angles_rad(wanted));
            for (got, wanted) in got.iter().zip(wanted) {
                // The law of cosines loses half the digits where the leg is straight.
                prop_assert!((got - wanted).abs() < 1e-9, "{got} for {wanted}");
            }
        }

        #[test]
        fn no_angle_leaves_its_range(i in 0usize..4, forward in -1.0..1.0f64, outward in -1.0..1.0f64, up in -1.0..1.0f64) {
            let leg = &legs()[i];
            for (angle, [least, greatest]) in leg.angles_rad([forward, outward, up]).iter().zip(leg.limits_rad) {
                prop_assert!((least..=greatest).contains(angle));
            }
        }
    }

    /// The thigh-and-shank chain is a distance-preserving one: turning the rotator moves the foot on a circle
    /// about the hip's left-right axis.
    #[test]
    fn rotator_turns_the_foot_about_the_hip() {
        for leg in legs() {
            let [forward, outward, up] = leg.foot_m([0.0, 0.3, leg.bend]);
            let turned = leg.foot_m([0.7, 0.3, leg.bend]);
            assert_eq!(outward, turned[1]);
            assert!((forward.hypot(up) - turned[0].hypot(turned[2])).abs() < 1e-15);
            let angle = (turned[2].atan2(turned[0]) - up.atan2(forward)).rem_euclid(std::f64::consts::TAU);
            assert!((angle - (std::f64::consts::TAU - 0.7)).abs() < 1e-12, "positive swings back: {angle}");
        }
    }
}
