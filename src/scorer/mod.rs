//! How far learned models are from the truth: one yardstick for each study.

pub mod car;
pub mod line;
pub mod plane;
pub mod stride;

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
    sum / n
}

fn square(x: f64) -> f64 {
    x * x
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// Greatest less least of values that are numbers.
fn range(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (least, greatest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    finite(greatest - least)
}

/// Root mean square of the errors of pairs (model, truth), and the share of the truth's variance that the
/// model explains.
fn rmse_and_r2(pairs: &[[f64; 2]]) -> Option<(f64, Option<f64>)> {
    let rest = finite(mean(pairs.iter().map(|[model, truth]| square(model - truth))))?;
    let centre = mean(pairs.iter().map(|[_, truth]| *truth));
    let variance = mean(pairs.iter().map(|[_, truth]| square(truth - centre)));
    Some((rest.sqrt(), finite(1.0 - rest / variance)))
}
