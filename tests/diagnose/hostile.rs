//! Logs as nobody would wish them: each gives an answer that says what it rests on, or a sentence on what the log lacks.

use std::path::PathBuf;

use asami_dataset::{Command, Dataset, Frame, Log, Sighting, store};
use asami_gap::answer::diagnosis::Verdict;

use crate::{Bench, answer, files, kept_library, said};

/// Writes a changed log as a data set of its own.
fn cut(bench: &Bench, whole: &Log, name: &str, change: &dyn Fn(&mut Log)) -> PathBuf {
    let mut log = whole.clone();
    change(&mut log);
    let folder = bench.path(name);
    store::write(&Dataset { log, ..Dataset::default() }, &folder).expect("sound");
    folder
}

/// Every time of a log changed.
fn timed(log: &mut Log, to: &dyn Fn(f64) -> f64) {
    let commands = log.commands.iter().map(|row| Command { t_s: to(row.t_s), ..*row });
    let sightings = log.sightings.iter().map(|row| Sighting { t_s: to(row.t_s), ..*row });
    let frames = log.frames.iter().flat_map(|frames| frames.iter()).map(|row| Frame { t_s: to(row.t_s), ..*row });
    let (commands, sightings) = (commands.collect::<Vec<_>>(), sightings.collect::<Vec<_>>());
    log.frames = Some(frames.collect::<Vec<_>>().into());
    (log.commands, log.sightings) = (commands.into(), sightings.into());
}

/// Logs that can show nothing, and requests that mean nothing, are refused with exit 2 before anything is played.
#[test]
fn what_shows_nothing_is_said_and_exits_2() {
    let bench = Bench::new();
    let whole = store::read(&bench.log("whole", "1004", &[])).expect("written");
    let cut = |name: &str, change: &dyn Fn(&mut Log)| cut(&bench, &whole.log, name, change);
    let empty = cut("empty", &|log| *log = Log { known: log.known.clone(), ..Log::default() });
    let commands = cut("no_commands", &|log| log.commands = Vec::new().into());
    let sightings = cut("no_sightings", &|log| log.sightings = Vec::new().into());
    let one = cut("one_row", &|log| *log = log.window(0.0..0.2));
    let early = cut("early", &|log| log.sightings = log.sightings.window(&(0.0..4.0)));
    let back = cut("back", &|_| {});
    let rows = std::fs::read_to_string(back.join("frames.csv")).expect("written") + "12.5,0.1\n";
    std::fs::write(back.join("frames.csv"), rows).expect("written");
    for (folder, why) in [
        (&empty, "the log has no commands"),
        (&commands, "the log has no commands"),
        (&sightings, "the log has no sightings"),
        (&one, "nothing can be said"),
        (&early, "0 sightings once the filter has settled"),
        (&back, "frames.csv"),
        (&bench.path("nowhere"), "nowhere"),
    ] {
        let refused = bench.diagnose(folder, "out", &[]);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused.stderr));
        assert!(said(&refused.stderr).contains(why), "{why}: {}", said(&refused.stderr));
    }
    for (options, why) in [
        (&["--without", "comand_delay"][..], "did you mean command_delay?"),
        (&["--real", "--every-s", "0"], "--every-s: every_s must lie in 0.001..=10 s, not 0"),
        (&["--real", "--points-s", "9"], "--points-s: points_s must lie in 0.01..=5 s, not 9"),
        (&["--real", "--earlier-s", "1.5"], "--earlier-s: earlier_s must lie in 0.001..=1 s, not 1.5"),
        (&["--average-s", "1"], "--real"),
    ] {
        let mistyped = bench.diagnose(&bench.path("whole"), "out", options);
        assert_eq!(mistyped.status.code(), Some(2), "{options:?}");
        assert!(said(&mistyped.stderr).contains(why), "{}", said(&mistyped.stderr));
    }
    assert!(!bench.path("out").exists() && !bench.path("libraries").exists());
}

/// What says little is diagnosed all the same, with a note on what it cannot show.
#[test]
fn what_shows_little_is_diagnosed_with_a_note() {
    let bench = Bench::new();
    let long = store::read(&bench.log("long", "1004", &[])).expect("written").log;
    let whole = long.window(0.0..120.0);
    let cut = |name: &str, change: &dyn Fn(&mut Log)| cut(&bench, &whole, name, change);
    let late = |by_s: f64| move |t_s: f64| if t_s > 50.0 { t_s + by_s } else { t_s };
    let constant = cut("constant", &|log| {
        let first = log.commands[0];
        log.commands = log.commands.iter().map(|row| Command { t_s: row.t_s, ..first }).collect::<Vec<_>>().into();
    });
    // The robot goes on; nothing is recorded for some seconds, for three minutes.
    let unrecorded = |log: &mut Log, until_s: f64| {
        let outside = |t_s: f64| !(60.0..until_s).contains(&t_s);
        let frames = long.frames.iter().flat_map(|frames| frames.iter()).filter(|row| outside(row.t_s)).copied();
        let sightings = long.sightings.iter().filter(|row| outside(row.t_s)).copied();
        *log = long.clone();
        (log.frames, log.sightings) = (Some(frames.collect::<Vec<_>>().into()), sightings.collect::<Vec<_>>().into());
    };
    let pause = cut("pause", &|log| unrecorded(log, 80.0));
    let gap = cut("gap", &|log| unrecorded(log, 240.0));
    let set = cut("set", &|log| timed(log, &late(86_400.0)));
    let epoch = cut("epoch", &|log| timed(log, &|t_s| t_s + 1.7e9));
    let frameless = cut("frameless", &|log| log.frames = None);
    let one_landmark = cut("one_landmark", &|log| {
        let only = log.sightings.iter().filter(|seen| seen.landmark == 0);
        log.sightings = only.copied().collect::<Vec<_>>().into();
    });
    let unmoved = cut("whole_again", &|_| {});
    for (folder, note) in [
        (&constant, Some("the command never changes")),
        (&pause, Some("nothing is sighted between")),
        (&gap, Some("is looked at: what happens elsewhere does not show")),
        (&set, Some("is looked at: what happens elsewhere does not show")),
        (&epoch, None),
        (&frameless, Some("no frames.csv")),
        (&one_landmark, None),
        (&unmoved, None),
    ] {
        let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
        let done = bench.diagnose_with(&kept_library(), folder, &format!("out_{name}"), &[]);
        assert_eq!(done.status.code(), Some(0), "{name}: {}", said(&done.stderr));
        assert!(said(&done.stdout).contains("verdict"), "{name}");
        if let Some(note) = note {
            assert!(said(&done.stderr).contains(note), "{name}: {}", said(&done.stderr));
            let page = std::fs::read_to_string(bench.path(&format!("out_{name}/report.html"))).expect("written");
            assert!(page.contains(note), "{name}: the report does not say it");
        }
        let which = answer(&bench.path(&format!("out_{name}"))).which;
        let sum: f64 = which.iter().map(|cause| cause.probability).sum();
        assert!(sum > 0.99 && sum < 1.0 + 1e-9, "{name}: {which:?}");
    }
    // Of the nominal world, with gaps or by another clock, nothing is said that was not there.
    for name in ["whole_again", "pause", "gap", "set", "epoch", "frameless"] {
        let verdict = answer(&bench.path(&format!("out_{name}"))).verdict;
        assert_eq!(verdict, Verdict::None, "{name}");
    }
}

/// A diagnosis of a withheld case is the same to the byte with keys and without.
#[test]
fn without_keys_every_byte_is_the_same() {
    let bench = Bench::new();
    let (scenario, out) = (bench.path("plain_2d.toml"), bench.path("withheld"));
    let arguments = ["--withhold", "--salt", "keyless", "--cases", "2", "--duration-s", "100", "-o"];
    let arguments = [&arguments[..], &[crate::utf8(&out), crate::utf8(&scenario)]].concat();
    let made = crate::run(env!("CARGO_BIN_EXE_generate"), &arguments);
    assert!(made.status.success(), "{}", said(&made.stderr));
    let case = out.join("cases/001");
    let first = bench.diagnose_with(&kept_library(), &case, "with_keys", &[]);
    assert_eq!(first.status.code(), Some(0), "{}", said(&first.stderr));
    std::fs::remove_dir_all(out.join("keys")).expect("there were keys");
    let second = bench.diagnose_with(&kept_library(), &case, "without_keys", &[]);
    assert_eq!(first.stdout, second.stdout);
    assert_eq!(files(&bench.path("with_keys")), files(&bench.path("without_keys")));
}
