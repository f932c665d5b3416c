//! The road under all lasers: how the scanner stands over it, and which lasers see it elsewhere than their neighbours.

use asami_dataset::firings::{ENCODER_STEP_RAD, RANGE_STEP_M};
use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::elementary::{ln, sin_cos};
use asami_math::regression::Regression;
use asami_scans::{Drive, Scan};

use super::motion::Moved;

/// Lasers that point down by more than this see the road near enough.
const DOWN: f64 = -0.085;
/// Half the width of the road that is looked at.
const ASIDE_M: f64 = 2.2;
/// As far ahead and behind it is looked at.
const AHEAD_M: f64 = 18.0;
/// Gates of the fit, one after another.
const GATES_M: [f64; 3] = [0.35, 0.15, 0.08];
/// Points of a laser in a segment that make a mean.
const LEAST: f64 = 150.0;

/// Height of the road over the sensor at x ahead and y to the left: `c + b x + a y + k x^2`.
pub type Plane = [f64; 4];

/// The road of a segment.
pub struct Ground {
    height_m: f64,
    /// Of each scan.
    planes: Vec<Plane>,
    /// Of each laser: points, sum of heights over the plane, sum of horizontal distances.
    lasers: Vec<[f64; 3]>,
    elevation: Vec<(f64, f64)>,
}

impl Ground {
    /// Nothing seen yet by a scanner that stands so high.
    #[must_use]
    pub fn new(drive: &Drive<'_>, height_m: f64) -> Self {
        Self {
            height_m,
            planes: Vec::new(),
            lasers: vec![[0.0; 3]; drive.lasers()],
            elevation: drive.elevation.clone(),
        }
    }

    /// Takes a scan in; the road in it, where it shows.
    pub fn take(&mut self, moved: &Moved<'_>, scan: &Scan) -> Option<Plane> {
        let points = points(moved, scan);
        let mut plane = [-self.height_m, 0.0, 0.0, 0.0];
        for gate_m in GATES_M {
            plane = fitted(&points, &plane, gate_m)?;
        }
        for (laser, [x, y, z]) in &points {
            let off_m = z - height(&plane, *x, *y);
            if off_m.abs() < 2.0 * GATES_M[2] {
                let sums = &mut self.lasers[*laser];
                *sums = [sums[0] + 1.0, sums[1] + off_m, sums[2] + (x * x + y * y).sqrt()];
            }
        }
        self.planes.push(plane);
        Some(plane)
    }

    /// Of each laser that saw the road `least` times and more: how often, how high it saw the road over all lasers' surface on
    /// average, how far away.
    #[must_use]
    pub fn by_laser(&self, least: f64) -> Vec<Option<[f64; 3]>> {
        self.lasers.iter().map(|[n, off_m, flat_m]| (*n >= least).then(|| [*n, off_m / n, flat_m / n])).collect()
    }

    /// Medians over the scans: how the road rises ahead and to the left, and the sensor's height, all as seen.
    #[must_use]
    pub fn posture(&self) -> [f64; 3] {
        [1, 2, 0].map(|k| {
            let mut values: Vec<f64> = self.planes.iter().map(|plane| plane[k]).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
        })
    }

    /// Vertical angle and range that all lasers have too much, by how the road bends with distance; logarithms of how
    /// vertical angles (of the far ones) and ranges (of the near ones) differ from laser to laser; how much higher the upper half of
    /// the lasers sees the road than the lower one.
    #[must_use]
    pub fn lasers(&self) -> [f64; 5] {
        let means = self.by_laser(LEAST);
        let mean = |laser: usize| means[laser].map(|[_, off_m, flat_m]| (off_m, flat_m));
        let mut bend = Regression::new(5);
        let (mut far, mut near) = (Vec::new(), Vec::new());
        for laser in 0..means.len() {
            let Some((off_m, flat_m)) = mean(laser) else { continue };
            let (sin, cos) = self.elevation[laser];
            let weight = 1.0 / (flat_m * flat_m).max(1.0);
            let upper = if laser < means.len() / 2 { 0.0 } else { 1.0 };
            bend.observe(&[1.0, flat_m, sin, flat_m * flat_m, upper], off_m, weight);
            let beside = laser.checked_sub(1).and_then(mean).zip(mean((laser + 1).min(means.len() - 1)));
            let Some(((low_m, low_flat_m), (high_m, high_flat_m))) = beside else { continue };
            if flat_m > 8.0 {
                far.push(off_m / flat_m - 0.5 * (low_m / low_flat_m + high_m / high_flat_m));
            }
            if flat_m < 6.0 {
                // A range that is too long goes below the road by its share down.
                near.push((off_m - 0.5 * (low_m + high_m)) / (cos * self.height_m / flat_m));
            }
        }
        let bend = bend
            .solve()
            .filter(|fit| fit.rank == 5)
            .map_or([f64::NAN; 3], |fit| [1, 2, 4].map(|k| fit.coefficients[k]));
        [bend[0], bend[1], ln_rms(&far), ln_rms(&near), bend[2]]
    }
}

/// Logarithm of the root mean square; no number of less than four.
pub(super) fn ln_rms(values: &[f64]) -> f64 {
    let squares = values.iter().fold(0.0, |sum, it| sum + it * it);
    if values.len() < 4 { f64::NAN } else { 0.5 * ln((squares / values.len() as f64).max(1e-14)) }
}

fn height(plane: &Plane, x: f64, y: f64) -> f64 {
    plane[0] + plane[1] * x + plane[2] * y + plane[3] * x * x
}

/// Returns from about the road: laser, and x ahead, y to the left, z up from the sensor.
fn points(moved: &Moved<'_>, scan: &Scan) -> Vec<(usize, [f64; 3])> {
    let drive = &moved.drive;
    let turns: Vec<(f64, f64)> =
        (scan.first..scan.end).map(|i| sin_cos(-f64::from(drive.firings.encoder_cdeg[i]) * ENCODER_STEP_RAD)).collect();
    let mut points = Vec::new();
    for (laser, (rise, reach)) in drive.elevation.iter().enumerate().filter(|(_, (rise, _))| *rise < DOWN) {
        let (sin_l, cos_l) = sin_cos(moved.angles_rad[laser]);
        let up_m = drive.place_m(laser)[1];
        for (steps, (sin_r, cos_r)) in drive.firings.range_2mm[laser][scan.first..scan.end].iter().zip(&turns) {
            let r = f64::from(*steps) * RANGE_STEP_M;
            let flat_m = r * reach;
            let y = flat_m * (sin_l * cos_r + cos_l * sin_r);
            if *steps == 0 || y.abs() > ASIDE_M {
                continue;
            }
            let x = flat_m * (cos_l * cos_r - sin_l * sin_r);
            if x.abs() < AHEAD_M {
                points.push((laser, [x, y, up_m + r * rise]));
            }
        }
    }
    points
}

/// The road through the points that lie near a first guess.
fn fitted(points: &[(usize, [f64; 3])], guess: &Plane, gate_m: f64) -> Option<Plane> {
    let (mut normal, mut right, mut n) = ([[0.0; 4]; 4], [0.0; 4], 0);
    for (_, [x, y, z]) in points {
        if (z - height(guess, *x, *y)).abs() > gate_m {
            continue;
        }
        let row = [1.0, *x, *y, x * x];
        // Near rings are dense.
        let weight = (x * x + y * y).sqrt();
        for i in 0..4 {
            for j in 0..=i {
                normal[i][j] += weight * row[i] * row[j];
            }
            right[i] += weight * row[i] * z;
        }
        n += 1;
    }
    if n < 200 {
        return None;
    }
    let full: Vec<Vec<f64>> = (0..4).map(|i| (0..4).map(|j| normal[i.max(j)][i.min(j)]).collect()).collect();
    let solved = cholesky_solve(&cholesky(&full)?, &right);
    solved.try_into().ok()
}
