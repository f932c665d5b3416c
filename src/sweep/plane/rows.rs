//! `trials.csv` in the plane.

use super::InPlane;
use super::quantities::{Of, QUANTITIES};
use crate::scenario::Origin;
use crate::sweep::Results;
use crate::sweep::quantity::Quantity;
use crate::sweep::rows::{head, push, tail, window};
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
        let mut fields = head(results, trial);
        fields.push((trial.ending == Ending::Converged).to_string());
        let of = |quantity: &Quantity<Of>| quantity.field((quantity.of)(trial, &record.truth));
        fields.extend(agreed.iter().map(of));
        if is_recorded {
            let id = |id: Option<u16>| id.map_or_else(String::new, |id| id.to_string());
            fields.extend([id(trial.case.robot), id(trial.case.landmarks)]);
            fields.extend(window(&trial.case));
        }
        fields.extend(more.iter().map(of));
        fields.extend(tail(results, trial));
        push(&mut text, &fields);
    }
    text
}
