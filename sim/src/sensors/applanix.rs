//! A reference of the kind that the dissertation's car carried: an Applanix POS LV, inertial sensors aided by GPS.
//!
//! It is not truth, and not what a learner sees: a track measured well, against which published errors were taken
//! (Stronger 2008, section 5.4: "accuracies of under one meter and 0.02 degrees"). The true track stays as it is; who
//! scores as published measures it with this.

use asami_dataset::{Rng, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{exp, sin_cos};
use rand_distr::{Distribution, StandardNormal};

asami_dataset::parameters! {
    /// What a reference errs by. Errors are smooth: what differs from one pose to the next is speed that never was.
    pub struct Applanix {
        /// Standard deviation of the slow error of either coordinate, satellites' and air's: a metre is three of them.
        position_sd_m: f64 = 0.33, "m", 0.0..=10.0;
        /// Its correlation time.
        position_correlation_s: f64 = 100.0, "s", 1.0..=10000.0;
        /// Standard deviation of the error of either coordinate's velocity.
        velocity_sd_m_per_s: f64 = 0.015, "m/s", 0.0..=1.0;
        /// Its correlation time.
        velocity_correlation_s: f64 = 2.0, "s", 0.1..=100.0;
        /// Standard deviation of the heading: 0.02 degrees are two of them.
        heading_sd_rad: f64 = 0.000175, "rad", 0.0..=0.1;
        /// Its correlation time.
        heading_correlation_s: f64 = 10.0, "s", 0.1..=1000.0;
    }
}

impl Applanix {
    /// What it reports along a true track, pose by pose.
    #[must_use]
    pub fn measure(&self, track: &[TruePose], rng: &mut Rng) -> Vec<TruePose> {
        let slow = (self.position_sd_m, self.position_correlation_s);
        // Of twice integrated noise the velocity's standard deviation is the position's by the correlation time.
        let fast = (self.velocity_sd_m_per_s * self.velocity_correlation_s, self.velocity_correlation_s);
        let heading = (self.heading_sd_rad, self.heading_correlation_s);
        let mut errors =
            [slow, slow, fast, fast, heading].map(|(sd, correlation_s)| Error::new(sd, correlation_s, rng));
        let mut last_t_s = track.first().map_or(0.0, |pose| pose.t_s);
        let mut measured = Vec::with_capacity(track.len());
        for pose in track {
            for error in &mut errors {
                error.step(pose.t_s - last_t_s, rng);
            }
            last_t_s = pose.t_s;
            let [slow_x, slow_y, fast_x, fast_y, heading] = &errors;
            let (sin, cos) = sin_cos(pose.theta_rad);
            let forward = |x: f64, y: f64| y * cos - x * sin;
            let excess = forward(slow_x.rate() + fast_x.rate(), slow_y.rate() + fast_y.rate());
            measured.push(TruePose {
                t_s: pose.t_s,
                x_m: pose.x_m + slow_x.value() + fast_x.value(),
                y_m: pose.y_m + slow_y.value() + fast_y.value(),
                theta_rad: wrap_rad(pose.theta_rad + heading.value()),
                v_m_per_s: pose.v_m_per_s.map(|v| v + excess),
            });
        }
        measured
    }
}

/// Gauss-Markov noise of the second order, critically damped: noise through a lag, through the same lag again.
struct Error {
    correlation_s: f64,
    /// After the first lag, and after the second.
    lags: [f64; 2],
    first_sd: f64,
}

impl Error {
    /// In its stationary state.
    fn new(sd: f64, correlation_s: f64, rng: &mut Rng) -> Self {
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        // Of noise of variance 1 after the first lag the second leaves a half, as much as the covariance of both.
        let first_sd = sd * std::f64::consts::SQRT_2;
        let first = normal();
        let second = 0.5 * first + 0.5 * normal();
        Self { correlation_s, lags: [first_sd * first, first_sd * second], first_sd }
    }

    /// On by a time, exactly.
    fn step(&mut self, dt_s: f64, rng: &mut Rng) {
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let h = dt_s / self.correlation_s;
        let kept = exp(-h);
        let [first, second] = self.lags;
        // Means follow x' = -x, y' = x - y; what is added has the stationary covariance less what was kept of it.
        let means = [kept * first, kept * (second + h * first)];
        let square = kept * kept;
        let var_first = 1.0 - square;
        let covariance = 0.5 - square * (0.5 + h);
        let var_second = 0.5 - square * (0.5 + h + h * h);
        let sd_first = var_first.max(0.0).sqrt();
        let (a, b) = (normal(), normal());
        let share = if sd_first > 0.0 { covariance / sd_first } else { 0.0 };
        let rest = (var_second - share * share).max(0.0).sqrt();
        self.lags = [means[0] + self.first_sd * sd_first * a, means[1] + self.first_sd * (share * a + rest * b)];
    }

    fn value(&self) -> f64 {
        self.lags[1]
    }

    fn rate(&self) -> f64 {
        (self.lags[0] - self.lags[1]) / self.correlation_s
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;

    fn straight(count: usize, step_s: f64) -> Vec<TruePose> {
        let pose = |i: usize| {
            let t_s = i as f64 * step_s;
            TruePose { t_s, x_m: 0.0, y_m: 5.0 * t_s, theta_rad: 0.0, v_m_per_s: Some(5.0) }
        };
        (0..count).map(pose).collect()
    }

    fn sd(values: impl Iterator<Item = f64>) -> f64 {
        let values: Vec<f64> = values.collect();
        (values.iter().map(|it| it * it).sum::<f64>() / values.len() as f64).sqrt()
    }

    /// Over 4000 correlation times standard deviations come out within 5 %: theirs is about 1 / sqrt(4000).
    #[test]
    fn errors_have_the_sizes_that_they_are_given() {
        let config = Applanix::default();
        let truth = straight(400_000, 1.0);
        let measured = config.measure(&truth, &mut Seed(1000).stream("applanix"));
        let error = sd(truth.iter().zip(&measured).map(|(a, b)| a.x_m - b.x_m));
        assert!((error / config.position_sd_m - 1.0).abs() < 0.05, "{error}");
        let heading = sd(truth.iter().zip(&measured).map(|(a, b)| a.theta_rad - b.theta_rad));
        assert!((heading / config.heading_sd_rad - 1.0).abs() < 0.05, "{heading}");
        // The slow error moves too, by its standard deviation in its correlation time.
        let slow = config.position_sd_m / config.position_correlation_s;
        let wanted = (config.velocity_sd_m_per_s * config.velocity_sd_m_per_s + slow * slow).sqrt();
        let speed = sd(truth.iter().zip(&measured).map(|(a, b)| a.v_m_per_s.unwrap() - b.v_m_per_s.unwrap()));
        assert!((speed / wanted - 1.0).abs() < 0.05, "{speed} against {wanted}");
    }

    /// What chapter 5 takes as velocity, the difference of poses half a second apart, is off by less than 0.05 m/s, and
    /// positions stay within a metre or so.
    #[test]
    fn a_drive_is_measured_as_well_as_published() {
        for seed in 1000..1010 {
            let truth = straight(20_001, 0.01);
            let measured = Applanix::default().measure(&truth, &mut Seed(seed).stream("applanix"));
            for (a, b) in measured.iter().zip(&measured[50..]).step_by(50) {
                let v = (b.y_m - a.y_m) / 0.5;
                assert!((v - 5.0).abs() < 0.07, "{v}");
            }
            let velocity = sd(measured.iter().zip(&measured[50..]).map(|(a, b)| (b.y_m - a.y_m) / 0.5 - 5.0));
            assert!(velocity < 0.02, "{velocity}");
            assert!(measured.iter().zip(&truth).all(|(a, b)| (a.x_m - b.x_m).abs() < 1.4));
        }
    }

    /// The rate is the rate: differences of positions add up to it.
    #[test]
    fn speed_is_the_derivative_of_position() {
        let config = Applanix { position_sd_m: 0.0, velocity_correlation_s: 1.0, ..Applanix::default() };
        let truth = straight(2001, 0.001);
        let measured = config.measure(&truth, &mut Seed(1001).stream("applanix"));
        let mut way_m = 0.0;
        for pair in measured.windows(2) {
            way_m += 0.0005 * (pair[0].v_m_per_s.unwrap() + pair[1].v_m_per_s.unwrap());
        }
        let moved_m = measured[2000].y_m - measured[0].y_m;
        // The heading's own error turns the rate by less than a thousandth of it.
        assert!((way_m - moved_m).abs() < 1e-4, "{way_m} against {moved_m}");
    }
}
