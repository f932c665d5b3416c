//! A log as the filter walks through it: frames, the rows of the motion's columns, and what was seen.

use asami_dataset::{Frame, Log, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin_cos};

use crate::columns::Columns;
use crate::shape::Sight;

/// A log that cannot be diagnosed, and why.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CannotSee {
    /// Fewer frames than a gap can show in.
    #[error("the log has {frames} frames, {seen} of them with a sighting: at least {least} are needed to say anything")]
    TooShort {
        /// Frames.
        frames: usize,
        /// Frames with a sighting.
        seen: usize,
        /// What is needed.
        least: usize,
    },
    /// Actions that the nominal world's drive never takes.
    #[error("the log has discrete actions that the nominal world does not know: {0:?}")]
    UnknownActions(Vec<u16>),
    /// No pedals.
    #[error("the log has no commands of pedals: what a car would have done meanwhile cannot be played")]
    NoPedals,
    /// A car that hardly moves.
    #[error(
        "the car is under way for {scored} steps of 0.2 s, and for {kept} of those that are set aside: less than {} and {} show nothing",
        least[1], least[0]
    )]
    Stands {
        /// Steps under way that are set aside.
        kept: usize,
        /// Steps under way that are not.
        scored: usize,
        /// Least numbers of both.
        least: [usize; 2],
    },
    /// No library.
    #[error(
        "nothing was played that the log could be held against: a real scanner is held against its own table alone"
    )]
    Unplayed,
    /// The scans of a car say nothing.
    #[error(transparent)]
    Follow(#[from] crate::drive::motion::CannotFollow),
    /// The nominal car cannot be played.
    #[error(transparent)]
    Play(#[from] crate::nominal::CannotPlay),
    /// A landmark nobody declared.
    #[error("the log has a sighting of landmark {0}, which it does not declare")]
    UnknownLandmark(u16),
}

/// One landmark in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Index among the landmarks.
    pub landmark: usize,
    /// Height in pixels, or range in metres.
    pub size: f64,
    /// Counter-clockwise from straight ahead.
    pub bearing_rad: f64,
}

/// One frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Its time.
    pub t_s: f64,
    /// Since the frame before; 0 for the first.
    pub dt_s: f64,
    /// Where the head looks.
    pub pan_rad: f64,
    /// How fast it turns.
    pub pan_rad_per_s: f64,
    /// Velocities attempted meanwhile, in shares of the greatest: right, forward, counter-clockwise.
    pub attempt: [f64; 3],
    /// How much commands change.
    pub changing: f64,
    /// Sightings of it.
    pub seen: std::ops::Range<usize>,
    /// Whether there was a frame, so that a miss is one.
    pub looked: bool,
    /// Whether the robot may go anywhere meanwhile, whatever it was told.
    pub astray: bool,
}

/// A log, ready to be filtered.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Frames in order of time.
    pub steps: Vec<Step>,
    /// Rows of the motion's columns, one after another, each column that is not 0 with its value.
    rows: Vec<(usize, f64)>,
    /// Where the row of each step ends.
    ends: Vec<usize>,
    /// Everything seen, frame by frame.
    pub seen: Vec<Seen>,
    /// Landmarks: world x and y.
    pub landmarks: Vec<[f64; 2]>,
    /// Whether sizes are ranges in metres; heights in pixels else.
    pub ranges: bool,
    /// Whether frames without sightings are in the log, so that a miss says something.
    pub misses: bool,
    /// Whether bearings were measured: where all are the same, on a rail, somebody put them in.
    pub aims: bool,
    /// Where the sensor sits in the robot frame: right, forward. Distances and bearings are from there.
    pub origin_m: [f64; 2],
}

/// Fewer frames with sightings than this say nothing.
pub const LEAST_SEEN: usize = 20;
/// Motion is taken to be straight, and the filter linear, for no longer than this: between frames farther apart steps without
/// one are put in.
const LONGEST_STEP_S: f64 = 0.25;
/// So many at most: after longer, the pose is lost anyhow.
const MOST_STEPS: f64 = 10_000.0;

impl View {
    /// Takes a part of every sighting's size and bearing away.
    pub fn steady(&mut self, of: &[[f64; 2]]) {
        for (seen, [of_size, of_bearing]) in self.seen.iter_mut().zip(of) {
            seen.size -= of_size;
            seen.bearing_rad -= of_bearing;
        }
    }

    /// The view of a log through `columns`.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn new(log: &Log, columns: &Columns) -> Result<Self, CannotSee> {
        let unknown = columns.unknown(&log.commands);
        if !unknown.is_empty() {
            return Err(CannotSee::UnknownActions(unknown));
        }
        let frames = frames(log);
        let mut view = Self {
            steps: Vec::with_capacity(frames.len()),
            rows: Vec::new(),
            ends: Vec::with_capacity(frames.len()),
            seen: Vec::with_capacity(log.sightings.len()),
            landmarks: log.known.landmarks.iter().map(|it| [it.x_m, it.y_m]).collect(),
            ranges: log.sightings.iter().any(|it| matches!(it.size, Size::RangeM(_))),
            misses: log.frames.is_some(),
            aims: log.sightings.windows(2).any(|pair| pair[0].bearing_rad != pair[1].bearing_rad),
            origin_m: log.known.range_bearing.as_ref().map_or([0.0; 2], |it| it.sensor_origin_m),
        };
        let mut held: Vec<(f64, f64)> = Vec::with_capacity(log.sightings.len());
        let mut next = 0;
        let mut row = vec![0.0; columns.len()];
        for (i, (frame, looked)) in frames.iter().enumerate() {
            let before = i.checked_sub(1).map(|before| &frames[before]);
            let dt_s = before.map_or(0.0, |(before, _)| frame.t_s - before.t_s);
            // How fast the head turned while nobody looked is not known.
            let turned = before.filter(|(_, looked)| *looked);
            let turned = turned.map_or(0.0, |(before, _)| frame.head_pan_rad - before.head_pan_rad);
            let attempt = columns.fill(&log.commands, frame.t_s - dt_s, frame.t_s, &held, &mut row);
            view.rows.extend(row.iter().copied().enumerate().filter(|(_, value)| *value != 0.0));
            view.ends.push(view.rows.len());
            let start = view.seen.len();
            while let Some(sighting) = log.sightings.get(next).filter(|it| it.t_s <= frame.t_s + 1e-9) {
                let landmark = log.known.landmarks.iter().position(|it| it.id == sighting.landmark);
                let landmark = landmark.ok_or(CannotSee::UnknownLandmark(sighting.landmark))?;
                view.seen.push(Seen { landmark, size: sighting.size.value(), bearing_rad: sighting.bearing_rad });
                held.push((sighting.t_s, sighting.bearing_rad));
                next += 1;
            }
            view.steps.push(Step {
                t_s: frame.t_s,
                dt_s,
                pan_rad: frame.head_pan_rad,
                pan_rad_per_s: if dt_s > 0.0 { turned / dt_s } else { 0.0 },
                attempt,
                changing: columns.changing(&row),
                seen: start..view.seen.len(),
                looked: *looked,
                astray: false,
            });
        }
        let seen = view.steps.iter().filter(|step| !step.seen.is_empty()).count();
        if seen < LEAST_SEEN {
            let frames = view.steps.iter().filter(|step| step.looked).count();
            return Err(CannotSee::TooShort { frames, seen, least: LEAST_SEEN });
        }
        Ok(view)
    }

    /// How a landmark lies at a step from a pose (world x, world y, heading), moved by so much from where it is said to
    /// stand.
    #[must_use]
    pub fn sight(
        &self,
        step: usize,
        landmark: usize,
        [x_m, y_m, theta_rad]: [f64; 3],
        [moved_x_m, moved_y_m]: [f64; 2],
    ) -> Sight {
        let step = &self.steps[step];
        let [landmark_x_m, landmark_y_m] = self.landmarks[landmark];
        let ([out_x_m, out_y_m], _) = self.out(theta_rad);
        let (dx, dy) = (landmark_x_m + moved_x_m - x_m - out_x_m, landmark_y_m + moved_y_m - y_m - out_y_m);
        let bearing_rad = wrap_rad(atan2(-dx, dy) - theta_rad);
        Sight {
            distance_m: hypot(dx, dy),
            bearing_rad,
            off_rad: self.off_rad(step.pan_rad, bearing_rad),
            pan_rad_per_s: step.pan_rad_per_s,
            theta_rad,
            landmark,
            attempt: step.attempt,
        }
    }

    /// From the body's centre to the sensor, in world axes, at a heading; and how that changes with the heading.
    #[must_use]
    pub fn out(&self, theta_rad: f64) -> ([f64; 2], [f64; 2]) {
        let [right_m, ahead_m] = self.origin_m;
        if self.origin_m == [0.0; 2] {
            return Default::default();
        }
        let (sin, cos) = sin_cos(theta_rad);
        let [x_m, y_m] = [right_m * cos - ahead_m * sin, right_m * sin + ahead_m * cos];
        ([x_m, y_m], [-y_m, x_m])
    }

    /// The angle off the image's centre of a bearing. Where a head looked is in the frames alone; a sensor of ranges looks
    /// straight ahead.
    #[must_use]
    pub fn off_rad(&self, pan_rad: f64, bearing_rad: f64) -> f64 {
        if self.misses || self.ranges { wrap_rad(bearing_rad - pan_rad) } else { 0.0 }
    }

    /// The row of the motion's columns of a step: each that is not 0, with its value, in order.
    #[must_use]
    pub fn row(&self, step: usize) -> &[(usize, f64)] {
        let start = step.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.rows[start..self.ends[step]]
    }
}

/// The log's frames, of a log without one wherever something was seen; between those far apart, steps at which nobody looked.
fn frames(log: &Log) -> Vec<(Frame, bool)> {
    let of_sightings = || {
        let mut times_s: Vec<f64> = log.sightings.iter().map(|it| it.t_s).collect();
        times_s.dedup();
        times_s.into_iter().map(|t_s| Frame { t_s, head_pan_rad: 0.0 }).collect::<Vec<_>>()
    };
    let there = log.frames.as_ref().map_or_else(of_sightings, |frames| frames.to_vec());
    let mut all: Vec<(Frame, bool)> = Vec::with_capacity(there.len());
    for frame in there {
        if let Some((last, _)) = all.last().copied() {
            let gap_s = frame.t_s - last.t_s;
            let between = (gap_s / LONGEST_STEP_S).ceil().clamp(1.0, MOST_STEPS);
            let at = |i: usize| Frame { t_s: last.t_s + gap_s * i as f64 / between, ..last };
            all.extend((1..between as usize).map(|i| (at(i), false)));
        }
        all.push((frame, true));
    }
    all
}

#[cfg(test)]
mod tests {
    use asami_dataset::Sighting;

    use super::*;

    /// What is put in between frames is no frame; all steps together last as long as the log.
    #[test]
    fn steps_are_short_however_far_frames_are_apart() {
        let sighting = |t_s| Sighting { t_s, landmark: 0, size: Size::HeightPx(20.0), bearing_rad: 0.0 };
        let times_s = [0.0, 0.05, 0.3, 1.0, 7.0];
        let log = Log { sightings: times_s.map(sighting).to_vec().into(), ..Log::default() };
        let frames = frames(&log);
        let looked: Vec<f64> = frames.iter().filter(|(_, looked)| *looked).map(|(frame, _)| frame.t_s).collect();
        assert_eq!(looked, times_s);
        // 0.05 and 0.25 s as they are, 0.7 s in three, 6 s in 24.
        assert_eq!(frames.len(), 1 + 1 + 1 + 3 + 24);
        assert!(
            frames.windows(2).all(|pair| (0.0..=LONGEST_STEP_S + 1e-12).contains(&(pair[1].0.t_s - pair[0].0.t_s)))
        );
    }
}
