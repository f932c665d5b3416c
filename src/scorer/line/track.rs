//! True distances and speeds out of a true track.

use asami_dataset::truth::{LONGEST_GAP_S, pose_at};
use asami_dataset::{Channel, Command, Log, Sighting, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{hypot, sin_cos};

use super::Stretch;

/// Length of the stretches over which speeds are averaged.
const STRETCH_S: f64 = 5.0;

/// Observation and true distance of every sighting that the track covers.
pub(super) fn distances(log: &Log, track: &[TruePose]) -> Vec<[f64; 2]> {
    let distance = |sighting: &Sighting| {
        let landmark = log.known.landmarks.iter().find(|landmark| landmark.id == sighting.landmark)?;
        let pose = pose_at(track, sighting.t_s)?;
        Some([sighting.size.value(), hypot(landmark.x_m - pose.x_m, landmark.y_m - pose.y_m)])
    };
    log.sightings.iter().filter_map(distance).collect()
}

/// Every whole stretch of time that the track and the commands cover.
pub(super) fn stretches(log: &Log, track: &[TruePose]) -> Vec<Stretch> {
    let (Some(first), Some(last), Some(command), Some((_, log_end_s))) =
        (track.first(), track.last(), log.commands.first(), log.span_s())
    else {
        return Vec::new();
    };
    let start_s = first.t_s.max(command.t_s);
    let end_s = last.t_s.min(log_end_s);
    // A log cut at t ends with its last row before t: a stretch may lack a twentieth.
    let whole = ((end_s - start_s) / STRETCH_S + 0.05).floor().max(0.0) as usize;
    (0..whole)
        .filter_map(|n| {
            let from_s = start_s + n as f64 * STRETCH_S;
            let to_s = (from_s + STRETCH_S).min(end_s);
            let commands = shares(&log.commands, from_s, to_s)?;
            Some(Stretch { commands, speed_m_per_s: forward_m(track, from_s, to_s)? / (to_s - from_s) })
        })
        .collect()
}

/// The commanded forward speeds in force between two times, and for which share of it.
fn shares(commands: &Channel<Command>, from_s: f64, to_s: f64) -> Option<Vec<[f64; 2]>> {
    let first = commands.partition_point(|command| command.t_s <= from_s).checked_sub(1)?;
    let in_force = commands[first..].iter().take_while(|command| command.t_s < to_s);
    let ends_s = commands[first + 1..].iter().map(|next| next.t_s.min(to_s)).chain([to_s]);
    in_force
        .zip(ends_s)
        .map(|(command, end_s)| {
            Some([command.action.forward_m_per_s()?, (end_s - command.t_s.max(from_s)) / (to_s - from_s)])
        })
        .collect()
}

/// Way made good forward between two times.
fn forward_m(track: &[TruePose], from_s: f64, to_s: f64) -> Option<f64> {
    let first = track.partition_point(|pose| pose.t_s <= from_s);
    let between = track[first..].iter().take_while(|pose| pose.t_s < to_s).copied();
    let path: Vec<TruePose> =
        [pose_at(track, from_s)?].into_iter().chain(between).chain([pose_at(track, to_s)?]).collect();
    let step = |pair: &[TruePose]| {
        if pair[1].t_s - pair[0].t_s > LONGEST_GAP_S {
            return None;
        }
        let (sin, cos) = sin_cos(pair[0].theta_rad + 0.5 * wrap_rad(pair[1].theta_rad - pair[0].theta_rad));
        Some(cos * (pair[1].y_m - pair[0].y_m) - sin * (pair[1].x_m - pair[0].x_m))
    };
    path.windows(2).map(step).sum()
}
