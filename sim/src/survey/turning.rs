//! The velocities that discrete actions lead to (Stronger 2008, section 4.4.1), the sideways and forward ones
//! included, which the dissertation could not measure.

use asami_dataset::survey::Velocity;
use asami_dataset::{Action, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{sin, sin_cos};

use super::{Surveying, Walk};
use crate::drives::hold::Hold;
use crate::world::World;

/// Lets `world` execute `action` for [`Surveying::action_s`] after the run-up.
///
/// The turning rate is the total angular change over the time. The other two are the constant velocity in
/// the robot frame that, together with an even turn, leads to each displacement over
/// [`Surveying::arc_s`], averaged over all such stretches of the walk: within a stretch the body may sway.
#[must_use]
pub fn velocity(world: &mut dyn World, id: u16, action: Action, how: &Surveying) -> Velocity {
    let mut walk = Walk::new(Hold(action));
    let until_s = how.run_up_s + how.action_s;
    walk.until(world, |last, _| last.t_s >= until_s);
    let track = &walk.record.track;
    let steady = &track[track.partition_point(|pose| pose.t_s < how.run_up_s)..];
    let [vx_m_per_s, vy_m_per_s, vtheta_rad_per_s] = mean_velocity(steady, how.arc_s);
    Velocity { action: id, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s }
}

/// Rightward, forward and turning velocity over a track, as [`velocity`] has them.
#[must_use]
pub fn mean_velocity(track: &[TruePose], arc_s: f64) -> [f64; 3] {
    let mut turned_rad = vec![0.0];
    for pair in track.windows(2) {
        turned_rad.push(turned_rad[turned_rad.len() - 1] + wrap_rad(pair[1].theta_rad - pair[0].theta_rad));
    }
    let (mut sum, mut arcs, mut end) = ([0.0; 2], 0.0, 0);
    for (i, from) in track.iter().enumerate() {
        // Times are rounded multiples of the frame's period.
        end += track[end..].iter().take_while(|pose| pose.t_s < from.t_s + arc_s - 1e-6).count();
        let Some(to) = track.get(end) else { break };
        let [right, forward] = along_arc(from, to, turned_rad[end] - turned_rad[i]);
        sum = [sum[0] + right, sum[1] + forward];
        arcs += 1.0;
    }
    let (Some(first), Some(last)) = (track.first(), track.last()) else { return [0.0; 3] };
    let turn = turned_rad[turned_rad.len() - 1] / (last.t_s - first.t_s).max(f64::MIN_POSITIVE);
    let arcs = if arcs > 0.0 { arcs } else { 1.0 };
    [sum[0] / arcs, sum[1] / arcs, turn]
}

/// The rightward and forward velocity that, held together with an even turn of `turned_rad`, leads from
/// one pose to the other: the logarithm of SE(2).
fn along_arc(from: &TruePose, to: &TruePose, turned_rad: f64) -> [f64; 2] {
    let half_rad = 0.5 * turned_rad;
    // The chord points halfway between the two headings, and is shorter than the arc.
    let (sin_chord, cos_chord) = sin_cos(from.theta_rad + half_rad);
    let chord_to_arc = if half_rad.abs() < 1e-6 { 1.0 } else { sin(half_rad) / half_rad };
    let lasted_s = (to.t_s - from.t_s) * chord_to_arc;
    let (dx_m, dy_m) = (to.x_m - from.x_m, to.y_m - from.y_m);
    [(cos_chord * dx_m + sin_chord * dy_m) / lasted_s, (-sin_chord * dx_m + cos_chord * dy_m) / lasted_s]
}
