//! Chapter 5: the angles of a laser scanner and the action model of the car that carries it, from one drive.
//!
//! [`Car`] is Algorithm 3; its fields are the questions that the method answers one way and may answer another.

mod action;
mod free_run;
mod registered;

use std::f64::consts::{FRAC_PI_2, PI};

use asami_dataset::{Action, Log, Models, SensorModel};
use asami_math::angle::wrap_rad;
use asami_math::rigid::{Rigid, rotate};

pub use asami_scans::{
    Angles, AsOf, Cut, Direction, Distance, Drive, Layout, Match, Matching, Motion, Odometry, Offsets, PairLag, Scan,
    Sensor, Shaping, Signal, Slope, Target, align, angle_median, chain, cloud, from_slopes, graph, pair_lags, pairs,
    slopes,
};

pub use action::{Coefficients, Stretch, pedals, regress, roll_out};
pub use free_run::{FreeRun, Run, free_run};
pub use registered::Registered;

use crate::learner::{CannotLearn, Lack, Learned, Trace};

/// Algorithm 3, and its answers.
#[derive(Clone, Debug, PartialEq)]
pub struct Car {
    /// How the lasers' relative angles are learned.
    pub sensor: Sensor,
    /// How long from one scan to the next; 0: every turn is one.
    pub interval_s: f64,
    /// Which points of a scan count.
    pub cut: Cut,
    /// How scans are matched.
    pub matching: Matching,
    /// Where matching begins.
    pub start: Start,
    /// How motions and pedals become an action model.
    pub fit: Fit,
    /// Slower motions do not tell which way is forward.
    pub slow_m_per_s: f64,
    /// Scans are matched anew with the action model learned from them so many times at most.
    pub max_iterations: u32,
}

/// Where the matching of two scans begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At what the action model predicts, at first one that is given, or else at no motion; points stay where they were measured.
    ActionModel,
    /// At the motion of the pair before, or what a given action model predicts; points are set back by the car's motion during the turn,
    /// to its middle.
    PairBefore,
}

/// How motions and pedals become an action model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fit {
    /// By the regressions of eqs 5.3 and 5.4 over means of whole intervals.
    Published,
    /// Pedals averaged over the very time of the acceleration, the actuators' delay found, within what tyres can do.
    Registered(Registered),
    /// The same, but what comes nearest is the roll-out over the whole drive.
    FreeRun(FreeRun),
}

/// What scan matching found.
struct Found {
    motions: Vec<Option<Motion>>,
    forward: Option<Direction>,
    iterations: u32,
    stretches: Vec<Stretch>,
    coefficients: Option<Coefficients>,
    delay_s: f64,
}

/// Motions that change by less than this from one iteration to the next (metres; turns count at 10 m) have converged.
const CONVERGED_M: f64 = 1e-3;

impl Car {
    /// Algorithm 3 as published.
    #[must_use]
    pub fn published() -> Self {
        Self {
            sensor: Sensor::published(),
            interval_s: 0.5,
            cut: Cut { lowest_m: -1.0, least_slope: 0.0, square_m: 0.0 },
            matching: Matching::published(),
            start: Start::ActionModel,
            fit: Fit::Published,
            slow_m_per_s: 2.0,
            max_iterations: 10,
        }
    }

    /// Learns the lasers' angles and the action model. An action model of pedals in `given` says where the matching of scans begins. A log without firings but with odometry of its own gives an action model
    /// alone; one without pedals, the angles alone.
    ///
    /// # Errors
    /// [`CannotLearn`] where the log has neither firings nor odometry, or its firings cannot be read.
    pub fn learn(&self, log: &Log, given: &Models) -> Result<Learned, CannotLearn> {
        if log.firings.is_none() && !log.odometry.is_empty() {
            return self.by_odometry(log);
        }
        let drive = Drive::try_from(log)?;
        let angles = self.sensor.learn(&drive)?;
        let scans = drive.scans(self.interval_s);
        let odometry = Odometry {
            drive: &drive,
            scans: &scans,
            angles_rad: &angles.angle_rad,
            cut: self.cut,
            matching: self.matching,
            as_of: match self.start {
                Start::ActionModel => AsOf::Beginning,
                Start::PairBefore => AsOf::Middle,
            },
        };
        let starts = given.action.as_ref().and_then(Coefficients::of).map(|model| guessed(&model, log, &scans));
        let found = match self.start {
            Start::ActionModel => self.iterate(log, &odometry, starts.unwrap_or_default()),
            Start::PairBefore => self.once(log, odometry.in_motion(&starts.unwrap_or_default())),
        };
        let mut lacks = lacks(&angles, &found, scans.len());
        lacks.extend(self.pedal_lack(log, &found.coefficients));
        // Forward lies at pi/2 in the car's frame: C turns it there (section 5.2).
        let (c_rad, c_se_rad) =
            found.forward.map_or((FRAC_PI_2, PI), |forward| (FRAC_PI_2 - forward.angle_rad, forward.se_rad));
        let absolute = |angle: &f64| wrap_rad(angle + c_rad);
        let sensor = SensorModel::Angles {
            horizontal_angles_rad: angles.angle_rad.iter().map(absolute).collect(),
            se_rad: angles.se_rad.iter().map(|se| (se * se + c_se_rad * c_se_rad).sqrt()).collect(),
        };
        Ok(Learned {
            models: Models {
                action: found.coefficients.map(|coefficients| coefficients.model(found.delay_s)),
                sensor: Some(sensor),
                ..Models::default()
            },
            iterations: Some(found.iterations),
            traces: traces(&found.motions, FRAC_PI_2 - c_rad),
            lacks,
            ..Learned::default()
        })
    }

    fn by_odometry(&self, log: &Log) -> Result<Learned, CannotLearn> {
        let (Some(first), Some(last)) = (log.odometry.first(), log.odometry.last()) else {
            return Err(CannotLearn::NoFirings);
        };
        let every_s = if self.interval_s > 0.0 { self.interval_s } else { 0.1 };
        let count = ((last.t_s - first.t_s) / every_s).floor().clamp(0.0, 1e6) as usize;
        let mean = |i: usize| {
            let (t_s, end_s) = (first.t_s + i as f64 * every_s, first.t_s + (i + 1) as f64 * every_s);
            let rows = log.odometry.window(&(t_s..end_s));
            let n = rows.len() as f64;
            let sums = rows.iter().fold((0.0, 0.0), |s, row| (s.0 + row.v_m_per_s, s.1 + row.omega_rad_per_s));
            let pedals = action::pedals(&log.commands, t_s, end_s)?;
            let stretch = Stretch { t_s, dt_s: every_s, v_m_per_s: sums.0 / n, omega_rad_per_s: sums.1 / n, pedals };
            (n > 0.0 && stretch.v_m_per_s.is_finite() && stretch.omega_rad_per_s.is_finite()).then_some(stretch)
        };
        let stretches: Vec<Stretch> = (0..count).filter_map(mean).collect();
        let (coefficients, delay_s) = self.fitted(log, &stretches);
        let mut lacks = vec![Lack::NoFirings];
        lacks.extend(self.pedal_lack(log, &coefficients));
        let action = coefficients.map(|coefficients| coefficients.model(delay_s));
        Ok(Learned { models: Models { action, ..Models::default() }, iterations: Some(1), lacks, ..Learned::default() })
    }

    /// Lines 2 to 6 of Algorithm 3, each scan pair by itself.
    fn iterate(&self, log: &Log, odometry: &Odometry<'_>, mut starts: Vec<Rigid>) -> Found {
        let mut before: Vec<Option<Motion>> = Vec::new();
        let mut iterations = 0;
        loop {
            iterations += 1;
            let found = self.once(log, odometry.apart(&starts));
            let settled = iterations > 1 && found.motions.iter().zip(&before).all(|(now, before)| same(now, before));
            let (Some(coefficients), Some(forward)) = (found.coefficients, found.forward) else {
                return Found { iterations, ..found };
            };
            if settled || iterations >= self.max_iterations {
                return Found { iterations, ..found };
            }
            starts = predicted(&coefficients, &found.stretches, odometry.scans, forward.angle_rad);
            before = found.motions;
        }
    }

    /// Lines 4 and 5 of Algorithm 3.
    fn once(&self, log: &Log, motions: Vec<Option<Motion>>) -> Found {
        let fast = motions.iter().flatten().filter(|motion| motion.speed_m_per_s() > self.slow_m_per_s);
        let angle = |motion: &Motion| {
            let [x, y] = motion.shift_m();
            asami_math::elementary::atan2(y, x)
        };
        let forward = angle_median(&fast.map(angle).collect::<Vec<_>>());
        let stretches: Vec<Stretch> = forward.map_or(Vec::new(), |forward| {
            let stretch = |motion: &Motion| {
                let pedals = action::pedals(&log.commands, motion.t_s, motion.t_s + motion.dt_s)?;
                Some(Stretch {
                    t_s: motion.t_s,
                    dt_s: motion.dt_s,
                    v_m_per_s: motion.along(forward.angle_rad),
                    omega_rad_per_s: motion.turning_rad_per_s(),
                    pedals,
                })
            };
            motions.iter().flatten().filter_map(stretch).collect()
        });
        let (coefficients, delay_s) = self.fitted(log, &stretches);
        Found { motions, forward, iterations: 1, stretches, coefficients, delay_s }
    }

    fn fitted(&self, log: &Log, stretches: &[Stretch]) -> (Option<Coefficients>, f64) {
        let found = match self.fit {
            Fit::Published => regress(stretches).map(|coefficients| (coefficients, 0.0)),
            Fit::Registered(fit) => fit.learn(stretches, &log.commands),
            Fit::FreeRun(fit) => fit.learn(stretches, &log.commands),
        };
        found.map_or((None, 0.0), |(coefficients, delay_s)| (Some(coefficients), delay_s))
    }

    fn pedal_lack(&self, log: &Log, coefficients: &Option<Coefficients>) -> Option<Lack> {
        let pedals = log.commands.iter().filter(|command| matches!(command.action, Action::Pedals { .. })).count();
        let undetermined = coefficients.is_none_or(|coefficients| coefficients.se.is_none());
        undetermined.then_some(Lack::Pedals { found: pedals })
    }
}

/// The same by a model that was given, from a standstill on. Which way is forward nobody knows yet: it is taken for the middle of the
/// lasers.
fn guessed(model: &Coefficients, log: &Log, scans: &[Scan]) -> Vec<Rigid> {
    let stretch = |pair: &[Scan]| {
        let (t_s, dt_s) = (pair[0].t_s, pair[1].t_s - pair[0].t_s);
        let pedals = action::pedals(&log.commands, t_s, t_s + dt_s)?;
        Some(Stretch { t_s, dt_s, v_m_per_s: 0.0, omega_rad_per_s: 0.0, pedals })
    };
    predicted(model, &scans.windows(2).filter_map(stretch).collect::<Vec<_>>(), scans, 0.0)
}

/// Where the model's prediction says each pair's later scan was taken, in the frame of the relative angles; no motion where it says nothing.
fn predicted(coefficients: &Coefficients, stretches: &[Stretch], scans: &[Scan], forward_rad: f64) -> Vec<Rigid> {
    let speeds = roll_out(coefficients, stretches);
    let mut by_time = stretches.iter().zip(&speeds).peekable();
    let start = |scan: &Scan| {
        while by_time.next_if(|(stretch, _)| stretch.t_s < scan.t_s).is_some() {}
        let (stretch, v) = by_time.peek().filter(|(stretch, _)| stretch.t_s == scan.t_s)?;
        let turn_rad = coefficients.turning(**v, stretch.pedals) * stretch.dt_s;
        let [x, y] = rotate(forward_rad + turn_rad / 2.0, [**v * stretch.dt_s, 0.0]);
        Some(Rigid { turn_rad, x, y }.or_none())
    };
    scans.iter().map(start).map(Option::unwrap_or_default).collect()
}

fn same(now: &Option<Motion>, before: &Option<Motion>) -> bool {
    match (now, before) {
        (Some(now), Some(before)) => {
            let change = now.later_from_earlier.after(&before.later_from_earlier.inverse());
            (change.x * change.x + change.y * change.y).sqrt() + 10.0 * change.turn_rad.abs() < CONVERGED_M
        }
        (None, None) => true,
        _ => false,
    }
}

fn lacks(angles: &Angles, found: &Found, scans: usize) -> Vec<Lack> {
    let mut lacks = Vec::new();
    if !angles.lost.is_empty() {
        lacks.push(Lack::LostPairs { pairs: angles.lost.clone() });
    }
    let unmatched = scans.saturating_sub(1) - found.motions.iter().flatten().count();
    if unmatched > 0 || scans < 2 {
        lacks.push(Lack::UnmatchedScans { unmatched, scans });
    }
    if found.forward.is_none() {
        lacks.push(Lack::NoForward);
    }
    lacks
}

/// Mean velocities from each scan to the next, at the moment of the first: rightward, forward and counter-clockwise in the car's frame.
fn traces(motions: &[Option<Motion>], forward_rad: f64) -> Vec<Trace> {
    let row =
        |value: &dyn Fn(&Motion) -> f64| motions.iter().flatten().map(|motion| [motion.t_s, value(motion)]).collect();
    vec![
        Trace { name: "right_m_per_s", points: row(&|motion| motion.along(forward_rad - FRAC_PI_2)) },
        Trace { name: "forward_m_per_s", points: row(&|motion| motion.along(forward_rad)) },
        Trace { name: "turning_rad_per_s", points: row(&|motion| motion.turning_rad_per_s()) },
    ]
}
