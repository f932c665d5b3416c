//! What a report shows of a simulated robot: simulated for the page, and never given to a learner.

use asami_dataset::{Action, Command, Dataset, Log, Seed};
use asami_sim::robots::aibo::watch::{Contacts, Outline, Watch};
use asami_sim::robots::aibo::{AiboWorld, Start};
use asami_sim::world::{Record, World};

use super::{Plate, one_at_a_time, scans};
use crate::draw::walk::{Part, Pose, Strip, contacts};
use crate::draw::{Figure, Picture};
use crate::scenario::Simulation;
use crate::simulate::CannotSimulate;

/// Where the walk begins, in front of the first beacon.
const FROM_M: f64 = 3.5;
/// Where it ends.
const TO_M: f64 = 1.3;
/// The one command of the walk.
const COMMAND_M_PER_S: f64 = 0.2;
/// The walk's longest duration, should the robot not get there.
const AT_MOST_S: f64 = 60.0;
/// So much of a log holds a cycle to the beacon and back.
const CYCLE_WITHIN_S: f64 = 90.0;
/// When the strip and the contacts begin: the gait is steady by then.
const STEADY_S: f64 = 4.0;
/// In the midst of so much of a drive the car is under way.
const UNDER_WAY_S: f64 = 24.0;
/// Poses of a strip.
const POSES: usize = 9;

/// Figures of a scenario's robot; empty where it is not simulated.
#[derive(Clone, Debug, Default)]
pub struct Exhibits {
    /// The walk: poses, contacts, what the camera sees.
    pub walk: Vec<Plate>,
    /// What a laser scanner sees: Figures 2.4b and 5.2.
    pub scans: Vec<Plate>,
    /// One model learned from the other: Figures 3.5 and 3.6.
    pub single: Vec<Figure>,
}

/// Simulates what is shown of a scenario's robot.
///
/// # Errors
/// If the robot cannot be built.
pub fn of(simulation: &Simulation) -> Result<Exhibits, CannotSimulate> {
    let seed = Seed(simulation.first_seed);
    let (approach, pacing) = rayon::join(|| approach(simulation, seed), || pacing(simulation, seed));
    let (approach, pacing) = (approach?, pacing?);
    let single = one_at_a_time::figures(&approach.log, &pacing.log);
    Ok(Exhibits { single, walk: approach.plates(), ..Exhibits::default() })
}

/// What a car's scanner sees in the midst of the beginning of the scenario's first drive.
///
/// # Errors
/// If the car cannot be built.
pub fn of_car(simulation: &Simulation) -> Result<Exhibits, CannotSimulate> {
    let beginning = Simulation { duration_s: simulation.duration_s.min(UNDER_WAY_S), ..simulation.clone() };
    let Dataset { log, truth, .. } = beginning.dataset(Seed(simulation.first_seed))?;
    let angles_rad = truth.survey.map_or(Vec::new(), |survey| survey.horizontal_angles_rad);
    Ok(Exhibits { scans: scans::plates(&log, &angles_rad), ..Exhibits::default() })
}

/// The beginning of the scenario's first log.
fn pacing(simulation: &Simulation, seed: Seed) -> Result<Dataset, CannotSimulate> {
    let beginning = Simulation { duration_s: simulation.duration_s.min(CYCLE_WITHIN_S), ..simulation.clone() };
    beginning.dataset(seed)
}

/// A walk towards the first beacon under one command.
struct Approach {
    log: Log,
    watch: Watch,
    /// Unit vector of the walk in the world.
    forward: [f64; 2],
    /// Distance and image when the walk begins and when it ends.
    views: Vec<(f64, Picture)>,
}

fn approach(simulation: &Simulation, seed: Seed) -> Result<Approach, CannotSimulate> {
    let theta_rad = simulation.start.theta_rad;
    let forward = [-theta_rad.sin(), theta_rad.cos()];
    let beacon_m = simulation.field.beacons.first().map_or([0.0, 0.0], |beacon| [beacon.body.x_m, beacon.body.y_m]);
    let [x_m, y_m] = [0, 1].map(|axis| beacon_m[axis] - FROM_M * forward[axis]);
    let start = Start { x_m, y_m, theta_rad, ..Start::default() };
    let mut world = simulation.aibo_at(start, seed)?;
    let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: COMMAND_M_PER_S, atheta_rad_per_s: 0.0 };
    let (mut record, mut views) = (Record::default(), Vec::new());
    record.seen.commands.push(Command { t_s: 0.0, action });
    world.watch();
    let distance_m = |world: &AiboWorld| {
        let pose = world.pose();
        (beacon_m[0] - pose.x_m).hypot(beacon_m[1] - pose.y_m)
    };
    while world.t_s() < AT_MOST_S && distance_m(&world) > TO_M && !world.has_fallen() {
        world.tick(action, &mut record);
        if views.is_empty() && world.t_s() >= 1.0 {
            views.push(view(&world, distance_m(&world)));
        }
    }
    views.push(view(&world, distance_m(&world)));
    let watch = world.watched().cloned().unwrap_or_default();
    let log = Log { commands: record.seen.commands.into(), sightings: record.seen.sightings.into(), ..Log::default() };
    Ok(Approach { log, watch, forward, views })
}

fn view(world: &AiboWorld, distance_m: f64) -> (f64, Picture) {
    let image = world.image();
    let (width_px, height_px) = (image.width_px() as u32, image.height_px() as u32);
    (distance_m, Picture::new("Camera", "What the camera sees", width_px, height_px, image.to_rgb()))
}

impl Approach {
    fn plates(&self) -> Vec<Plate> {
        let mut plates = vec![Plate::from(&self.strip()), Plate::from(&self.feet())];
        plates.extend(self.views.iter().map(|(distance_m, picture)| {
            let mut picture = picture.clone();
            picture.name = format!("Camera at {distance_m:.1} m");
            picture.title = format!("The camera, {distance_m:.1} m before the beacon");
            Plate::from(&picture.caption(
                "One frame as the vision gets it: the beacon's two bands on a white post, carpet and wall, blurred and \
                 noisy. Its height in pixels is all that chapter 3 learns from.",
            ))
        }));
        plates
    }

    fn strip(&self) -> Strip {
        let steady = self.watch.outlines.iter().filter(|outline| outline.t_s >= STEADY_S).take(POSES);
        Strip {
            name: "The walk, side view".to_owned(),
            title: format!("Walking at a commanded {} mm/s, frame by frame", 1e3 * COMMAND_M_PER_S),
            caption: "Poses of the body as the physics engine has them, one camera frame apart, right side in front; \
                      dots are feet that press on the ground. Good: diagonal legs move together, the body stays \
                      level, and feet leave the ground between steps. A body that sinks or feet that never lift ask \
                      for a look at the gait."
                .to_owned(),
            poses: steady.map(|outline| self.pose(outline)).collect(),
        }
    }

    fn pose(&self, outline: &Outline) -> Pose {
        let side = |point: &[f64; 3]| [point[0] * self.forward[0] + point[1] * self.forward[1], point[2]];
        let part = |line: &asami_sim::robots::aibo::watch::Line| Part {
            corners_m: line.points_m.iter().map(side).collect(),
            solid: matches!(line.part, "torso" | "head"),
            far: matches!(line.part, "fl" | "hl"),
        };
        let held = self.watch.contacts.partition_point(|contacts| contacts.t_s <= outline.t_s);
        let down = held.checked_sub(1).map_or([false; 4], |index| self.watch.contacts[index].down);
        let feet = ["fl", "fr", "hl", "hr"].into_iter().zip(down).filter(|(_, down)| *down);
        let foot = |name: &str| outline.lines.iter().find(|line| line.part == name)?.points_m.last().map(side);
        Pose {
            t_s: outline.t_s,
            parts: outline.lines.iter().map(part).collect(),
            contacts_m: feet.filter_map(|(name, _)| foot(name)).collect(),
        }
    }

    fn feet(&self) -> Figure {
        let steady = |contacts: &&Contacts| (STEADY_S..STEADY_S + 3.0).contains(&contacts.t_s);
        let samples: Vec<_> = self.watch.contacts.iter().filter(steady).map(|it| (it.t_s, it.down)).collect();
        contacts("Feet on the ground", "Which foot stands when", &samples).caption(
            "Contact of each foot with the ground, as the physics engine finds it; diagonals have one colour. Good: \
             the two diagonals take turns, as in a trot. Bars in splinters are feet that bounce or scrape.",
        )
    }
}
