//! Where a real robot does not do what it is told: it is held up, or its own reflexes overrule its commands. No effect is the
//! cause, and yet what little turned out otherwise would be put on one.
//!
//! Such stretches stand out by how much less likely a log is there than is to be expected. In them a robot may go anywhere, under
//! every hypothesis alike, and they are not scored.

use asami_math::statistics::median;

use super::noise::FREE;
use crate::blocks::likeliest;
use crate::judge::Judge;
use crate::plant::Planted;

/// A log is looked at in windows of this length.
const WINDOW_S: f64 = 3.0;
/// A window of thirty sightings, or of fewer, stands out that is by so many nats less likely than usual: thirty scatter by 5.5, and
/// more of them by as the root of how many they are.
const STANDS_OUT_NATS: f64 = 25.0;
const THIRTY: f64 = 30.0;
/// A robot has gone astray before that shows.
const EARLIER_S: f64 = 3.0;

/// Adds to `spans` those of a log that stand out under every response that is anything like that with these effects in the
/// world; they stay in order of time and apart from one another.
pub fn add(spans: &mut Vec<[f64; 2]>, judge: &dyn Judge, planted: &[Planted]) {
    // What a robot always makes of a command is no going astray, even where nothing in the list does so.
    let numbers = FREE.iter().fold(judge.numbers(planted), |numbers, block| likeliest(&[judge], &numbers, block));
    let reading = judge.read(&numbers);
    let unlikely = reading.expected.iter().zip(&reading.log_likelihoods).map(|(expected, likely)| -likely - expected);
    let mut windows: Vec<Window> = Vec::new();
    for (step, nats) in judge.steps().iter().zip(unlikely) {
        let from_s = (step.t_s / WINDOW_S).floor() * WINDOW_S;
        match windows.last_mut().filter(|last| last.from_s == from_s) {
            Some(last) => (last.nats, last.seen) = (last.nats + nats, last.seen + step.seen),
            None => windows.push(Window { from_s, nats, seen: step.seen }),
        }
    }
    spans.extend(standing_out(&windows));
    join(spans);
}

/// A part of a log.
#[derive(Clone, Copy, Debug)]
struct Window {
    from_s: f64,
    /// By how much it is less likely than is to be expected.
    nats: f64,
    /// Sightings in it.
    seen: usize,
}

/// The windows that stand out, with what led to them.
fn standing_out(windows: &[Window]) -> Vec<[f64; 2]> {
    let usual = median(&windows.iter().map(|it| it.nats).collect::<Vec<f64>>()).unwrap_or(0.0);
    let most = |it: &Window| STANDS_OUT_NATS * (it.seen as f64 / THIRTY).max(1.0).sqrt();
    let out = windows.iter().filter(|it| it.nats - usual > most(it));
    out.map(|it| [it.from_s - EARLIER_S, it.from_s + WINDOW_S]).collect()
}

/// Makes one of those that meet.
fn join(spans: &mut Vec<[f64; 2]>) {
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    spans.dedup_by(|next, last| {
        let meets = next[0] <= last[1];
        if meets {
            last[1] = last[1].max(next[1]);
        }
        meets
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_out_is_taken_out_with_what_led_to_it() {
        let window = |i: u32| Window { from_s: 3.0 * f64::from(i), nats: f64::from(i * 7 % 5) - 2.0, seen: 6 };
        let mut windows: Vec<Window> = (0..100).map(window).collect();
        assert!(standing_out(&windows).is_empty());
        windows[40].nats = 60.0;
        windows[41].nats = 30.0;
        windows[70].nats = 9.0;
        // Many sightings scatter by more.
        (windows[90].nats, windows[90].seen) = (60.0, 270);
        let mut spans = standing_out(&windows);
        assert_eq!(spans, vec![[117.0, 123.0], [120.0, 126.0]]);
        spans.extend([[10.0, 20.0], [11.0, 12.0]]);
        join(&mut spans);
        assert_eq!(spans, vec![[10.0, 20.0], [117.0, 126.0]]);
        assert!(standing_out(&[]).is_empty());
    }
}
