//! Axes: what range covers the data, where the ticks are and how they read.

/// An axis of a figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What is counted along it.
    pub label: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Fixed range; `None`: what covers the data.
    pub range: Option<(f64, f64)>,
    /// Names at 0, 1, 2, ... in place of numbers.
    pub names: Vec<String>,
    /// Whether zero must be on it.
    pub zero: bool,
}

impl Axis {
    /// Label and unit as printed.
    #[must_use]
    pub fn caption(&self) -> String {
        match (self.label.as_str(), self.unit.as_str()) {
            (label, "") => label.to_owned(),
            (label, unit) => format!("{label} ({unit})"),
        }
    }

    /// The range to draw for these values: the fixed one, else one that covers them with a margin.
    #[must_use]
    pub fn range_over(&self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        if let Some((low, high)) = self.range.filter(|(low, high)| drawable(*low) && drawable(*high) && low < high) {
            return (low, high);
        }
        if !self.names.is_empty() {
            return (-0.6, self.names.len() as f64 - 0.4);
        }
        let zero = self.zero.then_some(0.0);
        match cover(values.chain(zero)) {
            Some(range) => self.widened(range),
            None => (0.0, 1.0),
        }
    }

    /// Ticks within `range` and their labels; about `about` of them.
    #[must_use]
    pub fn ticks(&self, range: (f64, f64), about: usize) -> Vec<(f64, String)> {
        if !self.names.is_empty() {
            return self.names.iter().enumerate().map(|(i, name)| (i as f64, name.clone())).collect();
        }
        let step = step(range, about);
        let (first, last) = ((range.0 / step).ceil(), (range.1 / step).floor());
        let count = (last - first).clamp(0.0, 40.0) as usize;
        (0..=count).map(|i| (first + i as f64) * step).map(|at| (at, number(at, step))).collect()
    }

    fn widened(&self, (low, high): (f64, f64)) -> (f64, f64) {
        let margin = match high - low {
            span if span > high.abs().max(low.abs()) * 1e-9 => 0.04 * span,
            _ if high == 0.0 => 1.0,
            _ => 0.1 * high.abs(),
        };
        // An axis that starts at zero starts at zero, not a margin below it.
        let low_margin = if self.zero && low == 0.0 { 0.0 } else { margin };
        let high_margin = if self.zero && high == 0.0 { 0.0 } else { margin };
        (low - low_margin, high + high_margin)
    }
}

/// Least and greatest of the drawable values; `None` if there is none.
#[must_use]
pub fn cover(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|value| drawable(*value)).fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((if value < low { value } else { low }, if value > high { value } else { high })),
    })
}

/// Finite, and so far from overflow that spans and margins are finite too.
#[must_use]
pub fn drawable(value: f64) -> bool {
    value.abs() < 1e300
}

/// 1, 2 or 5 times a power of ten, so that about `about` steps make the range.
fn step((low, high): (f64, f64), about: usize) -> f64 {
    let raw = (high - low) / about.max(1) as f64;
    let decade = 10f64.powf(raw.log10().floor());
    match raw / decade {
        r if r < 1.5 => decade,
        r if r < 3.5 => 2.0 * decade,
        r if r < 7.5 => 5.0 * decade,
        _ => 10.0 * decade,
    }
}

/// `value` with the digits that a step of `step` can change, and a real minus sign.
#[must_use]
pub fn number(value: f64, step: f64) -> String {
    let magnitude = value.abs().max(step.abs());
    let text = if (1e-4..1e6).contains(&magnitude) || value == 0.0 {
        let decimals = (-step.abs().log10()).ceil().clamp(0.0, 9.0) as usize;
        format!("{:.decimals$}", value.abs())
    } else {
        format!("{:.3e}", value.abs())
    };
    if value < 0.0 && text.bytes().any(|byte| (b'1'..=b'9').contains(&byte)) { format!("\u{2212}{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_cover_the_data_and_ticks_lie_inside() {
        let axis = Axis::default();
        for values in [vec![0.0, 1.0], vec![-300.0, 300.0], vec![5.0], vec![0.0], vec![1e-9, 2e-9], vec![-1e299, 1e299]]
        {
            let (low, high) = axis.range_over(values.iter().copied());
            assert!(values.iter().all(|value| low < *value && *value < high), "{values:?} not in {low}..{high}");
            let ticks = axis.ticks((low, high), 6);
            assert!((2..=14).contains(&ticks.len()), "{values:?}: {ticks:?}");
            assert!(ticks.iter().all(|(at, _)| low <= *at && *at <= high), "{ticks:?} not in {low}..{high}");
        }
    }

    #[test]
    fn what_cannot_be_drawn_does_not_set_the_range() {
        let axis = Axis::default();
        let clean = axis.range_over([1.0, 3.0].into_iter());
        assert_eq!(axis.range_over([f64::NAN, 1.0, f64::INFINITY, 3.0, f64::MAX].into_iter()), clean);
        assert_eq!(axis.range_over([f64::NAN].into_iter()), (0.0, 1.0));
    }

    #[test]
    fn ticks_are_round_and_read_as_they_are() {
        let read =
            |range, about| Axis::default().ticks(range, about).into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(read((-310.0, 310.0), 6), ["\u{2212}300", "\u{2212}200", "\u{2212}100", "0", "100", "200", "300"]);
        assert_eq!(read((0.0, 0.31), 3), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(read((0.0, 150.0), 3), ["0", "50", "100", "150"]);
    }

    #[test]
    fn zero_is_the_end_of_an_axis_that_needs_it() {
        let axis = Axis { zero: true, ..Axis::default() };
        assert_eq!(axis.range_over([2.0, 10.0].into_iter()).0, 0.0);
        assert!(axis.range_over([-2.0, 10.0].into_iter()).0 < -2.0);
    }
}
