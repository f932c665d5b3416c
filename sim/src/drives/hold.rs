//! One action for ever.

use asami_dataset::Action;

use crate::world::{Drive, Seen};

/// Gives the same action at every tick.
#[derive(Clone, Copy, Debug)]
pub struct Hold(pub Action);

impl Hold {
    /// Walks straight ahead, or back, at a commanded speed.
    #[must_use]
    pub fn forward(ay_m_per_s: f64) -> Self {
        Self(Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s, atheta_rad_per_s: 0.0 })
    }
}

impl Drive for Hold {
    fn act(&mut self, _t_s: f64, _seen: &Seen) -> Action {
        self.0
    }
}
