//! From simulated runs, with their truth, to the numbers of a response.

mod motion;
mod sensor;
#[cfg(test)]
mod tests;

use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;
use rayon::prelude::*;

use crate::columns::{Columns, Group};
use crate::memory::Memory;
use crate::rhythm::{Heard, Rhythm};
use crate::shape::{Numbers, Shape, Sight};
use crate::touch::Touch;
use crate::view::{CannotSee, View};

/// A run: what was logged, and where the robot was at each frame.
struct Run {
    view: View,
    poses: Vec<TruePose>,
}

/// The layout that the logs of a nominal world call for; `None` where no run has a sighting.
#[must_use]
pub fn shape(runs: &[Dataset]) -> Option<Shape> {
    let first = runs.first()?;
    let landmarks = first.log.known.landmarks.len();
    let columns = Columns::new(runs.iter().flat_map(|run| run.log.commands.iter()), landmarks);
    let (mut distances_m, mut offs_rad, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    let (mut ranges, mut looks) = (false, 0.0);
    for run in runs {
        let Ok(run) = Run::new(run, &columns) else { continue };
        ranges |= run.view.ranges;
        for (i, step) in run.view.steps.iter().enumerate() {
            looks += if step.looked { landmarks as f64 } else { 0.0 };
            for seen in &run.view.seen[step.seen.clone()] {
                let sight = run.sight(i, seen.landmark, [0.0; 2]);
                distances_m.push(sight.distance_m);
                offs_rad.push(sight.off_rad.abs());
                sizes.push(seen.size);
            }
        }
    }
    for values in [&mut distances_m, &mut offs_rad, &mut sizes] {
        values.sort_by(f64::total_cmp);
    }
    let at = |values: &[f64], share: f64| values.get(((values.len() as f64 - 1.0) * share) as usize).copied();
    Some(Shape {
        columns,
        landmarks,
        ranges,
        near_far_m: [at(&distances_m, 0.01)?, at(&distances_m, 0.99)?],
        off_rad: at(&offs_rad, 0.99)?,
        sizes: [at(&sizes, 0.0)?, at(&sizes, 1.0)?],
        reported: sizes.len() as f64 / f64::max(looks, 1.0),
    })
}

/// What a fit may change of the response that it starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// Whether motion may change with the time in the log.
    pub wear: bool,
}

/// The same layout with curves of motion as fine as foretells runs best by the others: a gait stalls below some commands, and
/// beyond some it gains nothing.
#[must_use]
pub fn as_fine_as_shown(shape: Shape, runs: &[Dataset]) -> Shape {
    let finer = shape.columns.finer().into_iter().map(|columns| Shape { columns, ..shape.clone() });
    let foreseen = finer.map(|shape| (motion::unforeseen(&shape, &seen(&shape, &Rhythm::default(), runs)), shape));
    let best = foreseen.reduce(|coarse, fine| if fine.0 < coarse.0 { fine } else { coarse });
    best.filter(|_| runs.len() > 1).map_or(shape, |(_, shape)| shape)
}

/// The nominal motion's numbers; those of sensing are 0.
#[must_use]
pub fn motion_alone(shape: &Shape, runs: &[Dataset]) -> Vec<f64> {
    let mut numbers = vec![0.0; shape.len()];
    motion::nominal(shape, &seen(shape, &Rhythm::default(), runs), &mut numbers);
    numbers
}

/// The rhythm in the noise of runs of the nominal world, and the response with all of it in.
#[must_use]
pub fn rhythm(shape: &Shape, runs: &[Dataset]) -> Rhythm {
    let numbers = nominal(shape, &Rhythm::default(), runs);
    let runs = seen(shape, &Rhythm::default(), runs);
    let heard: Vec<Vec<Heard>> = runs.par_iter().map(|run| sensor::heard(shape, run, &numbers)).collect();
    Rhythm::listen(&heard, frame_s(&runs), &numbers)
}

/// The nominal response.
#[must_use]
pub fn nominal(shape: &Shape, rhythm: &Rhythm, runs: &[Dataset]) -> Vec<f64> {
    let runs = seen(shape, rhythm, runs);
    let mut numbers = vec![0.0; shape.len()];
    motion::nominal(shape, &runs, &mut numbers);
    sensor::nominal(shape, &runs, &mut numbers);
    sensor::detection(shape, &runs, &mut numbers);
    numbers
}

/// How the noise of sightings hangs on the noise before it, as runs of the nominal world show.
#[must_use]
pub fn remembered(shape: &Shape, rhythm: &Rhythm, numbers: &[f64], runs: &[Dataset]) -> Memory {
    sensor::memory(shape, &seen(shape, rhythm, runs), numbers)
}

/// The responses to an effect at several sizes, in shares of the greatest, as changes of the nominal one: what the runs
/// do not show to change is left alone, and so is what it cannot `touch`: a share of false sightings would be taken for a bent
/// curve. `smooth` ones change as a parabola in the size.
#[must_use]
pub fn changed(
    shape: &Shape,
    (rhythm, base): (&Rhythm, &[f64]),
    runs: &[(f64, &[Dataset])],
    free: Free,
    touch: Touch,
    smooth: bool,
) -> Vec<Vec<f64>> {
    let runs: Vec<(f64, Vec<Run>)> = runs.iter().map(|(share, runs)| (*share, seen(shape, rhythm, runs))).collect();
    let mut responses = vec![base.to_vec(); runs.len()];
    let moves = touch.changes(Numbers::Motion);
    if moves && smooth {
        motion::changed(shape, &runs, free, &mut responses);
    }
    for (of, numbers) in runs.iter().zip(&mut responses) {
        if moves && !smooth {
            motion::changed(shape, std::slice::from_ref(of), free, std::slice::from_mut(numbers));
        }
        if moves {
            motion::noise(shape, &of.1, true, numbers);
        }
        sensor::changed(shape, &of.1, touch, numbers);
        sensor::detection(shape, &of.1, numbers);
    }
    responses
}

/// The runs as they are seen, with the rhythm taken out.
fn seen(shape: &Shape, rhythm: &Rhythm, runs: &[Dataset]) -> Vec<Run> {
    let seen = |run: &Dataset| {
        let mut run = Run::new(run, &shape.columns).ok()?;
        if !rhythm.is_silent() {
            let of = rhythm.of(&sensor::heard(shape, &run, &rhythm.numbers));
            run.view.steady(&of);
        }
        Some(run)
    };
    runs.par_iter().filter_map(seen).collect()
}

/// Median time from frame to frame.
fn frame_s(runs: &[Run]) -> f64 {
    let steps = runs.iter().flat_map(|run| &run.view.steps);
    let frames_s: Vec<f64> = steps.map(|step| step.dt_s).filter(|dt_s| *dt_s > 0.0).collect();
    asami_math::statistics::median(&frames_s).unwrap_or(0.0)
}

impl Run {
    fn new(run: &Dataset, columns: &Columns) -> Result<Self, CannotSee> {
        let view = View::new(&run.log, columns)?;
        let first = run.truth.track.first().copied();
        let last = run.truth.track.last().copied();
        let at = |t_s: f64| {
            let beyond = if first.is_some_and(|first| t_s < first.t_s) { first } else { last };
            pose_at(&run.truth.track, t_s).or(beyond)
        };
        let none = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let poses = view.steps.iter().map(|step| at(step.t_s).unwrap_or(none)).collect();
        Ok(Self { view, poses })
    }

    /// How a landmark, moved by so much, really lies at a step.
    fn sight(&self, i: usize, landmark: usize, moved: [f64; 2]) -> Sight {
        let TruePose { x_m, y_m, theta_rad, .. } = self.poses[i];
        self.view.sight(i, landmark, [x_m, y_m, theta_rad], moved)
    }

    /// The displacement before a step in the robot's frame, R(-theta) (w' - w), and its row of columns with the
    /// heading's filled in.
    fn moved(&self, i: usize, columns: &Columns, row: &mut Vec<f64>) -> Option<[f64; 3]> {
        let (before, after) = (self.poses.get(i.checked_sub(1)?)?, &self.poses[i]);
        if self.view.steps[i].dt_s <= 0.0 {
            return None;
        }
        let (sin, cos) = sin_cos(before.theta_rad);
        let (dx, dy) = (after.x_m - before.x_m, after.y_m - before.y_m);
        row.clear();
        row.resize(columns.len(), 0.0);
        for &(column, value) in self.view.row(i) {
            row[column] = value;
        }
        let heading = columns.range(Group::Heading).start;
        for i in [heading, heading + 2] {
            row[i + 1] = row[i] * sin;
            row[i] *= cos;
        }
        Some([cos * dx + sin * dy, cos * dy - sin * dx, wrap_rad(after.theta_rad - before.theta_rad)])
    }
}

/// Inner product of a row of columns and their numbers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}
