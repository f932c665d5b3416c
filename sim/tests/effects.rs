//! One suite over the whole catalogue of effects: at null an effect changes no bit of a log, off null
//! it does, and any two of them work together.

use asami_dataset::{Action, Dataset, Rng, Seed, TruePose};
use asami_sim::drives::suite::Suite;
use asami_sim::effect::About;
use asami_sim::effects::{Effects, catalogue};
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, Start};
use asami_sim::robots::car::{CarConfig, CarWorld};
use asami_sim::robots::plain::{PlainConfig, PlainWorld};
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::scenes::solid::Ground;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::world::{Drive, Seen, World, run};
use rand::RngExt;

/// Long enough for several strides, a change of command and a dozen dozen frames.
const WALK_S: f64 = 6.0;

/// The robots that have a world: each must bear every effect that fits it.
const ROBOTS: [&str; 3] = ["aibo", "car", "plain"];

fn walk(robot: &str, effects: &Effects, seed: u64) -> Dataset {
    let seed = Seed(seed);
    let pedals = robot == "car";
    let mut drive = Wander { rng: seed.stream("drive"), current: None, pedals };
    run(&mut *world(robot, effects, seed), &mut drive, WALK_S)
}

fn world(robot: &str, effects: &Effects, seed: Seed) -> Box<dyn World> {
    let bands = [Colour::Pink, Colour::Yellow];
    let body = Cylinder { x_m: 0.0, y_m: 0.0, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands };
    let field = Field { beacons: vec![Landmark { id: 0, body }], clutter: Vec::new() };
    if robot == "car" {
        let (config, ground) = (CarConfig::default(), Ground::level(300.0));
        let start = asami_sim::robots::car::Start::default();
        return Box::new(CarWorld::new(&config, &ground, None, effects, start, seed).expect("the shipped car"));
    }
    if robot == "plain" {
        let (config, suite) = (PlainConfig::default(), Suite::default());
        let start = TruePose { t_s: 0.0, x_m: 0.0, y_m: -2.0, theta_rad: 0.0, v_m_per_s: None };
        return Box::new(PlainWorld::new(&config, &suite, &field, effects, start, seed));
    }
    let start = Start { y_m: -2.0, ..Start::default() };
    let (config, camera) = (AiboConfig::default(), CameraConfig::default());
    Box::new(AiboWorld::new(&config, &field, &camera, effects, start, seed).expect("the shipped robot"))
}

/// Commands of all three parts at once, new every 1.5 s.
struct Wander {
    rng: Rng,
    current: Option<(f64, Action)>,
    /// Of a car rather than of legs.
    pedals: bool,
}

impl Drive for Wander {
    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let (since_s, action) = self.current.unwrap_or_else(|| (t_s, self.draw()));
        self.current = Some((since_s, action));
        if t_s - since_s >= 1.5 {
            self.current = None;
        }
        action
    }
}

impl Wander {
    fn draw(&mut self) -> Action {
        let [a, b, c] = [(); 3].map(|()| 2.0 * self.rng.random::<f64>() - 1.0);
        if self.pedals {
            // Firm enough on brake and steering for tyres to slide.
            return Action::Pedals { throttle: a.abs(), brake: if b > 0.2 { b } else { 0.0 }, steering: c };
        }
        Action::Legs { id: None, ax_m_per_s: 0.06 * a, ay_m_per_s: 0.2 * b, atheta_rad_per_s: 0.4 * c }
    }
}

/// One effect with every parameter set by `choose`.
fn set(about: &About, choose: impl Fn(&asami_dataset::parameters::Parameter) -> f64) -> Effects {
    let mut effects = Effects::default();
    for parameter in about.parameters {
        assert!(effects.set(about.name, parameter.name, choose(parameter)), "{}.{}", about.name, parameter.name);
    }
    effects
}

fn fitting(robot: &str) -> Vec<&'static About> {
    catalogue().into_iter().filter(|about| about.fits.contains(&robot)).collect()
}

/// The parameter that says when an effect begins; by itself it does nothing.
const BEGIN: &str = "from_s";

/// The end of a parameter's range that is farther from its null value; a beginning is within the walk.
fn far(parameter: &asami_dataset::parameters::Parameter) -> f64 {
    if parameter.name == BEGIN {
        return WALK_S / 3.0;
    }
    let (least, greatest) = parameter.range;
    if parameter.default - least > greatest - parameter.default { least } else { greatest }
}

#[test]
fn the_catalogue_is_complete_and_says_what_it_is() {
    assert!(catalogue().len() >= 3, "most tests here pass on an empty list");
    for about in catalogue() {
        assert!(!about.what.is_empty() && !about.source.is_empty() && !about.fits.is_empty(), "{}", about.name);
        assert!(!about.parameters.is_empty(), "{}", about.name);
        for parameter in about.parameters {
            let (least, greatest) = parameter.range;
            assert!(least < greatest && (least..=greatest).contains(&parameter.default), "{}", parameter.name);
            assert!(!parameter.about.is_empty() && !parameter.unit.is_empty(), "{}", parameter.name);
            let suffix = match parameter.unit {
                "1" => "",
                unit => unit,
            };
            let tail = suffix.replace('/', "_per_").replace('^', "");
            assert!(parameter.name.ends_with(&tail), "{} carries no unit {}", parameter.name, parameter.unit);
        }
        let null = set(about, |parameter| parameter.default);
        assert!(null.iter().all(asami_sim::effect::Effect::is_null), "{}", about.name);
        assert_eq!(null.iter().count(), 1, "{}", about.name);
        assert_eq!(null.without(about.name), Effects::default(), "{}", about.name);
        assert!(!Effects::default().set(about.name, "no_such_parameter", 0.0), "{}", about.name);
    }
}

#[test]
fn at_null_no_bit_changes_and_off_null_the_log_does() {
    for robot in ROBOTS {
        let nominal = walk(robot, &Effects::default(), 1);
        let fitting = fitting(robot);
        assert!(fitting.len() >= 2, "effects for {robot}: {}", fitting.len());
        for about in fitting {
            let null = walk(robot, &set(about, |parameter| parameter.default), 1);
            assert!(null == nominal, "{} at null changes the log of {robot}", about.name);
            let mut effects = set(about, |parameter| parameter.default);
            for parameter in about.parameters.iter().filter(|parameter| parameter.name != BEGIN) {
                effects.set(about.name, parameter.name, far(parameter));
                let log = walk(robot, &effects, 1);
                assert!(log != nominal, "{}.{} changes nothing of {robot}", about.name, parameter.name);
                effects.set(about.name, parameter.name, parameter.default);
            }
        }
    }
}

#[test]
fn before_it_begins_an_effect_changes_no_bit() {
    let begins = |about: &&About| about.parameters.iter().any(|parameter| parameter.name == BEGIN);
    assert!(catalogue().into_iter().any(|about| begins(&about)), "the test would pass without effects that begin");
    for robot in ROBOTS {
        let nominal = walk(robot, &Effects::default(), 1);
        for about in fitting(robot).iter().filter(|about| begins(about)) {
            let late = walk(robot, &set(about, far), 1);
            let parted_s = nominal.truth.track.iter().zip(late.truth.track.iter()).find(|(a, b)| a != b);
            let parted_s = parted_s.map(|(pose, _)| pose.t_s - WALK_S / 3.0);
            assert!(
                parted_s.is_some_and(|after_s| (0.0..1.0).contains(&after_s)),
                "{robot}: {} {parted_s:?}",
                about.name
            );
        }
    }
}

#[test]
fn any_two_effects_work_together() {
    for robot in ROBOTS {
        let all = fitting(robot);
        for (i, one) in all.iter().enumerate() {
            for other in &all[i + 1..] {
                let mut both = set(one, far);
                for parameter in other.parameters {
                    both.set(other.name, parameter.name, far(parameter));
                }
                let dataset = walk(robot, &both, 2);
                assert_eq!(
                    dataset.log.sightings.is_empty(),
                    robot == "car",
                    "{robot}: {} and {}",
                    one.name,
                    other.name
                );
                let finite = dataset.truth.track.iter().all(|pose| (pose.x_m + pose.y_m + pose.theta_rad).is_finite());
                assert!(finite, "{robot}: {} and {}", one.name, other.name);
                assert!(dataset != walk(robot, &set(one, far), 2), "{robot}: {} hides {}", one.name, other.name);
            }
        }
    }
}

/// One effect's draws leave every other stream alone: the commands are the same with and without it.
#[test]
fn switching_an_effect_on_leaves_the_policys_draws_alone() {
    for robot in ROBOTS {
        let speeds = |effects: &Effects| -> Vec<f64> {
            let log = walk(robot, effects, 3).log;
            log.commands.iter().filter_map(|row| row.action.forward_m_per_s()).collect()
        };
        let nominal = speeds(&Effects::default());
        for about in fitting(robot) {
            assert_eq!(speeds(&set(about, far)), nominal, "{robot}: {}", about.name);
        }
    }
}
