//! The body in the engine: links, motors, feet on the ground.

use asami_math::elementary::atan2;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use rapier3d::prelude::*;
use rapier3d_urdf::{UrdfLoaderOptions, UrdfMultibodyOptions, UrdfRobot};

use super::BuildError;
use super::blueprint::{Blueprint, JOINT_NAMES, JOINTS, LEG_NAMES};
use super::config::{AiboConfig, Joints, Physics};
use super::engine::Engine;
use crate::knobs::BodyKnobs;
use crate::robots::frames::{from_engine, to_engine};

/// The axis about which every joint turns, in its own frame.
const AXIS: usize = JointAxis::AngX as usize;
/// Nearer than this to a limit a joint could meet it within a step: its servo makes an eighth of that.
const NEAR_RAD: f32 = 0.1;

/// A load's size, and how high above the body's centre it is: on the back.
pub(super) const PAYLOAD_RADIUS_M: f32 = 0.03;
pub(super) const PAYLOAD_UP_M: f32 = 0.06;

/// The Aibo in its own engine, with a flat ground.
pub struct Body {
    engine: PhysicsWorld,
    joints: JointHandles,
    torso: RigidBodyHandle,
    head: RigidBodyHandle,
    links: Vec<(String, RigidBodyHandle)>,
    ground: ColliderHandle,
    feet: [ColliderHandle; 4],
    /// Shapes other than the feet.
    shell: Vec<ColliderHandle>,
    friction: [f64; 5],
    /// Of every joint's motor, nominally: torque for each radian of error, and at most.
    motors: [[f64; 2]; JOINTS],
    torque_ratio: [f64; 4],
}

enum JointHandles {
    Multibody(Vec<MultibodyJointHandle>),
    Impulse(Vec<ImpulseJointHandle>),
}

impl Body {
    /// Puts the body with the given joint angles at a pose of its torso (URDF axes: x forward).
    ///
    /// # Errors
    /// If the blueprint lacks a part.
    pub fn new(
        config: &AiboConfig,
        blueprint: &Blueprint,
        world_from_torso: &Isometry3<f64>,
        angles_rad: &[f64; JOINTS],
    ) -> Result<Self, BuildError> {
        let mut engine = engine(&config.physics);
        // The smaller coefficient counts: a foot's own friction, never the ground's.
        let ground = ColliderBuilder::new(SharedShape::halfspace(Vector::Z))
            .friction(1e3)
            .friction_combine_rule(CoefficientCombineRule::Min);
        let ground = engine.colliders.insert(ground);

        let options = UrdfLoaderOptions {
            shift: to_engine(world_from_torso),
            collider_blueprint: ColliderBuilder::default()
                .density(0.0)
                .friction(config.physics.friction as f32)
                .friction_combine_rule(CoefficientCombineRule::Min),
            rigid_body_blueprint: RigidBodyBuilder::dynamic().can_sleep(false),
            ..UrdfLoaderOptions::default()
        };
        let mut urdf = UrdfRobot::from_robot(&blueprint.robot, options, std::path::Path::new(""));
        let order = joint_order(blueprint, &urdf)?;
        for (i, &at) in order.iter().enumerate() {
            fit_motor(&mut urdf.joints[at].joint, config, blueprint.joints[i].effort_n_m, angles_rad[i]);
        }
        if config.joints == Joints::Impulse {
            bend(&mut urdf, &order, angles_rad);
        }
        let names: Vec<String> =
            urdf.links.iter().map(|link| blueprint.robot.links[link.urdf_link_index].name.clone()).collect();
        let (joints, links) = match config.joints {
            Joints::Multibody => insert_multibody(&mut engine, urdf, &order, config, blueprint, angles_rad)?,
            Joints::Impulse => insert_impulse(&mut engine, urdf, &order),
        };
        let links: Vec<(String, RigidBodyHandle)> = names.into_iter().zip(links).collect();

        let [fl, fr, hl, hr] = LEG_NAMES.map(|leg| foot(&engine, &links, leg));
        let feet = [fl?, fr?, hl?, hr?];
        let shell = engine.colliders.iter().map(|(handle, _)| handle);
        let shell = shell.filter(|handle| *handle != ground && !feet.contains(handle)).collect();
        Ok(Self {
            torso: link(&links, "torso")?,
            head: link(&links, "head")?,
            engine,
            joints,
            links,
            ground,
            feet,
            shell,
            friction: [config.physics.friction; 5],
            motors: blueprint.joints.map(|joint| [config.servo.stiffness_n_m_per_rad, joint.effort_n_m]),
            torque_ratio: [1.0; 4],
        })
    }

    fn motor_mut(&mut self, i: usize) -> Option<&mut JointMotor> {
        let joint = match &self.joints {
            JointHandles::Multibody(handles) => {
                let (multibody, link) = self.engine.multibody_joints.get_mut(*handles.get(i)?)?;
                &mut multibody.link_mut(link)?.joint.data
            }
            JointHandles::Impulse(handles) => &mut self.engine.impulse_joints.get_mut(*handles.get(i)?, false)?.data,
        };
        Some(&mut joint.motors[AXIS])
    }

    /// Leaves to the engine only those limits that a joint is near to, or beyond: each costs it as much as a motor, and does nothing
    /// before it is met.
    fn mind_limits(&mut self) {
        let JointHandles::Multibody(handles) = &self.joints else { return };
        for &handle in handles {
            let Some((multibody, link)) = self.engine.multibody_joints.get_mut(handle) else { continue };
            let Some(link) = multibody.link_mut(link) else { continue };
            let angle_rad = link.joint.coords()[AXIS];
            let limits = &link.joint.data.limits[AXIS];
            let is_near = angle_rad < limits.min + NEAR_RAD || angle_rad > limits.max - NEAR_RAD;
            link.joint.data.limit_axes.set(JointAxesMask::ANG_X, is_near);
        }
    }
}

impl Engine for Body {
    fn load(&mut self, knobs: &BodyKnobs) {
        for (foot, short_m) in self.feet.into_iter().zip(knobs.short_m) {
            let at = self.engine.colliders[foot].position_wrt_parent().copied();
            if let Some(mut at) = at.filter(|_| short_m != 0.0) {
                at.translation.z += short_m as f32;
                self.engine.colliders[foot].set_position_wrt_parent(at);
            }
        }
        if knobs.payload_kg > 0.0 {
            // A ball that meets nothing.
            let ball = ColliderBuilder::ball(PAYLOAD_RADIUS_M)
                .translation(Vector::new(knobs.payload_ahead_m as f32, 0.0, PAYLOAD_UP_M))
                .mass(knobs.payload_kg as f32)
                .collision_groups(InteractionGroups::none());
            self.engine.colliders.insert_with_parent(ball, self.torso, &mut self.engine.bodies);
        }
    }

    fn incline(&mut self, slope: [f64; 2]) {
        if slope != [0.0; 2] {
            let g_m_per_s2 = f64::from(self.engine.gravity.z.abs());
            let [x, y] = slope;
            let level = (1.0 - x * x - y * y).max(0.0).sqrt();
            self.engine.gravity =
                Vector::new((-g_m_per_s2 * x) as f32, (-g_m_per_s2 * y) as f32, (-g_m_per_s2 * level) as f32);
        }
    }

    fn set_torque(&mut self, ratios: [f64; 4]) {
        for (leg, ratio) in ratios.into_iter().enumerate() {
            if ratio == self.torque_ratio[leg] {
                continue;
            }
            self.torque_ratio[leg] = ratio;
            for i in 3 * leg..3 * leg + 3 {
                let [stiffness, effort_n_m] = self.motors[i].map(|nominal| (ratio * nominal) as f32);
                if let Some(motor) = self.motor_mut(i) {
                    motor.stiffness = stiffness;
                    motor.max_force = effort_n_m;
                }
            }
        }
    }

    fn step(&mut self) {
        self.mind_limits();
        self.engine.step();
    }

    fn aim(&mut self, set_points_rad: &[f64]) {
        for (i, &angle_rad) in set_points_rad.iter().enumerate() {
            if let Some(motor) = self.motor_mut(i) {
                motor.target_pos = angle_rad as f32;
            }
        }
    }

    fn angle_rad(&self, i: usize) -> f64 {
        let angle = match &self.joints {
            JointHandles::Multibody(handles) => handles.get(i).and_then(|&handle| {
                let (multibody, link) = self.engine.multibody_joints.get(handle)?;
                Some(multibody.link(link)?.joint.coords()[AXIS])
            }),
            JointHandles::Impulse(handles) => handles.get(i).and_then(|&handle| {
                let joint = self.engine.impulse_joints.get(handle)?;
                let turned = |body: RigidBodyHandle, frame: &Pose| self.engine.bodies[body].rotation() * frame.rotation;
                let first = turned(joint.body1(), &joint.data.local_frame1);
                let second = turned(joint.body2(), &joint.data.local_frame2);
                let between = first.inverse() * second;
                Some(2.0 * atan2(f64::from(between.x), f64::from(between.w)) as f32)
            }),
        };
        angle.map_or(f64::NAN, f64::from)
    }

    fn set_friction(&mut self, feet: [f64; 4], shell: f64) {
        // Only what changed: its setters raise flags that would change later bits.
        for (i, friction) in feet.into_iter().enumerate() {
            if friction != self.friction[i] {
                self.friction[i] = friction;
                self.engine.colliders[self.feet[i]].set_friction(friction as f32);
            }
        }
        if shell != self.friction[4] {
            self.friction[4] = shell;
            for &handle in &self.shell {
                self.engine.colliders[handle].set_friction(shell as f32);
            }
        }
    }

    fn feet_down(&self) -> [bool; 4] {
        self.feet.map(|foot| {
            self.engine.narrow_phase.contact_pair(self.ground, foot).is_some_and(|pair| pair.has_any_active_contact())
        })
    }

    fn world_from_torso(&self) -> Isometry3<f64> {
        from_engine(self.engine.bodies[self.torso].position())
    }

    fn world_from_head(&self) -> Isometry3<f64> {
        from_engine(self.engine.bodies[self.head].position())
    }

    fn world_from_link(&self, name: &str) -> Option<Isometry3<f64>> {
        let (_, handle) = self.links.iter().find(|(link, _)| link == name)?;
        Some(from_engine(self.engine.bodies[*handle].position()))
    }

    fn mass_kg(&self) -> f64 {
        self.links.iter().map(|(_, handle)| f64::from(self.engine.bodies[*handle].mass())).sum()
    }
}

fn engine(physics: &Physics) -> PhysicsWorld {
    let mut engine = PhysicsWorld::new();
    engine.gravity = Vector::new(0.0, 0.0, -physics.gravity_m_per_s2 as f32);
    let parameters = &mut engine.integration_parameters;
    parameters.dt = physics.time_step_s as f32;
    parameters.num_solver_iterations = physics.solver_iterations as usize;
    parameters.num_internal_pgs_iterations = physics.pgs_iterations as usize;
    parameters.length_unit = physics.length_unit_m as f32;
    // Without friction in this pass too a standing robot creeps by millimetres a second.
    parameters.friction_in_bias_pass = true;
    engine
}

/// Index into the loader's joints of each of [`JOINT_NAMES`].
fn joint_order(blueprint: &Blueprint, urdf: &UrdfRobot) -> Result<[usize; JOINTS], BuildError> {
    let mut order = [0; JOINTS];
    for (at, name) in order.iter_mut().zip(JOINT_NAMES) {
        let found = urdf.joints.iter().position(|joint| blueprint.robot.joints[joint.urdf_joint_index].name == name);
        *at = found.ok_or_else(|| BuildError::Missing { kind: "joint", name: name.to_owned() })?;
    }
    Ok(order)
}

fn fit_motor(joint: &mut GenericJoint, config: &AiboConfig, effort_n_m: f64, angle_rad: f64) {
    let servo = &config.servo;
    joint.set_motor_model(JointAxis::AngX, MotorModel::ForceBased);
    joint.set_motor_position(
        JointAxis::AngX,
        angle_rad as f32,
        servo.stiffness_n_m_per_rad as f32,
        servo.damping_n_m_s_per_rad as f32,
    );
    joint.set_motor_max_force(JointAxis::AngX, effort_n_m as f32);
}

/// Turns each link about its parent: the loader places all of them at angle 0.
fn bend(urdf: &mut UrdfRobot, order: &[usize; JOINTS], angles_rad: &[f64; JOINTS]) {
    for at in 0..urdf.joints.len() {
        let Some(i) = order.iter().position(|&ordered| ordered == at) else { continue };
        let (parent, child, joint) = (urdf.joints[at].link1, urdf.joints[at].link2, urdf.joints[at].joint);
        let turn = to_engine(&Isometry3::from_parts(
            Translation3::identity(),
            UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), angles_rad[i]),
        ));
        let pose = *urdf.links[parent].body.position() * joint.local_frame1 * turn * joint.local_frame2.inverse();
        urdf.links[child].body.set_position(pose, false);
    }
}

type Inserted = (JointHandles, Vec<RigidBodyHandle>);

fn insert_multibody(
    engine: &mut PhysicsWorld,
    urdf: UrdfRobot,
    order: &[usize; JOINTS],
    config: &AiboConfig,
    blueprint: &Blueprint,
    angles_rad: &[f64; JOINTS],
) -> Result<Inserted, BuildError> {
    let inserted = urdf.insert_using_multibody_joints(
        &mut engine.bodies,
        &mut engine.colliders,
        &mut engine.multibody_joints,
        UrdfMultibodyOptions::DISABLE_SELF_CONTACTS,
    );
    let refused = |i: usize| BuildError::Joint(JOINT_NAMES[i].to_owned());
    let mut handles = Vec::with_capacity(JOINTS);
    let mut degrees = Vec::with_capacity(JOINTS);
    for (i, &at) in order.iter().enumerate() {
        let handle = inserted.joints[at].joint.ok_or_else(|| refused(i))?;
        let (multibody, link) = engine.multibody_joints.get(handle).ok_or_else(|| refused(i))?;
        let link = multibody.link(link).ok_or_else(|| refused(i))?;
        handles.push((handle, link.link_id()));
    }
    let (multibody, _) = engine.multibody_joints.get_mut(handles[0].0).ok_or_else(|| refused(0))?;
    // Only this first pass gives the free root its six degrees of freedom and the vectors their length.
    multibody.forward_kinematics(&engine.bodies, true);
    for (i, &(_, link)) in handles.iter().enumerate() {
        degrees.push(multibody.link(link).ok_or_else(|| refused(i))?.assembly_id());
    }
    let mut displacement = vec![0.0_f32; multibody.ndofs()];
    // The engine's default damping is ten times the URDF's, and acts on the free root too.
    multibody.damping_mut().fill(0.0);
    for (i, &degree) in degrees.iter().enumerate() {
        displacement[degree] = angles_rad[i] as f32;
        multibody.damping_mut()[degree] = blueprint.joints[i].damping_n_m_s_per_rad as f32;
        multibody.armature_mut()[degree] = config.servo.armature_kg_m2 as f32;
    }
    multibody.apply_displacements(&displacement);
    multibody.forward_kinematics(&engine.bodies, false);
    multibody.update_rigid_bodies(&mut engine.bodies, true);
    let links = inserted.links.iter().map(|link| link.body).collect();
    Ok((JointHandles::Multibody(handles.into_iter().map(|(handle, _)| handle).collect()), links))
}

fn insert_impulse(engine: &mut PhysicsWorld, urdf: UrdfRobot, order: &[usize; JOINTS]) -> Inserted {
    let inserted =
        urdf.insert_using_impulse_joints(&mut engine.bodies, &mut engine.colliders, &mut engine.impulse_joints);
    // The robot meets the ground (group 1) and not itself.
    let groups = InteractionGroups::new(Group::GROUP_2, Group::GROUP_1, InteractionTestMode::And);
    for collider in inserted.links.iter().flat_map(|link| &link.colliders) {
        engine.colliders[collider.handle].set_collision_groups(groups);
    }
    let handles = order.iter().map(|&at| inserted.joints[at].joint).collect();
    (JointHandles::Impulse(handles), inserted.links.iter().map(|link| link.body).collect())
}

fn link(links: &[(String, RigidBodyHandle)], name: &str) -> Result<RigidBodyHandle, BuildError> {
    let found = links.iter().find(|(link, _)| link == name);
    found.map(|(_, handle)| *handle).ok_or_else(|| BuildError::Missing { kind: "link", name: name.to_owned() })
}

/// The lowest shape of a lower leg.
fn foot(engine: &PhysicsWorld, links: &[(String, RigidBodyHandle)], leg: &str) -> Result<ColliderHandle, BuildError> {
    let name = format!("{leg}_lower");
    let lower = link(links, &name)?;
    let below = |handle: &ColliderHandle| {
        engine.colliders[*handle].position_wrt_parent().map_or(f32::MAX, |pose| pose.translation.z)
    };
    let lowest = engine.bodies[lower].colliders().iter().copied().min_by(|a, b| below(a).total_cmp(&below(b)));
    lowest.ok_or(BuildError::Missing { kind: "foot in link", name })
}

#[cfg(test)]
mod tests;
