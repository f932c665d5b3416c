//! `trials.csv` of chapter 3.

use asami_dataset::store::number;

use super::Chapter3;
use crate::scenario::Origin;
use crate::scorer::line::Scores;
use crate::sweep::rows::{head, millimetres, optional, push, quoted, window};
use crate::sweep::{Record, Results};
use crate::trial::Ending;

/// `trials.csv`.
#[must_use]
pub fn trials(results: &Results<Chapter3>) -> String {
    let is_recorded = matches!(results.scenario.origin, Origin::Recorded(_));
    let mut text = String::from(
        "scenario,learner,starting_model,seed,duration_s,converged,sensor_rmse_mm,action_rmse_mm_per_s,scale_ratio",
    );
    if is_recorded {
        text.push_str(",window_start_s,overlapping");
    }
    text.push_str(
        ",floor_sensor_rmse_mm,floor_action_rmse_mm_per_s,sensor_r2,action_r2,sensor_scale,action_scale,sensor_degree,action_degree,\
         iterations,\
         verdict,reason\n",
    );
    for (record, trial) in results.trials() {
        let row = &results.scenario.rows[trial.row];
        let mut fields = head(results, trial);
        fields.extend([number(row.duration_s), (trial.ending == Ending::Converged).to_string()]);
        let scores = &trial.scores;
        fields.extend([millimetres(scores.sensor_rmse_m), millimetres(scores.action_rmse_m_per_s)]);
        fields.push(optional(scores.scale_ratio()));
        if is_recorded {
            fields.extend(window(&trial.case));
        }
        let floor = floor(record);
        fields.extend([millimetres(floor.sensor_rmse_m), millimetres(floor.action_rmse_m_per_s)]);
        let rest = [scores.sensor_r2, scores.action_r2, scores.sensor_scale, scores.action_scale];
        fields.extend(rest.map(optional));
        fields
            .extend([trial.sensor_degree, trial.action_degree].map(|n| n.map_or_else(String::new, |n| n.to_string())));
        fields.push(trial.iterations.map_or_else(String::new, |n| n.to_string()));
        fields.extend([trial.ending.name().to_owned(), quoted(&trial.reason)]);
        push(&mut text, &fields);
    }
    text
}

/// Errors of the best models of the published degrees, of one case.
#[must_use]
pub fn floor(record: &Record<Chapter3>) -> Scores {
    record.references.iter().find(|reference| reference.name == "floor").map_or_else(Scores::default, |it| it.scores)
}
