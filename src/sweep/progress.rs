//! What a sweep says while it goes on: a bar on a terminal, plain lines elsewhere.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::cases::Count;
use super::{Timing, Watcher};
use crate::trial::Case;

/// Lines come this often at most, where nobody sees a bar.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Speaks to stderr.
pub struct Progress {
    state: Mutex<State>,
    /// What is done with a log, in a word.
    work: &'static str,
}

struct State {
    bar: Option<ProgressBar>,
    trials_per_case: usize,
    done: usize,
    of: usize,
    said: Instant,
}

impl Progress {
    /// Of a sweep that does this with its logs, in a word: `learning`.
    #[must_use]
    pub fn of(work: &'static str) -> Self {
        let state = State { bar: None, trials_per_case: 0, done: 0, of: 0, said: Instant::now() };
        Self { state: Mutex::new(state), work }
    }
}

impl State {
    fn say(&mut self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(line),
            // Nobody listening is no reason to stop.
            None => drop(writeln!(std::io::stderr(), "{line}")),
        }
        self.said = Instant::now();
    }

    fn count(&self) -> String {
        format!("{} of {} done", self.done * self.trials_per_case, self.of * self.trials_per_case)
    }
}

impl Watcher for Progress {
    fn begins(&self, found: &Count, trials_per_case: usize) {
        let Ok(mut state) = self.state.lock() else { return };
        (state.trials_per_case, state.done, state.of) = (trials_per_case, found.done, found.of);
        if found.stale {
            state.say("the scenario, its data or the program has changed: starting anew");
        }
        if state.done > 0 {
            let line = format!("going on where it stopped: {}", state.count());
            state.say(&line);
        }
        if std::io::stderr().is_terminal() && state.done < state.of {
            let bar = ProgressBar::new(state.of as u64).with_position(state.done as u64);
            let style = ProgressStyle::with_template("{bar:40} {pos} of {len} logs, {elapsed}, {eta} to go");
            state.bar = Some(style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style)));
        }
    }

    fn finished(&self, case: &Case, timing: &Timing) {
        let Ok(mut state) = self.state.lock() else { return };
        state.done += 1;
        if let Some(bar) = &state.bar {
            bar.inc(1);
            if state.done == state.of {
                bar.finish_and_clear();
            }
        } else if state.of <= 50 || state.done == state.of || state.said.elapsed() > LINE_EVERY {
            let work_s: f64 = timing.trials_s.iter().sum();
            let (name, log_s, work) = (case.name(), timing.log_s, self.work);
            let line = format!("{}: log {name} in {log_s:.1} s, {work} in {work_s:.1} s", state.count());
            state.say(&line);
        }
    }
}
