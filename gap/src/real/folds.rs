//! A log in folds: how noisy a real robot is gets learned from all folds but one, and is believed in that one alone (cross-fitting,
//! Chernozhukov et al. 2018). All of a log is so diagnosed, and no part of it with a noise that was fitted to it.

/// Blocks of a log, one after another, are of one fold after another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Folds {
    /// The length of a block.
    pub block_s: f64,
    /// How many folds there are.
    pub count: usize,
}

impl Default for Folds {
    fn default() -> Self {
        Self { block_s: 20.0, count: 2 }
    }
}

impl Folds {
    /// The fold that a time is in.
    #[must_use]
    pub fn of(&self, t_s: f64) -> usize {
        (t_s / self.block_s).floor().rem_euclid(self.count as f64) as usize
    }
}
