//! What of a response an effect can change at all: what acts on sensing leaves a robot's way as it is.

use asami_sim::effect::{Block, Place};

use crate::plant::Variant;
use crate::shape::Numbers;

/// Kinds of effects, by what they touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// How the robot moves, and with that all that it sees on the way.
    Motion,
    /// Where landmarks are seen, and whether.
    Sight,
    /// How sightings scatter, and whether there are any.
    Scatter,
}

impl Touch {
    /// That of a kind of effect.
    #[must_use]
    pub fn of(variant: &Variant) -> Self {
        match (variant.place(), variant.block()) {
            (Place::Actuation | Place::Dynamics, _) => Self::Motion,
            (Place::Sensing | Place::Scene, Block::Noise) => Self::Scatter,
            (Place::Sensing | Place::Scene, _) => Self::Sight,
        }
    }

    /// Whether such an effect can change these numbers.
    #[must_use]
    pub fn changes(self, group: Numbers) -> bool {
        match group {
            Numbers::Motion | Numbers::MotionNoise => self == Self::Motion,
            Numbers::Size | Numbers::Bearing | Numbers::Moved => self != Self::Scatter,
            Numbers::False => self != Self::Sight,
            Numbers::SizeNoise | Numbers::BearingNoise | Numbers::Detection => true,
        }
    }
}
