//! A flat field with coloured cylinders on it.

use std::collections::BTreeSet;

use asami_dataset::Beacon;
use asami_dataset::parameters::Fault;
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

impl Field {
    /// What a robot is told of its beacons, in order of id.
    #[must_use]
    pub fn known(&self) -> Vec<Beacon> {
        let beacon =
            |it: &Landmark| Beacon { id: it.id, x_m: it.body.x_m, y_m: it.body.y_m, height_m: Some(it.body.height_m) };
        let mut beacons: Vec<Beacon> = self.beacons.iter().map(beacon).collect();
        beacons.sort_by_key(|beacon| beacon.id);
        beacons
    }

    /// The same field with one beacon, counted from 0 in the order of ids and round again, shifted in world x and y.
    #[must_use]
    pub fn with_moved(&self, moved: Option<(usize, [f64; 2])>) -> Self {
        let mut field = self.clone();
        let Some((number, [x_m, y_m])) = moved else { return field };
        let mut order: Vec<&mut Landmark> = field.beacons.iter_mut().collect();
        order.sort_by_key(|beacon| beacon.id);
        let count = order.len().max(1);
        if let Some(beacon) = order.get_mut(number % count) {
            beacon.body.x_m += x_m;
            beacon.body.y_m += y_m;
        }
        field
    }

    /// Adds a fault for everything that cannot stand on a field.
    pub fn check(&self, path: &str, faults: &mut Vec<Fault>) {
        let mut ids = BTreeSet::new();
        for (i, beacon) in self.beacons.iter().enumerate() {
            beacon.body.check(&format!("{path}.beacons.{i}.body"), faults);
            if !ids.insert(beacon.id) {
                let message = format!("each beacon must have an id of its own; {} is taken", beacon.id);
                faults.push(Fault { path: format!("{path}.beacons.{i}.id"), message });
            }
        }
        for (i, cylinder) in self.clutter.iter().enumerate() {
            cylinder.check(&format!("{path}.clutter.{i}"), faults);
        }
    }
}

impl Cylinder {
    fn check(&self, path: &str, faults: &mut Vec<Fault>) {
        let rules = [
            ("x_m", self.x_m, -100.0..=100.0),
            ("y_m", self.y_m, -100.0..=100.0),
            ("radius_m", self.radius_m, 0.005..=2.0),
            ("base_m", self.base_m, 0.0..=5.0),
            ("height_m", self.height_m, 0.01..=5.0),
        ];
        for (name, value, range) in rules {
            if !range.contains(&value) {
                let (least, greatest) = range.into_inner();
                let message = format!("{name} must lie in {least}..={greatest} m, not {value}");
                faults.push(Fault { path: format!("{path}.{name}"), message });
            }
        }
    }
}
