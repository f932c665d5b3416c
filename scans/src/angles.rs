//! From the lags of pairs to the lasers' angles, up to a common offset.

use std::f64::consts::PI;

use asami_math::regression::Regression;

use crate::pairs::PairLag;

/// Angles whose mean is 0, with their standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Angles {
    /// One per laser.
    pub angle_rad: Vec<f64>,
    /// One per laser, about the mean of all.
    pub se_rad: Vec<f64>,
    /// Pairs that no lag was found for, or whose lag does not fit the others'.
    pub lost: Vec<(usize, usize)>,
}

/// Adds up the differences of adjacent lasers (section 5.1): `differences_rad[l]` is `theta_(l+1) - theta_l`, 0 taken where
/// there is none. A difference is known to a step of the firings, evenly: the standard errors are those of a sum of such.
#[must_use]
pub fn chain(differences_rad: &[Option<f64>], step_rad: f64) -> Angles {
    let lasers = differences_rad.len() + 1;
    let mut angle_rad = vec![0.0; lasers];
    for (l, difference_rad) in differences_rad.iter().enumerate() {
        angle_rad[l + 1] = angle_rad[l] + difference_rad.unwrap_or(0.0);
    }
    centre(&mut angle_rad);
    // Laser k less the mean of all: difference i counts with its share of lasers below it, or less that above.
    let share = |k: usize, i: usize| {
        let above = (lasers - 1 - i) as f64 / lasers as f64;
        if i < k { 1.0 - above } else { -above }
    };
    let spread = |k: usize| (0..lasers - 1).fold(0.0, |sum, i| sum + share(k, i) * share(k, i));
    let se_rad = (0..lasers).map(|k| step_rad * (spread(k) / 12.0).sqrt()).collect();
    let lost = (0..lasers - 1).filter(|l| differences_rad[*l].is_none()).map(|l| (l, l + 1)).collect();
    Angles { angle_rad, se_rad, lost }
}

/// Angles that fit all pairs' lags best, pairs that do not fit counting less and less: weights of Geman and McClure (1985) whose scale
/// shrinks from 5 degrees to `scale_rad` (graduated non-convexity, Blake and Zisserman 1987). `None` if the pairs do not hold all lasers
/// together.
#[must_use]
pub fn graph(lasers: usize, lags: &[Option<PairLag>], scale_rad: f64) -> Option<Angles> {
    let edges: Vec<&PairLag> = lags.iter().flatten().filter(|lag| lag.peak.coefficient > 0.0).collect();
    let mut scale = (5.0 * PI / 180.0).max(scale_rad);
    let mut weights: Vec<f64> = edges.iter().map(|edge| edge.peak.coefficient).collect();
    let mut regression = solve(lasers, &edges, &weights);
    let mut angle_rad = regression.solve().filter(|fit| fit.rank == lasers)?.coefficients;
    loop {
        let residual = |edge: &PairLag, angle_rad: &[f64]| edge.angle_rad - (angle_rad[edge.b] - angle_rad[edge.a]);
        for _ in 0..5 {
            for (weight, edge) in weights.iter_mut().zip(&edges) {
                let ratio = residual(edge, &angle_rad) / scale;
                let fits = 1.0 / (1.0 + ratio * ratio);
                *weight = (edge.peak.coefficient * fits * fits).max(1e-9);
            }
            regression = solve(lasers, &edges, &weights);
            angle_rad = regression.solve().filter(|fit| fit.rank == lasers)?.coefficients;
        }
        if scale <= scale_rad {
            let misfits = edges.iter().filter(|edge| residual(edge, &angle_rad).abs() > 3.0 * scale_rad);
            let mut lost: Vec<(usize, usize)> = misfits.map(|edge| (edge.a, edge.b)).collect();
            lost.retain(|(a, b)| b - a == 1);
            let se_rad = regression.standard_errors().unwrap_or_default();
            centre(&mut angle_rad);
            return Some(Angles { angle_rad, se_rad, lost });
        }
        scale = (0.6 * scale).max(scale_rad);
    }
}

fn solve(lasers: usize, edges: &[&PairLag], weights: &[f64]) -> Regression {
    let mut regression = Regression::new(lasers);
    let mut row = vec![1.0 / lasers as f64; lasers];
    // Only differences are seen: the mean of all is held at 0.
    regression.observe(&row, 0.0, 1.0);
    for (edge, weight) in edges.iter().zip(weights) {
        row.fill(0.0);
        (row[edge.a], row[edge.b]) = (-1.0, 1.0);
        regression.observe(&row, edge.angle_rad, *weight);
    }
    regression
}

fn centre(angle_rad: &mut [f64]) {
    let mean = angle_rad.iter().fold(0.0, |sum, angle| sum + angle) / angle_rad.len().max(1) as f64;
    angle_rad.iter_mut().for_each(|angle| *angle -= mean);
}
