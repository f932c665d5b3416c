//! Landmarks that are in view and not reported.

use asami_dataset::Rng;
use rand::RngExt;

use crate::effect::{Effect, Stage, effect};

effect! {
    /// The vision overlooks a share of what it would have recognised.
    MissedSightings, "missed_sightings",
    "The vision overlooks a share of the landmarks that it would have recognised.",
    Sensing, Noise, fits ["aibo", "plain", "create"],
    source "the robot of section 4.4.1 reported 9148 landmarks in 26 815 frames; shade and spectators hide more",
    drawn [share: Size { way: Up, least: 0.02, greatest: 0.6 }],
    {
        /// Share overlooked.
        share: f64 = 0.0, "1", 0.0..=0.9;
    }
}

impl Effect for MissedSightings {
    fn stage(&self, mut rng: Rng) -> Option<Stage> {
        let share = self.share;
        Some(Stage::Sighting(Box::new(move |_, sightings| sightings.retain(|_| rng.random::<f64>() >= share))))
    }
}
