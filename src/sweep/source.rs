//! Where a sweep's logs come from.

use asami_dataset::{Dataset, Seed, Survey};
use asami_sim::robots::aibo::blueprint::URDF;

use crate::scenario::{Scenario, Simulation};
use crate::trial::Case;

/// Makes or reads the log of each case.
pub trait Source: Sync {
    /// The cases, in order.
    fn cases(&self) -> Vec<Case>;

    /// A case's log and the truth about it; or why there is none, which makes its trials errors.
    ///
    /// # Errors
    /// One sentence.
    fn dataset(&self, case: &Case) -> Result<Dataset, String>;

    /// A hash of everything beside the scenario that bears on the logs and their truth.
    fn fingerprint(&self) -> String;

    /// Truth about the models, where all cases share it.
    fn survey(&self) -> Option<Survey>;
}

/// Logs out of a simulated world.
pub struct Simulated {
    scenario: Scenario,
    simulation: Simulation,
    survey: Survey,
}

impl Simulated {
    /// The simulation of `scenario`, surveyed.
    #[must_use]
    pub fn new(scenario: &Scenario, simulation: &Simulation, survey: Survey) -> Self {
        Self { scenario: scenario.clone(), simulation: simulation.clone(), survey }
    }
}

impl Source for Simulated {
    fn cases(&self) -> Vec<Case> {
        let first = self.simulation.first_seed;
        (0..u64::from(self.simulation.seeds)).map(|i| Case { seed: first + i, window: None }).collect()
    }

    fn dataset(&self, case: &Case) -> Result<Dataset, String> {
        let seed = Seed(case.seed);
        let mut dataset = self.simulation.dataset(seed).map_err(|error| error.to_string())?;
        dataset.truth.survey = Some(self.survey.clone());
        dataset.provenance = Some(self.scenario.provenance(seed));
        Ok(dataset)
    }

    fn fingerprint(&self) -> String {
        // Debug shows every number by its shortest round trip: what differs at all differs here.
        let survey = format!("{:?}", self.survey);
        format!("{} {}", blake3::hash(URDF.as_bytes()).to_hex(), blake3::hash(survey.as_bytes()).to_hex())
    }

    fn survey(&self) -> Option<Survey> {
        Some(self.survey.clone())
    }
}
