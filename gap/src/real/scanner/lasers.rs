//! What each laser is off by, learned from block to block.

use asami_math::elementary::ln;
use nalgebra::{DMatrix, DVector};

use super::seen::{Block, Mean, SHAPE_M, Seen, What, height_m, powers, road_shape};

/// Where one laser's row in the scanner's table is to be corrected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Laser {
    /// It points higher than the table says by this.
    pub vertical_rad: f64,
    /// Standard error of that.
    pub vertical_se_rad: f64,
    /// It measures this much too much.
    pub range_m: f64,
    /// Standard error of that.
    pub range_se_m: f64,
    /// It stands to the left of where it looks, off the axis.
    pub left_m: f64,
    /// It stands higher than the middle of all.
    pub up_m: f64,
}

/// As far as a hypothesis lets lasers be off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Off {
    /// Variance of what single vertical angles are.
    pub vertical_rad2: f64,
    /// Variance of what single ranges are.
    pub range_m2: f64,
    /// Even lasers stand to the left by this, odd ones to the right.
    pub aside_m: f64,
    /// The upper half of the lasers stands higher than the lower one by this.
    pub apart_m: f64,
    /// Ranges that run straight, and in a bow, over the lasers, from the middle to the outermost.
    pub range_curve_m: [f64; 2],
    /// Logarithms of louder chance: of the road, walls, sides.
    pub louder: [f64; 3],
}

/// What a mean said under a hypothesis, after those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Said {
    /// Off its prediction, and off the road's shape.
    pub plain_m: f64,
    /// Off its prediction, whitened.
    pub white: f64,
    /// Logarithm of the scale.
    pub ln_scale: f64,
}

impl Said {
    /// `log p(mean | those before)`.
    #[must_use]
    pub fn log_likelihood(&self) -> f64 {
        0.5 - 0.5 * self.white * self.white - self.expected()
    }

    /// What is expected of minus it.
    #[must_use]
    pub fn expected(&self) -> f64 {
        0.5 + 0.5 * ln(std::f64::consts::TAU) + self.ln_scale
    }
}

/// A filter for what lasers are off by: first the vertical angles, then the ranges.
pub struct Lasers<'a> {
    seen: &'a Seen,
    off: Off,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl<'a> Lasers<'a> {
    /// Nothing known but the hypothesis.
    #[must_use]
    pub fn new(seen: &'a Seen, off: Off) -> Self {
        let n = seen.elevation.len();
        let prior = |i: usize| if i < n { off.vertical_rad2 } else { off.range_m2 };
        let mean = DVector::from_fn(2 * n, |i, _| if i < n { 0.0 } else { off.curve_m(i - n, n) });
        Self { seen, off, mean, covariance: DMatrix::from_diagonal(&DVector::from_fn(2 * n, |i, _| prior(i))) }
    }

    /// Learns from a block, and says how likely its means were before, one after another. `None` if numbers fail.
    pub fn take(&mut self, block: &Block) -> Option<Vec<Said>> {
        let n = block.means.len();
        let lasers = self.seen.elevation.len();
        let mut h = DMatrix::zeros(n, 2 * lasers);
        for (i, mean) in block.means.iter().enumerate() {
            self.sees(mean, |k, coefficient| h[(i, k)] = coefficient);
        }
        let fixed = DVector::from_fn(n, |i, _| self.off.places_m(&block.means[i], lasers));
        let off = DVector::from_fn(n, |i, _| block.means[i].value_m) - &h * &self.mean - fixed;
        let seen = &h * &self.covariance;
        let mut s = &seen * h.transpose();
        for (i, mean) in block.means.iter().enumerate() {
            s[(i, i)] += mean.variance_m2 * asami_math::elementary::exp(2.0 * self.off.louder[mean.what.kind()]);
        }
        let road = |i: usize, k: usize| {
            let Mean { what, flat_m, .. } = block.means[i];
            if what.kind() == 0 { SHAPE_M[k] * powers(flat_m)[k] } else { 0.0 }
        };
        let shape = DMatrix::from_fn(n, SHAPE_M.len(), road);
        s += &shape * shape.transpose();
        let cholesky = s.cholesky()?;
        let l = cholesky.l();
        let white = l.solve_lower_triangular(&off)?;
        let on_road = |i: usize| (block.means[i].what.kind() == 0).then_some((block.means[i].flat_m, off[i]));
        let road_m = road_shape((0..n).filter_map(on_road));
        let plain = |i: usize| on_road(i).map_or(off[i], |(flat_m, off_m)| off_m - height_m(road_m, flat_m));
        let gain = cholesky.solve(&seen).transpose();
        self.mean += &gain * &off;
        self.covariance -= &gain * &seen;
        let said = |i: usize| Said { plain_m: plain(i), white: white[i], ln_scale: ln(l[(i, i)]) };
        Some((0..n).map(said).collect())
    }

    /// Calls `with` for each number of the state that a mean hangs on.
    fn sees(&self, mean: &Mean, mut with: impl FnMut(usize, f64)) {
        let lasers = self.seen.elevation.len();
        match mean.what {
            // What points higher than it is taken to puts the road lower; what ranges too far, too low as well.
            What::Road(laser) => {
                with(laser, -mean.flat_m);
                with(lasers + laser, self.seen.elevation[laser].0);
            }
            What::Wall(pair) => {
                with(lasers + pair, self.seen.elevation[pair].1);
                with(lasers + pair + 1, -self.seen.elevation[pair + 1].1);
            }
            What::Side(_) => {}
        }
    }

    /// The lasers as they are known by now.
    #[must_use]
    pub fn known(&self) -> Vec<Laser> {
        let n = self.seen.elevation.len();
        let laser = |i: usize| Laser {
            vertical_rad: self.mean[i],
            vertical_se_rad: self.covariance[(i, i)].max(0.0).sqrt(),
            range_m: self.mean[n + i],
            range_se_m: self.covariance[(n + i, n + i)].max(0.0).sqrt(),
            left_m: self.off.left_m(i),
            up_m: self.off.up_m(i, n),
        };
        (0..n).map(laser).collect()
    }
}

impl Off {
    fn left_m(&self, laser: usize) -> f64 {
        if laser.is_multiple_of(2) { self.aside_m } else { -self.aside_m }
    }

    fn up_m(&self, laser: usize, lasers: usize) -> f64 {
        if laser < lasers / 2 { -0.5 * self.apart_m } else { 0.5 * self.apart_m }
    }

    fn curve_m(&self, laser: usize, lasers: usize) -> f64 {
        let u = 2.0 * laser as f64 / (lasers.max(2) - 1) as f64 - 1.0;
        self.range_curve_m[0] * u + self.range_curve_m[1] * u * u
    }

    /// What a mean is moved by because of where lasers stand.
    fn places_m(&self, mean: &Mean, lasers: usize) -> f64 {
        match mean.what {
            What::Road(laser) => -self.up_m(laser, lasers),
            What::Wall(_) => 0.0,
            What::Side(pair) => self.left_m(pair) - self.left_m(pair + 1),
        }
    }
}
