//! One wheel: a hub on a spring and a damper, a tyre that rolls over what lies under it, a tread that grips.

use nalgebra::{UnitQuaternion, Vector3};

use super::blueprint::WheelPlan;
use super::config::{Suspension, Tyre};

/// Where along the wheel the ground is felt, in radii before the hub: a disc rolling over a kerb climbs it.
const DISC: [f64; 5] = [-0.8, -0.4, 0.0, 0.4, 0.8];
/// A plane reaches deepest under the hub.
const HUB: [f64; 1] = [0.0];
/// Feelers start this far above the hub.
const ABOVE_M: f64 = 0.4;

/// Cosine of the steepest slope that is rolled on as a plane.
const STEEPEST: f64 = 0.8;

/// The rigid body as the wheels need it. All in the world.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// The body's origin.
    pub origin_m: Vector3<f64>,
    /// World from body.
    pub rotation: UnitQuaternion<f64>,
    /// Centre of mass.
    pub centre_of_mass_m: Vector3<f64>,
    /// Velocity of the centre of mass.
    pub velocity_m_per_s: Vector3<f64>,
    /// Angular velocity.
    pub turning_rad_per_s: Vector3<f64>,
}

impl Motion {
    /// Velocity of the body at a place in the world.
    #[must_use]
    pub fn velocity_at(&self, at_m: Vector3<f64>) -> Vector3<f64> {
        self.velocity_m_per_s + self.turning_rad_per_s.cross(&(at_m - self.centre_of_mass_m))
    }
}

/// What a ray meets: how far off, and the surface's normal, of length 1. It starts at the first place, runs along the
/// second, and no farther than the third.
pub type Feeler<'a> = dyn Fn(Vector3<f64>, Vector3<f64>, f64) -> Option<(f64, Vector3<f64>)> + 'a;

/// A force on the body, and its moment about the centre of mass.
#[derive(Clone, Copy, Debug, Default)]
pub struct Push {
    /// In the world.
    pub force_n: Vector3<f64>,
    /// In the world.
    pub moment_n_m: Vector3<f64>,
}

impl Push {
    /// Adds a force that acts at a place.
    pub fn add(&mut self, motion: &Motion, force_n: Vector3<f64>, at_m: Vector3<f64>) {
        self.force_n += force_n;
        self.moment_n_m += (at_m - motion.centre_of_mass_m).cross(&force_n);
    }
}

/// What acts on a wheel during a step, the ground apart.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inputs {
    /// Angle of the wheel, to the left.
    pub steer_rad: f64,
    /// Force by which the anti-roll bar presses the hub down.
    pub anti_roll_n: f64,
    /// Torque of the engine.
    pub drive_n_m: f64,
    /// Greatest torque of the brake.
    pub brake_n_m: f64,
    /// Coulomb friction between tyre and road.
    pub friction: f64,
    /// Factors on the stiffness of the tread, along and across the wheel.
    pub tread_ratio: [f64; 2],
    /// Rolling resistance, as a share of the load, on top of the tyre's own.
    pub rolling_resistance: f64,
}

/// A wheel's state.
#[derive(Clone, Debug)]
pub struct Wheel {
    plan: WheelPlan,
    feelers: &'static [f64],
    tyre: Tyre,
    spring_n_per_m: f64,
    damper_n_s_per_m: f64,
    stop_n_per_m: f64,
    /// What the spring bears at rest.
    preload_n: f64,
    /// How far the hub is above where it rests, in the body.
    travel_m: f64,
    /// Velocity of the hub along the body's up axis, in the world.
    rising_m_per_s: f64,
    spin_rad_per_s: f64,
    /// Deflection of the tread, forward and left.
    tread_m: [f64; 2],
    load_n: f64,
}

impl Wheel {
    /// At rest, bearing `preload_n`.
    #[must_use]
    pub fn new(plan: WheelPlan, suspension: &Suspension, front: bool, tyre: Tyre, preload_n: f64) -> Self {
        let springs = [suspension.rear_stiffness_n_per_m, suspension.front_stiffness_n_per_m];
        Self {
            plan,
            feelers: &DISC,
            tyre,
            spring_n_per_m: springs[usize::from(front)],
            damper_n_s_per_m: suspension.damping_n_s_per_m,
            stop_n_per_m: suspension.stop_stiffness_n_per_m,
            preload_n,
            travel_m: 0.0,
            rising_m_per_s: 0.0,
            spin_rad_per_s: 0.0,
            tread_m: [0.0; 2],
            load_n: preload_n,
        }
    }

    /// The same for ground that has no edges: it is felt under the hub alone.
    #[must_use]
    pub fn on_a_plane(self) -> Self {
        Self { feelers: &HUB, ..self }
    }

    /// How far the suspension is compressed from where it rests.
    #[must_use]
    pub fn travel_m(&self) -> f64 {
        self.travel_m
    }

    /// How fast the wheel turns, forward positive.
    #[must_use]
    pub fn spin_rad_per_s(&self) -> f64 {
        self.spin_rad_per_s
    }

    /// Force of the road along the wheel's radius.
    #[must_use]
    pub fn load_n(&self) -> f64 {
        self.load_n
    }

    /// One step: adds to `push` what the body gets of it. `down` feels for the ground.
    pub fn step(&mut self, motion: &Motion, inputs: &Inputs, down: &Feeler, dt_s: f64, push: &mut Push) {
        let up = motion.rotation * Vector3::z();
        let hub_m = motion.origin_m + motion.rotation * (self.plan.hub_m + Vector3::z() * self.travel_m);
        let (sin, cos) = asami_math::elementary::sin_cos(inputs.steer_rad);
        let ahead = motion.rotation * Vector3::new(cos, sin, 0.0);

        let contact = self.contact(hub_m, ahead, up, down);
        self.load_n = 0.0;
        if let Some(Contact { at_m, normal, depth_m }) = contact {
            let spring_n = self.tyre.radial_stiffness_n_per_m * depth_m;
            self.load_n = (spring_n - self.tyre.radial_damping_n_s_per_m * self.rising_m_per_s).max(0.0);
            // Along the suspension the load goes through the spring; across it, straight into the body.
            let across_n = (normal - up * normal.dot(&up)) * self.load_n;
            push.add(motion, across_n, hub_m);
            let rolling_m = self.plan.radius_m - depth_m;
            let grip = self.grip(motion, inputs, at_m, normal, rolling_m, dt_s);
            push.add(motion, grip.force_n, at_m);
            self.spin(inputs, grip.along_n, rolling_m, dt_s);
        } else {
            self.tread_m = [0.0; 2];
            self.spin(inputs, 0.0, self.plan.radius_m, dt_s);
        }

        let rising = motion.velocity_at(hub_m).dot(&up);
        let strut_n = self.strut_n(self.rising_m_per_s - rising) + inputs.anti_roll_n;
        push.add(motion, up * strut_n, hub_m);
        // The wheels' weight is part of the body's, so that the load at rest is all of it; their inertia is their own.
        let lift_n = contact.map_or(0.0, |it| self.load_n * it.normal.dot(&up));
        self.rising_m_per_s += (lift_n - strut_n) * dt_s / self.plan.mass_kg;
        self.travel_m += (self.rising_m_per_s - rising) * dt_s;
    }

    /// Spring, damper and stops, on the body upward.
    fn strut_n(&self, compressing_m_per_s: f64) -> f64 {
        let [low_m, high_m] = self.plan.travel_m;
        let beyond_m = (self.travel_m - high_m).max(0.0) + (self.travel_m - low_m).min(0.0);
        self.preload_n
            + self.spring_n_per_m * self.travel_m
            + self.stop_n_per_m * beyond_m
            + self.damper_n_s_per_m * compressing_m_per_s
    }

    /// Where the ground reaches deepest into the disc: the plane under the hub, or an edge before or behind it.
    fn contact(&self, hub_m: Vector3<f64>, ahead: Vector3<f64>, up: Vector3<f64>, down: &Feeler) -> Option<Contact> {
        let radius_m = self.plan.radius_m;
        let feel = |share: f64| {
            let before_m = share * radius_m;
            let from_m = hub_m + ahead * before_m + up * ABOVE_M;
            let (below_m, facing) = down(from_m, -up, ABOVE_M + radius_m)?;
            let arm = ahead * before_m - up * (below_m - ABOVE_M);
            // An edge pushes towards the hub, a plane along its normal.
            let normal = if share == 0.0 && facing.dot(&up) > STEEPEST { facing } else { -arm.normalize() };
            let depth_m = radius_m + arm.dot(&normal);
            let at_m = hub_m - normal * (radius_m - depth_m);
            (depth_m > 0.0 && below_m > ABOVE_M).then_some(Contact { at_m, normal, depth_m })
        };
        self.feelers.iter().copied().filter_map(feel).max_by(|a, b| a.depth_m.total_cmp(&b.depth_m))
    }

    /// The tread's force. It bends with the slip, recovers as it rolls out of the contact, and slides beyond the
    /// friction's limit.
    fn grip(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        at_m: Vector3<f64>,
        normal: Vector3<f64>,
        rolling_m: f64,
        dt_s: f64,
    ) -> Grip {
        let (sin, cos) = asami_math::elementary::sin_cos(inputs.steer_rad);
        let axle = motion.rotation * Vector3::new(-sin, cos, 0.0);
        let along = axle.cross(&normal).normalize();
        let across = normal.cross(&along);
        let velocity = motion.velocity_at(at_m);
        let rolled_m_per_s = self.spin_rad_per_s * rolling_m;
        let slips_m_per_s = [velocity.dot(&along) - rolled_m_per_s, velocity.dot(&across)];
        let tyre = &self.tyre;
        let [along_ratio, across_ratio] = inputs.tread_ratio;
        let springs = [along_ratio * tyre.along_stiffness_n_per_m, across_ratio * tyre.across_stiffness_n_per_m];
        let relaxations_m = [tyre.along_relaxation_m, tyre.across_relaxation_m];
        let mut forces_n = [0.0; 2];
        for axis in 0..2 {
            // du/dt = -v_slip - |v_rolled| u / sigma, implicit in u
            let bent_m = (self.tread_m[axis] - slips_m_per_s[axis] * dt_s)
                / (1.0 + rolled_m_per_s.abs() * dt_s / relaxations_m[axis]);
            forces_n[axis] =
                springs[axis] * bent_m + tyre.tread_damping_n_s_per_m * (bent_m - self.tread_m[axis]) / dt_s;
            self.tread_m[axis] = bent_m;
        }
        let wanted_n = (forces_n[0] * forces_n[0] + forces_n[1] * forces_n[1]).sqrt();
        let limit_n = inputs.friction * self.load_n;
        if wanted_n > limit_n {
            let share = limit_n / wanted_n;
            forces_n = forces_n.map(|force| force * share);
            // As far as a sliding tread stays bent.
            self.tread_m = [0, 1].map(|axis| forces_n[axis] / springs[axis]);
        }
        Grip { force_n: along * forces_n[0] + across * forces_n[1], along_n: forces_n[0] }
    }

    /// Turns the wheel on; brake and rolling resistance stop it and hold it, and never turn it back.
    fn spin(&mut self, inputs: &Inputs, along_n: f64, rolling_m: f64, dt_s: f64) {
        let per_n_m = dt_s / self.plan.inertia_kg_m2;
        let free = self.spin_rad_per_s + per_n_m * (inputs.drive_n_m - rolling_m * along_n);
        let resistance = self.tyre.rolling_resistance + inputs.rolling_resistance;
        let held = per_n_m * (inputs.brake_n_m + resistance * self.load_n * rolling_m);
        self.spin_rad_per_s = free - free.clamp(-held, held);
    }
}

/// Where and how deep the ground touches.
#[derive(Clone, Copy)]
struct Contact {
    at_m: Vector3<f64>,
    /// Towards the hub.
    normal: Vector3<f64>,
    depth_m: f64,
}

struct Grip {
    force_n: Vector3<f64>,
    along_n: f64,
}
