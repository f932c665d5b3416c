//! The figures of chapter 3 of Stronger (2008), out of plain numbers.

use asami_dataset::survey::{Height, Speed};
use asami_math::polynomial::Polynomial;
use asami_math::statistics;

use super::axis::cover;
use super::figure::{Figure, Mark, Stroke};

/// At most this many marks of one series: more are a blot.
const MOST_MARKS: usize = 450;

/// Figure 3.5a: beacon height over time under one constant action, and the cubic fitted to the pairs
/// (o, t) (section 3.2.1): `time_s` of a height in pixels.
#[must_use]
pub fn figure_3_5a(observed_px: &[[f64; 2]], time_s: impl Fn(f64) -> f64) -> Figure {
    let heights = cover(observed_px.iter().map(|[_, o]| *o));
    let cubic = heights.map(|(low, high)| sampled((low, high), &time_s));
    let cubic: Vec<[f64; 2]> = cubic.into_iter().flatten().map(|[o, t]| [t, o]).collect();
    Figure::new("Figure 3.5a", "A sensor model from one constant action")
        .x("time", "s")
        .y("beacon height", "px")
        .points("observations", Mark::Plus, thinned(observed_px))
        .line("best cubic", Stroke::Dashed, cubic)
        .caption(
            "Walking towards the beacon under one constant action, time stands in for place, so that a cubic through \
             the observations is a sensor model up to shift and scale (section 3.2.1). Good: the cubic runs through \
             the middle of the cloud from end to end. A cloud that wanders off the cubic says that the speed was not \
             constant.",
        )
}

/// Figure 3.5b: place by the given action model over beacon height during one cycle, walking forward
/// and backward, with the cubic fitted to all of it (section 3.2.1).
#[must_use]
pub fn figure_3_5b(forward: &[[f64; 2]], backward: &[[f64; 2]], place_of_height: &Polynomial) -> Figure {
    let heights = cover(forward.iter().chain(backward).map(|[o, _]| *o));
    let cubic = heights.map(|range| sampled(range, |o| place_of_height.at(o))).unwrap_or_default();
    Figure::new("Figure 3.5b", "A sensor model from a given action model")
        .x("beacon height", "px")
        .y("place by the action model", "m")
        .points("walking forward", Mark::Plus, thinned(forward))
        .points("walking backward", Mark::Cross, thinned(backward))
        .line("best cubic", Stroke::Solid, cubic)
        .caption(
            "One cycle towards the beacon and back, placed by A(c) = c, which is not quite right: that is why the \
             two branches part, here as in the dissertation. Good: the cubic lies between the branches and flattens \
             as the beacon grows. The gap between the branches is what the action model still has to learn.",
        )
}

/// Figure 3.6: place by a rough sensor model over time, and the place that the action model learned
/// from it gives (eq. 3.2).
#[must_use]
pub fn figure_3_6(by_sensor: &[[f64; 2]], by_action: &[[f64; 2]]) -> Figure {
    Figure::new("Figure 3.6", "An action model from a given sensor model")
        .x("time", "s")
        .y("place", "units of the given sensor model")
        .size(1120, 340)
        .points("by the sensor model", Mark::Plus, thinned(by_sensor))
        .line("by the learned action model", Stroke::Solid, by_action)
        .caption(
            "One cycle, placed by the sensor model that was given, and by the action model that was learned from it: \
             one slope for each command (section 3.2.2, equation 3.2). Good: the line goes through the marks and \
             breaks where the command changes. Marks that stay on one side for seconds say that the command's speed \
             is wrong, or that the robot lags behind its commands.",
        )
}

/// Figure 3.7: place by either model while both are learned.
#[must_use]
pub fn figure_3_7(by_action: &[[f64; 2]], by_sensor: &[[f64; 2]]) -> Figure {
    Figure::new("Figure 3.7", "Both models, learning from each other")
        .x("time", "s")
        .y("place", "units of the learner")
        .size(1120, 340)
        .points("by the sensor model (w_s)", Mark::Plus, thinned(by_sensor))
        .line("by the action model (w_a)", Stroke::Solid, by_action)
        .caption(
            "Algorithm 1 on one log: place by the action model and place by the sensor model. Good: the two come \
             together after the starting phase and stay together. Two curves that drift apart, or shrink towards \
             nothing, are a trial that diverges.",
        )
}

/// Figure 3.8a: measured speeds, and a learned action model after scaling. `learned_m_per_s` maps a
/// command in m/s to a speed in m/s.
#[must_use]
pub fn figure_3_8a(measured: &[Speed], learned_m_per_s: impl Fn(f64) -> f64) -> Figure {
    let points: Vec<[f64; 2]> = measured.iter().map(|it| [1e3 * it.command_m_per_s, 1e3 * it.speed_m_per_s]).collect();
    let commands = cover(points.iter().map(|[c, _]| *c)).unwrap_or((-300.0, 300.0));
    Figure::new("Figure 3.8a", "A learned action model")
        .x("commanded speed", "mm/s")
        .y("speed", "mm/s")
        .points("measured", Mark::Plus, points)
        .curve("learned, scaled", Stroke::Solid, commands, |c_mm| 1e3 * learned_m_per_s(1e-3 * c_mm))
        .caption(
            "Speeds as surveyed, and the action model that Algorithm 1 learned from one log, scaled once to fit. \
             Good: the curve bends where the measurements bend.",
        )
}

/// Figure 3.8b: measured beacon heights, and a learned sensor model after scaling and shifting.
/// `learned_m` maps a height in pixels to a distance in metres.
#[must_use]
pub fn figure_3_8b(measured: &[Height], learned_m: impl Fn(f64) -> f64) -> Figure {
    let points: Vec<[f64; 2]> = measured.iter().map(|it| [it.height_px, 1e3 * it.distance_m]).collect();
    let heights = cover(points.iter().map(|[o, _]| *o)).unwrap_or((10.0, 35.0));
    Figure::new("Figure 3.8b", "A learned sensor model")
        .x("beacon height", "px")
        .y("distance", "mm")
        .points("measured", Mark::Plus, points)
        .curve("learned, scaled and shifted", Stroke::Solid, heights, |o_px| 1e3 * learned_m(o_px))
        .caption(
            "Mean beacon heights at surveyed distances, and the sensor model that Algorithm 1 learned from the same \
             log, scaled and shifted once to fit. Good: the curve goes through the marks, at the near end and the far \
             end too.",
        )
}

/// One half of Figure 3.9: what is plotted, in which unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Learning {
    /// Errors of sensor models in metres.
    Sensor,
    /// Errors of action models in m/s.
    Action,
}

/// Figure 3.9: errors over time, mean of the trials with the middle half of them, above the error of
/// the best polynomial there is. A curve is (seconds, metres or m/s) and holds from point to point.
#[must_use]
pub fn figure_3_9(which: Learning, curves: &[Vec<[f64; 2]>], floor: Option<f64>) -> Figure {
    let (name, title, label, unit) = match which {
        Learning::Sensor => ("Figure 3.9, sensor", "Sensor model, error over time", "sensor error", "mm"),
        Learning::Action => ("Figure 3.9, action", "Action model, error over time", "action error", "mm/s"),
    };
    let spread = spread_over_time(curves);
    let mean: Vec<[f64; 2]> = spread.iter().map(|it| [it.t_s, 1e3 * it.mean]).collect();
    let middle: Vec<[f64; 3]> = spread.iter().map(|it| [it.t_s, 1e3 * it.quartiles.0, 1e3 * it.quartiles.1]).collect();
    let settled = mean.iter().skip(mean.len() / 2).map(|[_, error]| *error);
    let lowest = floor.map_or(0.0, |floor| 1e3 * floor);
    let top = cover(settled).map_or(0.0, |(_, high)| 1.8 * high).max(2.0 * lowest);
    let highest = cover(mean.iter().map(|[_, error]| *error)).map_or(1.0, |(_, high)| 1.06 * high);
    let mut figure = Figure::new(name, title)
        .x("time", "s")
        .y(label, unit)
        .band("middle half of the trials", middle)
        .line(&format!("mean of {} trials", curves.len()), Stroke::Solid, mean)
        .coloured_as(0);
    if let Some(floor) = floor {
        figure = figure.level("best polynomial", 1e3 * floor);
    }
    if top > 0.0 && highest > 0.0 {
        figure = figure.y_range(0.0, top.min(highest).max(1.3 * lowest));
    }
    figure.caption(
        "Errors after scaling, against what was measured. Good: they fall towards the dotted line and stay there; \
         nothing of the same degree can be better. Errors of the first seconds may lie above the frame.",
    )
}

/// Speeds as surveyed over commands, beside the commands themselves.
#[must_use]
pub fn speed_over_command(measured: &[Speed]) -> Figure {
    let mm = |it: &Speed| {
        let [speed, sd] = [it.speed_m_per_s, it.sd_m_per_s];
        [it.command_m_per_s, speed, speed - sd, speed + sd].map(|m_per_s| 1e3 * m_per_s)
    };
    let points: Vec<[f64; 4]> = measured.iter().map(mm).collect();
    let commands = cover(points.iter().map(|[c, ..]| *c)).unwrap_or((-300.0, 300.0));
    Figure::new("Speed", "Speed over command")
        .x("commanded speed", "mm/s")
        .y("speed", "mm/s")
        .error_bars("measured, \u{b1} 1 sd", points)
        .curve("as commanded", Stroke::Dashed, commands, |c| c)
        .caption(
            "Walking speed as timed between two lines, over the speed commanded. The bend is physics: servos reach \
             their speed limit and feet slip. A straight line here would leave an action model nothing to learn.",
        )
}

/// What trials do together at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spread {
    t_s: f64,
    mean: f64,
    quartiles: (f64, f64),
}

/// Mean and quartiles over all curves wherever any has a point, from where all have begun.
fn spread_over_time(curves: &[Vec<[f64; 2]>]) -> Vec<Spread> {
    let begun_s = curves.iter().filter_map(|curve| curve.first()).map(|point| point[0]);
    let Some((_, all_begun_s)) = cover(begun_s) else { return Vec::new() };
    let mut times_s: Vec<f64> =
        curves.iter().flatten().map(|point| point[0]).filter(|t_s| *t_s >= all_begun_s).collect();
    times_s.sort_by(f64::total_cmp);
    // Trials keep their models at about the same times: one point for each such group.
    times_s.dedup_by(|later, earlier| *later - *earlier < 1.0);
    let at = |t_s: f64| {
        let held = curves.iter().filter_map(|curve| {
            let after = curve.partition_point(|point| point[0] <= t_s + 0.5);
            after.checked_sub(1).map(|index| curve[index][1])
        });
        let mut values: Vec<f64> = held.filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let quartiles = (quantile(&values, 0.25)?, quantile(&values, 0.75)?);
        Some(Spread { t_s, mean: statistics::mean(&values)?, quartiles })
    };
    times_s.iter().filter_map(|t_s| at(*t_s)).collect()
}

/// Quantile of sorted values, linear between them (Hyndman and Fan 1996, type 7).
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let at = share * (sorted.len().checked_sub(1)?) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    Some(sorted[low] + (at - low as f64) * (sorted[high] - sorted[low]))
}

fn sampled((from, to): (f64, f64), f: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let at = |i: u32| from + (to - from) * f64::from(i) / 120.0;
    (0..=120).map(|i| [at(i), f(at(i))]).collect()
}

/// Every so-manieth point, so that at most [`MOST_MARKS`] are left.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let every = points.len().div_ceil(MOST_MARKS).max(1);
    points.iter().step_by(every).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::super::figure::Shape;
    use super::*;

    fn series<'a>(figure: &'a Figure, name: &str) -> &'a Shape {
        &figure.series.iter().find(|series| series.name == name).unwrap().shape
    }

    #[test]
    fn the_curve_of_figure_3_5a_is_the_inverse_of_the_model() {
        // o = 10 + 2 t, so that t = (o - 10) / 2.
        let model = Polynomial::plain(vec![-5.0, 0.5]);
        let observed: Vec<[f64; 2]> = (0..2000).map(|i| f64::from(i) * 0.01).map(|t| [t, 10.0 + 2.0 * t]).collect();
        let figure = figure_3_5a(&observed, |o| model.at(o));
        let Shape::Line(Stroke::Dashed, curve) = series(&figure, "best cubic") else { panic!() };
        assert!(curve.iter().all(|[t, o]| (o - 10.0 - 2.0 * t).abs() < 1e-9));
        let Shape::Points(Mark::Plus, marks) = series(&figure, "observations") else { panic!() };
        assert!(marks.len() <= MOST_MARKS && marks.iter().all(|mark| observed.contains(mark)));
    }

    #[test]
    fn learning_curves_average_the_trials_where_all_have_begun() {
        let curves = vec![
            vec![[10.0, 0.4], [20.0, 0.2], [30.0, 0.1]],
            vec![[20.2, 0.4], [30.1, 0.2]],
            vec![[20.1, 0.6], [30.2, f64::NAN]],
        ];
        let spread = spread_over_time(&curves);
        assert_eq!(spread.len(), 2);
        assert!((spread[0].mean - 0.4).abs() < 1e-12 && (spread[1].mean - 0.15).abs() < 1e-12);
        // Type 7 quartiles of 0.2, 0.4, 0.6.
        assert!((spread[0].quartiles.0 - 0.3).abs() < 1e-12 && (spread[0].quartiles.1 - 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_floor_is_always_in_figure_3_9() {
        let flat = |error: f64| vec![(1..30).map(|i| [f64::from(i) * 5.0, error]).collect::<Vec<_>>()];
        for (curves, floor) in
            [(flat(0.07), 0.05), (flat(5.0), 0.05), (flat(0.0), 0.05), (vec![], 0.05), (flat(f64::NAN), 0.05)]
        {
            let (_, (low, high)) = figure_3_9(Learning::Sensor, &curves, Some(floor)).ranges();
            assert!(low <= 50.0 && 50.0 < high, "{low}..{high}");
        }
        let figure = figure_3_9(Learning::Action, &flat(0.03), None);
        assert!((figure.ranges().1.0..figure.ranges().1.1).contains(&30.0));
    }

    #[test]
    fn measured_points_stand_in_millimetres() {
        let speed = Speed { command_m_per_s: 0.3, speed_m_per_s: 0.2, sd_m_per_s: 0.005, timings: 5 };
        let height = Height { distance_m: 1.2, height_px: 31.0, sd_px: 1.0, bearing_sd_rad: 0.02, readings: 100 };
        let speeds = figure_3_8a(&[speed], |c| 0.5 * c);
        let heights = figure_3_8b(&[height], |o| 40.0 / o);
        assert_eq!(*series(&speeds, "measured"), Shape::Points(Mark::Plus, vec![[300.0, 200.0]]));
        assert_eq!(*series(&heights, "measured"), Shape::Points(Mark::Plus, vec![[31.0, 1200.0]]));
        let Shape::Line(_, curve) = series(&speeds, "learned, scaled") else { panic!() };
        assert!(curve.iter().all(|[c, v]| (v - 0.5 * c).abs() < 1e-9));
    }

    #[test]
    fn figures_without_data_are_empty_figures() {
        let none = Polynomial::plain(vec![]);
        for figure in [
            figure_3_5a(&[], |o| none.at(o)),
            figure_3_5b(&[], &[], &none),
            figure_3_6(&[], &[]),
            figure_3_7(&[], &[]),
            figure_3_8a(&[], |_| f64::NAN),
            figure_3_8b(&[], |_| f64::NAN),
            figure_3_9(Learning::Sensor, &[], None),
        ] {
            assert!(figure.svg().contains("no data"), "{}", figure.name);
        }
    }
}
