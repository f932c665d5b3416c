//! A car on an open plane under a log's commands, led by the speeds that were seen.
//!
//! Nobody knows the hills under a log's car. Left to itself, a car that is played without them drifts away by metres a
//! second. So the plane leans: after each step by as much as brings back, within about two seconds, what the played car
//! was too fast in it. Means are held against means, so that a car that needs no leading gets none. And where it
//! goes slower or faster than was seen, it changes gear by what was seen: a car that stays below the speed of a change
//! stays in the other gear for long.

use asami_dataset::{Command, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;
use asami_sim::effects::Effects;
use asami_sim::robots::car::{CarConfig, CarWorld, Start};
use asami_sim::scenes::solid::Ground;
use asami_sim::world::{Record, World};

use super::motion::Step;
use super::scanner::speed;
use crate::nominal::CannotPlay;

/// The speed comes back within this time.
const LED_S: f64 = 2.0;
/// Standard gravity.
const GRAVITY_M_PER_S2: f64 = 9.81;
/// Means over steps do not say by less than this how fast a car is at a time.
const AS_SEEN_M_PER_S: f64 = 0.1;
/// The plane never leans by more: no street does.
const STEEPEST: f64 = 0.25;
/// Routes begin towards world +x.
const TOWARDS_RAD: f64 = -std::f64::consts::FRAC_PI_2;

/// Slower cars are taken as they are.
const CREEPING_M_PER_S: f64 = 1.0;

/// Motion seen less motion played, by step: forward speed, turning rate.
pub type Left = [f64; 2];

/// Plays `commands` with `effects` in the world, and says what is left of the motion that was seen. The scanner's clock is
/// `ahead_s` ahead of the commands'.
///
/// # Errors
/// If the car cannot be built.
pub fn left(
    config: &CarConfig,
    effects: &Effects,
    commands: &[Command],
    steps: &[Step],
    ahead_s: f64,
) -> Result<Vec<Left>, CannotPlay> {
    let start = Start { x_m: 0.0, y_m: 0.0, theta_rad: TOWARDS_RAD };
    let ground = Ground::endless();
    let mut car =
        CarWorld::new(config, &ground, None, effects, start, Seed(0)).map_err(|error| CannotPlay(error.to_string()))?;
    let (Some(first), Some(last)) = (commands.first(), steps.last()) else { return Ok(Vec::new()) };
    // A log whose clock does not begin at zero: the car's own does.
    let zero_s = first.t_s.min(steps.first().map_or(0.0, |step| step.t_s));
    let until_s = last.t_s + last.dt_s - ahead_s - zero_s;
    let mut record = Record::default();
    let (mut next, mut in_force, mut rise) = (0, first.action, 0.0);
    let mut all: Vec<Left> = Vec::with_capacity(steps.len());
    loop {
        while let Some(step) = steps.get(all.len()) {
            let from_s = step.t_s - ahead_s - zero_s;
            if from_s + step.dt_s > car.t_s() {
                break;
            }
            let left = of_step(step, from_s, &record.track);
            rise = (-left[0] / (LED_S * GRAVITY_M_PER_S2)).clamp(-STEEPEST, STEEPEST);
            all.push(left);
        }
        if car.t_s() >= until_s {
            // A clock that runs behind may leave a step whose end was not reached by a rounding.
            let rest = steps[all.len()..].iter();
            all.extend(rest.map(|step| of_step(step, step.t_s - ahead_s - zero_s, &record.track)));
            return Ok(all);
        }
        let now_s = car.t_s() + zero_s;
        while let Some(command) = commands.get(next).filter(|command| command.t_s <= now_s + 1e-9) {
            in_force = command.action;
            next += 1;
        }
        let (sin, cos) = sin_cos(car.pose().theta_rad);
        car.lean([-rise * sin, rise * cos]);
        let off = speed(steps, now_s + ahead_s) - car.pose().v_m_per_s.unwrap_or(0.0);
        car.shift_as_if(off - off.clamp(-AS_SEEN_M_PER_S, AS_SEEN_M_PER_S));
        car.tick(in_force, &mut record);
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
    let faster = if v_m_per_s > CREEPING_M_PER_S { step.v_m_per_s / v_m_per_s } else { 1.0 };
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
        poses.windows(2).map(step).collect()
    }

    fn off(left: &[Left], axis: usize) -> f64 {
        (left.iter().map(|it| it[axis] * it[axis]).sum::<f64>() / left.len() as f64).sqrt()
    }

    #[test]
    fn of_a_nominal_car_on_a_plane_next_to_nothing_is_left() {
        let config = CarConfig::default();
        let steps = driven(&Effects::default());
        let left = left(&config, &Effects::default(), &commands(), &steps, 0.0).unwrap();
        assert!(off(&left, 0) < 1e-3 && off(&left, 1) < 1e-4, "{} {}", off(&left, 0), off(&left, 1));
    }

    #[test]
    fn what_an_effect_leaves_goes_once_it_is_played_too() {
        let config = CarConfig::default();
        let mut bent = Effects::default();
        bent.set("steering_offset", "offset_rad", 0.01);
        bent.set("throttle_delay", "delay_s", 0.3);
        let steps = driven(&bent);
        let under = |effects: &Effects| left(&config, effects, &commands(), &steps, 0.0).unwrap();
        let (without, with) = (under(&Effects::default()), under(&bent));
        for axis in 0..2 {
            assert!(off(&with, axis) < 0.05 * off(&without, axis), "{} {}", off(&with, axis), off(&without, axis));
        }
    }

    #[test]
    fn a_clock_that_is_ahead_is_set_back() {
        let config = CarConfig::default();
        let late = |step: &Step| Step { t_s: step.t_s + 0.2, ..*step };
        let steps: Vec<Step> = driven(&Effects::default()).iter().map(late).collect();
        let under = |ahead_s: f64| off(&left(&config, &Effects::default(), &commands(), &steps, ahead_s).unwrap(), 0);
        assert!(under(0.2) < 0.05 * under(0.0), "{} {}", under(0.2), under(0.0));
    }
}
