//! Chapter 5 of Stronger (2008): its side of a sweep.

pub mod published;
pub mod quantities;
pub mod rows;
pub mod tables;

use asami_dataset::{Dataset, Log, Models, Seed, Survey};
use asami_learners::Learned;
use asami_learners::learner::Trace;
use asami_learners::lidar::Coefficients;
use serde::{Deserialize, Serialize};

use super::outcome::Outcome;
use super::tally::{self, Group, Tallied};
use super::{CannotSweep, Finished, Record, Results};
use crate::report;
use crate::scenario::{Era, Origin, Policy, Row, Scenario, Start};
use crate::scorer::car::{Scores, Yardstick};
use crate::study::{Finishing, Reference, Study};
use crate::trial::{Trial, of_scores};

/// A car's laser scanner and action model.
#[derive(Clone, Debug, PartialEq)]
pub struct InTraffic;

/// What tables and figures need of the truth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Greatest less least true angle of the lasers.
    pub angle_range_rad: Option<f64>,
    /// Greatest less least acceleration, speed and yaw rate of the reference.
    pub ranges: Option<[f64; 3]>,
    /// True angles of the lasers.
    pub angles_rad: Vec<f64>,
    /// Of the reference, for each step: when it begins, speed and yaw rate.
    pub steps: Vec<[f64; 3]>,
}

/// Names of the curves that a roll-out gives.
pub const ROLLED: [&str; 2] = ["rolled_speed_m_per_s", "rolled_turning_rad_per_s"];

impl Study for InTraffic {
    type Scores = Scores;
    type Yardstick = Yardstick;
    type Truth = Truth;

    /// Action models of a simulated car are held against what an Applanix on it would say, as published; the motions that a
    /// learner sees, against the exact ones.
    fn yardstick(scenario: &Scenario, dataset: &Dataset, _: Option<&Survey>) -> Yardstick {
        let Dataset { log, truth, provenance } = dataset;
        let angles = truth.survey.as_ref().map_or(Vec::new(), |survey| survey.horizontal_angles_rad.clone());
        let of = |reference: &[_]| Yardstick::of(angles.clone(), &truth.track, reference, &log.commands);
        match &scenario.origin {
            Origin::Simulated(simulation) => match &simulation.drive {
                Policy::Route(ride) => {
                    let seed = Seed(provenance.as_ref().map_or(0, |provenance| provenance.seed));
                    of(&ride.applanix.measure(&truth.track, &mut seed.stream("applanix")))
                }
                _ => of(&truth.track),
            },
            Origin::Recorded(recording) => {
                let from_s = |learned_s| truth.track.first().map_or(0.0, |first| first.t_s) + learned_s;
                let held_out =
                    recording.learned_s.map(|learned_s| truth.track.window(&(from_s(learned_s)..f64::INFINITY)));
                of(held_out.as_ref().unwrap_or(&truth.track))
            }
        }
    }

    /// As published there is no action model to start from. Others are made from what the reference says of the car.
    fn given(_: &Scenario, row: &Row, _: &Log, yardstick: &Yardstick) -> Result<Models, String> {
        let factor = match row.start {
            Some(Start::ReferenceCar) => 1.0,
            Some(Start::HalfCar) => 0.5,
            _ => return Ok(Models::default()),
        };
        let fitted = yardstick.fitted().ok_or("the log's reference determines no action model to start from")?;
        let action = Coefficients { c: fitted.c.map(|c| factor * c), se: None }.model(0.0);
        Ok(Models { action: Some(action), ..Models::default() })
    }

    fn truth(yardstick: &Yardstick) -> Truth {
        let row = |step: &asami_learners::lidar::Stretch| [step.t_s, step.v_m_per_s, step.omega_rad_per_s];
        Truth {
            angle_range_rad: yardstick.angle_range_rad(),
            ranges: yardstick.ranges(),
            angles_rad: yardstick.angles_rad.clone(),
            steps: yardstick.steps.iter().map(row).collect(),
        }
    }

    fn score(yardstick: &Yardstick, models: &Models) -> Scores {
        yardstick.score(models)
    }

    fn faults(scenario: &Scenario, _: &Row, yardstick: &Yardstick, _: &Models, scores: &Scores) -> Vec<String> {
        yardstick.faults(scores, scenario.divergence.r2_min)
    }

    /// Odometry is no model, but a curve.
    fn follow(yardstick: &Yardstick, learned: &Learned, scores: &mut Scores) -> Vec<Trace> {
        scores.odometry_rmse = yardstick.odometry_rmse(&learned.traces);
        let rolled = learned.models.action.as_ref().map_or(Vec::new(), |action| yardstick.rolled(action));
        let curve = |i: usize| yardstick.steps.iter().zip(&rolled).map(|(step, row)| [step.t_s, row[i]]).collect();
        vec![Trace { name: ROLLED[0], points: curve(1) }, Trace { name: ROLLED[1], points: curve(2) }]
    }

    /// The dissertation's From-Truth: the same action model, fitted to the reference's own motions.
    fn references(_: &Scenario, _: &Log, yardstick: &Yardstick) -> Vec<Reference<Scores>> {
        let of = |models| Reference { name: "from_truth".to_owned(), start: None, scores: yardstick.score(&models) };
        yardstick.from_truth().map(of).into_iter().collect()
    }

    fn finish(results: Results<Self>, finishing: &Finishing<'_>) -> Result<Finished, CannotSweep> {
        let published = published::of(&results.scenario);
        let trials = rows::trials(&results);
        let compared = [
            "angle_rms_deg",
            "angle_rms_common_removed_deg",
            "odometry_v_rmse_m_per_s",
            "odometry_omega_rmse_rad_per_s",
            "acceleration_rmse_m_per_s2",
            "speed_rmse_m_per_s",
            "yaw_rate_rmse_rad_per_s",
        ];
        let outcome = Outcome::of(results, &tables::TABLES, published, ("car_published", &compared));
        outcome.write(&trials, finishing)?;
        let footnote = "Action models are rolled out open-loop over the whole drive and held against a reference as good as \
                        the dissertation's (an Applanix POS LV); odometry is held against the exact track. Medians, means and \
                        standard deviations are over the trials that converged.";
        report::chapter4::write(&outcome, &report::car::figures(&outcome.results), footnote, finishing)?;
        Ok(outcome.finished())
    }
}

impl Tallied for InTraffic {
    fn names() -> &'static [&'static str] {
        &quantities::NAMES
    }

    fn value(record: &Record<Self>, trial: &Trial<Scores>, _: Option<Era>, quantity: usize) -> Option<f64> {
        (quantities::QUANTITIES.get(quantity)?.of)(trial, &record.truth)
    }

    fn reference(record: &Record<Self>, scores: &Scores, _: Option<Era>, quantity: usize) -> Option<f64> {
        (quantities::QUANTITIES.get(quantity)?.of)(&of_scores(record.case, *scores), &record.truth)
    }

    fn groups(results: &Results<Self>) -> Vec<Group> {
        tally::parts(results)
    }
}
