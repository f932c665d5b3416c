//! What one number must be, in a row or under a key.

use std::f64::consts::PI;

/// A rule for one number. Every rule includes that it is finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    Finite,
    Positive,
    NotNegative,
    Angle,
    /// Of an angle above the horizon.
    Elevation,
    Share,
    Either,
    Id,
    Count,
}

impl Rule {
    pub(super) fn says(self) -> &'static str {
        match self {
            Rule::Finite => "must be a finite number",
            Rule::Positive => "must be a number greater than 0",
            Rule::NotNegative => "must be a number not less than 0",
            Rule::Angle => "must be an angle in [-pi, pi)",
            Rule::Elevation => "must be an angle in [-pi/2, pi/2]",
            Rule::Share => "must be a number in 0..=1",
            Rule::Either => "must be a number in -1..=1",
            Rule::Id => "must be a whole number in 0..=65535",
            Rule::Count => "must be a whole number in 1..=4294967295",
        }
    }

    pub(super) fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Rule::Finite => true,
                Rule::Positive => value > 0.0,
                Rule::NotNegative => value >= 0.0,
                Rule::Angle => (-PI..PI).contains(&value),
                Rule::Elevation => value.abs() <= PI / 2.0,
                Rule::Share => (0.0..=1.0).contains(&value),
                Rule::Either => (-1.0..=1.0).contains(&value),
                Rule::Id => value.fract() == 0.0 && (0.0..=f64::from(u16::MAX)).contains(&value),
                Rule::Count => value.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&value),
            }
    }

    /// The number that `text` says, if it keeps the rule.
    pub(super) fn parse(self, text: &str) -> Option<f64> {
        let value = match self {
            Rule::Id | Rule::Count => f64::from(text.parse::<u32>().ok()?),
            _ => text.parse().ok()?,
        };
        self.holds(value).then_some(value)
    }

    /// Whether numbers under this rule are written without a decimal point.
    pub(super) fn is_whole(self) -> bool {
        matches!(self, Rule::Id | Rule::Count)
    }
}
