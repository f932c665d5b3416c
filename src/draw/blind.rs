//! Curves of blind checks: how often a cause is named by its size, and what a probability is worth.

use super::{Figure, Mark, Stroke};

/// A named series of points with half the length of their bars.
pub type Bars = (String, Vec<[f64; 3]>);

/// How often an effect is named, over the logarithm of its size.
#[must_use]
pub fn power(effect: &str, parameter: &str, series: &[Bars]) -> Figure {
    let figure = Figure::new(&format!("Power, {effect}"), effect)
        .x(&format!("log10 of {parameter}, distance from null"), "")
        .y("share named", "")
        .y_range(0.0, 1.0)
        .size(420, 300);
    let figure = series.iter().fold(figure, |figure, (name, bars)| figure.error_bars(name, bars.as_slice()));
    figure.caption(
        "Cases with this effect alone, in five bins of size: how often it, or what this log cannot tell from it, is the \
         most probable cause, with half the width of the 95 % interval. Good: a steep rise within the first decade.",
    )
}

/// How often answers come true, over their probability.
#[must_use]
pub fn reliability(series: &[Bars]) -> Figure {
    let figure = Figure::new("Reliability", "What probabilities are worth")
        .x("probability of what was named", "")
        .y("share right", "")
        .x_range(0.0, 1.0)
        .y_range(0.0, 1.0)
        .line("as it should be", Stroke::Dashed, vec![[0.0, 0.0], [1.0, 1.0]]);
    let figure = series.iter().fold(figure, |figure, (name, bars)| figure.error_bars(name, bars.as_slice()));
    figure.caption(
        "All cases in ten bins of probability, with half the width of the 95 % interval. Good: on the line; below it, \
         answers are surer than they should be.",
    )
}

/// The axis of what separates a truth from the next cause, in nats.
const SEPARATIONS_NATS: [f64; 2] = [-20.0, 100.0];
/// Room for a dot at its ends.
const DOT_NATS: f64 = 2.0;

/// Probability of the truth over how far a log separates it.
#[must_use]
pub fn separation(points: &[(String, Vec<[f64; 2]>)]) -> Figure {
    let [least, most] = SEPARATIONS_NATS;
    let figure = Figure::new("Separation", "Probability of the truth")
        .x("D_sep", "nats")
        .y("probability of the truth", "")
        .x_range(least - DOT_NATS, most + DOT_NATS)
        .y_range(0.0, 1.0);
    let figure = points.iter().fold(figure, |figure, (name, points)| {
        let points: Vec<[f64; 2]> = points.iter().map(|[nats, p]| [nats.clamp(least, most), *p]).collect();
        figure.points(name, Mark::Dot, points)
    });
    figure.caption(
        "One point for each case; what is separated by more than 100 nats, or by less than -20, stands at the edge. Good: low on the \
         left, at 1 from 10 nats on. A point low on the right is a mistake that the log did not ask for.",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Most of an Aibo's cases are separated by hundreds of nats: they are the ones to be seen.
    #[test]
    fn what_lies_beyond_the_axis_stands_at_its_edge() {
        let drawn = |nats: f64| separation(&[("asami".to_owned(), vec![[nats, 0.4]])]).svg();
        assert_eq!(drawn(1400.0), drawn(100.0));
        assert_eq!(drawn(-35.0), drawn(-20.0));
        assert_ne!(drawn(99.0), drawn(100.0));
    }

    #[test]
    fn figures_without_data_are_drawn() {
        assert!(power("a", "b", &[]).svg().contains("no data"));
        assert!(separation(&[]).svg().contains("no data"));
        assert!(reliability(&[]).svg().contains("as it should be"));
    }
}
