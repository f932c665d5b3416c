//! The car in the engine: one rigid body with its wheels' forces on it, on the ground, among solids.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use rapier3d::prelude::*;

use super::BuildError;
use super::blueprint::{Blueprint, LUGGAGE_M, WHEELS};
use super::config::CarConfig;
use super::wheel::{Inputs, Motion, Push, Wheel};
use crate::robots::frames::{from_engine, from_vector, to_engine, to_vector, yawed};
use crate::scenes::solid::Ground;

/// Everything that acts on the wheels during a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Controls {
    /// Mean angle of the front wheels, to the left.
    pub steer_rad: f64,
    /// Engine's torque on each of the wheels.
    pub drive_n_m: [f64; 4],
    /// Greatest braking torque on each of the wheels.
    pub brake_n_m: [f64; 4],
    /// Coulomb friction between tyres and road.
    pub friction: f64,
    /// Factors on the stiffness of the tyres' tread, along and across the wheels.
    pub tread_ratio: [f64; 2],
    /// Rolling resistance, as a share of the load, on top of the tyres' own.
    pub rolling_resistance: f64,
    /// Resistance on top of the air's for each m/s.
    pub drag_n_s_per_m: f64,
    /// Resistance on top of the air's for each (m/s)^2.
    pub drag_n_s2_per_m2: f64,
}

/// What is put on and under the car from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Factor on mass and moments of inertia.
    pub mass_ratio: f64,
    /// In the luggage space.
    pub luggage_kg: f64,
    /// Sine of the slope of all ground, times the unit vector uphill in world x and y.
    pub slope: [f64; 2],
}

impl Default for Setting {
    fn default() -> Self {
        Self { mass_ratio: 1.0, luggage_kg: 0.0, slope: [0.0; 2] }
    }
}

/// The car in its own engine.
pub struct Body {
    engine: PhysicsWorld,
    chassis: RigidBodyHandle,
    ground: SharedShape,
    blueprint: Blueprint,
    wheels: [Wheel; 4],
    anti_roll_n_per_m: f64,
    air_drag_n_s2_per_m2: f64,
    time_step_s: f64,
    gravity_m_per_s2: f64,
    setting: Setting,
    centre_of_mass_m: Vector3<f64>,
}

impl Body {
    /// Puts the car with its Velodyne above a place, its wheels just on the ground.
    ///
    /// # Errors
    /// If there is no ground, or the engine refuses it.
    pub fn new(
        config: &CarConfig,
        blueprint: Blueprint,
        ground: &Ground,
        [x_m, y_m]: [f64; 2],
        facing: UnitQuaternion<f64>,
    ) -> Result<Self, BuildError> {
        let mut engine = PhysicsWorld::new();
        engine.gravity = Vector::new(0.0, 0.0, -config.physics.gravity_m_per_s2 as f32);
        engine.integration_parameters.dt = config.physics.time_step_s as f32;
        engine.integration_parameters.num_solver_iterations = 1;
        let endless = ground.triangles.is_empty();
        let shape = if endless {
            SharedShape::halfspace(Vector::Z)
        } else {
            let vertices = ground.vertices.iter().map(|&[x, y, z]| Vector::new(x, y, z)).collect();
            SharedShape::trimesh(vertices, ground.triangles.clone())
                .map_err(|error| BuildError::Ground(error.to_string()))?
        };
        // Nothing but its wheels touches a plane on which nothing stands.
        let touches = !(endless && ground.solids.is_empty());
        if touches {
            engine.colliders.insert(ColliderBuilder::new(shape.clone()));
        }
        for solid in &ground.solids {
            let [hx, hy, hz] = solid.half_m.map(|half| half as f32);
            let turned = yawed(asami_math::elementary::atan2(solid.along[1], solid.along[0]));
            let pose = Isometry3::from_parts(Translation3::from(Vector3::from(solid.centre_m)), turned);
            engine.colliders.insert(ColliderBuilder::cuboid(hx, hy, hz).position(to_engine(&pose)));
        }

        let mount = blueprint.body_from_velodyne.translation.vector;
        let at = Vector3::new(x_m, y_m, 0.0) - facing * Vector3::new(mount.x, mount.y, 0.0);
        let radius_m = blueprint.wheels[0].radius_m;
        let mut height_m = f64::MIN;
        for wheel in &blueprint.wheels {
            let hub = at + facing * wheel.hub_m;
            let (down_m, _) =
                feel(&shape, Vector3::new(hub.x, hub.y, 1e2), -Vector3::z(), 2e2).ok_or(BuildError::OffGround)?;
            height_m = height_m.max(1e2 - down_m);
        }
        let pose = Isometry3::from_parts(Translation3::new(at.x, at.y, height_m + radius_m), facing);
        let body = RigidBodyBuilder::dynamic()
            .pose(to_engine(&pose))
            .additional_mass_properties(Load::of(&blueprint, &Setting::default()).properties())
            .can_sleep(false);
        let chassis = engine.bodies.insert(body);
        for shell in blueprint.shells.iter().filter(|_| touches) {
            let half = shell.half_m.map(|half| half as f32);
            let collider = ColliderBuilder::cuboid(half.x, half.y, half.z)
                .position(to_engine(&Isometry3::from_parts(shell.centre_m.into(), UnitQuaternion::identity())))
                .density(0.0);
            engine.colliders.insert_with_parent(collider, chassis, &mut engine.bodies);
        }

        let weight_n = blueprint.mass_kg * config.physics.gravity_m_per_s2;
        let front_share = 0.5 + blueprint.centre_of_mass_m.x / blueprint.wheelbase_m();
        let wheels = std::array::from_fn(|i| {
            let front = i < 2;
            let share = if front { front_share } else { 1.0 - front_share };
            let preload_n = 0.5 * share * weight_n;
            let wheel = Wheel::new(blueprint.wheels[i], &config.suspension, front, config.tyre.clone(), preload_n);
            if endless { wheel.on_a_plane() } else { wheel }
        });
        Ok(Self {
            engine,
            chassis,
            ground: shape,
            centre_of_mass_m: blueprint.centre_of_mass_m,
            blueprint,
            wheels,
            anti_roll_n_per_m: config.suspension.anti_roll_n_per_m,
            air_drag_n_s2_per_m2: config.engine.air_drag_n_s2_per_m2,
            time_step_s: config.physics.time_step_s,
            gravity_m_per_s2: config.physics.gravity_m_per_s2,
            setting: Setting::default(),
        })
    }

    /// Moves on by one engine step.
    pub fn step(&mut self, controls: &Controls) {
        let motion = self.motion();
        let mut push = Push::default();
        let travels_m = [0, 1, 2, 3].map(|i: usize| self.wheels[i].travel_m());
        for i in 0..WHEELS.len() {
            let inputs = Inputs {
                steer_rad: if i < 2 { self.steered_rad(controls.steer_rad, i) } else { 0.0 },
                anti_roll_n: self.anti_roll_n_per_m * (travels_m[i] - travels_m[i ^ 1]),
                drive_n_m: controls.drive_n_m[i],
                brake_n_m: controls.brake_n_m[i],
                friction: controls.friction,
                tread_ratio: controls.tread_ratio,
                rolling_resistance: controls.rolling_resistance,
            };
            let ground = &self.ground;
            let down = |from_m, along, most_m| feel(ground, from_m, along, most_m);
            self.wheels[i].step(&motion, &inputs, &down, self.time_step_s, &mut push);
        }
        let velocity = motion.velocity_m_per_s;
        let square = self.air_drag_n_s2_per_m2 + controls.drag_n_s2_per_m2;
        push.force_n -= velocity * (square * velocity.norm() + controls.drag_n_s_per_m);

        if let Some(body) = self.engine.bodies.get_mut(self.chassis) {
            body.reset_forces(true);
            body.reset_torques(true);
            body.add_force(to_vector(&push.force_n), true);
            body.add_torque(to_vector(&push.moment_n_m), true);
        }
        self.engine.step();
    }

    /// Each front wheel's angle: both roll about one centre on the line of the rear axle.
    fn steered_rad(&self, steer_rad: f64, wheel: usize) -> f64 {
        let tan = asami_math::elementary::tan(steer_rad);
        // cot(wheel) = cot(mean) -+ half track / wheelbase (Ackermann, 1818)
        let aside = self.blueprint.wheels[wheel].hub_m.y / self.blueprint.wheelbase_m();
        asami_math::elementary::atan(tan / (1.0 - aside * tan))
    }

    /// Loads the car and tilts the ground; writes to the engine only what changed.
    pub fn set(&mut self, setting: Setting) {
        let loads = |it: &Setting| (it.mass_ratio, it.luggage_kg);
        if loads(&setting) != loads(&self.setting) {
            let load = Load::of(&self.blueprint, &setting);
            self.centre_of_mass_m = load.centre_m;
            if let Some(body) = self.engine.bodies.get_mut(self.chassis) {
                body.set_additional_mass_properties(load.properties(), true);
            }
        }
        if setting.slope != self.setting.slope {
            // On a plane that rises towards x, what is down leans back towards -x.
            let [x, y] = setting.slope;
            let down = Vector3::new(-x, -y, -(1.0 - x * x - y * y).max(0.0).sqrt()) * self.gravity_m_per_s2;
            self.engine.gravity = to_vector(&down);
        }
        self.setting = setting;
    }

    /// The wheels, front left, front right, rear left, rear right.
    #[must_use]
    pub fn wheels(&self) -> &[Wheel; 4] {
        &self.wheels
    }

    /// The body as it moves.
    #[must_use]
    pub fn motion(&self) -> Motion {
        let body = &self.engine.bodies[self.chassis];
        let pose = from_engine(body.position());
        Motion {
            origin_m: pose.translation.vector,
            rotation: pose.rotation,
            // In double precision from the pose: moments are differences of places.
            centre_of_mass_m: pose.translation.vector + pose.rotation * self.centre_of_mass_m,
            velocity_m_per_s: from_vector(body.linvel()),
            turning_rad_per_s: from_vector(body.angvel()),
        }
    }

    /// The Velodyne in the world, and its velocity.
    #[must_use]
    pub fn velodyne(&self) -> (Isometry3<f64>, Vector3<f64>) {
        let motion = self.motion();
        let world_from_body = Isometry3::from_parts(motion.origin_m.into(), motion.rotation);
        let pose = world_from_body * self.blueprint.body_from_velodyne;
        (pose, motion.velocity_at(pose.translation.vector))
    }
}

/// Mass with what was put into the car.
struct Load {
    mass_kg: f64,
    centre_m: Vector3<f64>,
    inertia_kg_m2: Matrix3<f64>,
}

impl Load {
    fn of(blueprint: &Blueprint, setting: &Setting) -> Self {
        let (own_kg, more_kg) = (blueprint.mass_kg * setting.mass_ratio, setting.luggage_kg);
        let arm = LUGGAGE_M - blueprint.centre_of_mass_m;
        let share = more_kg / (own_kg + more_kg);
        // Two bodies about their common centre (Steiner), the luggage a point.
        let apart = Matrix3::identity() * arm.dot(&arm) - arm * arm.transpose();
        Self {
            mass_kg: own_kg + more_kg,
            centre_m: blueprint.centre_of_mass_m + arm * share,
            inertia_kg_m2: blueprint.inertia_kg_m2 * setting.mass_ratio + apart * (own_kg * share),
        }
    }

    fn properties(&self) -> MassProperties {
        let inertia = &self.inertia_kg_m2;
        let column = |i: usize| Vector::new(inertia[(0, i)] as f32, inertia[(1, i)] as f32, inertia[(2, i)] as f32);
        MassProperties::with_inertia_matrix(
            to_vector(&self.centre_m),
            self.mass_kg as f32,
            Matrix::from_cols(column(0), column(1), column(2)),
        )
    }
}

/// See [`Feeler`](super::wheel::Feeler).
fn feel(ground: &SharedShape, from_m: Vector3<f64>, along: Vector3<f64>, most_m: f64) -> Option<(f64, Vector3<f64>)> {
    let ray = Ray::new(to_vector(&from_m), to_vector(&along));
    let hit = ground.cast_local_ray_and_get_normal(&ray, most_m as f32, true)?;
    let normal = from_vector(hit.normal);
    let facing = if normal.dot(&along) > 0.0 { -normal } else { normal };
    Some((f64::from(hit.time_of_impact), facing.normalize()))
}
