//! A landmark that does not stand where the robot thinks it does.

use std::f64::consts::FRAC_PI_2;

use asami_math::elementary::sin_cos;

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// One landmark was shifted; the robot still knows its old place.
    LandmarkMoved, "landmark_moved",
    "One landmark does not stand where the robot thinks it does.",
    Scene, Sensor, fits ["aibo", "plain", "create"],
    source "a beacon that was bumped into is off by a hand's breadth, one that was put back by hand by up to half a metre",
    drawn [
        distance_m: Size { way: Either, least: 0.01, greatest: 0.8 }, towards_rad: Choice(&[0.0, FRAC_PI_2]),
        number: Landmark(&[0.0, 1.0, 2.0, 3.0]),
    ],
    {
        /// From its place on the map to where it stands.
        distance_m: f64 = 0.0, "m", -1.5..=1.5;
        /// In which direction: counter-clockwise from world +y.
        towards_rad: f64 = 0.0, "rad", -3.15..=3.15;
        /// Which landmark: counted from 0 in the order of their ids, and round again.
        number: u16 = 0, "1", 0.0..=1000.0;
    }
}

impl Effect for LandmarkMoved {
    /// Which landmark and whereto do not matter where nothing moves.
    fn is_null(&self) -> bool {
        self.distance_m == 0.0
    }

    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        if self.is_null() {
            return;
        }
        let (to_left, ahead) = sin_cos(self.towards_rad);
        let shift_m = [-self.distance_m * to_left, self.distance_m * ahead];
        knobs.scene.moved = Some((usize::from(self.number), shift_m));
    }
}
