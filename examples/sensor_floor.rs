//! What a recorded scenario's learner makes of sightings as perfect as motion capture has them: the same landmarks,
//! seen at the same times from where the robot was, without errors or with white ones of the size that the learner
//! finds in the real sightings. What errs then is not the sensor: it is how the commands are cut into actions, and
//! that the robot is seen too seldom. A yardstick, no learner: it uses the truth.
//!
//! `cargo run --example sensor_floor -- scenarios/mrclam.toml em_robust attempted`

use std::path::Path;

use asami::scenario::{self, Origin, Row};
use asami::scorer::plane::Yardstick;
use asami::sweep::source::{Recorded, Source};
use asami_dataset::truth::pose_at;
use asami_dataset::{Beacon, Dataset, Log, Models, Rng, Seed, Sighting, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, ln, sin_cos};
use rand::RngExt;

/// Noise of sightings as good as perfect, m and rad: not zero, since a learner divides by it.
const HARDLY: [f64; 2] = [0.003, 0.0005];

/// Draws of white noise.
const DRAWS: u64 = 5;

type Error = Box<dyn std::error::Error>;

fn main() -> Result<(), Error> {
    let mut args = std::env::args().skip(1);
    let mut next = || args.next().ok_or("usage: sensor_floor SCENARIO LEARNER START");
    let (path, learner, start) = (next()?, next()?, next()?);
    let scenario = scenario::read(Path::new(&path)).map_err(|bad| format!("{bad:?}"))?;
    let Origin::Recorded(recording) = &scenario.origin else { return Err("the scenario is simulated".into()) };
    let source = Recorded::open(recording, Path::new(&recording.source)).map_err(|report| report.to_string())?;
    let has = |row: &&Row| row.learner == learner && row.start.is_some_and(|it| it.name() == start);
    let row = scenario.rows.iter().find(has).ok_or("no row of the scenario has this learner and start")?;
    let start = row.start.ok_or("the row has no start")?;
    let learner = scenario.learners.configured(&learner, &row.with).map_err(|faults| format!("{faults:?}"))?;
    let learn = |log: &Log| -> Result<Models, Error> {
        let given = scenario.starting.models(start, log)?;
        Ok(learner.learn(log, &given, &mut Seed(1).stream("learner"))?.models)
    };

    println!("error of forward speed, mm/s and % of range: real sightings; perfect ones; perfect but for white noise");
    for case in source.cases() {
        let Dataset { log, truth, .. } = source.dataset(&case)?;
        let yardstick = Yardstick::of(&log, &truth);
        let range = yardstick.velocity_ranges().ok_or("there is no truth about velocities")?[1];
        let error = |models: &Models| yardstick.score(models).velocity_rmse.map(|rmse| rmse[1]);
        let shown = |error: f64| format!("{:6.2} {:5.1} %", 1e3 * error, 1e2 * error / range);
        let real = learn(&log)?;
        let seen = |noise: [f64; 2], seed: u64| {
            let pose = |t_s| pose_at(&truth.track, t_s).map(|pose| [pose.x_m, pose.y_m, pose.theta_rad]);
            error(&learn(&as_it_was(&log, pose, noise, &mut Seed(seed).stream("sightings"))).ok()?)
        };
        let found = [real.noise.sigma1_m.unwrap_or_default(), real.noise.sigma2_rad.unwrap_or_default()];
        let noisy: Vec<f64> = (1..=DRAWS).filter_map(|seed| seen(found, seed)).collect();
        let mean = noisy.iter().sum::<f64>() / noisy.len() as f64;
        let (real, perfect) = (error(&real).unwrap_or(f64::NAN), seen(HARDLY, 1).unwrap_or(f64::NAN));
        println!("robot {}: {}; {}; {}", case.robot.unwrap_or(0), shown(real), shown(perfect), shown(mean));
    }
    Ok(())
}

/// The log up to where the track ends, with each sighting as it would be from the true pose, but for white noise.
fn as_it_was(log: &Log, pose: impl Fn(f64) -> Option<[f64; 3]>, noise: [f64; 2], rng: &mut Rng) -> Log {
    let place = |id: u16| log.known.landmarks.iter().find(|beacon| beacon.id == id);
    let mut last_s = f64::NEG_INFINITY;
    let mut as_it_was = |seen: &Sighting| {
        let (&Beacon { x_m, y_m, .. }, [x, y, theta_rad]) = (place(seen.landmark)?, pose(seen.t_s)?);
        last_s = seen.t_s;
        // Heading 0 faces +y.
        let (dx_m, dy_m) = (x_m - x, y_m - y);
        let bearing_rad = wrap_rad(atan2(-dx_m, dy_m) - theta_rad + noise[1] * normal(rng));
        let size = Size::RangeM((dx_m * dx_m + dy_m * dy_m).sqrt() + noise[0] * normal(rng));
        Some(Sighting { size, bearing_rad, ..*seen })
    };
    let sightings: Vec<Sighting> = log.sightings.iter().filter_map(&mut as_it_was).collect();
    let start_s = log.span_s().map_or(0.0, |(start_s, _)| start_s);
    Log { sightings: sightings.into(), ..log.clone() }.window(start_s..last_s + 1.0)
}

/// A standard normal number (Box and Muller 1958).
fn normal(rng: &mut Rng) -> f64 {
    let radius = (-2.0 * ln(1.0 - rng.random::<f64>())).sqrt();
    radius * sin_cos(std::f64::consts::TAU * rng.random::<f64>()).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use asami_dataset::{Action, Command, Known};

    #[test]
    fn sightings_are_as_the_pose_has_them_and_end_with_the_track() {
        let landmarks = vec![Beacon { id: 7, x_m: -2.0, y_m: 1.0, height_m: None }];
        let seen = |t_s| Sighting { t_s, landmark: 7, size: Size::RangeM(9.0), bearing_rad: 0.0 };
        let action = Action::Wheels { id: Some(0), v_m_per_s: 0.0, omega_rad_per_s: 0.0 };
        let log = Log {
            known: Known { landmarks, ..Known::default() }.into(),
            commands: vec![Command { t_s: 0.0, action }].into(),
            sightings: vec![seen(1.0), seen(5.0)].into(),
            ..Log::default()
        };
        // At (1, 1), first facing +y, which has the landmark to the left; the track ends before the second sighting.
        let pose = |t_s: f64| (t_s < 2.0).then_some([1.0, 1.0, 0.0]);
        let made = as_it_was(&log, pose, [0.0; 2], &mut Seed(1).stream("sightings"));
        assert_eq!(made.sightings.len(), 1);
        assert!((made.sightings[0].size.value() - 3.0).abs() < 1e-12);
        assert!((made.sightings[0].bearing_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}
