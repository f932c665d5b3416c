//! What a robot was commanded, behind a lag.

use asami_dataset::Command;
use asami_math::elementary::exp;
use asami_sim::effects::slight_turns::is_slight;

/// Commands, and what came of them, are looked at so often.
pub const STEP_S: f64 = 0.01;

/// Commanded speed, turning rate, speed times squared turning rate, and speed in slight turns, behind a lag, every so often from a time on.
pub struct Commanded {
    from_s: f64,
    /// Integrals from the beginning.
    sums: Vec<[f64; 4]>,
}

impl Commanded {
    /// Behind a lag of this time constant, until so long after the last command. Pedals command neither.
    #[must_use]
    pub fn new(commands: &[Command], lag_s: f64, after_s: f64) -> Self {
        let (from_s, to_s) = commands.first().zip(commands.last()).map_or((0.0, 0.0), |(a, b)| (a.t_s, b.t_s));
        let steps = ((to_s - from_s + after_s) / STEP_S) as usize + 1;
        let (mut next, mut given, mut acting) = (0, [0.0; 4], [0.0; 4]);
        let mut sums = vec![[0.0; 4]];
        let share = 1.0 - exp(-STEP_S / lag_s.max(1e-6));
        for i in 0..steps {
            let t_s = from_s + (i as f64 + 0.5) * STEP_S;
            while let Some(command) = commands.get(next).filter(|command| command.t_s <= t_s) {
                if let Some([v, omega]) = command.action.velocity() {
                    given = [v, omega, v * omega * omega, if is_slight(omega) { v } else { 0.0 }];
                }
                next += 1;
            }
            acting = std::array::from_fn(|k| acting[k] + share * (given[k] - acting[k]));
            let last = sums[i];
            sums.push(std::array::from_fn(|k| last[k] + STEP_S * acting[k]));
        }
        Self { from_s, sums }
    }

    /// The integrals from the beginning until a time.
    #[must_use]
    pub fn until(&self, t_s: f64) -> [f64; 4] {
        let step = ((t_s - self.from_s) / STEP_S).clamp(0.0, self.sums.len() as f64 - 1.0);
        let (i, share) = (step as usize, step.fract());
        let [a, b] = [i, i + 1].map(|i| self.sums[i.min(self.sums.len() - 1)]);
        std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
    }

    /// The integrals over so long from a time on.
    #[must_use]
    pub fn over(&self, from_s: f64, length_s: f64) -> [f64; 4] {
        let (before, after) = (self.until(from_s), self.until(from_s + length_s));
        std::array::from_fn(|k| after[k] - before[k])
    }
}

/// Stretches in which what is told is of one kind: the first command of each, and from when it was given until one of another kind was. The
/// last has no end, and is left out.
pub fn of_a_kind<Kind: PartialEq>(commands: &[Command], kind: impl Fn(&Command) -> Kind) -> Vec<(&Command, [f64; 2])> {
    let changes = (0..commands.len()).filter(|i| *i == 0 || kind(&commands[*i]) != kind(&commands[i - 1]));
    let firsts: Vec<&Command> = changes.map(|i| &commands[i]).collect();
    firsts.windows(2).map(|it| (it[0], [it[0].t_s, it[1].t_s])).collect()
}
