//! The Aibo on a field: the loop from command to motors, and from poses to frames.

use asami_dataset::{Action, Beacon, Camera, Known, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::atan2;
use nalgebra::Vector3;

use super::blueprint::{Blueprint, JOINTS};
use super::config::AiboConfig;
use super::engine::Engine;
use super::eye::Eye;
use super::gait::{Attempt, Trot};
use super::grip::Grip;
use super::heading::Heading;
use super::posture::{Start, joints_rad};
use super::servo::SetPoints;
use super::watch::{Contacts, Watch, outline};
use super::{BuildError, By};
use crate::effect::{CommandStage, JointStage, SightingStage, Stage};
use crate::effects::Effects;
use crate::knobs::{GroundKnobs, Knobs};
use crate::scenes::field::Field;
use crate::sensors::camera::CameraConfig;
use crate::sensors::image::Image;
use crate::world::{Record, World};

/// Index of the head's pan among the joints.
const PAN: usize = 13;

/// The Aibo in its world.
pub struct AiboWorld {
    config: AiboConfig,
    effects: Effects,
    nominal: Knobs,
    known: Known,

    command_stages: Vec<CommandStage>,
    joint_stages: Vec<JointStage>,
    sighting_stages: Vec<SightingStage>,
    heading: Heading,
    trot: Trot,
    set_points: SetPoints,
    grip: Grip,

    blueprint: Blueprint,
    body: Box<dyn Engine>,
    eye: Eye,
    steps: u64,
    fallen: bool,
    watch: Option<Watch>,
}

impl AiboWorld {
    /// The robot, standing at `start` for as long as the configuration lets it settle.
    ///
    /// # Errors
    /// If the URDF lacks a part or the engine refuses it.
    pub fn new(
        config: &AiboConfig,
        field: &Field,
        camera: &CameraConfig,
        effects: &Effects,
        start: Start,
        seed: Seed,
    ) -> Result<Self, BuildError> {
        Self::in_engine(By::Rapier, config, field, camera, effects, start, seed)
    }

    /// The same in any engine.
    ///
    /// # Errors
    /// If the URDF lacks a part, or the engine refuses it or does not start.
    pub fn in_engine(
        by: By<'_>,
        config: &AiboConfig,
        field: &Field,
        camera: &CameraConfig,
        effects: &Effects,
        start: Start,
        seed: Seed,
    ) -> Result<Self, BuildError> {
        let blueprint = Blueprint::shipped()?;
        let trot = Trot::new(config.gait.clone(), blueprint.legs.clone(), start.gait_phase);
        let angles_rad = joints_rad(&config.head, &trot, 0.0);
        let world_from_torso = start.world_from_torso(&config.gait, &blueprint, trot.pitch_rad());
        let nominal = Knobs {
            ground: GroundKnobs { friction: config.physics.friction, ..GroundKnobs::default() },
            ..Knobs::default()
        };
        let knobs = turned(&nominal, effects, 0.0);
        let mut body = by.body(config, &blueprint, &world_from_torso, &angles_rad)?;
        body.load(&knobs.body);
        body.incline(knobs.ground.slope);
        for _ in 0..(config.physics.settle_s / config.physics.time_step_s).round() as u64 {
            body.step();
        }

        let speed_limits = blueprint.joints.map(|joint| joint.speed_rad_per_s);
        let mut world = Self {
            set_points: SetPoints::new(
                &config.servo,
                config.physics.tick_s(),
                angles_rad.to_vec(),
                speed_limits.into_iter(),
                seed.stream("aibo/set_points"),
            ),
            grip: Grip::new(config.disturbance.clone(), seed.stream("aibo/grip")),
            heading: Heading::new(config.heading_hold.clone(), field.beacons.first().map(|beacon| beacon.id)),
            nominal,
            eye: Eye::new(
                camera,
                &config.head,
                &blueprint,
                &field.with_moved(knobs.scene.moved),
                &knobs.eye,
                config.physics.time_step_s,
                seed,
            ),
            known: known(config, camera, field),
            config: config.clone(),
            effects: effects.clone(),
            command_stages: Vec::new(),
            joint_stages: Vec::new(),
            sighting_stages: Vec::new(),
            trot,
            blueprint,
            body,
            steps: 0,
            fallen: false,
            watch: None,
        };
        for effect in effects.iter() {
            match effect.stage(seed.stream(&format!("effect/{}", effect.about().name))) {
                Some(Stage::Command(stage)) => world.command_stages.push(stage),
                Some(Stage::Joint(stage)) => world.joint_stages.push(stage),
                Some(Stage::Sighting(stage)) => world.sighting_stages.push(stage),
                Some(Stage::Lasers(_)) | None => {}
            }
        }
        Ok(world)
    }

    /// Begins to record foot contacts and outlines.
    pub fn watch(&mut self) {
        self.watch.get_or_insert_default();
    }

    /// What was recorded since [`watch`](Self::watch).
    #[must_use]
    pub fn watched(&self) -> Option<&Watch> {
        self.watch.as_ref()
    }

    /// The latest camera frame; black before the first. To be looked at: learners get sightings only.
    #[must_use]
    pub fn image(&self) -> &Image {
        self.eye.image()
    }

    /// Whether the torso has ever tilted by more than 60 degrees.
    #[must_use]
    pub fn has_fallen(&self) -> bool {
        self.fallen
    }

    /// The body in the engine.
    #[must_use]
    pub fn body(&self) -> &dyn Engine {
        &*self.body
    }

    fn now_s(&self) -> f64 {
        self.steps as f64 * self.config.physics.time_step_s
    }

    /// What the gait attempts: the command after its stages, scaled, and turned towards the beacon.
    fn attempt(&mut self, t_s: f64, action: Action, knobs: &Knobs) -> Attempt {
        let action = self.command_stages.iter_mut().fold(action, |action, stage| stage(t_s, action));
        let Action::Legs { ax_m_per_s, ay_m_per_s, atheta_rad_per_s, .. } = action else { return [0.0; 3] };
        let mut attempt = [ax_m_per_s, ay_m_per_s, atheta_rad_per_s];
        for (velocity, scale) in attempt.iter_mut().zip(knobs.command.scale) {
            *velocity *= scale;
        }
        attempt[2] += self.heading.turn_rad_per_s(t_s, &attempt);
        attempt
    }

    /// Moves the servos towards what the gait wants.
    fn drive(&mut self, t_s: f64, attempt: Attempt, speed_ratio: f64) {
        self.trot.step(self.config.physics.tick_s(), attempt);
        let wanted_rad = joints_rad(&self.config.head, &self.trot, t_s);
        let mut aimed_rad = [0.0; JOINTS];
        aimed_rad.copy_from_slice(self.set_points.approach(&wanted_rad, speed_ratio));
        for stage in &mut self.joint_stages {
            stage(t_s, &mut aimed_rad);
        }
        self.body.aim(&aimed_rad);
    }

    /// Follows the head, and takes a frame if one is due.
    fn look(&mut self, record: &mut Record) {
        let now_s = self.now_s();
        self.eye.follow(&self.body.world_from_head(), self.body.angle_rad(PAN));
        if !self.eye.is_due(now_s) {
            return;
        }
        let (frame, mut sightings) = self.eye.look(now_s);
        for stage in &mut self.sighting_stages {
            stage(&self.eye.glance(frame), &mut sightings);
        }
        self.heading.look(&sightings);
        record.seen.frames.push(frame);
        record.seen.sightings.append(&mut sightings);
        record.track.push(self.pose());
        if let Some(watch) = &mut self.watch {
            watch.outlines.push(outline(now_s, &*self.body, &self.blueprint));
        }
    }
}

impl World for AiboWorld {
    fn known(&self) -> Known {
        self.known.clone()
    }

    fn t_s(&self) -> f64 {
        self.now_s()
    }

    fn broken(&self) -> Option<String> {
        self.body.broken()
    }

    /// Where the body's centre is and where it faces.
    fn pose(&self) -> TruePose {
        let world_from_torso = self.body.world_from_torso();
        let ahead = world_from_torso * Vector3::x();
        let at = world_from_torso.translation;
        let theta_rad = wrap_rad(atan2(-ahead.x, ahead.y));
        TruePose { t_s: self.now_s(), x_m: at.x, y_m: at.y, theta_rad, v_m_per_s: None }
    }

    fn tick(&mut self, action: Action, record: &mut Record) {
        let t_s = self.now_s();
        let knobs = turned(&self.nominal, &self.effects, t_s);
        let friction = knobs.ground.friction;
        self.body.set_friction(self.grip.factors(t_s).map(|factor| factor * friction), friction);
        self.body.set_torque(knobs.motors.torque_ratio);

        if self.steps == 0 {
            self.eye.follow(&self.body.world_from_head(), self.body.angle_rad(PAN));
            record.track.push(self.pose());
        }
        let attempt = self.attempt(t_s, action, &knobs);
        self.drive(t_s, attempt, knobs.motors.speed_ratio);
        for _ in 0..self.config.physics.steps_per_tick {
            self.body.step();
            self.steps += 1;
            self.look(record);
        }

        let up = self.body.world_from_torso() * Vector3::z();
        self.fallen |= up.z.is_nan() || up.z < 0.5;
        if let Some(watch) = &mut self.watch {
            watch.contacts.push(Contacts {
                t_s: self.steps as f64 * self.config.physics.time_step_s,
                down: self.body.feet_down(),
            });
        }
    }
}

/// The knobs as the effects turn them.
fn turned(nominal: &Knobs, effects: &Effects, t_s: f64) -> Knobs {
    let mut knobs = nominal.clone();
    for effect in effects.iter() {
        effect.tune(t_s, &mut knobs);
    }
    knobs
}

fn known(config: &AiboConfig, camera: &CameraConfig, field: &Field) -> Known {
    Known {
        robot: "aibo".to_owned(),
        command_rate_hz: Some(1.0 / config.physics.tick_s()),
        camera: Some(Camera {
            width_px: camera.width_px,
            height_px: camera.height_px,
            focal_px: camera.focal_px,
            frame_rate_hz: camera.frame_rate_hz,
        }),
        landmarks: field
            .beacons
            .iter()
            .map(|beacon| Beacon {
                id: beacon.id,
                x_m: beacon.body.x_m,
                y_m: beacon.body.y_m,
                height_m: Some(beacon.body.height_m),
            })
            .collect(),
        ..Known::default()
    }
}

#[cfg(test)]
mod tests;
