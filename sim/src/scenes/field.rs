//! A flat field with coloured cylinders on it.

use serde::{Deserialize, Serialize};

/// A colour that the vision tells apart from the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Colour {
    /// RoboCup's beacon pink.
    Pink,
    /// Yellow.
    Yellow,
    /// Sky blue.
    Blue,
    /// Green of another shade than the carpet's.
    Green,
    /// Orange, near enough to pink and yellow to be mistaken: no beacon has it.
    Orange,
    /// White; no beacon has it.
    White,
    /// Grey; no beacon has it.
    Grey,
}

/// An upright cylinder with two bands of colour, one above the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// World x of the axis.
    pub x_m: f64,
    /// World y of the axis.
    pub y_m: f64,
    /// Radius.
    pub radius_m: f64,
    /// Height of its lower rim above the ground.
    pub base_m: f64,
    /// From lower to upper rim.
    pub height_m: f64,
    /// Colours of the upper and of the lower half.
    pub bands: [Colour; 2],
}

/// A beacon: a cylinder whose place the robot knows, recognised by its bands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Landmark {
    /// Its name in sightings.
    pub id: u16,
    /// What it looks like and where it stands.
    pub body: Cylinder,
}

/// The field: its beacons, and things that are none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Field {
    /// Beacons.
    pub beacons: Vec<Landmark>,
    /// Cylinders that the robot does not know of: they hide beacons or look like them.
    pub clutter: Vec<Cylinder>,
}
