//! Correlograms of many pairs at once: overlapping blocks, and spectra added up over the blocks.
//!
//! Only lags that are short beside the signals are wanted, so each signal is transformed block by block, once in each
//! role, and the cross-spectra of all blocks add up: six inverse transforms a pair in the end.

use std::ops::RangeInclusive;
use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

use super::{ABSENT, Correlogram};

/// Variances below this share of the sum of squares are rounding, for all that a transform can tell.
const ROUNDING: f64 = 1e-9;

/// Places of a block beside the lags on its two ends.
const BLOCK: usize = 7000;

/// Correlograms of `pairs` of `signals` over `lags`: the second signal of a pair is the one shifted, `(a[i], b[i + lag])`.
///
/// An empty list if there are no lags; pairs of signals that are not there have no coefficients.
#[must_use]
pub fn correlograms(signals: &[&[i16]], pairs: &[(usize, usize)], lags: RangeInclusive<isize>) -> Vec<Correlogram> {
    let (first, last) = lags.into_inner();
    if last < first {
        return Vec::new();
    }
    let (before, behind) = (first.min(0).unsigned_abs(), last.max(0).unsigned_abs());
    let longest = signals.iter().map(|signal| signal.len()).max().unwrap_or(0);
    let size = (before + behind + BLOCK.min(longest + 1)).next_power_of_two();
    let fresh = size - before - behind;
    let mut planner = RealFftPlanner::<f64>::new();
    let mut transform = Transform::new(planner.plan_fft_forward(size));
    let inverse = planner.plan_fft_inverse(size);
    let bins = size / 2 + 1;
    let means: Vec<f64> = signals.iter().map(|signal| mean(signal)).collect();
    let role = |of: &dyn Fn(&(usize, usize)) -> usize| {
        let mut used = vec![false; signals.len()];
        pairs.iter().map(of).for_each(|i| {
            if let Some(used) = used.get_mut(i) {
                *used = true
            }
        });
        used
    };
    let (fixed, shifted) = (role(&|pair| pair.0), role(&|pair| pair.1));

    let mut sums = vec![[const { Vec::new() }; 6]; pairs.len()];
    sums.iter_mut().flatten().for_each(|sum| *sum = vec![Complex::default(); bins]);
    let mut fixed_spectra = vec![[const { Vec::new() }; 3]; signals.len()];
    let mut shifted_spectra = fixed_spectra.clone();
    let mut start = 0;
    while start < longest {
        for (i, signal) in signals.iter().enumerate() {
            if fixed[i] {
                transform.block(
                    signal,
                    means[i],
                    start..start + fresh,
                    start as isize - before as isize,
                    &mut fixed_spectra[i],
                );
            }
            if shifted[i] {
                let from = start as isize - before as isize;
                let span = from.max(0) as usize..(start + fresh + behind);
                transform.block(signal, means[i], span, from, &mut shifted_spectra[i]);
            }
        }
        for (sum, (a, b)) in sums.iter_mut().zip(pairs) {
            if let (Some(a), Some(b)) = (fixed_spectra.get(*a), shifted_spectra.get(*b)) {
                add_products(sum, a, b);
            }
        }
        start += fresh;
    }
    let mut time = inverse.make_output_vec();
    let mut scratch = inverse.make_scratch_vec();
    let mut moments = |mut spectrum: Vec<Complex<f64>>| -> Vec<f64> {
        // The transform of a real sequence is real at both ends.
        for end in [0, bins - 1] {
            spectrum[end].im = 0.0;
        }
        match inverse.process_with_scratch(&mut spectrum, &mut time, &mut scratch) {
            Ok(()) => (first..=last).map(|lag| time[lag.rem_euclid(size as isize) as usize] / size as f64).collect(),
            // Only buffers of a wrong length are refused.
            Err(_) => vec![f64::NAN; (last - first + 1) as usize],
        }
    };
    sums.into_iter().map(|sum| correlogram(first, sum.map(&mut moments))).collect()
}

/// Counts and coefficients from the six sums at each lag: places, x, y, x^2, y^2, x y.
fn correlogram(first_lag: isize, [n, x, y, xx, yy, xy]: [Vec<f64>; 6]) -> Correlogram {
    let counts: Vec<i64> = n.iter().map(|n| n.round().max(0.0) as i64).collect();
    let coefficients = (0..counts.len())
        .map(|i| {
            let n = counts[i] as f64;
            let (x_ss, y_ss) = (xx[i] - x[i] * x[i] / n, yy[i] - y[i] * y[i] / n);
            let varies = x_ss > ROUNDING * xx[i].abs().max(1.0) && y_ss > ROUNDING * yy[i].abs().max(1.0);
            if counts[i] > 1 && varies { (xy[i] - x[i] * y[i] / n) / (x_ss * y_ss).sqrt() } else { f64::NAN }
        })
        .collect();
    Correlogram { first_lag, counts, coefficients }
}

fn mean(signal: &[i16]) -> f64 {
    let there = signal.iter().filter(|v| **v != ABSENT);
    let (n, sum) = there.fold((0i64, 0i64), |(n, sum), v| (n + 1, sum + i64::from(*v)));
    if n > 0 { (sum as f64 / n as f64).round() } else { 0.0 }
}

type Spectrum = Vec<Complex<f64>>;

/// Forward transforms of blocks: of the mask, of the values less their mean, and of the squares of those.
struct Transform {
    forward: Arc<dyn RealToComplex<f64>>,
    inputs: [Vec<f64>; 3],
    scratch: Spectrum,
}

impl Transform {
    fn new(forward: Arc<dyn RealToComplex<f64>>) -> Self {
        let inputs = [(); 3].map(|()| forward.make_input_vec());
        let scratch = forward.make_scratch_vec();
        Self { forward, inputs, scratch }
    }

    /// The three spectra of `signal[span]`, whose place `origin` is the block's first; zeros around it.
    fn block(
        &mut self,
        signal: &[i16],
        mean: f64,
        span: std::ops::Range<usize>,
        origin: isize,
        into: &mut [Spectrum; 3],
    ) {
        let [mask, value, square] = &mut self.inputs;
        for input in [&mut *mask, &mut *value, &mut *square] {
            input.fill(0.0);
        }
        let end = span.end.min(signal.len());
        let start = span.start.min(end);
        for (i, &v) in signal[start..end].iter().enumerate() {
            if v != ABSENT {
                let (k, x) = (((start + i) as isize - origin) as usize, f64::from(v) - mean);
                (mask[k], value[k], square[k]) = (1.0, x, x * x);
            }
        }
        for (input, spectrum) in self.inputs.iter_mut().zip(into) {
            spectrum.resize(input.len() / 2 + 1, Complex::default());
            // Only buffers of a wrong length are refused.
            if self.forward.process_with_scratch(input, spectrum, &mut self.scratch).is_err() {
                spectrum.fill(Complex::default());
            }
        }
    }
}

/// Adds a block's cross-spectra to the sums.
fn add_products(sums: &mut [Spectrum; 6], [am, ax, axx]: &[Spectrum; 3], [bm, by, byy]: &[Spectrum; 3]) {
    let [n, x, y, xx, yy, xy] = sums;
    let bins = n.len();
    let (am, ax, axx) = (&am[..bins], &ax[..bins], &axx[..bins]);
    let (bm, by, byy) = (&bm[..bins], &by[..bins], &byy[..bins]);
    let (x, y, xx, yy, xy) = (&mut x[..bins], &mut y[..bins], &mut xx[..bins], &mut yy[..bins], &mut xy[..bins]);
    for k in 0..bins {
        let (m, v, s) = (am[k].conj(), ax[k].conj(), axx[k].conj());
        n[k] += m * bm[k];
        x[k] += v * bm[k];
        y[k] += m * by[k];
        xx[k] += s * bm[k];
        yy[k] += m * byy[k];
        xy[k] += v * by[k];
    }
}
