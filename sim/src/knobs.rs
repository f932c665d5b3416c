//! Every constant of a world that an effect may turn, as plain data.
//!
//! Each tick the knobs start at their nominal values, then every effect of the scenario turns them
//! in the catalogue's order. A world writes to its physics engine only where a knob changed.

/// The knobs of landmark robots, one group per place.
#[derive(Clone, Debug, PartialEq)]
pub struct Knobs {
    /// Between the command and the gait.
    pub command: CommandKnobs,
    /// What the feet or wheels stand on.
    pub ground: GroundKnobs,
}

/// How a command becomes what the gait generator attempts.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandKnobs {
    /// Factors on the attempted rightward, forward and turning velocity.
    pub scale: [f64; 3],
}

/// The ground.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundKnobs {
    /// Coulomb friction coefficient between foot and ground.
    pub friction: f64,
}
