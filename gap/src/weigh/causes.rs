//! Causes by name, and what speaks for each of them.

use std::collections::BTreeMap;

use asami_math::elementary::ln;

/// The cause in nobody's list.
pub const UNKNOWN: &str = "unknown";
/// No cause.
pub const NONE: &str = "none";
/// Evidence of causes over *none*, by cause: an effect, several joined by `+`, or `unknown/` and a flexible block.
pub type Evidence = BTreeMap<String, f64>;

/// Prior odds of a second effect beside the first.
pub const PRIOR_OF_A_SECOND: f64 = 0.1;
/// Evidence from which on a cause leads, in nats.
pub const EVIDENT_NATS: f64 = 3.0;

/// Whether it is in nobody's list, in any block.
#[must_use]
pub fn is_unknown(cause: &str) -> bool {
    cause.starts_with(UNKNOWN)
}

/// One effect, not several and not *unknown*.
#[must_use]
pub fn is_single(cause: &str) -> bool {
    !is_unknown(cause) && cause != NONE && !cause.contains('+')
}

/// The cause that flexible blocks are put on top of: the most evident where any is evident, several effects at a price.
#[must_use]
pub fn leader(evidence: &Evidence) -> &str {
    let named = evidence.iter().filter(|(cause, _)| !is_unknown(cause));
    let priced = named.map(|(cause, nats)| (nats + if is_single(cause) { 0.0 } else { ln(PRIOR_OF_A_SECOND) }, cause));
    let best = priced.reduce(|a, b| if b.0 > a.0 { b } else { a });
    best.filter(|(nats, _)| *nats > EVIDENT_NATS).map_or(NONE, |(_, cause)| cause)
}
