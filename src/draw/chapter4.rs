//! The figures of chapter 4 of Stronger (2008), out of plain numbers.

use asami_math::statistics::median;

use super::axis::cover;
use super::figure::{Figure, Mark, Stroke};

/// Figures 4.2 and 4.4a: log-likelihood over iterations.
#[must_use]
pub fn likelihood(name: &str, nats: &[[f64; 2]]) -> Figure {
    Figure::new(name, "Log-likelihood over iterations")
        .x("iteration", "")
        .y("log-likelihood", "nats")
        .line("log-likelihood", Stroke::Solid, nats)
        .caption(
            "Log-likelihood of the models of each iteration, on the first log. Good: it rises steeply, then levels \
             off; small dips are the price of drawing one sample a frame. A long slope at the end says that iterations \
             stopped too early. Magnitudes hang on the units, px (or m) and rad.",
        )
}

/// Figure 4.4b: errors of the velocities over iterations, right and forward in m/s.
#[must_use]
pub fn velocity_errors(name: &str, right: &[[f64; 2]], forward: &[[f64; 2]]) -> Figure {
    let mm = |points: &[[f64; 2]]| points.iter().map(|[i, error]| [*i, 1e3 * error]).collect::<Vec<_>>();
    Figure::new(name, "Velocity errors over iterations")
        .x("iteration", "")
        .y("RMS error", "mm/s")
        .y_from_zero()
        .line("v_x", Stroke::Solid, mm(right))
        .line("v_y", Stroke::Dashed, mm(forward))
        .caption(
            "Errors of the learned velocities against the truth, over the same iterations as the log-likelihood. Good: \
             they fall while it rises, which is what makes it worth rising.",
        )
}

/// What Figures 4.3 and 4.5 compare: functions from distance in metres to size in px or mm.
pub struct Sensors<'a> {
    /// What the learner started from.
    pub starting: &'a dyn Fn(f64) -> f64,
    /// What it learned.
    pub learned: &'a dyn Fn(f64) -> f64,
    /// What the sensor would say by its data, and what that is called.
    pub analytic: (&'static str, &'a dyn Fn(f64) -> f64),
    /// Distances and mean sizes.
    pub measured: &'a [[f64; 2]],
}

/// Figures 4.3 and 4.5: f before and after learning, and what was measured; `unit` is the sizes'.
#[must_use]
pub fn sensors(name: &str, unit: &str, of: &Sensors<'_>) -> Figure {
    let distances = cover(of.measured.iter().map(|[d, _]| *d)).unwrap_or((1.0, 4.0));
    let figure = Figure::new(name, "Sensor functions")
        .x("distance", "m")
        .y(if unit == "px" { "beacon height" } else { "measured range" }, unit)
        .points("measured", Mark::Plus, of.measured)
        .curve("starting", Stroke::Dashed, distances, of.starting)
        .curve("learned", Stroke::Solid, distances, of.learned)
        .curve(of.analytic.0, Stroke::Dashed, distances, of.analytic.1);
    figure.caption(match of.measured {
        [] => {
            "The linear f that learning starts from, and the f that was learned from the first log. Ranges were not \
             surveyed. Good: the learned curve lies along the true distance, but for the sensor's own errors."
        }
        _ => {
            "The linear f that learning starts from, the f that was learned from the first log, and mean sizes at \
             surveyed distances. Good: the learned curve goes through the marks. A curve that leaves them at an end was \
             seldom seen there."
        }
    })
}

/// Learning curves of several learners over iterations: name and points, in the unit of the label.
#[must_use]
pub fn learning_curves(
    name: &str,
    title: &str,
    (label, unit): (&str, &str),
    curves: &[(String, Vec<[f64; 2]>)],
) -> Figure {
    let longest = curves.iter().filter_map(|(_, points)| points.last()).map(|point| point[0]);
    // Where half of the learners are done, there is not much more to see.
    let mut ends: Vec<f64> = longest.collect();
    ends.sort_by(f64::total_cmp);
    let end = ends.get(ends.len() / 2).copied().unwrap_or(1.0).max(1.0);
    let figure = Figure::new(name, title).x("iteration", "").y(label, unit).size(1120, 420).x_range(0.0, end);
    let figure = match down_to(curves, end) {
        Some(greatest) => figure.y_range(0.0, greatest),
        None => figure,
    };
    let stroke = |i: usize| if i < super::PALETTE.len() { Stroke::Solid } else { Stroke::Dashed };
    let figure = curves
        .iter()
        .enumerate()
        .fold(figure, |figure, (i, (name, points))| figure.line(name, stroke(i), points.as_slice()));
    figure.caption(
        "All learners from the published start, on the first log, up to where half of them are done; cut off at four \
         times the median of what they end with, above which a learner that diverges may stay. An iteration is a pass \
         over the data, and costs different learners different times (`timings.csv`). Good: down early, and low at the \
         end.",
    )
}

/// Four times the median of the last values until `end`, where any curve comes from above that.
fn down_to(curves: &[(String, Vec<[f64; 2]>)], end: f64) -> Option<f64> {
    let within = |points: &[[f64; 2]]| points.iter().filter(|point| point[0] <= end).map(|point| point[1]).collect();
    let values: Vec<Vec<f64>> = curves.iter().map(|(_, points)| within(points)).collect();
    let lasts: Vec<f64> = values.iter().filter_map(|values| values.last().copied()).collect();
    let most = 4.0 * median(&lasts).filter(|median| *median > 0.0)?;
    values.iter().flatten().any(|value| *value > most).then_some(most)
}

/// Figure 4.6a: mean heights at surveyed distances, and the learned f after shifting and scaling.
#[must_use]
pub fn figure_4_6a(measured: &[[f64; 2]], learned_px: impl Fn(f64) -> f64) -> Figure {
    let distances = cover(measured.iter().map(|[d, _]| *d)).unwrap_or((1.2, 3.6));
    Figure::new("Figure 4.6a", "Sensor function learned along a line")
        .x("distance", "m")
        .y("beacon height", "px")
        .points("measured", Mark::Plus, measured)
        .curve("learned, shifted and scaled", Stroke::Solid, distances, learned_px)
        .caption(
            "Learned from the first log, in units of the learner's own: f(a + b d) with the a and b that fit best. \
             Good: the curve goes through the marks.",
        )
}

/// Figures 4.6b and 4.7: true speeds of the strides and those learned, scaled: command, truth, learned, in m/s.
#[must_use]
pub fn strides(name: &str, when: &str, speeds: &[[f64; 3]]) -> Figure {
    let mm = |i: usize| speeds.iter().map(|row| [1e3 * row[0], 1e3 * row[i]]).collect::<Vec<_>>();
    Figure::new(name, &format!("Speeds of the strides, {when}"))
        .x("commanded speed", "mm/s")
        .y("speed", "mm/s")
        .points("measured", Mark::Plus, mm(1))
        .points("learned, scaled", Mark::Cross, mm(2))
        .caption(
            "True speed of each stride and the one learned from the first log, all scaled by one factor. Good: \
             crosses on plusses, at the ends too.",
        )
}

#[cfg(test)]
mod tests {
    use super::super::figure::Shape;
    use super::*;

    #[test]
    fn figures_without_data_are_empty_figures() {
        let nan = |_: f64| f64::NAN;
        let none = Sensors { starting: &nan, learned: &nan, analytic: ("", &nan), measured: &[] };
        for figure in [
            likelihood("a", &[]),
            velocity_errors("b", &[], &[]),
            sensors("c", "px", &none),
            learning_curves("d", "", ("", ""), &[]),
            figure_4_6a(&[], nan),
            strides("e", "", &[]),
        ] {
            assert!(figure.svg().contains("no data"), "{}", figure.name);
        }
    }

    #[test]
    fn learning_curves_are_cut_off_where_they_have_come_down() {
        let curve = |name: &str, ends: f64| (name.to_owned(), vec![[0.0, 300.0], [1.0, 50.0], [2.0, ends]]);
        let figure = learning_curves("a", "b", ("", ""), &[curve("a", 4.0), curve("b", 5.0), curve("c", 400.0)]);
        assert_eq!(figure.y.range, Some((0.0, 20.0)));
        let flat = [("a".to_owned(), vec![[0.0, 6.0], [1.0, 5.0]])];
        assert_eq!(learning_curves("a", "b", ("", ""), &flat).y.range, None);
    }

    #[test]
    fn speeds_and_errors_stand_in_millimetres() {
        let figure = strides("x", "before", &[[0.1, 0.09, 0.08]]);
        let points: Vec<_> = figure.series.iter().map(|series| series.shape.clone()).collect();
        assert_eq!(points[0], Shape::Points(Mark::Plus, vec![[100.0, 90.0]]));
        assert_eq!(points[1], Shape::Points(Mark::Cross, vec![[100.0, 80.0]]));
        let figure = velocity_errors("x", &[[0.0, 0.2]], &[[0.0, 0.3]]);
        assert_eq!(figure.series[0].shape, Shape::Line(Stroke::Solid, vec![[0.0, 200.0]]));
    }
}
