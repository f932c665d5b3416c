//! A camera that takes pictures by a clock of its own: a slower loop picks the newest of them up and says when, so that what is
//! reported is as old as the picture is.
//!
//! While a robot turns, a picture that is older shows landmarks where they were: their bearings saw up and down with the age of the
//! pictures. From one sighting of a landmark to the next its bearing turns by as much as the robot does, and by how much more the
//! second picture is older than the first, times the turning rate.

use std::collections::BTreeSet;

use asami_dataset::{Channel, Frame, Log, Sighting};
use asami_math::elementary::ln;
use asami_math::regression::Regression;
use asami_math::statistics::median;
use rayon::prelude::*;

use super::commanded::{Commanded, STEP_S};
use super::pairs::Pair;

/// A robot that turns more slowly shows nothing of pictures' age.
const TURNS_RAD_PER_S: f64 = 0.05;
/// Fewer pairs of sightings show nothing.
const LEAST: usize = 50;
/// How long a robot may take to turn as it is told.
const LAGS_S: [f64; 8] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5];
/// What pairs are off is weighed so often by how far they are.
const ROUNDS: usize = 12;
/// A camera's rate is as it is said to be within this share.
const OFF: f64 = 0.001;
/// Rates within this share of it show what chance makes of the log.
const BESIDE: f64 = 0.01;
/// How finely ages are looked at: rates that part by such a share of a period over the log, and shares of a period.
pub(super) const FINE: f64 = 0.125;
const PHASES: usize = 24;
/// By how much the clock is to be likelier than any that the camera cannot have, in nats: a sighting is in two pairs, those of a
/// picture are off alike, and what a robot's delay wanders by over minutes is taken for a clock whose rate is nearly that of the frames.
const LEAST_NATS: f64 = 10.0;

/// When pictures are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// From each to the next.
    pub period_s: f64,
    /// When one of them is.
    pub first_s: f64,
}

/// A clock, and how it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard {
    /// The likeliest clock.
    pub clock: Clock,
    /// By how much it makes bearings likelier than no age does, in nats.
    pub nats: f64,
    /// The same of the likeliest of those whose rate is none that the camera has.
    pub by_chance_nats: f64,
}

/// A log by a clock that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// As it was where the log does not tell the clock.
    pub log: Log,
    /// How far apart the clock strikes, if it tells.
    pub period_s: Option<f64>,
    /// The same in words, and how sure it is.
    pub said: String,
}

/// A landmark's sightings, one after another.
struct Aged {
    /// When.
    at_s: [f64; 2],
    /// How fast the robot turned.
    turns_rad_per_s: [f64; 2],
    /// By how much its bearing turned less than the robot did.
    off_rad: f64,
}

impl Clock {
    /// Those of a period that strike about a time, at every phase that is looked at.
    pub(super) fn of_period(period_s: f64, about_s: f64) -> impl Iterator<Item = Self> {
        (0..PHASES).map(move |phase| Self { period_s, first_s: about_s + phase as f64 / PHASES as f64 * period_s })
    }

    /// When the newest picture was taken.
    #[must_use]
    pub fn taken_s(&self, t_s: f64) -> f64 {
        self.first_s + ((t_s - self.first_s) / self.period_s).floor() * self.period_s
    }

    /// The log with all that was seen dated by when it was. What was read of a picture again is the same again, and stands once.
    #[must_use]
    pub fn taken_back(&self, log: &Log) -> Log {
        let mut read: BTreeSet<(u64, u16)> = BTreeSet::new();
        let sightings = log.sightings.iter().map(|it| Sighting { t_s: self.taken_s(it.t_s), ..*it });
        let sightings: Vec<Sighting> = sightings.filter(|it| read.insert((it.t_s.to_bits(), it.landmark))).collect();
        let frames = |frames: &Channel<Frame>| -> Channel<Frame> {
            let mut frames: Vec<Frame> =
                frames.iter().map(|frame| Frame { t_s: self.taken_s(frame.t_s), ..*frame }).collect();
            frames.dedup_by_key(|frame| frame.t_s.to_bits());
            frames.into()
        };
        Log { frames: log.frames.as_ref().map(frames), sightings: sightings.into(), ..log.clone() }
    }
}

impl Heard {
    /// Whether the log tells it from what chance makes.
    #[must_use]
    pub fn is_told(&self) -> bool {
        self.nats >= self.by_chance_nats + LEAST_NATS
    }
}

/// The log with all that was seen dated by when it was, where it tells when a camera of so many pictures a second took them.
#[must_use]
pub fn dated(log: &Log, rate_hz: f64) -> Told {
    match heard(log, rate_hz) {
        Some(heard) if heard.is_told() => {
            let Heard { clock, nats, by_chance_nats } = heard;
            let said = format!(
                "the camera takes {:.4} pictures a second by a clock of its own: what was seen is up to {:.1} ms older than it is \
                 dated, and is taken back to when it was ({nats:.0} nats, by chance {by_chance_nats:.0})",
                1.0 / clock.period_s,
                1e3 * clock.period_s
            );
            Told { log: clock.taken_back(log), period_s: Some(clock.period_s), said }
        }
        heard => {
            let why = heard.map_or_else(
                || "too few landmarks are seen in turns".to_owned(),
                |it| format!("{:.0} nats for the likeliest clock, by chance {:.0}", it.nats, it.by_chance_nats),
            );
            let said = format!(
                "when a camera of {rate_hz} pictures a second took them the log does not tell ({why}): what was seen stays as it is dated"
            );
            Told { log: log.clone(), period_s: None, said }
        }
    }
}

/// The clock of a camera that is said to take so many pictures a second, by the bearings of a log and its commands alone; `None`
/// where too few landmarks are seen in turns.
#[must_use]
pub fn heard(log: &Log, rate_hz: f64) -> Option<Heard> {
    let of_lags = LAGS_S.iter().filter_map(|lag_s| pairs(log, *lag_s));
    let (pairs, scale) = of_lags.reduce(|a, b| if b.1 < a.1 { b } else { a })?;
    let (from_s, to_s) = log.span_s()?;
    let fine_hz = FINE / (to_s - from_s);
    let steps = (BESIDE * rate_hz / fine_hz).ceil() as i64;
    let none = likely(&pairs, scale, |_| 0.0);
    // The middle of the log is where a phase means the same at all rates.
    let middle_s = 0.5 * (from_s + to_s);
    let likeliest = |step: i64| {
        let period_s = 1.0 / (rate_hz + step as f64 * fine_hz);
        let of_phase = Clock::of_period(period_s, middle_s)
            .map(|clock| (likely(&pairs, scale, |t_s| t_s - clock.taken_s(t_s) - 0.5 * period_s) - none, clock));
        of_phase.reduce(|a, b| if b.0 > a.0 { b } else { a })
    };
    let of_rates: Vec<(i64, (f64, Clock))> =
        (-steps..=steps).into_par_iter().filter_map(|step| Some((step, likeliest(step)?))).collect();
    let (its_own, others): (Vec<_>, Vec<_>) =
        of_rates.into_iter().partition(|(step, _)| (*step as f64 * fine_hz).abs() <= OFF * rate_hz);
    let (nats, clock) = its_own.into_iter().map(|it| it.1).reduce(|a, b| if b.0 > a.0 { b } else { a })?;
    let by_chance_nats = others.iter().fold(0.0, |most, it| f64::max(most, it.1.0));
    Some(Heard { clock, nats, by_chance_nats })
}

/// How likely what pairs are off is where pictures have such an age, but for a constant: of Cauchy's law, whose tails are as long as
/// those of what a camera takes for a mark.
fn likely(pairs: &[Aged], scale: f64, age_s: impl Fn(f64) -> f64) -> f64 {
    let of = |pair: &Aged| {
        let [before, after] = [0, 1].map(|k| pair.turns_rad_per_s[k] * age_s(pair.at_s[k]));
        let off = (pair.off_rad - (after - before)) / scale;
        ln(1.0 + off * off)
    };
    -pairs.iter().map(of).sum::<f64>()
}

/// The pairs of a log, of a robot that turns as it is told with a lag; and how far most are off.
fn pairs(log: &Log, lag_s: f64) -> Option<(Vec<Aged>, f64)> {
    let turning = Commanded::new(&log.commands, lag_s, 0.0);
    // What each is off, and what may make up for it: that turns are larger or smaller than told, a step to the side, an age that
    // all pictures have, and another lag.
    let mut found: Vec<(Aged, [f64; 4])> = Vec::new();
    for pair in Pair::all(log) {
        let at_s = pair.at_s();
        let moments = at_s.map(|t_s| Moment::at(&turning, t_s));
        let [was, is] = &moments;
        let turns_rad_per_s = [was.omega_rad_per_s, is.omega_rad_per_s];
        if turns_rad_per_s.iter().all(|it| it.abs() < TURNS_RAD_PER_S) {
            continue;
        }
        let aside_rad = pair.aside_rad([was.v_m_per_s, is.v_m_per_s]);
        let [_, turned_rad, ..] = turning.over(at_s[0], at_s[1] - at_s[0]);
        let off_rad = pair.turned_rad() + turned_rad - aside_rad;
        let others = [
            turned_rad,
            aside_rad,
            is.omega_rad_per_s - was.omega_rad_per_s,
            is.alpha_rad_per_s2 - was.alpha_rad_per_s2,
        ];
        found.push((Aged { at_s, turns_rad_per_s, off_rad }, others));
    }
    (found.len() >= LEAST).then(|| freed(found))
}

/// What pairs are off beside all else that may make up for it, by least squares of those that are not far off; and how far most are.
fn freed(mut pairs: Vec<(Aged, [f64; 4])>) -> (Vec<Aged>, f64) {
    let given: Vec<f64> = pairs.iter().map(|(pair, _)| pair.off_rad).collect();
    let usual = |pairs: &[(Aged, [f64; 4])]| usual(pairs.iter().map(|(pair, _)| pair.off_rad));
    for _ in 0..ROUNDS {
        let scale = usual(&pairs);
        let mut regression = Regression::new(4);
        for ((pair, others), given) in pairs.iter().zip(&given) {
            let far = pair.off_rad / (2.0 * scale);
            regression.observe(others, *given, 1.0 / (1.0 + far * far).powi(2));
        }
        let Some(fit) = regression.solve() else { break };
        for ((pair, others), given) in pairs.iter_mut().zip(&given) {
            pair.off_rad = given - others.iter().zip(&fit.coefficients).fold(0.0, |sum, (x, by)| sum + x * by);
        }
    }
    let scale = usual(&pairs);
    (pairs.into_iter().map(|(pair, _)| pair).collect(), scale)
}

/// How far most of these are off: of a Gaussian the standard deviation.
pub(super) fn usual(off: impl Iterator<Item = f64>) -> f64 {
    1.4826 * median(&off.map(f64::abs).collect::<Vec<f64>>()).unwrap_or(0.0).max(1e-6)
}

/// Speed and turning rate at a moment, and how the latter changes.
struct Moment {
    v_m_per_s: f64,
    omega_rad_per_s: f64,
    alpha_rad_per_s2: f64,
}

impl Moment {
    fn at(turning: &Commanded, t_s: f64) -> Self {
        let rates = |from_s: f64| turning.over(from_s, STEP_S).map(|it| it / STEP_S);
        let ([v_m_per_s, omega_rad_per_s, ..], [_, before, ..]) =
            (rates(t_s - 0.5 * STEP_S), rates(t_s - 1.5 * STEP_S));
        Self { v_m_per_s, omega_rad_per_s, alpha_rad_per_s2: (omega_rad_per_s - before) / STEP_S }
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Action, Beacon, Command, Known, Seed, Size};
    use asami_math::angle::wrap_rad;
    use asami_math::elementary::{atan2, hypot, sin_cos};
    use rand::RngExt;
    use rand_distr::StandardNormal;

    use super::*;

    const CAMERA: Clock = Clock { period_s: 0.100_04, first_s: 0.031 };
    const LENGTH_S: f64 = 600.0;

    /// A robot at the origin that turns one way and the other, and rests, as fast as it is told with a lag of 0.2 s, among six landmarks;
    /// of 0.233 s each somebody picks up the newest picture of a camera, if it has a clock of its own.
    fn log(camera: Option<Clock>, seed: u64) -> Log {
        let mut rng = Seed(seed).stream("clock");
        let rates = [0.4, 0.0, -0.3, 0.2, 0.0, -0.4];
        let action = |i: usize| Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s: rates[i % rates.len()] };
        let command = |i: usize| Command { t_s: 2.7 * i as f64, action: action(i) };
        let commands: Vec<Command> = (0..(LENGTH_S / 2.7) as usize).map(command).collect();
        let place = |i: u16| {
            let (sin, cos) = sin_cos(f64::from(i));
            let [right_m, ahead_m] = [3.0, 2.0 + 0.3 * f64::from(i)];
            Beacon { id: i, x_m: right_m * cos - ahead_m * sin, y_m: right_m * sin + ahead_m * cos, height_m: None }
        };
        let landmarks: Vec<Beacon> = (0..6).map(place).collect();
        let known = Known { landmarks: landmarks.clone(), ..Known::default() };
        let log = Log { commands: commands.into(), known: known.into(), ..Log::default() };
        let truth = Commanded::new(&log.commands, 0.2, 0.0);
        let mut sightings = Vec::new();
        for frame in 1..(LENGTH_S / 0.233) as usize - 20 {
            let t_s = 0.233 * frame as f64;
            let heading_rad = truth.until(camera.map_or(t_s, |camera| camera.taken_s(t_s)))[1];
            for Beacon { id: landmark, x_m, y_m, .. } in landmarks.iter().copied() {
                let error_rad = 0.005 * rng.sample::<f64, _>(StandardNormal);
                let bearing_rad = wrap_rad(atan2(-x_m, y_m) - heading_rad + error_rad);
                if bearing_rad.abs() < 0.5 {
                    sightings.push(Sighting { t_s, landmark, size: Size::RangeM(hypot(x_m, y_m)), bearing_rad });
                }
            }
        }
        Log { sightings: sightings.into(), ..log }
    }

    /// Rate and phase are those of the camera; what is taken back is dated by the pictures.
    #[test]
    fn a_camera_is_heard_and_what_it_saw_taken_back() {
        let stale = log(Some(CAMERA), 1);
        let found = heard(&stale, 10.0).unwrap();
        assert!(found.is_told() && found.nats > 100.0, "{found:?}");
        let middle_s = 0.5 * LENGTH_S;
        for t_s in [0.1 * LENGTH_S, middle_s, 0.9 * LENGTH_S] {
            // Around a picture the two clocks may differ by one.
            let off = (CAMERA.taken_s(t_s) - found.clock.taken_s(t_s)) / CAMERA.period_s;
            let off = off - off.round();
            assert!(off.abs() < 0.2, "{t_s}: {off}");
        }
        let taken = CAMERA.taken_back(&stale);
        assert!(taken.sightings.iter().zip(stale.sightings.iter()).all(|(taken, stale)| {
            (0.0..CAMERA.period_s + 1e-9).contains(&(stale.t_s - taken.t_s)) && taken.bearing_rad == stale.bearing_rad
        }));
        let again = heard(&taken, 10.0).unwrap();
        assert!(!again.is_told(), "{again:?}");
    }

    /// Where pictures are as new as they are dated, and where the camera has another rate than is said, nothing is told.
    #[test]
    fn what_is_no_clock_is_not_taken_for_one() {
        for seed in 2..6 {
            let found = heard(&log(None, seed), 10.0).unwrap();
            assert!(!found.is_told(), "{seed}: {found:?}");
        }
        let found = heard(&log(Some(CAMERA), 7), 9.94).unwrap();
        assert!(!found.is_told(), "{found:?}");
        assert_eq!(heard(&Log::default(), 10.0), None);
    }

    /// Two frames of one picture are one, and what was seen in both was seen once.
    #[test]
    fn frames_are_taken_back_as_well() {
        let t_s = |i: u16| 0.05 * f64::from(i);
        let frames: Vec<Frame> = (0..40).map(|i| Frame { t_s: t_s(i), head_pan_rad: 0.0 }).collect();
        let seen = |i: u16| {
            (0..2).map(move |landmark| Sighting { t_s: t_s(i), landmark, size: Size::RangeM(1.0), bearing_rad: 0.0 })
        };
        let sightings: Vec<Sighting> = (0..40).flat_map(seen).collect();
        let log = Log { frames: Some(frames.into()), sightings: sightings.into(), ..Log::default() };
        let taken = Clock { period_s: 0.1, first_s: 0.02 }.taken_back(&log);
        assert_eq!(taken.sightings.len(), 2 * 21);
        let frames = taken.frames.unwrap();
        assert!(frames.len() == 21 && frames.windows(2).all(|pair| (pair[1].t_s - pair[0].t_s - 0.1).abs() < 1e-9));
    }
}
