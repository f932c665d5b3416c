//! What the controller and the engine need to know of the body, read from its URDF.
//!
//! The engine's loader takes links, shapes, masses and joint ranges; effort, speed and damping it
//! leaves, so they are read here.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use urdf_rs::{Geometry, Robot};

use super::BuildError;
use super::leg::Leg;

/// The body, as shipped with the program.
pub const URDF: &str = include_str!("../../../../urdf/aibo_ers7.urdf");

/// How many joints move.
pub const JOINTS: usize = 15;

/// The moving joints in the order of every list of joints: four legs of three, neck tilt, pan, nod.
pub const JOINT_NAMES: [&str; JOINTS] = [
    "fl_rotator",
    "fl_elevator",
    "fl_knee",
    "fr_rotator",
    "fr_elevator",
    "fr_knee",
    "hl_rotator",
    "hl_elevator",
    "hl_knee",
    "hr_rotator",
    "hr_elevator",
    "hr_knee",
    "neck_tilt",
    "head_pan",
    "head_nod",
];

/// The legs in their order everywhere: fore left, fore right, hind left, hind right.
pub const LEG_NAMES: [&str; 4] = ["fl", "fr", "hl", "hr"];

/// Limits of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    /// Least and greatest angle.
    pub range_rad: [f64; 2],
    /// Greatest torque of its servo.
    pub effort_n_m: f64,
    /// Greatest speed of its servo.
    pub speed_rad_per_s: f64,
    /// Friction of the gear that grows with speed.
    pub damping_n_m_s_per_rad: f64,
}

/// The body.
#[derive(Clone, Debug)]
pub struct Blueprint {
    /// As parsed.
    pub robot: Robot,
    /// Limits of each of [`JOINT_NAMES`].
    pub joints: [JointLimits; JOINTS],
    /// Each of [`LEG_NAMES`].
    pub legs: [Leg; 4],
    /// Radius of the feet.
    pub foot_radius_m: f64,
    /// Foot of the neck, from the torso's origin: forward, left, up.
    pub neck_m: [f64; 3],
    /// From the foot of the neck to the head's axes.
    pub neck_length_m: f64,
    /// The camera (x right, y down, z along the line of sight) in the head link.
    pub head_from_camera: Isometry3<f64>,
}

impl Blueprint {
    /// The shipped body.
    ///
    /// # Errors
    /// If the text lacks a part; the shipped one does not.
    pub fn shipped() -> Result<Self, BuildError> {
        Self::parse(URDF)
    }

    /// Reads a body with the shipped one's names.
    ///
    /// # Errors
    /// If the text does not parse or lacks a link or joint.
    pub fn parse(urdf: &str) -> Result<Self, BuildError> {
        let robot = urdf_rs::read_from_string(urdf).map_err(|error| BuildError::Urdf(error.to_string()))?;
        let mut joints =
            [JointLimits { range_rad: [0.0; 2], effort_n_m: 0.0, speed_rad_per_s: 0.0, damping_n_m_s_per_rad: 0.0 };
                JOINTS];
        for (limits, name) in joints.iter_mut().zip(JOINT_NAMES) {
            let joint = joint(&robot, name)?;
            *limits = JointLimits {
                range_rad: [joint.limit.lower, joint.limit.upper],
                effort_n_m: joint.limit.effort,
                speed_rad_per_s: joint.limit.velocity,
                damping_n_m_s_per_rad: joint.dynamics.as_ref().map_or(0.0, |dynamics| dynamics.damping),
            };
        }
        let [fl, fr, hl, hr] = LEG_NAMES.map(|name| leg(&robot, name));
        let (_, foot_radius_m) = foot(&robot, LEG_NAMES[0])?;
        let mount = joint(&robot, "camera_mount")?;
        let ([x, y, z], [roll, pitch, yaw]) = (*mount.origin.xyz, *mount.origin.rpy);
        let head_from_camera =
            Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw));
        let legs = [fl?, fr?, hl?, hr?];
        let neck_m = *joint(&robot, "neck_tilt")?.origin.xyz;
        let neck_length_m = joint(&robot, "head_pan")?.origin.xyz[2];
        Ok(Self { joints, legs, foot_radius_m, neck_m, neck_length_m, head_from_camera, robot })
    }

    /// Mass of all links.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.robot.links.iter().map(|link| link.inertial.mass.value).sum()
    }
}

fn joint<'a>(robot: &'a Robot, name: &str) -> Result<&'a urdf_rs::Joint, BuildError> {
    let found = robot.joints.iter().find(|joint| joint.name == name);
    found.ok_or_else(|| BuildError::Missing { kind: "joint", name: name.to_owned() })
}

/// How far below the knee the foot's centre is, and its radius: the lowest ball of the lower leg.
fn foot(robot: &Robot, leg: &str) -> Result<(f64, f64), BuildError> {
    let name = format!("{leg}_lower");
    let link = robot.links.iter().find(|link| link.name == name);
    let balls = link.into_iter().flat_map(|link| &link.collision).filter_map(|collision| match collision.geometry {
        Geometry::Sphere { radius } => Some((-collision.origin.xyz[2], radius)),
        _ => None,
    });
    balls.max_by(|a, b| a.0.total_cmp(&b.0)).ok_or(BuildError::Missing { kind: "foot in link", name })
}

fn leg(robot: &Robot, name: &str) -> Result<Leg, BuildError> {
    let [rotator, elevator, knee] = ["rotator", "elevator", "knee"].map(|part| joint(robot, &format!("{name}_{part}")));
    let (rotator, elevator, knee) = (rotator?, elevator?, knee?);
    let hip_m = *rotator.origin.xyz;
    Ok(Leg {
        hip_m,
        side: 1.0_f64.copysign(hip_m[1]),
        bend: if hip_m[0] > 0.0 { -1.0 } else { 1.0 },
        thigh_m: -knee.origin.xyz[2],
        shank_m: foot(robot, name)?.0,
        limits_rad: [rotator, elevator, knee].map(|joint| [joint.limit.lower, joint.limit.upper]),
    })
}
