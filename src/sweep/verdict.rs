//! Whether the expected answers of a scenario came out.

use crate::scenario::{Era, Expect, Row};

/// One expected answer and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// What was expected of which row, and what was found.
    pub claim: String,
    /// Whether it holds.
    pub holds: bool,
}

/// The row's name in claims.
#[must_use]
pub fn name(row: &Row) -> String {
    let start = row.start.map_or_else(String::new, |start| format!(" from {}", start.name()));
    let era = if row.era == Era::After { " after the change" } else { "" };
    format!("{}{start}{era}, {} s", row.label, row.duration_s)
}

/// The claims on how many trials converge.
#[must_use]
pub fn shares(expect: &Expect, converged: usize, trials: usize) -> Vec<(String, bool)> {
    let share = converged as f64 / (trials as f64).max(1.0);
    let count = format!("{converged} of {trials}");
    let least = expect
        .converged_share_min
        .map(|least| (format!("at least {:.0} % converge ({count})", 100.0 * least), share >= least));
    let most = expect
        .converged_share_max
        .map(|most| (format!("at most {:.0} % converge ({count})", 100.0 * most), share <= most));
    least.into_iter().chain(most).collect()
}

/// Whether all of them hold; `None` where nothing was expected.
#[must_use]
pub fn all_hold(verdicts: &[Verdict]) -> Option<bool> {
    (!verdicts.is_empty()).then(|| verdicts.iter().all(|verdict| verdict.holds))
}

/// How many hold, in a sentence with a blank before it; empty where nothing was expected.
#[must_use]
pub fn in_words(verdicts: &[Verdict]) -> String {
    let holding = verdicts.iter().filter(|verdict| verdict.holds).count();
    match verdicts.len() {
        0 => String::new(),
        all if holding == all => format!(" All {all} expected answers came out."),
        all => format!(" {holding} of {all} expected answers came out; the others are below."),
    }
}

/// What a terminal shows of claims.
#[must_use]
pub fn text(verdicts: &[Verdict]) -> String {
    let line = |verdict: &Verdict| {
        format!("\n{} {}", if verdict.holds { "as expected:" } else { "NOT as expected:" }, verdict.claim)
    };
    verdicts.iter().map(line).collect()
}
