//! The plain robot on a field: the loop from command to pose, and from poses to frames.

use asami_dataset::survey::{self, Height, Survey};
use asami_dataset::{Action, Beacon, Frame, Known, Rng, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;
use rand_distr::{Distribution, StandardNormal};

use super::config::PlainConfig;
use super::velocities::{Velocities, Velocity};
use crate::drives::suite::Suite;
use crate::effect::{CommandStage, SightingStage, Stage};
use crate::effects::Effects;
use crate::knobs::{CommandKnobs, GroundKnobs, Knobs, VehicleKnobs};
use crate::scenes::field::{Field, Landmark};
use crate::survey::Surveying;
use crate::world::{Record, World};

/// The plain robot in its world.
pub struct PlainWorld {
    config: PlainConfig,
    suite: Suite,
    effects: Effects,
    beacons: Vec<Beacon>,
    velocities: Velocities,

    command_stages: Vec<CommandStage>,
    sighting_stages: Vec<SightingStage>,
    motion_rng: Rng,
    sight_rng: Rng,

    pose: TruePose,
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
        let beacon =
            |it: &Landmark| Beacon { id: it.id, x_m: it.body.x_m, y_m: it.body.y_m, height_m: Some(it.body.height_m) };
        let mut beacons: Vec<Beacon> = field.beacons.iter().map(beacon).collect();
        beacons.sort_by_key(|beacon| beacon.id);
        let mut world = Self {
            config: config.clone(),
            suite: suite.clone(),
            effects: effects.clone(),
            beacons,
            velocities: Velocities::new(&config.distortion, suite),
            command_stages: Vec::new(),
            sighting_stages: Vec::new(),
            motion_rng: seed.stream("plain/motion"),
            sight_rng: seed.stream("plain/sight"),
            pose: TruePose { t_s: 0.0, theta_rad: wrap_rad(start.theta_rad), ..start },
            steps: 0,
        };
        for effect in effects.iter() {
            match effect.stage(seed.stream(&format!("effect/{}", effect.about().name))) {
                Some(Stage::Command(stage)) => world.command_stages.push(stage),
                Some(Stage::Sighting(stage)) => world.sighting_stages.push(stage),
                // No joints to act on: such effects do not fit this robot.
                Some(Stage::Joint(_)) | None => {}
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
        let knobs = self.knobs(0.0);
        let velocity_by_action = (0..).zip(self.suite.actions()).map(|(action, attempted)| {
            let [vx_m_per_s, vy_m_per_s, vtheta_rad_per_s] = self.velocity(attempted, &knobs);
            survey::Velocity { action, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s }
        });
        let height_by_distance = how.distances_m().into_iter().map(|distance_m| Height {
            distance_m,
            height_px: sight.height_px(distance_m),
            sd_px: sight.sigma1_px,
            bearing_sd_rad: sight.sigma2_rad,
            readings: how.readings,
        });
        Survey {
            velocity_by_action: velocity_by_action.collect(),
            height_by_distance: height_by_distance.collect(),
            sigma1_px: Some(sight.sigma1_px),
            sigma2_rad: Some(sight.sigma2_rad),
            motion_sd: Some([motion.right_sd_m, motion.forward_sd_m, motion.turn_sd_rad]),
            ..Survey::default()
        }
    }

    fn now_s(&self) -> f64 {
        self.steps as f64 * self.config.motion.time_step_s
    }

    /// The knobs as the effects turn them.
    fn knobs(&self, t_s: f64) -> Knobs {
        let mut knobs = Knobs {
            command: CommandKnobs { scale: [1.0; 3] },
            ground: GroundKnobs { friction: 1.0 },
            vehicle: VehicleKnobs::default(),
        };
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
        self.velocities.of(id, attempt)
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
        let t_s = self.pose.t_s;
        let mut sightings = self.config.sight.look(&self.pose, &self.beacons, &mut self.sight_rng);
        for stage in &mut self.sighting_stages {
            stage(t_s, &mut sightings);
        }
        let head_pan_rad = wrap_rad(self.config.sight.head_pan_rad(t_s));
        record.seen.frames.push(Frame { t_s, head_pan_rad });
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
        let action = self.command_stages.iter_mut().fold(action, |action, stage| stage(t_s, action));
        let velocity = self.velocity(action, &self.knobs(t_s));
        self.step(velocity);
        self.look(record);
    }
}

#[cfg(test)]
mod tests;
