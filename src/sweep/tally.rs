//! Statistics of chapter 4's quantities: of each row of a scenario, in each group of its trials.

use asami_dataset::store::number;
use asami_math::statistics;

use super::rows::optional;
use super::spread::{Spread, stream};
use super::verdict::{Verdict, name, shares};
use super::{Record, Results};
use crate::scenario::{Era, Expect, Start};
use crate::study::Study;
use crate::trial::{Ending, Trial};

/// Trials that are told apart in tables: by whose log it is, what is left in it, or whose truth they are
/// held against. What does not tell apart is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Group {
    /// Of which robot.
    pub robot: Option<u16>,
    /// With how many landmarks.
    pub landmarks: Option<u16>,
    /// Against the truth of which era.
    pub truth: Option<Era>,
}

impl Group {
    /// Whether a case's trials belong to it.
    fn has<S: Study>(&self, record: &Record<S>) -> bool {
        record.case.robot == self.robot && record.case.landmarks == self.landmarks
    }
}

/// A study whose trials have numbers, each under the name of its column in `trials.csv`.
pub trait Tallied: Study {
    /// The names.
    fn names() -> &'static [&'static str];

    /// The number of a trial against a group's truth, if it has one.
    fn value(record: &Record<Self>, trial: &Trial<Self::Scores>, truth: Option<Era>, quantity: usize) -> Option<f64>;

    /// The same of what needs the truth and is no learner's: a reference's scores.
    fn reference(record: &Record<Self>, scores: &Self::Scores, truth: Option<Era>, quantity: usize) -> Option<f64>;

    /// The groups, in order.
    fn groups(results: &Results<Self>) -> Vec<Group>;
}

/// One row of the scenario in one group.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    /// Which row.
    pub row: usize,
    /// Which group.
    pub group: Group,
    /// How many trials converged.
    pub converged: usize,
    /// Of how many.
    pub trials: usize,
    /// Of each quantity, over the trials that converged.
    pub spreads: Vec<Option<Spread>>,
}

impl Tally {
    /// The statistics of a quantity.
    #[must_use]
    pub fn of<S: Tallied>(&self, quantity: &str) -> Option<&Spread> {
        self.spreads.get(S::names().iter().position(|name| *name == quantity)?)?.as_ref()
    }
}

/// One row against another over the logs on which both converged.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The row.
    pub row: usize,
    /// The row that it is held against.
    pub against: usize,
    /// In which group.
    pub group: Group,
    /// What is compared: an index into the study's quantities.
    pub quantity: usize,
    /// On how many logs.
    pub pairs: usize,
    /// Median of the differences, row less `against`.
    pub median_difference: f64,
    /// Two-sided p of Wilcoxon's signed-rank test.
    pub p: f64,
}

/// The cases of a recording that statistics tell apart, in order; one group of everything else.
#[must_use]
pub fn parts<S: Study>(results: &Results<S>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for record in &results.records {
        let group = Group { robot: record.case.robot, landmarks: record.case.landmarks, truth: None };
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups
}

/// Every row in every group, by row.
#[must_use]
pub fn tallies<S: Tallied>(results: &Results<S>) -> Vec<Tally> {
    let groups = S::groups(results);
    (0..results.scenario.rows.len())
        .flat_map(|row| groups.iter().map(move |group| (row, *group)))
        .map(|(row, group)| tally(results, row, group))
        .collect()
}

fn tally<S: Tallied>(results: &Results<S>, row: usize, group: Group) -> Tally {
    let records = results.counted().filter(|record| group.has(record));
    let trials: Vec<_> = records.filter_map(|record| Some((record, record.trials.get(row)?))).collect();
    let converged: Vec<_> = trials.iter().filter(|(_, trial)| trial.ending == Ending::Converged).collect();
    let spread = |quantity: usize| {
        let of = |(record, trial): &&(&Record<S>, &Trial<S::Scores>)| S::value(record, trial, group.truth, quantity);
        let values: Vec<f64> = converged.iter().filter_map(of).collect();
        let truth = group.truth.map_or("", Era::name);
        let name = format!("{}{truth}", S::names()[quantity]);
        Spread::of(&values, &stream(&results.scenario.rows[row], &name))
    };
    Tally {
        row,
        group,
        converged: converged.len(),
        trials: trials.len(),
        spreads: (0..S::names().len()).map(spread).collect(),
    }
}

/// Every row against the row of `published` with the same start and era, in each group, of these quantities.
#[must_use]
pub fn comparisons<S: Tallied>(results: &Results<S>, published: &str, quantities: &[&str]) -> Vec<Comparison> {
    let rows = &results.scenario.rows;
    let mut found = Vec::new();
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| row.label != published) {
        let is_against = |(_, other): &(usize, &crate::scenario::Row)| {
            // A learner without a start is held against the published start.
            let start = row.start.or(Some(Start::Published));
            let is_alike = other.start == start || other.start == row.start;
            other.label == published && is_alike && (other.era, other.duration_s) == (row.era, row.duration_s)
        };
        let Some((against, _)) = rows.iter().enumerate().find(is_against) else { continue };
        for group in S::groups(results) {
            let indices = quantities.iter().filter_map(|name| S::names().iter().position(|other| other == name));
            found.extend(indices.filter_map(|quantity| compare(results, i, against, group, quantity)));
        }
    }
    found
}

fn compare<S: Tallied>(
    results: &Results<S>,
    row: usize,
    against: usize,
    group: Group,
    quantity: usize,
) -> Option<Comparison> {
    let of = |record: &Record<S>, row: usize| {
        let trial = record.trials.get(row).filter(|trial| trial.ending == Ending::Converged)?;
        S::value(record, trial, group.truth, quantity)
    };
    let records = results.counted().filter(|record| group.has(record));
    let differences: Vec<f64> = records.filter_map(|record| Some(of(record, row)? - of(record, against)?)).collect();
    Some(Comparison {
        row,
        against,
        group,
        quantity,
        pairs: differences.len(),
        median_difference: statistics::median(&differences)?,
        p: statistics::wilcoxon_signed_rank(&differences)?,
    })
}

/// Columns that name a group, and a group's fields under them.
const GROUP_HEADS: &str = "robot,landmarks,truth_era";

fn group_fields(group: &Group) -> String {
    let id = |id: Option<u16>| id.map_or_else(String::new, |id| id.to_string());
    format!("{},{},{}", id(group.robot), id(group.landmarks), group.truth.map_or("", Era::name))
}

fn row_fields<S: Study>(results: &Results<S>, row: usize) -> String {
    let row = &results.scenario.rows[row];
    let start = row.start.map_or("", Start::name);
    format!("{},{start},{},{}", row.label, row.era.name(), number(row.duration_s))
}

/// `statistics.csv`.
#[must_use]
pub fn statistics_csv<S: Tallied>(results: &Results<S>, tallies: &[Tally]) -> String {
    let mut text = format!(
        "learner,starting_model,learned_era,duration_s,{GROUP_HEADS},quantity,converged,trials,median,mean,sd,\
         interquartile_mean,mean_95_low,mean_95_high\n"
    );
    for tally in tallies {
        for (name, spread) in S::names().iter().zip(&tally.spreads) {
            let Some(spread) = spread else { continue };
            let [low, high] = spread.interval.map_or([None; 2], |interval| interval.map(Some));
            let values =
                [Some(spread.median), Some(spread.mean), spread.sd, Some(spread.interquartile_mean), low, high];
            let (row, group) = (row_fields(results, tally.row), group_fields(&tally.group));
            let (converged, trials) = (tally.converged, tally.trials);
            let values = values.map(optional).join(",");
            text.push_str(&format!("{row},{group},{name},{converged},{trials},{values}\n"));
        }
    }
    text
}

/// `comparisons.csv`.
#[must_use]
pub fn comparisons_csv<S: Tallied>(results: &Results<S>, comparisons: &[Comparison]) -> String {
    let mut text = format!(
        "learner,starting_model,learned_era,duration_s,{GROUP_HEADS},against_learner,quantity,pairs,\
         median_difference,wilcoxon_p\n"
    );
    for it in comparisons {
        let (row, group) = (row_fields(results, it.row), group_fields(&it.group));
        let (against, quantity) = (&results.scenario.rows[it.against].label, S::names()[it.quantity]);
        let (pairs, difference, p) = (it.pairs, number(it.median_difference), number(it.p));
        text.push_str(&format!("{row},{group},{against},{quantity},{pairs},{difference},{p}\n"));
    }
    text
}

/// Every claim of the scenario's `[[expect]]`, in order, of every group that it is about.
#[must_use]
pub fn verdicts<S: Tallied>(results: &Results<S>, tallies: &[Tally]) -> Vec<Verdict> {
    let rows = &results.scenario.rows;
    let about = |expect: &Expect, tally: &Tally| {
        let Group { robot, landmarks, truth } = tally.group;
        expect.is_about(&rows[tally.row])
            && (expect.robot.is_none() || expect.robot == robot)
            && (expect.landmarks.is_none() || expect.landmarks == landmarks)
            && truth.is_none_or(|truth| truth == expect.truth.unwrap_or(expect.era))
    };
    let mut verdicts = Vec::new();
    for expect in &results.scenario.expect {
        for tally in tallies.iter().filter(|tally| about(expect, tally)) {
            let name = format!("{}{}", name(&rows[tally.row]), in_words(&tally.group, rows[tally.row].era));
            let claims = shares(expect, tally.converged, tally.trials).into_iter().chain(bounds::<S>(expect, tally));
            verdicts.extend(claims.map(|(claim, holds)| Verdict { claim: format!("{name}: {claim}"), holds }));
        }
    }
    verdicts
}

fn in_words(group: &Group, learned: Era) -> String {
    let robot = group.robot.map_or_else(String::new, |robot| format!(", robot {robot}"));
    let landmarks = group.landmarks.map_or_else(String::new, |landmarks| format!(", {landmarks} landmarks"));
    let truth = group.truth.filter(|truth| *truth != learned);
    let truth = truth.map_or_else(String::new, |truth| format!(", against the truth {} the change", truth.name()));
    format!("{robot}{landmarks}{truth}")
}

fn bounds<S: Tallied>(expect: &Expect, tally: &Tally) -> Vec<(String, bool)> {
    let claim = |name: &str, bound: f64, words: &str, holds: fn(f64, f64) -> bool| {
        let median = tally.of::<S>(name).map(|spread| spread.median);
        let found = median.map_or_else(|| "no number".to_owned(), |median| format!("{median:.4}"));
        (format!("median {name} {words} {bound} ({found})"), median.is_some_and(|median| holds(median, bound)))
    };
    let most =
        expect.median_max.iter().map(|(name, bound)| claim(name, *bound, "at most", |found, most| found <= most));
    let least =
        expect.median_min.iter().map(|(name, bound)| claim(name, *bound, "at least", |found, least| found >= least));
    most.chain(least).collect()
}
