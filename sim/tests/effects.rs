//! One suite over the whole catalogue of effects: at null an effect changes no bit of a log, off null
//! it does, and any two of them work together. Those of the car have their own suite, `effects_car`.

mod catalogue;

use asami_dataset::{Action, Dataset, Rng, Seed, TruePose};
use asami_sim::drives::suite::Suite;
use asami_sim::effect::{About, Draw, Way};
use asami_sim::effects::{self, Effects};
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, Start};
use asami_sim::robots::create::{CreateConfig, CreateWorld};
use asami_sim::robots::plain::{PlainConfig, PlainWorld};
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::world::{Drive, Seen, World, run};
use catalogue::{BEGIN, LARGE, null, plant, planted};
use rand::RngExt;

/// Long enough for several strides, a change of command and a dozen dozen frames.
const WALK_S: f64 = 6.0;

/// The robots that have a world: each must bear every effect that fits it.
const ROBOTS: [&str; 4] = ["aibo", "plain", "create", SCANNING];
/// The third of them, with a scanner in place of a camera.
const SCANNING: &str = "create with a scanner";
/// What of its effects only a camera has, and what only a scanner.
const OF_CAMERAS: [&str; 2] = ["focal_error", "lens_distortion"];
const OF_SCANNERS: [&str; 2] = ["encoder_eccentricity", "bearing_scale"];

/// Effects that fit a robot, and its sensor.
fn fitting(robot: &str) -> Vec<&'static About> {
    let (name, others) = match robot {
        SCANNING => ("create", OF_CAMERAS),
        _ => (robot, OF_SCANNERS),
    };
    catalogue::fitting(name).into_iter().filter(|about| !others.contains(&about.name)).collect()
}

fn walk(robot: &str, effects: &Effects, seed: u64) -> Dataset {
    walk_until(robot, effects, seed, WALK_S)
}

fn walk_until(robot: &str, effects: &Effects, seed: u64, until_s: f64) -> Dataset {
    let seed = Seed(seed);
    let mut drive = Wander { rng: seed.stream("drive"), current: None, robot: robot.to_owned() };
    run(&mut *world(robot, effects, seed), &mut drive, until_s)
}

fn world(robot: &str, effects: &Effects, seed: Seed) -> Box<dyn World> {
    let bands = [Colour::Pink, Colour::Yellow];
    let body = Cylinder { x_m: 0.0, y_m: 0.0, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands };
    let field = Field { beacons: vec![Landmark { id: 0, body }], clutter: Vec::new() };
    if robot == "plain" {
        let (config, suite) = (PlainConfig::default(), Suite::default());
        let start = TruePose { t_s: 0.0, x_m: 0.0, y_m: -2.0, theta_rad: 0.0, v_m_per_s: None };
        return Box::new(PlainWorld::new(&config, &suite, &field, effects, start, seed));
    }
    if robot.starts_with("create") {
        let mut config = CreateConfig::default();
        config.sight.view_rad = if robot == SCANNING { 4.2 } else { 2.0 };
        config.sight.recognised = 0.9;
        let start = TruePose { t_s: 0.0, x_m: 0.0, y_m: -2.0, theta_rad: 0.0, v_m_per_s: None };
        return Box::new(CreateWorld::new(&config, &field, effects, start, seed).expect("the shipped robot"));
    }
    let start = Start { y_m: -2.0, ..Start::default() };
    let (config, camera) = (AiboConfig::default(), CameraConfig::default());
    Box::new(AiboWorld::new(&config, &field, &camera, effects, start, seed).expect("the shipped robot"))
}

/// Commands of all three parts at once, new every 1.5 s; before each a robot on wheels stands for a while.
struct Wander {
    rng: Rng,
    current: Option<(f64, Action)>,
    robot: String,
}

impl Drive for Wander {
    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let (since_s, action) = self.current.unwrap_or_else(|| (t_s, self.draw()));
        self.current = Some((since_s, action));
        if t_s - since_s >= 1.5 {
            self.current = None;
        }
        if self.robot.starts_with("create") && t_s - since_s >= 1.1 {
            return Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s: 0.0 };
        }
        action
    }
}

impl Wander {
    fn draw(&mut self) -> Action {
        let [a, b, c] = [(); 3].map(|()| 2.0 * self.rng.random::<f64>() - 1.0);
        if self.robot.starts_with("create") {
            return Action::Wheels { id: None, v_m_per_s: 0.25 + 0.25 * b, omega_rad_per_s: 0.4 * c };
        }
        // The plain robot's whole range, and a stroll of the Aibo's.
        let [right, forward, turn] = if self.robot == "plain" { [0.35, 0.4, 3.0] } else { [0.06, 0.2, 0.4] };
        Action::Legs { id: None, ax_m_per_s: right * a, ay_m_per_s: forward * b, atheta_rad_per_s: turn * c }
    }
}

#[test]
fn the_catalogue_is_complete_and_says_what_it_is() {
    let fitting = ROBOTS.map(|robot| fitting(robot).len());
    assert!(fitting[0] >= 22 && fitting[1] >= 15 && fitting[2] >= 18, "most tests here pass on an empty list");
    for about in effects::catalogue() {
        assert!(!about.what.is_empty() && !about.source.is_empty() && !about.fits.is_empty(), "{}", about.name);
        assert!(!about.parameters.is_empty(), "{}", about.name);
        for parameter in about.parameters {
            let (least, greatest) = parameter.range;
            assert!(least < greatest && (least..=greatest).contains(&parameter.default), "{}", parameter.name);
            assert!(!parameter.about.is_empty() && !parameter.unit.is_empty(), "{}", parameter.name);
            let unit = parameter.unit.strip_prefix('1').unwrap_or(parameter.unit);
            let tail = unit.replace('/', "_per_").replace('.', "_").replace('^', "").to_lowercase();
            assert!(parameter.name.ends_with(&tail), "{} carries no unit {}", parameter.name, parameter.unit);
        }
        let null = null(about);
        assert!(null.iter().all(asami_sim::effect::Effect::is_null), "{}", about.name);
        assert_eq!(null.iter().count(), 1, "{}", about.name);
        assert_eq!(null.without(about.name), Effects::default(), "{}", about.name);
        assert!(!Effects::default().set(about.name, "no_such_parameter", 0.0), "{}", about.name);
        assert!(!planted(about, 0.0).iter().any(asami_sim::effect::Effect::is_null), "{}", about.name);
    }
}

/// Exactly one size, and nothing that a law draws leaves its range.
#[test]
fn laws_stay_in_range_from_least_to_greatest() {
    for about in effects::catalogue() {
        let name = about.name;
        let sizes: Vec<(f64, f64, Way)> = about
            .law
            .iter()
            .filter_map(|(_, draw)| match *draw {
                Draw::Size { way, least, greatest } => Some((least, greatest, way)),
                _ => None,
            })
            .collect();
        let [(least, greatest, way)] = sizes[..] else { panic!("{name} has {} sizes", sizes.len()) };
        assert!(0.0 < least && 3.0 * least < greatest, "{name}: {least} to {greatest}");
        for (parameter, draw) in about.law {
            let parameter = about.parameters.iter().find(|it| it.name == *parameter);
            let parameter = parameter.unwrap_or_else(|| panic!("{name} draws what it has not"));
            let null = parameter.default;
            let drawn = match draw {
                Draw::Choice(values) | Draw::Landmark(values) => values.to_vec(),
                _ => [(Way::Up, 1.0), (Way::Down, -1.0)]
                    .into_iter()
                    .filter(|(to, _)| way == Way::Either || way == *to)
                    .flat_map(|(_, sign)| [null + sign * least, null + sign * greatest])
                    .collect(),
            };
            let (low, high) = parameter.range;
            assert!(!drawn.is_empty(), "{name}.{}", parameter.name);
            for value in drawn {
                assert!((low..=high).contains(&value), "{name}.{} is drawn at {value}", parameter.name);
            }
        }
    }
}

#[test]
fn at_null_no_bit_changes_and_off_null_the_log_does() {
    for robot in ROBOTS {
        let nominal = walk(robot, &Effects::default(), 1);
        for about in fitting(robot) {
            assert!(walk(robot, &null(about), 1) == nominal, "{} at null changes the log of {robot}", about.name);
            let other = walk(robot, &planted(about, LARGE), 1);
            assert!(other.log != nominal.log, "{} changes nothing of {robot}", about.name);
            // The robot is told nothing.
            assert_eq!(other.log.known, nominal.log.known, "{robot} knows of {}", about.name);
        }
    }
}

/// Every parameter but the beginning counts for something once the effect is there.
#[test]
fn every_parameter_counts() {
    for (robot, about) in ["plain", "create", SCANNING]
        .into_iter()
        .flat_map(|robot| fitting(robot).into_iter().map(move |it| (robot, it)))
    {
        let large = planted(about, LARGE);
        let drawn = walk(robot, &large, 1);
        let values: Vec<f64> = large.iter().flat_map(|effect| effect.values()).collect();
        for (parameter, value) in about.parameters.iter().zip(values).filter(|(it, _)| it.name != BEGIN) {
            let (least, greatest) = parameter.range;
            let mut other = large.clone();
            other.set(about.name, parameter.name, if value == least { greatest } else { least });
            // With one landmark it does not matter which; and wheels do not go sideways.
            let exempt = parameter.name == "number" || (robot.starts_with("create") && parameter.name == "x_ratio");
            let differs = walk(robot, &other, 1).log != drawn.log || exempt;
            assert!(differs, "{robot}: {}.{} changes nothing", about.name, parameter.name);
        }
    }
}

#[test]
fn before_it_begins_an_effect_changes_no_bit() {
    let begins = |about: &&About| about.parameters.iter().any(|parameter| parameter.name == BEGIN);
    assert!(
        effects::catalogue().into_iter().any(|about| begins(&about)),
        "the test would pass without effects that begin"
    );
    for robot in ROBOTS {
        let nominal = walk(robot, &Effects::default(), 1);
        for about in fitting(robot).iter().filter(|about| begins(about)) {
            let mut late = planted(about, LARGE);
            late.set(about.name, BEGIN, WALK_S / 3.0);
            let late = walk(robot, &late, 1);
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

/// All pairs where a walk costs little; of the Aibo, each effect with the next two of the catalogue.
#[test]
fn any_two_effects_work_together() {
    for robot in ROBOTS {
        let (all, until_s) = (fitting(robot), if robot == "aibo" { 2.0 } else { WALK_S });
        let alone: Vec<Dataset> = all.iter().map(|one| walk_until(robot, &planted(one, LARGE), 2, until_s)).collect();
        for (i, one) in all.iter().enumerate() {
            let others = if robot == "aibo" { 2 } else { all.len() };
            for (j, other) in all.iter().enumerate().skip(i + 1).take(others) {
                let mut both = planted(one, LARGE);
                plant(&mut both, other, LARGE);
                let dataset = walk_until(robot, &both, 2, until_s);
                let pair = format!("{robot}: {} and {}", one.name, other.name);
                assert!(!dataset.log.sightings.is_empty(), "{pair}");
                let finite = dataset.truth.track.iter().all(|pose| (pose.x_m + pose.y_m + pose.theta_rad).is_finite());
                assert!(finite, "{pair}");
                // What one makes of commands may be none of what this walk is told.
                let another_shows = || {
                    (3..30).any(|seed| {
                        let [both, one, other] = [&both, &planted(one, LARGE), &planted(other, LARGE)]
                            .map(|effects| walk_until(robot, effects, seed, until_s));
                        both != one && both != other
                    })
                };
                let shows = dataset != alone[i] && dataset != alone[j];
                assert!(shows || another_shows(), "{pair}: one hides the other");
            }
        }
    }
}

/// One effect's draws leave every other stream alone: the commands are the same with and without it.
#[test]
fn switching_an_effect_on_leaves_the_policys_draws_alone() {
    for robot in ROBOTS {
        let speeds = |effects: &Effects| -> Vec<f64> {
            let log = walk_until(robot, effects, 3, 3.0).log;
            log.commands.iter().filter_map(|row| row.action.forward_m_per_s()).collect()
        };
        let nominal = speeds(&Effects::default());
        for about in fitting(robot) {
            assert_eq!(speeds(&planted(about, LARGE)), nominal, "{robot}: {}", about.name);
        }
    }
}
