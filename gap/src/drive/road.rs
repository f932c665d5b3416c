//! A car on an open plane under a log's commands, led by the speeds that were seen.
//!
//! Nobody knows the hills under a log's car. Left to itself, a car that is played without them drifts away by metres a
//! second. So the plane leans: after each step by as much as brings back, within about two seconds, what the played car
//! was too fast in it. Means are held against means, so that a car that needs no leading gets none. And it changes gear when
//! the log's car did, as far as its speeds tell.

use asami_dataset::{Command, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{exp, sin_cos};
use asami_sim::effects::Effects;
use asami_sim::robots::car::drivetrain::Gear;
use asami_sim::robots::car::{CarConfig, CarWorld, Start};
use asami_sim::scenes::solid::Ground;
use asami_sim::world::{Record, World};

use super::gears::Gears;
use super::memory::stands;
use super::motion::Step;
use crate::nominal::CannotPlay;

/// The speed comes back within this time.
const LED_S: f64 = 2.0;
/// Where a car stopped the slope is known by then; on its way from there that is forgotten.
const FORGOTTEN_M: f64 = 40.0;
/// Standard gravity.
const GRAVITY_M_PER_S2: f64 = 9.81;
/// The plane never leans by more: no street does.
const STEEPEST: f64 = 0.25;
/// Routes begin towards world +x.
const TOWARDS_RAD: f64 = -std::f64::consts::FRAC_PI_2;

/// Slower cars are taken as they are.
const CREEPING_M_PER_S: f64 = 0.2;
/// No car is taken for so many times as fast.
const MOST_FASTER: f64 = 4.0;

/// Motion seen less motion played, by step: forward speed, turning rate.
pub type Left = [f64; 2];

/// When a played car changes gear.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shifts<'a> {
    /// By itself, as if it were so much faster than it was seen to be, in m/s.
    AsIfFaster(f64),
    /// As it is told.
    Told(&'a Gears),
}

/// One play.
#[derive(Clone, Debug)]
pub(super) struct Play {
    /// By step.
    pub left: Vec<Left>,
    /// By step of the engine.
    pub gears: Vec<Gear>,
    /// The engine's step at which each step of the log was over.
    pub ends: Vec<usize>,
}

/// A car, what it was told and how it was seen to move.
#[derive(Clone, Copy, Debug)]
pub struct Ride<'a> {
    /// The car that is played.
    pub car: &'a CarConfig,
    /// In order of time.
    pub commands: &'a [Command],
    /// In order of time.
    pub steps: &'a [Step],
}

impl Ride<'_> {
    /// Plays the commands with `effects` in the world, in the gears that the log's car was in, and says what is left of the motion
    /// that was seen. The scanner's clock is `ahead_s` ahead of the commands'.
    ///
    /// # Errors
    /// If the car cannot be built.
    pub fn left(&self, effects: &Effects, ahead_s: f64, gears: &Gears) -> Result<Vec<Left>, CannotPlay> {
        Ok(self.play(effects, ahead_s, Shifts::Told(gears))?.left)
    }

    /// As [`Ride::left`], with the gearbox changing as is said.
    pub(super) fn play(&self, effects: &Effects, ahead_s: f64, shifts: Shifts<'_>) -> Result<Play, CannotPlay> {
        let Self { car: config, commands, steps } = *self;
        let mut all =
            Play { left: Vec::with_capacity(steps.len()), gears: Vec::new(), ends: Vec::with_capacity(steps.len()) };
        let start = Start { x_m: 0.0, y_m: 0.0, theta_rad: TOWARDS_RAD };
        let ground = Ground::endless();
        let mut car = CarWorld::new(config, &ground, None, effects, start, Seed(0))
            .map_err(|error| CannotPlay(error.to_string()))?;
        if let Shifts::Told(gears) = shifts {
            car.gear_as(gears.by_step(ahead_s, config.physics.time_step_s));
        }
        let (Some(first), Some(last)) = (commands.first(), steps.last()) else { return Ok(all) };
        // A log whose clock does not begin at zero: the car's own does.
        let zero_s = first.t_s.min(steps.first().map_or(0.0, |step| step.t_s));
        let until_s = last.t_s + last.dt_s - ahead_s - zero_s;
        let mut record = Record::default();
        let (mut next, mut in_force) = (0, first.action);
        let (mut rise, mut stopped_on) = (0.0, 0.0);
        loop {
            while let Some(step) = steps.get(all.left.len()) {
                let from_s = step.t_s - ahead_s - zero_s;
                if from_s + step.dt_s > car.t_s() {
                    break;
                }
                let left = of_step(step, from_s, &record.track);
                // The ground stays as it is under a car that stands.
                if !stands(step) {
                    let pulls_away = all.left.len().checked_sub(1).is_some_and(|before| stands(&steps[before]));
                    let known = if pulls_away { rise } else { stopped_on };
                    stopped_on = known * exp(-step.v_m_per_s * step.dt_s / FORGOTTEN_M);
                    rise = (stopped_on - left[0] / (LED_S * GRAVITY_M_PER_S2)).clamp(-STEEPEST, STEEPEST);
                }
                all.left.push(left);
                all.ends.push(car.gears().len());
            }
            if car.t_s() >= until_s {
                // A clock that runs behind may leave a step whose end was not reached by a rounding.
                let rest = steps[all.left.len()..].iter();
                all.left.extend(rest.map(|step| of_step(step, step.t_s - ahead_s - zero_s, &record.track)));
                all.ends.resize(steps.len(), car.gears().len());
                all.gears = car.gears().to_vec();
                return Ok(all);
            }
            let now_s = car.t_s() + zero_s;
            while let Some(command) = commands.get(next).filter(|command| command.t_s <= now_s + 1e-9) {
                in_force = command.action;
                next += 1;
            }
            let (sin, cos) = sin_cos(car.pose().theta_rad);
            car.lean([-rise * sin, rise * cos]);
            if let Shifts::AsIfFaster(by_m_per_s) = shifts {
                car.shift_as_if(all.left.last().map_or(0.0, |left| left[0]) + by_m_per_s);
            }
            car.tick(in_force, &mut record);
        }
    }
}

/// What is left of one step that begins at `from_s` by the played car's clock.
fn of_step(step: &Step, from_s: f64, played: &[TruePose]) -> Left {
    let (a, b) = (at_s(played, from_s), at_s(played, from_s + step.dt_s));
    let turn_rad = wrap_rad(b.theta_rad - a.theta_rad);
    let (sin, cos) = sin_cos(a.theta_rad + 0.5 * turn_rad);
    let along_m = -(b.x_m - a.x_m) * sin + (b.y_m - a.y_m) * cos;
    let v_m_per_s = along_m / step.dt_s;
    // A car that is played slower turns more slowly along the same curve.
    let faster = if v_m_per_s > CREEPING_M_PER_S { (step.v_m_per_s / v_m_per_s).clamp(0.0, MOST_FASTER) } else { 1.0 };
    [step.v_m_per_s - v_m_per_s, step.omega_rad_per_s - faster * turn_rad / step.dt_s]
}

/// The pose at a time, of poses in order of time; before the first and after the last, these.
fn at_s(poses: &[TruePose], t_s: f64) -> TruePose {
    let standing = TruePose { t_s, x_m: 0.0, y_m: 0.0, theta_rad: TOWARDS_RAD, v_m_per_s: None };
    let at = poses.partition_point(|pose| pose.t_s <= t_s).saturating_sub(1);
    let Some(a) = poses.get(at) else { return standing };
    let Some(b) = poses.get(at + 1).filter(|_| a.t_s <= t_s) else { return *a };
    let share = (t_s - a.t_s) / (b.t_s - a.t_s).max(1e-9);
    let mix = |a: f64, b: f64| a + share * (b - a);
    TruePose {
        t_s,
        x_m: mix(a.x_m, b.x_m),
        y_m: mix(a.y_m, b.y_m),
        theta_rad: a.theta_rad + share * wrap_rad(b.theta_rad - a.theta_rad),
        v_m_per_s: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asami_dataset::Action;

    /// Off from the line, a corner to the left, and on the brake again.
    fn commands() -> Vec<Command> {
        let pedals = |t_s: f64, throttle: f64, brake: f64, steering: f64| Command {
            t_s,
            action: Action::Pedals { throttle, brake, steering },
        };
        vec![
            pedals(0.0, 0.0, 0.4, 0.0),
            pedals(1.0, 0.2, 0.0, 0.0),
            pedals(4.0, 0.05, 0.0, 0.4),
            pedals(8.0, 0.1, 0.0, 0.0),
            pedals(12.0, 0.0, 0.3, 0.0),
        ]
    }

    /// What a car on a level plane does, as its scans would say it.
    fn driven(effects: &Effects) -> Vec<Step> {
        driven_in_gears(effects).0
    }

    fn driven_in_gears(effects: &Effects) -> (Vec<Step>, Vec<Gear>) {
        let start = Start { x_m: 0.0, y_m: 0.0, theta_rad: 0.3 };
        let mut car =
            CarWorld::new(&CarConfig::default(), &Ground::level(500.0), None, effects, start, Seed(1)).unwrap();
        let (commands, mut record) = (commands(), Record::default());
        while car.t_s() < 16.0 {
            let now = commands.partition_point(|command| command.t_s <= car.t_s() + 1e-9);
            car.tick(commands[now - 1].action, &mut record);
        }
        let poses: Vec<&TruePose> = record.track.iter().step_by(50).collect();
        let step = |pair: &[&TruePose]| {
            let (a, b) = (pair[0], pair[1]);
            let (dt_s, turn_rad) = (b.t_s - a.t_s, wrap_rad(b.theta_rad - a.theta_rad));
            let (sin, cos) = sin_cos(a.theta_rad + 0.5 * turn_rad);
            let along_m = -(b.x_m - a.x_m) * sin + (b.y_m - a.y_m) * cos;
            Step { t_s: a.t_s, dt_s, v_m_per_s: along_m / dt_s, omega_rad_per_s: turn_rad / dt_s }
        };
        (poses.windows(2).map(step).collect(), car.gears().to_vec())
    }

    fn left(effects: &Effects, steps: &[Step], ahead_s: f64) -> Vec<Left> {
        let (car, commands) = (CarConfig::default(), commands());
        let ride = Ride { car: &car, commands: &commands, steps };
        let gears = Gears::found(&ride, effects, ahead_s).unwrap();
        ride.left(effects, ahead_s, &gears).unwrap()
    }

    fn off(left: &[Left], axis: usize) -> f64 {
        (left.iter().map(|it| it[axis] * it[axis]).sum::<f64>() / left.len() as f64).sqrt()
    }

    #[test]
    fn of_a_nominal_car_on_a_plane_next_to_nothing_is_left() {
        let steps = driven(&Effects::default());
        let left = left(&Effects::default(), &steps, 0.0);
        assert!(off(&left, 0) < 1e-3 && off(&left, 1) < 1e-4, "{} {}", off(&left, 0), off(&left, 1));
    }

    #[test]
    fn what_an_effect_leaves_goes_once_it_is_played_too() {
        let mut bent = Effects::default();
        bent.set("steering_offset", "offset_rad", 0.01);
        bent.set("throttle_delay", "delay_s", 0.3);
        let steps = driven(&bent);
        let under = |effects: &Effects| left(effects, &steps, 0.0);
        let (without, with) = (under(&Effects::default()), under(&bent));
        for axis in 0..2 {
            assert!(off(&with, axis) < 0.05 * off(&without, axis), "{} {}", off(&with, axis), off(&without, axis));
        }
    }

    /// Throttle that comes late is not known of when they are found: changes are off by as much at most.
    #[test]
    fn gears_are_those_the_car_was_in() {
        for (delay_s, most_s) in [(0.0, 0.01), (0.05, 0.06)] {
            let mut bent = Effects::default();
            bent.set("throttle_delay", "delay_s", delay_s);
            let (steps, gears) = driven_in_gears(&bent);
            let (car, commands) = (CarConfig::default(), commands());
            let ride = Ride { car: &car, commands: &commands, steps: &steps };
            let found = Gears::found(&ride, &Effects::default(), 0.0).unwrap().by_step(0.0, car.physics.time_step_s);
            assert!(gears.contains(&Gear::Second) && gears.last() == Some(&Gear::First), "it changes up and down");
            let last = *found.last().unwrap();
            let same = |(at, gear): &(usize, &Gear)| found.get(*at).copied().unwrap_or(last) == **gear;
            let other = gears.iter().enumerate().filter(|it| !same(it)).count();
            let most = 2.0 * most_s / CarConfig::default().physics.time_step_s;
            assert!((other as f64) < most, "{delay_s} {other}");
        }
    }

    #[test]
    fn a_clock_that_is_ahead_is_set_back() {
        let late = |step: &Step| Step { t_s: step.t_s + 0.2, ..*step };
        let steps: Vec<Step> = driven(&Effects::default()).iter().map(late).collect();
        let under = |ahead_s: f64| off(&left(&Effects::default(), &steps, ahead_s), 0);
        assert!(under(0.2) < 0.05 * under(0.0), "{} {}", under(0.2), under(0.0));
    }
}
