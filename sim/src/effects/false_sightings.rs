//! Landmarks that are reported and not there.

use asami_dataset::{Rng, Sighting, Size};
use asami_math::angle::wrap_rad;
use rand::RngExt;

use crate::effect::{Effect, Glance, Stage, effect};

effect! {
    /// In a share of the frames something in view is taken for a landmark.
    FalseSightings, "false_sightings",
    "In a share of the frames something else in view is taken for a landmark.",
    Sensing, Noise, fits ["aibo", "plain", "create"],
    source "section 4.4.1 names false sightings among the robot's outliers; colour vision near spectators sees one in a hundred frames to one in ten",
    drawn [share: Size { way: Up, least: 0.001, greatest: 0.1 }],
    {
        /// Share of the frames.
        share: f64 = 0.0, "1", 0.0..=0.3;
    }
}

impl Effect for FalseSightings {
    fn stage(&self, mut rng: Rng) -> Option<Stage> {
        let share = self.share;
        Some(Stage::Sighting(Box::new(move |glance, sightings| {
            let draws = std::array::from_fn(|_| rng.random::<f64>());
            if let Some(mistaken) = (draws[0] < share).then(|| mistake(glance, draws)).flatten() {
                // The vision reports a landmark once: the impostor hides it.
                sightings.retain(|sighting| sighting.landmark != mistaken.landmark);
                sightings.push(mistaken);
            }
        })))
    }
}

/// Any landmark, anywhere in view, as far away as any: heights go with the inverse of distance.
fn mistake(glance: &Glance, [_, which, across, far]: [f64; 4]) -> Option<Sighting> {
    let landmark = *glance.landmarks.get((which * glance.landmarks.len() as f64) as usize)?;
    let size = match glance.sizes {
        [Size::RangeM(near_m), Size::RangeM(far_m)] => Size::RangeM(near_m + far * (far_m - near_m)),
        [least, greatest] => Size::HeightPx(1.0 / (far / least.value() + (1.0 - far) / greatest.value())),
    };
    let bearing_rad = wrap_rad(glance.frame.head_pan_rad + glance.view_rad * (across - 0.5));
    Some(Sighting { t_s: glance.frame.t_s, landmark, size, bearing_rad })
}
