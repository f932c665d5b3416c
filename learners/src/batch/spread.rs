//! What is still unknown of poses, as points around them.

use asami_math::bordered::{Link, STATE};

/// What is unknown of a pose and of the displacement after it, as offsets of points around their means.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    /// Standard deviation of the heading.
    pub(super) heading: f64,
    /// How displacement goes with heading: m of x and y for each standard deviation of it.
    pub(super) displacement: [f64; 2],
    /// Two columns of a root of the covariance: x, y and heading along each.
    pub(super) pose: [[f64; STATE]; 2],
}

/// Spreads beyond this many m and rad would leave the region where two points tell anything.
const GREATEST_SPREAD: [f64; 2] = [0.3, 0.5];

impl Spread {
    /// From the covariance of a link's two poses, the parameters known: it is these that the likelihood is of.
    pub(super) fn of(link: &Link) -> Self {
        let c = |i: usize, j: usize| link.at(i, j);
        let root = |x: f64| x.max(1e-18).sqrt();
        let heading = root(c(2, 2));
        let displacement = [0, 1].map(|i| (c(STATE + i, 2) - c(i, 2)) / heading);
        let x = root(c(0, 0));
        let first = [x, c(0, 1) / x, c(0, 2) / x];
        let y = root(c(1, 1) - first[1] * first[1]);
        let second = [0.0, y, (c(1, 2) - first[1] * first[2]) / y];
        let greatest = root(c(0, 0) + c(1, 1));
        let shrink = (GREATEST_SPREAD[0] / greatest).min(GREATEST_SPREAD[1] / heading).min(1.0);
        Self {
            heading: shrink * heading,
            displacement: displacement.map(|x| shrink * x),
            pose: [first, second].map(|column| column.map(|x| shrink * x)),
        }
    }
}

/// The covariance of a link's two poses if its parameters were known; `left` is room for what is left of it.
pub(super) fn given_parameters(covariance: &Link, left: &mut Vec<f64>, own: &mut Link) {
    let (poses, rows) = (2 * STATE, covariance.rows);
    left.clear();
    left.extend_from_slice(&covariance.entries);
    for p in (poses..rows).rev() {
        let (before, row) = left.split_at_mut(p * rows);
        let row = &row[..p + 1];
        if row[p] <= 0.0 {
            continue;
        }
        for (i, other) in before.chunks_exact_mut(rows).enumerate() {
            let factor = row[i] / row[p];
            for (x, y) in other.iter_mut().zip(&row[..p]) {
                *x -= factor * y;
            }
        }
    }
    for i in 0..poses {
        own.entries[i * poses..(i + 1) * poses].copy_from_slice(&left[i * rows..i * rows + poses]);
    }
}

/// Half-way between two spreads.
pub(super) fn between(a: &Spread, b: &Spread) -> Spread {
    let mean = |a: f64, b: f64| 0.5 * (a + b);
    Spread {
        heading: mean(a.heading, b.heading),
        displacement: std::array::from_fn(|i| mean(a.displacement[i], b.displacement[i])),
        pose: std::array::from_fn(|i| std::array::from_fn(|k| mean(a.pose[i][k], b.pose[i][k]))),
    }
}
