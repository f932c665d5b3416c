//! Stretches of a log that are set aside: what is learned there is not scored there.

/// Which times of a log are set aside: of blocks one after another the first of every so many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aside {
    /// The length of a block.
    pub block_s: f64,
    /// The first of so many is set aside.
    pub every: f64,
}

impl Default for Aside {
    /// A quarter of the log.
    fn default() -> Self {
        Self { block_s: 20.0, every: 4.0 }
    }
}

impl Aside {
    /// Whether a time is set aside.
    #[must_use]
    pub fn holds(&self, t_s: f64) -> bool {
        (t_s / self.block_s).floor().rem_euclid(self.every) < 1.0
    }
}
