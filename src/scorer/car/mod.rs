//! How far a car's models are from the truth, as Stronger (2008), section 5.4, measures it.

use asami_dataset::truth::pose_at;
use asami_dataset::{ActionModel, Channel, Command, Models, SensorModel, TruePose};
use asami_learners::learner::Trace;
use asami_learners::lidar::{Coefficients, Stretch, free_run, pedals, regress, roll_out};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, sin_cos};
use asami_math::statistics::median;
use serde::{Deserialize, Serialize};

use super::{mean, range, rmse_and_r2, square};

/// Step of the published errors.
pub const STEP_S: f64 = 0.5;

/// Errors of learned models. What does not exist is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Of the lasers' angles.
    pub angles: Option<AngleScores>,
    /// Root mean squares of the motions that the learner saw from scan to scan less the exact ones: forward m/s, turning
    /// rad/s.
    pub odometry_rmse: Option<[f64; 2]>,
    /// Root mean squares over the whole drive of the action model, rolled out open-loop from the first speed, less the
    /// reference: acceleration m/s^2, speed m/s, turning rate rad/s.
    pub rolled_rmse: Option<[f64; 3]>,
    /// Share of the reference's variance that the roll-out explains.
    pub rolled_r2: Option<[f64; 3]>,
    /// Root mean square of the acceleration that the action model gives at the reference's speed, one step ahead.
    pub one_step_rmse: Option<f64>,
}

/// Errors of learned angles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AngleScores {
    /// Root mean square as they are.
    pub rms_rad: f64,
    /// The same, less what all have in common.
    pub rms_common_removed_rad: f64,
    /// Greatest error of the angle between two adjacent lasers.
    pub worst_pair_rad: f64,
    /// Share of the true angles' variance that the learned ones explain as they are.
    pub r2: Option<f64>,
    /// Angles with a standard error that lie within 1.96 of them of the truth, and angles with one.
    pub covered: [u32; 2],
}

/// Truth to score against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Yardstick {
    /// True angles of the lasers; empty if unknown.
    pub angles_rad: Vec<f64>,
    /// Where the car was.
    pub track: Channel<TruePose>,
    /// What was commanded.
    pub commands: Channel<Command>,
    /// What the reference says of each step of the drive, as far as pedals are known.
    pub steps: Vec<Stretch>,
}

impl Yardstick {
    /// Of the true angles and track, and of what a reference measured along that track.
    #[must_use]
    pub fn of(
        angles_rad: Vec<f64>,
        track: &Channel<TruePose>,
        reference: &[TruePose],
        commands: &Channel<Command>,
    ) -> Self {
        let steps = steps(reference, commands);
        Self { angles_rad, track: track.clone(), commands: commands.clone(), steps }
    }

    /// Greatest less least angle: what an error is a percentage of.
    #[must_use]
    pub fn angle_range_rad(&self) -> Option<f64> {
        let first = *self.angles_rad.first()?;
        range(self.angles_rad.iter().map(|angle| wrap_rad(angle - first)))
    }

    /// Greatest less least acceleration, speed and turning rate of the reference.
    #[must_use]
    pub fn ranges(&self) -> Option<[f64; 3]> {
        let rows = self.rows();
        let of = |i: usize| range(rows.iter().map(|row| row[i]).filter(|x| x.is_finite()));
        Some([of(0)?, of(1)?, of(2)?])
    }

    /// Acceleration to the next step (none after the last), speed and turning rate of each.
    #[must_use]
    pub fn rows(&self) -> Vec<[f64; 3]> {
        let row = |(i, now): (usize, &Stretch)| {
            let next = self.steps.get(i + 1);
            let faster = next.map_or(f64::NAN, |next| (next.v_m_per_s - now.v_m_per_s) / (next.t_s - now.t_s));
            [faster, now.v_m_per_s, now.omega_rad_per_s]
        };
        self.steps.iter().enumerate().map(row).collect()
    }

    /// Scores models.
    #[must_use]
    pub fn score(&self, models: &Models) -> Scores {
        let angles = models.sensor.as_ref().and_then(|sensor| self.angles(sensor));
        let mut scores = Scores { angles, ..Scores::default() };
        let Some(action) = &models.action else { return scores };
        let (rolled, truth) = (self.rolled(action), self.rows());
        let of = |i: usize| {
            let pairs = rolled.iter().zip(&truth).map(|(model, truth)| [model[i], truth[i]]);
            rmse_and_r2(&pairs.filter(|[_, truth]| truth.is_finite()).collect::<Vec<_>>())
        };
        if let [Some(a), Some(v), Some(omega)] = [of(0), of(1), of(2)] {
            scores.rolled_rmse = Some([a.0, v.0, omega.0]);
            scores.rolled_r2 = a.1.zip(v.1).zip(omega.1).map(|((a, v), omega)| [a, v, omega]);
        }
        if let Some((coefficients, delay_s)) = coefficients(action) {
            let row = |(now, truth): (&Stretch, &[f64; 3])| {
                let model = self.one_step(&coefficients, delay_s, now)?;
                truth[0].is_finite().then_some([model, truth[0]])
            };
            let pairs: Vec<[f64; 2]> = self.steps.iter().zip(&truth).filter_map(row).collect();
            scores.one_step_rmse = rmse_and_r2(&pairs).map(|(rmse, _)| rmse);
        }
        scores
    }

    fn angles(&self, sensor: &SensorModel) -> Option<AngleScores> {
        let SensorModel::Angles { horizontal_angles_rad, se_rad } = sensor else { return None };
        if self.angles_rad.is_empty() || horizontal_angles_rad.len() != self.angles_rad.len() {
            return None;
        }
        let pairs = horizontal_angles_rad.iter().zip(&self.angles_rad);
        let errors: Vec<f64> = pairs.map(|(learned, truth)| wrap_rad(learned - truth)).collect();
        let (sin, cos) = errors.iter().map(|error| sin_cos(*error)).fold((0.0, 0.0), |s, it| (s.0 + it.0, s.1 + it.1));
        let common = atan2(sin, cos);
        let rms = |errors: &mut dyn Iterator<Item = f64>| mean(errors.map(square)).sqrt();
        let covered = errors.iter().zip(se_rad).filter(|(error, se)| error.abs() <= 1.96 * **se).count();
        let first = self.angles_rad[0];
        let truth = || self.angles_rad.iter().map(|angle| wrap_rad(angle - first));
        let centre = mean(truth());
        let rms_rad = rms(&mut errors.iter().copied());
        let r2 = 1.0 - square(rms_rad) / mean(truth().map(|angle| square(angle - centre)));
        Some(AngleScores {
            rms_rad,
            rms_common_removed_rad: rms(&mut errors.iter().map(|error| wrap_rad(error - common))),
            worst_pair_rad: errors.windows(2).map(|pair| wrap_rad(pair[1] - pair[0]).abs()).fold(0.0, f64::max),
            r2: r2.is_finite().then_some(r2),
            covered: [covered as u32, se_rad.len() as u32],
        })
    }

    /// Acceleration, speed and turning rate of each step by the action model alone, from the first speed on. A model without
    /// a delay is that of eq. 5.5: a step's pedals are averaged and make the speed of the next. One with a delay is of
    /// the moment: it is integrated, and averaged over steps.
    #[must_use]
    pub fn rolled(&self, action: &ActionModel) -> Vec<[f64; 3]> {
        let Some((coefficients, delay_s)) = coefficients(action) else { return Vec::new() };
        let mut rows: Vec<[f64; 3]> = if delay_s == 0.0 {
            let turned = |(v, now): (f64, &Stretch)| [f64::NAN, v, coefficients.turning(v, now.pedals)];
            roll_out(&coefficients, &self.steps).into_iter().zip(&self.steps).map(turned).collect()
        } else {
            let runs = free_run(&coefficients, &self.steps, &self.commands, delay_s, false);
            runs.iter().map(|run| [f64::NAN, run.v_m_per_s, run.omega_rad_per_s]).collect()
        };
        for i in 1..rows.len() {
            rows[i - 1][0] = (rows[i][1] - rows[i - 1][1]) / (self.steps[i].t_s - self.steps[i - 1].t_s);
        }
        rows
    }

    /// The acceleration from a step to the next at the reference's own speed; the acceleration of a model of the moment acts
    /// about the seam of the two.
    fn one_step(&self, coefficients: &Coefficients, delay_s: f64, now: &Stretch) -> Option<f64> {
        if delay_s == 0.0 {
            return Some(coefficients.acceleration(now.v_m_per_s, now.pedals));
        }
        let from_s = now.t_s + 0.5 * now.dt_s - delay_s;
        Some(coefficients.acceleration(now.v_m_per_s, pedals(&self.commands, from_s, from_s + now.dt_s)?))
    }

    /// Of a learner's curves of motion from scan to scan.
    #[must_use]
    pub fn odometry_rmse(&self, traces: &[Trace]) -> Option<[f64; 2]> {
        let trace = |name: &str| traces.iter().find(|trace| trace.name == name).map(|trace| &trace.points);
        let (forward, turning) = (trace("forward_m_per_s")?, trace("turning_rad_per_s")?);
        // Scans follow each other evenly; a gap is several steps long.
        let dt_s = median(&forward.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect::<Vec<_>>())?;
        let rows: Vec<[f64; 2]> = forward
            .iter()
            .zip(turning)
            .filter_map(|(v, omega)| {
                let [true_v, true_omega] = moved(&self.track, v[0], dt_s)?;
                Some([v[1] - true_v, omega[1] - true_omega])
            })
            .collect();
        let rms = |i: usize| Some(mean(rows.iter().map(|row| square(row[i]))).sqrt()).filter(|rms| rms.is_finite());
        Some([rms(0)?, rms(1)?])
    }

    /// The action model that fits the reference's own motions best: the dissertation's From-Truth.
    #[must_use]
    pub fn from_truth(&self) -> Option<Models> {
        Some(Models { action: Some(self.fitted()?.model(0.0)), ..Models::default() })
    }

    /// Its coefficients.
    #[must_use]
    pub fn fitted(&self) -> Option<Coefficients> {
        regress(&self.steps)
    }

    /// The rules of divergence that `models` with `scores` break: an R^2 below `r2_min`, or no model though there is truth
    /// about it.
    #[must_use]
    pub fn faults(&self, scores: &Scores, r2_min: f64) -> Vec<String> {
        let mut faults = Vec::new();
        let mut rule = |name: &str, r2: Option<f64>| match r2 {
            Some(r2) if r2 >= r2_min => {}
            Some(r2) => faults.push(format!("{name} R^2 {r2:.3} < {r2_min}")),
            None => faults.push(format!("{name}: nothing learned")),
        };
        if !self.angles_rad.is_empty() {
            rule("angles", scores.angles.and_then(|angles| angles.r2));
        }
        if self.ranges().is_some() {
            for (i, name) in ["acceleration", "speed", "yaw rate"].into_iter().enumerate() {
                rule(name, scores.rolled_r2.map(|r2| r2[i]));
            }
        }
        faults
    }
}

fn coefficients(action: &ActionModel) -> Option<(Coefficients, f64)> {
    match action {
        ActionModel::Car { c, se, delay_s } => Some((Coefficients { c: *c, se: *se }, *delay_s)),
        _ => None,
    }
}

/// Mean forward speed and turning rate from `t_s` on, as the average heading of the time sees them.
#[must_use]
pub fn moved(track: &[TruePose], t_s: f64, dt_s: f64) -> Option<[f64; 2]> {
    let (a, b) = (pose_at(track, t_s)?, pose_at(track, t_s + dt_s)?);
    let turn_rad = wrap_rad(b.theta_rad - a.theta_rad);
    let (sin, cos) = sin_cos(a.theta_rad + 0.5 * turn_rad);
    Some([((b.y_m - a.y_m) * cos - (b.x_m - a.x_m) * sin) / dt_s, turn_rad / dt_s])
}

/// The drive by steps, as far as track and pedals go.
fn steps(track: &[TruePose], commands: &[Command]) -> Vec<Stretch> {
    let (Some(first), Some(last)) = (track.first(), track.last()) else { return Vec::new() };
    let count = ((last.t_s - first.t_s) / STEP_S + 1e-6).floor().clamp(0.0, 1e6) as usize;
    let step = |i: usize| {
        let t_s = first.t_s + i as f64 * STEP_S;
        // The last step may end a rounding error after the track.
        let dt_s = STEP_S.min(last.t_s - t_s);
        let [v_m_per_s, omega_rad_per_s] = moved(track, t_s, dt_s)?;
        Some(Stretch { t_s, dt_s, v_m_per_s, omega_rad_per_s, pedals: pedals(commands, t_s, t_s + dt_s)? })
    };
    (0..count).filter_map(step).collect()
}

#[cfg(test)]
mod tests;
