//! Where a scenario's logs come from: a simulated world, or a recording.

use std::ops::Range;

use asami_sim::drives::explore::Exploring;
use asami_sim::drives::pace::Pacing;
use asami_sim::drives::roam::Roaming;
use asami_sim::drives::suite::Suite;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::AiboConfig;
use asami_sim::robots::create::CreateConfig;
use asami_sim::robots::plain::PlainConfig;
use asami_sim::scenes::field::Field;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::survey::Surveying;
use serde::{Deserialize, Serialize};

use crate::binning::Binning;
use crate::depths::Depths;
use asami_sim::ride::Ride;

/// Where a scenario's logs come from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Origin {
    /// Out of a simulated world, one log a seed.
    Simulated(Box<Simulation>),
    /// Out of a recorded log, one log a window.
    Recorded(Box<Recording>),
}

/// The world of a scenario and how it is driven.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Which robot.
    pub robot: Robot,
    /// How long each log is.
    pub duration_s: f64,
    /// How many logs.
    pub seeds: u32,
    /// The seed of the first; the others follow.
    pub first_seed: u64,
    /// The Aibo's own tables.
    pub aibo: AiboConfig,
    /// The plain robot's own tables.
    pub plain: PlainConfig,
    /// The robot's discrete actions.
    pub suite: Suite,
    /// The camera in its head.
    pub camera: CameraConfig,
    /// What stands on the field.
    pub field: Field,
    /// Where the robot stands at first.
    pub start: Placement,
    /// The policy.
    pub drive: Policy,
    /// What the nominal world leaves out.
    pub effects: Effects,
    /// How the truth about the models is measured.
    pub survey: Surveying,
    /// Another program's physics engine that the Aibo is put into, and its arguments: no key of a scenario.
    #[serde(skip)]
    pub engine: Option<Vec<String>>,
}

/// What the robot does: follows from what is studied.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Policy {
    /// To and fro at random speeds (section 3.3).
    Pace(Pacing),
    /// To and fro by the suite's 21 strides (section 4.4.3).
    Stride(Pacing),
    /// All over the field by the suite's 40 actions (section 4.4.1).
    Explore(Exploring),
    /// A wheeled robot, all over an arena at any speed.
    Roam(Box<Roams>),
    /// Round a town, as a person drives (chapter 5).
    Route(Box<Ride>),
}

/// A wheeled robot and its policy.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Roams {
    /// The robot.
    pub create: CreateConfig,
    /// The policy.
    pub roaming: Roaming,
    /// How its commands become discrete actions, for learners of a velocity for each.
    pub binning: Option<Binning>,
}

impl Simulation {
    /// When the robot changes, where it does so in the midst of a log.
    #[must_use]
    pub fn change_s(&self) -> Option<f64> {
        self.effects.command_scale.as_ref().map(|scale| scale.from_s).filter(|from_s| *from_s > 0.0)
    }

    /// The world as it is after the change, from the beginning; `None` of a robot that does not change.
    #[must_use]
    pub fn changed(&self) -> Option<Self> {
        let mut changed = self.clone();
        self.change_s()?;
        if let Some(scale) = &mut changed.effects.command_scale {
            scale.from_s = 0.0;
        }
        Some(changed)
    }
}

/// The robots of simulated scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Robot {
    /// Sony's ERS-7, walking in Rapier.
    Aibo,
    /// The dissertation's own simulator (section 4.4.2): kinematics and Gaussian noise.
    Plain,
    /// An iRobot Create among landmarks, in Rapier.
    Create,
    /// A 1999 Isuzu VehiCross with a Velodyne on its roof, in Rapier.
    Car,
}

impl Robot {
    /// Its name in scenarios and data sets.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Robot::Aibo => "aibo",
            Robot::Plain => "plain",
            Robot::Create => "create",
            Robot::Car => "car",
        }
    }
}

asami_dataset::parameters! {
    /// Where the robot stands when a log begins, facing world +y at heading 0.
    pub struct Placement {
        /// World x.
        x_m: f64 = 0.0, "m", -100.0..=100.0;
        /// World y.
        y_m: f64 = -2.4, "m", -100.0..=100.0;
        /// Heading, counter-clockwise.
        theta_rad: f64 = 0.0, "rad", -3.2..=3.2;
        /// Each seed starts up to this much further on or back.
        y_spread_m: f64 = 0.3, "m", 0.0..=10.0;
    }
}

/// A recorded log and how it is cut.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recording {
    /// Path of the data, relative to the repository's root.
    pub source: String,
    /// The importer that reads it; `None` for a data set of ours.
    pub format: Option<String>,
    /// How commands that take any value become discrete actions.
    pub binning: Option<Binning>,
    /// Whether what it calls ranges are depths.
    pub depths: Option<Depths>,
    /// Whose logs are learned from and which landmarks are left in them; at least one part.
    pub parts: Vec<Part>,
    /// The pieces that learners are given.
    pub windows: Vec<Window>,
    /// So much of each window, from its beginning, is learned from, and models are held against the rest; `None`: all of it, for
    /// both.
    pub learned_s: Option<f64>,
}

/// What is taken of a recording: whose log, and which landmarks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Which robot, of a recording of several.
    pub robot: Option<u16>,
    /// Ids of the landmarks that are left in the log; `None`: all.
    pub landmarks: Option<Vec<u16>>,
}

/// A piece of a recorded log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Where it begins, in seconds since the recording began.
    pub start_s: f64,
    /// How long it is.
    pub length_s: f64,
    /// Whether it shares data with its neighbours, so that statistics over it count data twice.
    pub overlapping: bool,
}

impl Window {
    /// From its start to its end.
    #[must_use]
    pub fn span_s(&self) -> Range<f64> {
        self.start_s..self.start_s + self.length_s
    }
}
