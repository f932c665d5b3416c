//! Table 3.1: our rows, each with the dissertation's under it, as CSV, Markdown, TeX and plain text.

use asami_dataset::store::number;
use asami_math::statistics;

use super::Chapter3;
use super::published::{CHAPTER_3, Published};
use super::summary::{Comparison, Summary};
use crate::scenario::{Row, Start};
use crate::scorer::line::Scores;
use crate::sweep::rows::optional;
use crate::sweep::spread::Spread;
use crate::sweep::{Results, Whose};

/// Mean and standard deviation.
pub type MeanSd = (f64, Option<f64>);

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Whose numbers.
    pub whose: Whose,
    /// Which learner.
    pub learner: String,
    /// Started from what.
    pub start: Option<Start>,
    /// How long it learned.
    pub duration_s: Option<f64>,
    /// Sensor model's error.
    pub sensor_rmse_mm: Option<MeanSd>,
    /// Action model's error.
    pub action_rmse_mm_per_s: Option<MeanSd>,
    /// How many trials converged.
    pub converged: Option<usize>,
    /// Of how many.
    pub trials: Option<usize>,
    /// Of our own rows, the statistics behind them.
    pub summary: Option<Summary>,
}

/// The lines in their order: each of ours, the published one under it; then the references.
#[must_use]
pub fn lines(results: &Results<Chapter3>, summaries: &[Summary]) -> Vec<Line> {
    let mut lines = Vec::new();
    for (row, summary) in results.scenario.rows.iter().zip(summaries) {
        let published = published(row);
        lines.push(Line {
            whose: Whose::Asami,
            learner: row.label.clone(),
            start: row.start,
            duration_s: Some(row.duration_s),
            sensor_rmse_mm: summary.sensor_rmse_m.as_ref().map(in_millimetres),
            action_rmse_mm_per_s: summary.action_rmse_m_per_s.as_ref().map(in_millimetres),
            converged: Some(summary.converged),
            trials: Some(summary.trials),
            summary: Some(summary.clone()),
        });
        lines.extend(published.map(printed));
    }
    for (name, start) in reference_names(results) {
        lines.push(reference(results, &name, start));
        let published = CHAPTER_3.iter().find(|published| published.learner == name && published.start == start);
        lines.extend(published.map(printed));
    }
    lines
}

fn published(row: &Row) -> Option<&'static Published> {
    CHAPTER_3.iter().find(|published| {
        let is_row = published.learner == row.label && published.start == row.start;
        is_row && published.duration_s == Some(row.duration_s)
    })
}

/// What the dissertation prints beside its table, with ours: a sentence each.
#[must_use]
pub fn remarks(results: &Results<Chapter3>, summaries: &[Summary]) -> Vec<String> {
    let mut remarks = Vec::new();
    for (row, summary) in results.scenario.rows.iter().zip(summaries) {
        let Some(published) = published(row) else { continue };
        let start = row.start.map_or_else(String::new, |start| format!(" from {}", start.name()));
        let name = format!("{}{start}, {} s", row.label, row.duration_s);
        let quantities = [
            ("scale difference", &summary.scale_difference, published.scale_difference),
            ("degree of the sensor model", &summary.sensor_degree, published.sensor_degree),
        ];
        for (quantity, ours, printed) in quantities {
            if let (Some(ours), Some(printed)) = (ours, printed) {
                let (ours, printed) = (shown((ours.mean, ours.sd), 2), shown(printed, 2));
                remarks.push(format!("{name}: {quantity} {ours} (dissertation: {printed}, {})", published.place));
            }
        }
    }
    remarks
}

fn shown((mean, sd): MeanSd, decimals: usize) -> String {
    sd.map_or_else(|| format!("{mean:.decimals$}"), |sd| format!("{mean:.decimals$} ± {sd:.decimals$}"))
}

fn in_millimetres(spread: &Spread) -> MeanSd {
    (spread.mean * 1000.0, spread.sd.map(|sd| sd * 1000.0))
}

fn printed(published: &Published) -> Line {
    Line {
        whose: Whose::Dissertation,
        learner: published.learner.to_owned(),
        start: published.start,
        duration_s: published.duration_s,
        sensor_rmse_mm: published.sensor_rmse_mm,
        action_rmse_mm_per_s: published.action_rmse_mm_per_s,
        converged: published.converged.map(|n| n as usize),
        trials: published.trials.map(|n| n as usize),
        summary: None,
    }
}

fn reference_names(results: &Results<Chapter3>) -> Vec<(String, Option<Start>)> {
    let first = results.records.iter().map(|record| &record.references).find(|references| !references.is_empty());
    first.into_iter().flatten().map(|reference| (reference.name.clone(), reference.start)).collect()
}

/// The mean over the cases; they differ only where each has a truth of its own.
fn reference(results: &Results<Chapter3>, name: &str, start: Option<Start>) -> Line {
    let of = |value: fn(&Scores) -> Option<f64>| {
        let values: Vec<f64> = results
            .counted()
            .flat_map(|record| &record.references)
            .filter(|reference| reference.name == name && reference.start == start)
            .filter_map(|reference| value(&reference.scores))
            .map(|metres| metres * 1000.0)
            .collect();
        let is_one = values.windows(2).all(|pair| pair[0] == pair[1]);
        let first = *values.first()?;
        Some(if is_one { (first, None) } else { (statistics::mean(&values)?, statistics::standard_deviation(&values)) })
    };
    Line {
        whose: Whose::Reference,
        learner: name.to_owned(),
        start,
        duration_s: None,
        sensor_rmse_mm: of(|scores| scores.sensor_rmse_m),
        action_rmse_mm_per_s: of(|scores| scores.action_rmse_m_per_s),
        converged: None,
        trials: None,
        summary: None,
    }
}

/// `table_3_1.csv`.
#[must_use]
pub fn csv(lines: &[Line]) -> String {
    let mut text = String::from(
        "source,learner,starting_model,duration_s,sensor_rmse_mm_mean,sensor_rmse_mm_sd,action_rmse_mm_per_s_mean,\
         action_rmse_mm_per_s_sd,converged,trials\n",
    );
    let count = |n: Option<usize>| n.map_or_else(String::new, |n| n.to_string());
    for line in lines {
        let mean = |value: Option<MeanSd>| optional(value.map(|(mean, _)| mean));
        let sd = |value: Option<MeanSd>| optional(value.and_then(|(_, sd)| sd));
        let fields = [
            line.whose.name().to_owned(),
            line.learner.clone(),
            line.start.map_or("", Start::name).to_owned(),
            optional(line.duration_s),
            mean(line.sensor_rmse_mm),
            sd(line.sensor_rmse_mm),
            mean(line.action_rmse_mm_per_s),
            sd(line.action_rmse_mm_per_s),
            count(line.converged),
            count(line.trials),
        ];
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}

/// `statistics.csv`: beside mean and standard deviation what is less easily led astray by one trial.
#[must_use]
pub fn statistics_csv(results: &Results<Chapter3>, summaries: &[Summary]) -> String {
    let mut text = String::from(
        "learner,starting_model,duration_s,quantity,unit,mean,sd,median,interquartile_mean,mean_95_low,mean_95_high\n",
    );
    for (row, summary) in results.scenario.rows.iter().zip(summaries) {
        let quantities = [
            ("sensor_rmse,mm", 1000.0, &summary.sensor_rmse_m),
            ("action_rmse,mm/s", 1000.0, &summary.action_rmse_m_per_s),
            ("scale_difference,1", 1.0, &summary.scale_difference),
            ("sensor_degree,1", 1.0, &summary.sensor_degree),
        ];
        for (name, unit, spread) in quantities {
            let Some(spread) = spread else { continue };
            let start = row.start.map_or("", Start::name);
            let [low, high] = spread.interval.map_or([None; 2], |interval| interval.map(Some));
            let values =
                [Some(spread.mean), spread.sd, Some(spread.median), Some(spread.interquartile_mean), low, high];
            let values = values.map(|value| optional(value.map(|value| value * unit))).join(",");
            text.push_str(&format!("{},{start},{},{name},{values}\n", row.label, number(row.duration_s)));
        }
    }
    text
}

/// `comparisons.csv`: paired tests over the logs on which both rows converged.
#[must_use]
pub fn comparisons_csv(results: &Results<Chapter3>, comparisons: &[Comparison]) -> String {
    let mut text = String::from(
        "learner,starting_model,duration_s,against_learner,against_starting_model,quantity,pairs,\
         median_difference_mm,wilcoxon_p\n",
    );
    let name = |row: usize| {
        let row = &results.scenario.rows[row];
        (row.label.clone(), row.start.map_or("", Start::name), row.duration_s)
    };
    for it in comparisons {
        let ((learner, start, duration_s), (other, other_start, _)) = (name(it.row), name(it.against));
        let (duration, quantity, pairs) = (number(duration_s), it.quantity, it.pairs);
        let (difference, p) = (number(it.median_difference * 1000.0), number(it.p));
        text.push_str(&format!(
            "{learner},{start},{duration},{other},{other_start},{quantity},{pairs},{difference},{p}\n"
        ));
    }
    text
}

const HEADS: [&str; 9] = [
    "source",
    "learner",
    "A0",
    "time (s)",
    "sensor (mm)",
    "action (mm/s)",
    "converged",
    "sensor median, iqm, 95 % of mean",
    "action median, iqm, 95 % of mean",
];

fn cells(line: &Line, plus_minus: &str) -> [String; 9] {
    let mean_sd = |value: Option<MeanSd>| match value {
        None => String::new(),
        Some((mean, None)) => format!("{mean:.1}"),
        Some((mean, Some(sd))) => format!("{mean:.1}{plus_minus}{sd:.1}"),
    };
    let robust = |spread: Option<&Spread>| {
        spread.map_or_else(String::new, |spread| {
            let interval = spread.interval.map(|[low, high]| format!(", {:.1}..{:.1}", low * 1000.0, high * 1000.0));
            let (median, middle) = (spread.median * 1000.0, spread.interquartile_mean * 1000.0);
            format!("{median:.1}, {middle:.1}{}", interval.unwrap_or_default())
        })
    };
    let converged = match (line.converged, line.trials) {
        (Some(converged), Some(trials)) => format!("{converged}/{trials}"),
        _ => String::new(),
    };
    [
        line.whose.name().to_owned(),
        line.learner.clone(),
        line.start.map_or("", Start::name).to_owned(),
        line.duration_s.map_or_else(String::new, |duration_s| format!("{duration_s}")),
        mean_sd(line.sensor_rmse_mm),
        mean_sd(line.action_rmse_mm_per_s),
        converged,
        robust(line.summary.as_ref().and_then(|summary| summary.sensor_rmse_m.as_ref())),
        robust(line.summary.as_ref().and_then(|summary| summary.action_rmse_m_per_s.as_ref())),
    ]
}

/// `table_3_1.md`.
#[must_use]
pub fn markdown(lines: &[Line]) -> String {
    let mut text = format!("| {} |\n|{}\n", HEADS.join(" | "), "---|".repeat(HEADS.len()));
    for line in lines {
        text.push_str(&format!("| {} |\n", cells(line, " ± ").join(" | ")));
    }
    text
}

/// `table_3_1.tex`: a `tabular` to be put into a `table`.
#[must_use]
pub fn tex(lines: &[Line]) -> String {
    let mut text = String::from("\\begin{tabular}{lllrrrr}\n\\hline\n");
    text.push_str("source & learner & $A_0(c)$ & time (s) & sensor (mm) & action (mm/s) & converged \\\\\n\\hline\n");
    for line in lines {
        let mut cells = cells(line, " $\\pm$ ");
        cells[2] = tex_start(line.start);
        for cell in &mut cells[..2] {
            *cell = cell.replace('_', "\\_");
        }
        text.push_str(&format!("{} \\\\\n", cells[..7].join(" & ")));
    }
    text.push_str("\\hline\n\\end{tabular}\n");
    text
}

fn tex_start(start: Option<Start>) -> String {
    match start {
        None => String::new(),
        Some(Start::C) => "$c$".into(),
        Some(Start::Sgn) => "$\\mathrm{Sgn}(c)$".into(),
        Some(Start::One) => "$1$".into(),
        Some(Start::ReferenceQuartic) => "best quartic".into(),
        Some(Start::ReferenceCubic) => "(best cubic $S$)".into(),
        Some(of_chapter_4) => of_chapter_4.name().replace('_', "\\_"),
    }
}

/// The table for a terminal, columns aligned.
#[must_use]
pub fn plain(lines: &[Line]) -> String {
    let rows: Vec<[String; 7]> = std::iter::once(HEADS.map(str::to_owned))
        .chain(lines.iter().map(|line| cells(line, " ± ")))
        .map(|row| std::array::from_fn(|i| row[i].clone()))
        .collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 7] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        let padded: Vec<String> = (0..7)
            .map(|i| if i < 3 { format!("{:<1$}", row[i], widths[i]) } else { format!("{:>1$}", row[i], widths[i]) })
            .collect();
        text.push_str(padded.join("  ").trim_end());
        text.push('\n');
    }
    text
}
