//! Lets the plain robot explore its field and prints how it fared: what it sees, how often it executes each action,
//! how well it keeps the field, and how far its velocities are from the attempted ones.
//!
//! ```text
//! cargo run --example exploring             # 15 logs of 900 s
//! cargo run --example exploring -- 1 a.svg  # one of them, its way drawn into a file
//! ```

use std::error::Error;
use std::fmt::Write;

use asami_dataset::{Action, Dataset, Seed, Size, TruePose};
use asami_sim::drives::explore::{Explore, Exploring};
use asami_sim::drives::suite::Suite;
use asami_sim::effects::Effects;
use asami_sim::robots::plain::{PlainConfig, PlainWorld};
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::survey::Surveying;
use asami_sim::world::run;

/// Seeds below 1000 belong to the experiments.
const FIRST_SEED: u64 = 1000;
const UNTIL_S: f64 = 900.0;
/// Half the field.
const HALF_M: [f64; 2] = [1.8, 2.7];
const BEACONS_M: [[f64; 2]; 4] = [[1.95, 1.35], [-1.95, 1.35], [-1.95, -1.35], [1.95, -1.35]];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let logs: u64 = arguments.next().map_or(Ok(15), |text| text.parse())?;
    println!("seed  sightings  rows of an action  off the field %  farthest m  heights px");
    for seed in (FIRST_SEED..FIRST_SEED + logs).map(Seed) {
        let mut drive = Explore::new(Exploring::default(), Suite::default().actions(), seed.stream("drive"));
        let dataset = run(&mut world(seed), &mut drive, UNTIL_S);
        println!("{:4}  {}", seed.0, fared(&dataset));
        if let Some(path) = arguments.next() {
            std::fs::write(path, drawn(&dataset.truth.track)?)?;
        }
    }
    let errors = attempted_errors();
    println!("attempted velocities err by {:.1} mm/s, {:.1} mm/s, {:.3} rad/s", errors[0], errors[1], errors[2]);
    Ok(())
}

fn world(seed: Seed) -> PlainWorld {
    let bands = [Colour::Pink, Colour::Yellow];
    let beacons = (0..).zip(BEACONS_M).map(|(id, [x_m, y_m])| Landmark {
        id,
        body: Cylinder { x_m, y_m, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands },
    });
    let field = Field { beacons: beacons.collect(), clutter: vec![] };
    let start = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
    PlainWorld::new(&PlainConfig::default(), &Suite::default(), &field, &Effects::default(), start, seed)
}

/// How far a pose is beyond the field's edge.
fn beyond_m(pose: &TruePose) -> f64 {
    (pose.x_m.abs() - HALF_M[0]).max(pose.y_m.abs() - HALF_M[1])
}

fn fared(dataset: &Dataset) -> String {
    let mut executed = [0; 40];
    for command in dataset.log.commands.iter() {
        if let Action::Legs { id: Some(id), .. } = command.action {
            executed[usize::from(id)] += 1;
        }
    }
    let track = &dataset.truth.track;
    let off = track.iter().filter(|pose| beyond_m(pose) > 0.0).count() as f64 / track.len() as f64;
    let farthest_m = track.iter().map(beyond_m).fold(f64::MIN, f64::max);
    let mut by_height = [0; 5];
    for sighting in dataset.log.sightings.iter() {
        if let Size::HeightPx(height_px) = sighting.size {
            by_height[((height_px / 8.0) as usize).min(4)] += 1;
        }
    }
    let (fewest, most) = (executed.iter().min(), executed.iter().max());
    format!(
        "{:9}  {:8} to {:6}  {:15.1}  {farthest_m:10.2}  0-8-16-24-32: {by_height:?}",
        dataset.log.sightings.len(),
        fewest.unwrap_or(&0),
        most.unwrap_or(&0),
        100.0 * off,
    )
}

/// Root mean squares over the actions: right and forward in mm/s, turn in rad/s.
fn attempted_errors() -> [f64; 3] {
    let survey = world(Seed(FIRST_SEED)).survey(&Surveying::default());
    let mut squares = [0.0; 3];
    for (action, truth) in Suite::default().actions().into_iter().zip(&survey.velocity_by_action) {
        let Action::Legs { ax_m_per_s, ay_m_per_s, atheta_rad_per_s, .. } = action else { continue };
        squares[0] += (1e3 * (truth.vx_m_per_s - ax_m_per_s)).powi(2) / 40.0;
        squares[1] += (1e3 * (truth.vy_m_per_s - ay_m_per_s)).powi(2) / 40.0;
        squares[2] += (truth.vtheta_rad_per_s - atheta_rad_per_s).powi(2) / 40.0;
    }
    squares.map(f64::sqrt)
}

/// The way over the field, y up, a grey for each five seconds; a stroke shows every second's heading.
fn drawn(track: &[TruePose]) -> Result<String, std::fmt::Error> {
    let at = |x_m: f64, y_m: f64| (160.0 * (x_m + 2.5), 160.0 * (3.4 - y_m));
    let mut svg = String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 800 1088\" fill=\"none\">\n");
    let (left, top) = at(-HALF_M[0], HALF_M[1]);
    let [width, height] = HALF_M.map(|half_m| 320.0 * half_m);
    writeln!(svg, "<rect width=\"800\" height=\"1088\" fill=\"white\"/>")?;
    writeln!(svg, "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" stroke=\"green\"/>")?;
    for (x, y) in BEACONS_M.map(|[x_m, y_m]| at(x_m, y_m)) {
        writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"8\" fill=\"deeppink\"/>")?;
    }
    for (i, phase) in track.chunks(100).enumerate() {
        let grey = [40, 110, 170][i % 3];
        write!(svg, "<path stroke=\"rgb({grey},{grey},{grey})\" d=\"M")?;
        for (x, y) in phase.iter().map(|pose| at(pose.x_m, pose.y_m)) {
            write!(svg, " {x:.1} {y:.1}")?;
        }
        writeln!(svg, "\"/>")?;
        for pose in phase.iter().step_by(20) {
            let ((x, y), (sin, cos)) = (at(pose.x_m, pose.y_m), pose.theta_rad.sin_cos());
            let (tip_x, tip_y) = (x - 9.0 * sin, y - 9.0 * cos);
            writeln!(svg, "<path stroke=\"orangered\" d=\"M {x:.1} {y:.1} {tip_x:.1} {tip_y:.1}\"/>")?;
        }
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}
