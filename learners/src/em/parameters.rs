//! `lambda`: everything that EM re-estimates.

use asami_dataset::models::{Curve, Entry};
use asami_dataset::{ActionModel, Models, Noise, SensorModel};
use asami_math::elementary::{exp, ln, ln_1p};
use asami_math::kalman::Gaussian;
use asami_math::polynomial::Polynomial;
use nalgebra::SVector;

use super::curve::SizeCurve;
use crate::learner::CannotLearn;
use crate::line::Unit;
use crate::plane::Plane;

/// The models, and the prior of the first state.
#[derive(Clone, Debug)]
pub struct Parameters<const N: usize> {
    /// Velocity of each action of the log in the robot frame, m/s and rad/s.
    pub velocity: Vec<SVector<f64, N>>,
    /// Variances of the motion's noise along the robot's axes, of each action, over a step of median length; they
    /// grow with the length of the step.
    pub motion_var: Vec<SVector<f64, N>>,
    /// Size of a landmark by its distance.
    pub f: SizeCurve,
    /// `sigma_1^2`, of sizes.
    pub size_var: f64,
    /// `sigma_2^2`, of bearings, rad^2.
    pub bearing_var: f64,
    /// Share of `sigma_2^2` that the bearings of one frame have in common, where the method knows of such.
    pub common_share: f64,
    /// Share of sightings that are false, where the method knows of such.
    pub false_share: f64,
    /// Log-density of a false sighting.
    pub false_log_density: f64,
    /// `pi(w_0)`.
    pub prior: Gaussian<N>,
}

/// Which of a pose's three numbers (right, forward, turn) the `N` numbers of a state are.
pub const fn axes<const N: usize>() -> [usize; N] {
    let mut axes = [1; N];
    if N == 3 {
        axes[0] = 0;
        axes[2] = 2;
    }
    axes
}

/// The sensor model that a log of this kind must be given.
pub fn given_sensor(plane: &Plane, given: &Models) -> Result<Polynomial, CannotLearn> {
    let (wanted, curve) = match (plane.unit, &given.sensor) {
        (Unit::HeightPx, Some(SensorModel::HeightOfDistance(curve))) => ("", Some(curve)),
        (Unit::RangeM, Some(SensorModel::RangeOfDistance(curve))) => ("", Some(curve)),
        (Unit::HeightPx, _) => ("a sensor model: height of distance", None),
        (Unit::RangeM, _) => ("a sensor model: range of distance", None),
    };
    let finite =
        |p: &Polynomial| !p.coefficients.is_empty() && p.scale != 0.0 && p.coefficients.iter().all(|c| c.is_finite());
    let polynomial = curve.map(|curve| curve.polynomial.clone()).filter(finite);
    polynomial.ok_or(CannotLearn::NotGiven(if wanted.is_empty() { "a finite sensor model" } else { wanted }))
}

impl<const N: usize> Parameters<N> {
    /// The models given, over the actions of the log; an action without an entry has no effect.
    ///
    /// # Errors
    /// [`CannotLearn::NotGiven`].
    pub fn given(plane: &Plane, given: &Models, f: SizeCurve, prior: Gaussian<N>) -> Result<Self, CannotLearn> {
        let Some(ActionModel::Table(entries)) = &given.action else {
            return Err(CannotLearn::NotGiven("an action model: a table of velocities"));
        };
        let velocity = |id: Option<u16>| {
            let entry = entries.iter().find(|entry| Some(entry.action) == id);
            let three = entry.map_or([0.0; 3], |e| [e.vx_m_per_s, e.vy_m_per_s, e.vtheta_rad_per_s]);
            SVector::from(axes::<N>().map(|axis| three[axis]))
        };
        let positive = |sigma: Option<f64>, name| {
            sigma.filter(|sigma| *sigma > 0.0 && sigma.is_finite()).ok_or(CannotLearn::NotGiven(name))
        };
        let sigma1 = match plane.unit {
            Unit::HeightPx => positive(given.noise.sigma1_px, "the noise of heights")?,
            Unit::RangeM => positive(given.noise.sigma1_m, "the noise of ranges")?,
        };
        let sigma2 = if N == 3 { positive(given.noise.sigma2_rad, "the noise of bearings")? } else { 1.0 };
        let sd =
            given.noise.motion_sd.filter(|sd| axes::<N>().iter().all(|axis| sd[*axis] > 0.0 && sd[*axis].is_finite()));
        let sd = sd.ok_or(CannotLearn::NotGiven("the noise of the motion"))?;
        let q = SVector::from(axes::<N>().map(|axis| sd[axis] * sd[axis]));
        Ok(Self {
            velocity: plane.actions.iter().map(|action| velocity(action.id)).collect(),
            motion_var: vec![q; plane.actions.len()],
            f,
            size_var: sigma1 * sigma1,
            bearing_var: sigma2 * sigma2,
            common_share: 0.0,
            false_share: 0.0,
            false_log_density: 0.0,
            prior,
        })
    }

    /// As models of the log's actions, with `errors` where they are known.
    #[must_use]
    pub fn models(&self, plane: &Plane, errors: Option<&Errors<N>>) -> Models {
        let spread = |values: &SVector<f64, N>| {
            let mut three = [0.0; 3];
            for (axis, value) in axes::<N>().into_iter().zip(values.iter()) {
                three[axis] = *value;
            }
            three
        };
        let entry = |a: usize| {
            let [vx_m_per_s, vy_m_per_s, vtheta_rad_per_s] = spread(&self.velocity[a]);
            let se = errors.and_then(|errors| errors.velocity[a].as_ref()).map(spread);
            plane.actions[a].id.map(|action| Entry { action, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s, se })
        };
        let se = errors.map_or(Vec::new(), |errors| errors.f.clone());
        let curve = Curve { polynomial: self.f.polynomial(), se };
        // Rooted mean over the time that each action was executed.
        let held_s: f64 = plane.actions.iter().map(|action| action.held_s).sum();
        let mut motion_var = SVector::<f64, N>::zeros();
        for (q, action) in self.motion_var.iter().zip(&plane.actions) {
            motion_var += q * if held_s > 0.0 { action.held_s / held_s } else { 1.0 / plane.actions.len() as f64 };
        }
        let sigma1 = Some(self.size_var.sqrt());
        let mut noise = Noise {
            sigma2_rad: (N == 3).then(|| self.bearing_var.sqrt()),
            motion_sd: Some(spread(&motion_var.map(f64::sqrt))),
            ..Noise::default()
        };
        let sensor = match plane.unit {
            Unit::HeightPx => {
                noise.sigma1_px = sigma1;
                SensorModel::HeightOfDistance(curve)
            }
            Unit::RangeM => {
                noise.sigma1_m = sigma1;
                SensorModel::RangeOfDistance(curve)
            }
        };
        let entries = (0..plane.actions.len()).filter_map(entry).collect();
        Models { action: Some(ActionModel::Table(entries)), sensor: Some(sensor), noise }
    }

    /// Velocities and then coefficients of `f`: what standard errors are given of.
    #[must_use]
    pub fn means(&self) -> Vec<f64> {
        let velocities = self.velocity.iter().flat_map(|v| v.iter().copied());
        velocities.chain(self.f.c[..self.f.n].iter().copied()).collect()
    }

    /// Sets what [`means`](Self::means) gives.
    pub fn set_means(&mut self, means: &[f64]) {
        let n = self.f.n;
        let places = self.velocity.iter_mut().flat_map(|v| v.iter_mut()).chain(self.f.c[..n].iter_mut());
        for (place, mean) in places.zip(means) {
            *place = *mean;
        }
    }

    /// Sets the noise to that of `before`, times the exponentials of `steps`: of the motion, along each axis, then
    /// of size and bearing.
    pub fn set_noise(&mut self, before: &Self, steps: &[f64]) {
        for (q, before) in self.motion_var.iter_mut().zip(&before.motion_var) {
            *q = SVector::from_fn(|axis, _| before[axis] * exp(steps[axis]));
        }
        self.size_var = before.size_var * exp(steps[N]);
        self.bearing_var = before.bearing_var * steps.get(N + 1).map_or(1.0, |step| exp(*step));
    }

    /// Directions in [`means`](Self::means) along which nothing that is observed changes. Along a line these are the
    /// unit of length, `v` to `k v` and `f(d)` to `f(d / k)`, and the landmark's place, `f(d)` to `f(d + a)`.
    #[must_use]
    pub fn free_units(&self) -> Vec<Vec<f64>> {
        if N > 1 {
            return Vec::new();
        }
        let (c, n) = (&self.f.c, self.f.n);
        // Coefficients of the derivative by u.
        let slope = |i: usize| if i + 1 < n { (i + 1) as f64 * c[i + 1] } else { 0.0 };
        let velocities = self.velocity.iter().flat_map(|v| v.iter().copied());
        let stretched = (0..n).map(|i| -(i as f64 * c[i] + self.f.centre_m / self.f.scale_m * slope(i)));
        let moved = (0..n).map(|i| slope(i) / self.f.scale_m);
        let still = std::iter::repeat_n(0.0, self.velocity.len());
        vec![velocities.chain(stretched).collect(), still.chain(moved).collect()]
    }

    /// Log-density of a sighting that is true with some log-density, and false with the rest of the probability.
    #[must_use]
    pub fn mixed(&self, log_density: f64) -> f64 {
        if self.false_share <= 0.0 {
            return log_density;
        }
        let (a, b) = (ln_1p(-self.false_share) + log_density, ln(self.false_share) + self.false_log_density);
        let (greater, less) = if a > b { (a, b) } else { (b, a) };
        greater + ln_1p(exp(less - greater))
    }

    /// Whether every number is one.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let vectors = self.velocity.iter().chain(&self.motion_var).all(|v| v.iter().all(|x| x.is_finite()));
        let scalars = [self.size_var, self.bearing_var, self.common_share, self.false_share];
        vectors
            && scalars.iter().chain(&self.f.c).all(|x| x.is_finite())
            && self.prior.mean.iter().all(|x| x.is_finite())
    }
}

/// Standard errors of what was learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors<const N: usize> {
    /// Of each action's velocity; `None` where the log says nothing about it.
    pub velocity: Vec<Option<SVector<f64, N>>>,
    /// Of the coefficients of `f`; empty where the log leaves them open.
    pub f: Vec<f64>,
}
