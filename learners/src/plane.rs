//! A log of chapter 4: landmarks at known places, discrete actions, motion in the plane.

use std::collections::BTreeMap;
use std::ops::Range;

use asami_dataset::{Action, Log};

use crate::learner::{CannotLearn, Lack};
use crate::line::Unit;

/// Times closer than this are one time.
const SAME_S: f64 = 1e-6;

/// An action executed for less than this is rare.
const RARE_S: f64 = 1.0;

/// A log as chapter 4 sees it: frames, the discrete action `c_t` after each, and what was seen in each.
///
/// The only place in these learners that matches on kinds of commands and sightings of chapter 4.
#[derive(Clone, Debug)]
pub struct Plane {
    /// What the sizes of landmarks are.
    pub unit: Unit,
    /// The discrete actions, in order of id; commands without an id together are the last of them.
    pub actions: Vec<Discrete>,
    /// Frames in order of time, from the first command on.
    pub frames: Vec<Frame>,
    /// All sightings, in order of frame.
    pub sightings: Vec<Seen>,
    /// Where the sensor sits in the robot frame: right, forward.
    pub sensor_origin_m: [f64; 2],
    /// Median length of a step from frame to frame.
    pub step_s: f64,
}

/// One of the discrete actions that occur in the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discrete {
    /// Its id; `None` for commands without one.
    pub id: Option<u16>,
    /// Mean attempted velocity: right in m/s, forward in m/s, counter-clockwise in rad/s.
    pub attempted: [f64; 3],
    /// How long it was executed.
    pub held_s: f64,
}

/// One frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// When, in the log's time.
    pub t_s: f64,
    /// Until the next frame; 0 for the last.
    pub dt_s: f64,
    /// `c_t`, an index into [`Plane::actions`]: what was executed for most of the time until the next frame.
    pub action: usize,
    /// Steps since the last frame with a sighting before this one, at least 1 (the dissertation's `k`).
    pub since_seen: u32,
    sightings: Range<usize>,
}

/// One landmark seen in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Its id.
    pub landmark: u16,
    /// Where it stands in the world; the origin in [`Plane::along_a_line`] if unknown.
    pub landmark_m: [f64; 2],
    /// `o_1`: height or range, in [`Plane::unit`].
    pub size: f64,
    /// `o_2`: from straight ahead, counter-clockwise.
    pub bearing_rad: f64,
}

impl TryFrom<&Log> for Plane {
    type Error = CannotLearn;

    fn try_from(log: &Log) -> Result<Self, CannotLearn> {
        Plane::of(log, true)
    }
}

impl Plane {
    /// A log of motion along a line: one landmark, whose place need not be known.
    ///
    /// # Errors
    /// What the log lacks.
    pub fn along_a_line(log: &Log) -> Result<Self, CannotLearn> {
        let plane = Plane::of(log, false)?;
        let found = plane.landmarks().len();
        if found > 1 { Err(CannotLearn::SeveralLandmarks { found }) } else { Ok(plane) }
    }

    fn of(log: &Log, places_needed: bool) -> Result<Self, CannotLearn> {
        let commands = commands(log)?;
        let (unit, seen) = sightings(log, places_needed)?;
        let times = times(log, &commands, &seen)?;
        let mut held = Held::default();
        let mut frames = Vec::with_capacity(times.len());
        let (mut sightings, mut seen) = (Vec::new(), seen.into_iter().peekable());
        let mut last_seen = None;
        let mut command = 0;
        for (i, &t_s) in times.iter().enumerate() {
            let next_s = times.get(i + 1).copied();
            let first = sightings.len();
            while let Some((at_s, one)) = seen.next_if(|(at_s, _)| next_s.is_none_or(|next_s| *at_s < next_s - SAME_S))
            {
                // A sighting between frames would be dated back.
                if (at_s - t_s).abs() <= SAME_S || log.frames.is_some() && at_s > t_s {
                    sightings.push(one);
                }
            }
            let since_seen = last_seen.map_or(1, |last| i - last) as u32;
            if sightings.len() > first {
                last_seen = Some(i);
            }
            let end_s = next_s.unwrap_or(t_s);
            let action = longest(&commands, &mut command, t_s, end_s);
            let action = held.add(&commands[action].action, end_s - t_s);
            frames.push(Frame { t_s, dt_s: end_s - t_s, action, since_seen, sightings: first..sightings.len() });
        }
        if sightings.is_empty() {
            return Err(CannotLearn::NoSightings);
        }
        let actions = held.in_order(&mut frames);
        if actions.iter().all(|action| action.id.is_none()) {
            return Err(CannotLearn::NoActions);
        }
        let sensor_origin_m = log.known.range_bearing.map_or([0.0; 2], |sensor| sensor.sensor_origin_m);
        Ok(Plane { unit, actions, step_s: median_step(&frames), frames, sightings, sensor_origin_m })
    }

    /// What was seen in frame `t`.
    #[must_use]
    pub fn seen(&self, t: usize) -> &[Seen] {
        self.frames.get(t).map_or(&[], |frame| &self.sightings[frame.sightings.clone()])
    }

    /// Ids and places of the landmarks that were seen, in order of id.
    #[must_use]
    pub fn landmarks(&self) -> BTreeMap<u16, [f64; 2]> {
        self.sightings.iter().map(|seen| (seen.landmark, seen.landmark_m)).collect()
    }

    /// What this log cannot tell: actions hardly executed, sizes of no landmark that change, a single landmark (in
    /// the plane, not along a line).
    #[must_use]
    pub fn lacks(&self, along_a_line: bool) -> Vec<Lack> {
        let mut lacks = Vec::new();
        let rare = self.actions.iter().filter(|action| action.held_s < RARE_S).filter_map(|action| action.id);
        let actions: Vec<u16> = rare.collect();
        if !actions.is_empty() {
            lacks.push(Lack::RareActions { actions, least_s: RARE_S });
        }
        let mut spans: BTreeMap<u16, (f64, f64)> = BTreeMap::new();
        for seen in &self.sightings {
            let (least, greatest) = spans.entry(seen.landmark).or_insert((seen.size, seen.size));
            (*least, *greatest) = (least.min(seen.size), greatest.max(seen.size));
        }
        let span = spans.values().fold(0.0, |most: f64, (least, greatest)| most.max(greatest - least));
        if span <= 10.0 * self.local_noise() {
            lacks.push(Lack::NarrowObservations { span, unit: self.unit.symbol() });
        }
        let landmarks = self.landmarks();
        if let (1, false, Some((landmark, _))) = (landmarks.len(), along_a_line, landmarks.first_key_value()) {
            lacks.push(Lack::OneLandmark { landmark: *landmark });
        }
        lacks
    }

    /// Standard deviation of the sizes' noise if it is white, out of second differences of successive
    /// sightings of each landmark, of which half are taken to be in steady motion.
    #[must_use]
    pub fn local_noise(&self) -> f64 {
        let mut by_landmark: BTreeMap<u16, Vec<f64>> = BTreeMap::new();
        for seen in &self.sightings {
            by_landmark.entry(seen.landmark).or_default().push(seen.size);
        }
        let second = |three: &[f64]| (three[0] - 2.0 * three[1] + three[2]).abs();
        let mut seconds: Vec<f64> = by_landmark.values().flat_map(|sizes| sizes.windows(3).map(second)).collect();
        seconds.sort_by(f64::total_cmp);
        // The median of |x| is 0.6745 standard deviations; a second difference has six times the variance.
        seconds.get(seconds.len() / 2).map_or(0.0, |median| median / (0.674_489_750_196_081_7 * f64::sqrt(6.0)))
    }

    /// The longest time from one frame with sightings to the next; 0 with fewer than two of them.
    #[must_use]
    pub fn longest_unseen_s(&self) -> f64 {
        let times: Vec<f64> =
            self.frames.iter().filter(|frame| !frame.sightings.is_empty()).map(|frame| frame.t_s).collect();
        times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
    }

    /// Refuses logs with fewer sightings than unknowns.
    ///
    /// # Errors
    /// [`CannotLearn::TooShort`].
    pub fn require(&self, needed: usize) -> Result<(), CannotLearn> {
        let found = self.sightings.len();
        if found < needed { Err(CannotLearn::TooShort { found, needed }) } else { Ok(()) }
    }
}

/// A command as a discrete action.
struct Commanded {
    t_s: f64,
    action: Discrete,
}

fn commands(log: &Log) -> Result<Vec<Commanded>, CannotLearn> {
    if log.commands.is_empty() {
        return Err(CannotLearn::NoCommands);
    }
    let mut commands: Vec<Commanded> = Vec::new();
    for row in log.commands.iter() {
        let (id, attempted) = match row.action {
            Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s } => {
                (id, [ax_m_per_s, ay_m_per_s, atheta_rad_per_s])
            }
            Action::Wheels { id, v_m_per_s, omega_rad_per_s } => (id, [0.0, v_m_per_s, omega_rad_per_s]),
            Action::Pedals { .. } => return Err(CannotLearn::WrongCommands),
        };
        let later = commands.last().is_none_or(|last| last.t_s <= row.t_s);
        if row.t_s.is_finite() && attempted.iter().all(|v| v.is_finite()) && later {
            commands.push(Commanded { t_s: row.t_s, action: Discrete { id, attempted, held_s: 0.0 } });
        }
    }
    if commands.is_empty() { Err(CannotLearn::NoCommands) } else { Ok(commands) }
}

/// Unit of the sightings, and times and values of those that are numbers.
fn sightings(log: &Log, places_needed: bool) -> Result<(Unit, Vec<(f64, Seen)>), CannotLearn> {
    let unit = Unit::of(log)?;
    let places: BTreeMap<u16, [f64; 2]> =
        log.known.landmarks.iter().map(|landmark| (landmark.id, [landmark.x_m, landmark.y_m])).collect();
    let (mut rows, mut last_s) = (Vec::with_capacity(log.sightings.len()), f64::NEG_INFINITY);
    for &row in log.sightings.iter() {
        let landmark = row.landmark;
        let landmark_m = match places.get(&landmark) {
            Some(place) => *place,
            None if places_needed => return Err(CannotLearn::UnknownLandmark { landmark }),
            None => [0.0; 2],
        };
        let seen = Seen { landmark, landmark_m, size: row.size.value(), bearing_rad: row.bearing_rad };
        if row.t_s.is_finite() && row.t_s >= last_s && seen.size.is_finite() && seen.bearing_rad.is_finite() {
            last_s = row.t_s;
            rows.push((row.t_s, seen));
        }
    }
    Ok((unit, rows))
}

/// Times of the frames: those logged, or else of all commands and sightings; from the first command on.
fn times(log: &Log, commands: &[Commanded], seen: &[(f64, Seen)]) -> Result<Vec<f64>, CannotLearn> {
    let mut times: Vec<f64> = match &log.frames {
        Some(frames) => frames.iter().map(|frame| frame.t_s).filter(|t_s| t_s.is_finite()).collect(),
        None => commands.iter().map(|row| row.t_s).chain(seen.iter().map(|row| row.0)).collect(),
    };
    times.retain(|t_s| *t_s >= commands[0].t_s - SAME_S);
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier <= SAME_S);
    if times.is_empty() { Err(CannotLearn::NoSightings) } else { Ok(times) }
}

/// Which command was in force for most of the time from `from_s` to `to_s`; `at` is the one in force at some
/// earlier time, and is moved on.
fn longest(commands: &[Commanded], at: &mut usize, from_s: f64, to_s: f64) -> usize {
    while commands.get(*at + 1).is_some_and(|next| next.t_s <= from_s + SAME_S) {
        *at += 1;
    }
    let (mut best, mut most_s, mut since_s) = (*at, f64::NEG_INFINITY, from_s);
    for i in *at..commands.len() {
        let until_s = commands.get(i + 1).map_or(to_s, |next| if next.t_s < to_s { next.t_s } else { to_s });
        if until_s - since_s > most_s {
            (best, most_s) = (i, until_s - since_s);
        }
        since_s = until_s;
        if until_s >= to_s {
            break;
        }
    }
    best
}

/// The discrete actions met so far.
#[derive(Default)]
struct Held {
    index: BTreeMap<Option<u16>, usize>,
    actions: Vec<Discrete>,
}

impl Held {
    /// Counts an action that was executed for some time, and says its number.
    fn add(&mut self, action: &Discrete, dt_s: f64) -> usize {
        let i = *self.index.entry(action.id).or_insert_with(|| {
            self.actions.push(Discrete { held_s: 0.0, ..*action });
            self.actions.len() - 1
        });
        let mean = &mut self.actions[i];
        mean.held_s += dt_s;
        if mean.held_s > 0.0 {
            for (mean_v, v) in mean.attempted.iter_mut().zip(action.attempted) {
                *mean_v += (v - *mean_v) * dt_s / mean.held_s;
            }
        }
        i
    }

    /// The actions in order of id, those without one last; the frames' numbers are changed to that order.
    fn in_order(self, frames: &mut [Frame]) -> Vec<Discrete> {
        let mut order: Vec<usize> = self.index.iter().filter(|(id, _)| id.is_some()).map(|(_, i)| *i).collect();
        order.extend(self.index.get(&None));
        let mut rank = vec![0; order.len()];
        for (new, old) in order.iter().enumerate() {
            rank[*old] = new;
        }
        for frame in frames {
            frame.action = rank[frame.action];
        }
        order.into_iter().map(|i| self.actions[i]).collect()
    }
}

fn median_step(frames: &[Frame]) -> f64 {
    let mut steps: Vec<f64> = frames.iter().map(|frame| frame.dt_s).filter(|dt_s| *dt_s > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}
