//! The diagnosis of a real car's log by what its own odometry says of its motion: pedals and steering wheel are played in the
//! nominal world, and what is left of speeds and turning rates tells which effects the car lacks there.
//!
//! A quarter of the log, in pieces, says how what is left scatters, and is not scored. Of a car that stands nothing says what gear
//! it is in, or who holds it: that is not scored either. Effects are found about a world that is as it is, then all are played
//! again about the world with them in it, for what they change is not additive.

mod steps;

use std::sync::Arc;

use asami_dataset::{Action, Log};
use asami_sim::effect::{Block, Place};
use asami_sim::effects::Effects;
use asami_sim::robots::car::CarConfig;

use super::assembled;
use super::folds::Folds;
use super::kin::Kin;
use super::layers::{Layer, Least, layers, planted, reconsidered};
use crate::answer::diagnosis::Diagnosis;
use crate::drive::driven::Driven;
use crate::drive::library::Drives;
use crate::drive::motion::Step;
use crate::drive::read::Read;
use crate::plant::{Planted, Variant};
use crate::view::CannotSee;
use steps::steps;

/// The world is played about the effects that were found so often.
const WORLDS: usize = 2;
/// In each of them noise is learned, and effects are named, so often.
const ROUNDS: usize = 3;
/// What adds less may as well be what the nominal car's own shape, or the superposition of effects, is off.
const LEAST: Least = Least { nats: 10.0, share: 0.003, share_together: 0.003, late_once: false, kin: Kin::NONE };
/// Fewer steps do not say how what is left scatters; fewer show nothing.
const LEAST_KEPT: usize = 60;
const LEAST_SCORED: usize = 100;
/// Slower cars stand.
const STANDING_M_PER_S: f64 = 0.3;
/// After it stood, a car is not scored for so long: the played one has to catch up.
const STARTING_S: f64 = 3.0;

/// Diagnoses a log by its odometry.
///
/// # Errors
/// [`CannotSee`] says what the log lacks.
pub fn diagnose(car: &CarConfig, effects: &Effects, variants: &[Variant], log: &Log) -> Result<Diagnosis, CannotSee> {
    if !log.commands.iter().any(|command| matches!(command.action, Action::Pedals { .. })) {
        return Err(CannotSee::NoPedals);
    }
    // There is no scanner, and no street.
    let moves = |it: &&Variant| matches!(it.place(), Place::Actuation | Place::Dynamics) && it.block() != Block::Noise;
    let variants: Vec<Variant> = variants.iter().filter(moves).cloned().collect();
    let steps = steps(&log.odometry);
    let (kept, scored) = parted(&steps);
    let least = [LEAST_KEPT, LEAST_SCORED];
    if kept.len() < LEAST_KEPT || scored.len() < LEAST_SCORED {
        return Err(CannotSee::Stands { kept: kept.len(), scored: scored.len(), least });
    }
    let mut drives = Drives::of_motion(car, effects);
    let read = |drives: &Drives, held: &[Planted]| {
        Read::of(drives, &log.commands, (steps.clone(), Vec::new()), held).map(Arc::new).map_err(CannotSee::Play)
    };
    let scores = |i: usize| scored.binary_search(&i).is_ok();
    let mut now = read(&drives, &[])?;
    drives.base.memory = Driven::new(&drives, Arc::clone(&now)).noise(&[], &kept);
    drives.play(&variants);
    let mut found: Vec<Layer> = Vec::new();
    for _ in 0..WORLDS {
        now = read(&drives, &planted(&found))?;
        for _ in 0..ROUNDS {
            drives.base.memory = Driven::new(&drives, Arc::clone(&now)).noise(&planted(&found), &kept);
            let judge = Driven::scoring(&drives, Arc::clone(&now), scores);
            found = layers(&judge, &variants, &LEAST);
        }
    }
    let judge = Driven::scoring(&drives, now, scores);
    let found = reconsidered(&judge, &variants, found, &LEAST);
    Ok(assembled(&judge, &variants, &found, &planted(&found)))
}

/// Numbers of the steps under way that are set aside, and of those that are scored.
fn parted(steps: &[Step]) -> (Vec<usize>, Vec<usize>) {
    let folds = Folds { count: 4, ..Folds::default() };
    let begins_s = steps.first().map_or(0.0, |step| step.t_s);
    let under_way = under_way(steps);
    (0..steps.len()).filter(|i| under_way[*i]).partition(|i| folds.of(steps[*i].t_s - begins_s) == 0)
}

/// Whether the car moves at each step, and has for a while.
fn under_way(steps: &[Step]) -> Vec<bool> {
    let mut stood_s = f64::NEG_INFINITY;
    let moves = |step: &Step| {
        if step.v_m_per_s.abs() < STANDING_M_PER_S {
            stood_s = step.t_s;
        }
        step.t_s - stood_s > STARTING_S
    };
    steps.iter().map(moves).collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::log::Odometry;
    use asami_dataset::{Command, Known, Seed};
    use asami_math::elementary::sin;
    use asami_sim::effects::catalogue;
    use asami_sim::robots::car::{CarWorld, Start};
    use asami_sim::scenes::solid::Ground;
    use asami_sim::world::{Record, World};
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::answer::diagnosis::Verdict;

    /// Enough for a pair of pieces that are set aside.
    const RIDE_S: f64 = 160.0;

    /// A ride on a level plane, at speeds about a wish that changes, told by readings with some noise.
    fn ride(effects: &Effects, seed: u64) -> Log {
        let ground = Ground::endless();
        let mut car =
            CarWorld::new(&CarConfig::default(), &ground, None, effects, Start::default(), Seed(seed)).unwrap();
        let mut rng = Seed(seed).stream("ride");
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (mut commands, mut odometry, mut record) = (Vec::new(), Vec::new(), Record::default());
        let mut before = car.pose();
        while car.t_s() < RIDE_S {
            let t_s = car.t_s();
            let wish = 8.0 + 3.0 * sin(0.21 * t_s) + 1.5 * sin(0.83 * t_s);
            let pull = 0.1 + 0.06 * (wish - before.v_m_per_s.unwrap_or(0.0));
            let (throttle, brake) = (pull.clamp(0.0, 0.5), (-pull).clamp(0.0, 0.4));
            let steering = 0.06 * sin(0.37 * t_s) + 0.05 * sin(1.1 * t_s);
            let action = Action::Pedals { throttle, brake, steering };
            commands.push(Command { t_s, action });
            car.tick(action, &mut record);
            let pose = car.pose();
            let turned = asami_math::angle::wrap_rad(pose.theta_rad - before.theta_rad);
            let omega_rad_per_s = turned / (pose.t_s - before.t_s) + 2e-3 * normal();
            let speeds = [before, pose].map(|it| it.v_m_per_s.unwrap_or(0.0));
            let v_m_per_s = 0.5 * (speeds[0] + speeds[1]) + 0.02 * normal();
            odometry.push(Odometry { t_s: 0.5 * (pose.t_s + before.t_s), v_m_per_s, omega_rad_per_s });
            before = pose;
        }
        let known = Known { robot: "car".to_owned(), ..Known::default() };
        Log { known: known.into(), commands: commands.into(), odometry: odometry.into(), ..Log::default() }
    }

    fn thought_of() -> Vec<Variant> {
        let names = ["throttle_deadband", "engine_torque", "steering_offset", "steering_ratio", "steering_lag", "drag"];
        let all = catalogue().into_iter().filter(|about| names.contains(&about.name));
        all.flat_map(|about| Variant::of(about, 0)).collect()
    }

    fn said(effects: &Effects, seed: u64) -> Diagnosis {
        diagnose(&CarConfig::default(), &Effects::default(), &thought_of(), &ride(effects, seed)).unwrap()
    }

    #[test]
    fn two_effects_of_a_car_are_named_with_their_sizes_by_its_odometry_alone() {
        let mut effects = Effects::default();
        effects.set("steering_offset", "offset_rad", 0.004);
        effects.set("engine_torque", "ratio", 0.75);
        let diagnosis = said(&effects, 1000);
        let cause = diagnosis.which.iter().find(|cause| cause.effects[0] != "unknown").unwrap();
        assert_eq!(diagnosis.verdict, Verdict::Named, "{:?}", diagnosis.which);
        let near = |name: &str, size: f64, within: f64| {
            let found = cause.parameters.get(name).map_or(f64::NAN, |it| it.value);
            assert!((found - size).abs() < within, "{name}: {found}, not {size}");
        };
        near("steering_offset.offset_rad", 0.004, 0.0003);
        near("engine_torque.ratio", 0.75, 0.03);
        assert!(diagnosis.how_far.closed.is_some_and(|closed| closed > 0.9), "{:?}", diagnosis.how_far);
    }

    #[test]
    fn of_a_car_that_lacks_nothing_nothing_is_said() {
        let diagnosis = said(&Effects::default(), 1001);
        assert_eq!(diagnosis.verdict, Verdict::None, "{:?}", diagnosis.which);
    }

    #[test]
    fn a_ride_without_pedals_or_without_moving_is_refused() {
        let asked = |log: &Log| diagnose(&CarConfig::default(), &Effects::default(), &thought_of(), log).unwrap_err();
        let stands = |t_s: f64| Odometry { t_s, v_m_per_s: 0.0, omega_rad_per_s: 0.0 };
        let odometry: Vec<Odometry> = (0..2000).map(|i| stands(0.1 * f64::from(i))).collect();
        let action = Action::Pedals { throttle: 0.0, brake: 0.3, steering: 0.0 };
        let commands = vec![Command { t_s: 0.0, action }];
        let log = Log { commands: commands.into(), odometry: odometry.into(), ..Log::default() };
        let said = asked(&log);
        assert!(matches!(said, CannotSee::Stands { kept: 0, scored: 0, .. }), "{said}");
        let wheels = Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s: 0.0 };
        let commands = vec![Command { t_s: 0.0, action: wheels }];
        assert_eq!(asked(&Log { commands: commands.into(), ..log }), CannotSee::NoPedals);
    }

    #[test]
    fn a_car_that_stands_is_not_under_way_nor_just_after() {
        let step = |i: usize| Step {
            t_s: i as f64,
            dt_s: 1.0,
            v_m_per_s: if i < 3 { 0.0 } else { 5.0 },
            omega_rad_per_s: 0.0,
        };
        let found = under_way(&(0..9).map(step).collect::<Vec<_>>());
        assert_eq!(found, [false, false, false, false, false, false, true, true, true]);
    }
}
