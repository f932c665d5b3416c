//! The survey of a scenario's world: found where one of this very world was kept, or made.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use asami_dataset::store::{WriteError, read_survey, write_survey};
use asami_dataset::survey::Velocity;
use asami_dataset::{Action, Seed, Sighting, Survey};
use asami_sim::drives::hold::Hold;
use asami_sim::robots::aibo::Start;
use asami_sim::robots::aibo::blueprint::URDF;
use asami_sim::survey::{self as measure, CannotSurvey as CannotMeasure};
use asami_sim::world;
use rayon::prelude::*;

use crate::scenario::{Policy, Robot, Simulation};
use crate::simulate::CannotSimulate;

/// Why a world cannot be surveyed.
#[derive(Debug, thiserror::Error)]
pub enum CannotSurvey {
    /// The robot cannot be built.
    #[error(transparent)]
    Build(#[from] CannotSimulate),
    /// A measurement failed.
    #[error("cannot survey the robot: {0}")]
    Measure(#[from] CannotMeasure),
    /// The threads cannot be started.
    #[error("cannot start the threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// It was made, but cannot be kept.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It was made, but its key cannot be kept.
    #[error("cannot write {}: {source}", path.display())]
    Key {
        /// Of the key.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
}

/// Where surveys are kept, and who hears of it when one is made.
pub struct Surveyor<'a> {
    /// Folders that may hold a survey, looked at in order.
    pub look_in: Vec<PathBuf>,
    /// Where a new one is kept.
    pub keep_in: PathBuf,
    /// Threads; `None`: one for each core.
    pub jobs: Option<usize>,
    /// Hears how it goes on.
    pub say: &'a (dyn Fn(&str) + Sync),
}

impl Surveyor<'_> {
    /// The survey of `simulation`'s world: kept, if its key is this world's, else made and kept.
    ///
    /// # Errors
    /// [`CannotSurvey`] if the robot cannot be built or measured, or the survey not written.
    pub fn survey(&self, simulation: &Simulation) -> Result<Survey, CannotSurvey> {
        self.survey_as(simulation, SURVEY, KEY)
    }

    /// The same of the robot after its change, kept beside the other.
    ///
    /// # Errors
    /// As [`survey`](Self::survey).
    pub fn survey_after(&self, changed: &Simulation) -> Result<Survey, CannotSurvey> {
        self.survey_as(changed, "survey_after.toml", "survey_after.key")
    }

    fn survey_as(&self, simulation: &Simulation, name: &str, key_name: &str) -> Result<Survey, CannotSurvey> {
        if simulation.robot != Robot::Aibo {
            // Exact, and at no cost: nothing to keep.
            return make(simulation, self.jobs, self.say);
        }
        let key = key(simulation)?;
        if let Some(survey) = kept_as(&key, self.look_in.iter().chain([&self.keep_in]), name, key_name) {
            return Ok(survey);
        }
        (self.say)("no survey of this very world is kept: measuring its speeds and heights");
        let survey = make(simulation, self.jobs, self.say)?;
        let path = self.keep_in.join(key_name);
        std::fs::create_dir_all(&self.keep_in)
            .and_then(|()| {
                // The key goes first: a survey without its key is never believed, a key whose survey is missing
                // neither.
                let _ = std::fs::remove_file(self.keep_in.join(name));
                std::fs::write(&path, format!("{key}\n"))
            })
            .map_err(|source| CannotSurvey::Key { path, source })?;
        write_survey(&survey, &self.keep_in.join(name))?;
        Ok(survey)
    }
}

const SURVEY: &str = "survey.toml";
const KEY: &str = "survey.key";

/// The survey of `simulation`'s world, where it costs nothing: one kept in one of `folders`, or one that is exact.
///
/// # Errors
/// If the robot cannot be built.
pub fn at_hand<'a>(
    simulation: &Simulation,
    folders: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<Option<Survey>, CannotSimulate> {
    match simulation.robot {
        Robot::Plain => Ok(Some(exact(simulation))),
        // Each log has its own.
        Robot::Car | Robot::Create => Ok(None),
        Robot::Aibo => Ok(kept_as(&key(simulation)?, folders, SURVEY, KEY)),
    }
}

fn exact(simulation: &Simulation) -> Survey {
    let how = &simulation.survey;
    simulation.plain_at(Start::default(), Seed(how.seed)).survey(how)
}

fn kept_as<'a>(
    key: &str,
    folders: impl IntoIterator<Item = &'a PathBuf>,
    name: &str,
    key_name: &str,
) -> Option<Survey> {
    folders.into_iter().find_map(|folder| {
        let found = std::fs::read_to_string(folder.join(key_name)).ok()?;
        // A survey that cannot be read is as good as none: it is made anew.
        (found.trim() == key).then(|| read_survey(&folder.join(name)).ok()).flatten()
    })
}

/// Speed of the walk that stands for the world in a survey's key.
const PROBE_M_PER_S: f64 = 0.2;
/// Its length: several strides, dozens of frames.
const PROBE_S: f64 = 2.0;

/// The hash of what a survey depends on: the world's numbers, its body, what is surveyed, the discrete
/// actions of a robot in the plane, and, since code counts too, every bit of the log of a short walk.
///
/// # Errors
/// If the robot cannot be built.
pub fn key(simulation: &Simulation) -> Result<String, CannotSimulate> {
    let Simulation { robot, aibo, camera, field, effects, survey, .. } = simulation;
    let mut probe = simulation.before_beacon(survey.near_m, Seed(survey.seed))?;
    let walked = world::run(&mut *probe, &mut Hold::forward(PROBE_M_PER_S), PROBE_S);
    // Debug shows every number by its shortest round trip: what differs at all differs here.
    let actions = actions(simulation);
    let all = format!("{robot:?} {aibo:?} {camera:?} {field:?} {effects:?} {survey:?} {actions:?} {URDF} {walked:?}");
    Ok(format!("blake3:{}", blake3::hash(all.as_bytes()).to_hex()))
}

/// Ids and discrete actions whose velocities are surveyed: those of a robot in the plane (section 4.4.1). Along a
/// line forward speeds are timed instead.
fn actions(simulation: &Simulation) -> Vec<(u16, Action)> {
    match simulation.drive {
        Policy::Explore(_) => (0..).zip(simulation.suite.actions()).collect(),
        Policy::Pace(_) | Policy::Stride(_) | Policy::Roam(_) | Policy::Route(_) => Vec::new(),
    }
}

/// Measures speeds or velocities, and heights, in parallel; the same whatever the number of threads.
///
/// # Errors
/// [`CannotSurvey`] if the robot cannot be built or measured.
pub fn make(simulation: &Simulation, jobs: Option<usize>, say: &(dyn Fn(&str) + Sync)) -> Result<Survey, CannotSurvey> {
    let how = &simulation.survey;
    match simulation.robot {
        Robot::Aibo => {}
        Robot::Plain => return Ok(exact(simulation)),
        // Where lasers point may be drawn, and commands take any value: each log has a survey of its own.
        Robot::Car | Robot::Create => return Ok(Survey::default()),
    }
    let actions = actions(simulation);
    let commands = if actions.is_empty() { how.commands_m_per_s() } else { Vec::new() };
    let distances_m = how.distances_m();
    // Every measurement has a seed of its own.
    let mut seeds = how.seed..;
    let repeated = commands.iter().flat_map(|&command| std::iter::repeat_n(command, how.timings as usize));
    let walks: Vec<(f64, u64)> = repeated.zip(&mut seeds).collect();
    let turns: Vec<((u16, Action), u64)> = actions.into_iter().zip(&mut seeds).collect();
    let placements = distances_m.iter().flat_map(|&distance_m| (0..how.placements).map(move |n| (distance_m, n)));
    let stands: Vec<((f64, u32), u64)> = placements.zip(&mut seeds).collect();
    let progress = Count { done: AtomicUsize::new(0), of: walks.len() + turns.len() + stands.len(), say };

    let timed = |&(command, seed): &(f64, u64)| -> Result<f64, CannotSurvey> {
        let mut world = simulation.before_beacon(how.start_m(command), Seed(seed))?;
        let speed = measure::timed_m_per_s(&mut *world, command, how)?;
        progress.one_more();
        Ok(speed)
    };
    let turned = |&((id, action), seed): &((u16, Action), u64)| -> Result<Velocity, CannotSurvey> {
        let mut world = simulation.before_beacon(how.near_m, Seed(seed))?;
        let velocity = measure::velocity(&mut *world, id, action, how);
        progress.one_more();
        Ok(velocity)
    };
    let looked = |&((distance_m, placement), seed): &((f64, u32), u64)| -> Result<Vec<Sighting>, CannotSurvey> {
        let mut world = simulation.before_beacon(distance_m, Seed(seed))?;
        let read = measure::look(&mut *world, distance_m, placement, how)?;
        progress.one_more();
        Ok(read)
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs.unwrap_or(0)).build()?;
    let (speeds, velocities, looks) = pool.install(|| {
        let speeds: Result<Vec<f64>, CannotSurvey> = walks.par_iter().with_max_len(1).map(timed).collect();
        let velocities: Result<Vec<Velocity>, CannotSurvey> = turns.par_iter().with_max_len(1).map(turned).collect();
        let looks: Result<Vec<_>, CannotSurvey> = stands.par_iter().with_max_len(1).map(looked).collect();
        (speeds, velocities, looks)
    });

    let (speeds, looks) = (speeds?, looks?);
    let timings = commands.iter().zip(speeds.chunks(how.timings.max(1) as usize));
    let heights = distances_m.iter().zip(looks.chunks(how.placements.max(1) as usize));
    Ok(Survey {
        speed_by_command: timings.map(|(&command, timings)| measure::speed(command, timings)).collect(),
        height_by_distance: heights.map(|(&distance_m, looks)| measure::height(distance_m, &looks.concat())).collect(),
        velocity_by_action: velocities?,
        ..Survey::default()
    })
}

/// Counts measurements, and says so now and then.
struct Count<'a> {
    done: AtomicUsize,
    of: usize,
    say: &'a (dyn Fn(&str) + Sync),
}

impl Count<'_> {
    fn one_more(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(20) || done == self.of {
            (self.say)(&format!("survey: {done} of {} measurements done", self.of));
        }
    }
}
