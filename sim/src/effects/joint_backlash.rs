//! Gears with play.

use asami_dataset::Rng;

use crate::effect::{Effect, Stage, effect};

effect! {
    /// Every leg joint follows its motor through play: it stays until one flank or the other pushes it.
    JointBacklash, "joint_backlash",
    "Leg joints follow their motors through play.",
    Actuation, StaticMotion, fits ["aibo"],
    source "gears of hobby servos have 1 to 2 degrees of play",
    drawn [play_rad: Size { way: Up, least: 0.005, greatest: 0.08 }],
    {
        /// From flank to flank.
        play_rad: f64 = 0.0, "rad", 0.0..=0.12;
    }
}

/// Four legs of three joints come first among the joints.
const LEG_JOINTS: usize = 12;

impl Effect for JointBacklash {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        if self.is_null() {
            return None;
        }
        let half_rad = 0.5 * self.play_rad;
        let mut pushed_rad: Option<[f64; LEG_JOINTS]> = None;
        Some(Stage::Joint(Box::new(move |_, aimed_rad| {
            let joints = pushed_rad.get_or_insert_with(|| {
                let mut start_rad = [0.0; LEG_JOINTS];
                start_rad.iter_mut().zip(aimed_rad.iter()).for_each(|(start, aimed)| *start = *aimed);
                start_rad
            });
            for (joint, aimed) in joints.iter_mut().zip(aimed_rad) {
                *joint = joint.clamp(*aimed - half_rad, *aimed + half_rad);
                *aimed = *joint;
            }
        })))
    }
}
