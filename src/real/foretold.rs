//! How far learners' scores on simulated logs are from those on the real one, before and after a repair.

use std::collections::BTreeMap;

use asami_math::elementary::{exp, ln};
use asami_math::statistics::median;

use super::learning::{Lesson, MEASURES, World};
use crate::diagnose::words;
use crate::report::{Cell, RowKind, Table};
use crate::sweep::rows::{optional, push};

/// Columns of `learning.csv`.
pub const LEARNING: &str = "scenario,log,robot,learner,measure,real,nominal,repaired,factor_before,factor_after,\
                            real_converged,nominal_converged,repaired_converged";

/// A score on a real log and what simulated ones make of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Foretold {
    /// The log's name in the scenario.
    pub log: String,
    /// Whose, of a recording of several.
    pub robot: Option<u16>,
    /// Whose score.
    pub learner: String,
    /// Of [`MEASURES`].
    pub measure: &'static str,
    /// By [`World`]: the median of the trials that converged.
    pub score: [Option<f64>; 3],
    /// By [`World`]: the share of trials that converged.
    pub converged: [f64; 3],
}

impl Foretold {
    /// By what factor, 1 and more, the real score is missed in the nominal world.
    #[must_use]
    pub fn before(&self) -> Option<f64> {
        factor(self.score[0]?, self.score[1]?)
    }

    /// The same in the repaired one.
    #[must_use]
    pub fn after(&self) -> Option<f64> {
        factor(self.score[0]?, self.score[2]?)
    }
}

fn factor(a: f64, b: f64) -> Option<f64> {
    (a > 0.0 && b > 0.0).then(|| exp(ln(a / b).abs()))
}

/// Every score, in the order of the lessons.
#[must_use]
pub fn foretold(lessons: &[Lesson]) -> Vec<Foretold> {
    let real = lessons.iter().filter(|it| it.world == World::Real);
    let of = |lesson: &Lesson, measure: &'static str| {
        let by_world = [World::Real, World::Nominal, World::Repaired].map(|world| {
            let same = |it: &&Lesson| {
                it.world == world && it.log == lesson.log && it.robot == lesson.robot && it.learner == lesson.learner
            };
            let trials: Vec<&Lesson> = lessons.iter().filter(same).collect();
            let good: Vec<&&Lesson> = trials.iter().filter(|it| it.converged).collect();
            let values: Vec<f64> = good.iter().filter_map(|it| it.values.get(measure).copied()).collect();
            (median(&values), good.len() as f64 / trials.len().max(1) as f64)
        });
        Foretold {
            log: lesson.log.clone(),
            robot: lesson.robot,
            learner: lesson.learner.clone(),
            measure,
            score: by_world.map(|it| it.0),
            converged: by_world.map(|it| it.1),
        }
    };
    real.flat_map(|lesson| MEASURES.map(|measure| of(lesson, measure))).collect()
}

/// `learning.csv`.
#[must_use]
pub fn csv(scenario: &str, all: &[Foretold]) -> String {
    let mut text = format!("{LEARNING}\n");
    for it in all {
        let robot = it.robot.map_or_else(String::new, |robot| robot.to_string());
        let mut row = vec![scenario.to_owned(), it.log.clone(), robot, it.learner.clone(), it.measure.to_owned()];
        row.extend(it.score.map(optional));
        row.extend([it.before(), it.after()].map(optional));
        row.extend(it.converged.map(|share| optional(Some(share))));
        push(&mut text, &row);
    }
    text
}

/// By log and measure: how far simulated scores are from real ones; and how far shares of learners that converge are.
#[must_use]
pub fn table(all: &[Foretold]) -> Table {
    let heads = [
        "log",
        "measure",
        "scores",
        "factor before",
        "factor after",
        "nearer",
        "converge",
        "missed before",
        "missed after",
    ];
    let mut table = Table::new("Learners' scores, foretold by simulation", &heads).caption(
        "What the learners err by on simulated logs, of a robot among the same landmarks that starts where the real one stood, is told \
         what that was told and sees something as often, against what they err by on the real one, learned in the same way: the factor, \
         in the median over robots and learners, by which it is missed in the nominal world and in those that are believed after the \
         log, with the effects that were named and what else may be there; how many of the scores the latter come nearer to. Scores are by \
         where a robot's axle is and where it goes, of the real one as motion capture has that, however its markers were put on. Converge: \
         how many of the learners do on real logs; by how much, in the mean over robots and learners, the share of simulated logs on which one \
         does misses that, in the nominal world and in those that are believed.",
    );
    let mut groups: BTreeMap<(&str, usize), Vec<&Foretold>> = BTreeMap::new();
    for it in all {
        let place = MEASURES.iter().position(|measure| *measure == it.measure).unwrap_or_default();
        groups.entry((&it.log, place)).or_default().push(it);
    }
    for ((log, place), group) in groups {
        let factors: Vec<[f64; 2]> = group.iter().filter_map(|it| Some([it.before()?, it.after()?])).collect();
        let of = |k: usize| {
            let middle = median(&factors.iter().map(|it| it[k]).collect::<Vec<f64>>());
            middle.map_or_else(Cell::default, |it| words::digits(it).into())
        };
        let nearer = factors.iter().filter(|it| it[1] < it[0]).count();
        let missed = |world: usize| {
            let sum: f64 = group.iter().map(|it| (it.converged[0] - it.converged[world]).abs()).sum();
            format!("{:.2}", sum / group.len() as f64).into()
        };
        let converge = group.iter().filter(|it| it.converged[0] > 0.0).count();
        table = table.row(
            RowKind::Ours,
            [
                log.to_owned().into(),
                MEASURES[place].to_owned().into(),
                factors.len().to_string().into(),
                of(0),
                of(1),
                format!("{nearer} of {}", factors.len()).into(),
                format!("{converge} of {}", group.len()).into(),
                missed(1),
                missed(2),
            ],
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lesson(world: World, seed: Option<u64>, converged: bool, value: f64) -> Lesson {
        let values = [("vx_rmse_mm_per_s", value)].into_iter().collect();
        Lesson { log: "m".into(), robot: Some(1), world, seed, learner: "em".into(), converged, values }
    }

    /// Twice too small in the nominal world, 1.25 times too large in the repaired one; what diverged does not count.
    #[test]
    fn a_score_is_held_against_the_median_of_what_converged() {
        let lessons = [
            lesson(World::Real, None, true, 4.0),
            lesson(World::Nominal, Some(0), true, 2.0),
            lesson(World::Nominal, Some(1), false, 1e9),
            lesson(World::Repaired, Some(0), true, 5.0),
            lesson(World::Repaired, Some(1), true, 4.0),
            lesson(World::Repaired, Some(2), true, 8.0),
        ];
        let all = foretold(&lessons);
        assert_eq!(all.len(), MEASURES.len());
        let near = |a: Option<f64>, b: f64| assert!((a.unwrap() - b).abs() < 1e-12, "{a:?} {b}");
        near(all[0].before(), 2.0);
        near(all[0].after(), 1.25);
        assert_eq!(all[0].converged, [1.0, 0.5, 1.0]);
        assert_eq!(all[1].before(), None);
        let shown = table(&all).markdown();
        assert!(shown.contains("| 2.00 | 1.25 | 1 of 1 | 1 of 1 | 0.50 | 0.00 |"), "{shown}");
        // Where none converges that is what is said.
        let none = foretold(
            &lessons[2..3].iter().chain(&[lesson(World::Real, None, false, 4.0)]).cloned().collect::<Vec<_>>(),
        );
        let shown = table(&none).markdown();
        assert!(shown.contains("| 0 |") && shown.contains("| 0 of 0 | 0 of 1 | 0.00 | 0.00 |"), "{shown}");
        let row = csv("real", &all).lines().nth(1).unwrap().to_owned();
        let scores = [4.0, 2.0, 5.0].map(asami_dataset::store::number).join(",");
        assert!(row.starts_with(&format!("real,m,1,em,vx_rmse_mm_per_s,{scores},")), "{row}");
    }
}
