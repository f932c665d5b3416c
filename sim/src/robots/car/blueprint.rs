//! What the simulation needs to know of the body, read from its URDF.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use urdf_rs::{Geometry, Joint, Link, Robot};

use super::BuildError;

/// Which car: the bodies that are shipped with the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// An Isuzu VehiCross of 1999.
    #[default]
    Vehicross,
    /// A Dallara AV-21, a race car without a driver.
    Av21,
}

impl Model {
    /// Its body's URDF.
    #[must_use]
    pub fn urdf(self) -> &'static str {
        match self {
            Model::Vehicross => include_str!("../../../../urdf/vehicross.urdf"),
            Model::Av21 => include_str!("../../../../urdf/av21.urdf"),
        }
    }
}

/// The wheels in their order everywhere.
pub const WHEELS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];

/// The middle of the luggage space in the body's axes: behind the rear axle, at the height of a boot's floor.
pub const LUGGAGE_M: Vector3<f64> = Vector3::new(-1.4, 0.0, 0.45);

/// One wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelPlan {
    /// Its hub at rest, in the body's axes.
    pub hub_m: Vector3<f64>,
    /// Of the unladen tyre.
    pub radius_m: f64,
    /// Of hub and wheel.
    pub mass_kg: f64,
    /// About the axle.
    pub inertia_kg_m2: f64,
    /// How far the hub can go down (negative) and up from where it rests.
    pub travel_m: [f64; 2],
}

/// A box of the body that can run into things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// Its middle in the body's axes.
    pub centre_m: Vector3<f64>,
    /// Half its extents.
    pub half_m: Vector3<f64>,
}

/// The car. The body's axes: x forward, y left, z up, origin midway between the axles at the height of the hubs.
#[derive(Clone, Debug)]
pub struct Blueprint {
    /// Each of [`WHEELS`].
    pub wheels: [WheelPlan; 4],
    /// Mass of all links.
    pub mass_kg: f64,
    /// Centre of mass of all links.
    pub centre_of_mass_m: Vector3<f64>,
    /// Of all links about their centre of mass, in the body's axes.
    pub inertia_kg_m2: Matrix3<f64>,
    /// The body's boxes.
    pub shells: Vec<Shell>,
    /// The Velodyne in the body's axes.
    pub body_from_velodyne: Isometry3<f64>,
    /// Greatest angle of the front wheels, and how fast they turn.
    pub steering_rad: f64,
    /// How fast the front wheels turn.
    pub steering_rad_per_s: f64,
}

impl Blueprint {
    /// A shipped car.
    ///
    /// # Errors
    /// If the text lacks a part; the shipped ones do not.
    pub fn shipped(model: Model) -> Result<Self, BuildError> {
        Self::parse(model.urdf())
    }

    /// Reads a car with the shipped one's names.
    ///
    /// # Errors
    /// If the text does not parse or lacks a link or joint.
    pub fn parse(urdf: &str) -> Result<Self, BuildError> {
        let robot = urdf_rs::read_from_string(urdf).map_err(|error| BuildError::Urdf(error.to_string()))?;
        let [fl, fr, rl, rr] = WHEELS.map(|name| wheel(&robot, name));
        let steering = joint(&robot, "front_left_steering")?;
        let mount = joint(&robot, "velodyne_mount")?;
        let [roll, pitch, yaw] = *mount.origin.rpy;
        let masses = masses(&robot);
        let mass_kg: f64 = masses.iter().map(|it| it.0).sum();
        let centre_of_mass_m = masses.iter().fold(Vector3::zeros(), |sum, it| sum + it.1 * it.0) / mass_kg;
        let inertia_kg_m2 = masses.iter().fold(Matrix3::zeros(), |sum, (mass_kg, at, own)| {
            let arm: Vector3<f64> = at - centre_of_mass_m;
            // Steiner: J + m (r.r 1 - r r^T)
            sum + own + (Matrix3::identity() * arm.dot(&arm) - arm * arm.transpose()) * *mass_kg
        });
        Ok(Self {
            wheels: [fl?, fr?, rl?, rr?],
            mass_kg,
            centre_of_mass_m,
            inertia_kg_m2,
            shells: shells(link(&robot, "body")?),
            body_from_velodyne: Isometry3::from_parts(
                Translation3::from(Vector3::from(*mount.origin.xyz)),
                UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            ),
            steering_rad: steering.limit.upper,
            steering_rad_per_s: steering.limit.velocity,
        })
    }

    /// From axle to axle.
    #[must_use]
    pub fn wheelbase_m(&self) -> f64 {
        self.wheels[0].hub_m.x - self.wheels[2].hub_m.x
    }

    /// Half the distance between the wheels of an axle.
    #[must_use]
    pub fn half_track_m(&self) -> f64 {
        0.5 * (self.wheels[0].hub_m.y - self.wheels[1].hub_m.y)
    }
}

fn joint<'a>(robot: &'a Robot, name: &str) -> Result<&'a Joint, BuildError> {
    let found = robot.joints.iter().find(|joint| joint.name == name);
    found.ok_or_else(|| BuildError::Missing { kind: "joint", name: name.to_owned() })
}

fn link<'a>(robot: &'a Robot, name: &str) -> Result<&'a Link, BuildError> {
    let found = robot.links.iter().find(|link| link.name == name);
    found.ok_or_else(|| BuildError::Missing { kind: "link", name: name.to_owned() })
}

fn wheel(robot: &Robot, name: &str) -> Result<WheelPlan, BuildError> {
    let suspension = joint(robot, &format!("{name}_suspension"))?;
    let (hub, spinning) = (link(robot, &format!("{name}_hub"))?, link(robot, &format!("{name}_wheel"))?);
    let radius = spinning.collision.iter().find_map(|it| match it.geometry {
        Geometry::Cylinder { radius, .. } => Some(radius),
        _ => None,
    });
    let radius_m =
        radius.ok_or_else(|| BuildError::Missing { kind: "cylinder of link", name: format!("{name}_wheel") })?;
    let knuckle_kg = link(robot, &format!("{name}_knuckle")).map_or(0.0, |it| it.inertial.mass.value);
    Ok(WheelPlan {
        hub_m: Vector3::from(*suspension.origin.xyz),
        radius_m,
        mass_kg: hub.inertial.mass.value + knuckle_kg + spinning.inertial.mass.value,
        inertia_kg_m2: spinning.inertial.inertia.iyy,
        travel_m: [suspension.limit.lower, suspension.limit.upper],
    })
}

/// Mass, place and own inertia of every link, all joints at 0. No joint of the car turns a link at 0.
fn masses(robot: &Robot) -> Vec<(f64, Vector3<f64>, Matrix3<f64>)> {
    let place = |link: &Link| {
        let (mut at, mut name) = (Vector3::from(*link.inertial.origin.xyz), link.name.as_str());
        // As many joints as there are, at most: a loop in the file ends too.
        for _ in 0..robot.joints.len() {
            let Some(joint) = robot.joints.iter().find(|joint| joint.child.link == name) else { break };
            at += Vector3::from(*joint.origin.xyz);
            name = joint.parent.link.as_str();
        }
        at
    };
    let of = |link: &Link| {
        let it = &link.inertial.inertia;
        let own = Matrix3::new(it.ixx, it.ixy, it.ixz, it.ixy, it.iyy, it.iyz, it.ixz, it.iyz, it.izz);
        (link.inertial.mass.value, place(link), own)
    };
    robot.links.iter().map(of).collect()
}

fn shells(body: &Link) -> Vec<Shell> {
    let shell = |it: &urdf_rs::Collision| match &it.geometry {
        Geometry::Box { size } => {
            Some(Shell { centre_m: Vector3::from(*it.origin.xyz), half_m: Vector3::from(**size) * 0.5 })
        }
        _ => None,
    };
    body.collision.iter().filter_map(shell).collect()
}
