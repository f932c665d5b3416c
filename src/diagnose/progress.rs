//! What a diagnosis says while it goes on: a bar on a terminal, plain lines elsewhere.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Hears how long work goes on.
pub trait Listener: Sync {
    /// Work of `of` parts begins, `done` of them done before.
    fn begins(&self, what: &str, done: usize, of: usize);
    /// One more part is done.
    fn steps(&self);
    /// A remark.
    fn says(&self, line: &str);
}

/// Hears nothing.
pub struct Silent;

impl Listener for Silent {
    fn begins(&self, _what: &str, _done: usize, _of: usize) {}
    fn steps(&self) {}
    fn says(&self, _line: &str) {}
}

/// Speaks to stderr.
pub struct Progress(Mutex<State>);

struct State {
    what: String,
    bar: Option<ProgressBar>,
    done: usize,
    of: usize,
    said: Instant,
}

/// Lines come this often at most, where nobody sees a bar.
const LINE_EVERY: Duration = Duration::from_secs(10);

impl Default for Progress {
    fn default() -> Self {
        Self(Mutex::new(State { what: String::new(), bar: None, done: 0, of: 0, said: Instant::now() }))
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
}

impl Listener for Progress {
    fn begins(&self, what: &str, done: usize, of: usize) {
        let Ok(mut state) = self.0.lock() else { return };
        (state.what, state.done, state.of) = (what.to_owned(), done, of);
        if done >= of {
            return;
        }
        let line =
            if done > 0 { format!("{what}: {done} of {of} kept, going on") } else { format!("{what}: 0 of {of}") };
        state.say(&line);
        if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(of as u64).with_position(done as u64);
            let style = ProgressStyle::with_template("{bar:40} {pos} of {len}, {elapsed}, {eta} to go");
            state.bar = Some(style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style)));
        }
    }

    fn steps(&self) {
        let Ok(mut state) = self.0.lock() else { return };
        state.done += 1;
        if let Some(bar) = &state.bar {
            bar.inc(1);
            if state.done >= state.of {
                bar.finish_and_clear();
                state.bar = None;
            }
        } else if state.done == state.of || state.said.elapsed() > LINE_EVERY {
            let line = format!("{}: {} of {}", state.what, state.done, state.of);
            state.say(&line);
        }
    }

    fn says(&self, line: &str) {
        let Ok(mut state) = self.0.lock() else { return };
        state.say(line);
    }
}
