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
use crate::sighted::Sighted;

/// A log is looked at in windows of this length.
const WINDOW_S: f64 = 3.0;
/// A window stands out that is by so many nats less likely than usual: a dozen sightings scatter by 3.5.
const STANDS_OUT_NATS: f64 = 25.0;
/// A robot has gone astray before that shows.
const EARLIER_S: f64 = 3.0;

/// Adds to `spans` those of a log that stand out under every response that is anything like that with these effects in the
/// world; they stay in order of time and apart from one another.
pub fn add(spans: &mut Vec<[f64; 2]>, judge: &Sighted<'_>, planted: &[Planted]) {
    // What a robot always makes of a command is no going astray, even where nothing in the list does so.
    let numbers = FREE.iter().fold(judge.numbers(planted), |numbers, block| likeliest(&[judge], &numbers, block));
    let reading = judge.read(&numbers);
    let unlikely = reading.expected.iter().zip(&reading.log_likelihoods).map(|(expected, likely)| -likely - expected);
    let mut windows: Vec<(f64, f64)> = Vec::new();
    for (step, nats) in judge.steps().iter().zip(unlikely) {
        let from_s = (step.t_s / WINDOW_S).floor() * WINDOW_S;
        match windows.last_mut() {
            Some((last_s, sum)) if *last_s == from_s => *sum += nats,
            _ => windows.push((from_s, nats)),
        }
    }
    spans.extend(standing_out(&windows));
    join(spans);
}

/// The windows that stand out, with what led to them.
fn standing_out(windows: &[(f64, f64)]) -> Vec<[f64; 2]> {
    let usual = median(&windows.iter().map(|it| it.1).collect::<Vec<f64>>()).unwrap_or(0.0);
    let out = windows.iter().filter(|(_, nats)| nats - usual > STANDS_OUT_NATS);
    out.map(|(from_s, _)| [from_s - EARLIER_S, from_s + WINDOW_S]).collect()
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
        let mut windows: Vec<(f64, f64)> = (0..100).map(|i| (3.0 * f64::from(i), f64::from(i * 7 % 5) - 2.0)).collect();
        assert!(standing_out(&windows).is_empty());
        windows[40].1 = 60.0;
        windows[41].1 = 30.0;
        windows[70].1 = 9.0;
        let mut spans = standing_out(&windows);
        assert_eq!(spans, vec![[117.0, 123.0], [120.0, 126.0]]);
        spans.extend([[10.0, 20.0], [11.0, 12.0]]);
        join(&mut spans);
        assert_eq!(spans, vec![[10.0, 20.0], [117.0, 126.0]]);
        assert!(standing_out(&[]).is_empty());
    }
}
