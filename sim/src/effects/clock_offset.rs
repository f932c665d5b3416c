//! A scanner whose clock is not the log's.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The times of the firings are ahead of those of the commands by a constant.
    ClockOffset, "clock_offset",
    "The laser scanner's clock is ahead of, or behind, that of the commands.",
    Sensing, Timing, fits ["car"],
    source "clocks of sensors that no pulse synchronises differ by 10 to 100 ms; one whole packet too late is 1.3 ms",
    drawn [offset_s: Size { way: Either, least: 0.002, greatest: 0.2 }],
    {
        /// What is recorded less what was.
        offset_s: f64 = 0.0, "s", -0.3..=0.3;
    }
}

impl Effect for ClockOffset {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.velodyne.ahead_s += self.offset_s;
    }
}
