//! Where a sweep's logs come from.

use std::path::Path;

use asami_dataset::{Dataset, Log, Seed, Survey, TruePose, Truth};
use asami_sim::robots::aibo::blueprint::URDF;

use crate::binning::{self, Binning};
use crate::depths;
use crate::import;
use crate::report::exhibits::{self, Exhibits};
use crate::report::scans;
use crate::scenario::{Part, Policy, Recording, Robot, Scenario, Simulation, Study, Window};
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

    /// The same after the robot changed, where it does; by default it does not.
    fn changed(&self) -> Option<Survey> {
        None
    }

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
    changed: Option<Survey>,
}

impl Simulated {
    /// The simulation of `scenario`, surveyed, also after its change.
    #[must_use]
    pub fn new(scenario: &Scenario, simulation: &Simulation, survey: Survey, changed: Option<Survey>) -> Self {
        Self { scenario: scenario.clone(), simulation: simulation.clone(), survey, changed }
    }
}

impl Source for Simulated {
    fn cases(&self) -> Vec<Case> {
        let first = self.simulation.first_seed;
        (0..u64::from(self.simulation.seeds)).map(|i| Case { seed: first + i, ..Case::default() }).collect()
    }

    fn dataset(&self, case: &Case) -> Result<Dataset, String> {
        let seed = Seed(case.seed);
        let mut dataset = self.simulation.dataset(seed).map_err(|error| error.to_string())?;
        dataset.truth.survey.get_or_insert_with(|| self.survey.clone());
        if let Policy::Roam(roams) = &self.simulation.drive
            && let Some(binning) = &roams.binning
        {
            bin(&mut dataset, binning);
        }
        dataset.provenance = Some(self.scenario.provenance(seed));
        Ok(dataset)
    }

    fn fingerprint(&self) -> String {
        // Debug shows every number by its shortest round trip: what differs at all differs here.
        let survey = format!("{:?}", (&self.survey, &self.changed));
        format!("{} {}", blake3::hash(URDF.as_bytes()).to_hex(), blake3::hash(survey.as_bytes()).to_hex())
    }

    fn survey(&self) -> Option<Survey> {
        (self.simulation.robot != Robot::Car).then(|| self.survey.clone())
    }

    fn changed(&self) -> Option<Survey> {
        self.changed.clone()
    }

    fn exhibits(&self) -> Exhibits {
        match (self.simulation.robot, self.scenario.study) {
            // A robot that cannot be built has failed every trial already: the page says so without pictures.
            (Robot::Aibo, Study::Line) => exhibits::of(&self.simulation).unwrap_or_default(),
            (Robot::Car, _) => exhibits::of_car(&self.simulation).unwrap_or_default(),
            _ => Exhibits::default(),
        }
    }
}

/// Seed of the learners' own draws on a recorded log.
const RECORDED_SEED: u64 = 1;

/// Windows of recorded logs.
pub struct Recorded {
    recording: Recording,
    /// In order of robot.
    wholes: Vec<(Option<u16>, Dataset)>,
}

impl Recorded {
    /// Reads the recording at `path`.
    ///
    /// # Errors
    /// A report on what is missing or wrong, or which window lies outside the log.
    pub fn open(recording: &Recording, path: &Path) -> Result<Self, miette::Report> {
        Self::open_as(recording, path, <[TruePose]>::to_vec)
    }

    /// The same, whose truth is by the tracks that are made of those that are read.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_as(
        recording: &Recording,
        path: &Path,
        track: impl Fn(&[TruePose]) -> Vec<TruePose>,
    ) -> Result<Self, miette::Report> {
        let mut wholes: Vec<(Option<u16>, Dataset)> = Vec::new();
        for part in &recording.parts {
            if wholes.iter().all(|(robot, _)| *robot != part.robot) {
                let mut whole = read(recording, part.robot, path)?;
                whole.truth.track = track(&whole.truth.track).into();
                wholes.push((part.robot, whole));
            }
        }
        Self::of(recording, wholes, path)
    }

    /// Data sets as they come, each robot's in the place of its recording; `path` says in errors which they are.
    ///
    /// # Errors
    /// A report on which window lies outside the log.
    pub fn of(
        recording: &Recording,
        mut wholes: Vec<(Option<u16>, Dataset)>,
        path: &Path,
    ) -> Result<Self, miette::Report> {
        for (robot, whole) in &mut wholes {
            prepare(recording, *robot, whole);
            let whole = &*whole;
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
        }
        Ok(Self { recording: recording.clone(), wholes })
    }
}

fn read(recording: &Recording, robot: Option<u16>, path: &Path) -> Result<Dataset, miette::Report> {
    let formats = import::catalogue();
    let importer = recording.format.as_deref().and_then(|name| formats.iter().find(|it| it.name == name));
    match importer {
        Some(importer) => Ok(importer.import(path, robot).map_err(|error| miette::miette!("{error}"))?.dataset),
        None => crate::verb::dataset(path),
    }
}

/// Makes of a data set what its learners are given.
fn prepare(recording: &Recording, robot: Option<u16>, whole: &mut Dataset) {
    if let Some(depths) = &recording.depths {
        let mut robots: Vec<Option<u16>> = recording.parts.iter().map(|part| part.robot).collect();
        robots.dedup();
        let place = robots.iter().position(|it| *it == robot).unwrap_or_default();
        whole.log = depths::ranges(&whole.log, depths.axis_of(place));
    }
    if let Some(binning) = &recording.binning {
        bin(whole, binning);
    }
}

/// Makes discrete actions of a log's commands; their true velocities are those of the track.
fn bin(dataset: &mut Dataset, binning: &Binning) {
    dataset.log = binning.binned(&dataset.log);
    let velocity_by_action =
        binning::velocities(&dataset.log, &dataset.truth.track, binning.settle_s.unwrap_or_default());
    dataset.truth.survey = Some(Survey { velocity_by_action, ..dataset.truth.survey.take().unwrap_or_default() });
}

/// The log as if there were no landmarks but those of `ids`.
fn with_landmarks(log: &Log, ids: &[u16]) -> Log {
    let mut known = (*log.known).clone();
    known.landmarks.retain(|landmark| ids.contains(&landmark.id));
    let sightings: Vec<_> = log.sightings.iter().copied().filter(|seen| ids.contains(&seen.landmark)).collect();
    Log { known: known.into(), sightings: sightings.into(), ..log.clone() }
}

impl Source for Recorded {
    fn cases(&self) -> Vec<Case> {
        let case = |part: &Part, window: &Window| {
            let landmarks = part.landmarks.as_ref().map(|ids| ids.len() as u16);
            Case { seed: RECORDED_SEED, window: Some(*window), robot: part.robot, landmarks }
        };
        let Recording { parts, windows, .. } = &self.recording;
        parts.iter().flat_map(|part| windows.iter().map(move |window| case(part, window))).collect()
    }

    fn dataset(&self, case: &Case) -> Result<Dataset, String> {
        let Some(window) = case.window else { return Err("a recording has windows, not seeds".into()) };
        let whole = self.wholes.iter().find(|(robot, _)| *robot == case.robot);
        let (_, whole) = whole.ok_or("the recording has no such robot")?;
        let is_case = |part: &&Part| {
            part.robot == case.robot && part.landmarks.as_ref().map(|ids| ids.len() as u16) == case.landmarks
        };
        let part = self.recording.parts.iter().find(is_case).ok_or("the recording has no such part")?;
        let log = whole.log.window(window.span_s());
        let log = part.landmarks.as_ref().map_or_else(|| log.clone(), |ids| with_landmarks(&log, ids));
        let truth = Truth { track: whole.truth.track.window(&window.span_s()), survey: whole.truth.survey.clone() };
        Ok(Dataset { log, truth, provenance: whole.provenance.clone() })
    }

    fn fingerprint(&self) -> String {
        blake3::hash(format!("{:?}", self.wholes).as_bytes()).to_hex().to_string()
    }

    fn survey(&self) -> Option<Survey> {
        None
    }

    fn exhibits(&self) -> Exhibits {
        let Some((_, Dataset { log, truth, .. })) = self.wholes.first() else { return Exhibits::default() };
        let angles_rad = truth.survey.as_ref().map_or(&[][..], |survey| &survey.horizontal_angles_rad);
        Exhibits { scans: scans::plates(log, angles_rad), ..Exhibits::default() }
    }
}
