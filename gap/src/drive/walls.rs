//! Walls that neighbouring lasers see: they are upright, so that both must see them equally far.

use asami_dataset::firings::{ENCODER_STEP_RAD, RANGE_STEP_M};
use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::elementary::cos;
use asami_scans::{Drive, Scan};

use super::ground::ln_rms;
use super::motion::Moved;

/// Lower returns are of the ground.
const LOWEST_M: f64 = -1.0;
/// Farther ones are too far apart.
const FARTHEST_M: f64 = 40.0;
/// Differences beyond this are of different things.
const GATE_M: f64 = 0.12;
/// A wall bends by less than this over four firings.
const BEND_M: f64 = 0.06;
/// Returns of a pair of lasers that tell something.
const LEAST: f64 = 200.0;

/// Differences of a pair of lasers: normal equations of a constant, the wall's slope, the slope over the range.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    n: f64,
    normal: [[f64; 3]; 3],
    right: [f64; 3],
    /// Sums over the slopes of 1, 1 over the range, and that squared.
    sums: [f64; 3],
    /// Sum of squared bends, by which single ranges show how noisy they are.
    bends_m2: f64,
}

/// The walls of a segment.
pub struct Walls {
    pairs: Vec<Pair>,
    step_rad: f64,
}

impl Walls {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(drive: &Drive<'_>) -> Self {
        Self { pairs: vec![Pair::default(); drive.lasers().saturating_sub(1)], step_rad: drive.step_rad }
    }

    /// Takes a scan in; the car moves ahead at `v_m_per_s` meanwhile.
    pub fn take(&mut self, moved: &Moved<'_>, scan: &Scan, v_m_per_s: f64) {
        let drive = &moved.drive;
        let firings = drive.firings;
        let firing_s =
            (firings.t_s[scan.end - 1] - firings.t_s[scan.first]) / (scan.end - scan.first - 1).max(1) as f64;
        for (a, pair) in self.pairs.iter_mut().enumerate() {
            let (one, other) = (&firings.range_2mm[a], &firings.range_2mm[a + 1]);
            let ((rise, reach), (_, other_reach)) = (drive.elevation[a], drive.elevation[a + 1]);
            let aside_m = drive.place_m(a)[0] - drive.place_m(a + 1)[0];
            // So many firings later the other looks the same way.
            let lag = (moved.angles_rad[a + 1] - moved.angles_rad[a]) / drive.step_rad;
            let (whole, part) = (lag.floor(), lag - lag.floor());
            for i in (scan.first.max(2)..scan.end.min(one.len().saturating_sub(2))).step_by(2) {
                let Some(r) = smooth(one, i) else { continue };
                if r[1] > FARTHEST_M || r[1] * rise < LOWEST_M {
                    continue;
                }
                let at = i as f64 + whole;
                if at < 0.0 || at + 1.0 >= other.len() as f64 {
                    continue;
                }
                let [p, q] = [other[at as usize], other[at as usize + 1]].map(|r| f64::from(r) * RANGE_STEP_M);
                if p == 0.0 || q == 0.0 || (p - q).abs() > 0.5 {
                    continue;
                }
                let turned_rad = f64::from(firings.encoder_cdeg[i]) * ENCODER_STEP_RAD;
                let went_m = v_m_per_s * lag * firing_s * cos(moved.angles_rad[a] - turned_rad);
                let flat_m = r[1] * reach;
                // The head turns clockwise.
                let slope_m = -(r[2] - r[0]) * reach / (4.0 * drive.step_rad);
                let known_m = aside_m * slope_m / flat_m;
                let off_m = flat_m - ((p + part * (q - p)) * other_reach + went_m) - known_m;
                if off_m.abs() < GATE_M && slope_m.abs() < 1.5 * flat_m {
                    pair.add([1.0, slope_m, slope_m / flat_m], off_m);
                    let bend_m = (r[0] - 2.0 * r[1] + r[2]) * reach;
                    pair.bends_m2 += bend_m * bend_m;
                    for (k, sum) in pair.sums.iter_mut().enumerate() {
                        *sum += (1.0 / flat_m).powi(k as i32);
                    }
                }
            }
        }
    }

    /// Of each laser and the one above it, where both saw walls `least` times and more: how much farther the lower one sees
    /// them, how much farther to the left it stands, and how well the latter shows (the inverse of its cofactor).
    #[must_use]
    pub fn by_pair(&self, least: f64) -> Vec<Option<[f64; 3]>> {
        let step_rad = self.step_rad;
        let of = |pair: &Pair| {
            let ([constant_m, _, aside_m], shows) = (pair.n >= least).then(|| pair.solved(step_rad))??;
            Some([constant_m, aside_m, shows])
        };
        self.pairs.iter().map(of).collect()
    }

    /// Logarithm of how ranges of neighbours differ, and how far lasers stand to either side by turns, even ones to the
    /// left.
    #[must_use]
    pub fn lasers(&self) -> [f64; 2] {
        let (mut constants, mut sum, mut weight) = (Vec::new(), 0.0, 0.0);
        for (a, pair) in self.by_pair(LEAST).into_iter().enumerate() {
            let Some([constant_m, aside_m, counts]) = pair else { continue };
            constants.push(constant_m);
            let sign = if a.is_multiple_of(2) { 1.0 } else { -1.0 };
            sum += 0.5 * sign * aside_m * counts;
            weight += counts;
        }
        let middle = {
            let mut sorted = constants.clone();
            sorted.sort_by(f64::total_cmp);
            sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
        };
        // Some neighbours see a hedge where the other sees the wall behind it: the middle half tells.
        constants.iter_mut().for_each(|it| *it = (*it - middle).abs());
        constants.sort_by(f64::total_cmp);
        [ln_rms(&constants[..2 * constants.len() / 3]), if weight > 0.0 { sum / weight } else { f64::NAN }]
    }
}

impl Pair {
    fn add(&mut self, row: [f64; 3], off_m: f64) {
        self.n += 1.0;
        for i in 0..3 {
            for j in 0..3 {
                self.normal[i][j] += row[i] * row[j];
            }
            self.right[i] += row[i] * off_m;
        }
    }

    /// The coefficients, and how well the last is known: the inverse of its cofactor. What noise of ranges adds to slopes is taken
    /// away, or they would count for too little (Fuller 1987, section 1.2).
    fn solved(&self, step_rad: f64) -> Option<([f64; 3], f64)> {
        let range_m2 = self.bends_m2 / (6.0 * self.n);
        let slope_m2 = 2.0 * range_m2 / (4.0 * step_rad).powi(2);
        let mut normal: Vec<Vec<f64>> = self.normal.iter().map(|row| row.to_vec()).collect();
        for (i, row) in normal.iter_mut().enumerate().skip(1) {
            for (j, it) in row.iter_mut().enumerate().skip(1) {
                // Of walls that all stand square to the ray noise would leave nothing.
                *it -= (slope_m2 * self.sums[i + j - 2]).min(0.5 * it.max(0.0));
            }
        }
        let l = cholesky(&normal)?;
        let solved: [f64; 3] = cholesky_solve(&l, &self.right).try_into().ok()?;
        let cofactor = cholesky_solve(&l, &[0.0, 0.0, 1.0])[2];
        (cofactor > 0.0 && cofactor.is_finite()).then(|| (solved, 1.0 / cofactor))
    }
}

/// Ranges two firings before, at, and two after, where they are of one surface that hardly bends.
fn smooth(ranges: &[u16], i: usize) -> Option<[f64; 3]> {
    let r = [i - 2, i, i + 2].map(|k| f64::from(ranges[k]) * RANGE_STEP_M);
    (!r.contains(&0.0) && (r[0] - 2.0 * r[1] + r[2]).abs() < BEND_M).then_some(r)
}
