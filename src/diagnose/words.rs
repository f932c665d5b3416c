//! A diagnosis in a dozen lines.

use std::fmt::Write as _;

use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::{Cause, Estimate, Kind, Suspect, Unsettled, Verdict};
use asami_sim::effects::catalogue;

/// Places and causes said of each.
const MOST: usize = 3;
/// Members of the 90 % set said.
const MOST_OF_SET: usize = 5;
/// Smallest visible sizes said where there is no gap.
const MOST_VISIBLE: usize = 6;

/// The three answers, as the command line gives them.
#[must_use]
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut out = String::new();
    let mut say = |head: &str, line: &str| {
        let _ = writeln!(out, "{head:<9}{line}");
    };
    say("verdict", &verdict(diagnosis));
    for (i, place) in diagnosis.places.iter().take(MOST).enumerate() {
        let [low, high] = place.interval;
        let line = format!(
            "{:>3.0} % of the gap ({:.0} to {:.0} %) in {}, {}: {}, p = {}",
            100.0 * place.share,
            100.0 * low,
            100.0 * high,
            place.channel,
            place.regime,
            kind(place.kind),
            probability(place.p)
        );
        say(if i == 0 { "where" } else { "" }, &line);
    }
    for (i, cause) in diagnosis.which.iter().take(MOST).enumerate() {
        say(if i == 0 { "which" } else { "" }, &format!("P = {:<9}{}", share(cause.probability), of_cause(cause)));
    }
    if !diagnosis.set90.is_empty() {
        let set: Vec<String> = diagnosis.set90.iter().take(MOST_OF_SET).map(|it| joined(it)).collect();
        let more = diagnosis.set90.len().saturating_sub(MOST_OF_SET);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        say("", &format!("90 % set: {}{more}", set.join("; ")));
    }
    for group in &diagnosis.cannot_tell_apart {
        say("", &format!("this log cannot tell apart: {}", group.join(", ")));
    }
    for (i, it) in diagnosis.unsettled.iter().enumerate() {
        say(if i == 0 { "besides" } else { "" }, &unsettled(it));
    }
    if let Some(next) = &diagnosis.next_experiment {
        say("next", next);
        if let Some(keys) = &diagnosis.next_keys {
            say("", &format!("{keys} in the scenario drives so"));
        }
    }
    let far = &diagnosis.how_far;
    if let (Some(closed), Some([low, high])) = (far.closed, far.interval) {
        let closed = format!("{:.0} % closed ({:.0} to {:.0} %)", 100.0 * closed, 100.0 * low, 100.0 * high);
        let from_to = format!("{:.4} -> {:.4} nats per observation", far.excess_before, far.excess_after);
        say("how far", &format!("{closed}: {from_to}"));
        let channels = far
            .channels
            .iter()
            .map(|(name, rms)| format!("{name} {} -> {}", digits(rms.rms_before), digits(rms.rms_after)));
        let channels: Vec<String> = channels.collect();
        if !channels.is_empty() {
            say("", &format!("RMS of innovations: {}", channels.join(", ")));
        }
    }
    if let Some(period_s) = diagnosis.picture_period_s {
        let hz = 1.0 / period_s;
        say("camera", &format!("{hz:.4} pictures a second by a clock of its own: what it saw is dated by when it did"));
    }
    if let Some(cycle_s) = diagnosis.command_cycle_s {
        say(
            "commands",
            &format!("taken up once in {cycle_s:.4} s: they are given as they were, as far as the log tells"),
        );
    }
    if let Some(astray_s) = diagnosis.astray_s.filter(|it| *it > 0.0) {
        say(
            "astray",
            &format!("for {astray_s:.0} s the robot did not do what it was told, whatever is found: not scored"),
        );
    }
    if let Some(differ) = diagnosis.halves_differ.filter(|it| *it > 1.0) {
        let by =
            format!("differ by {} times as much as they are said to: as much less is said for sure", digits(differ));
        say("halves", &format!("of the log, or of logs of its make, {by}"));
    }
    if let Some(noise) = &diagnosis.noise {
        let [size, bearing, motion] = [noise.size_ratio, noise.bearing_ratio, noise.motion_ratio].map(digits);
        let nominal =
            format!("sizes scatter {size} times as nominally, bearings {bearing} times, motion {motion} times");
        say("noise", &format!("{nominal} (of each half of the log, in pieces, by the other)"));
        if noise.lasting_share > 0.0 {
            let [percent, fades_s] = [100.0 * noise.lasting_share, noise.fades_s].map(digits);
            let lasts = format!("{percent} % of the variance of sizes lasts: it fades to 1/e in {fades_s} s");
            say("", &format!("{lasts}, each landmark's by itself"));
        }
    }
    if diagnosis.verdict == Verdict::None && !diagnosis.smallest_visible.is_empty() {
        let visible =
            diagnosis.smallest_visible.iter().map(|(path, size)| format!("{path} {}", with_unit(path, *size)));
        let visible: Vec<String> = visible.take(MOST_VISIBLE).collect();
        let more = diagnosis.smallest_visible.len().saturating_sub(MOST_VISIBLE);
        let more = if more > 0 { format!(" and {more} more in report.html") } else { String::new() };
        say("visible", &format!("this log would have shown: {}{more}", visible.join(", ")));
    }
    out
}

/// The verdict in a sentence.
#[must_use]
pub fn verdict(diagnosis: &Diagnosis) -> String {
    let leads = diagnosis.which.first();
    let name = leads.map(|cause| joined(&cause.effects)).unwrap_or_default();
    let certain = leads.map(|cause| format!(" (P = {})", share(cause.probability))).unwrap_or_default();
    match diagnosis.verdict {
        Verdict::Named => format!("named: {name}{certain}"),
        Verdict::Tied => {
            let tied: Vec<String> = diagnosis.set90.iter().map(|it| joined(it)).collect();
            format!("tied: {}", if tied.is_empty() { name } else { tied.join(" or ") })
        }
        Verdict::Unknown => {
            let unknown = diagnosis.which.iter().find(|cause| cause.effects.iter().any(|it| it == "unknown"));
            let block = unknown.and_then(|cause| cause.block.as_deref());
            let like = unknown.and_then(|cause| cause.behaves_like.as_deref());
            let block = block.map(|block| format!(", in {}", block.replace('_', " "))).unwrap_or_default();
            let like = like.map(|like| format!("; behaves like {like}")).unwrap_or_default();
            format!("unknown: something that no effect of the catalogue explains{block}{like}")
        }
        Verdict::None => "none: nothing parts this log from the nominal world".to_owned(),
    }
}

/// What a small part of the gap may be, and how small it is.
#[must_use]
pub fn unsettled(it: &Unsettled) -> String {
    let suspect = |it: &Suspect| format!("{} (P = {})", it.effect, share(it.probability));
    let one_of: Vec<String> = it.one_of.iter().map(suspect).collect();
    format!("{}: {} % of what is explained", one_of.join(" or "), digits(100.0 * it.share))
}

fn of_cause(cause: &Cause) -> String {
    let mut out = joined(&cause.effects);
    if let Some(block) = &cause.block {
        let _ = write!(out, ", in {}", block.replace('_', " "));
    }
    if let Some(like) = &cause.behaves_like {
        let _ = write!(out, ", behaves like {like}");
    }
    for (path, estimate) in &cause.parameters {
        let _ = write!(out, "  {path} = {}", estimated(path, estimate));
    }
    out
}

/// Value, interval and unit of a parameter `NAME.PARAM`.
#[must_use]
pub fn estimated(path: &str, estimate: &Estimate) -> String {
    let [low, high] = estimate.interval;
    let unit = unit(path).filter(|unit| *unit != "1").map(|unit| format!(" {unit}")).unwrap_or_default();
    let value = size(path, estimate.value);
    let end = if estimate.at_end { ", the largest that is known" } else { "" };
    let interval = if low == high { String::new() } else { format!(" ({} to {})", size(path, low), size(path, high)) };
    format!("{value}{interval}{unit}{end}")
}

/// A size of a parameter `NAME.PARAM` with its unit.
#[must_use]
pub fn with_unit(path: &str, value: f64) -> String {
    let unit = unit(path).filter(|unit| *unit != "1").map(|unit| format!(" {unit}")).unwrap_or_default();
    format!("{}{unit}", digits(value))
}

/// The unit of a parameter `NAME.PARAM` of the catalogue.
#[must_use]
pub fn unit(path: &str) -> Option<&'static str> {
    let (name, parameter) = path.split_once('.')?;
    let about = catalogue().into_iter().find(|about| about.name == name)?;
    about.parameters.iter().find(|it| it.name == parameter).map(|it| it.unit)
}

/// What differs, in a word or two.
#[must_use]
pub fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Bias => "bias",
        Kind::Spread => "spread",
        Kind::Memory => "memory",
    }
}

/// Effects of one cause.
#[must_use]
pub fn joined(effects: &[String]) -> String {
    effects.join(" + ")
}

/// Three digits that tell something.
#[must_use]
pub fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0);
    format!("{value:.*}", decimals as usize)
}

/// A size of a parameter `NAME.PARAM`: three digits, and of a factor that is nearly 1 two of what it is off.
#[must_use]
pub fn size(path: &str, value: f64) -> String {
    let off = (value - 1.0).abs();
    if !path.ends_with("ratio") || off == 0.0 || off >= 0.1 {
        return digits(value);
    }
    let decimals = (1.0 - off.log10().floor()).clamp(3.0, 4.0);
    format!("{value:.*}", decimals as usize)
}

/// A probability, never rounded to certainty.
#[must_use]
pub fn share(probability: f64) -> String {
    match probability {
        p if p > 0.999 && p < 1.0 => "> 0.999".to_owned(),
        p if p < 0.001 && p > 0.0 => "< 0.001".to_owned(),
        p => format!("{p:.3}"),
    }
}

fn probability(p: f64) -> String {
    if p < 0.001 && p > 0.0 { format!("{p:.0e}") } else { format!("{p:.3}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_that_tell_and_probabilities_are_never_certain() {
        let read = [0.0812345, 1234.5, -2.345678, 0.0, 1e-7].map(digits);
        assert_eq!(read, ["0.0812", "1234", "-2.35", "0", "0.000000100"]);
        let factors = [1.0, 1.02, 0.9948, 1.00213, 0.99996, 0.8976, 1.3].map(|it| size("wheel_base.ratio", it));
        assert_eq!(factors, ["1.00", "1.020", "0.9948", "1.0021", "1.0000", "0.898", "1.30"]);
        assert_eq!(size("turn_slowing.loss_s2", 1.02), "1.02");
        assert_eq!([0.99999, 1.0, 0.0001, 0.93].map(share), ["> 0.999", "1.000", "< 0.001", "0.930"]);
    }

    #[test]
    fn a_value_at_the_end_of_what_is_known_says_so() {
        let estimate = |at_end: bool| Estimate { value: 0.008, interval: [0.007, 0.008], at_end };
        let said = |at_end: bool| estimated("steering_offset.offset_rad", &estimate(at_end));
        assert_eq!(said(false), "0.00800 (0.00700 to 0.00800) rad");
        assert_eq!(said(true), "0.00800 (0.00700 to 0.00800) rad, the largest that is known");
    }

    #[test]
    fn what_is_not_settled_is_said_with_how_little_it_is() {
        let suspect = |effect: &str, probability: f64| Suspect { effect: effect.to_owned(), probability };
        let one_of = vec![suspect("wheel_base", 0.55), suspect("unequal_wheels", 0.41)];
        let mut diagnosis: Diagnosis = serde_json::from_str(super::super::EXAMPLE).unwrap();
        assert!(
            !text(&diagnosis).contains("besides") && !serde_json::to_string(&diagnosis).unwrap().contains("unsettled")
        );
        diagnosis.unsettled = vec![Unsettled { one_of, share: 0.0042 }];
        let said = "besides  wheel_base (P = 0.550) or unequal_wheels (P = 0.410): 0.420 % of what is explained";
        assert!(text(&diagnosis).contains(said), "{}", text(&diagnosis));
        let read: Diagnosis = serde_json::from_str(&serde_json::to_string(&diagnosis).unwrap()).unwrap();
        assert_eq!(read, diagnosis);
    }

    #[test]
    fn an_answer_is_a_dozen_lines_that_name_all_three() {
        let diagnosis: Diagnosis = serde_json::from_str(super::super::EXAMPLE).unwrap();
        let text = text(&diagnosis);
        assert!((6..=14).contains(&text.lines().count()), "{text}");
        for word in ["named: command_delay", "71 % of the gap", "delay_s = 0.0810 (0.0740 to 0.0880) s", "94 % closed"]
        {
            assert!(text.contains(word), "{word} is not in\n{text}");
        }
    }
}
