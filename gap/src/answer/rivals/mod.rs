//! Diagnosers of the textbook, to be compared with: they judge by the same likelihood, and give no probabilities.

pub mod all_at_once;
pub mod forward_selection;

pub use all_at_once::AllAtOnce;
pub use forward_selection::ForwardSelection;

#[cfg(test)]
mod tests;
