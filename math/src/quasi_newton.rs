//! Minimisation of smooth functions of many variables by their slopes.

use std::collections::VecDeque;

use crate::decomposition::dot;

/// Pairs of steps and changes of slope that are remembered.
const MEMORY: usize = 10;
/// Share of what the slope promises that a step must keep.
const SUFFICIENT: f64 = 1e-4;
/// Share of the slope along the step that may be left.
const CURVATURE: f64 = 0.9;
/// Trials of a line search.
const TRIALS: usize = 40;

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Where.
    pub at: Vec<f64>,
    /// The value there.
    pub value: f64,
    /// Its slope there.
    pub slope: Vec<f64>,
}

/// L-BFGS (Liu and Nocedal, Mathematical Programming 45, 1989, 503-528), with line searches by bisection to the weak Wolfe
/// conditions (Lewis and Overton, Mathematical Programming 141, 2013, algorithm 2.6). `f` gives the value and the slope. It
/// ends after so many steps, where the slope is no longer than `tolerance`, or where no step goes down.
pub fn lbfgs(mut f: impl FnMut(&[f64]) -> (f64, Vec<f64>), start: &[f64], steps: usize, tolerance: f64) -> Found {
    let (value, slope) = f(start);
    let mut here = Found { at: start.to_vec(), value, slope };
    let mut known: VecDeque<(Vec<f64>, Vec<f64>)> = VecDeque::with_capacity(MEMORY);
    for _ in 0..steps {
        let length = dot(&here.slope, &here.slope).sqrt();
        if length <= tolerance {
            break;
        }
        let way = down(&here.slope, &known);
        // The first step has no curvature to go by.
        let first = if known.is_empty() { (1.0 / length).min(1.0) } else { 1.0 };
        let Some(next) = searched(&mut f, &here, &way, first) else { break };
        let step = minus(&next.at, &here.at);
        let bent = minus(&next.slope, &here.slope);
        if dot(&step, &bent) > 0.0 {
            if known.len() == MEMORY {
                known.pop_front();
            }
            known.push_back((step, bent));
        }
        here = next;
    }
    here
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn add(to: &mut [f64], share: f64, what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += share * what);
}

/// Minus the slope, times the inverse curvature that the last steps tell of: the two loops.
fn down(slope: &[f64], known: &VecDeque<(Vec<f64>, Vec<f64>)>) -> Vec<f64> {
    let mut way: Vec<f64> = slope.iter().map(|slope| -slope).collect();
    let mut shares = Vec::with_capacity(known.len());
    for (step, bent) in known.iter().rev() {
        let share = dot(step, &way) / dot(step, bent);
        add(&mut way, -share, bent);
        shares.push(share);
    }
    if let Some((step, bent)) = known.back() {
        let scale = dot(step, bent) / dot(bent, bent);
        way.iter_mut().for_each(|it| *it *= scale);
    }
    for ((step, bent), share) in known.iter().zip(shares.into_iter().rev()) {
        let back = dot(bent, &way) / dot(step, bent);
        add(&mut way, share - back, step);
    }
    way
}

/// A point along the way that is lower, and where the slope is flatter; `None` where there is none.
fn searched(f: &mut impl FnMut(&[f64]) -> (f64, Vec<f64>), here: &Found, way: &[f64], first: f64) -> Option<Found> {
    let steep = dot(&here.slope, way);
    let (mut low, mut high, mut t) = (0.0, f64::INFINITY, first);
    let mut lower = None;
    for _ in 0..TRIALS {
        let mut at = here.at.clone();
        add(&mut at, t, way);
        let (value, slope) = f(&at);
        let falls = value <= here.value + SUFFICIENT * t * steep;
        if !falls {
            high = t;
        } else {
            let is_flat = dot(&slope, way) >= CURVATURE * steep;
            lower = Some(Found { at, value, slope });
            if is_flat {
                break;
            }
            low = t;
        }
        t = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * t };
    }
    lower
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley in so many pairs of variables (1960): least, and nought, where all are 1.
    fn valley(at: &[f64]) -> (f64, Vec<f64>) {
        let mut value = 0.0;
        let mut slope = Vec::with_capacity(at.len());
        for pair in at.chunks(2) {
            let (x, y) = (pair[0], pair[1]);
            let off = y - x * x;
            value += 100.0 * off * off + (1.0 - x) * (1.0 - x);
            slope.extend([-400.0 * x * off - 2.0 * (1.0 - x), 200.0 * off]);
        }
        (value, slope)
    }

    #[test]
    fn the_floor_of_a_bent_valley_is_found() {
        let found = lbfgs(valley, &[-1.2, 1.0, 0.3, -2.0, 4.0, 4.0], 300, 1e-9);
        assert!(found.at.iter().all(|it| (it - 1.0).abs() < 1e-8), "{found:?}");
        assert!(dot(&found.slope, &found.slope).sqrt() <= 1e-9);
    }

    #[test]
    fn it_never_goes_up_and_ends_on_a_kink_and_where_there_are_no_numbers() {
        let mut last = f64::INFINITY;
        for steps in 0..40 {
            let value = lbfgs(valley, &[-1.2, 1.0], steps, 0.0).value;
            assert!(value <= last, "{steps}: {value} after {last}");
            last = value;
        }
        let kink = lbfgs(|at| (at[0].abs(), vec![at[0].signum()]), &[3.0], 100, 1e-12);
        assert!(kink.value < 1e-6, "{kink:?}");
        let wall = |at: &[f64]| if at[0] < 1.0 { (f64::NAN, vec![f64::NAN]) } else { (at[0], vec![1.0]) };
        assert!((lbfgs(wall, &[3.0], 100, 1e-12).at[0] - 1.0).abs() < 1e-6);
        let still = lbfgs(|_| (1.0, vec![0.0]), &[3.0], 100, 1e-12);
        assert_eq!((still.at, still.value), (vec![3.0], 1.0));
    }
}
