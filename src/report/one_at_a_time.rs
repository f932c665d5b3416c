//! Sections 3.2.1 and 3.2.2 of Stronger (2008) on logs: one model out of the other, for Figures 3.5
//! and 3.6.

use asami_dataset::{Log, Models, Seed, SensorModel, Timed};
use asami_learners::{Learned, Learners};

use crate::draw::Figure;
use crate::draw::chapter3::{figure_3_5a, figure_3_5b, figure_3_6};
use crate::scenario::Start;

/// Figures 3.5a, 3.5b and 3.6: `constant` is a log under one action, `pacing` one of walking to and
/// fro. A figure that the logs do not allow is left out.
#[must_use]
pub fn figures(constant: &Log, pacing: &Log) -> Vec<Figure> {
    let rough = learned("sensor_constant_action", constant, &Models::default());
    let cycle = cycle_s(pacing).map(|span_s| pacing.window(span_s)).unwrap_or_default();
    let start = Start::C.models().unwrap_or_default();
    let from_action = learned("sensor_from_action", &cycle, &start);
    let from_sensor = rough.as_ref().and_then(|rough| learned("action_from_sensor", &cycle, &rough.models));
    let figures = [
        rough.and_then(|rough| sensor_from_constant_action(constant, &rough)),
        from_action.and_then(|learned| sensor_from_action(&cycle, &learned)),
        from_sensor.map(|learned| figure_3_6(trace(&learned, "w_s"), trace(&learned, "w_a"))),
    ];
    figures.into_iter().flatten().collect()
}

fn learned(learner: &str, log: &Log, given: &Models) -> Option<Learned> {
    let learner = Learners::default().configured(learner, &Default::default()).ok()?;
    learner.learn(log, given, &mut Seed(0).stream("report")).ok()
}

fn trace<'a>(learned: &'a Learned, name: &str) -> &'a [[f64; 2]] {
    learned.traces.iter().find(|trace| trace.name == name).map_or(&[], |trace| &trace.points)
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

/// Figure 3.5a out of places S(o) = c t: the command turns them back into times.
fn sensor_from_constant_action(log: &Log, learned: &Learned) -> Option<Figure> {
    let Some(SensorModel::DistanceOfHeight(curve)) = &learned.models.sensor else { return None };
    let c_m_per_s = log.commands.first()?.action.forward_m_per_s()?;
    let first_s = trace(learned, "w_a").first()?[0];
    let seen = log.sightings.iter().filter(|sighting| sighting.t_s >= first_s);
    let observed: Vec<[f64; 2]> = seen.map(|sighting| [sighting.t_s - first_s, sighting.size.value()]).collect();
    Some(figure_3_5a(&observed, |o| curve.polynomial.at(o) / c_m_per_s))
}

/// Figure 3.5b: each observation beside its place, by the direction of the command in force.
fn sensor_from_action(log: &Log, learned: &Learned) -> Option<Figure> {
    let Some(SensorModel::DistanceOfHeight(curve)) = &learned.models.sensor else { return None };
    let mut branches = [Vec::new(), Vec::new()];
    for [t_s, w_a] in trace(learned, "w_a") {
        let seen = &log.sightings[log.sightings.partition_point(|sighting| sighting.t_s < *t_s)..];
        let held = log.commands.partition_point(|command| command.t_s < *t_s).saturating_sub(1);
        let c = log.commands.get(held).and_then(|command| command.action.forward_m_per_s());
        if let Some(sighting) = seen.first() {
            branches[usize::from(c.is_some_and(|c| c < 0.0))].push([sighting.size.value(), *w_a]);
        }
    }
    Some(figure_3_5b(&branches[0], &branches[1], &curve.polynomial))
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
        for [t, o] in line(&figures[0], "observations").iter().chain(line(&figures[0], "best cubic")) {
            // The learner's stretch begins with the second observation.
            assert!((o - (10.0 + 10.0 * speed(0.2) * (t + 0.05))).abs() < 1e-6);
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
