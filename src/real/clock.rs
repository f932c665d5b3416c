//! A camera that takes pictures by a clock of its own: a slower loop picks the newest of them up and says when, so that what is
//! reported is as old as the picture is.
//!
//! While a robot turns, a picture that is older shows landmarks where they were: their bearings saw up and down with the age of the
//! pictures. From one sighting of a landmark to the next its bearing turns by as much as the robot does, and by how much more the
//! second picture is older than the first, times the turning rate.

use std::collections::BTreeMap;

use asami_dataset::{Action, Channel, Frame, Log, Sighting, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{exp, ln, sin_cos};
use asami_math::regression::Regression;
use asami_math::statistics::median;
use rayon::prelude::*;

/// Sightings of a landmark that are farther apart say little of the robot's turning.
const APART_S: std::ops::Range<f64> = 0.02..0.6;
/// A robot that turns more slowly shows nothing of pictures' age.
const TURNS_RAD_PER_S: f64 = 0.05;
/// Fewer pairs of sightings show nothing.
const LEAST: usize = 50;
/// How long a robot may take to turn as it is told.
const LAGS_S: [f64; 8] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5];
/// Its turning is followed in such steps.
const STEP_S: f64 = 0.01;
/// What pairs are off is weighed so often by how far they are.
const ROUNDS: usize = 12;
/// A camera's rate is as it is said to be within this share.
const OFF: f64 = 0.001;
/// Rates within this share of it show what chance makes of the log.
const BESIDE: f64 = 0.01;
/// How finely ages are looked at: rates that part by such a share of a period over the log, and shares of a period.
const FINE: f64 = 0.125;
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

/// What became of a camera's clock.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Taken {
    /// In words; `None` where nobody asked.
    pub said: Option<String>,
    /// From each picture to the next, if what was seen was taken back.
    pub picture_period_s: Option<f64>,
}

/// A landmark's sightings, one after another.
struct Pair {
    /// When.
    at_s: [f64; 2],
    /// How fast the robot turned.
    turns_rad_per_s: [f64; 2],
    /// By how much its bearing turned less than the robot did.
    off_rad: f64,
}

impl Clock {
    /// When the newest picture was taken.
    #[must_use]
    pub fn taken_s(&self, t_s: f64) -> f64 {
        self.first_s + ((t_s - self.first_s) / self.period_s).floor() * self.period_s
    }

    /// The log with all that was seen dated by when it was.
    #[must_use]
    pub fn taken_back(&self, log: &Log) -> Log {
        let seen = |it: &Sighting| Sighting { t_s: self.taken_s(it.t_s), ..*it };
        let frames = |frames: &Channel<Frame>| -> Channel<Frame> {
            let mut frames: Vec<Frame> =
                frames.iter().map(|frame| Frame { t_s: self.taken_s(frame.t_s), ..*frame }).collect();
            frames.dedup_by_key(|frame| frame.t_s.to_bits());
            frames.into()
        };
        Log {
            frames: log.frames.as_ref().map(frames),
            sightings: log.sightings.iter().map(seen).collect::<Vec<_>>().into(),
            ..log.clone()
        }
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
pub fn dated(log: &Log, rate_hz: f64) -> (Log, Taken) {
    match heard(log, rate_hz) {
        Some(heard) if heard.is_told() => {
            let Heard { clock, nats, by_chance_nats } = heard;
            let said = format!(
                "the camera takes {:.4} pictures a second by a clock of its own: what was seen is up to {:.1} ms older than it is \
                 dated, and is taken back to when it was ({nats:.0} nats, by chance {by_chance_nats:.0})",
                1.0 / clock.period_s,
                1e3 * clock.period_s
            );
            (clock.taken_back(log), Taken { said: Some(said), picture_period_s: Some(clock.period_s) })
        }
        heard => {
            let why = heard.map_or_else(
                || "too few landmarks are seen in turns".to_owned(),
                |it| format!("{:.0} nats for the likeliest clock, by chance {:.0}", it.nats, it.by_chance_nats),
            );
            let said = format!(
                "when a camera of {rate_hz} pictures a second took them the log does not tell ({why}): what was seen stays as it is dated"
            );
            (log.clone(), Taken { said: Some(said), picture_period_s: None })
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
        let of_phase = (0..PHASES).map(|phase| {
            let clock = Clock { period_s, first_s: middle_s + phase as f64 / PHASES as f64 * period_s };
            (likely(&pairs, scale, |t_s| t_s - clock.taken_s(t_s) - 0.5 * period_s) - none, clock)
        });
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
fn likely(pairs: &[Pair], scale: f64, age_s: impl Fn(f64) -> f64) -> f64 {
    let of = |pair: &Pair| {
        let [before, after] = [0, 1].map(|k| pair.turns_rad_per_s[k] * age_s(pair.at_s[k]));
        let off = (pair.off_rad - (after - before)) / scale;
        ln(1.0 + off * off)
    };
    -pairs.iter().map(of).sum::<f64>()
}

/// The pairs of a log, of a robot that turns as it is told with a lag; and how far most are off.
fn pairs(log: &Log, lag_s: f64) -> Option<(Vec<Pair>, f64)> {
    let turning = Turning::new(log, lag_s)?;
    let mut last: BTreeMap<u16, Sighting> = BTreeMap::new();
    // What each is off, and what may make up for it: that turns are larger or smaller than told, a step to the side, an age that
    // all pictures have, and another lag.
    let mut found: Vec<(Pair, [f64; 4])> = Vec::new();
    for seen in log.sightings.iter() {
        let before = last.insert(seen.landmark, *seen);
        let Some(before) = before.filter(|it| APART_S.contains(&(seen.t_s - it.t_s))) else { continue };
        let both = [&before, seen];
        let at_s = both.map(|it| it.t_s);
        let turns_rad_per_s = at_s.map(|t_s| turning.at(t_s).omega_rad_per_s);
        if turns_rad_per_s.iter().all(|it| it.abs() < TURNS_RAD_PER_S) {
            continue;
        }
        let aside = |it: &Sighting| match it.size {
            Size::RangeM(range_m) => turning.at(it.t_s).v_m_per_s * sin_cos(it.bearing_rad).0 / range_m.max(0.1),
            Size::HeightPx(_) => 0.0,
        };
        let aside_rad = 0.5 * (at_s[1] - at_s[0]) * (aside(&before) + aside(seen));
        let turned_rad = turning.heading_rad(at_s[1]) - turning.heading_rad(at_s[0]);
        let grows = |of: fn(&Moment) -> f64| of(turning.at(at_s[1])) - of(turning.at(at_s[0]));
        let off_rad = wrap_rad(seen.bearing_rad - before.bearing_rad) + turned_rad - aside_rad;
        let others = [turned_rad, aside_rad, grows(|it| it.omega_rad_per_s), grows(|it| it.alpha_rad_per_s2)];
        found.push((Pair { at_s, turns_rad_per_s, off_rad }, others));
    }
    (found.len() >= LEAST).then(|| freed(found))
}

/// What pairs are off beside all else that may make up for it, by least squares of those that are not far off; and how far most are.
fn freed(mut pairs: Vec<(Pair, [f64; 4])>) -> (Vec<Pair>, f64) {
    let given: Vec<f64> = pairs.iter().map(|(pair, _)| pair.off_rad).collect();
    let usual = |pairs: &[(Pair, [f64; 4])]| {
        let off: Vec<f64> = pairs.iter().map(|(pair, _)| pair.off_rad.abs()).collect();
        // Of a Gaussian this is the standard deviation.
        1.4826 * median(&off).unwrap_or(0.0).max(1e-6)
    };
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

/// How a robot moves at a moment.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    v_m_per_s: f64,
    omega_rad_per_s: f64,
    alpha_rad_per_s2: f64,
}

/// How it turns as it is told, with a lag.
struct Turning {
    from_s: f64,
    moments: Vec<Moment>,
    /// Turned by the beginning of each step.
    headings_rad: Vec<f64>,
}

impl Turning {
    fn new(log: &Log, lag_s: f64) -> Option<Self> {
        let (from_s, to_s) = log.span_s()?;
        let steps = ((to_s - from_s) / STEP_S).ceil() as usize + 1;
        let share = 1.0 - exp(-STEP_S / lag_s);
        let (mut next, mut told, mut now, mut heading_rad) = (0, [0.0; 2], Moment::default(), 0.0);
        let (mut moments, mut headings_rad) = (Vec::with_capacity(steps), Vec::with_capacity(steps));
        for i in 0..steps {
            let t_s = from_s + i as f64 * STEP_S;
            while let Some(command) = log.commands.get(next).filter(|it| it.t_s <= t_s) {
                told = match command.action {
                    Action::Wheels { v_m_per_s, omega_rad_per_s, .. } => [v_m_per_s, omega_rad_per_s],
                    Action::Legs { ay_m_per_s, atheta_rad_per_s, .. } => [ay_m_per_s, atheta_rad_per_s],
                    Action::Pedals { .. } => return None,
                };
                next += 1;
            }
            let alpha_rad_per_s2 = share * (told[1] - now.omega_rad_per_s) / STEP_S;
            now = Moment {
                v_m_per_s: now.v_m_per_s + share * (told[0] - now.v_m_per_s),
                omega_rad_per_s: now.omega_rad_per_s + STEP_S * alpha_rad_per_s2,
                alpha_rad_per_s2,
            };
            moments.push(now);
            headings_rad.push(heading_rad);
            heading_rad += STEP_S * now.omega_rad_per_s;
        }
        Some(Self { from_s, moments, headings_rad })
    }

    fn step(&self, t_s: f64) -> usize {
        (((t_s - self.from_s) / STEP_S).max(0.0) as usize).min(self.moments.len() - 1)
    }

    fn at(&self, t_s: f64) -> &Moment {
        &self.moments[self.step(t_s)]
    }

    fn heading_rad(&self, t_s: f64) -> f64 {
        let step = self.step(t_s);
        let within_s = t_s - self.from_s - step as f64 * STEP_S;
        self.headings_rad[step] + within_s * self.moments[step].omega_rad_per_s
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Beacon, Command, Known, Seed};
    use asami_math::elementary::{atan2, hypot};
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
        let truth = Turning::new(&log, 0.2).unwrap();
        let mut sightings = Vec::new();
        for frame in 1..(LENGTH_S / 0.233) as usize - 20 {
            let t_s = 0.233 * frame as f64;
            let heading_rad = truth.heading_rad(camera.map_or(t_s, |camera| camera.taken_s(t_s)));
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

    /// Two frames of one picture are one.
    #[test]
    fn frames_are_taken_back_as_well() {
        let frames: Vec<Frame> = (0..40).map(|i| Frame { t_s: 0.05 * f64::from(i), head_pan_rad: 0.0 }).collect();
        let log = Log { frames: Some(frames.into()), ..Log::default() };
        let taken = Clock { period_s: 0.1, first_s: 0.02 }.taken_back(&log);
        let frames = taken.frames.unwrap();
        assert!(frames.len() == 21 && frames.windows(2).all(|pair| (pair[1].t_s - pair[0].t_s - 0.1).abs() < 1e-9));
    }
}
