//! `trials.csv` in the plane.

use super::InPlane;
use super::quantities::QUANTITIES;
use crate::scenario::{Origin, Start};
use crate::sweep::Results;
use crate::sweep::rows::{optional, quoted};
use crate::trial::Ending;

/// Columns of the log's part that a recording's trial learned from stand after so many quantities.
const AGREED: usize = 12;

/// `trials.csv`.
#[must_use]
pub fn trials(results: &Results<InPlane>) -> String {
    let is_recorded = matches!(results.scenario.origin, Origin::Recorded(_));
    let (agreed, more) = QUANTITIES.split_at(AGREED);
    let mut heads = vec!["scenario", "learner", "starting_model", "seed", "converged"];
    heads.extend(agreed.iter().map(|quantity| quantity.name));
    if is_recorded {
        heads.extend(["robot", "landmarks", "window_start_s", "overlapping"]);
    }
    heads.extend(more.iter().map(|quantity| quantity.name));
    heads.extend(["duration_s", "lacks", "verdict", "reason"]);
    let mut text = heads.join(",") + "\n";
    for (record, trial) in results.trials() {
        let row = &results.scenario.rows[trial.row];
        let mut fields = vec![
            results.scenario.name.clone(),
            row.label.clone(),
            row.start.map_or("", Start::name).to_owned(),
            trial.case.seed.to_string(),
            (trial.ending == Ending::Converged).to_string(),
        ];
        let of = |quantity: &super::quantities::Quantity| {
            let value = (quantity.of)(trial, &record.truth);
            let is_count = matches!(quantity.name, "iterations" | "observations");
            if is_count { value.map_or_else(String::new, |n| format!("{n:.0}")) } else { optional(value) }
        };
        fields.extend(agreed.iter().map(of));
        if is_recorded {
            let id = |id: Option<u16>| id.map_or_else(String::new, |id| id.to_string());
            fields.extend([id(trial.case.robot), id(trial.case.landmarks)]);
            fields.push(optional(trial.case.window.map(|window| window.start_s)));
            fields.push(trial.case.window.is_some_and(|window| window.overlapping).to_string());
        }
        fields.extend(more.iter().map(of));
        fields.push(optional(Some(row.duration_s)));
        fields.extend([quoted(&trial.lacks.join("; ")), trial.ending.name().to_owned(), quoted(&trial.reason)]);
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}
