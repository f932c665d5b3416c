//! How a scanner's statistics scatter in the nominal world: from drive to drive, and from segment to segment of one.

use asami_math::elementary::ln;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::memory::contaminated;
use super::scanner::{COUNT, Segment};

/// No statistic is known better than this, whatever a handful of drives say.
const LEAST_SD: [f64; COUNT] =
    [1e-5, 2e-3, 2e-4, 3e-4, 5e-4, 2e-4, 2e-3, 0.05, 0.05, 0.05, 2e-4, 1e-3, 5e-3, 0.05, 1e-3];

/// The steps at the turn's seam and the things in the other lane: of these a segment in a hundred is far off while all others of
/// it are usual (7 of some 720 values of nominal drives, by 5 to 14 standard deviations). Their odd values are taken out alone,
/// and after the others, so that none is taken for odd with them.
const ODD: [usize; 2] = [1, 13];
/// Farther off than so many standard deviations is odd.
const ODD_SDS: f64 = 4.0;
/// Standard deviations are taken again so often without.
const ODD_ROUNDS: usize = 3;

/// Mean and covariances.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Law {
    /// Of all segments.
    pub mean: [f64; COUNT],
    /// Of drives' means.
    pub between: Vec<Vec<f64>>,
    /// Of segments about their drive's mean.
    pub within: Vec<Vec<f64>>,
}

/// What a segment says.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    /// `log p(segment | those before)`.
    pub log_likelihood: f64,
    /// What is expected of minus it.
    pub expected: f64,
    /// Of each statistic there is: which, off its prediction, the same whitened, logarithm of the scale, whether the
    /// segment is taken to be of the scanner.
    pub off: Vec<(usize, f64, f64, f64, bool)>,
}

impl Law {
    /// The law of nominal drives.
    #[must_use]
    pub fn learn(drives: &[Vec<Segment>]) -> Self {
        let drives = &without_odd(drives.to_vec());
        let all: Vec<&Segment> = drives.iter().flatten().collect();
        let mean = std::array::from_fn(|k| robust_mean(all.iter().map(|it| it.values[k])));
        let mut within = vec![vec![0.0; COUNT]; COUNT];
        let mut between = vec![vec![0.0; COUNT]; COUNT];
        let (mut n_within, mut n_between) = (within.clone(), within.clone());
        for segments in drives {
            let own: [f64; COUNT] = std::array::from_fn(|k| plain_mean(segments.iter().map(|it| it.values[k])));
            for i in 0..COUNT {
                for j in 0..COUNT {
                    for it in segments {
                        add(&mut within[i][j], &mut n_within[i][j], (it.values[i] - own[i]) * (it.values[j] - own[j]));
                    }
                    add(&mut between[i][j], &mut n_between[i][j], (own[i] - mean[i]) * (own[j] - mean[j]));
                }
            }
        }
        let drives_n = drives.len() as f64;
        for i in 0..COUNT {
            for j in 0..COUNT {
                let freedom = (n_within[i][j] - drives_n).max(1.0);
                within[i][j] /= freedom;
                between[i][j] /= n_between[i][j].max(1.0);
            }
        }
        // A drive's mean scatters by its segments' scatter as well; what few drives say of correlations is shrunk.
        let per_drive = (all.len() as f64 / drives_n.max(1.0)).max(1.0);
        for i in 0..COUNT {
            for j in 0..COUNT {
                let own = between[i][j] - within[i][j] / per_drive;
                between[i][j] = if i == j { own.max(0.1 * between[i][i]) } else { 0.8 * own };
                if i != j {
                    within[i][j] *= 0.8;
                }
            }
        }
        for k in 0..COUNT {
            let least = LEAST_SD[k] * LEAST_SD[k];
            within[k][k] = within[k][k].max(0.0) + 0.5 * least;
            between[k][k] = between[k][k].max(0.0) + 0.5 * least;
        }
        Self { mean, between: bounded(between), within: bounded(within) }
    }

    /// Standard deviation of a statistic in one segment.
    #[must_use]
    pub fn sd(&self, k: usize) -> f64 {
        (self.between[k][k] + self.within[k][k]).sqrt()
    }

    /// What segments say one after another where means are moved by `moved` and drives scatter by `further` standard
    /// deviations more.
    #[must_use]
    pub fn read(&self, segments: &[Segment], moved: &[f64], further: &[f64]) -> Vec<Said> {
        let mut mean = DVector::from_fn(COUNT, |k, _| self.mean[k] + moved[k]);
        let mut covariance = DMatrix::from_fn(COUNT, COUNT, |i, j| {
            self.between[i][j] + if i == j { further[i] * further[i] } else { 0.0 }
        });
        segments.iter().map(|segment| self.take(segment, &mut mean, &mut covariance)).collect()
    }

    fn take(&self, segment: &Segment, mean: &mut DVector<f64>, covariance: &mut DMatrix<f64>) -> Said {
        let is_there = |k: &usize| segment.values[*k].is_finite();
        let usual = (0..COUNT).filter(|k| !ODD.contains(k)).filter(is_there).collect::<Vec<_>>();
        let there: Vec<usize> = usual.iter().copied().chain(ODD.into_iter().filter(is_there)).collect();
        let n = there.len();
        let off = DVector::from_fn(n, |i, _| segment.values[there[i]] - mean[there[i]]);
        let s = self.scatter(&there, covariance);
        let lost = || Said { log_likelihood: f64::NEG_INFINITY, expected: 0.0, off: Vec::new() };
        let Some(l) = s.cholesky().map(|cholesky| cholesky.l()) else { return lost() };
        let Some(white) = l.solve_lower_triangular(&off) else { return lost() };

        let mut said = Said { log_likelihood: 0.0, expected: 0.0, off: Vec::new() };
        let alone = (usual.len()..n).map(|i| i..i + 1);
        for these in std::iter::once(0..usual.len()).chain(alone) {
            let ln_scale = these.clone().fold(0.0, |sum, i| sum + ln(l[(i, i)]));
            let squares = white.rows_range(these.clone()).norm_squared();
            let (log_likelihood, genuine) = contaminated(squares, these.len() as f64, ln_scale);
            said.log_likelihood += log_likelihood;
            said.expected += these.len() as f64 * (0.5 + 0.5 * ln(std::f64::consts::TAU)) + ln_scale;
            said.off.extend(these.map(|i| (there[i], off[i], white[i], ln(l[(i, i)]), genuine)));
        }
        let genuine: Vec<(usize, f64)> = said.off.iter().filter(|it| it.4).map(|it| (it.0, it.1)).collect();
        self.learn_from(&genuine, mean, covariance);
        said
    }

    /// Covariance of some statistics of the next segment.
    fn scatter(&self, there: &[usize], covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let n = there.len();
        DMatrix::from_fn(n, n, |i, j| covariance[(there[i], there[j])] + self.within[there[i]][there[j]])
    }

    /// The drive's own mean, after some statistics of a segment that are so far off it.
    fn learn_from(&self, off: &[(usize, f64)], mean: &mut DVector<f64>, covariance: &mut DMatrix<f64>) {
        let there: Vec<usize> = off.iter().map(|it| it.0).collect();
        let Some(cholesky) = self.scatter(&there, covariance).cholesky() else { return };
        let of = DMatrix::from_fn(COUNT, there.len(), |i, j| covariance[(i, there[j])]);
        let gain = &of * cholesky.inverse();
        *mean += &gain * DVector::from_iterator(off.len(), off.iter().map(|it| it.1));
        *covariance -= &gain * of.transpose();
    }
}

/// Drives whose odd values are gone.
fn without_odd(mut drives: Vec<Vec<Segment>>) -> Vec<Vec<Segment>> {
    for k in ODD {
        for _ in 0..ODD_ROUNDS {
            let mean = plain_mean(drives.iter().flatten().map(|it| it.values[k]));
            let variance = plain_mean(drives.iter().flatten().map(|it| (it.values[k] - mean) * (it.values[k] - mean)));
            let odd = |it: &&mut Segment| (it.values[k] - mean).abs() > ODD_SDS * variance.sqrt();
            drives.iter_mut().flatten().filter(odd).for_each(|it| it.values[k] = f64::NAN);
        }
    }
    drives
}

fn add(sum: &mut f64, n: &mut f64, term: f64) {
    if term.is_finite() {
        *sum += term;
        *n += 1.0;
    }
}

/// Mean of what is there.
pub(super) fn plain_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.filter(|it| it.is_finite()).fold((0.0, 0.0), |(sum, n), it| (sum + it, n + 1.0));
    if n > 0.0 { sum / n } else { f64::NAN }
}

/// Mean of what is there, an eighth cut off either end; 0 of nothing.
fn robust_mean(values: impl Iterator<Item = f64>) -> f64 {
    let mut there: Vec<f64> = values.filter(|it| it.is_finite()).collect();
    there.sort_by(f64::total_cmp);
    let cut = there.len() / 8;
    let middle = plain_mean(there[cut..there.len() - cut].iter().copied());
    if middle.is_finite() { middle } else { 0.0 }
}

/// The covariance with correlations pulled in until it is positive.
fn bounded(mut covariance: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for _ in 0..40 {
        let n = covariance.len();
        let scaled = DMatrix::from_fn(n, n, |i, j| covariance[i][j] / (covariance[i][i] * covariance[j][j]).sqrt());
        let least = scaled.symmetric_eigenvalues().iter().copied().fold(f64::INFINITY, f64::min);
        if least > 0.02 {
            break;
        }
        for (i, row) in covariance.iter_mut().enumerate() {
            row.iter_mut().enumerate().filter(|(j, _)| *j != i).for_each(|(_, it)| *it *= 0.9);
        }
    }
    covariance
}

#[cfg(test)]
mod tests {
    use super::*;
    use asami_dataset::Seed;
    use rand_distr::{Distribution, StandardNormal};

    /// Drives whose means scatter by 3 and whose segments by 1, in units of ten times the least.
    fn drives(n: usize, seed: u64) -> Vec<Vec<Segment>> {
        let mut rng = Seed(seed).stream("drive/law");
        let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
        let drive = |_| {
            let own: [f64; COUNT] = std::array::from_fn(|k| 30.0 * LEAST_SD[k] * normal());
            (0..3)
                .map(|i| Segment {
                    t_s: 20.0 * f64::from(i),
                    values: std::array::from_fn(|k| 7.0 + own[k] + 10.0 * LEAST_SD[k] * normal()),
                })
                .collect()
        };
        (0..n).map(drive).collect()
    }

    #[test]
    fn segments_of_nominal_drives_say_what_is_expected_of_them() {
        let law = Law::learn(&drives(300, 1));
        for (k, least) in LEAST_SD.iter().enumerate() {
            let (between, within) = (law.between[k][k].sqrt() / least, law.within[k][k].sqrt() / least);
            assert!((between - 30.0).abs() < 6.0 && (within - 10.0).abs() < 1.5, "{k}: {between} {within}");
        }
        let none = [0.0; COUNT];
        let (mut off, mut n) = (0.0, 0.0);
        for drive in drives(200, 2) {
            for said in law.read(&drive, &none, &none) {
                off += -said.log_likelihood - said.expected;
                n += 1.0;
            }
        }
        // Half of 15 squares has variance 7.5; learning the law costs something.
        assert!((off / n).abs() < 4.0 * (7.5_f64 / n).sqrt() + 0.7, "{}", off / n);
    }

    #[test]
    fn odd_values_do_not_widen_what_is_usual() {
        let mut some = drives(100, 6);
        let narrow = Law::learn(&some);
        for (drive, k) in some.iter_mut().step_by(30).zip(ODD.into_iter().cycle()) {
            drive[1].values[k] += 40.0 * narrow.sd(k);
        }
        let law = Law::learn(&some);
        for k in ODD {
            assert!((law.sd(k) / narrow.sd(k) - 1.0).abs() < 0.05, "{k}: {} {}", law.sd(k), narrow.sd(k));
        }
    }

    /// What is odd in one statistic neither says much nor hides what the others say.
    #[test]
    fn an_odd_value_is_taken_out_alone() {
        let law = Law::learn(&drives(300, 1));
        let none = [0.0; COUNT];
        let total = |drive: &[Segment]| law.read(drive, &none, &none).iter().map(|it| it.log_likelihood).sum::<f64>();
        let usual = drives(1, 4).remove(0);
        for k in ODD {
            let mut odd = usual.clone();
            odd[0].values[k] += 20.0 * law.sd(k);
            let lost = total(&usual) - total(&odd);
            assert!((2.0..16.0).contains(&lost), "{k}: {lost}");
            let mut both = odd.clone();
            both[0].values[2] += 6.0 * law.sd(2);
            let mut other = usual.clone();
            other[0].values[2] += 6.0 * law.sd(2);
            let (alone, beside) = (total(&usual) - total(&other), total(&odd) - total(&both));
            assert!((alone - beside).abs() < 0.3 * alone, "{k}: {alone} {beside}");
        }
    }

    #[test]
    fn a_statistic_that_is_not_there_says_nothing() {
        let law = Law::learn(&drives(50, 3));
        let none = [0.0; COUNT];
        let mut drive = drives(1, 4).remove(0);
        drive.iter_mut().for_each(|segment| segment.values[5] = f64::NAN);
        let without = law.read(&drive, &none, &none);
        let mut moved = none;
        moved[5] = 1.0;
        assert_eq!(law.read(&drive, &moved, &none), without);
        assert!(without.iter().all(|said| said.off.len() == COUNT - 1 && said.log_likelihood.is_finite()));
        let nothing = Segment { t_s: 0.0, values: [f64::NAN; COUNT] };
        assert!(law.read(&[nothing], &none, &none)[0].log_likelihood.abs() < 0.1);
    }
}
