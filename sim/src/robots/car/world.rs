//! The car in its surroundings: the loop from pedals to wheels, and the Velodyne's way.

use asami_dataset::log::Velodyne;
use asami_dataset::{Action, Known, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::atan2;
use nalgebra::Vector3;

use super::BuildError;
use super::blueprint::Blueprint;
use super::body::{Body, Controls, Setting};
use super::brakes::Brakes;
use super::config::CarConfig;
use super::drivetrain::{Drivetrain, Gear};
use crate::effect::{CommandStage, Stage};
use crate::effects::Effects;
use crate::knobs::{GroundKnobs, Knobs, VehicleKnobs};
use crate::robots::actuator::{Actuator, Late};
use crate::robots::frames::yawed;
use crate::scenes::solid::Ground;
use crate::scenes::town::Waypoint;
use crate::sensors::velodyne::SensorPose;
use crate::world::{Record, World};

/// What is done while nobody commands pedals.
const HOLDING: Action = Action::Pedals { throttle: 0.0, brake: 0.5, steering: 0.0 };

/// Where the car stands at first: the place of its Velodyne, and its heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// World x.
    pub x_m: f64,
    /// World y.
    pub y_m: f64,
    /// 0 facing world +y, counter-clockwise.
    pub theta_rad: f64,
}

impl From<Waypoint> for Start {
    fn from(at: Waypoint) -> Self {
        Self { x_m: at.x_m, y_m: at.y_m, theta_rad: at.theta_rad }
    }
}

/// The car in its world.
pub struct CarWorld {
    config: CarConfig,
    effects: Effects,
    nominal: Knobs,
    velodyne: Option<Velodyne>,

    command_stages: Vec<CommandStage>,
    throttle: Actuator,
    brake: Actuator,
    steering: Actuator,
    brakes: Brakes,
    drivetrain: Drivetrain,
    told: Vec<Gear>,
    gears: Vec<Gear>,
    body: Body,
    steering_rad: f64,
    radius_m: f64,
    steps: u64,
}

impl CarWorld {
    /// The car, standing on its brake at `start` for as long as the configuration lets it settle. `velodyne` is what the
    /// robot knows of its laser scanner.
    ///
    /// # Errors
    /// If the URDF lacks a part, or there is no ground at the start.
    pub fn new(
        config: &CarConfig,
        ground: &Ground,
        velodyne: Option<Velodyne>,
        effects: &Effects,
        start: Start,
        seed: Seed,
    ) -> Result<Self, BuildError> {
        let blueprint = Blueprint::shipped(config.body)?;
        let (steering_rad, radius_m) = (blueprint.steering_rad, blueprint.wheels[0].radius_m);
        let turned = std::f64::consts::FRAC_PI_2 + start.theta_rad;
        let facing = yawed(turned);
        let dt_s = config.physics.time_step_s;
        let fast = blueprint.steering_rad_per_s / steering_rad;
        let actuator = |delay_s, lag_s, most_per_s| Actuator::new(delay_s, lag_s, most_per_s, dt_s);
        let mut world = Self {
            throttle: actuator(config.engine.throttle_delay_s, config.engine.throttle_lag_s, f64::INFINITY),
            brake: actuator(config.brake.delay_s, config.brake.lag_s, f64::INFINITY),
            steering: actuator(config.steering.delay_s, config.steering.lag_s, fast),
            brakes: Brakes::default(),
            drivetrain: Drivetrain::new(config.engine.clone()),
            told: Vec::new(),
            gears: Vec::new(),
            body: Body::new(config, blueprint, ground, [start.x_m, start.y_m], facing)?,
            nominal: Knobs {
                ground: GroundKnobs { friction: config.physics.friction, ..GroundKnobs::default() },
                ..Knobs::default()
            },
            config: config.clone(),
            effects: effects.clone(),
            velodyne,
            command_stages: Vec::new(),
            steering_rad,
            radius_m,
            steps: 0,
        };
        for effect in effects.iter() {
            match effect.stage(seed.stream(&format!("effect/{}", effect.about().name))) {
                Some(Stage::Command(stage)) => world.command_stages.push(stage),
                // No joints, no landmarks; its scanner sees to its lasers itself.
                Some(Stage::Joint(_) | Stage::Sighting(_) | Stage::Lasers(_)) | None => {}
            }
        }
        let knobs = world.knobs(0.0);
        world.set(&knobs);
        for _ in 0..(config.physics.settle_s / dt_s).round() as u64 {
            world.step(HOLDING, &knobs);
        }
        Ok(world)
    }

    /// The body in the engine.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The Velodyne's pose; its axes are the robot's.
    #[must_use]
    pub fn sensor_pose(&self) -> SensorPose {
        let (pose, _) = self.body.velodyne();
        // From x right, y forward to x forward, y left.
        let body_from_robot = yawed(-std::f64::consts::FRAC_PI_2);
        SensorPose {
            t_s: self.now_s(),
            position_m: pose.translation.vector.into(),
            world_from_sensor: pose.rotation * body_from_robot,
        }
    }

    /// Leans all ground from the next control period on: the sine of its slope times the unit vector uphill, before any
    /// effect.
    pub fn lean(&mut self, slope: [f64; 2]) {
        self.nominal.ground.slope = slope;
    }

    /// Lets the gearbox change, from the next step on, as if the wheels were so much faster.
    pub fn shift_as_if(&mut self, faster_m_per_s: f64) {
        self.drivetrain.faster_m_per_s = faster_m_per_s;
    }

    /// Has the gearbox in these gears, by step of the engine from the start, whatever the speed; in the last of them after that.
    pub fn gear_as(&mut self, told: Vec<Gear>) {
        self.told = told;
    }

    /// What the gearbox was in, or changing to, by step of the engine.
    #[must_use]
    pub fn gears(&self) -> &[Gear] {
        &self.gears
    }

    fn now_s(&self) -> f64 {
        self.steps as f64 * self.config.physics.time_step_s
    }

    /// The knobs as the effects turn them.
    fn knobs(&self, t_s: f64) -> Knobs {
        let mut knobs = self.nominal.clone();
        for effect in self.effects.iter() {
            effect.tune(t_s, &mut knobs);
        }
        knobs
    }

    /// One step of the engine. The pedals are moved by motors, which take their time.
    fn step(&mut self, action: Action, knobs: &Knobs) {
        let Action::Pedals { throttle, brake, steering } = (match action {
            Action::Pedals { .. } => action,
            Action::Legs { .. } | Action::Wheels { .. } => HOLDING,
        }) else {
            return;
        };
        let vehicle = &knobs.vehicle;
        let late = Late { delay_s: vehicle.throttle_delay_s, lag_s: 0.0 };
        let pressed = self.throttle.step(throttle.clamp(0.0, 1.0), late);
        let throttle = ((pressed - vehicle.throttle_play) / (1.0 - vehicle.throttle_play)).max(0.0);
        let faded = vehicle.brake_ratio * self.brakes.left(vehicle.brake_fade_per_mj);
        let brake = self.brake.step(brake.clamp(0.0, 1.0), Late::default()) * faded;
        let late = Late { delay_s: 0.0, lag_s: vehicle.steering_lag_s };
        let steering = self.steering.step(steering.clamp(-1.0, 1.0), late) * vehicle.steering_ratio;

        let (engine, brakes) = (&self.config.engine, &self.config.brake);
        let spins = self.body.wheels().each_ref().map(|wheel| wheel.spin_rad_per_s());
        let (front, rear) = (0.5 * (spins[0] + spins[1]), 0.5 * (spins[2] + spins[3]));
        let mean = engine.front_share * front + (1.0 - engine.front_share) * rear;
        let dt_s = self.config.physics.time_step_s;
        let drive_n_m = self.drivetrain.step(throttle, mean, self.radius_m, vehicle.engine_ratio, dt_s);
        let split = |total: f64, front: f64| [front, front, 1.0 - front, 1.0 - front].map(|share| 0.5 * share * total);
        let brake_n_m = split(brake * brakes.full_torque_n_m, brakes.front_share);
        self.brakes.work(&brake_n_m, &spins, dt_s);
        self.body.step(&Controls {
            steer_rad: steering * self.steering_rad + vehicle.steering_offset_rad,
            drive_n_m: split(drive_n_m, engine.front_share),
            brake_n_m,
            friction: knobs.ground.friction,
            tread_ratio: vehicle.tread_ratio,
            rolling_resistance: vehicle.rolling_resistance,
            drag_n_s_per_m: vehicle.drag_n_s_per_m,
            drag_n_s2_per_m2: vehicle.drag_n_s2_per_m2,
        });
    }

    fn set(&mut self, knobs: &Knobs) {
        let VehicleKnobs { mass_ratio, luggage_kg, .. } = knobs.vehicle;
        self.body.set(Setting { mass_ratio, luggage_kg, slope: knobs.ground.slope });
    }
}

impl World for CarWorld {
    fn known(&self) -> Known {
        let physics = &self.config.physics;
        Known {
            robot: "car".to_owned(),
            command_rate_hz: Some(1.0 / (physics.time_step_s * f64::from(physics.steps_per_tick))),
            velodyne: self.velodyne.clone(),
            ..Known::default()
        }
    }

    fn t_s(&self) -> f64 {
        self.now_s()
    }

    /// Where the Velodyne's centre is, where the car faces, and how fast that centre moves that way.
    fn pose(&self) -> TruePose {
        let (pose, velocity) = self.body.velodyne();
        let ahead = pose.rotation * Vector3::x();
        let level = Vector3::new(ahead.x, ahead.y, 0.0).normalize();
        let at = pose.translation;
        let theta_rad = wrap_rad(atan2(-level.x, level.y));
        TruePose { t_s: self.now_s(), x_m: at.x, y_m: at.y, theta_rad, v_m_per_s: Some(velocity.dot(&level)) }
    }

    fn tick(&mut self, action: Action, record: &mut Record) {
        let t_s = self.now_s();
        let knobs = self.knobs(t_s);
        self.set(&knobs);
        if self.steps == 0 {
            record.sensor_poses.push(self.sensor_pose());
            record.track.push(self.pose());
        }
        for _ in 0..self.config.physics.steps_per_tick {
            let t_s = self.now_s();
            let action = self.command_stages.iter_mut().fold(action, |action, stage| stage(t_s, action));
            self.drivetrain.told = self.told.get(self.gears.len()).or(self.told.last()).copied();
            self.step(action, &knobs);
            self.gears.push(self.drivetrain.gear());
            self.steps += 1;
            record.sensor_poses.push(self.sensor_pose());
            if self.steps.is_multiple_of(u64::from(self.config.physics.steps_per_pose)) {
                record.track.push(self.pose());
            }
        }
    }
}

#[cfg(test)]
mod tests;
