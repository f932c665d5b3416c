//! A robot in a scene, and the one loop that runs it.

use asami_dataset::{Action, Channel, Command, Dataset, Frame, Known, Log, Odometry, Sighting, TruePose, Truth};

use crate::sensors::velodyne::SensorPose;

/// A robot in a scene, stepped from control tick to control tick.
pub trait World: Send {
    /// What the robot knows before it moves.
    fn known(&self) -> Known;

    /// Seconds since the log began.
    fn t_s(&self) -> f64;

    /// Where the robot is.
    fn pose(&self) -> TruePose;

    /// Why the world does not go on, if it does not: what it recorded since then is worth nothing.
    fn broken(&self) -> Option<String> {
        None
    }

    /// Carries out `action` for one control period and records what is seen and where the robot is.
    fn tick(&mut self, action: Action, record: &mut Record);
}

/// What a world has recorded so far.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// What the robot has seen and done: all that a [`Drive`] may look at, [`Drive::localise`] apart.
    pub seen: Seen,
    /// Where the robot was.
    pub track: Vec<TruePose>,
    /// Where a car's Velodyne was, at every step of the engine.
    pub sensor_poses: Vec<SensorPose>,
}

/// The part of a record that the robot itself has.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Actions, a row where they change.
    pub commands: Vec<Command>,
    /// Sensor frames.
    pub frames: Vec<Frame>,
    /// Landmarks seen.
    pub sightings: Vec<Sighting>,
    /// Own motion measured.
    pub odometry: Vec<Odometry>,
}

/// Chooses the action of each control tick out of the logged past.
pub trait Drive: Send {
    /// Told before each [`act`](Self::act) where the robot is, as by the "previously developed accurate
    /// localization module" that kept the robot on the field (Stronger 2008, section 4.4.1). Only the
    /// choice of actions may hang on it; a drive that does without ignores it.
    fn localise(&mut self, pose: &TruePose) {
        let _ = pose;
    }

    /// The action from `t_s` until the next tick.
    fn act(&mut self, t_s: f64, seen: &Seen) -> Action;
}

/// Runs `world` under `drive` until `until_s`, and gives the log with its truth.
pub fn run(world: &mut dyn World, drive: &mut dyn Drive, until_s: f64) -> Dataset {
    let record = record(world, drive, until_s);
    dataset(world, record)
}

/// Runs `world` under `drive` until `until_s`.
pub fn record(world: &mut dyn World, drive: &mut dyn Drive, until_s: f64) -> Record {
    let mut record = Record::default();
    while world.t_s() < until_s {
        let t_s = world.t_s();
        drive.localise(&world.pose());
        let action = drive.act(t_s, &record.seen);
        if record.seen.commands.last().is_none_or(|last| last.action != action) {
            record.seen.commands.push(Command { t_s, action });
        }
        world.tick(action, &mut record);
    }
    record
}

/// A record of `world` as a log with its truth.
#[must_use]
pub fn dataset(world: &dyn World, record: Record) -> Dataset {
    let Record { seen, track, .. } = record;
    let known = world.known();
    // A car looks for no landmarks, so that there is none that it could have missed.
    let frames = (known.robot != "car").then(|| Channel::from(seen.frames));
    let log = Log {
        known: known.into(),
        commands: seen.commands.into(),
        frames,
        sightings: seen.sightings.into(),
        odometry: seen.odometry.into(),
        firings: None,
    };
    Dataset { log, truth: Truth { track: track.into(), survey: None }, provenance: None }
}
