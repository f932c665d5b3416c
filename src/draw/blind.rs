//! Curves of blind checks: how often a cause is named by its size, and what a probability is worth.

use super::{Figure, Mark, Stroke};

/// A named series of points with both ends of their bars.
pub type Bars = (String, Vec<[f64; 4]>);

/// Room for a dot at the ends of an axis of shares.
const DOT_SHARE: f64 = 0.02;
/// So far from one another do bars of different series stand that would hide each other, in shares of the axis.
const BESIDE: f64 = 0.015;

/// How often an effect is named, over the logarithm of its size, from the least to the greatest that its law draws.
#[must_use]
pub fn power(effect: &str, parameter: &str, (least, greatest): (f64, f64), series: &[Bars]) -> Figure {
    let beside = BESIDE * (greatest - least);
    let figure = Figure::new(&format!("Power, {effect}"), effect)
        .x(&format!("log10 of {parameter}, distance from null"), "")
        .y("share named", "")
        .x_range(least - 2.0 * beside, greatest + 2.0 * beside)
        .y_range(-DOT_SHARE, 1.0 + DOT_SHARE)
        .size(420, 300);
    let middle = (series.len().max(1) - 1) as f64 / 2.0;
    let figure = series.iter().enumerate().fold(figure, |figure, (i, (name, bars))| {
        let aside = (i as f64 - middle) * beside;
        figure
            .error_bars(name, bars.iter().map(|[x, bar @ ..]| [x + aside, bar[0], bar[1], bar[2]]).collect::<Vec<_>>())
    });
    figure.caption(
        "Cases with this effect alone, in five bins of size: how often it, or what this log cannot tell from it, is the \
         most probable cause, with its 95 % interval; those of several diagnosers stand side by side. Good: a \
         steep rise within the first decade.",
    )
}

/// How often answers come true, over their probability.
#[must_use]
pub fn reliability(series: &[Bars]) -> Figure {
    let figure = Figure::new("Reliability", "What probabilities are worth")
        .x("probability of what was named", "")
        .y("share right", "")
        .x_range(-DOT_SHARE, 1.0 + DOT_SHARE)
        .y_range(-DOT_SHARE, 1.0 + DOT_SHARE)
        .line("as it should be", Stroke::Dashed, vec![[0.0, 0.0], [1.0, 1.0]]);
    let figure = series.iter().fold(figure, |figure, (name, bars)| figure.error_bars(name, bars.as_slice()));
    figure.caption(
        "All cases in ten bins of probability, with 95 % intervals. Good: on the line; below it, answers are surer than they \
         should be.",
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
        .y_range(-DOT_SHARE, 1.0 + DOT_SHARE);
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

    /// Two diagnosers that name the same cases.
    #[test]
    fn bars_of_the_same_size_do_not_hide_each_other() {
        let bars = vec![[0.5, 1.0, 0.6, 1.0]];
        let series = [("a".to_owned(), bars.clone()), ("b".to_owned(), bars)];
        let figure = power("effect", "size", (0.0, 2.0), &series);
        let at: Vec<f64> = figure.series.iter().map(|series| series.told()[0][0]).collect();
        assert!(at[0] < 0.5 && 0.5 < at[1] && (at[1] - at[0] - 0.03).abs() < 1e-12, "{at:?}");
    }

    #[test]
    fn figures_without_data_are_drawn() {
        assert!(power("a", "b", (-1.0, 1.0), &[]).svg().contains("no data"));
        assert!(separation(&[]).svg().contains("no data"));
        assert!(reliability(&[]).svg().contains("as it should be"));
    }
}
