//! Effects added one by one while that helps on blocks that no fit has seen.

use asami_dataset::Log;
use asami_math::elementary::{exp, ln};
use asami_math::optimise::golden_section;

use crate::answer::contest::{CannotDiagnose, Diagnoses, Judges, Likelihood};
use crate::answer::diagnosis::Diagnosis;
use crate::plant::{Planted, Variant};

/// Greedy forward selection with the one-standard-error rule (Breiman, Friedman, Olshen and Stone 1984, section
/// 3.4.3): sizes and order come from every other block, the number of effects from the blocks between: the
/// fewest whose score there is within one standard error of the best.
pub struct ForwardSelection<'a> {
    /// The likelihood of logs.
    pub judges: &'a dyn Judges,
    /// The effects that may be added.
    pub variants: Vec<Variant>,
    /// The most that are added.
    pub most: usize,
}

impl Diagnoses for ForwardSelection<'_> {
    fn name(&self) -> &str {
        "forward_selection"
    }

    fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotDiagnose> {
        let likelihood = self.judges.of(log)?;
        let mut path = vec![Vec::new()];
        while path.len() <= self.most {
            let so_far: &[Planted] = path.last().map_or(&[], Vec::as_slice);
            let Some(longer) = longer(&*likelihood, so_far, &self.variants) else { break };
            path.push(longer);
        }
        let scores: Vec<Vec<f64>> = path.iter().map(|effects| every_other(&likelihood.blocks(effects), 1)).collect();
        let chosen = one_standard_error(&scores);
        Ok(Diagnosis::flat(path.get(chosen).map_or(&[], Vec::as_slice)))
    }
}

/// The set with one more effect, the one that fits the training blocks best; `None` where none is left.
fn longer(likelihood: &dyn Likelihood, so_far: &[Planted], variants: &[Variant]) -> Option<Vec<Planted>> {
    let is_new = |variant: &&Variant| !so_far.iter().any(|planted| planted.variant.about == variant.about);
    let with = |variant: &Variant| {
        let set = |size: f64| [so_far, &[Planted { variant: variant.clone(), size }]].concat();
        let fit = |size: f64| every_other(&likelihood.blocks(&set(size)), 0).iter().fold(0.0, |sum, term| sum + term);
        let size = best_size(variant.sizes(), fit);
        (fit(size), set(size))
    };
    let fitted = variants.iter().filter(is_new).map(with).filter(|(fit, _)| fit.is_finite());
    fitted.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, set)| set)
}

/// Sizes of the grid before it is refined.
const GRID: usize = 6;

/// The size of the greatest `fit` between two ends, on a logarithmic scale: a grid, refined about its best.
pub(crate) fn best_size((least, greatest): (f64, f64), fit: impl Fn(f64) -> f64) -> f64 {
    let span = ln(greatest / least);
    let at = |place: f64| least * exp(span * place);
    let step = 1.0 / (GRID - 1) as f64;
    let grid = (0..GRID).map(|i| (fit(at(i as f64 * step)), i as f64 * step));
    let Some((_, best)) = grid.max_by(|a, b| a.0.total_cmp(&b.0)) else { return least };
    let found = golden_section(|place| -fit(at(place)), (best - step).max(0.0), (best + step).min(1.0), 0.02);
    at(found.x)
}

fn every_other(blocks: &[f64], from: usize) -> Vec<f64> {
    blocks.iter().skip(from).step_by(2).copied().collect()
}

/// The first of the rows that is less than one standard error of their difference below the best.
fn one_standard_error(rows: &[Vec<f64>]) -> usize {
    let sum = |row: &[f64]| row.iter().fold(0.0, |sum, term| sum + term);
    let Some(best) = rows.iter().max_by(|a, b| sum(a).total_cmp(&sum(b))) else { return 0 };
    let is_near = |row: &Vec<f64>| {
        let differences: Vec<f64> = best.iter().zip(row).map(|(a, b)| a - b).collect();
        let n = differences.len() as f64;
        let mean = sum(&differences) / n;
        let squares = differences.iter().fold(0.0, |sum, d| sum + (d - mean) * (d - mean));
        // The standard error of a sum of n.
        let error = (n * squares / (n - 1.0).max(1.0)).sqrt();
        sum(&differences) <= error
    };
    rows.iter().position(is_near).unwrap_or(0)
}
