//! Commands of a wheeled robot, which take any value, binned into discrete actions; and what these actions really do,
//! out of a motion capture.

use std::collections::BTreeMap;

use asami_dataset::parameters::Fault;
use asami_dataset::survey::Velocity;
use asami_dataset::truth::pose_at;
use asami_dataset::{Action, Command, Log, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;
use serde::{Deserialize, Serialize};

/// `[binning]`: bands of forward speed, each cut into bands of turning rate. A cell of them is an action, whose id is
/// the number of its band of speed times the greatest number of bands of turning rate, plus the number of its band of
/// turning rate; both count from 0, upwards.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Binning {
    /// Commands act so much later than they are given; absent: at once.
    pub delay_s: Option<f64>,
    /// What an action really does is measured from so long after it began, as a stopwatch would be started on a robot
    /// that moves steadily; absent: from its beginning.
    pub settle_s: Option<f64>,
    /// Commands are averaged over steps of this length first; absent: they are taken as they are.
    pub step_s: Option<f64>,
    /// So many bands of forward speed, in force for equal times.
    pub v_cells: Option<u16>,
    /// In its place: where a band ends and the next begins.
    pub v_edges_m_per_s: Option<Vec<f64>>,
    /// So many bands of turning rate, in force for equal times within each band of speed.
    pub omega_cells: Option<u16>,
    /// In its place: where a band ends and the next begins, in every band of speed.
    pub omega_edges_rad_per_s: Option<Vec<f64>>,
}

/// More bands than any log can tell apart.
const MOST_CELLS: u16 = 64;

/// Actions that motion capture saw for less have no true velocity, s: each had "roughly four times
/// ... five seconds at a time" in section 4.4.1.
const LEAST_S: f64 = 20.0;

/// Times closer than this are one time.
const SAME_S: f64 = 1e-6;

impl Binning {
    /// Adds a fault for everything that is wrong; `path` is the table's place in the file.
    pub fn check(&self, path: &str, faults: &mut Vec<Fault>) {
        let mut fault = |key: &str, message: String| faults.push(Fault { path: format!("{path}.{key}"), message });
        if let Some(step_s) = self.step_s.filter(|step_s| !(0.001..=10.0).contains(step_s)) {
            fault("step_s", format!("step_s must lie in 0.001..=10 s, not {step_s}"));
        }
        for (key, time_s) in [("delay_s", self.delay_s), ("settle_s", self.settle_s)] {
            if let Some(time_s) = time_s.filter(|time_s| !(0.0..=5.0).contains(time_s)) {
                fault(key, format!("{key} must lie in 0..=5 s, not {time_s}"));
            }
        }
        let bands = [
            ("v_cells", self.v_cells, "v_edges_m_per_s", &self.v_edges_m_per_s),
            ("omega_cells", self.omega_cells, "omega_edges_rad_per_s", &self.omega_edges_rad_per_s),
        ];
        for (cells_key, cells, edges_key, edges) in bands {
            if cells.is_some() == edges.is_some() {
                let found = if cells.is_some() { "both are" } else { "neither is" };
                fault(cells_key, format!("a binning must have {cells_key} or {edges_key}; {found} given"));
            }
            if let Some(cells) = cells.filter(|cells| !(1..=MOST_CELLS).contains(cells)) {
                fault(cells_key, format!("{cells_key} must lie in 1..={MOST_CELLS}, not {cells}"));
            }
            if let Some(edges) = edges
                && !(edges.iter().all(|edge| edge.is_finite()) && edges.windows(2).all(|pair| pair[0] < pair[1]))
            {
                fault(edges_key, format!("{edges_key} must be numbers that increase, not {edges:?}"));
            }
            if let Some(edges) = edges.as_ref().filter(|edges| edges.len() >= usize::from(MOST_CELLS)) {
                fault(edges_key, format!("{edges_key} must be fewer than {MOST_CELLS}, not {}", edges.len()));
            }
        }
    }

    /// The log with an action in each command of wheels; other commands stay as they are.
    #[must_use]
    pub fn binned(&self, log: &Log) -> Log {
        let delay_s = self.delay_s.unwrap_or_default();
        let acting: Vec<Command> =
            log.commands.iter().map(|command| Command { t_s: command.t_s + delay_s, ..*command }).collect();
        let end_s = log.span_s().map_or(0.0, |(_, end_s)| end_s);
        let mut driven = driven(&acting, end_s);
        if let Some(step_s) = self.step_s {
            driven = averaged(&driven, step_s);
        }
        if driven.is_empty() {
            return log.clone();
        }
        let speeds = driven.iter().map(|it| (it.v_m_per_s, it.held_s));
        let v_edges = edges(&self.v_edges_m_per_s, self.v_cells, speeds);
        let omega_edges: Vec<Vec<f64>> = (0..=v_edges.len())
            .map(|v_band| {
                let inside = driven.iter().filter(|it| band(&v_edges, it.v_m_per_s) == v_band);
                let turns = inside.map(|it| (it.omega_rad_per_s, it.held_s));
                edges(&self.omega_edges_rad_per_s, self.omega_cells, turns)
            })
            .collect();
        let most = omega_edges.iter().map(|edges| edges.len() + 1).max().unwrap_or(1);
        let command = |it: &Driven| {
            let v_band = band(&v_edges, it.v_m_per_s);
            let id = v_band * most + band(&omega_edges[v_band], it.omega_rad_per_s);
            let Driven { t_s, v_m_per_s, omega_rad_per_s, .. } = *it;
            Command { t_s, action: Action::Wheels { id: u16::try_from(id).ok(), v_m_per_s, omega_rad_per_s } }
        };
        Log { commands: driven.iter().map(command).collect::<Vec<_>>().into(), ..log.clone() }
    }
}

/// A command of wheels and how long it was in force.
#[derive(Clone, Copy)]
struct Driven {
    t_s: f64,
    held_s: f64,
    v_m_per_s: f64,
    omega_rad_per_s: f64,
}

/// The commands, if they are of wheels.
fn driven(commands: &[Command], end_s: f64) -> Vec<Driven> {
    let ends_s = commands.iter().skip(1).map(|next| next.t_s).chain([end_s]);
    let wheels = |(command, end_s): (&Command, f64)| match command.action {
        Action::Wheels { v_m_per_s, omega_rad_per_s, .. } => {
            let held_s = (end_s - command.t_s).max(0.0);
            Some(Driven { t_s: command.t_s, held_s, v_m_per_s, omega_rad_per_s })
        }
        Action::Legs { .. } | Action::Pedals { .. } => None,
    };
    commands.iter().zip(ends_s).filter_map(wheels).collect()
}

/// Means over steps of equal length from the first command on; the last may be cut short.
fn averaged(driven: &[Driven], step_s: f64) -> Vec<Driven> {
    let (Some(first), Some(last)) = (driven.first(), driven.last()) else { return Vec::new() };
    let end_s = last.t_s + last.held_s;
    let steps = ((end_s - first.t_s) / step_s).ceil().max(1.0) as usize;
    let mut at = 0;
    (0..steps)
        .map(|n| {
            let from_s = first.t_s + n as f64 * step_s;
            let to_s = (first.t_s + (n + 1) as f64 * step_s).min(end_s);
            while driven.get(at + 1).is_some_and(|next| next.t_s <= from_s) {
                at += 1;
            }
            let (mut way_m, mut turn_rad) = (0.0, 0.0);
            for it in driven[at..].iter().take_while(|it| it.t_s < to_s) {
                let share_s = ((it.t_s + it.held_s).min(to_s) - it.t_s.max(from_s)).max(0.0);
                way_m += it.v_m_per_s * share_s;
                turn_rad += it.omega_rad_per_s * share_s;
            }
            let held_s = to_s - from_s;
            match held_s > 0.0 {
                true => Driven { t_s: from_s, held_s, v_m_per_s: way_m / held_s, omega_rad_per_s: turn_rad / held_s },
                false => Driven { t_s: from_s, held_s: 0.0, ..driven[at] },
            }
        })
        .collect()
}

/// The edges given; or those that cut `values`, each with a time, into so many bands of most nearly equal time. A
/// value that is in force for long stays in one band, and there may be fewer bands then.
fn edges(given: &Option<Vec<f64>>, cells: Option<u16>, values: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    if let Some(edges) = given {
        return edges.clone();
    }
    let mut values: Vec<(f64, f64)> = values.collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Each value once, with the time during which it or less was in force.
    let (mut upto, mut all_s): (Vec<(f64, f64)>, f64) = (Vec::new(), 0.0);
    for (value, held_s) in values {
        all_s += held_s;
        upto.pop_if(|last| last.0 == value);
        upto.push((value, all_s));
    }
    let cells = cells.unwrap_or(1);
    let mut edges = Vec::new();
    for k in 1..cells {
        let wanted_s = all_s * f64::from(k) / f64::from(cells);
        let after = upto.partition_point(|(_, upto_s)| *upto_s < wanted_s).min(upto.len().saturating_sub(1));
        let before = after.checked_sub(1).filter(|before| wanted_s - upto[*before].1 < upto[after].1 - wanted_s);
        edges.extend(upto.get(before.unwrap_or(after)).map(|(value, _)| *value));
    }
    edges.dedup();
    // Above the greatest value there is nothing.
    edges.retain(|edge| upto.last().is_some_and(|(most, _)| edge < most));
    edges
}

/// The band that holds `value`: an edge belongs to the band below.
fn band(edges: &[f64], value: f64) -> usize {
    edges.partition_point(|edge| *edge < value)
}

/// The mean velocity in the robot's frame while each action was in force, from `settle_s` after it began, by the true
/// track, in order of action; without actions that the track covers for less than 20 s.
///
/// A displacement is turned into the robot's frame by the mean of its headings before and after: exact for arcs, but
/// for the chord's being shorter by the 24th part of the turn squared.
#[must_use]
pub fn velocities(log: &Log, track: &[TruePose], settle_s: f64) -> Vec<Velocity> {
    let mut moved: BTreeMap<u16, ([f64; 3], f64)> = BTreeMap::new();
    let mut began = (None, f64::NEG_INFINITY);
    for pair in log.commands.windows(2) {
        let (Action::Wheels { id, .. } | Action::Legs { id, .. }) = pair[0].action else { continue };
        if began.0 != Some(id) {
            began = (Some(id), pair[0].t_s);
        }
        if pair[0].t_s < began.1 + settle_s - SAME_S {
            continue;
        }
        let (Some(id), Some(a), Some(b)) = (id, pose_at(track, pair[0].t_s), pose_at(track, pair[1].t_s)) else {
            continue;
        };
        let turn_rad = wrap_rad(b.theta_rad - a.theta_rad);
        let (sin, cos) = sin_cos(a.theta_rad + 0.5 * turn_rad);
        let (x_m, y_m) = (b.x_m - a.x_m, b.y_m - a.y_m);
        let (sum, seen_s) = moved.entry(id).or_default();
        for (sum, step) in sum.iter_mut().zip([cos * x_m + sin * y_m, cos * y_m - sin * x_m, turn_rad]) {
            *sum += step;
        }
        *seen_s += pair[1].t_s - pair[0].t_s;
    }
    let velocity = |(action, ([x_m, y_m, turn_rad], seen_s)): (u16, ([f64; 3], f64))| Velocity {
        action,
        vx_m_per_s: x_m / seen_s,
        vy_m_per_s: y_m / seen_s,
        vtheta_rad_per_s: turn_rad / seen_s,
    };
    moved.into_iter().filter(|(_, (_, seen_s))| *seen_s >= LEAST_S).map(velocity).collect()
}

#[cfg(test)]
mod tests;
