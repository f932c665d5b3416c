//! How the car moved from scan to scan (section 5.2).

use asami_math::rigid::{Rigid, rotate};

use crate::cloud::{Cut, Going, cloud};
use crate::drive::{Drive, Scan};
use crate::matching::{Match, Matching, Target, align};

/// The moment of its turn as of which a scan taken in motion shows its surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AsOf {
    /// Its beginning. A speed that is wrong by e shifts all points, in the mean by half a turn's time e.
    Beginning,
    /// Its middle. A speed that is wrong stretches the points, but leaves their middle where it is.
    Middle,
}

impl AsOf {
    /// Share of the turn that has passed.
    fn passed(self) -> f64 {
        match self {
            Self::Beginning => 0.0,
            Self::Middle => 0.5,
        }
    }
}

/// A motion from the moment of one scan to that of the next, in the frame of the lasers' relative angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The earlier scan's moment.
    pub t_s: f64,
    /// How much later the later one's is.
    pub dt_s: f64,
    /// Where the later scan was taken, seen from the earlier.
    pub later_from_earlier: Rigid,
    /// How the scans were matched.
    pub matched: Match,
}

impl Motion {
    /// The shift turned by minus half the turn: as the average direction over the step sees it (section 5.2).
    #[must_use]
    pub fn shift_m(&self) -> [f64; 2] {
        let motion = &self.later_from_earlier;
        rotate(-motion.turn_rad / 2.0, [motion.x, motion.y])
    }

    /// Mean speed.
    #[must_use]
    pub fn speed_m_per_s(&self) -> f64 {
        let [x, y] = self.shift_m();
        (x * x + y * y).sqrt() / self.dt_s
    }

    /// Mean speed along a direction of the frame.
    #[must_use]
    pub fn along(&self, direction_rad: f64) -> f64 {
        rotate(-direction_rad, self.shift_m())[0] / self.dt_s
    }

    /// Mean turning rate.
    #[must_use]
    pub fn turning_rad_per_s(&self) -> f64 {
        self.later_from_earlier.turn_rad / self.dt_s
    }
}

/// The first of two passes stops at so many tolerances, and thins points out over squares so much larger.
const ROUGH: f64 = 10.0;
const COARSER: f64 = 2.5;

/// The gate of the second pass at most.
const NEAR_M: f64 = 1.5;

/// Scans, matched one to the next.
#[derive(Clone, Copy, Debug)]
pub struct Odometry<'a> {
    /// The log.
    pub drive: &'a Drive<'a>,
    /// The scans.
    pub scans: &'a [Scan],
    /// Relative angles of the lasers.
    pub angles_rad: &'a [f64],
    /// Which points count.
    pub cut: Cut,
    /// How clouds are matched.
    pub matching: Matching,
    /// The moment of a turn from which to which motions are found.
    pub as_of: AsOf,
}

impl Odometry<'_> {
    /// As published: each pair by itself, from the start given for it or else from no motion; D1 is the smaller scan.
    #[must_use]
    pub fn apart(&self, starts: &[Rigid]) -> Vec<Option<Motion>> {
        let pair = |i: usize| {
            let clouds = [i, i + 1].map(|k| cloud(self.drive, &self.scans[k], self.angles_rad, &self.cut, None));
            let start = starts.get(i).copied().unwrap_or_default();
            let (earlier, later) = (&clouds[0], &clouds[1]);
            let matched = if earlier.len() < later.len() {
                // D1 came first: its points go to where the later scan sees them, and the motion is the inverse.
                let found = align(earlier, &Target::new(later, &self.matching), start.inverse(), &self.matching)?;
                Match { motion: found.motion.inverse(), ..found }
            } else {
                align(later, &Target::new(earlier, &self.matching), start, &self.matching)?
            };
            Some(self.motion(i, matched))
        };
        (0..self.scans.len().saturating_sub(1)).map(pair).collect()
    }

    /// Each pair from the start given for it or else the motion of the one before it, points set back to where the car stood at the moment of its scan. Twice over:
    /// only after the first pass is it known how fast the car was at each scan.
    #[must_use]
    pub fn in_motion(&self, starts: &[Rigid]) -> Vec<Option<Motion>> {
        let first = self.first_pass(starts);
        let rate_of = |i: Option<usize>| i.and_then(|i| first.get(i).copied().flatten()).map(|motion| rate(&motion));
        let rates: Vec<Option<Rigid>> = (0..self.scans.len())
            .map(|k| match (rate_of(k.checked_sub(1)), rate_of(Some(k))) {
                (Some(a), Some(b)) => Some(blend(&a, &b)),
                (a, b) => a.or(b),
            })
            .collect();
        // The first pass came near: nothing needs to be looked for far off.
        let fine = Matching { gate_m: self.matching.gate_m.min(NEAR_M), coarse: 1, ..self.matching };
        let mut earlier = self.scans.first().map(|_| self.steady(0, rates[0]));
        (0..self.scans.len().saturating_sub(1))
            .map(|i| {
                let later = self.steady(i + 1, rates[i + 1]);
                let target = earlier.replace(later).map(|points| Target::new(&points, &fine))?;
                let start = first[i]?.later_from_earlier;
                Some(self.motion(i, align(earlier.as_ref()?, &target, start, &fine)?))
            })
            .collect()
    }

    fn first_pass(&self, starts: &[Rigid]) -> Vec<Option<Motion>> {
        // Only speeds are wanted yet: fewer points do.
        let rough = Matching { tolerance_m: ROUGH * self.matching.tolerance_m, ..self.matching };
        let thinned = Self { cut: Cut { square_m: COARSER * self.cut.square_m, ..self.cut }, ..*self };
        let mut speed: Option<Rigid> = None;
        (0..self.scans.len().saturating_sub(1))
            .map(|i| {
                // Both set back at one speed: errors of the speed that differ from scan to scan would feed on themselves.
                let (earlier, later) = (thinned.steady(i, speed), thinned.steady(i + 1, speed));
                let dt_s = self.moment_s(i + 1) - self.moment_s(i);
                let going_on = || speed.map_or(Rigid::default(), |speed| scaled(&speed, dt_s));
                let start = starts.get(i).copied().unwrap_or_else(going_on);
                let found = align(&later, &Target::new(&earlier, &rough), start, &rough);
                let motion = found.map(|matched| self.motion(i, matched));
                speed = motion.as_ref().map(rate);
                motion
            })
            .collect()
    }

    /// A scan's points, the car's own motion at `speed` (per second) taken out.
    fn steady(&self, k: usize, speed: Option<Rigid>) -> Vec<[f64; 2]> {
        let (scan, passed) = (&self.scans[k], self.as_of.passed());
        let firings = (scan.end - scan.first - 1).max(1) as f64;
        let going = speed.map(|speed| {
            let motion = chord(&speed, self.lasts_s(k), passed);
            Going { motion, firings, before: passed * firings }
        });
        cloud(self.drive, scan, self.angles_rad, &self.cut, going)
    }

    fn lasts_s(&self, k: usize) -> f64 {
        let (times, scan) = (&self.drive.firings.t_s, &self.scans[k]);
        times[scan.end - 1] - times[scan.first]
    }

    fn moment_s(&self, k: usize) -> f64 {
        self.scans[k].t_s + self.as_of.passed() * self.lasts_s(k)
    }

    fn motion(&self, i: usize, matched: Match) -> Motion {
        let (t_s, next_s) = (self.moment_s(i), self.moment_s(i + 1));
        Motion { t_s, dt_s: next_s - t_s, later_from_earlier: matched.motion, matched }
    }
}

/// Per second, along the chord turned back by half the turn.
fn rate(motion: &Motion) -> Rigid {
    let [x, y] = motion.shift_m();
    Rigid { turn_rad: motion.turning_rad_per_s(), x: x / motion.dt_s, y: y / motion.dt_s }
}

/// From now on.
fn scaled(speed: &Rigid, dt_s: f64) -> Rigid {
    chord(speed, dt_s, 0.0)
}

/// In `dt_s`, of which a share has passed, in the frame of now.
fn chord(speed: &Rigid, dt_s: f64, passed: f64) -> Rigid {
    let turn_rad = speed.turn_rad * dt_s;
    let [x, y] = rotate((0.5 - passed) * turn_rad, [speed.x * dt_s, speed.y * dt_s]);
    Rigid { turn_rad, x, y }
}

fn blend(a: &Rigid, b: &Rigid) -> Rigid {
    Rigid { turn_rad: (a.turn_rad + b.turn_rad) / 2.0, x: (a.x + b.x) / 2.0, y: (a.y + b.y) / 2.0 }
}
