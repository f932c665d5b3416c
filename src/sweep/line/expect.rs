//! Whether the expected answers of a scenario came out.

use super::Chapter3;
use super::summary::{Comparison, Summary};
use super::table::Line;
use crate::scenario::{Expect, Start};
use crate::sweep::verdict::{Verdict, shares};
use crate::sweep::{Results, Whose};

/// Every claim of the scenario's `[[expect]]`, in order.
#[must_use]
pub fn verdicts(
    results: &Results<Chapter3>,
    summaries: &[Summary],
    comparisons: &[Comparison],
    lines: &[Line],
) -> Vec<Verdict> {
    let rows = &results.scenario.rows;
    let mut verdicts = Vec::new();
    for expect in &results.scenario.expect {
        let Some(index) = rows.iter().position(|row| expect.is_about(row)) else { continue };
        let row = &rows[index];
        let start = row.start.map_or_else(String::new, |start| format!(" from {}", start.name()));
        let name = format!("{}{start}, {} s", row.label, row.duration_s);
        let found = claims(expect, index, results, &summaries[index], comparisons, lines);
        verdicts.extend(found.into_iter().map(|(claim, holds)| Verdict { claim: format!("{name}: {claim}"), holds }));
    }
    verdicts
}

fn claims(
    expect: &Expect,
    index: usize,
    results: &Results<Chapter3>,
    summary: &Summary,
    comparisons: &[Comparison],
    lines: &[Line],
) -> Vec<(String, bool)> {
    let mut claims = Vec::new();
    claims.extend(shares(expect, summary.converged, summary.trials));
    let reference = |name: &str, start: Option<Start>| {
        lines.iter().find(|line| line.whose == Whose::Reference && line.learner == name && line.start == start)
    };
    let floor = reference("floor", None);
    let ratios = [
        ("sensor", expect.sensor_to_floor_max, &summary.sensor_rmse_m, floor.and_then(|line| line.sensor_rmse_mm)),
        (
            "action",
            expect.action_to_floor_max,
            &summary.action_rmse_m_per_s,
            floor.and_then(|line| line.action_rmse_mm_per_s),
        ),
    ];
    for (model, most, spread, floor) in ratios {
        let Some(most) = most else { continue };
        let ratio = spread.zip(floor).map(|(spread, (floor_mm, _))| spread.mean * 1000.0 / floor_mm);
        let found = ratio.map_or_else(|| "no number".to_owned(), |ratio| format!("{ratio:.2}"));
        let holds = ratio.is_some_and(|ratio| ratio <= most);
        claims.push((format!("{model} error at most {most} x the floor ({found})"), holds));
    }
    if expect.beats_unlearned {
        let unlearned = reference("unlearned", Some(Start::C)).and_then(|line| line.action_rmse_mm_per_s);
        let ours = summary.action_rmse_m_per_s.map(|spread| spread.mean * 1000.0);
        let holds = ours.zip(unlearned).is_some_and(|(ours, (unlearned, _))| ours < unlearned);
        let shown = |value: Option<f64>| value.map_or_else(|| "no number".to_owned(), |value| format!("{value:.1}"));
        let (ours, unlearned) = (shown(ours), shown(unlearned.map(|(mean, _)| mean)));
        claims.push((format!("action error below the unlearned model's ({ours} against {unlearned} mm/s)"), holds));
    }
    if let Some(beaten) = &expect.beats {
        for it in comparisons.iter().filter(|it| it.row == index) {
            let against = &results.scenario.rows[it.against];
            // So few pairs that the test could not tell whatever they were: of a sweep with fewer seeds.
            if against.label != *beaten || 2.0 * 0.5_f64.powi(it.pairs as i32) >= 0.05 {
                continue;
            }
            let holds = it.median_difference < 0.0 && it.p < 0.05;
            let start = against.start.map_or("", Start::name);
            let difference = it.median_difference * 1000.0;
            let (quantity, pairs, p) = (it.quantity, it.pairs, it.p);
            let claim =
                format!("{quantity} below {beaten} {start}'s (median {difference:.1} mm over {pairs}, p = {p:.2e})");
            claims.push((claim, holds));
        }
    }
    claims
}
