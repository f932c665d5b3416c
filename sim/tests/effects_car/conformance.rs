//! One suite over all effects that fit the car: at null an effect changes no bit of a log, off null it does, any two of
//! them work together, and none disturbs another's draws.

use std::sync::Arc;

use asami_dataset::{Action, Dataset, Rng, Seed};
use asami_sim::effect::{About, Place};
use asami_sim::effects::Effects;
use asami_sim::robots::car::{CarConfig, CarWorld, Start};
use asami_sim::scenes::solid::Ground;
use asami_sim::sensors::velodyne::Velodyne;
use asami_sim::world::{Drive, Seen, dataset, record};
use rand::RngExt;

use crate::catalogue::{BEGIN, LARGE, fitting, null, plant, planted};
use crate::scans::{YARD, every_eighth, few_beams, traffic};

/// Long enough for five changes of the pedals.
const DRIVE_S: f64 = 4.0;

fn fits() -> Vec<&'static About> {
    let all = fitting("car");
    assert!(all.len() >= 23, "the suite would pass on an empty list, not on {} effects", all.len());
    all
}

fn drive(effects: &Effects, seed: u64) -> Dataset {
    let seed = Seed(seed);
    let mut config = CarConfig::default();
    config.physics.settle_s = 0.5;
    let ground = Ground::level(300.0);
    let mut car =
        CarWorld::new(&config, &ground, None, effects, Start::default(), seed).expect("the shipped car builds");
    let mut record = record(&mut car, &mut Feet { rng: seed.stream("drive"), current: None }, DRIVE_S);
    let poses = std::mem::take(&mut record.sensor_poses);
    let mut dataset = dataset(&car, record);
    let velodyne = Velodyne::new(few_beams(), every_eighth()).under(effects, seed).among(traffic(effects, seed));
    dataset.log.firings = Some(Arc::new(velodyne.scan(&YARD, &poses, seed).expect("a drive")));
    dataset
}

/// Whether two drives, or what was scanned on them, do.
fn differ(one: &Dataset, other: &Dataset) -> bool {
    one.truth != other.truth || one.log.firings != other.log.firings
}

/// Pedals and steering at random, new every 0.8 s; firm enough for tyres to slide.
struct Feet {
    rng: Rng,
    current: Option<(f64, Action)>,
}

impl Drive for Feet {
    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let (since_s, action) = self.current.unwrap_or_else(|| (t_s, self.draw()));
        self.current = (t_s - since_s < 0.75).then_some((since_s, action));
        action
    }
}

impl Feet {
    fn draw(&mut self) -> Action {
        let [throttle, brake, steering] = [(); 3].map(|()| self.rng.random::<f64>());
        Action::Pedals { throttle, brake: (brake - 0.6).max(0.0), steering: 2.0 * steering - 1.0 }
    }
}

#[test]
fn at_null_no_bit_changes_and_off_null_the_drive_does() {
    let nominal = drive(&Effects::default(), 1);
    for about in fits() {
        assert!(drive(&null(about), 1) == nominal, "{} at null changes the drive", about.name);
        let large = planted(about, LARGE);
        let other = drive(&large, 1);
        assert!(differ(&other, &nominal), "{} changes nothing", about.name);
        // The car is told nothing.
        assert_eq!(other.log.known, nominal.log.known, "{}", about.name);
        let values: Vec<f64> = large.iter().flat_map(|effect| effect.values()).collect();
        for (parameter, value) in about.parameters.iter().zip(values).filter(|(it, _)| it.name != BEGIN) {
            let (least, greatest) = parameter.range;
            let mut changed = large.clone();
            changed.set(about.name, parameter.name, if value == least { greatest } else { least });
            assert!(differ(&drive(&changed, 1), &other), "{}.{} changes nothing", about.name, parameter.name);
        }
    }
}

#[test]
fn any_two_effects_work_together() {
    let all = fits();
    let alone: Vec<Dataset> = all.iter().map(|about| drive(&planted(about, LARGE), 2)).collect();
    for (i, one) in all.iter().enumerate() {
        for (k, other) in all.iter().enumerate().skip(i + 1) {
            let mut both = planted(one, LARGE);
            plant(&mut both, other, LARGE);
            let dataset = drive(&both, 2);
            let pair = format!("{} and {}", one.name, other.name);
            let finite = dataset.truth.track.iter().all(|pose| (pose.x_m + pose.y_m + pose.theta_rad).is_finite());
            assert!(finite, "{pair}");
            assert!(differ(&dataset, &alone[i]) && differ(&dataset, &alone[k]), "{pair}: one hides the other");
        }
    }
}

/// The commands are the same with and without an effect: they are drawn from a stream of their own. And an effect on the
/// scanner does not move the car.
#[test]
fn switching_an_effect_on_leaves_other_draws_alone() {
    let nominal = drive(&Effects::default(), 3);
    for about in fits() {
        let dataset = drive(&planted(about, LARGE), 3);
        assert!(dataset.log.commands == nominal.log.commands, "{}", about.name);
        let still = dataset.truth == nominal.truth;
        let sensing = matches!(about.place, Place::Sensing | Place::Scene);
        // Friction that is enough for all that these tyres are asked to do changes nothing.
        assert!(still == sensing || about.name == "ground_friction", "{}", about.name);
    }
}
