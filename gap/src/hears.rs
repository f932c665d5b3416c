//! Who hears what a filter over a log of landmarks finds, step by step.

use crate::race::Runner;

/// What one sighting said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// Which step.
    pub step: usize,
    /// Which sighting.
    pub seen: usize,
    /// Size less its prediction, in pixels or metres; bearing less its prediction, in radians.
    pub plain: [f64; 2],
    /// Whitened, what was to be expected after those before it taken away: of variance 1 and independent of each
    /// other, the size's first.
    pub white: [f64; 2],
    /// The scales by which they were whitened.
    pub scale: [f64; 2],
    /// Probability that it is of the landmark that it says.
    pub genuine: f64,
}

/// A filtered log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Filtered {
    /// `log p(o_t | past)` by step.
    pub log_likelihoods: Vec<f64>,
    /// What the response itself expects of `-log p(o_t | past)`, by step (misfit's `h_t`).
    pub expected: Vec<f64>,
    /// Of all sightings, in order.
    pub innovations: Vec<Innovation>,
    /// How often each bin of detection was visited.
    pub visits: Vec<f64>,
}

/// Who hears what a filter finds, step by step.
pub trait Hears {
    /// Whether what was to be expected is asked for; it is 0 else.
    const EXPECTS: bool;

    /// One sighting.
    fn sighting(&mut self, innovation: Innovation);

    /// A step, after its sightings; false ends the walk.
    fn step(&mut self, log_likelihood: f64, expected: f64) -> bool;
}

impl Hears for Filtered {
    const EXPECTS: bool = true;

    fn sighting(&mut self, innovation: Innovation) {
        self.innovations.push(innovation);
    }

    fn step(&mut self, log_likelihood: f64, expected: f64) -> bool {
        self.log_likelihoods.push(log_likelihood);
        self.expected.push(expected);
        true
    }
}

impl Innovation {
    /// The same where the bearing was not measured.
    #[must_use]
    pub fn of_size_alone(self) -> Self {
        Self { plain: [self.plain[0], 0.0], white: [self.white[0], 0.0], scale: [self.scale[0], 1.0], ..self }
    }
}

impl Filtered {
    /// Sum over the steps from `first` on.
    #[must_use]
    pub fn total(&self, first: usize) -> f64 {
        self.log_likelihoods.iter().skip(first).fold(0.0, |sum, it| sum + it)
    }
}

/// Passes on scored steps alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Scored<'a, H> {
    /// Whether each step to come is.
    pub scored: &'a [bool],
    /// Who hears of those that are.
    pub heard: H,
}

impl<H: Hears> Hears for Scored<'_, H> {
    const EXPECTS: bool = H::EXPECTS;

    fn sighting(&mut self, innovation: Innovation) {
        if self.scored.first() == Some(&true) {
            self.heard.sighting(innovation);
        }
    }

    fn step(&mut self, log_likelihood: f64, expected: f64) -> bool {
        let Some((scored, rest)) = self.scored.split_first() else { return false };
        self.scored = rest;
        !scored || self.heard.step(log_likelihood, expected)
    }
}

/// `log p(o_t | past)` by step, and nothing else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Terms(pub Vec<f64>);

impl Hears for Terms {
    const EXPECTS: bool = false;

    fn sighting(&mut self, _: Innovation) {}

    fn step(&mut self, log_likelihood: f64, _: f64) -> bool {
        self.0.push(log_likelihood);
        true
    }
}

impl Hears for Runner<'_> {
    const EXPECTS: bool = false;

    fn sighting(&mut self, _: Innovation) {}

    fn step(&mut self, log_likelihood: f64, _: f64) -> bool {
        self.goes_on(log_likelihood)
    }
}
