//! How a sighting's noise hangs on the noise before it: a gait sways the camera from frame to frame.
//!
//! The noise of sizes, and that of bearings, is a sway that all sightings share, an autoregression of second order (Yule
//! 1927, Walker 1931), and white noise on top; at each pace another, for a gait sways as it steps. All are learned from the
//! nominal world's own logs and then frozen: a sway that is taken for white noise makes false causes out of nothing, and is
//! not noise enough to follow it where it is slow; one that is taken for turns and steps makes a robot that wavers.

use asami_math::elementary::{exp, ln, sin_cos};
use serde::{Deserialize, Serialize};

use crate::columns::Attempt;
use crate::tails::Tails;

/// Paces: standing, and bands of attempted speed, forward or to the side, and backward.
pub const PACES: usize = 1 + 2 * BANDS;
/// So many bands.
const BANDS: usize = 4;

/// At which pace a robot goes that attempts these shares of its greatest velocities.
#[must_use]
pub fn pace(attempt: Attempt) -> usize {
    let speed = attempt.iter().fold(0.0, |most, share| f64::max(most, share.abs()));
    if speed < 1e-6 {
        return 0;
    }
    let band = ((speed * BANDS as f64 - 1e-9).floor() as usize).min(BANDS - 1);
    1 + band + if attempt[1] < 0.0 { BANDS } else { 0 }
}

/// The sways of sizes and of bearings, and how far innovations scatter once they are taken into account.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Sizes' and bearings', at each pace.
    pub sways: [[Sway; 2]; PACES],
    /// Standard deviations of whitened innovations: 1 where the filter's own covariance says all.
    pub spread: [f64; 2],
    /// How often they are far off.
    pub tails: Tails,
    /// Time from frame to frame, in seconds.
    pub frame_s: f64,
    /// Where nothing sways: what landmarks' sizes are off for a while.
    #[serde(default)]
    pub lasting: Lasting,
}

/// What a landmark's sizes are off for a while, each landmark's by itself, as a camera reads a mark from where it stands: an
/// autoregression of first order in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lasting {
    /// Its variance, as a share of that of all noise of sizes.
    pub share: f64,
    /// It fades to 1/e in so many seconds.
    pub fades_s: f64,
}

impl Lasting {
    /// What is left of it after so many seconds.
    #[must_use]
    pub fn kept(self, dt_s: f64) -> f64 {
        if self.fades_s > 0.0 { exp(-dt_s / self.fades_s) } else { 0.0 }
    }
}

/// A sway: `s_t = p s_(t-1) + q s_(t-2) + e_t`, of variance 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sway {
    /// Its variance, as a share of all noise.
    pub share: f64,
    /// On one and two frames before.
    pub on: [f64; 2],
    /// Standard deviation of all noise at this pace, in shares of what it is at any.
    pub scale: f64,
}

/// Lags, in frames, at which noise is held against itself.
const LAGS: usize = 24;
/// Decays and frequencies that are tried.
const DECAYS: usize = 40;
const TURNS: usize = 60;
/// A sway of a smaller share than this is none.
const LEAST_SHARE: f64 = 0.05;
/// Squared correlations that it explains, in units of their variance: of white noise those of the best of the grid are hardly ever as many.
const BY_CHANCE: f64 = 30.0;
/// A sway fades to 1/e in so many frames, from the least to the greatest.
const FRAMES: [f64; 2] = [0.7, 60.0];

impl Default for Sway {
    /// White noise.
    fn default() -> Self {
        Self { share: 0.0, on: [0.0; 2], scale: 1.0 }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            sways: [[Sway::default(); 2]; PACES],
            spread: [1.0; 2],
            tails: Tails::default(),
            frame_s: 0.0,
            lasting: Lasting::default(),
        }
    }
}

impl Memory {
    /// The same sways of sizes and bearings at every pace.
    #[must_use]
    pub fn at_any_pace(sways: [Sway; 2], frame_s: f64) -> Self {
        Self { sways: [sways; PACES], frame_s, ..Self::default() }
    }

    /// Whether anything sways at all.
    #[must_use]
    pub fn sways(&self) -> bool {
        self.sways.iter().flatten().any(|sway| sway.share > 0.0)
    }

    /// Whether what landmarks' sizes are off lasts: nothing does where anything sways.
    #[must_use]
    pub fn lasts(&self) -> bool {
        self.lasting.share > 0.0 && !self.sways()
    }

    /// What lasts of the sizes of a robot on wheels: of a single landmark it is their sway.
    #[must_use]
    pub fn fading(&self) -> Lasting {
        let Sway { share, on: [kept, _], .. } = self.sways[0][0];
        if share > 0.0 && kept > 0.0 { Lasting { share, fades_s: -self.frame_s / ln(kept) } } else { self.lasting }
    }
}

/// Modulus of the roots of the `i`-th decay.
fn root(i: usize) -> f64 {
    let [least, greatest] = FRAMES.map(ln);
    exp(-exp(-(least + (greatest - least) * i as f64 / (DECAYS - 1) as f64)))
}

impl Sway {
    /// The sway in runs of noise of variance 1, frame by frame; `None` where nothing was seen.
    #[must_use]
    pub fn learn(runs: &[Vec<Option<f64>>]) -> Self {
        let (mut squares, mut n) = (0.0, 0.0);
        let (mut products, mut counts) = ([0.0; LAGS + 1], [0.0; LAGS + 1]);
        for run in runs {
            for (i, now) in run.iter().enumerate().filter_map(|(i, it)| Some((i, (*it)?))) {
                squares += now * now;
                n += 1.0;
                for lag in 1..=LAGS.min(i) {
                    if let Some(then) = run[i - lag] {
                        products[lag] += now * then;
                        counts[lag] += 1.0;
                    }
                }
            }
        }
        let variance = squares / f64::max(n, 1.0);
        let mut r = [0.0; LAGS + 1];
        for lag in 1..=LAGS {
            r[lag] = products[lag] / f64::max(counts[lag], 1.0) / variance.max(1e-12);
        }
        Self::of(&r, counts[1]).unwrap_or_default()
    }

    /// The sway whose autocorrelations are nearest to these: of a grid of decays and frequencies, 0 among them. White noise
    /// is in that of lag 0 alone, and in those of `n` pairs by chance.
    fn of(r: &[f64; LAGS + 1], n: f64) -> Option<Self> {
        let slow = (1..DECAYS).map(|i| [root(i), 0.0]);
        let turning = (0..DECAYS).flat_map(|i| {
            (1..TURNS).map(move |j| {
                let turn_rad = std::f64::consts::PI * j as f64 / TURNS as f64;
                [2.0 * root(i) * sin_cos(turn_rad).1, -root(i) * root(i)]
            })
        });
        let near = |on: [f64; 2]| {
            let sway = Self { share: 1.0, on, scale: 1.0 };
            let own = sway.correlations::<{ LAGS + 1 }>();
            let (fit, norm) =
                (1..=LAGS).fold((0.0, 0.0), |(fit, norm), k| (fit + r[k] * own[k], norm + own[k] * own[k]));
            let share = (fit / norm).clamp(0.0, 0.95);
            let off = (1..=LAGS).fold(0.0, |sum, k| sum + (r[k] - share * own[k]) * (r[k] - share * own[k]));
            (off, share * share * norm, Self { share, ..sway })
        };
        let (_, shows, nearest) = slow.chain(turning).map(near).reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        (nearest.share >= LEAST_SHARE && n * shows >= BY_CHANCE).then_some(nearest)
    }

    /// Its autocorrelations.
    #[must_use]
    pub fn correlations<const N: usize>(&self) -> [f64; N] {
        let [p, q] = self.on;
        let mut r = [1.0; N];
        for lag in 1..N {
            r[lag] = if lag == 1 { p / (1.0 - q) } else { p * r[lag - 1] + q * r[lag - 2] };
        }
        r
    }

    /// Variance of what is new in it from frame to frame, where it varies by 1.
    #[must_use]
    pub fn fresh_var(&self) -> f64 {
        let [_, r1, r2] = self.correlations::<3>();
        (1.0 - self.on[0] * r1 - self.on[1] * r2).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn noise(sway: Sway, n: usize, seed: u64) -> Vec<Option<f64>> {
        let mut rng = Seed(seed).stream("memory/test");
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut s = [0.0; 2];
        (0..n)
            .map(|_| {
                let now = sway.on[0] * s[0] + sway.on[1] * s[1] + sway.fresh_var().sqrt() * normal();
                s = [now, s[0]];
                Some(sway.share.sqrt() * now + (1.0 - sway.share).sqrt() * normal())
            })
            .collect()
    }

    #[test]
    fn a_sway_is_found_in_its_own_noise() {
        // A period of five frames that lasts for a second.
        let sway = Sway { share: 0.7, on: [0.58, -0.9], scale: 1.0 };
        let runs: Vec<_> = (0..8).map(|seed| noise(sway, 3000, seed)).collect();
        let found = Sway::learn(&runs);
        assert!((found.share - 0.7).abs() < 0.05, "{found:?}");
        assert!((found.on[0] - 0.58).abs() < 0.03 && (found.on[1] + 0.9).abs() < 0.03, "{found:?}");
    }

    #[test]
    fn white_noise_has_none() {
        let white = Sway::default();
        for seed in 0..50 {
            assert_eq!(Sway::learn(&[noise(white, 20_000, seed)]), Sway::default(), "{seed}");
        }
        assert_eq!(Sway::learn(&[]), Sway::default());
    }

    #[test]
    fn what_is_new_makes_up_for_what_fades() {
        let sway = Sway { share: 0.5, on: [1.1, -0.6], scale: 1.0 };
        let [r0, r1, _] = sway.correlations::<3>();
        let [p, q] = sway.on;
        // var(p s1 + q s2) + fresh = var s.
        let again = (p * p + q * q + 2.0 * p * q * r1) * r0 + sway.fresh_var();
        assert!((again - 1.0).abs() < 1e-12, "{again}");
    }

    #[test]
    fn a_pace_is_a_band_of_speed_one_way_or_the_other() {
        let of = |forward: f64| pace([0.0, forward, 0.0]);
        assert_eq!([0.0, 0.01, 0.25, 0.26, 0.5, 1.0].map(of), [0, 1, 1, 2, 2, 4]);
        assert_eq!([-0.01, -0.25, -0.26, -1.0].map(of), [5, 5, 6, 8]);
        assert_eq!([pace([-0.6, 0.0, 0.0]), pace([0.0, 0.0, -1.0]), pace([0.3, -0.1, 0.0])], [3, 4, 6]);
        assert!((0..=20).all(|i| of(f64::from(i) / 10.0 - 1.0) < PACES));
    }
}
