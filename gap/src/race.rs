//! Log-likelihoods of many responses, one after another: who has fallen behind for good is not heard to the end.

use crate::judge::Reading;

/// A response that a part of the log speaks against so clearly, in nats, is out: had it caused the log, the odds of
/// that would be `e` to as many against one (Wald 1945).
const OUT_NATS: f64 = 60.0;

/// The log-likelihood up to each scored step under a response that others are held against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pace {
    so_far: Vec<f64>,
}

impl Pace {
    /// That of a reading.
    #[must_use]
    pub fn of(reading: &Reading) -> Self {
        let sum = |so_far: &mut f64, it: &f64| {
            *so_far += it;
            Some(*so_far)
        };
        Self { so_far: reading.log_likelihoods.iter().scan(0.0, sum).collect() }
    }

    /// That of the steps at these places alone.
    #[must_use]
    pub fn of_part(&self, at: &[usize]) -> Self {
        let so_far = |i: usize| self.so_far.get(i).copied().unwrap_or(f64::NEG_INFINITY);
        let term = |i: &usize| so_far(*i) - i.checked_sub(1).map_or(0.0, so_far);
        let sum = |sum: &mut f64, it: f64| {
            *sum += it;
            Some(*sum)
        };
        Self { so_far: at.iter().map(term).scan(0.0, sum).collect() }
    }

    /// That of a reading of which each nat counts so many times.
    #[must_use]
    pub fn times(&self, times: f64) -> Self {
        Self { so_far: self.so_far.iter().map(|it| times * it).collect() }
    }

    /// The whole log's.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.so_far.last().copied().unwrap_or(0.0)
    }
}

/// A response on its way through a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Runner<'a> {
    pace: &'a Pace,
    steps: usize,
    so_far: f64,
}

impl<'a> Runner<'a> {
    /// At the first scored step.
    #[must_use]
    pub fn new(pace: &'a Pace) -> Self {
        Self { pace, steps: 0, so_far: 0.0 }
    }

    /// Takes a scored step's log-likelihood in; false if the response is out.
    pub fn goes_on(&mut self, log_likelihood: f64) -> bool {
        self.so_far += log_likelihood;
        self.steps += 1;
        self.so_far > self.pace.so_far.get(self.steps - 1).copied().unwrap_or(f64::NEG_INFINITY) - OUT_NATS
    }

    /// The log-likelihood; of a response that is out, what it would be had it gone on falling behind as fast.
    #[must_use]
    pub fn log_likelihood(&self) -> f64 {
        let all = self.pace.so_far.len();
        let Some(pace) = self.steps.checked_sub(1).and_then(|last| self.pace.so_far.get(last)) else {
            return self.so_far;
        };
        self.pace.total() + (self.so_far - pace) * all as f64 / self.steps as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pace(terms: &[f64]) -> Pace {
        Pace::of(&Reading { log_likelihoods: terms.to_vec(), ..Reading::default() })
    }

    fn run<'a>(pace: &'a Pace, terms: &[f64]) -> (Runner<'a>, usize) {
        let mut runner = Runner::new(pace);
        let ran = terms.iter().take_while(|it| runner.goes_on(**it)).count();
        (runner, ran)
    }

    #[test]
    fn who_keeps_up_is_heard_to_the_end_and_has_its_own_sum() {
        let pace = pace(&[-1.0; 100]);
        // Far behind at first, but not out, and ahead in the end.
        let terms: Vec<f64> = (0..100).map(|i| if i < 50 { -2.0 } else { 0.5 }).collect();
        let (runner, ran) = run(&pace, &terms);
        assert_eq!(ran, 100);
        assert!((runner.log_likelihood() - terms.iter().sum::<f64>()).abs() < 1e-9);
    }

    #[test]
    fn who_is_out_falls_behind_as_fast_as_before() {
        let pace = pace(&[-1.0; 1000]);
        let (runner, ran) = run(&pace, &[-2.0; 1000]);
        assert_eq!(ran, OUT_NATS as usize - 1);
        assert!((runner.log_likelihood() + 2000.0).abs() < 1e-9, "{}", runner.log_likelihood());
    }

    #[test]
    fn what_is_no_number_is_out_at_once() {
        let pace = pace(&[-1.0; 10]);
        let (runner, ran) = run(&pace, &[f64::NAN; 10]);
        assert_eq!(ran, 0);
        assert!(runner.log_likelihood().is_nan());
    }
}
