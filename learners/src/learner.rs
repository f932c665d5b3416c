//! The door that every learner stands behind.

use asami_dataset::parameters::Parameter;
use asami_dataset::{Log, Models, Rng};
use asami_scans::CannotScan;

/// What the declaration of a learner says of it; written by the `learner!` macro.
pub trait Declared: Send + Sync {
    /// What it is, and whose.
    fn about(&self) -> &'static About;
}

/// Learns models from a log.
///
/// A learner is given what the robot knows and nothing else; randomness is an argument.
pub trait Learner: Declared {
    /// Learns from `log`, starting at `given` (a starting action model, or a model that the method
    /// takes as known; [`About::needs`] says which).
    ///
    /// # Errors
    /// [`CannotLearn`] says what the log or `given` lacks. Divergence is no error but a
    /// [`Verdict`].
    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn>;
}

/// A learner's row in the catalogue.
#[derive(Debug)]
pub struct About {
    /// Its name in scenarios and tables.
    pub name: &'static str,
    /// One sentence.
    pub what: &'static str,
    /// Section, equation or paper.
    pub source: &'static str,
    /// What it must be given to start from.
    pub needs: Needs,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

/// What a learner must be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing: no starting model.
    Nothing,
    /// An action model, to start from or as known.
    Action,
    /// A sensor model, taken as known.
    Sensor,
    /// All models, to start from: a table of velocities (an action without an entry counts as having no
    /// effect), height or range as a function of distance, and the noise of sensor and motion.
    Both,
    /// The firings of a car's laser scanner, or odometry in their place; an action model of pedals, if one is given, tells where the
    /// matching of scans begins.
    Firings,
}

/// What a learner learned, and how it got there.
#[derive(Clone, Debug, Default)]
pub struct Learned {
    /// The models, with standard errors where the method gives them.
    pub models: Models,
    /// How it ended.
    pub verdict: Verdict,
    /// Passes over the data, for methods that iterate.
    pub iterations: Option<u32>,
    /// The models on the way, for learning curves.
    pub history: Vec<Step>,
    /// Curves worth drawing, by name: `"w_a"` and `"w_s"` of Figure 3.7, say.
    pub traces: Vec<Trace>,
    /// What the log could not determine.
    pub lacks: Vec<Lack>,
}

/// How learning ended, as far as the learner itself can tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// It converged, or has no rule by which it would not have.
    #[default]
    Converged,
    /// A rule of the method's own says that it failed.
    Diverged {
        /// Which.
        rule: &'static str,
    },
}

/// One point of a learning curve.
#[derive(Clone, Debug)]
pub struct Step {
    /// Seconds into the log, of a method that learns as it goes.
    pub t_s: Option<f64>,
    /// Log-likelihood in nats, of a method that has one.
    pub log_likelihood: Option<f64>,
    /// The models then.
    pub models: Models,
}

/// A named curve over time.
#[derive(Clone, Debug)]
pub struct Trace {
    /// What is drawn.
    pub name: &'static str,
    /// Time in seconds, and value.
    pub points: Vec<[f64; 2]>,
}

/// Something that the log could not determine; what was learned is given all the same.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Lack {
    /// The robot was never commanded to move, or only at one speed.
    #[error("commands take fewer than {needed} distinct speeds ({found}), too few for the action model's degree")]
    FewSpeeds {
        /// Distinct speeds found.
        found: usize,
        /// Needed for the degree.
        needed: usize,
    },
    /// The observation hardly changed.
    #[error("observations span only {span} ({unit}): the sensor model outside that span is extrapolated")]
    NarrowObservations {
        /// Greatest less least observation.
        span: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// Some discrete actions were hardly ever executed.
    #[error("actions {actions:?} were executed for less than {least_s} s in all: their velocities are hardly known")]
    RareActions {
        /// Their ids, in order.
        actions: Vec<u16>,
        /// How long an action must be executed.
        least_s: f64,
    },
    /// Some actions of the starting models were never executed.
    #[error("actions {actions:?} of the starting models were never executed: nothing is learned about them")]
    UnusedActions {
        /// Their ids, in order.
        actions: Vec<u16>,
    },
    /// No landmark but one was seen: the world could be turned about it.
    #[error("only landmark {landmark} was ever seen: where the robot stood about it cannot be told")]
    OneLandmark {
        /// Its id.
        landmark: u16,
    },
    /// Nothing was fired: the lasers' angles are not learned.
    #[error("the log has no laser firings: no laser's angle is learned")]
    NoFirings,
    /// Some adjacent lasers see nothing alike.
    #[error("lasers {pairs:?} see too little alike: the angle between them is a guess")]
    LostPairs {
        /// Their numbers, from 0 in order of vertical angle.
        pairs: Vec<(usize, usize)>,
    },
    /// Some scans could not be matched, or there are fewer than two.
    #[error("{unmatched} pairs of {scans} scans have too few points in common: no motion is known between them")]
    UnmatchedScans {
        /// Pairs that could not be matched.
        unmatched: usize,
        /// Full turns of the scanner.
        scans: usize,
    },
    /// The car was never seen to move fast enough.
    #[error(
        "the car never moves fast enough to tell which way is forward: the lasers' common angle is taken as 90 degrees"
    )]
    NoForward,
    /// Pedals and motions do not determine the action model.
    #[error("{found} commands of throttle, brake and steering do not determine the car's action model")]
    Pedals {
        /// Commands of pedals found.
        found: usize,
    },
}

/// What kept a learner from learning at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CannotLearn {
    /// No landmark was ever seen.
    #[error("the log has no sightings")]
    NoSightings,
    /// No command was ever given.
    #[error("the log has no commands")]
    NoCommands,
    /// Too few observations for the number of unknowns.
    #[error("the log has {found} observations; {needed} are needed for this many unknowns")]
    TooShort {
        /// Observations found.
        found: usize,
        /// Observations needed.
        needed: usize,
    },
    /// The commands are of another robot.
    #[error("the log's commands have no forward speed (a car's pedals?)")]
    WrongCommands,
    /// The commands are not out of a list of discrete actions.
    #[error("no command of the log has an action's id; this method learns a velocity for each discrete action")]
    NoActions,
    /// A landmark of unknown place was seen.
    #[error("the log sights landmark {landmark}, whose place is unknown")]
    UnknownLandmark {
        /// Its id.
        landmark: u16,
    },
    /// More than one landmark where the method takes one.
    #[error("the log sights {found} landmarks; this method takes logs of one")]
    SeveralLandmarks {
        /// How many.
        found: usize,
    },
    /// Heights and ranges in one log.
    #[error("the log mixes heights and ranges")]
    MixedSightings,
    /// The method needs a model that was not given.
    #[error("this method must be given {0}")]
    NotGiven(&'static str),
    /// No laser was ever fired.
    #[error("the log has no laser firings, and no odometry in their place")]
    NoFirings,
    /// Laser firings that say nothing.
    #[error(transparent)]
    Scans(CannotScan),
    /// The data leave the models undetermined.
    #[error("the log does not determine the models: {0}")]
    Undetermined(String),
}

impl From<CannotScan> for CannotLearn {
    fn from(error: CannotScan) -> Self {
        match error {
            CannotScan::NoFirings => Self::NoFirings,
            CannotScan::Undetermined(why) => Self::Undetermined(why),
            other => Self::Scans(other),
        }
    }
}

/// Declares a learner's parameters and its row in the catalogue.
macro_rules! learner {
    (
        $(#[$meta:meta])* $T:ident, $name:literal, $what:literal,
        source $source:literal, needs $needs:ident,
        { $($body:tt)* }
    ) => {
        asami_dataset::parameters! { $(#[$meta])* pub struct $T { $($body)* } }
        impl $T {
            /// The learner's row in the catalogue.
            #[must_use]
            pub fn about() -> &'static $crate::learner::About {
                use asami_dataset::parameters::Parameters;
                static ABOUT: std::sync::LazyLock<$crate::learner::About> =
                    std::sync::LazyLock::new(|| $crate::learner::About {
                        name: $name, what: $what, source: $source, needs: $crate::learner::Needs::$needs,
                        parameters: $T::table(),
                    });
                &ABOUT
            }
        }
        impl $crate::learner::Declared for $T {
            fn about(&self) -> &'static $crate::learner::About {
                Self::about()
            }
        }
    };
}
pub(crate) use learner;
