//! The one way in which numbers are written.

use std::fmt::Write;

/// Appends the shortest text that reads back as the same number; -0 is written as 0, and what is no
/// number (NaN, an infinity) as nothing.
///
/// ```
/// use asami_dataset::store::number;
/// assert_eq!(number(0.1), "0.1");
/// assert_eq!(number(-0.0), "0.0");
/// assert_eq!(number(1.0e-9), "1e-9");
/// assert_eq!(number(f64::NAN), "");
/// ```
pub fn push_number(text: &mut String, value: f64) {
    if value.is_finite() {
        // Writing to a String cannot fail. Adding zero turns -0 into 0.
        let _ = write!(text, "{:?}", value + 0.0);
    }
}

/// [`push_number`] on its own.
#[must_use]
pub fn number(value: f64) -> String {
    let mut text = String::new();
    push_number(&mut text, value);
    text
}
