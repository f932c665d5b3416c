//! Where a recorded scenario's first learner finds the log most likely: over the delay of the commands, and over the
//! axis of each robot's camera. Needs no truth.
//!
//! `cargo run --example camera_axis -- scenarios/mrclam.toml`

use std::path::Path;

use asami::binning::Binning;
use asami::depths::Depths;
use asami::scenario::{self, Origin, Recording, Scenario};
use asami::sweep::source::{Recorded, Source};
use asami_dataset::{Seed, Size};
use asami_math::elementary::{ln, sin_cos};

const AXES_RAD: [f64; 9] = [-0.06, -0.045, -0.03, -0.015, 0.0, 0.015, 0.03, 0.045, 0.06];
const DELAYS_S: [f64; 5] = [0.0, 0.1, 0.2, 0.3, 0.4];

type Error = Box<dyn std::error::Error>;

fn main() -> Result<(), Error> {
    let path = std::env::args().nth(1).ok_or("usage: camera_axis SCENARIO")?;
    let scenario = scenario::read(Path::new(&path)).map_err(|bad| format!("{bad:?}"))?;
    let Origin::Recorded(recording) = &scenario.origin else { return Err("the scenario is simulated".into()) };
    let robots = recording.parts.len();
    let shown = |row: &[f64]| row.iter().map(|value| format!("{value:10.1}")).collect::<String>();

    println!("log-likelihood, by robot and by delay of the commands {DELAYS_S:?} s");
    let mut by_delay = vec![Vec::new(); robots];
    for delay_s in DELAYS_S {
        let binning = Binning { delay_s: Some(delay_s), ..recording.binning.clone().unwrap_or_default() };
        let found = likelihoods(&scenario, &Recording { binning: Some(binning), ..(**recording).clone() })?;
        by_delay.iter_mut().zip(found).for_each(|(row, value)| row.push(value));
    }
    by_delay.iter().for_each(|row| println!("{}   greatest at {:.2} s", shown(row), peak(&DELAYS_S, row)));

    println!("log-likelihood, by robot and by axis {AXES_RAD:?} rad");
    let mut by_axis = vec![Vec::new(); robots];
    for axis_rad in AXES_RAD {
        let depths = Some(Depths { axis_rad: vec![axis_rad] });
        let found = likelihoods(&scenario, &Recording { depths, ..(**recording).clone() })?;
        by_axis.iter_mut().zip(found).for_each(|(row, value)| row.push(value));
    }
    by_axis.iter().for_each(|row| println!("{}   greatest at {:.3} rad", shown(row), peak(&AXES_RAD, row)));
    Ok(())
}

/// The greatest log-likelihood that the scenario's first row reaches for each part of the recording.
fn likelihoods(scenario: &Scenario, recording: &Recording) -> Result<Vec<f64>, Error> {
    let source = Recorded::open(recording, Path::new(&recording.source)).map_err(|report| report.to_string())?;
    let row = scenario.rows.first().ok_or("the scenario has no rows")?;
    let of = |(place, case)| -> Result<f64, Error> {
        let log = source.dataset(&case)?.log;
        let start = row.start.ok_or("the first row has no start")?;
        let given = scenario.starting.models(start, &log)?;
        let learner = scenario.learners.configured(&row.learner, &row.with).map_err(|faults| format!("{faults:?}"))?;
        let learned = learner.learn(&log, &given, &mut Seed(1).stream("learner"))?;
        let best = learned.history.iter().filter_map(|step| step.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
        // The density of the depth, r cos(b), is that of the range r divided by the cosine.
        let axis_rad = recording.depths.as_ref().map(|depths| depths.axis_of(place));
        let stretched = |seen: &asami_dataset::Sighting| match (seen.size, axis_rad) {
            (Size::RangeM(_), Some(axis_rad)) => ln(sin_cos(seen.bearing_rad - axis_rad).1),
            _ => 0.0,
        };
        Ok(best - log.sightings.iter().map(stretched).sum::<f64>())
    };
    source.cases().into_iter().enumerate().map(of).collect()
}

/// Where a parabola through the greatest of `y` and its neighbours has its top.
fn peak(x: &[f64], y: &[f64]) -> f64 {
    let at = (0..y.len()).max_by(|a, b| y[*a].total_cmp(&y[*b])).unwrap_or(0).clamp(1, y.len().saturating_sub(2));
    let (down, up) = (y[at] - y[at - 1], y[at + 1] - y[at]);
    x[at] + 0.5 * (x[at + 1] - x[at]) * (down + up) / (down - up)
}
