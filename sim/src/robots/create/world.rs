//! The robot in an arena: the loop from command to wheels, and from poses to frames.

use asami_dataset::log::RangeBearing;
use asami_dataset::{Action, Beacon, Frame, Known, Rng, Seed, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::atan2;
use nalgebra::Vector3;
use rand_distr::{Distribution, StandardNormal};

use super::BuildError;
use super::blueprint::Blueprint;
use super::body::Body;
use super::config::CreateConfig;
use super::sight::Lasting;
use crate::effect::{CommandStage, Glance, SightingStage, Stage};
use crate::effects::Effects;
use crate::effects::slight_turns::is_slight;
use crate::knobs::{EyeKnobs, GroundKnobs, Knobs};
use crate::robots::actuator::{Actuator, Late};
use crate::robots::past::Past;
use crate::scenes::field::Field;
use crate::world::{Record, World};

/// The Create in its world.
pub struct CreateWorld {
    config: CreateConfig,
    effects: Effects,
    nominal: Knobs,
    /// Where the robot thinks that the landmarks stand.
    beacons: Vec<Beacon>,
    /// Where they stand.
    standing: Vec<Beacon>,
    ids: Vec<u16>,
    eye: EyeKnobs,

    command_stages: Vec<CommandStage>,
    sighting_stages: Vec<SightingStage>,
    wheel_rng: Rng,
    sight_rng: Rng,
    lasting: Lasting,

    /// Wanted speeds of the two tyres.
    servos: [Actuator; 2],
    blueprint: Blueprint,
    body: Body,
    past: Past,
    ticks: u64,
}

impl CreateWorld {
    /// The robot, standing at `start` for as long as the configuration lets it settle.
    ///
    /// # Errors
    /// If the URDF lacks a part or the engine refuses it.
    pub fn new(
        config: &CreateConfig,
        field: &Field,
        effects: &Effects,
        start: TruePose,
        seed: Seed,
    ) -> Result<Self, BuildError> {
        let nominal = Knobs {
            ground: GroundKnobs { friction: config.physics.friction, ..GroundKnobs::default() },
            ..Knobs::default()
        };
        let mut knobs = nominal.clone();
        effects.iter().for_each(|effect| effect.tune(0.0, &mut knobs));
        let blueprint = Blueprint::shipped()?;
        let turned_rad = std::f64::consts::FRAC_PI_2 + start.theta_rad;
        let mut body = Body::new(config, &blueprint, [start.x_m, start.y_m], turned_rad, &knobs)?;
        body.incline(knobs.ground.slope);
        body.set_friction(knobs.ground.friction);
        let dt_s = config.physics.time_step_s;
        for _ in 0..(config.physics.settle_s / dt_s).round() as u64 {
            body.step([0.0; 2]);
        }
        let wheels = &config.wheels;
        let servo = Actuator::new(0.0, wheels.lag_s, wheels.most_m_per_s2, dt_s);
        // Heights are of no use to it.
        let known = |field: &Field| field.known().into_iter().map(|it| Beacon { height_m: None, ..it }).collect();
        let beacons: Vec<Beacon> = known(field);
        let tick_s = dt_s * f64::from(config.physics.steps_per_tick);
        let frame_s = tick_s * f64::from(config.sight.ticks_per_frame);
        let lasting = Lasting::new(beacons.len(), frame_s, &config.sight, seed.stream("create/lasting"));
        let mut world = Self {
            standing: known(&field.with_moved(knobs.scene.moved)),
            ids: beacons.iter().map(|beacon| beacon.id).collect(),
            beacons,
            eye: knobs.eye,
            command_stages: Vec::new(),
            sighting_stages: Vec::new(),
            wheel_rng: seed.stream("create/wheels"),
            sight_rng: seed.stream("create/sight"),
            lasting,
            servos: [servo.clone(), servo],
            blueprint,
            body,
            past: Past::default(),
            ticks: 0,
            nominal,
            config: config.clone(),
            effects: effects.clone(),
        };
        for effect in effects.iter() {
            match effect.stage(seed.stream(&format!("effect/{}", effect.about().name))) {
                Some(Stage::Command(stage)) => world.command_stages.push(stage),
                Some(Stage::Sighting(stage)) => world.sighting_stages.push(stage),
                // Neither joints to pose nor lasers.
                Some(Stage::Joint(_) | Stage::Lasers(_)) | None => {}
            }
        }
        Ok(world)
    }

    /// The body in the engine.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    fn tick_s(&self) -> f64 {
        self.config.physics.time_step_s * f64::from(self.config.physics.steps_per_tick)
    }

    fn now_s(&self) -> f64 {
        self.ticks as f64 * self.tick_s()
    }

    /// The knobs as the effects turn them.
    fn knobs(&self, t_s: f64) -> Knobs {
        let mut knobs = self.nominal.clone();
        self.effects.iter().for_each(|effect| effect.tune(t_s, &mut knobs));
        knobs
    }

    /// Speeds of the two tyres, left and right, that the robot's computer wants for a command: of wheels of their nominal
    /// size and place.
    fn wanted_m_per_s(&self, action: Action, knobs: &Knobs) -> [f64; 2] {
        let Action::Wheels { v_m_per_s, omega_rad_per_s, .. } = action else { return [0.0; 2] };
        let [_, of_speed, of_turning] = knobs.command.scale;
        let aside = 0.5 * self.blueprint.base_m() * omega_rad_per_s * of_turning;
        let of_speed = of_speed * if is_slight(omega_rad_per_s) { 1.0 + knobs.wheels.slight_gain } else { 1.0 };
        let of_speed = of_speed * (1.0 - knobs.wheels.turn_loss_s2 * omega_rad_per_s * omega_rad_per_s).max(0.0);
        let most_m_per_s = self.config.wheels.most_m_per_s * knobs.motors.speed_ratio;
        let step_m_per_s = knobs.wheels.step_m_per_s;
        let made =
            |wanted: f64| if step_m_per_s > 0.0 { (wanted / step_m_per_s).round() * step_m_per_s } else { wanted };
        [-1.0, 1.0].map(|side| made((v_m_per_s * of_speed + side * aside).clamp(-most_m_per_s, most_m_per_s)))
    }

    /// Takes a frame.
    fn look(&mut self, record: &mut Record) {
        let (pose, eye) = (self.pose(), &self.eye);
        let seen_from = self.past.at(eye.taken_s(pose.t_s)).unwrap_or(pose);
        let sight = &self.config.sight;
        self.lasting.go_on();
        let mut sightings = sight.look(pose.t_s, &seen_from, &self.standing, eye, &self.lasting, &mut self.sight_rng);
        let frame = Frame { t_s: pose.t_s, head_pan_rad: 0.0 };
        let sizes = [sight.near_m, sight.far_m].map(Size::RangeM);
        for stage in &mut self.sighting_stages {
            stage(&Glance { frame, landmarks: &self.ids, view_rad: sight.view_rad, sizes }, &mut sightings);
        }
        record.seen.frames.push(frame);
        record.seen.sightings.append(&mut sightings);
    }

    /// Takes note of where the robot is, and looks when it is time.
    fn note(&mut self, record: &mut Record) {
        let pose = self.pose();
        self.past.note(pose, self.eye.taken_s(pose.t_s));
        record.track.push(pose);
        if self.ticks.is_multiple_of(u64::from(self.config.sight.ticks_per_frame)) {
            self.look(record);
        }
    }
}

impl World for CreateWorld {
    fn known(&self) -> Known {
        let sight = &self.config.sight;
        Known {
            robot: "create".to_owned(),
            command_rate_hz: Some(1.0 / self.tick_s()),
            range_bearing: Some(RangeBearing { max_range_m: sight.far_m, sensor_origin_m: [0.0, sight.ahead_m] }),
            landmarks: self.beacons.clone(),
            ..Known::default()
        }
    }

    fn t_s(&self) -> f64 {
        self.now_s()
    }

    fn pose(&self) -> TruePose {
        let pose = self.body.world_from_body();
        let ahead = pose.rotation * Vector3::x();
        let at = pose.translation;
        let theta_rad = wrap_rad(atan2(-ahead.x, ahead.y));
        TruePose { t_s: self.now_s(), x_m: at.x, y_m: at.y, theta_rad, v_m_per_s: None }
    }

    fn tick(&mut self, action: Action, record: &mut Record) {
        let t_s = self.now_s();
        if self.ticks == 0 {
            self.note(record);
        }
        let action = self.command_stages.iter_mut().fold(action, |action, stage| stage(t_s, action));
        let knobs = self.knobs(t_s);
        let wanted = self.wanted_m_per_s(action, &knobs);
        let jitter: [f64; 2] = std::array::from_fn(|_| {
            let normal: f64 = StandardNormal.sample(&mut self.wheel_rng);
            self.config.wheels.jitter_m_per_s * normal
        });
        let late = Late { delay_s: 0.0, lag_s: knobs.wheels.lag_s };
        for _ in 0..self.config.physics.steps_per_tick {
            let spins = std::array::from_fn(|i| {
                let speed_m_per_s = self.servos[i].step(wanted[i], late);
                // A robot that stands has its gears at rest.
                let jitter = if speed_m_per_s.abs() > 1e-4 { jitter[i] } else { 0.0 };
                (speed_m_per_s + jitter) / self.blueprint.wheels[i].radius_m
            });
            self.body.step(spins);
        }
        self.ticks += 1;
        self.note(record);
    }
}

#[cfg(test)]
mod tests;
