//! Sections 3.2.1 and 3.2.2 of Stronger (2008) on logs: one model out of the other, for Figures 3.5
//! and 3.6.

use asami_dataset::{Log, Timed};
use asami_learners::line::Line;
use asami_math::polynomial::Polynomial;
use asami_math::regression::least_squares;

use crate::draw::Figure;
use crate::draw::axis::cover;
use crate::draw::chapter3::{figure_3_5a, figure_3_5b, figure_3_6};

const SENSOR_DEGREE: usize = 3;
const ACTION_DEGREE: usize = 4;

/// Figures 3.5a, 3.5b and 3.6: `constant` is a log under one action, `pacing` one of walking to and
/// fro. A figure that the logs do not allow is left out.
#[must_use]
pub fn figures(constant: &Log, pacing: &Log) -> Vec<Figure> {
    let mut figures = Vec::new();
    let rough = Line::try_from(constant).ok().and_then(|line| {
        let observed: Vec<[f64; 2]> = line.rows.iter().map(|row| [row.t_s - line.start_s, row.o]).collect();
        let time_of_height = cubic(observed.iter().map(|[t, o]| (*o, *t)))?;
        figures.push(figure_3_5a(&observed, &time_of_height));
        Some(time_of_height)
    });
    let cycle = cycle_s(pacing).map(|span_s| pacing.window(span_s)).and_then(|log| Line::try_from(&log).ok());
    if let Some(cycle) = &cycle {
        figures.extend(sensor_from_action(cycle));
        figures.extend(rough.and_then(|rough| action_from_sensor(cycle, &rough)));
    }
    figures
}

/// From the first turn towards the beacon to the end of the way back: the first full cycle.
fn cycle_s(log: &Log) -> Option<std::ops::Range<f64>> {
    let mut turns: Vec<(f64, bool)> = Vec::new();
    for command in log.commands.iter() {
        let c = command.action.forward_m_per_s().unwrap_or(0.0);
        if c != 0.0 && turns.last().is_none_or(|(_, forward)| *forward != (c > 0.0)) {
            turns.push((command.t_s(), c > 0.0));
        }
    }
    // The first stretch begins wherever the robot was put, so that only the second one is whole.
    let first = (1..turns.len()).find(|i| turns[*i].1)?;
    let end_s = turns.get(first + 2).map_or(log.span_s()?.1, |turn| turn.0);
    (turns.len() > first + 1).then_some(turns[first].0..end_s)
}

/// The best cubic through `(x, y)` points.
fn cubic(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<Polynomial> {
    let (low, high) = cover(points.clone().map(|point| point.0)).filter(|(low, high)| low < high)?;
    Some(Polynomial::fit(points, SENSOR_DEGREE, 0.5 * (low + high), 0.5 * (high - low))?.0)
}

/// Section 3.2.1: regression of the place that `A(c) = c` gives on the observation.
fn sensor_from_action(cycle: &Line) -> Option<Figure> {
    let (mut w_a, mut branches) = (0.0, [Vec::new(), Vec::new()]);
    for (i, row) in cycle.rows.iter().enumerate() {
        let pieces = cycle.pieces(i);
        w_a += pieces.iter().map(|piece| piece.c_m_per_s * piece.dt_s).sum::<f64>();
        let backward = pieces.last().is_some_and(|piece| piece.c_m_per_s < 0.0);
        branches[usize::from(backward)].push([row.o, w_a]);
    }
    let place_of_height = cubic(branches.iter().flatten().map(|[o, w]| (*o, *w)))?;
    Some(figure_3_5b(&branches[0], &branches[1], &place_of_height))
}

/// Section 3.2.2: w_s,t = w_0 + sum_j a_j (dt sum_i c_i^j) (eq. 3.2), the place that `sensor` gives
/// regressed on the cumulated powers of the command.
fn action_from_sensor(cycle: &Line, sensor: &Polynomial) -> Option<Figure> {
    let w_s: Vec<[f64; 2]> = cycle.rows.iter().map(|row| [row.t_s, sensor.at(row.o)]).collect();
    let cumulated = cycle.cumulated_powers(ACTION_DEGREE, cycle.command_scale());
    let regressors: Vec<Vec<f64>> = cumulated.into_iter().map(|sums| [vec![1.0], sums].concat()).collect();
    let rows = regressors.iter().zip(&w_s).map(|(x, [_, w])| (x.clone(), *w));
    let coefficients = least_squares(ACTION_DEGREE + 2, rows).solve()?.coefficients;
    let place = |x: &Vec<f64>| x.iter().zip(&coefficients).map(|(x, c)| x * c).sum::<f64>();
    let walked: Vec<[f64; 2]> = w_s.iter().zip(&regressors).map(|([t_s, _], x)| [*t_s, place(x)]).collect();
    Some(figure_3_6(&w_s, &walked))
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Action, Command, Sighting, Size};

    use super::*;
    use crate::draw::figure::Shape;

    /// A robot that does `speed(c)`, seen as its distance itself: every model is then known.
    fn log(commands: &[(f64, f64)], until_s: f64, speed: impl Fn(f64) -> f64) -> Log {
        let action = |c| Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: c, atheta_rad_per_s: 0.0 };
        let (mut d, mut sightings) = (3.0, Vec::new());
        for i in 0..(until_s * 20.0) as usize {
            let t_s = i as f64 / 20.0;
            sightings.push(Sighting { t_s, landmark: 0, size: Size::HeightPx(40.0 - 10.0 * d), bearing_rad: 0.0 });
            let c = commands.iter().rev().find(|command| command.0 <= t_s + 1e-9).map_or(0.0, |command| command.1);
            d -= 0.05 * speed(c);
        }
        let commands: Vec<Command> =
            commands.iter().map(|(t_s, c)| Command { t_s: *t_s, action: action(*c) }).collect();
        Log { commands: commands.into(), sightings: sightings.into(), ..Log::default() }
    }

    const PACING: [(f64, f64); 7] =
        [(0.0, -0.1), (3.0, 0.2), (6.0, 0.1), (9.0, -0.2), (12.0, -0.1), (15.0, 0.3), (18.0, 0.05)];

    fn line<'a>(figure: &'a Figure, name: &str) -> &'a Vec<[f64; 2]> {
        match &figure.series.iter().find(|series| series.name == name).unwrap().shape {
            Shape::Points(_, points) | Shape::Line(_, points) => points,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_cycle_is_one_way_forward_and_the_way_back() {
        assert_eq!(cycle_s(&log(&PACING, 20.0, |c| c)), Some(3.0..15.0));
        assert_eq!(cycle_s(&log(&PACING[..4], 12.0, |c| c)), Some(3.0..11.95));
        assert_eq!(cycle_s(&log(&PACING[..3], 9.0, |c| c)), None);
        assert_eq!(cycle_s(&Log::default()), None);
    }

    #[test]
    fn models_that_are_learned_without_noise_are_met_exactly() {
        let speed = |c: f64| 0.8 * c - 2.0 * c * c * c;
        let constant = log(&[(0.0, 0.2)], 10.0, speed);
        let figures = figures(&constant, &log(&PACING, 20.0, speed));
        let names: Vec<&str> = figures.iter().map(|figure| figure.name.as_str()).collect();
        assert_eq!(names, ["Figure 3.5a", "Figure 3.5b", "Figure 3.6"]);
        // A straight sensor is a cubic, and four commands leave a quartic free: both fits are exact.
        for [t, o] in line(&figures[0], "best cubic") {
            assert!((o - (10.0 + 10.0 * speed(0.2) * t)).abs() < 1e-6);
        }
        let (marks, walked) =
            (line(&figures[2], "by the sensor model"), line(&figures[2], "by the learned action model"));
        for [t, w] in marks {
            let there = walked.iter().find(|point| point[0] == *t).unwrap();
            assert!((w - there[1]).abs() < 1e-6, "{w} at {t} s, but {}", there[1]);
        }
    }

    #[test]
    fn branches_part_where_the_given_action_model_is_wrong() {
        // Walking back is slower than A(c) = c says: after the cycle, w_a lies behind the place.
        let pacing = log(&PACING, 20.0, |c| if c < 0.0 { 0.5 * c } else { c });
        let figures = figures(&Log::default(), &pacing);
        let (forward, backward) = (line(&figures[0], "walking forward"), line(&figures[0], "walking backward"));
        let at = |branch: &[[f64; 2]], o: f64| {
            branch.iter().min_by(|a, b| (a[0] - o).abs().total_cmp(&(b[0] - o).abs())).unwrap()[1]
        };
        let o = 13.5;
        assert!(at(backward, o) < at(forward, o) - 0.1, "{} and {}", at(backward, o), at(forward, o));
    }
}
