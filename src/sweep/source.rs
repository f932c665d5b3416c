//! Where a sweep's logs come from.

use std::path::Path;

use asami_dataset::{Dataset, Seed, Survey, Truth, store};
use asami_sim::robots::aibo::blueprint::URDF;

use crate::import;
use crate::report::exhibits::{self, Exhibits};
use crate::scenario::{Recording, Scenario, Simulation};
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

    /// What a report shows of the robot beside its logs; by default nothing.
    fn exhibits(&self) -> Exhibits {
        Exhibits::default()
    }
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

    fn exhibits(&self) -> Exhibits {
        // A robot that cannot be built has failed every trial already: the page says so without pictures.
        exhibits::of(&self.simulation).unwrap_or_default()
    }
}

/// Seed of the learners' own draws on a recorded log.
const RECORDED_SEED: u64 = 1;

/// Windows of a recorded log.
pub struct Recorded {
    recording: Recording,
    whole: Dataset,
}

impl Recorded {
    /// Reads the recording at `path`.
    ///
    /// # Errors
    /// A report on what is missing or wrong, or which window lies outside the log.
    pub fn open(recording: &Recording, path: &Path) -> Result<Self, miette::Report> {
        let formats = import::catalogue();
        let importer = recording.format.as_deref().and_then(|name| formats.iter().find(|it| it.name == name));
        let whole = match importer {
            Some(importer) => importer.import(path, None).map_err(|error| miette::miette!("{error}"))?.dataset,
            None => store::read(path).map_err(crate::verb::shown)?,
        };
        let (first_s, last_s) = whole.log.span_s().unwrap_or((0.0, 0.0));
        for window in &recording.windows {
            // The last row may come one period before the window ends.
            if window.start_s < first_s - 1.0 || window.span_s().end > last_s + 1.0 {
                let (start_s, end_s) = (window.span_s().start, window.span_s().end);
                let shown = path.display();
                return Err(miette::miette!(
                    "{shown}: the log lasts from {first_s} to {last_s} s; the window {start_s}..{end_s} s lies outside"
                ));
            }
        }
        Ok(Self { recording: recording.clone(), whole })
    }
}

impl Source for Recorded {
    fn cases(&self) -> Vec<Case> {
        self.recording.windows.iter().map(|window| Case { seed: RECORDED_SEED, window: Some(*window) }).collect()
    }

    fn dataset(&self, case: &Case) -> Result<Dataset, String> {
        let Some(window) = case.window else { return Err("a recording has windows, not seeds".into()) };
        let track = self.whole.truth.track.window(&window.span_s());
        let truth = Truth { track, survey: self.whole.truth.survey.clone() };
        let provenance = self.whole.provenance.clone();
        Ok(Dataset { log: self.whole.log.window(window.span_s()), truth, provenance })
    }

    fn fingerprint(&self) -> String {
        blake3::hash(format!("{:?}", self.whole).as_bytes()).to_hex().to_string()
    }

    fn survey(&self) -> Option<Survey> {
        None
    }
}
