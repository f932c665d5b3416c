//! Cases that another program wrote.

use std::sync::atomic::Ordering;

use asami::blind::draw::Mix;
use asami::blind::walk::run;
use asami::blind::withhold::withhold;
use asami::blind::{Planting, rows};
use asami::sweep::Silent;
use asami_gap::weigh::practice::{NONE_SHARE, ONE_SHARE};

use crate::{ASKED, blind, options, stand_ins};

/// The same logs give the same answers as if they were drawn here, and no key is opened before
/// everything is said.
#[test]
fn cases_of_a_folder_are_scored_like_drawn_ones_and_keys_are_opened_last() {
    let text = ASKED.replace("duration_s = 5", "duration_s = 20").replace("cases = 12", "cases = 8");
    let drawn = blind(&text);
    let dir = tempfile::tempdir().expect("made");
    let folder = dir.path().join("foreign");
    let planting = Planting {
        nominal: drawn.world.clone(),
        salt: drawn.asked.salt.clone(),
        mix: drawn.asked.mix.clone(),
        places: drawn.asked.places.clone(),
    };
    withhold(&planting, "plain_2d", 8, &folder, &|_| {}).expect("written");
    let from = format!("cases_from = \"{}\"", folder.display());
    let foreign = blind(&text.replace("salt = \"1000\"", &from));
    let contest = stand_ins();
    let here = run(&drawn, &contest, &options(&dir.path().join("here"), 2), &Silent).expect("run");
    assert_eq!(contest.calls.swap(0, Ordering::Relaxed), 16);

    let (keys, away) = (folder.join("keys"), dir.path().join("away"));
    std::fs::rename(&keys, &away).expect("put away");
    let out = options(&dir.path().join("there"), 2);
    let error = run(&foreign, &contest, &out, &Silent).expect_err("no key").to_string();
    assert!(error.contains("cannot read the key"), "{error}");
    assert_eq!(contest.calls.swap(0, Ordering::Relaxed), 16);
    std::fs::rename(&away, &keys).expect("put back");
    let there = run(&foreign, &contest, &out, &Silent).expect("run");
    assert_eq!(contest.calls.swap(0, Ordering::Relaxed), 0, "what was said before stands");
    let [here, there] = [&here, &there].map(rows::trials);
    let alike = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        // A size is a parameter's distance from its null value: writing it as the parameter costs a bit.
        (Ok(a), Ok(b)) => (a - b).abs() < 1e-9,
        _ => a == b,
    };
    assert_eq!(here.lines().count(), there.lines().count());
    for (here, there) in here.lines().zip(there.lines()) {
        assert!(here.split(',').zip(there.split(',')).all(alike), "{here}\n{there}");
    }

    // What the catalogue has no name for is unknown; how far it shows, nobody can say.
    let key = keys.join("001/key.toml");
    let sound = std::fs::read_to_string(&key).expect("a key");
    let (head, _) = sound.split_once("[effects").expect("a table");
    let limp = "[[unlisted]]\nname = \"limp\"\nplace = \"actuation\"\nblock = \"static_motion\"\nsize = 0.2\n";
    std::fs::write(&key, format!("{head}{limp}")).expect("written");
    let record = &run(&foreign, &contest, &out, &Silent).expect("run").records[0];
    assert_eq!((&record.planted[..], &record.withheld[..]), (&["limp".to_owned()][..], &["limp".to_owned()][..]));
    assert_eq!(record.reference.as_ref().map(|it| (it.d_det, it.d_sep)), Some((None, None)));
    assert!(record.answers.iter().all(|answer| !answer.top_group_right && answer.oracle_closed.is_none()));
    let none = format!("{head}[effects.slope]\nuphill_rad = 0.3\npitch_rad = 0.02\n");
    std::fs::write(&key, none).expect("written");
    let error = run(&foreign, &contest, &out, &Silent).expect_err("of no law").to_string();
    assert!(error.contains("slope of these values is no kind"), "{error}");

    let more = blind(&text.replace("salt = \"1000\"", &from).replace("cases = 8", "cases = 9"));
    let error = run(&more, &contest, &out, &Silent).expect_err("too few").to_string();
    assert!(error.contains("holds 8 cases, of which 9 are asked for"), "{error}");
}

/// Probabilities that are learned from cases of another mix would be off by the difference.
#[test]
fn diagnosers_learn_from_cases_of_the_mix_that_they_are_asked_of() {
    let mix = Mix::default();
    assert_eq!((mix.none_share, mix.one_share), (NONE_SHARE, ONE_SHARE));
}
