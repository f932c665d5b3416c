//! What the robot knows: its commands and its observations, with times.

use std::ops::{Deref, Range};
use std::sync::Arc;

use crate::firings::Firings;

/// A row with a time.
pub trait Timed {
    /// Seconds since the log began.
    fn t_s(&self) -> f64;
}

/// Rows in order of time, shared: windows and clones copy no row.
#[derive(Debug)]
pub struct Channel<T> {
    rows: Arc<Vec<T>>,
    of: Range<usize>,
}

impl<T> Clone for Channel<T> {
    fn clone(&self) -> Self {
        Self { rows: Arc::clone(&self.rows), of: self.of.clone() }
    }
}

impl<T> Default for Channel<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> From<Vec<T>> for Channel<T> {
    fn from(rows: Vec<T>) -> Self {
        let of = 0..rows.len();
        Self { rows: Arc::new(rows), of }
    }
}

impl<T> Deref for Channel<T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        &self.rows[self.of.clone()]
    }
}

impl<T: PartialEq> PartialEq for Channel<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Timed> Channel<T> {
    /// The rows with `span_s.start <= t < span_s.end`.
    #[must_use]
    pub fn window(&self, span_s: &Range<f64>) -> Self {
        let index = |t_s: f64| self.of.start + self.partition_point(|row| row.t_s() < t_s);
        let start = index(span_s.start);
        Self { rows: Arc::clone(&self.rows), of: start..index(span_s.end).max(start) }
    }
}

/// What is commanded (the dissertation's `c_t`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Attempted velocities of a legged robot: right, forward, counter-clockwise.
    Legs {
        /// Which of the discrete actions this is, where the robot has a list of them.
        id: Option<u16>,
        /// Attempted rightward velocity.
        ax_m_per_s: f64,
        /// Attempted forward velocity.
        ay_m_per_s: f64,
        /// Attempted turning rate, counter-clockwise.
        atheta_rad_per_s: f64,
    },
    /// Pedals and steering wheel of a car.
    Pedals {
        /// 0 to 1.
        throttle: f64,
        /// 0 to 1.
        brake: f64,
        /// -1 to 1, left positive.
        steering: f64,
    },
    /// Commanded velocities of a wheeled robot.
    Wheels {
        /// Which of the discrete actions this is, where commands were binned into a list of them.
        id: Option<u16>,
        /// Forward speed.
        v_m_per_s: f64,
        /// Turning rate, counter-clockwise.
        omega_rad_per_s: f64,
    },
}

impl Action {
    /// The commanded forward speed in m/s of a robot that has one; `None` for pedals.
    #[must_use]
    pub fn forward_m_per_s(&self) -> Option<f64> {
        self.velocity().map(|[forward_m_per_s, _]| forward_m_per_s)
    }

    /// Commanded forward speed in m/s and turning rate in rad/s; pedals command neither.
    #[must_use]
    pub fn velocity(&self) -> Option<[f64; 2]> {
        match *self {
            Action::Legs { ay_m_per_s, atheta_rad_per_s, .. } => Some([ay_m_per_s, atheta_rad_per_s]),
            Action::Wheels { v_m_per_s, omega_rad_per_s, .. } => Some([v_m_per_s, omega_rad_per_s]),
            Action::Pedals { .. } => None,
        }
    }
}

/// One row of `commands.csv`: the action from `t_s` until the next row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Seconds since the log began.
    pub t_s: f64,
    /// What is commanded from then on.
    pub action: Action,
}

/// One sensor frame, also where nothing was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Seconds since the log began.
    pub t_s: f64,
    /// Head pan as the robot reads it, counter-clockwise; 0 if the sensor is fixed.
    pub head_pan_rad: f64,
}

/// How large or how far a landmark looked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Height in the image, pixels.
    HeightPx(f64),
    /// Measured distance, metres.
    RangeM(f64),
}

impl Size {
    /// The number, in pixels or metres.
    #[must_use]
    pub fn value(&self) -> f64 {
        match *self {
            Size::HeightPx(value) | Size::RangeM(value) => value,
        }
    }
}

/// One landmark seen in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Seconds since the log began; the time of its frame.
    pub t_s: f64,
    /// Which landmark: an id out of [`Known::landmarks`].
    pub landmark: u16,
    /// Height or range.
    pub size: Size,
    /// From the body's straight ahead, counter-clockwise, in `[-pi, pi)`.
    pub bearing_rad: f64,
}

/// The robot's own measurement of its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry {
    /// Seconds since the log began.
    pub t_s: f64,
    /// Forward speed.
    pub v_m_per_s: f64,
    /// Turning rate, counter-clockwise.
    pub omega_rad_per_s: f64,
}

macro_rules! timed { ($($T:ty),*) => { $(impl Timed for $T { fn t_s(&self) -> f64 { self.t_s } })* } }
timed!(Command, Frame, Sighting, Odometry);

/// Geometry of a camera that the robot knows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Image width.
    pub width_px: u32,
    /// Image height.
    pub height_px: u32,
    /// Focal length in (square) pixels.
    pub focal_px: f64,
    /// Frames a second.
    pub frame_rate_hz: f64,
}

/// A sensor that measures range and bearing of landmarks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeBearing {
    /// No landmark beyond this is reported.
    pub max_range_m: f64,
    /// Where the sensor sits in the robot frame: right, forward.
    pub sensor_origin_m: [f64; 2],
}

/// A landmark whose place the robot knows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beacon {
    /// Its name in sightings.
    pub id: u16,
    /// World x.
    pub x_m: f64,
    /// World y.
    pub y_m: f64,
    /// Height of its body, where the sensor measures heights.
    pub height_m: Option<f64>,
}

/// What stands in `commands.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CommandsAre {
    /// What the robot was told.
    #[default]
    Told,
    /// What its wheels were measured to do: odometry stands in for commands that nobody wrote down.
    Odometry,
}

/// What the robot knows before it moves: `dataset.toml` less its provenance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// `aibo`, `car`, `create` or `plain`.
    pub robot: String,
    /// The scenario whose world is the nominal one.
    pub nominal: Option<String>,
    /// How often the controller looks at the command.
    pub command_rate_hz: Option<f64>,
    /// What commands are.
    pub commands_are: CommandsAre,
    /// The camera, of a robot that has one.
    pub camera: Option<Camera>,
    /// The range-bearing sensor, of a robot that has one.
    pub range_bearing: Option<RangeBearing>,
    /// Landmarks, in order of id.
    pub landmarks: Vec<Beacon>,
    /// The laser scanner, of a robot that has one.
    pub velodyne: Option<Velodyne>,
    /// What 1.0 of a pedal meant, where an importer scaled it: name and value, in order of name.
    pub full_scale: Vec<(String, f64)>,
}

/// What the robot knows of its laser scanner: never the horizontal angles.
#[derive(Clone, Debug, PartialEq)]
pub struct Velodyne {
    /// One per laser, increasing.
    pub vertical_angles_rad: Vec<f64>,
    /// Firings of one laser a second.
    pub firing_rate_hz: f64,
    /// Revolutions a second.
    pub turn_rate_hz: f64,
    /// Height above ground.
    pub sensor_height_m: f64,
    /// How far each laser stands to the left of where it looks, off the axis of turning; empty: none does.
    pub left_m: Vec<f64>,
    /// How far each stands above where their table takes them to meet; empty: none does.
    pub up_m: Vec<f64>,
}

/// Everything that the robot knows. Channels that a robot lacks are empty, or `None` where an empty
/// channel would say something else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Known before it moved.
    pub known: Arc<Known>,
    /// Actions, each held until the next.
    pub commands: Channel<Command>,
    /// Sensor frames; `None`: misses are unknown.
    pub frames: Option<Channel<Frame>>,
    /// Landmarks seen.
    pub sightings: Channel<Sighting>,
    /// Own motion measured, if at all.
    pub odometry: Channel<Odometry>,
    /// What a laser scanner recorded, of a robot that has one.
    pub firings: Option<Arc<Firings>>,
}

impl Log {
    /// The part of the log with `span_s.start <= t < span_s.end`, times unchanged; the command in
    /// force at the start is kept, from the start on. Firings are copied where the span cuts any off.
    #[must_use]
    pub fn window(&self, span_s: Range<f64>) -> Log {
        let mut commands = self.commands.window(&span_s);
        if commands.first().is_none_or(|first| first.t_s > span_s.start) {
            let before = self.commands.partition_point(|row| row.t_s < span_s.start);
            if let Some(held) = before.checked_sub(1).map(|i| self.commands[i]) {
                let held = Command { t_s: span_s.start, ..held };
                commands = std::iter::once(held).chain(commands.iter().copied()).collect::<Vec<_>>().into();
            }
        }
        Log {
            known: Arc::clone(&self.known),
            commands,
            frames: self.frames.as_ref().map(|frames| frames.window(&span_s)),
            sightings: self.sightings.window(&span_s),
            odometry: self.odometry.window(&span_s),
            firings: self.firings.as_ref().map(|firings| {
                let within = firings.within(&span_s);
                if within == (0..firings.len()) { Arc::clone(firings) } else { Arc::new(firings.part(within)) }
            }),
        }
    }

    /// Its two halves, as long as each other.
    #[must_use]
    pub fn halves(&self) -> [Log; 2] {
        let (first_s, last_s) = self.span_s().unwrap_or_default();
        let middle_s = 0.5 * (first_s + last_s);
        [self.window(f64::NEG_INFINITY..middle_s), self.window(middle_s..f64::INFINITY)]
    }

    /// Times of the first and last row of any channel; `None` for an empty log.
    #[must_use]
    pub fn span_s(&self) -> Option<(f64, f64)> {
        let ends = [
            ends(&self.commands),
            self.frames.as_ref().and_then(|frames| ends(frames)),
            ends(&self.sightings),
            ends(&self.odometry),
            self.firings.as_ref().and_then(|firings| Some((*firings.t_s.first()?, *firings.t_s.last()?))),
        ];
        ends.into_iter().flatten().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

fn ends<T: Timed>(rows: &[T]) -> Option<(f64, f64)> {
    Some((rows.first()?.t_s(), rows.last()?.t_s()))
}
