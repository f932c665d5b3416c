//! How unsure sizes are that were found together, whatever the noise of a real robot is: how much the score of the log scatters
//! from block to block, over how curved its likelihood is (Huber 1967, White 1982). Where the noise were what it is taken for, the
//! two would be one number; of a real log its tails make the scores scatter by more.

use asami_math::elementary::{exp, ln};

use crate::judge::Judge;
use crate::newton::Curvature;
use crate::plant::Planted;

/// Scores are differences over such a change of a size's logarithm.
const DIFFERENCE: f64 = 0.05;
/// How curved the likelihood is is looked at over about a standard deviation, of a size's logarithm from the least to the greatest:
/// over less, what a reading errs by in the last digits would count.
const AROUND: [f64; 2] = [0.02, 0.5];
/// What a real robot and its sensor err by hangs together for seconds, whatever the filter makes of it: what is said of an
/// effect is weighed by blocks of this length.
const BLOCK_S: f64 = 20.0;
/// Half of a Gaussian's middle 90 %, in standard deviations.
const NINETY: f64 = 1.645;

/// The block in which each step is.
pub fn blocks(judge: &dyn Judge) -> Vec<usize> {
    let numbered = judge.steps().iter().scan((0, None), |(block, before), step| {
        let now = (step.t_s / BLOCK_S).floor();
        *block += usize::from(before.is_some_and(|before| before != now));
        *before = Some(now);
        Some(*block)
    });
    numbered.collect()
}

/// 90 % intervals of sizes where a log is likeliest, within each one's law; all of the law where the log does not tell.
#[must_use]
pub fn intervals(judge: &dyn Judge, all: &[Planted]) -> Vec<[f64; 2]> {
    let variances = variances(judge, all).unwrap_or_else(|| vec![f64::INFINITY; all.len()]);
    let within = |(it, variance): (&Planted, f64)| {
        let (least, greatest) = it.variant.sizes();
        let within = if variance.is_finite() { NINETY * variance.sqrt() } else { f64::INFINITY };
        [-within, within].map(|by| (it.size * exp(by)).clamp(least, greatest))
    };
    all.iter().zip(variances).map(within).collect()
}

/// Variances of the sizes' logarithms; `None` where a log says nothing of one.
fn variances(judge: &dyn Judge, all: &[Planted]) -> Option<Vec<f64>> {
    let terms = |all: &[Planted], by: &[(usize, f64)]| {
        let mut there = all.to_vec();
        by.iter().for_each(|(i, by)| there[*i].size *= exp(*by));
        judge.terms(&judge.numbers(&there))
    };
    let middle: Vec<Planted> = all.iter().map(|it| inside(it, DIFFERENCE)).collect();
    let score = |i: usize| -> Vec<f64> {
        let [above, below] = [DIFFERENCE, -DIFFERENCE].map(|by| terms(&middle, &[(i, by)]));
        above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * DIFFERENCE)).collect()
    };
    let scores: Vec<Vec<f64>> = (0..all.len()).map(score).collect();
    let around = Curvature::new(&scores, 0.0)?.variances().into_iter().map(|it| it.sqrt().clamp(AROUND[0], AROUND[1]));
    let around: Vec<f64> = around.collect();
    let middle: Vec<Planted> = all.iter().zip(&around).map(|(it, by)| inside(it, *by)).collect();
    let likely = |by: &[(usize, f64)]| terms(&middle, by).into_iter().fold(0.0, |sum, it| sum + it);
    // Where it bends upwards somewhere, the scores say how curved it is.
    let curvature = Curvature::of(&bent(likely, &around)).or_else(|| Curvature::new(&scores, 0.0))?;
    let scattered = curvature.variances_by_block(&scores, &blocks(judge));
    // Blocks are few: that errors in one made up for one another is not believed.
    Some(scattered.into_iter().zip(curvature.variances()).map(|(scattered, bent)| scattered.max(bent)).collect())
}

/// Minus the second derivatives of what is `likely` where some are changed by so much, over so much `around`.
fn bent(likely: impl Fn(&[(usize, f64)]) -> f64, around: &[f64]) -> Vec<Vec<f64>> {
    let here = likely(&[]);
    let sides = |i: usize, j: Option<usize>| {
        let by = |side: f64| [Some(i), j].into_iter().flatten().map(|k| (k, side * around[k])).collect::<Vec<_>>();
        likely(&by(1.0)) + likely(&by(-1.0)) - 2.0 * here
    };
    let alone: Vec<f64> = (0..around.len()).map(|i| sides(i, None)).collect();
    let mut bent = vec![vec![0.0; around.len()]; around.len()];
    for i in 0..around.len() {
        bent[i][i] = -alone[i] / (around[i] * around[i]);
        for j in 0..i {
            bent[i][j] = -(sides(i, Some(j)) - alone[i] - alone[j]) / (2.0 * around[i] * around[j]);
            bent[j][i] = bent[i][j];
        }
    }
    bent
}

/// Where so much to both sides stays within the law.
fn inside(it: &Planted, by: f64) -> Planted {
    let (least, greatest) = it.variant.sizes();
    let size = exp(ln(it.size).min(ln(greatest) - by).max(ln(least) + by));
    Planted { size, ..it.clone() }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

    /// Noise that is three times what it is taken for leaves sizes three times as unsure, alone or beside another.
    #[test]
    fn what_scatters_by_more_than_it_is_taken_to_is_surer_of_nothing() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let truth = kinds.map(|variant| Planted { size: 0.5 * variant.sizes().1, variant });
        let wave = |t: usize, step: f64| 3.0 * (step * t as f64).sin();
        let log = || Straight::new(&truth, &[&|t| wave(t, 0.37), &|t| wave(t, 0.37) + wave(t, 0.91)], Seed(7));
        let (quiet, mut loud) = (log(), log());
        let silent = quiet.numbers(&truth);
        for (t, it) in loud.measured.iter_mut().enumerate() {
            let made = quiet.made(&silent, t);
            *it = made + 3.0 * (*it - made);
        }
        let width = |judge: &dyn Judge| {
            intervals(judge, &truth).into_iter().map(|[from, to]| (to / from).ln()).collect::<Vec<f64>>()
        };
        let [quiet_widths, loud_widths] = [width(&quiet), width(&loud)];
        for (i, (quiet, loud)) in quiet_widths.iter().zip(&loud_widths).enumerate() {
            assert!((loud / quiet - 3.0).abs() < 1.2, "{i}: {quiet} {loud}");
        }
        // By the two waves' own squares, were nothing known of the other.
        let alone = 2.0 * NINETY / (0.5 * (400.0 * 9.0 / 2.0_f64).sqrt());
        assert!((quiet_widths[1] / alone - 1.0).abs() < 0.35, "{quiet_widths:?} {alone}");
    }

    /// A log that tells nothing of a size leaves all of its law.
    #[test]
    fn what_a_log_says_nothing_of_may_be_anything() {
        let kind = Straight::kind("command_scale");
        let (least, greatest) = kind.sizes();
        let truth = [Planted { size: 0.5 * greatest, variant: kind }];
        let nothing = Straight::new(&truth, &[&|_| 0.0], Seed(1));
        assert_eq!(intervals(&nothing, &truth), [[least, greatest]]);
    }
}
