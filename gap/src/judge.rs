//! One log under many responses: what a log of any robot offers once it is read.

use crate::directions::Direction;
use crate::plant::{Planted, Variant};
use crate::race::{Pace, Runner};

/// A log that tells how likely it is, whatever was in the world. A response is a list of numbers; what they mean is the
/// judge's own.
pub trait Judge: Sync {
    /// The response of the nominal world with these effects in it; one that nothing is known of changes nothing.
    fn numbers(&self, planted: &[Planted]) -> Vec<f64>;

    /// Whether it is known what effects make of one another, and not only what each does by itself: those on motion, or those on what a
    /// sensor makes of it.
    fn knows_together(&self, _motion: bool) -> bool {
        false
    }

    /// Whether it is known what a kind of effect changes.
    fn knows(&self, variant: &Variant) -> bool;

    /// What the log says under a response.
    fn read(&self, numbers: &[f64]) -> Reading;

    /// The steps that are scored, in order of time.
    fn steps(&self) -> &[Moment];

    /// From the log's first observation to its last.
    fn length_s(&self) -> f64;

    /// The channels of [`Innovation`]s.
    fn measured(&self) -> Vec<&'static str>;

    /// Ways in which a response may change if the cause is of a flexible block.
    fn directions(&self, numbers: &[f64], block: &str) -> Vec<Direction>;

    /// Which of the response's numbers are whose.
    fn channels(&self) -> Vec<Channel>;

    /// Circumstances in which a gap may show.
    fn regimes(&self) -> Vec<Regime>;

    /// Of what length blocks are held out in turn, and how much at either end of one counts for neither side.
    fn held_out_s(&self) -> (f64, f64) {
        (10.0, 1.0)
    }

    /// `log p(o)` by scored step under a response.
    fn terms(&self, numbers: &[f64]) -> Vec<f64> {
        self.read(numbers).log_likelihoods
    }

    /// `log p(o)` under a response, told whether it is worth the while to read on; a rough figure where it is not.
    fn beside(&self, numbers: &[f64], pace: &Pace) -> f64 {
        let mut runner = Runner::new(pace);
        for term in self.terms(numbers) {
            if !runner.goes_on(term) {
                break;
            }
        }
        runner.log_likelihood()
    }

    /// `log p(o)` of the log in the nominal world with these effects.
    fn log_likelihood(&self, planted: &[Planted]) -> f64 {
        self.terms(&self.numbers(planted)).into_iter().fold(0.0, |sum, it| sum + it)
    }
}

/// A step of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Its time.
    pub t_s: f64,
    /// Observations in it.
    pub seen: usize,
}

/// What a log says under a response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// `log p(o_t | past)` by scored step.
    pub log_likelihoods: Vec<f64>,
    /// What the response itself expects of `-log p(o_t | past)`, by scored step (misfit's `h_t`).
    pub expected: Vec<f64>,
    /// Of all that was measured, the same things in the same order under every response.
    pub innovations: Vec<Innovation>,
    /// Shares of what was counted.
    pub shares: Vec<Share>,
    /// How many observations there are.
    pub observations: usize,
}

/// What one measured number said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// Which of [`Judge::measured`].
    pub channel: usize,
    /// The number less its prediction, in the channel's unit.
    pub plain: f64,
    /// Whitened: of variance 1 and independent of the others.
    pub white: f64,
    /// Logarithm of the scale by which it was whitened.
    pub ln_scale: f64,
    /// Whether it is taken to be of what it says.
    pub genuine: bool,
}

/// How often something is said to happen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Logarithm of its odds.
    pub log_odds: f64,
    /// How often it could have happened in this log.
    pub trials: f64,
}

/// A channel, and which of a response's numbers are its own: means and noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// One of the names that every report uses: `forward`, `height_px`, ...
    pub name: &'static str,
    /// Numbers that move predictions.
    pub means: Vec<usize>,
    /// Numbers of noise and shares.
    pub noise: Vec<usize>,
}

/// A regime: a name and whether each scored step is in it.
pub type Regime = (&'static str, Vec<bool>);

impl Reading {
    /// The log-likelihood of all steps.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.log_likelihoods.iter().fold(0.0, |sum, it| sum + it)
    }
}
