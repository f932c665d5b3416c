//! What is measured of a trial, each under the name of its column in `trials.csv`.

use super::rows::optional;

/// A number that a trial has, or not; `F` is the function that finds it.
#[derive(Clone, Copy)]
pub struct Quantity<F> {
    /// Its column.
    pub name: &'static str,
    /// Its value, if it has one.
    pub of: F,
}

impl<F> Quantity<F> {
    /// Its value as a field: what is counted is a whole number.
    #[must_use]
    pub fn field(&self, value: Option<f64>) -> String {
        match self.name {
            "iterations" | "observations" => value.map_or_else(String::new, |n| format!("{n:.0}")),
            _ => optional(value),
        }
    }
}

/// The columns of these quantities.
#[must_use]
pub const fn names<F, const N: usize>(quantities: &[Quantity<F>; N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = quantities[i].name;
        i += 1;
    }
    names
}
