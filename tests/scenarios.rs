//! Scenario files: the shipped ones are read, broken ones are refused with file, line, rule and value.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use asami::real::scenario::Source;
use asami::scenario::{self, Bad};
use asami::{blind, real};
use proptest::prelude::*;

const AIBO: &str = include_str!("../scenarios/aibo_1d.toml");
const BARFOOT: &str = include_str!("../scenarios/barfoot_1d.toml");
const MRCLAM: &str = include_str!("../scenarios/mrclam.toml");
const CAR: &str = include_str!("../scenarios/car.toml");
const AV21: &str = include_str!("../scenarios/av21.toml");
const PLAIN: &str = include_str!("../scenarios/plain_2d.toml");

fn shown(bad: &Bad) -> String {
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::none());
    let mut out = String::new();
    handler.render_report(&mut out, bad).expect("writing to memory");
    out
}

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let paths = entries.map(|entry| entry.expect("readable").path());
    paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect()
}

#[test]
fn every_shipped_scenario_is_read_and_expects_something() {
    assert!(shipped().len() >= 2);
    for path in shipped() {
        // Those are read by `asami::blind` and `asami::real`.
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        if stem.starts_with("blind_") {
            let expected = match (blind::scenario::read(&path), blind::pool::read(&path)) {
                (Ok(Some(blind)), Ok(None)) => blind.asked.expect.len(),
                (Ok(None), Ok(Some(pool))) => pool.asked.expect.len(),
                (Err(bad), _) | (_, Err(bad)) => panic!("{}", shown(&bad)),
                _ => 0,
            };
            assert!(expected > 0, "{} is no blind scenario, or expects nothing", path.display());
            continue;
        }
        if stem.starts_with("real") {
            let read = |path: &Path| match real::scenario::read(path) {
                Ok(real) => real.map(|real| real.asked.logs).unwrap_or_default(),
                Err(bad) => panic!("{}", shown(&bad)),
            };
            let (logs, all) = (read(&path), read(&path.with_file_name("real.toml")));
            assert!(all.len() >= 4 && !logs.is_empty(), "{stem}");
            // A part of real.toml is no other question; it may leave learning out.
            let same = |log: &Source, it: &Source| it == log || Source { learned_in: None, ..it.clone() } == *log;
            assert!(logs.iter().all(|log| all.iter().any(|it| same(log, it))), "{stem}: {logs:?}");
            continue;
        }
        match scenario::read(&path) {
            Ok(scenario) => assert!(!scenario.expect.is_empty(), "{} expects nothing", path.display()),
            Err(bad) => panic!("{}", shown(&bad)),
        }
    }
}

/// Refused at `line`, which is shown with the file's name.
fn assert_refused(text: &str, line: usize, why: &str) {
    let bad = match scenario::parse("broken", "broken.toml", text) {
        Ok(_) => panic!("line {line}, {why}: taken for sound:\n{text}"),
        Err(bad) => bad,
    };
    assert_eq!(bad.line(), Some(line), "{why}: {}", shown(&bad));
    let shown = shown(&bad);
    assert!(shown.contains(&format!("broken.toml:{line}:")), "{why}: {shown}");
}

/// The lines `key = value` of a file, counted from 1; not those whose list goes on in the next line.
fn settings(text: &str) -> impl Iterator<Item = (usize, &str, &str)> {
    text.lines().enumerate().filter_map(|(i, line)| {
        let (key, value) = line.split_once(" = ")?;
        let value = if value.starts_with('"') { value } else { value.split('#').next()?.trim() };
        let is_key = key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        (is_key && value != "[").then_some((i + 1, key, value))
    })
}

/// The file with one line replaced.
fn with_line(text: &str, line: usize, replacement: &str) -> String {
    let mut out = String::new();
    for (i, old) in text.lines().enumerate() {
        writeln!(out, "{}", if i + 1 == line { replacement } else { old }).expect("memory");
    }
    out
}

/// Every setting of every shipped scenario, broken in every way that a line can be.
#[test]
fn every_broken_line_is_refused_where_it_stands() {
    let mut broken = 0;
    for text in [AIBO, BARFOOT, PLAIN] {
        for (line, key, value) in settings(text) {
            let is_number = value.parse::<f64>().is_ok();
            let mut ways = vec![
                (format!("{key}x = {value}"), line, "unknown key"),
                (format!("{key} = "), line, "no value"),
                (format!("{key} {value}"), line, "no equals sign"),
                (format!("{key} = {value}\n{key} = {value}"), line + 1, "twice"),
                (format!("{key} = 1979-05-27"), line, "wrong type"),
            ];
            if is_number {
                ways.push((format!("{key} = \"{value}\""), line, "a string"));
                ways.push((format!("{key} = 1e30"), line, "too large"));
                ways.push((format!("{key} = -1e30"), line, "too small"));
                ways.push((format!("{key} = nan"), line, "not a number"));
            } else if value.starts_with('"') {
                ways.push((format!("{key} = 7"), line, "a number"));
                ways.push((format!("{key} = {}", &value[..value.len() - 1]), line, "an open string"));
                if key != "about" && key != "source" && key != "as" {
                    ways.push((format!("{key} = \"nosuch\""), line, "unknown name"));
                }
            }
            for (replacement, at, why) in ways {
                assert_refused(&with_line(text, line, &replacement), at, &format!("{replacement:?} ({why})"));
                broken += 1;
            }
        }
    }
    assert!(broken >= 200, "only {broken}");
}

/// What is wrong, and what is said about it.
#[test]
fn rules_are_stated_with_the_value_and_the_remedy() {
    let cases = [
        (AIBO, "seeds = 15", "seds = 15", "did you mean `seeds`?"),
        (AIBO, "[drive]", "[dirve]", "did you mean `drive`?"),
        (AIBO, "\"pink\"", "\"pnik\"", "did you mean `pink`?"),
        (AIBO, "learner = \"algorithm1\"", "learner = \"algoritm1\"", "did you mean `algorithm1`?"),
        (AIBO, "alpha = 0.0", "alhpa = 0.0", "did you mean `alpha`?"),
        (AIBO, "alpha = 0.0", "alpha = 2.0", "alpha must lie in 0..=1, not 2"),
        (AIBO, "r2_min = 0.75", "r2_min = 1.75", "r2_min must lie in 0..=1, not 1.75"),
        (AIBO, "height_m = 0.2", "height_m = -0.2", "height_m must lie in 0.01..=5 m, not -0.2"),
        (AIBO, "schema = 1", "schema = 2", "schema must be 1 for this program, not 2"),
        (AIBO, "schema = 1\n", "", "missing field `schema`"),
        (AIBO, "robot = \"aibo\"\n", "", "a scenario must have robot = \"...\" (simulated) or source"),
        (AIBO, "robot = \"aibo\"", "robot = \"abio\"", "did you mean `aibo`?"),
        (AIBO, "robot = \"aibo\"", "robot = \"aibo\"\nsource = \"x\"", "exclude each other"),
        (AIBO, "duration_s = 300 ", "#", "a simulated scenario must have duration_s"),
        (AIBO, "seeds = 15", "", "a simulated scenario must have seeds"),
        (AIBO, "seeds = 15", "seeds = 0", "seeds must lie in 1..=10000, not 0"),
        (AIBO, "start = \"sgn\"", "start = \"sgm\"", "did you mean `sgn`?"),
        (AIBO, "start = \"sgn\"", "", "learner algorithm1 takes start ="),
        (AIBO, "start = \"sgn\"", "start = \"reference_cubic\"", "not reference_cubic"),
        (AIBO, "learner = \"canonical\"", "learner = \"canonical\"\nstart = \"c\"", "canonical takes no start, not c"),
        (AIBO, "start = \"sgn\"\nduration_s = 150", "start = \"c\"\nduration_s = 150", "stands here twice"),
        (AIBO, "duration_s = 150", "duration_s = 301", "duration_s must lie in 1..=300 s, not 301"),
        (AIBO, "far_height_px = ", "far_height_px = 90.0 # ", "far_height_px must be below near_height_px"),
        (AIBO, "as = \"algorithm1_no_pull\"", "as = \"no pull\"", "letters, digits and _, not \"no pull\""),
        (AIBO, "[divergence]", "[windows]\nlength_s = 1\ndisjoint_starts_s = [1]\n[divergence]", "windows belongs to"),
        (AIBO, "converged_share_min = 1.0", "converged_share_min = 15.0", "must lie in 0..=1, not 15"),
        (AIBO, "beats = \"algorithm1\"", "beats = \"algorithm2\"", "no row is called \"algorithm2\""),
        (AIBO, "[divergence]", "[effects.comand_scale]\n[divergence]", "did you mean `command_scale`?"),
        (AIBO, "[divergence]", "[effects.command_scale]\ny_ratio = 9.0\n[divergence]", "must lie in 0.5..=1.5, not 9"),
        (
            AIBO,
            "[divergence]",
            "[learners.algorithm1]\ngamma = 1.5\n[divergence]",
            "gamma must lie in 0.5..=1, not 1.5",
        ),
        (AIBO, "[divergence]", "[learners.canonicl]\n[divergence]", "did you mean `canonical`?"),
        (AIBO, "[divergence]", "[aibo.gaitt]\n[divergence]", "did you mean `gait`?"),
        (AIBO, "[divergence]", "[camera]\nfocal_px = 1.0\n[divergence]", "focal_px must lie in 20..=5000 px, not 1"),
        (AIBO, "id = 0\n", "", "missing field `id`"),
        (AIBO, "[drive]", "[explore]\n[drive]", "explore is the policy in the plane; study \"line\" takes [drive]"),
        (
            AIBO,
            "[drive]",
            "[effects.command_scale]\ny_ratio = 0.75\nfrom_s = 300\n[drive]",
            "from_s must be before the log ends, at duration_s 300, not 300",
        ),
        (AIBO, "[drive]", "[starting]\n[drive]", "starting belongs to studies \"plane\" and \"stride\""),
        (AIBO, "start = \"sgn\"", "start = \"sgn\"\nera = \"after\"", "there is no era \"after\""),
        (AIBO, "learner = \"canonical\"", "learner = \"em_rts\"", "learner em_rts is not for study \"line\""),
        (AIBO, "beats_unlearned = true", "median_max = { nis = 1 }", "median_max belongs to studies"),
        (PLAIN, "study = \"plane\"", "study = \"plain\"", "did you mean `plane`?"),
        (PLAIN, "study = \"plane\"", "study = \"line\"", "explore is the policy in the plane"),
        (PLAIN, "[explore]", "[drive]", "drive is the policy along a line; study \"plane\" takes [explore]"),
        (PLAIN, "\"f_worse_1\"", "\"f_worse_4\"", "did you mean `f_worse_"),
        (PLAIN, "\"attempted\"", "\"c\"", "another of chapter 4's, not c"),
        (PLAIN, "starts = [\"published\"", "start = \"published\"\nstarts = [\"published\"", "not both"),
        (PLAIN, "\"em_published\"", "\"algorithm1\"", "learner algorithm1 is not for study \"plane\""),
        (PLAIN, "sigma2_rad = 0.5", "sigma2_rad = 5.0", "sigma2_rad must lie in 0..=2 rad, not 5"),
        (PLAIN, "vx_rmse_mm_per_s = ", "vx_rmse_mm_s = ", "did you mean `vx_rmse_mm_per_s`?"),
        (PLAIN, "[explore]", "[binning]\nv_cells = 3\n[explore]", "binning is not for robot \"plain\""),
        (CAR, "robot = \"car\"", "robot = \"aibo\"", "robot \"car\" and study \"car\" belong together"),
        (CAR, "[town]", "[field]\n[town]", "field is not for robot \"car\""),
        (CAR, "\"car_lines\"", "\"batch\"", "learner batch is not for study \"car\", which learns from"),
        (CAR, "\"car_lines\"", "\"likelihood\"", "learner likelihood is not for study \"car\""),
        (CAR, "\"redrawn\"", "\"redraw\"", "did you mean `redrawn`?"),
        (CAR, "speed_percent = 8.25", "speed_per_cent = 8.25", "did you mean `speed_percent`?"),
        (CAR, "[velodyne]", "[starting]\n[velodyne]", "starting belongs to studies \"plane\" and \"stride\""),
        (CAR, "[\"reference_car\"", "[\"published\"", "learner car_lines takes no start, or start = \"reference_car\""),
        (PLAIN, "\"attempted\"", "\"half_car\"", "another of chapter 4's, not half_car"),
        (AV21, "learned_s = 335.5", "learned_s = 700", "learned_s must lie in 1..=671 s, not 700"),
        (MRCLAM, "[windows] ", "[windows]\nlearned_s = 5 ", "learned_s belongs to study \"car\""),
        (PLAIN, "[explore]", "[town]\n[explore]", "town is not for robot \"plain\""),
        (PLAIN, "\"em_published\"", "\"car_graph\"", "it learns from a car's laser firings"),
        (BARFOOT, "[windows]", "landmarks = [[1, 2], [3, 4]]\n[windows]", "sets are told apart by their size"),
        (BARFOOT, "[windows]", "landmarks = [[1, 1]]\n[windows]", "at least one, and none twice"),
        (BARFOOT, "[windows]", "robots = [1, 1]\n[windows]", "robots must differ; 1 stands here twice"),
        (MRCLAM, "0.033, ", "", "axis_rad must have one angle, or one for each of 5 robots, not 4"),
        (MRCLAM, "[-0.1, 0.1]", "[0.1, -0.1]", "omega_edges_rad_per_s must be numbers that increase, not [0.1, -0.1]"),
        (MRCLAM, "settle_s", "settle", "did you mean `settle_s`?"),
        (BARFOOT, "225.0", "200.0", "disjoint windows must not overlap: 200 < 75 + length_s 150"),
        (BARFOOT, "[75.0, 225.0, 375.0, 525.0]", "[]", "at least one start"),
        (BARFOOT, "[windows]", "[window]", "did you mean `windows`?"),
        (BARFOOT, "barfoot-1d", "barfoot-3d", "did you mean `barfoot-1d`?"),
        (BARFOOT, "\"../shared/data/barfoot_1d\"", "\"\"", "source must be the path of a recorded log, not empty"),
        (BARFOOT, "[divergence]", "[drive]\n[divergence]", "drive belongs to simulated scenarios"),
        (BARFOOT, "overlapping_every_s = 25.0", "overlapping_every_s = 0", "must lie in 0.1..=36000 s, not 0"),
    ];
    for (text, from, to, said) in cases {
        assert!(text.contains(from), "{from:?} is no longer in the scenario");
        let bad = scenario::parse("broken", "broken.toml", &text.replacen(from, to, 1)).expect_err(to);
        // Lines may be wrapped anywhere: compare without the frame and the spaces.
        let bare = |text: &str| text.chars().filter(|c| !c.is_whitespace() && *c != '|').collect::<String>();
        let shown = shown(&bad);
        assert!(bare(&shown).contains(&bare(said)), "{to:?}: {said:?} is not said in\n{shown}");
        assert!(shown.contains("broken.toml:"), "{shown}");
    }
}

#[test]
fn several_faults_are_shown_at_once() {
    let text = AIBO.replace("hold_s = 3.0", "hold_s = 300.0").replace("r2_min = 0.75", "r2_min = -1.0");
    let bad = scenario::parse("broken", "broken.toml", &text).expect_err("two faults");
    let shown = shown(&bad);
    assert!(shown.contains("2 values break rules"), "{shown}");
    assert!(shown.contains("hold_s must lie in 0.1..=60 s, not 300"), "{shown}");
    assert!(shown.contains("r2_min must lie in 0..=1, not -1"), "{shown}");
}

#[test]
fn what_is_no_file_or_no_text_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("made");
    let missing = folder.path().join("missing.toml");
    assert!(scenario::read(&missing).expect_err("missing").to_string().contains("missing.toml"));
    assert!(scenario::read(folder.path()).is_err());
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"schema = 1\nabout = \"\xff\"\n").expect("written");
    let bad = scenario::read(&binary).expect_err("not UTF-8");
    assert_eq!(bad.line(), Some(2));
    assert!(shown(&bad).contains("binary.toml:2:"), "{}", shown(&bad));
}

/// Comments, prose, order of keys and the number of seeds bear on no trial; everything else does.
#[test]
fn the_hash_changes_with_what_bears_on_a_trial() {
    let hash = |from: &str, to: &str| {
        assert!(AIBO.contains(from), "{from:?} is no longer in the scenario");
        scenario::parse("x", "x.toml", &AIBO.replacen(from, to, 1)).expect("sound").hash()
    };
    let plain = hash("seeds = 15", "seeds = 15");
    assert_eq!(plain, hash("seeds = 15", "seeds = 3 # fewer"));
    assert_eq!(plain, hash("about = \"", "about = \"In other words: "));
    assert_eq!(plain, hash("converged_share_min = 1.0", "converged_share_min = 0.5"));
    for (from, to) in
        [("hold_s = 3.0", "hold_s = 3.1"), ("alpha = 0.0", "alpha = 0.1"), ("r2_min = 0.75", "r2_min = 0.7")]
    {
        assert_ne!(plain, hash(from, to), "{to}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Cut off anywhere, or with bytes put in anywhere: an answer, never a panic; and what is refused
    /// is shown.
    #[test]
    fn no_text_panics(at in 0..AIBO.len(), cut in any::<bool>(), junk in "[\\PC\n\"\\[\\]{}=.]{0,6}") {
        let at = (0..=at).rev().find(|at| AIBO.is_char_boundary(*at)).unwrap_or(0);
        let text = AIBO[..at].to_owned() + &junk + if cut { "" } else { &AIBO[at..] };
        if let Err(bad) = scenario::parse("broken", "broken.toml", &text) {
            prop_assert!(shown(&bad).contains("broken.toml"), "{}", shown(&bad));
        }
    }
}
