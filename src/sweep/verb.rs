//! The verb `sweep`: read, plan, run, write, say.

use std::io::Write;
use std::path::{Path, PathBuf};

use miette::Report;

use super::source::{Recorded, Simulated, Source};
use super::summary::{Comparison, Summary};
use super::table::Line;
use super::{CannotSweep, Options, Plan, Results, Watcher, cases, expect, manifest, rows, summary, table};
use crate::report;
use crate::scenario::{Origin, Scenario, Start};
use crate::survey::Surveyor;
use crate::trial::Ending;

/// What was asked on the command line.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Fewer, or more, seeds than the scenario says.
    pub seeds: Option<u32>,
    /// Recorded data elsewhere than the scenario says.
    pub data: Option<PathBuf>,
    /// Where results go, a new survey among them.
    pub out: PathBuf,
    /// Threads; `None`: one for each core.
    pub jobs: Option<usize>,
}

/// Results with everything that is said about them.
pub struct Outcome {
    /// Raw rows.
    pub results: Results,
    /// Statistics of each row.
    pub summaries: Vec<Summary>,
    /// Paired tests.
    pub comparisons: Vec<Comparison>,
    /// The table.
    pub lines: Vec<Line>,
    /// Expected answers.
    pub verdicts: Vec<expect::Verdict>,
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
    let source: Box<dyn Source> = match &scenario.origin {
        Origin::Simulated(simulation) => {
            let surveyor = Surveyor {
                look_in: vec![manifest::repository().join("results/reference").join(&scenario.name)],
                keep_in: asked.out.clone(),
                jobs: asked.jobs,
                say: &|line| drop(writeln!(std::io::stderr(), "{line}")),
            };
            let survey = surveyor.survey(simulation).map_err(crate::verb::plain)?;
            Box::new(Simulated::new(&scenario, simulation, survey))
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
    let learners = scenario.rows.iter().enumerate().map(|(i, row)| {
        scenario.learners.configured(&row.learner, &row.with).map_err(|faults| {
            // The scenario's check has said so already; a plan made by hand may still get here.
            let said: Vec<_> = faults.into_iter().map(|fault| fault.message).collect();
            miette::miette!("row {}: {}", i + 1, said.join("; "))
        })
    });
    let learners = learners.collect::<Result<Vec<_>, _>>()?;
    Ok(Plan { scenario, source, learners })
}

/// Runs a plan and writes its files.
///
/// # Errors
/// If files cannot be written.
pub fn carry_out(plan: &Plan, options: &Options, watcher: &dyn Watcher) -> Result<Outcome, CannotSweep> {
    let results = super::run(plan, options, watcher)?;
    let outcome = Outcome::of(results);
    outcome.write(&options.out, &options.program)?;
    report::sweep::write(&outcome, &plan.source.exhibits(), &options.program, &options.out)?;
    Ok(outcome)
}

impl Outcome {
    /// Works out everything that is said about `results`.
    #[must_use]
    pub fn of(results: Results) -> Self {
        let summaries = summary::summaries(&results);
        let comparisons = summary::comparisons(&results);
        let lines = table::lines(&results, &summaries);
        let verdicts = expect::verdicts(&results, &summaries, &comparisons, &lines);
        Self { results, summaries, comparisons, lines, verdicts }
    }

    /// Writes every file but figures and the report.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, out: &Path, program: &str) -> Result<(), CannotSweep> {
        rows::write(&self.results, out)?;
        let manifest = serde_json::to_string_pretty(&manifest::manifest(&self.results, program));
        let path = out.join("manifest.json");
        let manifest = manifest.map_err(std::io::Error::other).map_err(CannotSweep::file("serialise", &path))?;
        let files = [
            ("table_3_1.csv", table::csv(&self.lines)),
            ("table_3_1.md", table::markdown(&self.lines)),
            ("table_3_1.tex", table::tex(&self.lines)),
            ("statistics.csv", table::statistics_csv(&self.results, &self.summaries)),
            ("comparisons.csv", table::comparisons_csv(&self.results, &self.comparisons)),
            ("manifest.json", manifest + "\n"),
        ];
        for (name, text) in files {
            cases::write_whole(&out.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// What a terminal shows at the end: question, table, expected answers, errors.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n{}", self.results.scenario.about, table::plain(&self.lines));
        for remark in table::remarks(&self.results, &self.summaries) {
            text.push_str(&format!("\n{remark}"));
        }
        for it in &self.comparisons {
            let name = |row: usize| {
                let row = &self.results.scenario.rows[row];
                format!("{} {}", row.label, row.start.map_or("", Start::name)).trim_end().to_owned()
            };
            let (row, against, seconds) =
                (name(it.row), name(it.against), self.results.scenario.rows[it.row].duration_s);
            let difference = it.median_difference * 1000.0;
            let (quantity, pairs, p) = (it.quantity, it.pairs, it.p);
            text.push_str(&format!(
                "\n{row} against {against}, {seconds} s, {quantity}: median difference {difference:+.1} over {pairs} \
                 logs, Wilcoxon p = {p:.1e}"
            ));
        }
        text.push('\n');
        for verdict in &self.verdicts {
            text.push_str(&format!(
                "\n{} {}",
                if verdict.holds { "as expected:" } else { "NOT as expected:" },
                verdict.claim
            ));
        }
        let errors = self.results.trials().filter(|(_, trial)| trial.ending == Ending::Error);
        for (record, trial) in errors {
            let label = &self.results.scenario.rows[trial.row].label;
            text.push_str(&format!("\nERROR: {label} on {}: {}", record.case.name(), trial.reason));
        }
        text.push('\n');
        text
    }
}
