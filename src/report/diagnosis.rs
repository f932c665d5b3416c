//! The report of a diagnosis: where, which, how far, and what to do next.

use std::collections::BTreeSet;

use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::{Cause, Cell as Place, Verdict};
use asami_math::statistics::wilson_interval;
use asami_sim::effects::catalogue;

use super::{Cell, Plate, Report, RowKind, Section, Table};
use crate::diagnose::words::{self, digits, estimated, joined, kind, share, unit, verdict, with_unit};
use crate::draw::map::{Map, Patch};
use crate::draw::{Figure, Mark, Stroke};

/// What a report says beside the diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Beside {
    /// The log, by its folder's name.
    pub log: String,
    /// The nominal scenario's name.
    pub nominal: String,
    /// What the log cannot show.
    pub notes: Vec<String>,
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// How often a cause given so much probability was the true one, of the calibration's cases: claimed, found, cases.
    pub reliability: Vec<[f64; 3]>,
    /// How it was made: what, and its value.
    pub made_with: Vec<(String, String)>,
}

/// Channels in the order of every report.
const CHANNELS: [&str; 13] = [
    "forward",
    "sideways",
    "turn",
    "height_px",
    "bearing_rad",
    "range_m",
    "detection",
    "timing",
    "acceleration",
    "yaw_rate",
    "lidar_range",
    "lidar_angle",
    "intensity",
];

/// The report.
#[must_use]
pub fn report(diagnosis: &Diagnosis, beside: &Beside) -> Report {
    let question = format!("Where do the log {} and the world of {} part, and why?", beside.log, beside.nominal);
    let title = format!("Diagnosis of {}", beside.log);
    let mut report = Report::new(&title, &question)
        .answer(answer(diagnosis))
        .section(place(diagnosis))
        .section(cause(diagnosis, beside))
        .section(how_far(diagnosis))
        .section(next(diagnosis, beside));
    if let Some(section) = reliability(diagnosis, beside) {
        report = report.section(section);
    }
    report = report.section(visible(diagnosis)).footnote(
        "Excess: nats per observation by which the log is less likely in the nominal world than under the best model that \
         fits it, on blocks that no fit has seen. Misfit: nats per observation more than the world itself expects.",
    );
    let made = beside.made_with.iter();
    made.fold(report, |report, (what, value)| report.made_with(what.as_str(), value.as_str()))
}

fn answer(diagnosis: &Diagnosis) -> String {
    let mut answer = verdict(diagnosis);
    if let Some(first) = diagnosis.places.first() {
        answer += &format!(". {:.0} % of the gap lies in {}, {}", 100.0 * first.share, first.channel, first.regime);
    }
    if let (Some(closed), Verdict::Named | Verdict::Tied) = (diagnosis.how_far.closed, diagnosis.verdict) {
        answer += &format!(". With the effect in it, the world closes {:.0} % of the gap", 100.0 * closed);
    }
    answer + "."
}

fn place(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("Where");
    if diagnosis.places.is_empty() {
        return section.text("In no cell does the log part from the nominal world by more than chance allows.");
    }
    let mut table = Table::new("Cells", &["channel", "regime", "what differs", "share (%)", "95 %", "p"]).caption(
        "Cells in which the log parts from the nominal world, false discoveries held at 5 %. A share is what the cell \
         holds of the gap; regimes of one partition add up.",
    );
    for Place { channel, regime, kind: what, share, interval, p } in &diagnosis.places {
        let p = Cell { text: format!("{p:.1e}"), value: Some(*p), hint: String::new() };
        table = table.row(
            RowKind::Ours,
            [
                channel.as_str().into(),
                regime.as_str().into(),
                kind(*what).into(),
                Cell::number(100.0 * share, 0),
                format!("{:.0} to {:.0}", 100.0 * interval[0], 100.0 * interval[1]).into(),
                p,
            ],
        );
    }
    section.figure(&map(diagnosis)).table(table)
}

/// Channel by regime, the largest shares on top.
fn map(diagnosis: &Diagnosis) -> Map {
    let places = &diagnosis.places;
    let of_places = places.iter().map(|place| place.channel.as_str());
    let there: BTreeSet<&str> = of_places.chain(diagnosis.how_far.channels.keys().map(String::as_str)).collect();
    let known = CHANNELS.iter().copied().filter(|channel| there.contains(channel));
    let columns: Vec<&str> = known.chain(there.iter().copied().filter(|it| !CHANNELS.contains(it))).collect();
    let mut regimes: Vec<&str> = Vec::new();
    for place in places {
        if !regimes.contains(&place.regime.as_str()) {
            regimes.push(&place.regime);
        }
    }
    let greatest = places.iter().map(|place| place.share).fold(1e-9, f64::max);
    let patch = |regime: &str, channel: &str| {
        let here = places.iter().filter(|place| place.regime == regime && place.channel == channel);
        let most = here.reduce(|a, b| if b.share > a.share { b } else { a })?;
        let [low, high] = most.interval;
        Some(Patch {
            shade: most.share / greatest,
            lines: vec![format!("{:.0} %", 100.0 * most.share), kind(most.kind).to_owned()],
            hint: format!("{channel}, {regime}: {:.0} to {:.0} %, p = {:.1e}", 100.0 * low, 100.0 * high, most.p),
        })
    };
    let row = |regime: &&str| {
        let cells = columns.iter().map(|channel| patch(regime, channel)).collect();
        ((*regime).to_owned(), cells)
    };
    Map {
        name: "Gap map".to_owned(),
        title: "Shares of the gap, by channel and regime".to_owned(),
        caption:
            "Darker cells hold more of the gap; the word says what differs. Empty cells differ by no more than chance \
                  allows. Good: one dark cell, which says where to look first."
                .to_owned(),
        rows: regimes.iter().map(row).collect(),
        columns: columns.into_iter().map(str::to_owned).collect(),
    }
}

/// Causes less probable than this stand only in the file: each has as much for the chance that all evidence misleads.
const SHOWN: f64 = 1e-3;

/// So many effects at once are written out beside a bar, and described in the table.
const FEW: usize = 2;

/// A cause's name beside its bar: of many effects the first, with the cause's rank, since others may begin alike.
fn label(rank: usize, effects: &[String]) -> String {
    match effects {
        [first, ..] if effects.len() > FEW => format!("{rank}: {first} + {} more", effects.len() - 1),
        _ => joined(effects),
    }
}

fn cause(diagnosis: &Diagnosis, beside: &Beside) -> Section {
    let heads =
        ["cause", "probability", "evidence (nats)", "fits by itself (p)", "acts in", "values, 90 %", "what it is"];
    let mut table = Table::new("Causes", &heads).caption(
        "Causes by probability, down to 0.1 % (`diagnosis.json` has the others). Evidence: how much better than `none` the \
         log bears a cause out, sizes averaged over. A cause that fits by itself with p below 0.01 leaves something \
         unexplained.",
    );
    let what = |names: &[String]| {
        let of = |name: &String| catalogue().into_iter().find(|about| about.name == name).map(|about| about.what);
        // Of many at once the names must do.
        let few = if names.len() <= FEW { names } else { &[] };
        few.iter().filter_map(of).collect::<Vec<_>>().join(" ")
    };
    for cause in diagnosis.which.iter().filter(|cause| cause.probability >= SHOWN) {
        let probability = Cell { text: share(cause.probability), value: Some(cause.probability), hint: String::new() };
        let mut acts: Vec<String> = cause.place.iter().cloned().collect();
        acts.extend(cause.block.iter().map(|block| format!("block {}", block.replace('_', " "))));
        acts.extend(cause.behaves_like.iter().map(|like| format!("like {}", like.replace('+', " + "))));
        let values = cause.parameters.iter().map(|(path, it)| format!("{path} = {}", estimated(path, it)));
        table = table.row(
            RowKind::Ours,
            [
                joined(&cause.effects).into(),
                probability,
                Cell::number(cause.evidence_nats, 1),
                cause.adequacy_p.map_or_else(Cell::default, |p| Cell::number(p, 3)),
                acts.join(", ").into(),
                values.collect::<Vec<_>>().join("; ").into(),
                what(&cause.effects).into(),
            ],
        );
    }
    let ranked: Vec<(usize, &Cause)> = (1..).zip(diagnosis.which.iter().take(12)).collect();
    let bars: Vec<(String, Vec<[f64; 2]>)> = ranked
        .into_iter()
        .rev()
        .map(|(rank, cause)| (label(rank, &cause.effects), vec![[0.0, cause.probability]]))
        .collect();
    let figure = Figure::new("Ranked causes", "Probability of each cause")
        .x("probability", "")
        .x_range(0.0, 1.0)
        .rows(bars.iter().map(|(name, bars)| (name.as_str(), bars.clone())))
        .caption("Good: one long bar. Two of like length are a tie, which the next experiment may split.");
    let mut section = Section::new("Which").figure(&figure).table(table);
    if !diagnosis.set90.is_empty() {
        let set: Vec<String> = diagnosis.set90.iter().map(|effects| format!("`{}`", joined(effects))).collect();
        section =
            section.text(format!("The smallest set that holds the true cause in 90 % of cases: {}.", set.join(", ")));
    }
    for group in &diagnosis.cannot_tell_apart {
        let group: Vec<String> = group.iter().map(|name| format!("`{name}`")).collect();
        section = section.text(format!("At the sizes found, this log cannot tell apart {}.", group.join(", ")));
    }
    if !diagnosis.unsettled.is_empty() {
        let small: Vec<String> = diagnosis.unsettled.iter().map(words::unsettled).collect();
        section = section.text(format!(
            "Small parts of the gap, of which the log does not settle what they are, and which are not named: {}.",
            small.join("; ")
        ));
    }
    if !beside.without.is_empty() {
        section = section.text(format!("Taken out of the catalogue: `{}`.", beside.without.join("`, `")));
    }
    section
}

fn how_far(diagnosis: &Diagnosis) -> Section {
    let far = &diagnosis.how_far;
    let mut section = Section::new("How far").text(match (far.closed, far.interval) {
        (Some(closed), Some([low, high])) => format!(
            "With the most probable cause in it, the world closes {:.0} % of the gap (95 %: {:.0} to {:.0} %): from {} to {} \
             nats per observation.",
            100.0 * closed,
            100.0 * low,
            100.0 * high,
            digits(far.excess_before),
            digits(far.excess_after)
        ),
        _ => "How much of the gap would be closed is not reported: it cannot be told from none on blocks that no fit has seen."
            .to_owned(),
    });
    let mut table = Table::new("Before and after", &["", "before", "after", "after / before"])
        .caption("Excess and misfit in nats per observation; root mean squares of the innovations in their units.");
    let mut add = |name: &str, before: f64, after: f64| {
        let ratio = if before > 0.0 && after >= 0.0 { Cell::number(after / before, 2) } else { Cell::default() };
        let cell = |value: f64| Cell { text: digits(value), value: Some(value), hint: String::new() };
        table = std::mem::take(&mut table).row(RowKind::Ours, [name.into(), cell(before), cell(after), ratio]);
    };
    add("excess (nats)", far.excess_before, far.excess_after);
    add("misfit (nats)", far.misfit_before, far.misfit_after);
    for (channel, rms) in &far.channels {
        add(channel, rms.rms_before, rms.rms_after);
    }
    if !far.channels.is_empty() {
        section = section.figure(&before_and_after(diagnosis));
    }
    section = section.table(table);
    if far.comment.is_empty() { section } else { section.text(format!("About these numbers: {}.", far.comment)) }
}

/// Root mean squares with the cause in the world, in shares of those without.
fn before_and_after(diagnosis: &Diagnosis) -> Figure {
    let channels = diagnosis.how_far.channels.iter().filter(|(_, rms)| rms.rms_before > 0.0).rev();
    let bars: Vec<(String, Vec<[f64; 2]>)> =
        channels.map(|(name, rms)| (name.clone(), vec![[0.0, rms.rms_after / rms.rms_before]])).collect();
    Figure::new("Channels", "Innovations with the cause, in shares of those without")
        .x("RMS after / RMS before", "")
        .rows(bars.iter().map(|(name, bars)| (name.as_str(), bars.clone())))
        .caption(
            "Below 1: the cause brings the world nearer to the log in this channel. Above 1: it opens a gap there.",
        )
}

fn next(diagnosis: &Diagnosis, beside: &Beside) -> Section {
    let section = Section::new("Next experiment").text(match &diagnosis.next_experiment {
        Some(next) => match &diagnosis.next_keys {
            Some(keys) => format!("Record next: {next}. In the nominal scenario, {keys} drives so."),
            None => format!("Record next: {next}."),
        },
        None => "Nothing is tied: no further experiment is called for.".to_owned(),
    });
    beside.notes.iter().fold(section, |section, note| section.text(format!("This log: {note}.")))
}

fn reliability(diagnosis: &Diagnosis, beside: &Beside) -> Option<Section> {
    let on = diagnosis.calibrated_on.as_ref()?;
    let section = Section::new("Reliability").text(format!(
        "Probabilities were calibrated on {} planted cases of {}: {}.",
        on.cases, on.scenario, on.size_law
    ));
    if beside.reliability.is_empty() {
        return Some(section);
    }
    let points: Vec<[f64; 2]> = beside.reliability.iter().map(|[claimed, found, _]| [*claimed, *found]).collect();
    let bar = |[claimed, found, cases]: &[f64; 3]| {
        let right = (found * cases).round() as u32;
        let [low, high] = wilson_interval(right, *cases as u32, 0.95).unwrap_or([f64::NAN; 2]);
        [*claimed, *found, low, high]
    };
    let bars: Vec<[f64; 4]> = beside.reliability.iter().map(bar).collect();
    let figure = Figure::new("Reliability", "How often a probability was right")
        .x("probability given", "")
        .y("share of cases in which it was true", "")
        .x_range(0.0, 1.0)
        .y_range(0.0, 1.0)
        .line("perfect", Stroke::Dashed, [[0.0, 0.0], [1.0, 1.0]])
        .error_bars("cases", bars)
        .points("", Mark::Dot, points)
        .caption("Good: on the dashed line. Below it, probabilities are too bold.");
    Some(section.figures([Plate::from(&figure)]))
}

fn visible(diagnosis: &Diagnosis) -> Section {
    let mut table =
        Table::new("Smallest visible sizes", &["parameter", "smallest distance from its null value", "unit"])
            .caption("What this log would have shown of each effect. Smaller ones may be there all the same.");
    for (path, size) in &diagnosis.smallest_visible {
        let size = Cell { text: digits(*size), value: Some(*size), hint: with_unit(path, *size) };
        let unit = unit(path).filter(|unit| *unit != "1").unwrap_or_default();
        table = table.row(RowKind::Ours, [path.as_str().into(), size, unit.into()]);
    }
    let section = Section::new("What would have shown").table(table);
    if diagnosis.verdict == Verdict::None { section } else { section.folded() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_effects_are_counted_beside_a_bar_and_few_are_named() {
        let names =
            |n: usize| ["slope", "payload", "wheel_lag"][..n].iter().map(|it| (*it).to_owned()).collect::<Vec<_>>();
        let labels = [1, 2, 3].map(|n| label(4, &names(n)));
        assert_eq!(labels, ["slope", "slope + payload", "4: slope + 2 more"]);
    }
}
