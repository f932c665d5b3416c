//! Iterative closest points in the plane (Algorithm 2), to points or to lines.

use std::cell::OnceCell;

use asami_math::neighbours::Neighbours;
use asami_math::rigid::{Rigid, rotate};
use nalgebra::{Matrix3, Vector3};

/// What is made small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distance {
    /// From point to point, all alike, as published.
    Points,
    /// From point to the line through the target's points around the nearest (Chen and Medioni 1991), with weights of Cauchy:
    /// a residual of `scale_m` counts half.
    Lines {
        /// Residual that counts half.
        scale_m: f64,
    },
}

/// How two clouds are matched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matching {
    /// What is made small.
    pub distance: Distance,
    /// Points farther from their nearest than this do not count.
    pub gate_m: f64,
    /// The gate shrinks to so many root-mean-square distances, but not below half a metre; infinite: it does not.
    pub shrink: f64,
    /// Stops when the points would move by less than this (turns count at 10 m).
    pub tolerance_m: f64,
    /// Stops after so many passes.
    pub max_passes: u32,
    /// At first every so-manieth point is matched, until they would move by less than twenty tolerances; only then all. 1: all at once.
    pub coarse: usize,
}

impl Matching {
    /// Algorithm 2: point to point, with a fixed gate of 7 m.
    #[must_use]
    pub fn published() -> Self {
        Self {
            distance: Distance::Points,
            gate_m: 7.0,
            shrink: f64::INFINITY,
            tolerance_m: 1e-4,
            max_passes: 100,
            coarse: 1,
        }
    }

    /// Point to line, the gate shrinking from 7 m to three root-mean-square distances.
    #[must_use]
    pub fn lines(scale_m: f64) -> Self {
        Self {
            distance: Distance::Lines { scale_m },
            shrink: 3.0,
            tolerance_m: 5e-4,
            max_passes: 60,
            coarse: 8,
            ..Self::published()
        }
    }
}

/// A cloud that others are matched to.
#[derive(Clone, Debug)]
pub struct Target {
    grid: Neighbours,
    /// Of the line at each point, in the grid's order; none where the points around it are no line. Empty for point to point.
    /// Found when they are asked for.
    normals: Vec<OnceCell<Option<[f64; 2]>>>,
}

/// Coarse matching ends when the points would move by less than so many tolerances, or where fewer than so many count.
const COARSE: f64 = 20.0;
const FEW: usize = 100;

/// Side of the cells, and radius within which a line is laid through the points.
const CELL_M: f64 = 0.5;

/// Points of a row of cells that a line is laid through; of more, evenly so many.
const MOST: usize = 12;

impl Target {
    /// Prepares a cloud for matching.
    #[must_use]
    pub fn new(points: &[[f64; 2]], matching: &Matching) -> Self {
        // Where the gate shrinks few queries look far.
        let shrinks = matching.shrink.is_finite();
        let grid = if shrinks { Neighbours::near(points, CELL_M) } else { Neighbours::new(points, CELL_M) };
        let normals = match matching.distance {
            Distance::Points => Vec::new(),
            Distance::Lines { .. } => vec![OnceCell::new(); grid.points().len()],
        };
        Self { grid, normals }
    }

    fn normal(&self, place: usize) -> Option<[f64; 2]> {
        let found = || self.grid.points().get(place).and_then(|point| normal(&self.grid, *point));
        *self.normals.get(place)?.get_or_init(found)
    }

    /// How many points it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.grid.points().len()
    }

    /// Whether it has none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.grid.points().is_empty()
    }
}

/// Across the line through the points around `point`, if they are one: their scatter across is less than a fifth of that along.
fn normal(grid: &Neighbours, point: [f64; 2]) -> Option<[f64; 2]> {
    let (mut n, mut sums) = (0.0, [0.0; 5]);
    grid.around(point, CELL_M, MOST, |p| {
        let (dx, dy) = (p[0] - point[0], p[1] - point[1]);
        if dx * dx + dy * dy <= CELL_M * CELL_M {
            n += 1.0;
            for (sum, term) in sums.iter_mut().zip([dx, dy, dx * dx, dx * dy, dy * dy]) {
                *sum += term;
            }
        }
    });
    if n < 4.0 {
        return None;
    }
    let [x, y, xx, xy, yy] = sums.map(|sum| sum / n);
    let (xx, xy, yy) = (xx - x * x, xy - x * y, yy - y * y);
    let (middle, half) = ((xx + yy) / 2.0, (((xx - yy) / 2.0) * ((xx - yy) / 2.0) + xy * xy).sqrt());
    if middle - half > 0.2 * (middle + half) {
        return None;
    }
    // Eigenvector of the greater eigenvalue, turned a quarter.
    let along = if xx > yy { [half + (xx - yy) / 2.0, xy] } else { [xy, half + (yy - xx) / 2.0] };
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    (length > 0.0).then(|| [-along[1] / length, along[0] / length])
}

/// How a cloud was matched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Takes the cloud's points to the target's.
    pub motion: Rigid,
    /// Points that counted in the last pass.
    pub counted: usize,
    /// Their root-mean-square residual.
    pub rms_m: f64,
    /// Inverse of the normal matrix of the last pass (turn, x, y), for residuals of variance 1.
    pub cofactors: [[f64; 3]; 3],
    /// Passes taken.
    pub passes: u32,
}

/// The motion that takes `source` onto `target`, from `start`; `None` where too few points lie within the gate.
#[must_use]
pub fn align(source: &[[f64; 2]], target: &Target, start: Rigid, matching: &Matching) -> Option<Match> {
    let mut motion = start.or_none();
    let mut gate_m = matching.gate_m;
    let mut hints: Vec<Option<usize>> = vec![None; source.len()];
    let mut passes = 0;
    let mut stride = matching.coarse.max(1);
    loop {
        passes += 1;
        let sums = gather(source, target, &motion, gate_m, matching.distance, &mut hints, stride);
        if sums.counted < 10 {
            if stride == 1 {
                return None;
            }
            stride = 1;
            continue;
        }
        let cholesky = sums.normal.cholesky()?;
        let update = cholesky.solve(&sums.right);
        // T is linearised about its last value (section 5.2): only the turn is not linear.
        motion = Rigid { turn_rad: motion.turn_rad + update[0], x: motion.x + update[1], y: motion.y + update[2] };
        let moved_m = (update[1] * update[1] + update[2] * update[2]).sqrt() + 10.0 * update[0].abs();
        if !moved_m.is_finite() {
            return None;
        }
        if stride > 1
            && (moved_m < COARSE * matching.tolerance_m || sums.counted < FEW || passes >= matching.max_passes / 2)
        {
            stride = 1;
            continue;
        }
        if moved_m < matching.tolerance_m || passes >= matching.max_passes {
            let inverse = cholesky.inverse();
            let cofactors = [0, 1, 2].map(|i| [0, 1, 2].map(|j| inverse[(i, j)]));
            let rms_m = (sums.residual_ss / sums.weight).sqrt();
            return Some(Match { motion, counted: sums.counted, rms_m, cofactors, passes });
        }
        if matching.shrink.is_finite() {
            gate_m = gate_m.min((matching.shrink * (sums.distance_ss / sums.counted as f64).sqrt()).max(CELL_M));
        }
    }
}

/// Normal equations of one pass.
struct Sums {
    normal: Matrix3<f64>,
    right: Vector3<f64>,
    counted: usize,
    weight: f64,
    residual_ss: f64,
    distance_ss: f64,
}

fn gather(
    source: &[[f64; 2]],
    target: &Target,
    motion: &Rigid,
    gate_m: f64,
    distance: Distance,
    hints: &mut [Option<usize>],
    stride: usize,
) -> Sums {
    let [cos, sin] = rotate(motion.turn_rad, [1.0, 0.0]);
    let (mut counted, mut weight_sum, mut residual_ss, mut distance_ss) = (0usize, 0.0, 0.0, 0.0);
    // Upper triangle, and the right-hand side.
    let (mut h, mut g) = ([0.0; 6], [0.0; 3]);
    for (point, hint) in source.iter().zip(hints).step_by(stride) {
        let turned = [cos * point[0] - sin * point[1], sin * point[0] + cos * point[1]];
        let at = [turned[0] + motion.x, turned[1] + motion.y];
        let found = target.grid.nearest(at, gate_m, *hint);
        *hint = found.map(|found| found.0).or(*hint);
        let Some((place, distance_sq)) = found else { continue };
        let nearest = target.grid.points()[place];
        let error = [nearest[0] - at[0], nearest[1] - at[1]];
        match distance {
            Distance::Points => {
                let (x, y) = (turned[0], turned[1]);
                for (sum, term) in h.iter_mut().zip([x * x + y * y, -y, x, 1.0, 0.0, 1.0]) {
                    *sum += term;
                }
                for (sum, term) in g.iter_mut().zip([x * error[1] - y * error[0], error[0], error[1]]) {
                    *sum += term;
                }
                residual_ss += distance_sq;
                weight_sum += 1.0;
            }
            Distance::Lines { scale_m } => {
                let Some([nx, ny]) = target.normal(place) else { continue };
                let residual = error[0] * nx + error[1] * ny;
                let weight = 1.0 / (1.0 + (residual / scale_m) * (residual / scale_m));
                let j = [ny * turned[0] - nx * turned[1], nx, ny];
                for (sum, term) in
                    h.iter_mut().zip([j[0] * j[0], j[0] * j[1], j[0] * j[2], j[1] * j[1], j[1] * j[2], j[2] * j[2]])
                {
                    *sum += weight * term;
                }
                for (sum, term) in g.iter_mut().zip(j) {
                    *sum += weight * term * residual;
                }
                residual_ss += weight * residual * residual;
                weight_sum += weight;
            }
        }
        counted += 1;
        distance_ss += distance_sq;
    }
    let normal = Matrix3::new(h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5]);
    Sums { normal, right: Vector3::from(g), counted, weight: weight_sum, residual_ss, distance_ss }
}
