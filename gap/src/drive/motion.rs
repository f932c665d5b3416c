//! How the car moved, by its scans alone.

use asami_dataset::Log;
use asami_math::elementary::atan2;
use asami_scans::{AsOf, CannotScan, Cut, Drive, Matching, Motion, Odometry, Scan, Sensor, angle_median};

/// From one scan to the next.
const INTERVAL_S: f64 = 0.5;
/// Turns out of which the lasers' angles are learned.
const MOST_TURNS: u32 = 40;
/// Slower motions do not tell which way is forward.
const SLOW_M_PER_S: f64 = 2.0;

/// Mean motion from one scan to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// When the earlier scan begins, by the scanner's clock.
    pub t_s: f64,
    /// How much later the later one does.
    pub dt_s: f64,
    /// Forward speed.
    pub v_m_per_s: f64,
    /// Turning rate, counter-clockwise.
    pub omega_rad_per_s: f64,
}

/// What the scans of a log say of motion, and of where the lasers look.
#[derive(Clone, Debug)]
pub struct Moved<'a> {
    /// The firings.
    pub drive: Drive<'a>,
    /// The scans that were matched.
    pub scans: Vec<Scan>,
    /// Where each laser looks at encoder angle 0, counter-clockwise from straight ahead.
    pub angles_rad: Vec<f64>,
    /// Steps that could be matched, in order of time.
    pub steps: Vec<Step>,
}

/// Why nothing is known of the motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CannotFollow {
    /// No scans to speak of.
    #[error(transparent)]
    Scan(#[from] CannotScan),
    /// A car that stands, or scans that do not match.
    #[error(
        "of {scans} scans {matched} were matched, {moving} of them while the car moved faster than 2 m/s: which way is forward does not show"
    )]
    NoWay {
        /// Scans there are.
        scans: usize,
        /// Matched to the one before.
        matched: usize,
        /// Of these, fast enough.
        moving: usize,
    },
}

/// Least number of motions that tell which way is forward.
const LEAST_MOVING: usize = 10;

impl<'a> Moved<'a> {
    /// Finds the lasers' angles and matches scan to scan, half a second apart.
    ///
    /// # Errors
    /// [`CannotFollow`] says what the log lacks.
    pub fn read(log: &'a Log) -> Result<Self, CannotFollow> {
        Self::read_every(log, INTERVAL_S)
    }

    /// The same of scans `interval_s` apart.
    ///
    /// # Errors
    /// [`CannotFollow`] says what the log lacks.
    pub fn read_every(log: &'a Log, interval_s: f64) -> Result<Self, CannotFollow> {
        let drive = Drive::try_from(log)?;
        let sensor = Sensor::graph(20.0, 30.0, 2.0).over(4, 0.1, MOST_TURNS);
        let relative_rad = sensor.learn(&drive)?.angle_rad;
        let scans = drive.scans(interval_s);
        // Half a second apart the ground misleads hardly: .0057 m/s with it, .0055 without.
        let cut = Cut { lowest_m: -1.0, least_slope: 0.0, square_m: 0.1 };
        let matching = Matching::lines(0.1);
        let odometry =
            Odometry { drive: &drive, scans: &scans, angles_rad: &relative_rad, cut, matching, as_of: AsOf::Beginning };
        let motions: Vec<Motion> = odometry.in_motion(&[]).into_iter().flatten().collect();
        let fast = motions.iter().filter(|motion| motion.speed_m_per_s() > SLOW_M_PER_S);
        let ways: Vec<f64> = fast
            .map(|motion| {
                let [x, y] = motion.shift_m();
                atan2(y, x)
            })
            .collect();
        let forward = angle_median(&ways).filter(|_| ways.len() >= LEAST_MOVING);
        let (scanned, matched, moving) = (scans.len(), motions.len(), ways.len());
        let forward = forward.ok_or(CannotFollow::NoWay { scans: scanned, matched, moving })?.angle_rad;
        let step = |motion: &Motion| Step {
            t_s: motion.t_s,
            dt_s: motion.dt_s,
            v_m_per_s: motion.along(forward),
            omega_rad_per_s: motion.turning_rad_per_s(),
        };
        let steps = motions.iter().map(step).collect();
        let angles_rad = relative_rad.iter().map(|angle| angle - forward).collect();
        Ok(Self { drive, scans, angles_rad, steps })
    }
}
