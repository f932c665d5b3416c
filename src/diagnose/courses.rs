//! Ways to drive a scenario's robot that differ from its own by a key of their policy's table.

use std::sync::OnceLock;

use asami_dataset::{Log, Seed};
use asami_gap::answer::experiment::{Course, Courses};
use asami_gap::library::play;
use asami_sim::drives::explore::Exploring;
use asami_sim::drives::pace::Pacing;
use asami_sim::drives::roam::Roaming;
use rayon::prelude::*;

use crate::scenario::{Policy, Roams, Simulation};

/// Seeds of the logs that courses are judged by: no case has them.
const SEEDS: [Seed; 3] = [Seed(7_900_000_000), Seed(7_900_000_001), Seed(7_900_000_002)];
/// For how long commands are held, s.
const HOLDS_S: [f64; 5] = [0.25, 0.5, 1.0, 2.5, 8.0];
/// Share of a field's extent that is a small one.
const INNER: f64 = 0.45;

/// The courses of a nominal world, played once they are asked for.
pub struct Played {
    simulation: Simulation,
    length_s: f64,
    courses: OnceLock<Vec<Course>>,
    again: OnceLock<Vec<Log>>,
}

impl Played {
    /// Of logs of this length.
    #[must_use]
    pub fn new(simulation: &Simulation, length_s: f64) -> Self {
        Self { simulation: simulation.clone(), length_s, courses: OnceLock::new(), again: OnceLock::new() }
    }

    /// Plays all of them now. Threads that share work must not wait for one another to play them: the one that plays may
    /// meanwhile be given work that waits for itself.
    pub fn play_ahead(&self) {
        self.courses();
        self.again();
    }

    /// The world driven as these keys have it.
    #[must_use]
    pub fn driven(&self, keys: &str) -> Option<Simulation> {
        ways(&self.simulation).into_iter().find(|way| way.keys == keys).map(|way| self.driving(way.drive))
    }

    fn driving(&self, drive: Policy) -> Simulation {
        Simulation { drive, ..self.simulation.clone() }
    }

    fn play(&self, way: Way) -> Option<Course> {
        Some(Course { words: way.words, keys: way.keys, logs: self.logs(way.drive)? })
    }

    fn logs(&self, drive: Policy) -> Option<Vec<Log>> {
        let world = self.driving(drive);
        // An engine with contacts takes seconds a log.
        let seeds = if world.robot.name() == "plain" { &SEEDS[..] } else { &SEEDS[..1] };
        seeds.iter().map(|seed| play(&world, &[], *seed, self.length_s).ok().map(|played| played.log)).collect()
    }
}

impl Courses for Played {
    fn courses(&self) -> &[Course] {
        self.courses.get_or_init(|| ways(&self.simulation).into_par_iter().filter_map(|way| self.play(way)).collect())
    }

    fn again(&self) -> &[Log] {
        self.again.get_or_init(|| self.logs(self.simulation.drive.clone()).unwrap_or_default())
    }
}

/// A course that is not played yet.
struct Way {
    words: String,
    keys: String,
    drive: Policy,
}

/// Commands held for other times than its own.
fn held(table: &str, own_s: f64, drive: impl Fn(f64) -> Policy) -> Vec<Way> {
    let way = |hold_s: f64| Way {
        words: format!("with each command held for {hold_s} s"),
        keys: format!("{table}.hold_s = {hold_s}"),
        drive: drive(hold_s),
    };
    HOLDS_S.into_iter().filter(|hold_s| *hold_s != own_s).map(way).collect()
}

fn ways(simulation: &Simulation) -> Vec<Way> {
    match &simulation.drive {
        Policy::Explore(own) => explored(own),
        Policy::Pace(own) => paced(own, &Policy::Pace),
        Policy::Stride(own) => paced(own, &Policy::Stride),
        Policy::Roam(own) => roamed(own),
        // A person who drives through traffic does not choose.
        Policy::Route(_) => Vec::new(),
    }
}

/// On the whole field and the inner part of it, commands held for all times.
fn explored(own: &Exploring) -> Vec<Way> {
    let mut ways = held("explore", own.hold_s, |hold_s| Policy::Explore(Exploring { hold_s, ..own.clone() }));
    let [field_x_m, field_y_m] = [own.field_x_m, own.field_y_m].map(|it| (100.0 * INNER * it).round() / 100.0);
    let inner = Exploring { field_x_m, field_y_m, ..own.clone() };
    let place = format!("in the inner {field_x_m} by {field_y_m} m of the field");
    let keys = format!("explore.field_x_m = {field_x_m}, explore.field_y_m = {field_y_m}");
    let held_there = held("explore", own.hold_s, |hold_s| Policy::Explore(Exploring { hold_s, ..inner.clone() }));
    ways.extend(held_there.into_iter().map(|way| Way {
        words: format!("{} {place}", way.words),
        keys: format!("{}, {keys}", way.keys),
        ..way
    }));
    ways.push(Way { words: place, keys, drive: Policy::Explore(inner) });
    ways
}

/// Commands of a wheeled robot held for other times than its own, and slower ones.
fn roamed(own: &Roams) -> Vec<Way> {
    let with = |roaming: Roaming| Policy::Roam(Box::new(Roams { roaming, ..own.clone() }));
    let held = HOLDS_S.into_iter().map(|hold_s| Way {
        words: format!("with each command held for {hold_s} s"),
        keys: format!("roam.least_hold_s = {hold_s}, roam.most_hold_s = {hold_s}"),
        drive: with(Roaming { least_hold_s: hold_s, most_hold_s: hold_s, ..own.roaming.clone() }),
    });
    let most_m_per_s = (100.0 * 0.25 * own.roaming.most_m_per_s).round() / 100.0;
    let slow = Way {
        words: format!("no faster than {most_m_per_s} m/s"),
        keys: format!("roam.most_m_per_s = {most_m_per_s}"),
        drive: with(Roaming { most_m_per_s: most_m_per_s.max(0.01), ..own.roaming.clone() }),
    };
    held.chain([slow]).collect()
}

/// Held for other times, and near the beacon or far from it alone.
fn paced(own: &Pacing, policy: &dyn Fn(Pacing) -> Policy) -> Vec<Way> {
    let mut ways = held("drive", own.hold_s, |hold_s| policy(Pacing { hold_s, ..own.clone() }));
    let between_px = ((own.near_height_px * own.far_height_px).sqrt() * 10.0).round() / 10.0;
    let near = ("far_height_px", "near the beacon", Pacing { far_height_px: between_px, ..own.clone() });
    let far = ("near_height_px", "far from the beacon", Pacing { near_height_px: between_px, ..own.clone() });
    ways.extend([near, far].map(|(key, words, pacing)| Way {
        words: format!("walking to and fro {words} alone"),
        keys: format!("drive.{key} = {between_px}"),
        drive: policy(pacing),
    }));
    ways
}
