//! What an effect is: one named phenomenon that a nominal simulator leaves out.

use asami_dataset::parameters::Parameter;
use asami_dataset::{Action, Frame, Rng, Sighting, Size};

use crate::knobs::{Knobs, LaserKnobs};

/// What the declaration of an effect says of it; written by the `effect!` macro.
pub trait Declared: Send + Sync {
    /// Its row in the catalogue.
    fn about(&self) -> &'static About;

    /// Its parameters' values, in the order of [`About::parameters`].
    fn values(&self) -> Vec<f64>;
}

/// One unmodelled phenomenon with its parameters.
///
/// Most effects only [`tune`](Effect::tune) a constant; those with memory or random draws add a
/// [`Stage`]. At its null value an effect changes no bit of a log.
pub trait Effect: Declared {
    /// Turns the knobs as they stand `t_s` seconds into the log.
    fn tune(&self, t_s: f64, knobs: &mut Knobs) {
        let _ = (t_s, knobs);
    }

    /// A stage with memory or random draws of its own, if it has one. It is fresh for every world;
    /// `rng` is the effect's own stream.
    fn stage(&self, rng: Rng) -> Option<Stage> {
        let _ = rng;
        None
    }

    /// Whether every parameter has the value at which the effect does nothing.
    fn is_null(&self) -> bool {
        self.values().iter().zip(self.about().parameters).all(|(value, parameter)| *value == parameter.default)
    }
}

/// A step of the pipeline that an effect inserts; closed, because these are the pipeline's places.
pub enum Stage {
    /// Between the logged command and what the gait attempts; called once a control tick with the
    /// tick's time, of a car once a step of the engine with the step's, of a plain robot at many moments of each step.
    Command(CommandStage),
    /// On the servos' set-points in radians, once a control tick.
    Joint(JointStage),
    /// On what one frame's vision reports, once a frame.
    Sighting(SightingStage),
    /// On how each laser of a scanner departs from what its maker measured, lasers by increasing vertical angle; called
    /// once.
    Lasers(LasersStage),
}

/// See [`Stage::Command`].
pub type CommandStage = Box<dyn FnMut(f64, Action) -> Action + Send>;
/// See [`Stage::Joint`].
pub type JointStage = Box<dyn FnMut(f64, &mut [f64]) + Send>;
/// See [`Stage::Sighting`].
pub type SightingStage = Box<dyn FnMut(&Glance, &mut Vec<Sighting>) + Send>;
/// See [`Stage::Lasers`].
pub type LasersStage = Box<dyn FnOnce(&mut [LaserKnobs]) + Send>;

/// One frame, as a [`SightingStage`] is told of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Glance<'a> {
    /// When the frame was taken, and where the head was turned to.
    pub frame: Frame,
    /// The landmarks that the vision looks for.
    pub landmarks: &'a [u16],
    /// Width of what the camera sees.
    pub view_rad: f64,
    /// Least and greatest size that it reports: heights, or ranges.
    pub sizes: [Size; 2],
}

/// Where in the loop an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    /// Between command and joint torque.
    Actuation,
    /// Bodies, contacts and terrain.
    Dynamics,
    /// Between the world and the observation.
    Sensing,
    /// What stands around the robot.
    Scene,
}

impl Place {
    /// Its name in diagnoses.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Place::Actuation => "actuation",
            Place::Dynamics => "dynamics",
            Place::Sensing => "sensing",
            Place::Scene => "scene",
        }
    }
}

/// Which of the diagnosis's flexible blocks an effect would show in, were it unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Block {
    /// A curve from command to velocity.
    StaticMotion,
    /// Delays and lags.
    Timing,
    /// Slow change over the log.
    Drift,
    /// A curve from state to observation.
    Sensor,
    /// Sizes and tails of noise.
    Noise,
}

impl Block {
    /// Its name in diagnoses.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Block::StaticMotion => "static_motion",
            Block::Timing => "timing",
            Block::Drift => "drift",
            Block::Sensor => "sensor",
            Block::Noise => "noise",
        }
    }
}

/// An effect's row in the catalogue.
#[derive(Debug, PartialEq)]
pub struct About {
    /// Its key under `[effects]`.
    pub name: &'static str,
    /// One sentence on what it is.
    pub what: &'static str,
    /// Where it acts.
    pub place: Place,
    /// Where it would show.
    pub block: Block,
    /// Robots it fits.
    pub fits: &'static [&'static str],
    /// Where its size comes from.
    pub source: &'static str,
    /// Its parameters; each default is the null value, each range the plausible one.
    pub parameters: &'static [Parameter],
    /// The law by which cases with this effect are planted, and by which a diagnosis expects its sizes: a
    /// parameter that is not named keeps its null value.
    pub law: &'static [(&'static str, Draw)],
}

/// How one parameter of a planted effect is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Draw {
    /// Away from the null value by a distance drawn log-uniformly; an effect has exactly one such parameter.
    Size {
        /// Which way from the null value.
        way: Way,
        /// Least distance, half a decade below what a log of 150 s would show.
        least: f64,
        /// Greatest distance.
        greatest: f64,
    },
    /// Moves along with the parameter that is sized, by the same distance.
    Same,
    /// One of these, each as likely.
    Choice(&'static [f64]),
    /// One of these landmarks, each as likely, as far as there are so many.
    Landmark(&'static [f64]),
}

/// A direction from the null value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Greater values.
    Up,
    /// Smaller values.
    Down,
    /// Both, each as likely.
    Either,
}

/// Declares an effect's parameters and its row in the catalogue.
macro_rules! effect {
    (
        $(#[$meta:meta])* $T:ident, $name:literal, $what:literal, $place:ident, $block:ident,
        fits [$($fit:literal),*], source $source:literal,
        drawn [$($drawn:ident: $draw:expr),* $(,)?],
        { $($body:tt)* }
    ) => {
        asami_dataset::parameters! { $(#[$meta])* pub struct $T { $($body)* } }
        impl $T {
            /// The effect's row in the catalogue.
            #[must_use]
            pub fn about() -> &'static $crate::effect::About {
                use asami_dataset::parameters::Parameters;
                static ABOUT: std::sync::LazyLock<$crate::effect::About> =
                    std::sync::LazyLock::new(|| $crate::effect::About {
                        name: $name, what: $what, place: $crate::effect::Place::$place,
                        block: $crate::effect::Block::$block, fits: &[$($fit),*], source: $source,
                        parameters: $T::table(),
                        law: const {
                            #[allow(unused_imports)]
                            use $crate::effect::{Draw::*, Way::*};
                            &[$((stringify!($drawn), $draw)),*]
                        },
                    });
                &ABOUT
            }
        }
        impl $crate::effect::Declared for $T {
            fn about(&self) -> &'static $crate::effect::About {
                Self::about()
            }

            fn values(&self) -> Vec<f64> {
                asami_dataset::parameters::Parameters::values(self)
            }
        }
    };
}
pub(crate) use effect;
