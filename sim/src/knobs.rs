//! Every constant of a world that an effect may turn, as plain data.
//!
//! Each tick the knobs start at their nominal values, then every effect of the scenario turns them
//! in the catalogue's order. A world writes to its physics engine only where a knob changed.

/// The knobs of all robots, one group per place; a robot turns a deaf ear to those it lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct Knobs {
    /// Between the command and the gait.
    pub command: CommandKnobs,
    /// What the feet or wheels stand on.
    pub ground: GroundKnobs,
    /// What a car's mass, engine, brakes and steering are.
    pub vehicle: VehicleKnobs,
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
    /// Coulomb friction coefficient between foot or tyre and ground.
    pub friction: f64,
}

/// A car.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleKnobs {
    /// Factor on mass and moments of inertia.
    pub mass_ratio: f64,
    /// Factor on the engine's torque.
    pub engine_ratio: f64,
    /// Factor on the brakes' torque.
    pub brake_ratio: f64,
    /// Factor on the front wheels' angle.
    pub steering_ratio: f64,
    /// Angle of the front wheels, to the left, while the steering wheel is straight.
    pub steering_offset_rad: f64,
}

impl Default for VehicleKnobs {
    fn default() -> Self {
        Self { mass_ratio: 1.0, engine_ratio: 1.0, brake_ratio: 1.0, steering_ratio: 1.0, steering_offset_rad: 0.0 }
    }
}
