//! How far innovations scatter, and how one hangs on those before it: a gait sways the camera from frame to frame.
//!
//! An autoregression of second order (Yule 1927, Walker 1931) on the innovations before, of sizes those of the same
//! landmark in the two frames before, of bearings those of any landmark, since the head and the heading are common to
//! all. It is learned with the innovations' spread from the nominal world's own logs and then frozen: unmodelled,
//! swaying makes false causes out of nothing.

use asami_math::elementary::ln;
use serde::{Deserialize, Serialize};

use crate::filter::Innovation;
use crate::view::View;

/// Spread and autocorrelations of whitened innovations, sizes' and bearings'.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Standard deviations: 1 where the filter's own covariance says all.
    spread: [f64; 2],
    /// One and two back.
    correlations: [[f64; 2]; 2],
}

impl Default for Memory {
    fn default() -> Self {
        Self { spread: [1.0; 2], correlations: [[0.0; 2]; 2] }
    }
}

/// The last two innovations of a channel, for as long as there is one in every frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Past {
    step: usize,
    last: Option<f64>,
    before: Option<f64>,
}

impl Past {
    /// What counts as the past at a step: this frame and the one before.
    fn at(self, step: usize) -> Self {
        if self.last.is_some() && self.step + 1 >= step { self } else { Self::default() }
    }

    fn then(self, step: usize, value: f64) -> Self {
        Self { step, last: Some(value), before: self.at(step).last }
    }
}

/// A memory at work: what it has seen of each landmark's size, and of bearings.
#[derive(Clone, Debug)]
pub struct Recall {
    memory: Memory,
    sizes: Vec<Past>,
    bearing: Past,
}

impl Memory {
    /// The memory in these innovations.
    #[must_use]
    pub fn learn<'a>(logs: impl Iterator<Item = (&'a View, &'a [Innovation])>) -> Self {
        let (mut products, mut squares) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
        let (mut sum, mut n) = ([0.0; 2], 0.0);
        for (view, innovations) in logs {
            let mut recall = Recall::new(Self::default(), view.landmarks.len());
            for it in innovations.iter().filter(|it| it.genuine > 0.5) {
                let landmark = view.seen[it.seen].landmark;
                for (k, past) in recall.past(landmark, it.step).into_iter().enumerate() {
                    for (lag, then) in [past.last, past.before].into_iter().enumerate() {
                        let Some(then) = then else { continue };
                        products[k][lag] += it.white[k] * then;
                        squares[k][lag] += 0.5 * (it.white[k] * it.white[k] + then * then);
                    }
                    sum[k] += it.white[k] * it.white[k];
                }
                n += 1.0;
                recall.take(landmark, it.step, it.white);
            }
        }
        let share = |k: usize, lag: usize| (products[k][lag] / f64::max(squares[k][lag], 1e-9)).clamp(-0.95, 0.95);
        let spread = sum.map(|sum| if n > 0.0 { (sum / n).sqrt().max(0.1) } else { 1.0 });
        Self { spread, correlations: [0, 1].map(|k| [0, 1].map(|lag| share(k, lag))) }
    }

    /// Mean and variance of a whitened innovation of channel `k` after those before it.
    fn after(&self, k: usize, past: &Past) -> (f64, f64) {
        let [r1, r2] = self.correlations[k];
        match (past.last, past.before) {
            (Some(last), Some(before)) => {
                let (a, b) = (r1 * (1.0 - r2) / (1.0 - r1 * r1), (r2 - r1 * r1) / (1.0 - r1 * r1));
                (a * last + b * before, (1.0 - a * r1 - b * r2).max(0.05))
            }
            (Some(last), None) => (r1 * last, 1.0 - r1 * r1),
            _ => (0.0, 1.0),
        }
    }
}

impl Recall {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(memory: Memory, landmarks: usize) -> Self {
        Self { memory, sizes: vec![Past::default(); landmarks], bearing: Past::default() }
    }

    /// What is left of an innovation once the past is taken away, again of variance 1, and the logarithms of the
    /// scales by which that was reached.
    #[must_use]
    pub fn fresh(&self, landmark: usize, step: usize, white: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let (mut fresh, mut scales) = ([0.0; 2], [0.0; 2]);
        for (k, past) in self.past(landmark, step).into_iter().enumerate() {
            let (mean, variance) = self.memory.after(k, &past);
            let spread = self.memory.spread[k];
            fresh[k] = (white[k] - mean) / (spread * variance.sqrt());
            scales[k] = ln(spread) + 0.5 * ln(variance);
        }
        (fresh, scales)
    }

    /// Remembers a genuine innovation.
    pub fn take(&mut self, landmark: usize, step: usize, white: [f64; 2]) {
        self.sizes[landmark] = self.sizes[landmark].then(step, white[0]);
        self.bearing = self.bearing.then(step, white[1]);
    }

    fn past(&self, landmark: usize, step: usize) -> [Past; 2] {
        [self.sizes[landmark].at(step), self.bearing.at(step)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the textbook's autocorrelations of an AR(2), what is fresh is its own noise.
    #[test]
    fn fresh_innovations_of_an_autoregression_are_its_noise() {
        let (a, b) = (1.2_f64, -0.5_f64);
        let r1 = a / (1.0 - b);
        let r2 = a * r1 + b;
        let sd = (1.0 - a * r1 - b * r2).sqrt();
        let memory = Memory { correlations: [[r1, r2]; 2], ..Memory::default() };
        let mut recall = Recall::new(memory, 1);
        let noise = [0.3, -1.2, 0.7, 2.0, -0.4, 0.1];
        let (mut x1, mut x2) = (0.5, -0.3);
        recall.take(0, 0, [x2; 2]);
        recall.take(0, 1, [x1; 2]);
        for (i, e) in noise.into_iter().enumerate() {
            let x = a * x1 + b * x2 + sd * e;
            let (fresh, scales) = recall.fresh(0, i + 2, [x; 2]);
            assert!((fresh[0] - e).abs() < 1e-9, "{fresh:?} {e}");
            assert!((scales[0] - sd.ln()).abs() < 1e-9);
            recall.take(0, i + 2, [x; 2]);
            (x2, x1) = (x1, x);
        }
    }

    #[test]
    fn a_frame_without_the_landmark_ends_the_past() {
        let mut recall = Recall::new(Memory { correlations: [[0.8, 0.5]; 2], ..Memory::default() }, 1);
        recall.take(0, 4, [1.0; 2]);
        assert!((recall.fresh(0, 5, [0.8; 2]).0[0]).abs() < 1e-12);
        assert_eq!(recall.fresh(0, 6, [0.8; 2]), ([0.8; 2], [0.0; 2]));
    }
}
