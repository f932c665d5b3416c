//! Times whose commands count, and for how much.

use asami_dataset::{Action, Command};

/// Every time of an interval, and so much earlier: by nothing, or by anything between two ages.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    on_s: [f64; 2],
    earlier_s: Option<[f64; 2]>,
}

impl Times {
    /// An interval's.
    pub fn between(from_s: f64, to_s: f64) -> Self {
        Self { on_s: [from_s, to_s], earlier_s: None }
    }

    /// An interval's, each earlier by anything between two ages.
    pub fn earlier(self, ages_s: [f64; 2]) -> Self {
        let [from_s, to_s] = self.on_s;
        if to_s > from_s {
            Self { earlier_s: Some(ages_s), ..self }
        } else {
            Self::between(from_s - ages_s[1], from_s - ages_s[0])
        }
    }

    /// Every action in force at these times, with its share of them. Before the first command none is.
    pub fn each(self, commands: &[Command], mut with: impl FnMut(f64, &Action)) {
        let ages_s = self.earlier_s.unwrap_or_default();
        let (from_s, to_s) = (self.on_s[0] - ages_s[1], self.on_s[1] - ages_s[0]);
        if to_s <= from_s {
            return;
        }
        let first = commands.partition_point(|command| command.t_s <= from_s).saturating_sub(1);
        for (i, command) in commands.iter().enumerate().skip(first).take_while(|(_, command)| command.t_s < to_s) {
            let until_s = commands.get(i + 1).map_or(to_s, |next| next.t_s.min(to_s));
            let share = self.share(command.t_s.max(from_s), until_s);
            if share > 0.0 {
                with(share, &command.action);
            }
        }
    }

    /// The share of them that lies between two.
    fn share(&self, from_s: f64, to_s: f64) -> f64 {
        let on_s = self.on_s;
        self.earlier_s.map_or((to_s - from_s) / (on_s[1] - on_s[0]), |[least_s, most_s]| {
            let until = |t_s: f64| below(t_s, on_s, [-most_s, -least_s]);
            until(to_s) - until(from_s)
        })
    }
}

/// How probable it is that the sum of two numbers, each as likely to be anything between its limits, is below `x`.
pub fn below(x: f64, a: [f64; 2], b: [f64; 2]) -> f64 {
    let ramp = |z: f64| 0.5 * z.max(0.0) * z.max(0.0);
    let area = (a[1] - a[0]) * (b[1] - b[0]);
    (ramp(x - a[0] - b[0]) - ramp(x - a[1] - b[0]) - ramp(x - a[0] - b[1]) + ramp(x - a[1] - b[1])) / area
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wheels(t_s: f64, v_m_per_s: f64) -> Command {
        Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s: 0.0 } }
    }

    fn mean(times: Times, commands: &[Command]) -> f64 {
        let mut sum = 0.0;
        times.each(commands, |share, action| {
            if let Action::Wheels { v_m_per_s, .. } = action {
                sum += share * v_m_per_s;
            }
        });
        sum
    }

    /// Of commands that change within a step, what is late is what is late at every time of it: the mean over many short steps.
    #[test]
    fn a_long_step_is_the_mean_of_short_ones() {
        let commands = [wheels(0.0, 0.1), wheels(2.03, 0.4), wheels(2.11, -0.2), wheels(2.3, 0.3)];
        for ages_s in [[0.0, 0.05], [0.1, 0.15], [0.3, 0.45], [0.7, 1.0]] {
            for from_s in [0.0, 1.9, 2.0, 2.2, 2.9, 9.0] {
                let long = mean(Times::between(from_s, from_s + 0.25).earlier(ages_s), &commands);
                let n = 20_000;
                let short = (0..n).map(|i| {
                    let t_s = from_s + 0.25 * (f64::from(i) + 0.5) / f64::from(n);
                    mean(Times::between(t_s, t_s).earlier(ages_s), &commands)
                });
                let short = short.sum::<f64>() / f64::from(n);
                assert!((long - short).abs() < 1e-6, "{ages_s:?} {from_s}: {long} {short}");
            }
        }
    }

    #[test]
    fn before_the_first_command_none_is_in_force() {
        let commands = [wheels(1.0, 0.2)];
        assert_eq!(mean(Times::between(0.0, 0.5), &commands), 0.0);
        assert!((mean(Times::between(0.5, 1.5), &commands) - 0.1).abs() < 1e-12);
        assert!((mean(Times::between(1.0, 2.0).earlier([0.0, 1.0]), &commands) - 0.1).abs() < 1e-12);
        assert_eq!(mean(Times::between(1.5, 1.5), &commands), 0.0);
    }
}
