//! Sections 4.4.1 and 4.4.2 of Stronger (2008): their side of a sweep.

pub mod published;
pub mod quantities;
pub mod rows;
pub mod tables;

use asami_dataset::{Dataset, Log, Models, Survey};
use asami_learners::em::consistency::nis_in_plane;
use asami_learners::line::Unit;
use serde::{Deserialize, Serialize};

use super::outcome::Outcome;
use super::tally::{self, Group, Tallied};
use super::{CannotSweep, Finished, Record, Results};
use crate::report;
use crate::scenario::{Era, Row, Scenario, Start};
use crate::scorer::plane::bound::bound;
use crate::scorer::plane::{Scores, Yardstick};
use crate::study::{Finishing, Reference, Study};
use crate::trial::{Trial, of_scores};

/// Models of chapter 4 in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct InPlane;

/// What tables need of the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Whether sizes are ranges in metres, not heights in pixels.
    pub in_metres: bool,
    /// True standard deviation of sizes.
    pub sigma1: Option<f64>,
    /// True standard deviation of bearings.
    pub sigma2_rad: Option<f64>,
    /// Greatest less least velocity: right, forward, turn.
    pub velocity_ranges: Option<[f64; 3]>,
    /// Greatest less least mean size.
    pub size_range: Option<f64>,
    /// The least that an unbiased learner of the velocities can err.
    pub bound: Option<[f64; 3]>,
}

impl Study for InPlane {
    type Scores = Scores;
    type Yardstick = Yardstick;
    type Truth = Truth;

    fn yardstick(_: &Scenario, dataset: &Dataset, _: Option<&Survey>) -> Yardstick {
        let Dataset { log, truth, .. } = dataset;
        let yardstick = Yardstick::of(log, truth);
        Yardstick { bound: bound(&yardstick, log, truth), ..yardstick }
    }

    fn given(scenario: &Scenario, row: &Row, log: &Log, _: &Yardstick) -> Result<Models, String> {
        let Some(start) = row.start else { return Ok(Models::default()) };
        scenario.starting.models(start, log).map_err(|lack| lack.to_string())
    }

    fn truth(yardstick: &Yardstick) -> Truth {
        Truth {
            in_metres: yardstick.unit == Unit::RangeM,
            sigma1: yardstick.sigma1,
            sigma2_rad: yardstick.sigma2_rad,
            velocity_ranges: yardstick.velocity_ranges(),
            size_range: yardstick.size_range(),
            bound: yardstick.bound,
        }
    }

    fn score(yardstick: &Yardstick, models: &Models) -> Scores {
        yardstick.score(models)
    }

    fn faults(scenario: &Scenario, _: &Row, yardstick: &Yardstick, models: &Models, scores: &Scores) -> Vec<String> {
        yardstick.faults(models, scores, scenario.divergence.r2_min)
    }

    fn inspect(log: &Log, models: &Models, scores: &mut Scores) {
        scores.nis = nis_in_plane(log, models);
    }

    /// The bound, where the truth is exact; the floor: the best cubic f; and what starting models are as they are.
    fn references(scenario: &Scenario, log: &Log, yardstick: &Yardstick) -> Vec<Reference<Scores>> {
        let floor = Models { sensor: yardstick.best_sensor(3), ..Models::default() };
        let starts = [Start::Published, Start::Attempted].into_iter();
        let unlearned = starts.filter_map(|start| Some((start, scenario.starting.models(start, log).ok()?)));
        let bound = yardstick.bound.map(|bound| Scores { velocity_rmse: Some(bound), ..Scores::default() });
        let bound = bound.map(|scores| Reference { name: "bound".to_owned(), start: None, scores });
        std::iter::once(("floor", None, floor))
            .chain(unlearned.map(|(start, models)| ("unlearned", Some(start), models)))
            .map(|(name, start, models)| Reference { name: name.to_owned(), start, scores: yardstick.score(&models) })
            .chain(bound)
            .collect()
    }

    fn finish(results: Results<Self>, finishing: &Finishing<'_>) -> Result<Finished, CannotSweep> {
        let published = published::of(&results.scenario);
        let trials = rows::trials(&results);
        let compared = ["vx_rmse_mm_per_s", "vy_rmse_mm_per_s", "vtheta_rmse_rad_per_s"];
        let outcome = Outcome::of(results, &tables::TABLES, published, ("em_published", &compared));
        outcome.write(&trials, finishing)?;
        let footnote = "Errors are root mean squares against the truth as it is: landmarks stand at known places, so that \
                        nothing needs scaling. Medians, means and standard deviations are over the trials that converged.";
        report::chapter4::write(&outcome, &report::plane::figures(&outcome.results), footnote, finishing)?;
        Ok(outcome.finished())
    }
}

impl Tallied for InPlane {
    fn names() -> &'static [&'static str] {
        &quantities::NAMES
    }

    fn value(record: &Record<Self>, trial: &Trial<Scores>, _: Option<Era>, quantity: usize) -> Option<f64> {
        (quantities::QUANTITIES.get(quantity)?.of)(trial, &record.truth)
    }

    fn reference(record: &Record<Self>, scores: &Scores, _: Option<Era>, quantity: usize) -> Option<f64> {
        // The truth itself is in every row already.
        let name = quantities::NAMES.get(quantity)?;
        let is_truth = name.starts_with("sigma") && name.contains("_true");
        let value = (quantities::QUANTITIES.get(quantity)?.of)(&of_scores(record.case, *scores), &record.truth);
        value.filter(|_| !is_truth)
    }

    fn groups(results: &Results<Self>) -> Vec<Group> {
        tally::parts(results)
    }
}
