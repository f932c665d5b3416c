//! Measuring a robot's true models "with a stopwatch and a tape measure" (Stronger 2008, 3.3.2).
//!
//! The surveyor sees where the robot is and what its vision reports, as a person beside the field
//! would; it reads no gait, no effect, nor what became of a command.

use asami_dataset::survey::{Height, Speed};
use asami_dataset::truth::pose_at;
use asami_dataset::{Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, sin_cos};

use crate::drives::hold::Hold;
use crate::world::{Drive, Record, World};

mod turning;

pub use turning::{mean_velocity, velocity};

asami_dataset::parameters! {
    /// What is measured, and how (sections 3.3.2 and 4.4.1).
    pub struct Surveying {
        /// Speeds are measured for commands up to this, either way.
        max_speed_m_per_s: f64 = 0.3, "m/s", 0.01..=1.0;
        /// From one command to the next.
        speed_step_m_per_s: f64 = 0.02, "m/s", 0.001..=1.0;
        /// Times each speed is measured.
        timings: u32 = 5, "1", 1.0..=100.0;
        /// Walked before the first line is crossed and the watch starts.
        run_up_s: f64 = 2.0, "s", 0.0..=30.0;
        /// From the first line to the second.
        course_m: f64 = 4.2, "m", 0.1..=20.0;
        /// Speeds below this are measured over a fixed time instead.
        slow_m_per_s: f64 = 0.08, "m/s", 0.0..=1.0;
        /// That time.
        slow_time_s: f64 = 10.0, "s", 0.5..=100.0;
        /// The end of the course that is nearer to the beacon lies this far from it.
        course_end_m: f64 = 1.0, "m", 0.3..=10.0;
        /// Least distance from body's centre to beacon at which heights are read.
        near_m: f64 = 1.2, "m", 0.3..=20.0;
        /// Greatest.
        far_m: f64 = 3.6, "m", 0.3..=20.0;
        /// From one distance to the next.
        distance_step_m: f64 = 0.2, "m", 0.01..=5.0;
        /// Heights read at each distance.
        readings: u32 = 100, "1", 2.0..=10_000.0;
        /// Times the robot is put back on its mark meanwhile: one that steps in place wanders off it.
        placements: u32 = 1, "1", 1.0..=1000.0;
        /// It stands, or steps, for this long before heights are read.
        stand_s: f64 = 0.0, "s", 0.0..=30.0;
        /// How long each discrete action is executed.
        action_s: f64 = 30.0, "s", 1.0..=600.0;
        /// Velocities of discrete actions are those of arcs that last this long.
        arc_s: f64 = 1.0, "s", 0.05..=10.0;
        /// Seed of the survey's own walks: none of a learner's logs.
        seed: u64 = 900_000, "1", 0.0..=9e15;
    }
}

impl Surveying {
    /// Commanded speeds, in order.
    #[must_use]
    pub fn commands_m_per_s(&self) -> Vec<f64> {
        // Counted in whole steps, so that 0 is exactly 0 and the ends are what was asked for.
        let steps = (self.max_speed_m_per_s / self.speed_step_m_per_s + 1e-9).floor() as i64;
        (-steps..=steps).map(|n| n as f64 * self.max_speed_m_per_s / steps.max(1) as f64).collect()
    }

    /// Distances at which heights are read, in order.
    #[must_use]
    pub fn distances_m(&self) -> Vec<f64> {
        let steps = ((self.far_m - self.near_m) / self.distance_step_m + 1e-9).floor().max(0.0) as u64;
        (0..=steps).map(|n| self.near_m + n as f64 * self.distance_step_m).collect()
    }

    /// How far from the beacon a timed walk begins: room for the run-up and the course ahead of a
    /// robot that walks forward, behind one that walks back.
    #[must_use]
    pub fn start_m(&self, command_m_per_s: f64) -> f64 {
        if command_m_per_s < 0.0 {
            return self.course_end_m;
        }
        self.course_end_m + self.course_m + 1.5 * self.max_speed_m_per_s * self.run_up_s
    }
}

/// What went wrong with a measurement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CannotSurvey {
    /// It neither stood nor arrived.
    #[error("at a command of {command_m_per_s} m/s the robot moved {moved_m} m in {after_s} s and crossed no line")]
    NeverArrived {
        /// The command.
        command_m_per_s: f64,
        /// Along the course.
        moved_m: f64,
        /// Since the watch started.
        after_s: f64,
    },
    /// The beacon is not seen from there.
    #[error("at {distance_m} m only {found} of {wanted} frames showed the beacon")]
    NotSeen {
        /// From body to beacon.
        distance_m: f64,
        /// Readings taken.
        found: usize,
        /// Readings wanted.
        wanted: u32,
    },
}

/// Times one walk of `world` at a commanded speed: over the course, or over a fixed time where it is
/// slow. Speeds are along the heading at the start, forward positive.
///
/// # Errors
/// [`CannotSurvey::NeverArrived`] if it takes three times as long as the slowest walk that is timed
/// over the course should.
pub fn timed_m_per_s(world: &mut dyn World, command_m_per_s: f64, how: &Surveying) -> Result<f64, CannotSurvey> {
    let mut walk = Walk::new(Hold::forward(command_m_per_s));
    let first = walk.until(world, |last, _| last.t_s >= how.run_up_s);
    let Some(first) = first else {
        return Err(CannotSurvey::NeverArrived { command_m_per_s, moved_m: 0.0, after_s: how.run_up_s });
    };
    let ahead = ahead(&first);
    let along = |pose: &TruePose| (pose.x_m - first.x_m) * ahead[0] + (pose.y_m - first.y_m) * ahead[1];

    let slow_end = walk.until(world, |last, _| last.t_s >= first.t_s + how.slow_time_s);
    let slow_end = slow_end.unwrap_or(first);
    let slow_m_per_s = along(&slow_end) / (slow_end.t_s - first.t_s).max(f64::MIN_POSITIVE);
    if slow_m_per_s.abs() < how.slow_m_per_s {
        return Ok(slow_m_per_s);
    }

    let limit_s = first.t_s + 3.0 * how.course_m / how.slow_m_per_s.max(1e-3);
    let end = walk.until(world, |last, _| along(last).abs() >= how.course_m || last.t_s >= limit_s);
    let arrived = end.filter(|end| along(end).abs() >= how.course_m);
    let Some(_) = arrived else {
        let last = end.unwrap_or(slow_end);
        return Err(CannotSurvey::NeverArrived {
            command_m_per_s,
            moved_m: along(&last),
            after_s: last.t_s - first.t_s,
        });
    };
    // The second line may have been crossed before the fixed time was up.
    let track = &walk.record.track;
    let after = track.partition_point(|pose| pose.t_s <= first.t_s || along(pose).abs() < how.course_m);
    let (before, after) = (&track[after - 1], &track[after]);
    let share = (how.course_m - along(before).abs()) / (along(after).abs() - along(before).abs());
    let crossed_s = before.t_s + share * (after.t_s - before.t_s);
    Ok(how.course_m * along(after).signum() / (crossed_s - first.t_s))
}

/// Mean and spread of repeated timings of one command.
#[must_use]
pub fn speed(command_m_per_s: f64, timings_m_per_s: &[f64]) -> Speed {
    let [speed_m_per_s, sd_m_per_s] = mean_and_sd(timings_m_per_s);
    Speed { command_m_per_s, speed_m_per_s, sd_m_per_s, timings: timings_m_per_s.len() as u32 }
}

/// Reads heights and bearings off a robot that was put on a mark `distance_m` from the beacon: as many as fall
/// to each of [`Surveying::placements`], the greater share to the first ones. The robot faces the beacon; bearings are
/// given off the beacon's true direction, for one that steps in place, or swings its head, turns a little.
///
/// # Errors
/// [`CannotSurvey::NotSeen`] if too few frames show it.
pub fn look(
    world: &mut dyn World,
    distance_m: f64,
    placement: u32,
    how: &Surveying,
) -> Result<Vec<Sighting>, CannotSurvey> {
    let wanted = how.readings.saturating_sub(placement).div_ceil(how.placements) as usize;
    let mark = world.pose();
    let [ahead_x, ahead_y] = ahead(&mark);
    let beacon_m = [mark.x_m + distance_m * ahead_x, mark.y_m + distance_m * ahead_y];
    let mut walk = Walk::new(Hold::forward(0.0));
    let is_read = |sighting: &&Sighting| sighting.t_s >= how.stand_s && matches!(sighting.size, Size::HeightPx(_));
    // A beacon that is seen in less than every twentieth frame cannot be surveyed.
    walk.until(world, |_, record| {
        let read = record.seen.sightings.iter().filter(is_read).count();
        read >= wanted || record.seen.frames.iter().filter(|frame| frame.t_s >= how.stand_s).count() >= 20 * wanted
    });
    let Record { seen, track, .. } = walk.record;
    let off_truth = |sighting: &Sighting| {
        let pose = pose_at(&track, sighting.t_s)?;
        let direction_rad = atan2(pose.x_m - beacon_m[0], beacon_m[1] - pose.y_m);
        let bearing_rad = wrap_rad(sighting.bearing_rad - direction_rad + pose.theta_rad);
        Some(Sighting { bearing_rad, ..*sighting })
    };
    let sightings: Vec<Sighting> = seen.sightings.iter().filter(is_read).take(wanted).filter_map(off_truth).collect();
    if sightings.len() < wanted {
        return Err(CannotSurvey::NotSeen { distance_m, found: sightings.len(), wanted: wanted as u32 });
    }
    Ok(sightings)
}

/// Means and spreads of what was read at one distance.
#[must_use]
pub fn height(distance_m: f64, sightings: &[Sighting]) -> Height {
    let heights_px = sightings.iter().filter_map(|sighting| match sighting.size {
        Size::HeightPx(height_px) => Some(height_px),
        Size::RangeM(_) => None,
    });
    let bearings_rad: Vec<f64> = sightings.iter().map(|sighting| sighting.bearing_rad).collect();
    let [height_px, sd_px] = mean_and_sd(&heights_px.collect::<Vec<f64>>());
    let [_, bearing_sd_rad] = mean_and_sd(&bearings_rad);
    Height { distance_m, height_px, sd_px, bearing_sd_rad, readings: sightings.len() as u32 }
}

/// A walk under way, and what was seen of it.
struct Walk {
    drive: Hold,
    record: Record,
}

/// Nobody holds a stopwatch for longer.
const PATIENCE_S: f64 = 600.0;

impl Walk {
    fn new(drive: Hold) -> Self {
        Self { drive, record: Record::default() }
    }

    /// Walks on until the newest pose and the record are as wanted; that pose, or the last before
    /// patience ran out.
    fn until(&mut self, world: &mut dyn World, mut done: impl FnMut(&TruePose, &Record) -> bool) -> Option<TruePose> {
        let end_s = world.t_s() + PATIENCE_S;
        while world.t_s() < end_s {
            if let Some(last) = self.record.track.last()
                && done(last, &self.record)
            {
                break;
            }
            let action = self.drive.act(world.t_s(), &self.record.seen);
            world.tick(action, &mut self.record);
        }
        self.record.track.last().copied()
    }
}

/// Unit vector straight ahead of a robot: theta = 0 faces +y.
fn ahead(pose: &TruePose) -> [f64; 2] {
    let (sin, cos) = sin_cos(pose.theta_rad);
    [-sin, cos]
}

fn mean_and_sd(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>();
    [mean, if values.len() < 2 { 0.0 } else { (squares / (n - 1.0)).sqrt() }]
}

#[cfg(test)]
mod tests;
