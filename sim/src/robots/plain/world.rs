//! The plain robot on a field: the loop from command to pose, and from poses to frames.

use asami_dataset::survey::{self, Height, Survey};
use asami_dataset::{Action, Beacon, Frame, Known, Rng, Seed, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{hypot, sin_cos};
use rand_distr::{Distribution, StandardNormal};

use super::config::PlainConfig;
use super::velocities::{Velocities, Velocity};
use crate::drives::suite::Suite;
use crate::effect::{CommandStage, Glance, SightingStage, Stage};
use crate::effects::Effects;
use crate::knobs::{EyeKnobs, Knobs};
use crate::robots::past::Past;
use crate::scenes::field::Field;
use crate::survey::Surveying;
use crate::world::{Record, World};

/// Share of its speed, for each unit of the slope's sine, at which the robot slides downhill. The walking Aibo, tried in
/// Rapier on slopes of 1.4 and 5.7 degrees, has 0.8 along its stride and 3 across.
const SLIDE: f64 = 2.0;
/// A step is so many times as long as what tells when within it a command takes effect.
const MOMENTS: u32 = 50;

/// The plain robot in its world.
pub struct PlainWorld {
    config: PlainConfig,
    suite: Suite,
    effects: Effects,
    /// Where the robot thinks that the beacons stand.
    beacons: Vec<Beacon>,
    /// Where they stand.
    standing: Vec<Beacon>,
    ids: Vec<u16>,
    eye: EyeKnobs,
    velocities: Velocities,

    command_stages: Vec<CommandStage>,
    sighting_stages: Vec<SightingStage>,
    motion_rng: Rng,
    sight_rng: Rng,

    pose: TruePose,
    past: Past,
    steps: u64,
}

impl PlainWorld {
    /// The robot, standing at `start`. The velocities of the actions of `suite` are those of the
    /// configuration's robot; `seed` draws the noise only.
    #[must_use]
    pub fn new(
        config: &PlainConfig,
        suite: &Suite,
        field: &Field,
        effects: &Effects,
        start: TruePose,
        seed: Seed,
    ) -> Self {
        let beacons = field.known();
        let mut world = Self {
            config: config.clone(),
            suite: suite.clone(),
            effects: effects.clone(),
            standing: Vec::new(),
            ids: beacons.iter().map(|beacon| beacon.id).collect(),
            beacons,
            eye: EyeKnobs::default(),
            velocities: Velocities::new(&config.distortion, suite),
            command_stages: Vec::new(),
            sighting_stages: Vec::new(),
            motion_rng: seed.stream("plain/motion"),
            sight_rng: seed.stream("plain/sight"),
            pose: TruePose { t_s: 0.0, theta_rad: wrap_rad(start.theta_rad), ..start },
            past: Past::default(),
            steps: 0,
        };
        let knobs = world.knobs(0.0);
        world.standing = field.with_moved(knobs.scene.moved).known();
        world.eye = knobs.eye;
        for effect in effects.iter() {
            match effect.stage(seed.stream(&format!("effect/{}", effect.about().name))) {
                Some(Stage::Command(stage)) => world.command_stages.push(stage),
                Some(Stage::Sighting(stage)) => world.sighting_stages.push(stage),
                // No joints to act on: such effects do not fit this robot.
                Some(Stage::Joint(_) | Stage::Lasers(_)) | None => {}
            }
        }
        world
    }

    /// The truth about the models of this very world, effects at the log's beginning and all: exact, not
    /// measured. Of `how` only the distances count, and the readings that are said to be taken.
    #[must_use]
    pub fn survey(&self, how: &Surveying) -> Survey {
        let sight = &self.config.sight;
        let motion = &self.config.motion;
        let (knobs, eye) = (self.knobs(0.0), &self.eye);
        let velocity_by_action = (0..).zip(self.suite.actions()).map(|(action, attempted)| {
            let [vx_m_per_s, vy_m_per_s, vtheta_rad_per_s] = self.velocity(attempted, &knobs);
            survey::Velocity { action, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s }
        });
        let height_by_distance = how.distances_m().into_iter().map(|distance_m| Height {
            distance_m,
            height_px: sight.height_px(distance_m, eye),
            sd_px: sight.sigma1_px * eye.noise_ratio,
            bearing_sd_rad: sight.sigma2_rad * eye.noise_ratio,
            readings: how.readings,
        });
        Survey {
            velocity_by_action: velocity_by_action.collect(),
            height_by_distance: height_by_distance.collect(),
            sigma1_px: Some(sight.sigma1_px * eye.noise_ratio),
            sigma2_rad: Some(sight.sigma2_rad * eye.noise_ratio),
            motion_sd: Some([motion.right_sd_m, motion.forward_sd_m, motion.turn_sd_rad]),
            ..Survey::default()
        }
    }

    fn now_s(&self) -> f64 {
        self.steps as f64 * self.config.motion.time_step_s
    }

    /// The knobs as the effects turn them.
    fn knobs(&self, t_s: f64) -> Knobs {
        let mut knobs = Knobs::default();
        for effect in self.effects.iter() {
            effect.tune(t_s, &mut knobs);
        }
        knobs
    }

    /// What an action leads to.
    fn velocity(&self, action: Action, knobs: &Knobs) -> Velocity {
        let Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s } = action else { return [0.0; 3] };
        let mut attempt = [ax_m_per_s, ay_m_per_s, atheta_rad_per_s];
        for (velocity, scale) in attempt.iter_mut().zip(knobs.command.scale) {
            *velocity *= scale;
        }
        self.velocities.of(id, attempt, &knobs.motors)
    }

    /// The mean velocity over the step that begins at `t_s`, in which what reaches the robot may change.
    fn mean_velocity(&mut self, t_s: f64, action: Action, knobs: &Knobs) -> Velocity {
        if self.command_stages.is_empty() {
            return self.velocity(action, knobs);
        }
        let mut in_force: Vec<(Action, u32)> = Vec::with_capacity(2);
        for moment in 0..MOMENTS {
            let at_s = t_s + self.config.motion.time_step_s * f64::from(moment) / f64::from(MOMENTS);
            let action = self.command_stages.iter_mut().fold(action, |action, stage| stage(at_s, action));
            match in_force.last_mut() {
                Some((last, moments)) if *last == action => *moments += 1,
                _ => in_force.push((action, 1)),
            }
        }
        in_force.into_iter().fold([0.0; 3], |mean, (action, moments)| {
            let velocity = self.velocity(action, knobs);
            let share = f64::from(moments) / f64::from(MOMENTS);
            std::array::from_fn(|i| mean[i] + share * velocity[i])
        })
    }

    /// A velocity on a slope: with every step the robot slides downhill.
    fn on_slope(&self, mut velocity: Velocity, slope: [f64; 2]) -> Velocity {
        if slope == [0.0; 2] {
            return velocity;
        }
        let slid_m_per_s = SLIDE * hypot(velocity[0], velocity[1]);
        let (sin, cos) = sin_cos(self.pose.theta_rad);
        let uphill = [slope[0] * cos + slope[1] * sin, slope[1] * cos - slope[0] * sin];
        velocity[0] -= slid_m_per_s * uphill[0];
        velocity[1] -= slid_m_per_s * uphill[1];
        velocity
    }

    /// Moves by one step.
    fn step(&mut self, velocity: Velocity) {
        let motion = &self.config.motion;
        let sds = [motion.right_sd_m, motion.forward_sd_m, motion.turn_sd_rad];
        let mut moved = [0.0; 3];
        for ((moved, velocity), sd) in moved.iter_mut().zip(velocity).zip(sds) {
            let normal: f64 = StandardNormal.sample(&mut self.motion_rng);
            *moved = velocity * motion.time_step_s + sd * normal;
        }
        // R(-theta_t) (w_t+1 - w_t) ~ N(A(c) dt, Sigma_m) (Stronger 2008, equation 2.28)
        let (sin, cos) = sin_cos(self.pose.theta_rad);
        self.pose.x_m += moved[0] * cos - moved[1] * sin;
        self.pose.y_m += moved[0] * sin + moved[1] * cos;
        self.pose.theta_rad = wrap_rad(self.pose.theta_rad + moved[2]);
        self.steps += 1;
        self.pose.t_s = self.now_s();
    }

    /// Takes a frame.
    fn look(&mut self, record: &mut Record) {
        let (t_s, sight, eye) = (self.pose.t_s, &self.config.sight, &self.eye);
        self.past.note(self.pose, t_s - eye.delay_s);
        let seen_from = self.past.at(t_s - eye.delay_s).unwrap_or(self.pose);
        let pan_reading_rad = sight.head_pan_rad(t_s) + eye.pan_offset_rad;
        let at = (t_s, pan_reading_rad);
        let mut sightings = sight.look(at, &seen_from, &self.standing, eye, &mut self.sight_rng);
        let frame = Frame { t_s, head_pan_rad: wrap_rad(pan_reading_rad) };
        let (view_rad, sizes) = (sight.view_rad, sight.heights_px().map(Size::HeightPx));
        for stage in &mut self.sighting_stages {
            stage(&Glance { frame, landmarks: &self.ids, view_rad, sizes }, &mut sightings);
        }
        record.seen.frames.push(frame);
        record.seen.sightings.append(&mut sightings);
        record.track.push(self.pose);
    }
}

impl World for PlainWorld {
    fn known(&self) -> Known {
        Known {
            robot: "plain".to_owned(),
            command_rate_hz: Some(1.0 / self.config.motion.time_step_s),
            landmarks: self.beacons.clone(),
            ..Known::default()
        }
    }

    fn t_s(&self) -> f64 {
        self.now_s()
    }

    fn pose(&self) -> TruePose {
        self.pose
    }

    fn tick(&mut self, action: Action, record: &mut Record) {
        let t_s = self.now_s();
        if self.steps == 0 {
            self.look(record);
        }
        let knobs = self.knobs(t_s);
        let velocity = self.mean_velocity(t_s, action, &knobs);
        let velocity = self.on_slope(velocity, knobs.ground.slope);
        self.step(velocity);
        self.look(record);
    }
}

#[cfg(test)]
mod tests;
