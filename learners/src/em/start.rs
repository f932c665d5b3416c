//! Where the first state may be, and over which distances `f` is a polynomial.
//!
//! The dissertation does not say what `pi(w_0)` starts as. Here, in the plane: poses on a coarse grid over the
//! landmarks' rectangle are tried, and the one under which the starting models explain the first sightings best is
//! the mean. Along a line: the place from which the starting `f` gives the first size.

use asami_dataset::Models;
use asami_math::kalman::Gaussian;
use asami_math::polynomial::Polynomial;
use nalgebra::{SMatrix, SVector, Vector1, Vector3};

use super::curve::SizeCurve;
use super::field::Field;
use super::filter::{About, Forward};
use super::parameters::{Parameters, given_sensor};
use super::world::Problem;
use crate::learner::CannotLearn;
use crate::plane::Plane;

/// Sightings that the grid of poses is judged by.
const JUDGES: usize = 60;

/// Distances at which a starting `f` is looked up.
fn distances() -> impl Iterator<Item = f64> {
    (1..=400).map(|i| 0.05 * f64::from(i))
}

/// Least and greatest corner of the landmarks' rectangle.
fn rectangle(plane: &Plane) -> ([f64; 2], [f64; 2]) {
    let mut corners = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for place in plane.landmarks().values() {
        for ((low, high), x) in corners.0.iter_mut().zip(&mut corners.1).zip(place) {
            (*low, *high) = (low.min(*x), high.max(*x));
        }
    }
    corners
}

/// `f` in the plane: centred and scaled over the landmarks' rectangle, whatever the starting models say.
pub fn curve_in_plane(plane: &Plane, f: &Polynomial, coefficients: usize) -> SizeCurve {
    let (low, high) = rectangle(plane);
    let half = 0.5 * ((high[0] - low[0]) * (high[0] - low[0]) + (high[1] - low[1]) * (high[1] - low[1])).sqrt();
    let half = if half > 0.5 { half } else { 0.5 };
    SizeCurve::new(f, coefficients, half, half)
}

/// `f` along a line: centred and scaled over the distances at which the starting `f` gives the sizes observed.
pub fn curve_along_line(plane: &Plane, f: &Polynomial, coefficients: usize) -> SizeCurve {
    let sizes = plane.sightings.iter().map(|seen| seen.size);
    let (least, greatest) = sizes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), o| (a.min(o), b.max(o)));
    let fitting = distances().filter(|d| (least..=greatest).contains(&f.at(*d)));
    let (near, far) = fitting.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
    if far - near > 0.1 {
        SizeCurve::new(f, coefficients, 0.5 * (near + far), 0.5 * (far - near))
    } else {
        SizeCurve::new(f, coefficients, 2.0, 1.0)
    }
}

/// The prior along a line: where `f` gives the first size, give or take a metre.
pub fn prior_along_line(plane: &Plane, f: &SizeCurve) -> Gaussian<1> {
    let first = plane.sightings.first().map_or(0.0, |seen| seen.size);
    let off = |d: f64| (f.at(d).0 - first).abs();
    let nearest = distances().fold((f64::INFINITY, 2.0), |best, d| if off(d) < best.0 { (off(d), d) } else { best });
    Gaussian { mean: Vector1::new(-nearest.1), covariance: SMatrix::identity() }
}

/// The prior in the plane: the best pose of the grid, give or take a cell.
pub fn prior_in_plane(world: &Field, plane: &Plane, start: &Parameters<3>) -> Gaussian<3> {
    const CELLS: usize = 4;
    const HEADINGS: usize = 8;
    let (low, high) = rectangle(plane);
    // Landmarks in one place or a row: a square about them.
    let reach = 0.5 * (high[0] - low[0]).max(high[1] - low[1]).max(1.0);
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    let cell = 2.0 * reach / CELLS as f64;
    let turn = std::f64::consts::TAU / HEADINGS as f64;
    let variances = Vector3::new(cell * cell, cell * cell, turn * turn);
    let frames = frames_up_to(plane, JUDGES);
    let looks = (0..frames).map(|t| plane.seen(t).len()).sum();
    let (mut forward, mut weights) = (Forward::new(frames), vec![1.0; looks]);
    let mut best = (f64::NEG_INFINITY, Vector3::zeros());
    for i in 0..CELLS * CELLS * HEADINGS {
        let at = |cells: usize, middle: f64| middle - reach + cell * (cells as f64 + 0.5);
        let (x, y) = (at(i % CELLS, middle[0]), at(i / CELLS % CELLS, middle[1]));
        let mean = Vector3::new(x, y, turn * (i / (CELLS * CELLS)) as f64 - std::f64::consts::PI);
        let prior = Gaussian { mean, covariance: SMatrix::from_diagonal(&variances) };
        let lambda = Parameters { prior, ..start.clone() };
        let ran = forward.run(Problem { world, plane }, &lambda, About::Own, &mut weights, false);
        if ran.is_some() && forward.log_likelihood > best.0 {
            best = (forward.log_likelihood, mean);
        }
    }
    Gaussian { mean: best.1, covariance: SMatrix::from_diagonal(&variances) }
}

/// How many frames it takes to have so many sightings.
fn frames_up_to(plane: &Plane, sightings: usize) -> usize {
    let mut found = 0;
    for t in 0..plane.frames.len() {
        found += plane.seen(t).len();
        if found >= sightings {
            return t + 1;
        }
    }
    plane.frames.len()
}

/// Everything that learning in the plane starts from: the given models over the log's actions, `f` over the landmarks'
/// rectangle, and the best pose of the grid.
///
/// # Errors
/// What the log or the given models lack.
pub fn in_plane(plane: &Plane, given: &Models, coefficients: usize) -> Result<Parameters<3>, CannotLearn> {
    let f = curve_in_plane(plane, &given_sensor(plane, given)?, coefficients);
    let lambda = Parameters::given(plane, given, f, nowhere())?;
    plane.require(coefficients + 3)?;
    Ok(Parameters { prior: prior_in_plane(&Field::of(plane), plane, &lambda), ..lambda })
}

/// A vague state, for room.
pub fn nowhere<const N: usize>() -> Gaussian<N> {
    Gaussian { mean: SVector::zeros(), covariance: SMatrix::identity() }
}
