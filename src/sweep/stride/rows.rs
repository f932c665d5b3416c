//! `trials.csv` along the line: a row for each trial and era of the truth.

use super::Strides;
use super::quantities::{Of, QUANTITIES};
use crate::scenario::Era;
use crate::sweep::Results;
use crate::sweep::quantity::Quantity;
use crate::sweep::rows::{head, push, tail};
use crate::trial::Ending;

/// `trials.csv`.
#[must_use]
pub fn trials(results: &Results<Strides>) -> String {
    // Iterations stand among the agreed columns.
    let quantities = || QUANTITIES.iter().filter(|quantity| quantity.name != "iterations");
    let names: Vec<&str> = quantities().map(|quantity| quantity.name).collect();
    let mut text = format!(
        "scenario,learner,starting_model,seed,converged,iterations,learned_era,truth_era,{},duration_s,lacks,\
         verdict,reason\n",
        names.join(",")
    );
    for (record, trial) in results.trials() {
        let row = &results.scenario.rows[trial.row];
        for era in [Era::Before, Era::After] {
            // A trial that learned nothing has a row all the same: against its own era.
            let scores = trial.scores.of(era).zip(record.truth.of(era));
            if scores.is_none() && era != row.era {
                continue;
            }
            let mut fields = head(results, trial);
            fields.extend([
                (trial.ending == Ending::Converged).to_string(),
                trial.iterations.map_or_else(String::new, |n| n.to_string()),
                row.era.name().to_owned(),
                era.name().to_owned(),
            ]);
            let of = |quantity: &Quantity<Of>| {
                quantity.field(scores.and_then(|(scores, truth)| (quantity.of)(trial, scores, truth)))
            };
            fields.extend(quantities().map(of));
            fields.extend(tail(results, trial));
            push(&mut text, &fields);
        }
    }
    text
}
