//! The verb `diagnose` as a user meets it, on a plain world that is played in moments.

mod hostile;
mod self_test;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use asami::real::odometry;
use asami::scenario::{self, Origin};
use asami_dataset::{Dataset, Log, store};
use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::Verdict;

/// Section 4.4.2's simulator with less noise on bearings, so that minutes say enough.
const SCENARIO: &str = include_str!("plain_2d.toml");

fn run(program: &str, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).output().expect("the program starts")
}

fn said(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes).into_owned();
    text.split_whitespace().filter(|word| !["│", "×"].contains(word)).collect::<Vec<_>>().join(" ")
}

/// A folder with the small world in it.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("made");
        std::fs::write(folder.path().join("plain_2d.toml"), SCENARIO).expect("written");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A data set of the small world with these effects.
    fn log(&self, name: &str, seed: &str, effects: &[&str]) -> PathBuf {
        let (scenario, out) = (self.path("plain_2d.toml"), self.path(name));
        let mut arguments = vec!["--seed", seed, "-o", utf8(&out), utf8(&scenario)];
        effects.iter().for_each(|effect| arguments.extend(["--effect", effect]));
        let made = run(env!("CARGO_BIN_EXE_generate"), &arguments);
        assert!(made.status.success(), "{}", said(&made.stderr));
        // Only what a robot knows.
        for file in ["truth.csv", "survey.toml"] {
            std::fs::remove_file(out.join(file)).expect("was there");
        }
        out
    }

    fn diagnose(&self, log: &Path, out: &str, more: &[&str]) -> Output {
        self.diagnose_with(&self.path("libraries"), log, out, more)
    }

    fn diagnose_with(&self, libraries: &Path, log: &Path, out: &str, more: &[&str]) -> Output {
        self.command(libraries, log, out).args(more).output().expect("the program starts")
    }

    fn command(&self, libraries: &Path, log: &Path, out: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_diagnose"));
        command.args(["--calibrate", "0", "--nominal"]).arg(self.path("plain_2d.toml"));
        command.arg("--libraries").arg(libraries).arg("-o").arg(self.path(out)).arg(log);
        command
    }
}

/// Everything in a folder, by name.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found: Vec<_> = std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()).collect();
    found.sort();
    found
        .into_iter()
        .map(|path| (path.file_name().expect("a name").into(), std::fs::read(&path).expect("there")))
        .collect()
}

/// A library that is kept from test to test and from run to run, under the hash of what it hangs on; the documentation's commands
/// look for it here, too.
fn kept_library() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("user/results/library")
}

fn utf8(path: &Path) -> &str {
    path.to_str().expect("a temporary folder's name is text")
}

fn answer(folder: &Path) -> Diagnosis {
    let text = std::fs::read_to_string(folder.join("diagnosis.json")).expect("written");
    serde_json::from_str(&text).expect("in the form of a diagnosis")
}

/// A late command is named from its log alone; the scenario written with it generates such logs; a second run, with what was kept
/// of the first, gives the same bytes.
#[test]
fn a_planted_effect_is_named_and_repaired() {
    let bench = Bench::new();
    let log = bench.log("late", "1003", &["command_delay.delay_s=0.15"]);
    let first = bench.diagnose_with(&kept_library(), &log, "first", &[]);
    assert_eq!(first.status.code(), Some(0), "{}", said(&first.stderr));
    let text = said(&first.stdout);
    assert!(text.contains("named: command_delay"), "{text}");

    let folder = bench.path("first");
    let diagnosis = answer(&folder);
    assert_eq!((diagnosis.verdict, &*diagnosis.which[0].effects[0]), (Verdict::Named, "command_delay"));
    let found = diagnosis.which[0].parameters["command_delay.delay_s"];
    assert!((found.value - 0.15).abs() < 0.05, "{found:?}");
    assert!(diagnosis.how_far.closed.is_some_and(|closed| closed > 0.5), "{:?}", diagnosis.how_far);

    let repaired = std::fs::read_to_string(folder.join("with_effect.toml")).expect("written");
    assert!(repaired.contains("# a remark"));
    let Ok(Origin::Simulated(simulation)) = scenario::parse("r", "r.toml", &repaired).map(|it| it.origin) else {
        panic!("it is a simulated scenario")
    };
    assert_eq!(simulation.effects.command_delay.map(|it| it.delay_s), Some(found.value));

    let page = std::fs::read_to_string(folder.join("report.html")).expect("written");
    for part in ["Gap map", "Ranked causes", "Before and after", "Next experiment", "Smallest visible sizes"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("NaN") && !page.contains("src=\"http"));

    let second = bench.diagnose_with(&kept_library(), &log, "second", &[]);
    assert!(!said(&second.stderr).contains("responses to effects"), "{}", said(&second.stderr));
    assert_eq!(first.stdout, second.stdout);
    assert_eq!(files(&folder), files(&bench.path("second")));

    // Without it in the catalogue, it is not named, and an older repair is removed.
    let without = bench.diagnose_with(&kept_library(), &log, "first", &["--without", "command_delay"]);
    assert_eq!(without.status.code(), Some(0), "{}", said(&without.stderr));
    let diagnosis = answer(&folder);
    assert!(diagnosis.which.iter().all(|cause| cause.effects != ["command_delay"]), "{:?}", diagnosis.which);
    assert_eq!(folder.join("with_effect.toml").exists(), matches!(diagnosis.verdict, Verdict::Named | Verdict::Tied));
}

/// With `--real` several effects are named at once, and the scenario is written with all of them.
#[test]
fn several_effects_of_a_real_log_are_named_and_repaired() {
    let bench = Bench::new();
    let log = bench.log("worn", "1004", &["image_delay.delay_s=0.08", "height_bias.bias_px=3.0"]);
    let mut worn = store::read(&log).expect("written");
    worn.log = worn.log.window(0.0..150.0);
    let log = bench.path("two and a half minutes");
    store::write(&worn, &log).expect("written");
    let done = bench.diagnose_with(&kept_library(), &log, "real", &["--real"]);
    assert_eq!(done.status.code(), Some(0), "{}", said(&done.stderr));
    let folder = bench.path("real");
    let diagnosis = answer(&folder);
    let mut named = diagnosis.which[0].effects.clone();
    named.sort();
    assert_eq!(named, ["height_bias", "image_delay"], "{:?}", diagnosis.which);
    let repaired = std::fs::read_to_string(folder.join("with_effect.toml")).expect("written");
    let Ok(Origin::Simulated(simulation)) = scenario::parse("r", "r.toml", &repaired).map(|it| it.origin) else {
        panic!("it is a simulated scenario")
    };
    let found = [
        simulation.effects.image_delay.map(|it| it.delay_s / 0.08),
        simulation.effects.height_bias.map(|it| it.bias_px / 3.0),
    ];
    assert!(found.iter().all(|it| it.is_some_and(|ratio| (ratio - 1.0).abs() < 0.2)), "{found:?}");

    // One frame in half a second is what a log of such frames shows.
    let mut short = store::read(&log).expect("written");
    short.log = short.log.window(0.0..100.0);
    store::write(&short, &bench.path("short")).expect("written");
    let thin = Dataset { log: odometry::thinned(&short.log, 0.5), ..short };
    store::write(&thin, &bench.path("thin")).expect("written");
    let short = bench.path("short");
    let by_option = bench.diagnose_with(&kept_library(), &short, "by_option", &["--real", "--every-s", "0.5"]);
    let by_itself = bench.diagnose_with(&kept_library(), &bench.path("thin"), "by_itself", &["--real"]);
    for done in [by_option, by_itself] {
        assert_eq!(done.status.code(), Some(0), "{}", said(&done.stderr));
    }
    assert_eq!(answer(&bench.path("by_option")), answer(&bench.path("by_itself")));
}

/// Where halves say of an effect what is many times as far apart as either is unsure of, the whole log no longer names it.
#[test]
fn a_log_is_believed_as_far_as_its_halves_agree() {
    let bench = Bench::new();
    let [small, large] = [("small", "1.5"), ("large", "3.0")].map(|(name, bias)| {
        let log = bench.log(name, "1004", &[&format!("height_bias.bias_px={bias}")]);
        store::read(&log).expect("written")
    });
    // Two minutes of it.
    let [[first, _], [_, second]] = [&small, &large].map(|it| it.log.window(0.0..120.0).halves());
    let both: Vec<_> = first.sightings.iter().chain(second.sightings.iter()).cloned().collect();
    let whole = Log { sightings: both.into(), ..small.log.window(0.0..120.0) };
    store::write(&Dataset { log: whole, ..small }, &bench.path("both")).expect("written");
    let diagnosed = |out: &str, options: &[&str]| {
        let done = bench.diagnose_with(&kept_library(), &bench.path("both"), out, &[&["--real"], options].concat());
        assert_eq!(done.status.code(), Some(0), "{}", said(&done.stderr));
        answer(&bench.path(out))
    };
    let as_it_speaks = diagnosed("as_it_speaks", &[]);
    let by_halves = diagnosed("by_halves", &["--by-halves"]);
    assert_eq!(as_it_speaks.halves_differ, Some(1.0));
    let differ = by_halves.halves_differ.expect("asked");
    assert!(differ > 3.0, "{differ}");
    let names = |it: &Diagnosis| it.said().is_some_and(|cause| cause.effects.iter().any(|it| it == "height_bias"));
    assert_eq!([&as_it_speaks, &by_halves].map(names), [true, false], "{differ}");
    let visible = |it: &Diagnosis| it.smallest_visible["height_bias.bias_px"];
    assert!(visible(&by_halves) > 2.0 * visible(&as_it_speaks), "{} {}", visible(&by_halves), visible(&as_it_speaks));
}
