//! What the simulation needs to know of the robot, read from its URDF.

use nalgebra::{Matrix3, Vector3};
use urdf_rs::{Geometry, Joint, Link, Robot};

use super::BuildError;

/// The robot, as shipped with the program.
pub const URDF: &str = include_str!("../../../../urdf/create.urdf");

/// The wheels in their order everywhere.
pub const WHEELS: [&str; 2] = ["left", "right"];

/// One wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelPlan {
    /// Its hub in the body's axes.
    pub hub_m: Vector3<f64>,
    /// Of the tyre.
    pub radius_m: f64,
    /// Its mass.
    pub mass_kg: f64,
    /// About its own three axes.
    pub inertia_kg_m2: Vector3<f64>,
    /// The most torque that its motor gives.
    pub effort_n_m: f64,
}

/// The robot. The body's axes: x forward, y left, z up, origin midway between the wheels' hubs.
#[derive(Clone, Debug, PartialEq)]
pub struct Blueprint {
    /// Each of [`WHEELS`].
    pub wheels: [WheelPlan; 2],
    /// Mass of the body without its wheels.
    pub mass_kg: f64,
    /// Its centre of mass.
    pub centre_of_mass_m: Vector3<f64>,
    /// About that.
    pub inertia_kg_m2: Matrix3<f64>,
    /// The caster's middle.
    pub caster_m: Vector3<f64>,
    /// The caster's radius.
    pub caster_radius_m: f64,
}

impl Blueprint {
    /// The shipped robot.
    ///
    /// # Errors
    /// If the text lacks a part; the shipped one does not.
    pub fn shipped() -> Result<Self, BuildError> {
        Self::parse(URDF)
    }

    /// Reads a robot with the shipped one's names.
    ///
    /// # Errors
    /// If the text does not parse or lacks a link or joint.
    pub fn parse(urdf: &str) -> Result<Self, BuildError> {
        let robot = urdf_rs::read_from_string(urdf).map_err(|error| BuildError::Urdf(error.to_string()))?;
        let [left, right] = WHEELS.map(|name| wheel(&robot, name));
        let body = link(&robot, "body")?;
        let it = &body.inertial.inertia;
        Ok(Self {
            wheels: [left?, right?],
            mass_kg: body.inertial.mass.value,
            centre_of_mass_m: Vector3::from(*body.inertial.origin.xyz),
            inertia_kg_m2: Matrix3::new(it.ixx, it.ixy, it.ixz, it.ixy, it.iyy, it.iyz, it.ixz, it.iyz, it.izz),
            caster_m: Vector3::from(*joint(&robot, "caster_mount")?.origin.xyz),
            caster_radius_m: radius_m(&robot, "caster")?,
        })
    }

    /// From wheel to wheel.
    #[must_use]
    pub fn base_m(&self) -> f64 {
        self.wheels[0].hub_m.y - self.wheels[1].hub_m.y
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

fn radius_m(robot: &Robot, name: &str) -> Result<f64, BuildError> {
    let found = link(robot, name)?.collision.iter().find_map(|it| match it.geometry {
        Geometry::Sphere { radius } => Some(radius),
        _ => None,
    });
    found.ok_or_else(|| BuildError::Missing { kind: "sphere of link", name: name.to_owned() })
}

fn wheel(robot: &Robot, name: &str) -> Result<WheelPlan, BuildError> {
    let axle = joint(robot, &format!("{name}_axle"))?;
    let name = format!("{name}_wheel");
    let inertial = &link(robot, &name)?.inertial;
    let about = &inertial.inertia;
    Ok(WheelPlan {
        hub_m: Vector3::from(*axle.origin.xyz),
        radius_m: radius_m(robot, &name)?,
        mass_kg: inertial.mass.value,
        inertia_kg_m2: Vector3::new(about.ixx, about.iyy, about.izz),
        effort_n_m: axle.limit.effort,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Open Interface specification's own numbers.
    #[test]
    fn the_shipped_robot_is_a_create() {
        let create = Blueprint::shipped().unwrap();
        assert!((create.base_m() - 0.258).abs() < 1e-12);
        // Wheels and caster touch one floor.
        let floor_m = create.caster_m.z - create.caster_radius_m;
        assert!((floor_m + create.wheels[0].radius_m).abs() < 1e-12);
    }

    #[test]
    fn a_robot_that_lacks_a_part_is_refused_by_its_name() {
        let said = |from: &str, to: &str| Blueprint::parse(&URDF.replace(from, to)).unwrap_err().to_string();
        assert!(said("left_axle", "left_axis").contains("no joint `left_axle`"));
        assert!(said("link name=\"caster\"", "link name=\"roller\"").contains("no link `caster`"));
        assert!(said("sphere radius=\"0.018\"", "box size=\"1 1 1\"").contains("no sphere of link `caster`"));
        assert!(said("<robot", "<rabbit").contains("does not parse"));
    }
}
