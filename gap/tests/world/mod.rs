//! The dissertation's own simulator (section 4.4.2) as a nominal world: four beacons, 40 actions.

use asami_dataset::{Seed, TruePose};
use asami_gap::{CannotPlay, Nominal, Variant};
use asami_sim::drives::explore::{Explore, Exploring};
use asami_sim::drives::suite::Suite;
use asami_sim::effects::Effects;
use asami_sim::robots::plain::{PlainConfig, PlainWorld};
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::world::{Drive, World};
use rand::RngExt;

/// Kinds of the effects of these names before its four beacons.
pub fn kinds(names: &[&str]) -> Vec<Variant> {
    let all = Variant::all("plain", 4, &[]);
    all.into_iter().filter(|variant| names.contains(&variant.about.name)).collect()
}

/// See the module.
pub struct Plain {
    /// The robot.
    pub config: PlainConfig,
    /// How it explores.
    pub exploring: Exploring,
    /// What stands on the field.
    pub field: Field,
    effects: Effects,
}

impl Default for Plain {
    fn default() -> Self {
        let corners = [(1.95, 1.35), (-1.95, 1.35), (-1.95, -1.35), (1.95, -1.35)];
        let beacon = |(id, (x_m, y_m)): (u16, (f64, f64))| {
            let bands = [Colour::Pink, Colour::Yellow];
            Landmark { id, body: Cylinder { x_m, y_m, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands } }
        };
        let beacons = (0..).zip(corners).map(beacon).collect();
        Self {
            config: PlainConfig::default(),
            exploring: Exploring::default(),
            effects: Effects::default(),
            field: Field { beacons, clutter: Vec::new() },
        }
    }
}

impl Nominal for Plain {
    fn robot(&self) -> &'static str {
        "plain"
    }

    fn landmarks(&self) -> usize {
        self.field.beacons.len()
    }

    fn effects(&self) -> &Effects {
        &self.effects
    }

    fn duration_s(&self) -> f64 {
        150.0
    }

    fn world(&self, effects: &Effects, seed: Seed) -> Result<Box<dyn World>, CannotPlay> {
        let mut rng = seed.stream("start");
        let y_m = 0.3 * (2.0 * rng.random::<f64>() - 1.0);
        let start = TruePose { t_s: 0.0, x_m: 0.0, y_m, theta_rad: 0.0, v_m_per_s: None };
        Ok(Box::new(PlainWorld::new(&self.config, &Suite::default(), &self.field, effects, start, seed)))
    }

    fn drive(&self, seed: Seed) -> Box<dyn Drive> {
        Box::new(Explore::new(self.exploring.clone(), Suite::default().actions(), seed.stream("drive")))
    }
}
