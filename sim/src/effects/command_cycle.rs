//! A robot that takes commands up once in a while.

use asami_dataset::{Action, Rng};

use crate::effect::{Effect, Stage, effect};

effect! {
    /// Whoever passes commands on to the wheels looks for a new one once in a cycle, and the newest is in force until the next: a turn that
    /// is told for less than a cycle lasts all of one, or none. In the mean that is a delay of half a cycle; what it has of its own is that
    /// motion scatters.
    CommandCycle, "command_cycle",
    "Commands are taken up once in a cycle, the newest each time, and stay in force until the next.",
    Actuation, Noise, fits ["create"],
    source "MRCLAM data set 6 (Leung et al. 2011): by motion capture all five Creates turn for whole multiples of 0.216 s, whatever \
            they are told; Player's driver of Creates sleeps for 0.2 s in each of its cycles",
    drawn [period_s: Size { way: Up, least: 0.05, greatest: 0.5 }],
    {
        /// From one look to the next; the first is as the log begins.
        period_s: f64 = 0.0, "s", 0.0..=2.0;
    }
}

impl Effect for CommandCycle {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        let period_s = self.period_s;
        let mut taken: Option<(f64, Action)> = None;
        let stage = move |t_s: f64, action: Action| {
            // Half a microsecond: times are multiples of the tick, computed by one rounding each.
            let look = ((t_s + 5e-7) / period_s).floor();
            match taken {
                Some((last, in_force)) if look <= last => in_force,
                _ => {
                    taken = Some((look, action));
                    action
                }
            }
        };
        (period_s > 0.0).then(|| Stage::Command(Box::new(stage)))
    }
}
