//! A log whose nats count less than they seem to.
//!
//! A log of a real robot is likely by a model that is off in more ways than one, and what it says it says too surely, of sizes and of
//! effects alike. By how much shows where the same was asked of several parts: as a variance is overdispersed, so is the logarithm of a
//! likelihood divided by that (the variance inflation factor of Burnham and Anderson 2002, "Model Selection and Multimodel Inference",
//! section 2.5).

use crate::directions::Direction;
use crate::judge::{Channel, Judge, Moment, Reading, Regime};
use crate::plant::{Planted, Variant};
use crate::race::Pace;

/// A log, of whose nats so much counts.
pub struct Cautious<'a> {
    judge: &'a dyn Judge,
    counts: f64,
}

impl<'a> Cautious<'a> {
    /// The log of `judge`, of each of whose nats this share counts.
    #[must_use]
    pub fn new(judge: &'a dyn Judge, counts: f64) -> Self {
        Self { judge, counts }
    }
}

fn all_counted(mut terms: Vec<f64>, counts: f64) -> Vec<f64> {
    terms.iter_mut().for_each(|it| *it *= counts);
    terms
}

/// A reading of which so much counts: what two worlds part by, too, which is in squares of what is whitened.
fn counted(mut reading: Reading, counts: f64) -> Reading {
    for it in &mut reading.innovations {
        it.white *= counts.sqrt();
        it.ln_scale *= counts.sqrt();
    }
    reading.shares.iter_mut().for_each(|it| it.trials *= counts);
    let (log_likelihoods, expected) = (reading.log_likelihoods, reading.expected);
    Reading {
        log_likelihoods: all_counted(log_likelihoods, counts),
        expected: all_counted(expected, counts),
        ..reading
    }
}

impl Judge for Cautious<'_> {
    fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        self.judge.numbers(planted)
    }

    fn knows_together(&self, motion: bool) -> bool {
        self.judge.knows_together(motion)
    }

    fn knows(&self, variant: &Variant) -> bool {
        self.judge.knows(variant)
    }

    fn read(&self, numbers: &[f64]) -> Reading {
        counted(self.judge.read(numbers), self.counts)
    }

    fn terms(&self, numbers: &[f64]) -> Vec<f64> {
        all_counted(self.judge.terms(numbers), self.counts)
    }

    fn beside(&self, numbers: &[f64], pace: &Pace) -> f64 {
        self.counts * self.judge.beside(numbers, &pace.times(1.0 / self.counts))
    }

    fn steps(&self) -> &[Moment] {
        self.judge.steps()
    }

    fn length_s(&self) -> f64 {
        self.judge.length_s()
    }

    fn measured(&self) -> Vec<&'static str> {
        self.judge.measured()
    }

    fn directions(&self, numbers: &[f64], block: &str) -> Vec<Direction> {
        self.judge.directions(numbers, block)
    }

    fn channels(&self) -> Vec<Channel> {
        self.judge.channels()
    }

    fn regimes(&self) -> Vec<Regime> {
        self.judge.regimes()
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::judge::{Innovation, Share};
    use crate::real::layers::{ANY_SHARE, Least, beside_one_another, layers};
    use crate::real::settle::settle;
    use crate::real::unsure::sized;
    use crate::straight::Straight;
    use crate::weigh::groups::Signature;

    fn wave(t: usize, step: f64) -> f64 {
        (step * t as f64).sin()
    }

    /// A quarter of the nats leaves sizes where they are and twice as unsure, and takes names from what is hardly worth one.
    #[test]
    fn a_cautious_answer_is_less_sure_and_names_less() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let log = Straight::new(&[of(0, 0.5), of(1, 0.3)], &[&|t| 9.0 * wave(t, 0.37), &|t| wave(t, 0.91)], Seed(3));
        let least = Least { ..ANY_SHARE };
        let names = |counts: f64| -> Vec<&str> {
            layers(&Cautious::new(&log, counts), &kinds, &least).iter().map(|it| it.weighed.effect).collect()
        };
        assert_eq!(names(1.0), ["command_scale", "wheel_base"]);
        assert_eq!(names(0.25), ["command_scale"]);
        let all = settle(&log, vec![of(0, 0.5), of(1, 0.3)]).effects;
        let believed = |counts: f64| {
            let judge = Cautious::new(&log, counts);
            let (found, _) = sized(&judge, &[], beside_one_another(&judge, &all), &least);
            let [low, high] = found[0].weighed.interval;
            (found[0].weighed.best.size, high - low)
        };
        let ((size, width), (again, wider)) = (believed(1.0), believed(0.25));
        assert!((size / again - 1.0).abs() < 0.01, "{size} and {again}");
        assert!((wider / width - 2.0).abs() < 0.1, "{wider} over {width}");
    }

    /// What two worlds part by is nats of the log as well: of innovations, of their scales and of shares alike.
    #[test]
    fn worlds_part_by_what_counts() {
        let reading = |white: f64, ln_scale: f64, log_odds: f64| {
            let innovation = Innovation { channel: 0, plain: 0.1, white, ln_scale, genuine: true };
            Reading {
                log_likelihoods: vec![-1.0, -3.0],
                expected: vec![1.0, 2.0],
                innovations: vec![innovation],
                shares: vec![Share { log_odds, trials: 50.0 }],
                observations: 1,
            }
        };
        let here = reading(0.4, -1.0, 0.2);
        for there in [reading(3.4, -1.0, 0.2), reading(0.4, 1.0, 0.2), reading(0.4, -1.0, -1.4), reading(2.0, 0.5, 1.0)]
        {
            let parts =
                |counts: f64| Signature::new(&counted(here.clone(), counts), &counted(there.clone(), counts)).nats();
            assert!(
                parts(1.0) > 1.0 && (parts(0.3) / parts(1.0) - 0.3).abs() < 1e-9,
                "{} and {}",
                parts(0.3),
                parts(1.0)
            );
        }
        assert!((counted(here, 0.5).total() + 2.0).abs() < 1e-12);
    }
}
