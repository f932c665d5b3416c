//! What a turning laser scanner's log says by itself: at which angles its lasers point to one another, and how it moved
//! from scan to scan (Stronger 2008, sections 5.1 and 5.2). No map, no model of what carries it.

mod angles;
mod cloud;
mod drive;
mod forward;
mod matching;
mod odometry;
mod offsets;
mod pairs;
mod sensor;
mod signal;
mod thickness;
mod upright;

pub use angles::{Angles, chain, graph};
pub use cloud::{Cut, Going, cloud};
pub use drive::{Drive, Scan};
pub use forward::{Direction, angle_median};
pub use matching::{Distance, Match, Matching, Target, align};
pub use odometry::{AsOf, Motion, Odometry};
pub use offsets::{Offsets, Slope, from_slopes, slopes};
pub use pairs::{PairLag, pair_lags, pairs};
pub use sensor::{Layout, Sensor};
pub use signal::{Shaping, Signal};
pub use thickness::{Thickness, off_planes, thickness};

/// Why a log's firings say nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CannotScan {
    /// No laser was ever fired.
    #[error("the log has no laser firings")]
    NoFirings,
    /// Laser firings that contradict each other.
    #[error("the log's laser firings do not fit together: {0}")]
    Firings(#[from] asami_dataset::firings::Misfit),
    /// The lasers' vertical angles are not known.
    #[error("the log knows the vertical angles of {known} lasers; {found} fired")]
    UnknownLasers {
        /// Lasers that fired.
        found: usize,
        /// Vertical angles known.
        known: usize,
    },
    /// Less than makes a turn.
    #[error("the log has {found} firings; {needed} are needed for a turn")]
    TooShort {
        /// Firings found.
        found: usize,
        /// Firings needed.
        needed: usize,
    },
    /// Lasers that nothing holds together.
    #[error("{0}")]
    Undetermined(String),
}
