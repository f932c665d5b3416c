//! Withheld cases: everything follows from the salt, and nothing in a case gives its key away.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use asami::blind::withhold::{CannotWithhold, Key, withhold};
use asami::blind::{Mix, Planting};
use asami::scenario::{self, Origin};
use asami_dataset::store;
use asami_gap::Variant;
use asami_sim::effects::catalogue;
use proptest::prelude::*;

const PLAIN: &str = include_str!("../scenarios/plain_2d.toml");

/// Logs of the plain robot, of eight seconds.
fn planting(salt: &str, none_share: f64, one_share: f64) -> Planting {
    let scenario = scenario::parse("plain_2d", "plain_2d.toml", PLAIN).expect("sound");
    let Origin::Simulated(nominal) = scenario.origin else { panic!("simulated") };
    let mut nominal = *nominal;
    nominal.duration_s = 8.0;
    Planting { nominal, salt: salt.to_owned(), mix: Mix { none_share, one_share }, places: Vec::new() }
}

fn write(planting: &Planting, count: usize, out: &Path) {
    withhold(planting, "plain_2d", count, out, &|_| {}).expect("written");
}

/// Every file below a folder with its bytes and when it was made.
fn files(folder: &Path) -> BTreeMap<String, (Vec<u8>, std::time::SystemTime)> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).expect("below").display().to_string();
            let made = entry.metadata().expect("metadata").modified().expect("a time");
            found.insert(name, (fs::read(&path).expect("bytes"), made));
        }
    }
    found
}

fn holds(text: &[u8], word: &str) -> bool {
    text.windows(word.len()).any(|window| window == word.as_bytes())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn cases_follow_from_the_salt_alone_and_tell_nothing(number in 1000..9999_u32) {
        let salt = format!("a salt {number}");
        let dir = tempfile::tempdir().expect("made");
        let (first, again) = (dir.path().join("first"), dir.path().join("again"));
        let planting = planting(&salt, 0.2, 0.4);
        write(&planting, 6, &first);
        let cases = files(&first.join("cases"));
        fs::remove_dir_all(first.join("keys")).expect("removed");
        prop_assert_eq!(&cases, &files(&first.join("cases")));
        // Fewer of the same salt are the first of them, keys or no keys.
        write(&planting, 4, &again);
        let fewer: BTreeMap<_, _> = cases.clone().into_iter().filter(|(name, _)| name.as_str() < "005").collect();
        prop_assert_eq!(&fewer, &files(&again.join("cases")));

        let words = catalogue().into_iter().map(|about| about.name).chain([salt.as_str(), "seed", "salt", "provenance"]);
        let words: Vec<&str> = words.collect();
        let known = &cases["001/dataset.toml"];
        for (name, (bytes, made)) in &cases {
            for word in &words {
                prop_assert!(!name.contains(word) && !holds(bytes, word), "{} holds {}", name, word);
            }
            prop_assert!(!name.ends_with("truth.csv") && !name.ends_with("survey.toml"), "{}", name);
            prop_assert_eq!(made, &known.1);
            prop_assert!(!name.ends_with("dataset.toml") || bytes == &known.0, "{}", name);
        }
    }
}

/// What the key says, generated again, is the case; of another salt, nothing is the same.
#[test]
fn a_key_opens_its_case() {
    let dir = tempfile::tempdir().expect("made");
    let out = dir.path().join("out");
    let planting = planting("1000", 0.0, 0.0);
    write(&planting, 3, &out);
    for name in ["001", "002", "003"] {
        let text = fs::read_to_string(out.join("keys").join(name).join("key.toml")).expect("a key");
        let key: Key = toml::from_str(&text).expect("TOML");
        assert_eq!(key.effects.iter().count(), 2, "{text}");
        assert!(key.effects.iter().all(|effect| !effect.is_null()), "{text}");
        let mut simulation = planting.nominal.clone();
        simulation.effects = key.effects;
        let again = simulation.dataset(asami_dataset::Seed(key.seed)).expect("built");
        let case = store::read(&out.join("cases").join(name)).expect("a data set");
        assert_eq!(case.log.sightings, again.log.sightings);
        assert_eq!(case.log.commands, again.log.commands);
        assert_eq!(case.log.known.nominal.as_deref(), Some("plain_2d"));
        let truth = store::read(&out.join("keys").join(name)).expect("a data set").truth;
        assert_eq!(truth, again.truth);
    }
    let other = self::planting("1001", 0.0, 0.0);
    assert!((1..=20).all(|number| planting.case(number).seed != other.case(number).seed));
    assert!(matches!(withhold(&planting, "plain_2d", 1, &out, &|_| {}), Err(CannotWithhold::Occupied(_))));
}

/// Over 4000 cases: shares as asked, every kind of effect, sizes log-uniform within the law.
#[test]
fn cases_are_drawn_as_the_mix_and_the_laws_say() {
    let planting = planting("1002", 0.3, 0.5);
    let cases: Vec<_> = (1..=4000).map(|number| planting.case(number)).collect();
    let share = |count: usize| cases.iter().filter(|case| case.planted.len() == count).count() as f64 / 4000.0;
    for (count, expected) in [(0, 0.3), (1, 0.5), (2, 0.2)] {
        // Four standard deviations of a share of 4000.
        let bound = 4.0 * f64::sqrt(expected * (1.0 - expected) / 4000.0);
        assert!((share(count) - expected).abs() < bound, "{count}: {}", share(count));
    }
    let planted: Vec<_> = cases.iter().flat_map(|case| &case.planted).collect();
    for variant in Variant::all("plain", 4, &[]) {
        assert!(planted.iter().any(|planted| planted.variant == variant), "no {}", variant.name());
    }
    let place = |size: f64, (least, greatest): (f64, f64)| (size / least).ln() / (greatest / least).ln();
    let places: Vec<f64> = planted.iter().map(|planted| place(planted.size, planted.variant.sizes())).collect();
    assert!(places.iter().all(|place| (0.0..=1.0).contains(place)));
    let mean = places.iter().sum::<f64>() / places.len() as f64;
    assert!((mean - 0.5).abs() < 4.0 / (12.0 * places.len() as f64).sqrt(), "{mean}");
    for case in &cases {
        let mut names: Vec<_> = case.planted.iter().map(|planted| planted.variant.about.name).collect();
        names.dedup();
        assert_eq!(names.len(), case.planted.len());
    }
}

#[test]
fn the_verb_withholds() {
    let dir = tempfile::tempdir().expect("made");
    let (scenario, out) = (dir.path().join("short.toml"), dir.path().join("out"));
    fs::write(&scenario, PLAIN.replace("duration_s = 900", "duration_s = 5")).expect("written");
    let run = |arguments: &[&str]| {
        let paths = [scenario.to_str().expect("text"), "-o", out.to_str().expect("text")];
        Command::new(env!("CARGO_BIN_EXE_generate")).args(paths).args(arguments).output().expect("run")
    };
    let output = run(&["--withhold", "--salt", "x", "--cases", "2", "--duration-s", "3"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let log = store::read(&out.join("cases/002")).expect("a data set").log;
    assert!(log.span_s().is_some_and(|(_, last_s)| last_s <= 3.0));
    assert!(out.join("keys/002/truth.csv").is_file());
    for refused in [&["--withhold"][..], &["--withhold", "--salt", "x"], &["--salt", "x", "--cases", "2"]] {
        assert_eq!(run(refused).status.code(), Some(2), "{refused:?}");
    }
}
