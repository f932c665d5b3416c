//! The verb `sweep`: read, plan, run, write, say.

use std::io::Write;
use std::path::PathBuf;

use asami_learners::Learner;
use miette::Report;

use super::car::InTraffic;
use super::line::Chapter3;
use super::plane::InPlane;
use super::source::{Recorded, Simulated, Source};
use super::stride::Strides;
use super::{CannotSweep, Finished, Options, Plan, Results, Watcher, manifest};
use crate::scenario::{self, Origin, Scenario};
use crate::study::{Finishing, Study};
use crate::survey::Surveyor;
use crate::trial::Ending;

/// What was asked on the command line.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Fewer, or more, seeds than the scenario says.
    pub seeds: Option<u32>,
    /// Only rows of these names; all, if there are none.
    pub only: Vec<String>,
    /// Recorded data elsewhere than the scenario says.
    pub data: Option<PathBuf>,
    /// Where results go, a new survey among them.
    pub out: PathBuf,
    /// Threads; `None`: one for each core.
    pub jobs: Option<usize>,
}

/// Makes a plan out of a checked scenario.
///
/// # Errors
/// A report on what is the user's to mend: data that are missing, options that do not fit.
pub fn plan(mut scenario: Scenario, asked: &Asked) -> Result<Plan, Report> {
    match (&mut scenario.origin, asked.seeds) {
        (_, None) => {}
        (_, Some(0)) => miette::bail!("--seeds must be at least 1"),
        (Origin::Simulated(simulation), Some(seeds)) => simulation.seeds = seeds,
        (Origin::Recorded(_), Some(_)) => {
            miette::bail!("--seeds is for simulated scenarios; {} is a recording", scenario.name);
        }
    }
    only(&mut scenario, &asked.only)?;
    let source: Box<dyn Source> = match &scenario.origin {
        Origin::Simulated(simulation) => {
            let surveyor = Surveyor {
                look_in: vec![manifest::repository().join("results/reference").join(&scenario.name)],
                keep_in: asked.out.clone(),
                jobs: asked.jobs,
                say: &|line| drop(writeln!(std::io::stderr(), "{line}")),
            };
            let survey = surveyor.survey(simulation).map_err(crate::verb::plain)?;
            let changed = simulation.changed().map(|changed| surveyor.survey_after(&changed)).transpose();
            Box::new(Simulated::new(&scenario, simulation, survey, changed.map_err(crate::verb::plain)?))
        }
        Origin::Recorded(recording) => {
            let path = asked.data.clone().unwrap_or_else(|| manifest::repository().join(&recording.source));
            if !path.exists() && recording.format.is_none() {
                miette::bail!(help = "give its folder with --data DIR", "{}: no such data set", path.display());
            }
            Box::new(Recorded::open(recording, &path).map_err(|report| match path.exists() {
                true => report,
                false => miette::miette!(help = "if it lies elsewhere: --data DIR", "{report}"),
            })?)
        }
    };
    let learners = configured(&scenario)?;
    Ok(Plan { scenario, source, learners })
}

/// One learner for each of a scenario's rows.
///
/// # Errors
/// A report on which row's parameters are none of its learner's.
pub fn configured(scenario: &Scenario) -> Result<Vec<Box<dyn Learner>>, Report> {
    let learners = scenario.rows.iter().enumerate().map(|(i, row)| {
        scenario.learners.configured(&row.learner, &row.with).map_err(|faults| {
            // The scenario's check has said so already; a plan made by hand may still get here.
            let said: Vec<_> = faults.into_iter().map(|fault| fault.message).collect();
            miette::miette!("row {}: {}", i + 1, said.join("; "))
        })
    });
    learners.collect()
}

/// Leaves only the rows of these names in a scenario, and what is expected of them alone.
fn only(scenario: &mut Scenario, names: &[String]) -> Result<(), Report> {
    let has = |name: &String| scenario.rows.iter().any(|row| row.label == *name);
    if let Some(unknown) = names.iter().find(|name| !has(name)) {
        let labels = scenario.rows.iter().map(|row| row.label.as_str());
        let meant = scenario::fault::nearest(unknown, labels);
        let meant = meant.map_or_else(String::new, |name| format!(" (did you mean {name}?)"));
        miette::bail!("{} has no row called {unknown}{meant}", scenario.name);
    }
    if !names.is_empty() {
        scenario.rows.retain(|row| names.contains(&row.label));
        scenario.expect.retain(|expect| {
            names.contains(&expect.learner) && expect.beats.as_ref().is_none_or(|beaten| names.contains(beaten))
        });
    }
    Ok(())
}

/// Runs a plan and writes its files.
///
/// # Errors
/// If files cannot be written.
pub fn carry_out(plan: &Plan, options: &Options, watcher: &dyn Watcher) -> Result<Finished, CannotSweep> {
    match plan.scenario.study {
        scenario::Study::Line => of_study::<Chapter3>(plan, options, watcher),
        scenario::Study::Plane => of_study::<InPlane>(plan, options, watcher),
        scenario::Study::Stride => of_study::<Strides>(plan, options, watcher),
        scenario::Study::Car => of_study::<InTraffic>(plan, options, watcher),
    }
}

fn of_study<S: Study>(plan: &Plan, options: &Options, watcher: &dyn Watcher) -> Result<Finished, CannotSweep> {
    let results = super::run::<S>(plan, options, watcher)?;
    let exhibits = plan.source.exhibits();
    S::finish(results, &Finishing { out: &options.out, program: &options.program, exhibits })
}

/// What a terminal is told of trials that gave no result.
#[must_use]
pub fn errors<S: Study>(results: &Results<S>) -> String {
    let errors = results.trials().filter(|(_, trial)| trial.ending == Ending::Error);
    let line = |(record, trial): (&super::Record<S>, &crate::trial::Trial<S::Scores>)| {
        let label = &results.scenario.rows[trial.row].label;
        format!("\nERROR: {label} on {}: {}", record.case.name(), trial.reason)
    };
    errors.map(line).collect()
}
