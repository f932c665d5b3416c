//! What is known of a real robot's log before it is looked at: what others of its make have, and how far such logs are to be believed.

use std::collections::BTreeMap;

use super::kin::Kin;
use crate::answer::diagnosis::{Diagnosis, Estimate};

/// Standard deviations from end to end of a Gaussian's middle 90 %.
const WIDTH: f64 = 3.29;

/// What is known beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Other robots of its make.
    pub kin: Kin,
    /// By how many times as much as they are said to sizes differ between halves of such logs ([`halves_differ`]); no less than 1.
    pub halves_differ: f64,
}

impl Default for Prior {
    fn default() -> Self {
        Self::NONE
    }
}

impl Prior {
    /// Nothing: no other robot is known, and a log is believed as it speaks.
    pub const NONE: Self = Self { kin: Kin::NONE, halves_differ: 1.0 };

    /// The same, where halves differ by so many times as much as they are said to.
    #[must_use]
    pub fn whose_halves_differ(self, times: f64) -> Self {
        Self { halves_differ: times.max(1.0), ..self }
    }

    /// What counts of a nat of the log: as much less as a square does.
    #[must_use]
    pub fn counts(&self) -> f64 {
        self.halves_differ.powi(-2)
    }
}

/// By how many times as much as they are said to sizes differ between halves of logs, each diagnosed by itself: of all effects that
/// both halves of a log name, the root of the mean square over what both say that they are unsure of. No less than 1.
pub fn halves_differ<'a>(halves: impl IntoIterator<Item = [&'a Diagnosis; 2]>) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for [first, second] in halves {
        let (first, second) = (sizes(first), sizes(second));
        for (effect, a) in first {
            let Some(b) = second.get(effect) else { continue };
            let variance = error(a).powi(2) + error(b).powi(2);
            if variance > 0.0 {
                sum += (a.value - b.value).powi(2) / variance;
                n += 1.0;
            }
        }
    }
    if n > 0.0 { f64::max(sum / n, 1.0).sqrt() } else { 1.0 }
}

/// Each effect's size, by one of its parameters: all of them say the same.
fn sizes(diagnosis: &Diagnosis) -> BTreeMap<&str, &Estimate> {
    let parameters = diagnosis.said().into_iter().flat_map(|cause| &cause.parameters);
    parameters.map(|(name, estimate)| (name.split('.').next().unwrap_or(name), estimate)).collect()
}

/// How unsure a size is, as a standard deviation.
#[must_use]
pub fn error(of: &Estimate) -> f64 {
    (of.interval[1] - of.interval[0]) / WIDTH
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::diagnosis::Cause;

    fn half(values: &[(&str, f64)], error: f64) -> Diagnosis {
        let far = 0.5 * WIDTH * error;
        let estimate = |value: f64| Estimate { value, interval: [value - far, value + far], at_end: false };
        let parameters = values.iter().map(|(name, value)| ((*name).to_owned(), estimate(*value))).collect();
        let nothing = Diagnosis::flat(&[]);
        let named = Cause { effects: vec!["turn_slowing".to_owned()], parameters, ..nothing.which[0].clone() };
        Diagnosis { which: vec![named], ..nothing }
    }

    /// Of an effect with three parameters one counts, what one half alone names does not, and halves that agree better than they are
    /// said to are believed as they speak.
    #[test]
    fn halves_differ_by_what_both_name() {
        let scale = |value: f64| ["theta_ratio", "x_ratio", "y_ratio"].map(|it| (format!("command_scale.{it}"), value));
        let of = |slowing: f64, scales: f64| {
            let scale = scale(scales);
            let all = scale.iter().map(|(name, value)| (name.as_str(), *value));
            half(&all.chain([("turn_slowing.loss_s2", slowing)]).collect::<Vec<_>>(), 0.1)
        };
        let apart = |by: f64| by * 0.1 * std::f64::consts::SQRT_2;
        let first = of(2.0, 1.0);
        let second = of(2.0 + apart(1.0), 1.0 + apart(5.0));
        assert!((halves_differ([[&first, &second]]) - 13.0_f64.sqrt()).abs() < 1e-9);
        let alone = half(&[("wheel_base.ratio", 1.1)], 0.1);
        assert!((halves_differ([[&first, &second], [&first, &alone]]) - 13.0_f64.sqrt()).abs() < 1e-9);
        for pair in [[&first, &first], [&first, &alone]] {
            assert!((halves_differ([pair]) - 1.0).abs() < 1e-12);
        }
        assert!((halves_differ([]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nats_count_as_much_less_as_squares_are_more() {
        let counts = |times: f64| Prior::NONE.whose_halves_differ(times).counts();
        assert!((counts(2.0) - 0.25).abs() < 1e-12);
        assert!((counts(0.5) - 1.0).abs() < 1e-12, "a log is never surer than it says");
    }
}
