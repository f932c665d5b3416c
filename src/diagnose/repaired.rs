//! The nominal scenario with the effects that were found: `with_effect.toml`.

use std::collections::{BTreeMap, BTreeSet};

use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::{Cause, Estimate, Noise, Verdict};
use asami_sim::effect::About;
use asami_sim::effects::{Effects, catalogue};
use toml::{Table, Value};
use toml_edit::DocumentMut;

use crate::scenario::{self, Origin, Policy};

/// No wheel or sensor is noisier: m/s, m or rad.
const MOST_NOISE: f64 = 0.5;

/// A nominal scenario cannot be given effects.
#[derive(Debug, thiserror::Error)]
#[error("the nominal scenario with {effects} in it would not be one: {why}")]
pub struct CannotRepair {
    effects: String,
    why: String,
}

/// The most probable cause that can be put into a scenario; `None` where the answer is no effect of the catalogue.
#[must_use]
pub fn cause(diagnosis: &Diagnosis) -> Option<&Cause> {
    let leads = diagnosis.which.first()?;
    let named = matches!(diagnosis.verdict, Verdict::Named | Verdict::Tied) && !leads.parameters.is_empty();
    named.then_some(leads)
}

/// `text`, a scenario, with the effects of `cause` on at the values found: comments and all, where the effects are
/// not on already.
///
/// # Errors
/// [`CannotRepair`] where the cause's effects, parameters or values are none of the catalogue's for that robot.
pub fn repaired(text: &str, cause: &Cause) -> Result<String, CannotRepair> {
    let failed = |why: String| CannotRepair { effects: cause.effects.join(" and "), why };
    let settings = settings(cause);
    let mut wanted: Effects = effects(text).map_err(failed)?;
    for (about, parameter, value) in &settings {
        if !wanted.set(about.name, parameter, *value) {
            return Err(failed(format!("{} has no parameter {parameter}", about.name)));
        }
    }
    let appended = appended(text, &settings);
    if effects(&appended).is_ok_and(|found| found == wanted) {
        return Ok(appended);
    }
    // The effect stands there already, in whatever of TOML's forms.
    let mut table: Table = text.parse().map_err(|error: toml::de::Error| failed(error.to_string()))?;
    let on = table.entry("effects").or_insert_with(|| Value::Table(Table::new()));
    let written = Value::try_from(&wanted).map_err(|error| failed(error.to_string()))?;
    *on = written;
    let rewritten = toml::to_string(&table).map_err(|error| failed(error.to_string()))?;
    match effects(&rewritten) {
        Ok(found) if found == wanted => Ok(rewritten),
        Ok(_) => Err(failed("its effects are not the ones asked for".to_owned())),
        Err(why) => Err(failed(why)),
    }
}

/// The nominal scenario with what a diagnosis says of a log: the effects of its `cause`, and of a real robot its noise and the clocks of
/// its own.
///
/// # Errors
/// [`CannotRepair`] as of either.
pub fn whole(text: &str, cause: &Cause, diagnosis: &Diagnosis) -> Result<String, CannotRepair> {
    let repaired = repaired(text, &by_its_clocks(cause, diagnosis))?;
    if let Some(noise) = &diagnosis.noise { noisy(&repaired, noise) } else { Ok(repaired) }
}

/// The same of each world that a real robot's diagnosis draws, as it is believed; where it draws none, with the `cause` alone.
///
/// # Errors
/// [`CannotRepair`] as of either.
pub fn believed(text: &str, cause: &Cause, diagnosis: &Diagnosis) -> Result<Vec<String>, CannotRepair> {
    let drawn = |values: &BTreeMap<String, f64>| {
        let names = values.keys().filter_map(|path| path.split_once('.')).map(|(name, _)| name.to_owned());
        let effects: BTreeSet<String> = names.collect();
        let estimate = |value: f64| Estimate { value, interval: [value; 2], at_end: false };
        let parameters = values.iter().map(|(path, value)| (path.clone(), estimate(*value))).collect();
        Cause { effects: effects.into_iter().collect(), parameters, ..cause.clone() }
    };
    match diagnosis.draws.is_empty() {
        true => Ok(vec![whole(text, cause, diagnosis)?]),
        false => diagnosis.draws.iter().map(|values| whole(text, &drawn(values), diagnosis)).collect(),
    }
}

/// A cause, and the clocks of the camera and of whoever takes commands up, if they are the robot's own.
fn by_its_clocks(cause: &Cause, diagnosis: &Diagnosis) -> Cause {
    let clocks = [
        ("stale_pictures.period_s", diagnosis.picture_period_s),
        ("command_cycle.period_s", diagnosis.command_cycle_s),
    ];
    let mut all = cause.clone();
    for (name, value) in clocks.into_iter().filter_map(|(name, value)| Some((name, value?))) {
        all.parameters.insert(name.to_owned(), Estimate { value, interval: [value; 2], at_end: false });
    }
    all
}

/// `text`, a scenario of a robot on wheels, as noisy as a log says; others stay as they are.
///
/// # Errors
/// [`CannotRepair`] where the text is no scenario, or none with that noise.
pub fn noisy(text: &str, noise: &Noise) -> Result<String, CannotRepair> {
    let failed = |why: String| CannotRepair { effects: "noise".to_owned(), why };
    let parsed = |text: &str| {
        let scenario = scenario::parse("with_effect", "with_effect.toml", text).map_err(|bad| bad.to_string())?;
        Ok::<_, String>(if let Origin::Simulated(it) = scenario.origin { Some(it.drive) } else { None })
    };
    let Some(Policy::Roam(roams)) = parsed(text).map_err(failed)? else { return Ok(text.to_owned()) };
    let (sight, wheels) = (&roams.create.sight, &roams.create.wheels);
    let mut edited: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| failed(error.to_string()))?;
    for (table, key, was, ratio) in [
        ("sight", "sigma1_m", sight.sigma1_m, noise.size_ratio),
        ("sight", "sigma2_rad", sight.sigma2_rad, noise.bearing_ratio),
        ("wheels", "jitter_m_per_s", wheels.jitter_m_per_s, noise.motion_ratio),
    ] {
        edited["create"][table][key] = toml_edit::value((was * ratio).min(MOST_NOISE));
    }
    if noise.lasting_share > 0.0 {
        edited["create"]["sight"]["lasting_share"] = toml_edit::value(noise.lasting_share);
        edited["create"]["sight"]["fades_s"] = toml_edit::value(noise.fades_s);
    }
    let edited = edited.to_string();
    parsed(&edited).map_err(failed)?;
    Ok(edited)
}

/// Effect, parameter and value, within the parameter's range.
fn settings(cause: &Cause) -> Vec<(&'static About, String, f64)> {
    let about = |name: &str| catalogue().into_iter().find(|about| about.name == name);
    let found = cause.parameters.iter().filter_map(|(path, estimate)| {
        let (name, parameter) = path.split_once('.')?;
        let about = about(name)?;
        let range = about.parameters.iter().find(|it| it.name == parameter).map(|it| it.range);
        let value = range.map_or(estimate.value, |(least, greatest)| estimate.value.clamp(least, greatest));
        Some((about, parameter.to_owned(), value))
    });
    found.collect()
}

fn appended(text: &str, settings: &[(&About, String, f64)]) -> String {
    let mut out = text.trim_end().to_owned() + "\n";
    let mut last = "";
    for (about, parameter, value) in settings {
        if about.name != last {
            out += &format!("\n# Found by `diagnose`: {}\n[effects.{}]\n", about.what, about.name);
            last = about.name;
        }
        // `{:?}` is the shortest text that reads back the same bits, and always a float to TOML.
        out += &format!("{parameter} = {value:?}\n");
    }
    out
}

/// The effects of a simulated scenario of this text.
fn effects(text: &str) -> Result<Effects, String> {
    let scenario = scenario::parse("with_effect", "with_effect.toml", text).map_err(|bad| bad.to_string())?;
    match scenario.origin {
        Origin::Simulated(simulation) => Ok(simulation.effects),
        Origin::Recorded(_) => Err("it is about a recorded log".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use asami_gap::answer::diagnosis::Estimate;
    use asami_sim::robots::create::config::Sight;

    use super::*;

    const NOMINAL: &str = r#"
schema = 1
about = "Does it walk?"   # a remark
robot = "aibo"
duration_s = 10
seeds = 1
[[field.beacons]]
id = 0
body = { x_m = 0.0, y_m = 0.0, radius_m = 0.05, base_m = 0.1, height_m = 0.2, bands = ["pink", "yellow"] }
[[rows]]
learner = "canonical"
"#;

    fn found(parameters: &[(&str, f64)]) -> Cause {
        let estimate = |value: f64| Estimate { value, interval: [value, value], at_end: false };
        Cause {
            effects: vec!["some".into()],
            probability: 0.9,
            evidence_nats: 1.0,
            adequacy_p: None,
            place: None,
            block: None,
            behaves_like: None,
            parameters: parameters.iter().map(|(name, value)| ((*name).to_owned(), estimate(*value))).collect(),
        }
    }

    /// What is written parses again, to the very bits, and keeps the remarks.
    #[test]
    fn a_repaired_scenario_is_the_nominal_one_with_the_effect() {
        let delay_s = 0.1 + 0.2;
        let text = repaired(NOMINAL, &found(&[("command_delay.delay_s", delay_s)])).unwrap();
        assert!(text.contains("# a remark"));
        let on = effects(&text).unwrap();
        assert_eq!(on.command_delay.as_ref().unwrap().delay_s.to_bits(), delay_s.to_bits());
        assert_eq!(on.without("command_delay"), Effects::default());
    }

    /// An effect that is on already takes the new value, however it was written.
    #[test]
    fn an_effect_that_is_on_is_set_anew() {
        for on in ["\n[effects]\ncommand_delay = { delay_s = 0.02 }\n", "\n[effects.command_delay]\ndelay_s = 0.02\n"] {
            let nominal = NOMINAL.to_owned() + on;
            let text = repaired(&nominal, &found(&[("command_delay.delay_s", 0.08)])).unwrap();
            assert_eq!(effects(&text).unwrap().command_delay.unwrap().delay_s, 0.08, "{text}");
        }
    }

    #[test]
    fn values_stay_within_their_ranges_and_foreign_names_are_refused() {
        let text = repaired(NOMINAL, &found(&[("command_delay.delay_s", 1e9)])).unwrap();
        let greatest = catalogue().iter().find(|it| it.name == "command_delay").unwrap().parameters[0].range.1;
        assert_eq!(effects(&text).unwrap().command_delay.unwrap().delay_s, greatest);
        let error = repaired(NOMINAL, &found(&[("command_delay.delya_s", 0.1)])).unwrap_err();
        assert!(error.to_string().contains("no parameter delya_s"), "{error}");
    }

    /// A robot on wheels takes the noise of its log, wherever its scenario says how noisy it is; a walking one stays as it is.
    #[test]
    fn a_repaired_robot_is_as_noisy_as_its_log() {
        let of_scatter = Noise { size_ratio: 2.0, bearing_ratio: 0.5, motion_ratio: 3.0, ..Noise::default() };
        let noise = Noise { lasting_share: 0.75, fades_s: 8.0, ..of_scatter };
        let nominal = include_str!("../../scenarios/create.toml");
        let text = noisy(nominal, &noise).unwrap();
        assert!(text.contains("# numbers of no log"), "remarks are kept");
        let of = |text: &str| match scenario::parse("create", "create.toml", text).unwrap().origin {
            Origin::Simulated(it) => match it.drive {
                Policy::Roam(roams) => roams.create,
                _ => panic!("it roams"),
            },
            Origin::Recorded(_) => panic!("it is simulated"),
        };
        let (before, after) = (of(nominal), of(&text));
        assert!((after.sight.sigma1_m - 2.0 * before.sight.sigma1_m).abs() < 1e-15);
        assert!((after.sight.sigma2_rad - 0.5 * before.sight.sigma2_rad).abs() < 1e-15);
        assert!((after.wheels.jitter_m_per_s - 3.0 * before.wheels.jitter_m_per_s).abs() < 1e-15);
        let lasts = |it: &Sight| [it.lasting_share, it.fades_s];
        assert_eq!(lasts(&after.sight), [0.75, 8.0]);
        let white = of(&noisy(nominal, &of_scatter).unwrap());
        assert_eq!(lasts(&white.sight), lasts(&before.sight));
        assert_eq!(noisy(NOMINAL, &noise).unwrap(), NOMINAL);
    }

    /// Clocks are no cause, and are in the robot all the same; without any nothing is.
    #[test]
    fn a_repaired_robot_has_its_clocks() {
        let nominal = include_str!("../../scenarios/create.toml");
        let scaled = found(&[("wheel_base.ratio", 1.05)]);
        for (picture_period_s, command_cycle_s) in [(None, None), (Some(0.1004), None), (Some(0.1), Some(0.2162))] {
            let clocks = Diagnosis { picture_period_s, command_cycle_s, ..Diagnosis::flat(&[]) };
            let on = effects(&whole(nominal, &scaled, &clocks).unwrap()).unwrap();
            assert_eq!(on.stale_pictures.map(|it| it.period_s), picture_period_s);
            assert_eq!(on.command_cycle.map(|it| it.period_s), command_cycle_s);
            assert_eq!(on.wheel_base.map(|it| it.ratio), Some(1.05));
        }
    }

    /// Every world that is drawn is a scenario with what it has and nothing else; without any there is the one with the cause.
    #[test]
    fn worlds_as_they_are_believed_are_scenarios() {
        let nominal = include_str!("../../scenarios/create.toml");
        let named = found(&[("wheel_base.ratio", 1.05)]);
        let two = BTreeMap::from([("wheel_base.ratio".to_owned(), 1.04), ("wheel_lag.lag_s".to_owned(), 0.1)]);
        let draws = vec![two, BTreeMap::from([("wheel_base.ratio".to_owned(), 1.07)])];
        let diagnosis = Diagnosis { draws, ..Diagnosis::flat(&[]) };
        let of = |diagnosis: &Diagnosis| {
            let texts = believed(nominal, &named, diagnosis).unwrap();
            texts.iter().map(|text| effects(text).unwrap()).collect::<Vec<_>>()
        };
        let worlds = of(&diagnosis);
        let on = |it: &Effects| (it.wheel_base.as_ref().map(|it| it.ratio), it.wheel_lag.as_ref().map(|it| it.lag_s));
        assert_eq!(worlds.iter().map(on).collect::<Vec<_>>(), [(Some(1.04), Some(0.1)), (Some(1.07), None)]);
        assert_eq!(worlds[1].without("wheel_base"), Effects::default());
        let alone = of(&Diagnosis::flat(&[]));
        assert_eq!(alone.iter().map(on).collect::<Vec<_>>(), [(Some(1.05), None)]);
    }

    #[test]
    fn only_a_named_effect_is_put_into_a_scenario() {
        let mut diagnosis = Diagnosis {
            schema: 1,
            verdict: Verdict::Unknown,
            places: Vec::new(),
            which: vec![found(&[("command_delay.delay_s", 0.1)])],
            set90: Vec::new(),
            cannot_tell_apart: Vec::new(),
            unsettled: Vec::new(),
            draws: Vec::new(),
            next_experiment: None,
            next_keys: None,
            next_nats: None,
            next_length_s: None,
            smallest_visible: BTreeMap::new(),
            astray_s: None,
            halves_differ: None,
            picture_period_s: None,
            command_cycle_s: None,
            noise: None,
            calibrated_on: None,
            how_far: asami_gap::answer::diagnosis::HowFar::default(),
        };
        assert!(cause(&diagnosis).is_none());
        diagnosis.verdict = Verdict::Tied;
        assert!(cause(&diagnosis).is_some());
    }
}
