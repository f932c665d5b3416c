//! Correlograms of many pairs at once: overlapping blocks, and spectra added up over the blocks.
//!
//! Only lags that are short beside the signals are wanted, so each signal is transformed block by block, once in each
//! role, and the cross-spectra of all blocks add up: six inverse transforms a pair in the end.

use std::ops::RangeInclusive;
use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

use super::{ABSENT, Correlogram};

/// Where the squares about the mean add up to less than this share of all the signal's, a transform cannot tell the coefficient to 1e-9.
const ROUNDING: f64 = 1e-5;

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
    let mut planner = RealFftPlanner::<f64>::new();
    let mut transform = Transform::new(planner.plan_fft_forward(size));
    let inverse = planner.plan_fft_inverse(size);
    let levels: Vec<Level> = signals.iter().map(|signal| level(signal)).collect();
    let energy = |i: usize| levels.get(i).map_or(0.0, |level| level.energy);
    let blocks = Blocks { signals, levels: &levels, before, behind, fresh: size - before - behind, longest };
    // Where no spectrum serves two pairs, one pair after another keeps all that is added up near at hand.
    let batch = if served_once(pairs) { 1 } else { pairs.len() };
    let mut time = inverse.make_output_vec();
    let mut scratch = inverse.make_scratch_vec();
    let mut moments = |mut spectrum: Spectrum| -> Vec<f64> {
        // The transform of a real sequence is real at both ends.
        for end in [0, size / 2] {
            spectrum[end].im = 0.0;
        }
        match inverse.process_with_scratch(&mut spectrum, &mut time, &mut scratch) {
            Ok(()) => (first..=last).map(|lag| time[lag.rem_euclid(size as isize) as usize] / size as f64).collect(),
            // Only buffers of a wrong length are refused.
            Err(_) => vec![f64::NAN; (last - first + 1) as usize],
        }
    };
    let sums = pairs.chunks(batch.max(1)).flat_map(|pairs| blocks.cross_spectra(&mut transform, pairs));
    sums.zip(pairs).map(|(sum, (a, b))| correlogram(first, sum.map(&mut moments), [energy(*a), energy(*b)])).collect()
}

/// Whether each signal is the first of one pair at most, and the second of one at most.
fn served_once(pairs: &[(usize, usize)]) -> bool {
    let once = |of: fn(&(usize, usize)) -> usize| {
        let mut used: Vec<usize> = pairs.iter().map(of).collect();
        used.sort_unstable();
        used.windows(2).all(|two| two[0] != two[1])
    };
    once(|pair| pair.0) && once(|pair| pair.1)
}

/// How signals are cut into blocks.
struct Blocks<'a> {
    signals: &'a [&'a [i16]],
    levels: &'a [Level],
    /// Places that a shifted block reaches beyond the fixed one, ahead of it and behind.
    before: usize,
    behind: usize,
    /// Places of a fixed block.
    fresh: usize,
    longest: usize,
}

impl Blocks<'_> {
    /// Of each pair the six cross-spectra, added up over all blocks.
    fn cross_spectra(&self, transform: &mut Transform, pairs: &[(usize, usize)]) -> Vec<[Spectrum; 6]> {
        let (mut fixed, mut shifted) = (vec![None; self.signals.len()], vec![None; self.signals.len()]);
        for &(a, b) in pairs {
            if a < fixed.len() && b < shifted.len() {
                fixed[a] = Some([const { Vec::new() }; 3]);
                shifted[b] = Some([const { Vec::new() }; 3]);
            }
        }
        let mut sums: Vec<[Spectrum; 6]> =
            pairs.iter().map(|_| [(); 6].map(|()| vec![Complex::default(); transform.bins()])).collect();
        for start in (0..self.longest).step_by(self.fresh) {
            let origin = start as isize - self.before as isize;
            for (i, signal) in self.signals.iter().enumerate() {
                if let Some(spectra) = &mut fixed[i] {
                    transform.block(signal, self.levels[i].mean, start..start + self.fresh, origin, spectra);
                }
                if let Some(spectra) = &mut shifted[i] {
                    let span = origin.max(0) as usize..(start + self.fresh + self.behind);
                    transform.block(signal, self.levels[i].mean, span, origin, spectra);
                }
            }
            for (sum, (a, b)) in sums.iter_mut().zip(pairs) {
                if let (Some(Some(a)), Some(Some(b))) = (fixed.get(*a), shifted.get(*b)) {
                    add_products(sum, a, b);
                }
            }
        }
        sums
    }
}

/// Counts and coefficients from the six sums at each lag: places, x, y, x^2, y^2, x y.
fn correlogram(first_lag: isize, [n, x, y, xx, yy, xy]: [Vec<f64>; 6], energies: [f64; 2]) -> Correlogram {
    let [least_x, least_y] = energies.map(|energy| ROUNDING * energy.max(1.0));
    let counts: Vec<i64> = n.iter().map(|n| n.round().max(0.0) as i64).collect();
    let coefficients = (0..counts.len())
        .map(|i| {
            let n = counts[i] as f64;
            let (x_ss, y_ss) = (xx[i] - x[i] * x[i] / n, yy[i] - y[i] * y[i] / n);
            let varies = x_ss > least_x && y_ss > least_y;
            if counts[i] > 1 && varies { (xy[i] - x[i] * y[i] / n) / (x_ss * y_ss).sqrt() } else { f64::NAN }
        })
        .collect();
    Correlogram { first_lag, counts, coefficients }
}

/// Where a signal's values lie.
#[derive(Clone, Copy, Debug)]
struct Level {
    /// Their mean, rounded.
    mean: f64,
    /// Sum of squares about it.
    energy: f64,
}

fn level(signal: &[i16]) -> Level {
    let sums = super::Overlap::at(signal, signal, 0);
    let n = sums.count.max(1) as f64;
    let mean = (sums.x[0] as f64 / n).round();
    Level { mean, energy: sums.x[1] as f64 - mean * (2.0 * sums.x[0] as f64 - n * mean) }
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

    /// Frequencies of a spectrum.
    fn bins(&self) -> usize {
        self.inputs[0].len() / 2 + 1
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
        // A signal that ends before this block leaves it empty.
        let offset = (start as isize - origin).max(0) as usize;
        let of = offset..offset + (end - start);
        let outputs = mask[of.clone()].iter_mut().zip(&mut value[of.clone()]).zip(&mut square[of]);
        for (&v, ((mask, value), square)) in signal[start..end].iter().zip(outputs) {
            let there = f64::from(u8::from(v != ABSENT));
            let x = (f64::from(v) - mean) * there;
            (*mask, *value, *square) = (there, x, x * x);
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
