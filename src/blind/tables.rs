//! The tables of a blind sweep.

use std::collections::BTreeSet;

use super::answer::NONE;
use super::scenario::{Expect, Measure};
use super::tally::{
    Asked, Measured, STRATA, Share, asked, asked_of, calibration_by_chance, confusion, measure, named_word, power,
    reliability, truth_word,
};
use super::walk::Results;
use crate::report::{Cell, RowKind, Table};
use crate::sweep::verdict::Verdict;

/// What the first table measures, with heads and decimals.
const MEASURED: [(Measure, &str, usize); 10] = [
    (Measure::TopGroupRight, "top group right", 3),
    (Measure::InSet90, "in 90 % set", 3),
    (Measure::SetSize, "set size", 2),
    (Measure::ConfidentWrong, "wrong where P >= 0.9", 3),
    (Measure::PlaceRight, "place right", 3),
    (Measure::ParameterError, "size error / limit", 2),
    (Measure::ParameterErrorCr, "size error / Cramer-Rao", 2),
    (Measure::ParameterCovered, "size in 90 % interval", 3),
    (Measure::ClosedRatio, "closed / oracle's", 3),
    (Measure::Unknown, "called unknown", 3),
];

/// Every table with the name of its files.
#[must_use]
pub fn all(results: &Results) -> Vec<(String, Table)> {
    let diagnosers = || results.question.diagnosers.iter().enumerate();
    let mut tables = vec![("blind".to_owned(), strata(results)), ("none".to_owned(), without_effect(results))];
    tables.extend(diagnosers().map(|(i, name)| (format!("confusion_{name}"), matrix(results, i, name))));
    if results.is_pool() {
        tables.insert(2, ("worlds".to_owned(), worlds(results)));
    }
    if !planted_alone(results).is_empty() {
        tables.push(("power".to_owned(), powers(results)));
    }
    if results.records.iter().any(|record| record.planted.len() > 1) {
        tables.push(("two".to_owned(), two_effects(results)));
    }
    if results.question.next_experiment {
        tables.push(("next".to_owned(), next_logs(results)));
    }
    tables
}

fn is_ours(name: &str) -> RowKind {
    if name == "asami" { RowKind::Ours } else { RowKind::Reference }
}

/// Planted cases by strata of how far the truth is separated.
fn strata(results: &Results) -> Table {
    let mut heads = vec!["diagnoser", "D_sep (nats)", "cases"];
    heads.extend(MEASURED.iter().map(|(_, head, _)| *head));
    let mut table = Table::new("Planted cases", &heads).caption(
        "Cases with one effect or two, by how far the log separates the truth from everything that is not of its group \
         (one likelihood for all diagnosers). Shares with 95 % intervals (Wilson). Good: top group right >= 0.95 from 10 \
         nats on and >= 0.8 from 3 to 10; the 90 % set holds the truth in 0.87 to 0.97; sizes err at most 1.3 times what \
         the log allows, 0.67 / sqrt(2 D) of the size (and beside it by the bound of Cramer and Rao: the best there can be has 1 \
         in the median); what is named closes >= 0.95 of what the truth closes.",
    );
    for (i, name) in results.question.diagnosers.iter().enumerate() {
        for stratum in STRATA {
            let cases: Vec<Asked<'_>> = asked(results, i).filter(|it| it.is_planted() && stratum.holds(it)).collect();
            let mut cells = vec![name.as_str().into(), stratum.name.into(), Cell::number(cases.len() as f64, 0)];
            cells.extend(MEASURED.iter().map(|(what, _, decimals)| cell(measure(*what, &cases), *decimals)));
            table = table.row(is_ours(name), cells);
        }
    }
    table
}

/// A number, a share with its interval.
fn cell(measured: Measured, decimals: usize) -> Cell {
    let mut cell = Cell::number(measured.value.unwrap_or(f64::NAN), decimals);
    if let Some([low, high]) = measured.share.and_then(|share| share.interval()) {
        cell.text = format!("{} ({low:.decimals$}-{high:.decimals$})", cell.text);
    }
    if let Some(Share { count, of }) = measured.share {
        cell.hint = format!("{count} of {of}");
    }
    cell
}

/// Cases without an effect, and what concerns all cases.
fn without_effect(results: &Results) -> Table {
    let heads = [
        "diagnoser",
        "cases without effect",
        "called anything else",
        "none in 90 % set",
        "false unknown, all cases",
        "wrong where P >= 0.9, all cases",
        "calibration error",
        "by chance",
        "as far by chance",
        "log score",
        "by evidence alone",
        "by frequencies",
    ];
    let mut table = Table::new("No effect, and probabilities", &heads).caption(
        "How often a log of the nominal world is said to show a cause (good: <= 0.03), and over all cases how far \
         probabilities are from how often they come true, in ten bins (good: <= 0.04, or, where cases are few, no more than is \
         to be expected by chance of probabilities that are just right; as far by chance: how often such are off by as much, \
         good: >= 0.05). Log score: the mean logarithm of the truth's probability, in nats, beside that of the evidence as it is and \
         that of how often each truth is planted in these cases (good: greater than both).",
    );
    for (i, name) in results.question.diagnosers.iter().enumerate() {
        let all: Vec<Asked<'_>> = asked(results, i).collect();
        let none: Vec<Asked<'_>> = all.iter().filter(|it| !it.is_planted()).copied().collect();
        let listed: Vec<Asked<'_>> = all.iter().filter(|it| it.record.withheld.is_empty()).copied().collect();
        let cells = [
            name.as_str().into(),
            Cell::number(none.len() as f64, 0),
            cell(measure(Measure::NoneCalledElse, &all), 3),
            cell(measure(Measure::InSet90, &none), 3),
            cell(measure(Measure::Unknown, &listed), 3),
            cell(measure(Measure::ConfidentWrong, &all), 3),
            cell(measure(Measure::CalibrationError, &all), 3),
            cell(calibration_by_chance(&reliability(all.iter().copied())).into(), 3),
            cell(measure(Measure::CalibrationP, &all), 3),
            cell(measure(Measure::LogScore, &all), 2),
            cell(measure(Measure::LogScoreEvidence, &all), 2),
            cell(measure(Measure::LogScoreFrequencies, &all), 2),
        ];
        table = table.row(is_ours(name), cells);
    }
    table
}

/// A pool's scenarios, one by one.
fn worlds(results: &Results) -> Table {
    let heads = [
        "diagnoser",
        "scenario",
        "cases",
        "without effect",
        "called anything else",
        "from 10 nats on",
        "top group right",
        "in 90 % set",
        "set size",
        "closed / oracle's",
        "wrong where P >= 0.9, all cases",
        "calibration error",
        "by chance",
    ];
    let mut table = Table::new("World by world", &heads).caption(
        "The same, scenario by scenario: of the planted cases those whose log separates the truth by 10 nats and more, and what \
         concerns all.",
    );
    for (i, name) in results.question.diagnosers.iter().enumerate() {
        let mut first = 0;
        for (scenario, count) in &results.of {
            let numbers = first..first + count;
            first += count;
            let all: Vec<Asked<'_>> = results.records[numbers].iter().filter_map(|it| asked_of(it, i)).collect();
            let none = all.iter().filter(|it| !it.is_planted()).count();
            let far = |it: &&Asked<'_>| it.is_planted() && it.is_separated(10.0..f64::INFINITY);
            let far: Vec<Asked<'_>> = all.iter().filter(far).copied().collect();
            let cells = [
                name.as_str().into(),
                scenario.as_str().into(),
                Cell::number(all.len() as f64, 0),
                Cell::number(none as f64, 0),
                cell(measure(Measure::NoneCalledElse, &all), 3),
                Cell::number(far.len() as f64, 0),
                cell(measure(Measure::TopGroupRight, &far), 3),
                cell(measure(Measure::InSet90, &far), 3),
                cell(measure(Measure::SetSize, &far), 2),
                cell(measure(Measure::ClosedRatio, &far), 3),
                cell(measure(Measure::ConfidentWrong, &all), 3),
                cell(measure(Measure::CalibrationError, &all), 3),
                cell(calibration_by_chance(&reliability(all.iter().copied())).into(), 3),
            ];
            table = table.row(is_ours(name), cells);
        }
    }
    table
}

/// Cases with two effects, by what the one that shows less shows beside the other.
fn two_effects(results: &Results) -> Table {
    let heads = [
        "diagnoser",
        "each beside the other (nats)",
        "cases",
        "named as it is",
        "nothing else named",
        "called unknown",
        "wrong name where P >= 0.9",
    ];
    let mut table = Table::new("Two effects", &heads).caption(
        "Cases with two effects, by how many nats the log would be less likely without the one that shows less, the other \
         of any size. Good: from 10 nats on both named in >= 0.8, and nothing that is not there in >= 0.9; of one in the \
         list and one that is not a wrong name with P >= 0.9 in <= 0.05.",
    );
    for (i, name) in results.question.diagnosers.iter().enumerate() {
        for stratum in STRATA {
            let is_in = |it: &Asked<'_>| stratum.holds_nats(it.reference.d_each);
            let cases: Vec<Asked<'_>> =
                asked(results, i).filter(|it| it.record.planted.len() == 2 && is_in(it)).collect();
            let cells = [
                name.as_str().into(),
                stratum.name.into(),
                Cell::number(cases.len() as f64, 0),
                cell(measure(Measure::NamedRight, &cases), 3),
                cell(measure(Measure::NothingElseNamed, &cases), 3),
                cell(measure(Measure::Unknown, &cases), 3),
                cell(measure(Measure::ConfidentlyMisnamed, &cases), 3),
            ];
            table = table.row(is_ours(name), cells);
        }
    }
    table
}

/// Ties, and what other logs make of them.
fn next_logs(results: &Results) -> Table {
    let heads = ["diagnoser", "ties with advice", "split as advised", "split by old commands", "advised says more"];
    let mut table = Table::new("What to record next", &heads).caption(
        "Logs in which the truth is one of the two most probable effects, neither is ruled out, and commands are advised \
         that should split them. Both logs are then recorded in the true world, as long as is advised: driven so, and with \
         the old commands, and each is held against the nominal world driven alike. Split: the log speaks for the truth by 3 nats \
         and more. Good: >= 0.8 as advised, and more than by old commands.",
    );
    for (i, name) in results.question.diagnosers.iter().enumerate() {
        let all: Vec<Asked<'_>> = asked(results, i).collect();
        let ties = all.iter().filter(|it| it.answer.next.is_some()).count();
        let of = |what: Measure| cell(measure(what, &all), 3);
        let shares = [Measure::NextSplits, Measure::AgainSplits, Measure::NextBeatsAgain].map(of);
        let cells = [name.as_str().into(), Cell::number(ties as f64, 0)].into_iter().chain(shares);
        table = table.row(is_ours(name), cells);
    }
    table
}

/// Truths down, names across.
fn matrix(results: &Results, i: usize, name: &str) -> Table {
    let counts = confusion(asked(results, i));
    let truths: BTreeSet<String> = asked(results, i).map(|it| truth_word(it.record)).collect();
    let words: BTreeSet<String> = asked(results, i).map(|it| named_word(it.answer)).collect();
    let columns: Vec<&str> = truths.union(&words).map(String::as_str).collect();
    let mut heads = vec!["truth"];
    heads.extend(columns.iter().copied());
    let caption = format!("What was planted, by rows, and what `{name}` named, by columns: numbers of cases.");
    let mut table = Table::new(&format!("Confusion, {name}"), &heads).caption(caption);
    for truth in &truths {
        let count = |word: &&str| counts.get(&(truth.clone(), (*word).to_owned())).copied();
        let number = |count: Option<u32>| count.map_or_else(Cell::default, |count| Cell::number(f64::from(count), 0));
        let cells = std::iter::once(truth.as_str().into()).chain(columns.iter().map(count).map(number));
        table = table.row(RowKind::Ours, cells);
    }
    table
}

/// Every effect planted alone, in the catalogue's words; of a pool none, for one name has sizes of its own in each world.
#[must_use]
pub fn planted_alone(results: &Results) -> BTreeSet<String> {
    let records = if results.is_pool() { &[] } else { &results.records[..] };
    let alone = records.iter().filter(|record| record.planted.len() == 1 && record.withheld.is_empty());
    alone.flat_map(|record| record.planted.clone()).filter(|name| name != NONE).collect()
}

fn powers(results: &Results) -> Table {
    let heads = ["effect", "diagnoser", "size", "cases", "top group right"];
    let mut table = Table::new("Power", &heads)
        .caption("How often an effect planted alone is the most probable cause, by its size (middle of the bin).");
    for effect in planted_alone(results) {
        for (i, name) in results.question.diagnosers.iter().enumerate() {
            for point in power(asked(results, i), &effect) {
                let cells = [
                    effect.as_str().into(),
                    name.as_str().into(),
                    Cell { text: format!("{:.3e}", point.size), value: Some(point.size), ..Cell::default() },
                    Cell::number(f64::from(point.right.of), 0),
                    cell(point.right.into(), 2),
                ];
                table = table.row(is_ours(name), cells);
            }
        }
    }
    table
}

/// What came of every expected answer.
#[must_use]
pub fn verdicts(results: &Results) -> Vec<Verdict> {
    results.question.expect.iter().map(|expect| verdict(results, expect)).collect()
}

fn verdict(results: &Results, expect: &Expect) -> Verdict {
    let i = results.question.diagnosers.iter().position(|name| *name == expect.diagnoser);
    let is_asked = |it: &Asked<'_>| {
        let (least, most) = (expect.d_sep_min, expect.d_sep_max);
        let nats = least.unwrap_or(f64::NEG_INFINITY)..most.unwrap_or(f64::INFINITY);
        ((least, most) == (None, None) || it.is_separated(nats))
            && expect.each_min.is_none_or(|least| it.reference.d_each.is_some_and(|nats| nats >= least))
            && expect.effects.is_none_or(|count| it.record.planted.len() == count)
    };
    let cases: Vec<Asked<'_>> = i.map_or_else(Vec::new, |i| asked(results, i).filter(is_asked).collect());
    let measured = measure(expect.measure, &cases);
    let holds = measured.value.is_some_and(|value| {
        expect.min.is_none_or(|least| value >= least) && expect.max.is_none_or(|most| value <= most)
    });
    let bound = |word: &str, bound: Option<f64>| bound.map(|bound| format!("{word} {bound}"));
    let bounds: Vec<String> = bound("at least", expect.min).into_iter().chain(bound("at most", expect.max)).collect();
    let from = expect.d_sep_min.map_or_else(String::new, |least| format!(" from {least} nats on"));
    let to = expect.d_sep_max.map_or_else(String::new, |most| format!(" below {most} nats"));
    let count = expect.effects.map_or_else(String::new, |count| format!(" with {count} effects"));
    let each = expect.each_min.map_or_else(String::new, |least| format!(" that each show by {least} nats"));
    let found = measured.value.map_or_else(|| "no number".to_owned(), |value| format!("{value:.3}"));
    let what = head(expect.measure);
    let claim = format!(
        "{}: {what}{count}{each}{from}{to}: {} ({found}, {} cases)",
        expect.diagnoser,
        bounds.join(", "),
        cases.len()
    );
    Verdict { claim, holds }
}

/// A measure in words.
fn head(measure: Measure) -> &'static str {
    match measure {
        Measure::NoneCalledElse => "no effect called anything else",
        Measure::ConfidentlyMisnamed => "given a wrong name with P >= 0.9",
        Measure::ClosedLow => "10th percentile of closed / oracle's",
        Measure::CalibrationError => "calibration error",
        Measure::CalibrationP => "probabilities as far off by chance",
        Measure::LogScore => "log score",
        Measure::LogScoreEvidence => "log score by evidence alone",
        Measure::LogScoreFrequencies => "log score by frequencies",
        Measure::NamedRight => "what is named is the truth",
        Measure::NothingElseNamed => "nothing named that is not there",
        Measure::NextSplits => "ties that the advised log splits",
        Measure::AgainSplits => "ties that another log of old commands splits",
        Measure::NextBeatsAgain => "ties of which the advised log says more than another of old commands",
        other => MEASURED.iter().find(|(it, _, _)| *it == other).map_or("", |(_, head, _)| *head),
    }
}
