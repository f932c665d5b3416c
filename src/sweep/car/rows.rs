//! `trials.csv` of chapter 5.

use super::InTraffic;
use super::quantities::{Of, QUANTITIES};
use crate::scenario::Origin;
use crate::sweep::Results;
use crate::sweep::quantity::Quantity;
use crate::sweep::rows::{head, push, tail, window};
use crate::trial::Ending;

/// So many quantities stand ahead of whether the trial converged.
const AGREED: usize = 8;

/// `trials.csv`.
#[must_use]
pub fn trials(results: &Results<InTraffic>) -> String {
    let is_recorded = matches!(results.scenario.origin, Origin::Recorded(_));
    let (agreed, more) = QUANTITIES.split_at(AGREED);
    let mut heads = vec!["scenario", "learner", "starting_model", "seed"];
    heads.extend(agreed.iter().map(|quantity| quantity.name));
    heads.push("converged");
    if is_recorded {
        heads.extend(["window_start_s", "overlapping"]);
    }
    heads.extend(more.iter().map(|quantity| quantity.name));
    heads.extend(["duration_s", "lacks", "verdict", "reason"]);
    let mut text = heads.join(",") + "\n";
    for (record, trial) in results.trials() {
        let mut fields = head(results, trial);
        let of = |quantity: &Quantity<Of>| quantity.field((quantity.of)(trial, &record.truth));
        fields.extend(agreed.iter().map(of));
        fields.push((trial.ending == Ending::Converged).to_string());
        if is_recorded {
            fields.extend(window(&trial.case));
        }
        fields.extend(more.iter().map(of));
        fields.extend(tail(results, trial));
        push(&mut text, &fields);
    }
    text
}
