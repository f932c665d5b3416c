//! Section 4.4.3 of Stronger (2008): its side of a sweep.

pub mod published;
pub mod quantities;
pub mod rows;
pub mod tables;

use asami_dataset::{Action, Dataset, Log, Models, Survey};
use serde::{Deserialize, Serialize};

use super::outcome::Outcome;
use super::table::Published;
use super::tally::{Group, Tallied};
use super::{CannotSweep, Finished, Record, Results};
use crate::report;
use crate::scenario::{Era, Origin, Row, Scenario, Start};
use crate::scorer::stride::{Scores, Yardstick};
use crate::study::{Finishing, Reference, Study};
use crate::trial::{Trial, of_scores};

/// Models of chapter 4 along a line, before and after the robot changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Strides;

/// Something of each era; of a robot that does not change, there is no era after.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ByEra<T> {
    /// Before the change.
    pub before: T,
    /// After it.
    pub after: Option<T>,
}

impl<T> ByEra<T> {
    /// That of `era`.
    pub fn of(&self, era: Era) -> Option<&T> {
        match era {
            Era::Before => Some(&self.before),
            Era::After => self.after.as_ref(),
        }
    }

    fn map<U>(&self, f: impl Fn(&T) -> U) -> ByEra<U> {
        ByEra { before: f(&self.before), after: self.after.as_ref().map(f) }
    }
}

/// What tables need of an era's truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Greatest less least speed.
    pub speed_range_m_per_s: Option<f64>,
    /// Greatest less least mean height.
    pub height_range_px: Option<f64>,
}

impl Study for Strides {
    type Scores = ByEra<Scores>;
    type Yardstick = ByEra<Yardstick>;
    type Truth = ByEra<Truth>;

    fn yardstick(scenario: &Scenario, dataset: &Dataset, changed: Option<&Survey>) -> ByEra<Yardstick> {
        let Origin::Simulated(simulation) = &scenario.origin else { return ByEra::default() };
        let stride = |action: &Action| match *action {
            Action::Legs { id, ay_m_per_s, .. } => Some((id?, ay_m_per_s)),
            _ => None,
        };
        let strides: Vec<(u16, f64)> = simulation.suite.strides().iter().filter_map(stride).collect();
        let before = dataset.truth.survey.as_ref().map(|survey| Yardstick::surveyed(survey, &strides));
        let after = changed.map(|survey| Yardstick::surveyed(survey, &strides));
        ByEra { before: before.unwrap_or_default(), after }
    }

    fn given(scenario: &Scenario, row: &Row, log: &Log, _: &ByEra<Yardstick>) -> Result<Models, String> {
        let Some(start) = row.start else { return Ok(Models::default()) };
        scenario.starting.models(start, log).map_err(|lack| lack.to_string())
    }

    fn truth(yardstick: &ByEra<Yardstick>) -> ByEra<Truth> {
        yardstick
            .map(|era| Truth { speed_range_m_per_s: era.speed_range_m_per_s(), height_range_px: era.height_range_px() })
    }

    fn score(yardstick: &ByEra<Yardstick>, models: &Models) -> ByEra<Scores> {
        yardstick.map(|era| era.score(models))
    }

    fn faults(
        scenario: &Scenario,
        row: &Row,
        yardstick: &ByEra<Yardstick>,
        models: &Models,
        scores: &ByEra<Scores>,
    ) -> Vec<String> {
        let own = yardstick.of(row.era).zip(scores.of(row.era));
        own.map_or_else(Vec::new, |(era, scores)| era.faults(models, scores, scenario.divergence.r2_min))
    }

    /// The floor: the best cubic f; and what starting models are as they are.
    fn references(scenario: &Scenario, log: &Log, yardstick: &ByEra<Yardstick>) -> Vec<Reference<ByEra<Scores>>> {
        let floor = yardstick.map(|era| era.score(&Models { sensor: era.best_sensor(3), ..Models::default() }));
        let unlearned = scenario.starting.models(Start::Attempted, log).map(|models| Self::score(yardstick, &models));
        let floor = Reference { name: "floor".to_owned(), start: None, scores: floor };
        let unlearned =
            unlearned.map(|scores| Reference { name: "unlearned".to_owned(), start: Some(Start::Attempted), scores });
        std::iter::once(floor).chain(unlearned.ok()).collect()
    }

    fn finish(results: Results<Self>, finishing: &Finishing<'_>) -> Result<Finished, CannotSweep> {
        let trials = rows::trials(&results);
        let published: &[Published] = match results.scenario.origin {
            Origin::Simulated(_) => published::section_4_4_3(results.changed.is_some()),
            Origin::Recorded(_) => &[],
        };
        let compared = ["action_rmse_mm_per_s", "sensor_rmse_px"];
        let outcome = Outcome::of(results, &[tables::TABLE], published, ("em_1d_published", &compared));
        outcome.write(&trials, finishing)?;
        let footnote = "Errors are root mean squares after scaling: action models as k A(c), sensor models as f(a + b d), \
                        with the k, a and b that fit the truth best (Stronger 2008, sections 3.3.2 and 4.4.3).";
        report::chapter4::write(&outcome, &report::stride::figures(&outcome.results), footnote, finishing)?;
        Ok(outcome.finished())
    }
}

impl Tallied for Strides {
    fn names() -> &'static [&'static str] {
        &quantities::NAMES
    }

    fn value(record: &Record<Self>, trial: &Trial<ByEra<Scores>>, truth: Option<Era>, quantity: usize) -> Option<f64> {
        let era = truth.unwrap_or_default();
        let (scores, truth) = trial.scores.of(era).zip(record.truth.of(era))?;
        (quantities::QUANTITIES.get(quantity)?.of)(trial, scores, truth)
    }

    fn reference(record: &Record<Self>, scores: &ByEra<Scores>, truth: Option<Era>, quantity: usize) -> Option<f64> {
        Self::value(record, &of_scores(record.case, *scores), truth, quantity)
    }

    fn groups(results: &Results<Self>) -> Vec<Group> {
        let eras = [Some(Era::Before), results.changed.as_ref().map(|_| Era::After)];
        eras.into_iter().flatten().map(|era| Group { truth: Some(era), ..Group::default() }).collect()
    }
}
