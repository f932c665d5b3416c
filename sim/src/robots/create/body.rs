//! The robot in the engine: a body on two motored wheels and a caster that slides.

use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};
use rapier3d::prelude::*;

use super::BuildError;
use super::blueprint::{Blueprint, WHEELS, WheelPlan};
use super::config::CreateConfig;
use crate::knobs::{BodyKnobs, Knobs};
use crate::robots::frames::{from_engine, to_engine, to_vector, yawed};

/// The axis about which wheels turn, in the joint's own frame.
const AXIS: usize = JointAxis::AngX as usize;

/// How high above the body's origin a load is: on the deck.
const PAYLOAD_UP_M: f64 = 0.12;

/// The Create in its own engine, with a flat floor.
pub struct Body {
    engine: PhysicsWorld,
    /// Its frame is at its centre of mass: the engine turns the root of a multibody about its frame's origin, and moves that
    /// as its centre of mass moves.
    chassis: RigidBodyHandle,
    centre_of_mass_m: Vector3<f64>,
    wheels: [Wheel; 2],
    friction: f64,
    gain: f64,
    integral: f64,
    time_step_s: f64,
}

struct Wheel {
    body: RigidBodyHandle,
    tyre: ColliderHandle,
    joint: MultibodyJointHandle,
    /// What it has fallen behind, rad.
    behind_rad: f64,
}

impl Body {
    /// Puts the robot on the floor, its origin above a place of the world, turned about the vertical (URDF axes: x
    /// forward).
    ///
    /// # Errors
    /// If the engine refuses a wheel.
    pub fn new(
        config: &CreateConfig,
        blueprint: &Blueprint,
        [x_m, y_m]: [f64; 2],
        turned_rad: f64,
        knobs: &Knobs,
    ) -> Result<Self, BuildError> {
        let physics = &config.physics;
        let mut engine = PhysicsWorld::new();
        engine.gravity = Vector::new(0.0, 0.0, -physics.gravity_m_per_s2 as f32);
        let parameters = &mut engine.integration_parameters;
        parameters.dt = physics.time_step_s as f32;
        parameters.num_solver_iterations = physics.solver_iterations as usize;
        parameters.num_internal_pgs_iterations = physics.pgs_iterations as usize;
        parameters.length_unit = 0.1;
        parameters.friction_in_bias_pass = true;
        // The smaller coefficient counts: a tyre's own friction, never the floor's.
        let floor = ColliderBuilder::new(SharedShape::halfspace(Vector::Z))
            .friction(1e3)
            .friction_combine_rule(CoefficientCombineRule::Min);
        engine.colliders.insert(floor);

        let load = Load::of(blueprint, &knobs.body);
        let at_m = Vector3::new(x_m, y_m, blueprint.wheels[0].radius_m);
        let pose = Isometry3::from_parts(at_m.into(), yawed(turned_rad)) * Translation3::from(load.centre_m);
        let chassis = RigidBodyBuilder::dynamic()
            .pose(to_engine(&pose))
            .additional_mass_properties(load.properties())
            .can_sleep(false);
        let chassis = engine.bodies.insert(chassis);
        let caster = ColliderBuilder::ball(blueprint.caster_radius_m as f32)
            .translation(to_vector(&(blueprint.caster_m - load.centre_m)))
            .density(0.0)
            .friction(0.0)
            .friction_combine_rule(CoefficientCombineRule::Min);
        engine.colliders.insert_with_parent(caster, chassis, &mut engine.bodies);
        let mut hold = |i: usize| {
            let plan = WheelPlan {
                hub_m: blueprint.wheels[i].hub_m.component_mul(&Vector3::new(1.0, knobs.wheels.base_ratio, 1.0))
                    - load.centre_m,
                radius_m: blueprint.wheels[i].radius_m * knobs.wheels.radius_ratio[i],
                ..blueprint.wheels[i]
            };
            wheel(&mut engine, chassis, &pose, &plan, config).ok_or(BuildError::Joint(WHEELS[i]))
        };
        let wheels = [hold(0)?, hold(1)?];
        if let Some((multibody, _)) = engine.multibody_joints.get_mut(wheels[0].joint) {
            // Only this first pass gives the free root its six degrees of freedom and the vectors their length; the engine's
            // own damping acts on the free root too.
            multibody.forward_kinematics(&engine.bodies, true);
            multibody.damping_mut().fill(0.0);
        }
        Ok(Self {
            engine,
            chassis,
            centre_of_mass_m: load.centre_m,
            wheels,
            friction: physics.friction,
            gain: config.wheels.gain_n_m_s_per_rad,
            integral: config.wheels.integral_n_m_per_rad,
            time_step_s: physics.time_step_s,
        })
    }

    /// Inclines the floor: gravity in the floor's own axes. `slope` is its sine, times the unit vector uphill.
    pub fn incline(&mut self, slope: [f64; 2]) {
        if slope != [0.0; 2] {
            let g_m_per_s2 = f64::from(self.engine.gravity.z.abs());
            let [x, y] = slope;
            let down = Vector3::new(-x, -y, -(1.0 - x * x - y * y).max(0.0).sqrt()) * g_m_per_s2;
            self.engine.gravity = to_vector(&down);
        }
    }

    /// Sets the tyres' friction coefficient; writes to the engine only what changed, since its setters raise flags that
    /// would change later bits.
    pub fn set_friction(&mut self, friction: f64) {
        if friction != self.friction {
            self.friction = friction;
            for wheel in &self.wheels {
                self.engine.colliders[wheel.tyre].set_friction(friction as f32);
            }
        }
    }

    /// Moves on by one engine step, the motors holding their wheels at these speeds, left and right, rad/s.
    pub fn step(&mut self, wanted_rad_per_s: [f64; 2]) {
        for (i, wanted) in wanted_rad_per_s.into_iter().enumerate() {
            let behind = (wanted - self.spin_rad_per_s(i)) * self.time_step_s;
            let wheel = &mut self.wheels[i];
            wheel.behind_rad += behind;
            let aim = wanted + self.integral / self.gain * wheel.behind_rad;
            if let Some((multibody, link)) = self.engine.multibody_joints.get_mut(wheel.joint)
                && let Some(link) = multibody.link_mut(link)
            {
                link.joint.data.motors[AXIS].target_vel = aim as f32;
            }
        }
        self.engine.step();
    }

    /// How fast a wheel turns about its axle, forwards positive.
    #[must_use]
    pub fn spin_rad_per_s(&self, wheel: usize) -> f64 {
        let chassis = &self.engine.bodies[self.chassis];
        let apart = self.engine.bodies[self.wheels[wheel].body].angvel() - chassis.angvel();
        f64::from(apart.dot(*chassis.rotation() * Vector::Y))
    }

    /// The body in the world (URDF axes: x forward).
    #[must_use]
    pub fn world_from_body(&self) -> Isometry3<f64> {
        from_engine(self.engine.bodies[self.chassis].position()) * Translation3::from(-self.centre_of_mass_m)
    }

    /// Mass of all parts as the engine holds it; 0 before the first step.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        let wheels = self.wheels.iter().map(|wheel| wheel.body);
        wheels.chain([self.chassis]).map(|handle| f64::from(self.engine.bodies[handle].mass())).sum()
    }
}

/// The chassis with what is on its deck, a point.
struct Load {
    mass_kg: f64,
    centre_m: Vector3<f64>,
    inertia_kg_m2: Matrix3<f64>,
}

impl Load {
    fn of(blueprint: &Blueprint, knobs: &BodyKnobs) -> Self {
        let (own_kg, more_kg) = (blueprint.mass_kg, knobs.payload_kg);
        let arm = Vector3::new(knobs.payload_ahead_m, 0.0, PAYLOAD_UP_M) - blueprint.centre_of_mass_m;
        let share = more_kg / (own_kg + more_kg);
        // Two bodies about their common centre (Steiner).
        let apart = Matrix3::identity() * arm.dot(&arm) - arm * arm.transpose();
        Self {
            mass_kg: own_kg + more_kg,
            centre_m: blueprint.centre_of_mass_m + arm * share,
            inertia_kg_m2: blueprint.inertia_kg_m2 + apart * (own_kg * share),
        }
    }

    /// About the centre of mass.
    fn properties(&self) -> MassProperties {
        let inertia = &self.inertia_kg_m2;
        let column = |i: usize| Vector::new(inertia[(0, i)] as f32, inertia[(1, i)] as f32, inertia[(2, i)] as f32);
        let columns = Matrix::from_cols(column(0), column(1), column(2));
        MassProperties::with_inertia_matrix(Vector::ZERO, self.mass_kg as f32, columns)
    }
}

/// Hangs a wheel on the chassis.
fn wheel(
    engine: &mut PhysicsWorld,
    chassis: RigidBodyHandle,
    world_from_chassis: &Isometry3<f64>,
    plan: &WheelPlan,
    config: &CreateConfig,
) -> Option<Wheel> {
    let pose = world_from_chassis * Isometry3::translation(plan.hub_m.x, plan.hub_m.y, plan.hub_m.z);
    let properties = MassProperties::new(Vector::ZERO, plan.mass_kg as f32, to_vector(&plan.inertia_kg_m2));
    let body =
        RigidBodyBuilder::dynamic().pose(to_engine(&pose)).additional_mass_properties(properties).can_sleep(false);
    let body = engine.bodies.insert(body);
    let tyre = ColliderBuilder::ball(plan.radius_m as f32)
        .density(0.0)
        .friction(config.physics.friction as f32)
        .friction_combine_rule(CoefficientCombineRule::Min);
    let tyre = engine.colliders.insert_with_parent(tyre, body, &mut engine.bodies);
    let axle = RevoluteJointBuilder::new(Vector::Y)
        .local_anchor1(to_vector(&plan.hub_m))
        .motor_model(MotorModel::ForceBased)
        .motor_velocity(0.0, config.wheels.gain_n_m_s_per_rad as f32)
        .motor_max_force(plan.effort_n_m as f32)
        .contacts_enabled(false);
    let joint = engine.multibody_joints.insert(chassis, body, axle, true)?;
    Some(Wheel { body, tyre, joint, behind_rad: 0.0 })
}
