//! What the documentation shows is what the program reads.

use std::path::{Path, PathBuf};
use std::process::Command;

use asami::scenario::{self, Start};
use asami_dataset::store;

fn block<'a>(text: &'a str, kind: &str) -> &'a str {
    let (_, from) = text.split_once(&format!("```{kind}\n")).expect("the page has such a block");
    from.split_once("```").expect("the block ends").0
}

#[test]
fn the_smallest_robot_of_the_docs_is_a_data_set() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("docs/data-set.md")).expect("the page");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("dataset.toml"), block(&page, "toml")).expect("written");

    // Two files stand side by side, at least two spaces apart.
    let mut files: Vec<(String, String)> = Vec::new();
    for line in block(&page, "text").lines() {
        for (i, cell) in line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).enumerate() {
            match files.get_mut(i) {
                Some((_, rows)) => *rows += &format!("{cell}\n"),
                None => files.push((cell.to_owned(), String::new())),
            }
        }
    }
    assert_eq!(files.len(), 2);
    for (name, rows) in files {
        std::fs::write(folder.path().join(name), rows).expect("written");
    }
    let dataset = store::read(folder.path()).expect("the docs' own example");
    assert_eq!((dataset.log.commands.len(), dataset.log.sightings.len()), (2, 2));
}

#[test]
fn the_small_scenario_of_the_docs_is_one() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("docs/scenarios.md")).expect("the page");
    let scenario = scenario::parse("small", "docs/scenarios.md", block(&page, "toml")).expect("the docs' own example");
    assert_eq!((scenario.rows.len(), scenario.expect.len()), (2, 1));
    // Every key of a scenario file, every starting model and every scenario of chapter 4 has its place on the page.
    let wire = std::fs::read_to_string(root.join("src/scenario/wire.rs")).expect("the wire format");
    let (_, fields) = wire.split_once("pub struct Wire {").expect("the whole file");
    let fields = fields.split_once("\n}").expect("its end").0;
    let keys = fields.lines().filter_map(|line| line.trim().strip_prefix("pub ")?.split_once(':')).map(|(key, _)| key);
    let keys: Vec<&str> = keys.map(|key| key.trim_start_matches('_')).collect();
    assert!(keys.len() > 20, "{keys:?}");
    let starts = Start::CHAPTER_4.into_iter().chain([Start::ReferenceCar, Start::HalfCar]);
    let starts: Vec<&str> = starts.map(Start::name).collect();
    let scenarios =
        ["plain_2d", "aibo_2d", "aibo_1d_em", "aibo_1d_changed", "barfoot_2d", "mrclam", "car", "kitti_hdl64e", "av21"];
    for name in keys.into_iter().chain(starts).chain(scenarios) {
        let names = ["`", "`[", "`[["].map(|before| format!("{before}{name}"));
        assert!(names.iter().any(|name| page.contains(name)), "{name} is not on the page");
    }
}

/// A user's folder without any results but the library, which is kept from run to run and shared with the tests of `diagnose`.
fn of_a_user() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("user");
    let results = folder.join("results");
    std::fs::create_dir_all(&results).expect("made");
    for old in std::fs::read_dir(&results).expect("there").flatten().filter(|old| old.file_name() != "library") {
        std::fs::remove_dir_all(old.path()).expect("removed");
    }
    folder
}

/// The tutorial from a log to a repaired simulator, and the page on blind sweeps, as they stand there, uncalibrated, in the small
/// world of the tests of `diagnose`.
#[test]
fn the_commands_of_the_tutorial_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = |name: &str| std::fs::read_to_string(root.join("docs").join(name)).expect("the page");
    let pages = page("diagnosis.md") + &page("blind.md");
    let folder = of_a_user();
    std::fs::create_dir_all(folder.join("scenarios")).expect("made");
    std::fs::copy(root.join("tests/diagnose/plain_2d.toml"), folder.join("scenarios/plain_2d.toml")).expect("copied");
    for name in ["blind_plain_2d.toml", "blind_foreign.toml"] {
        let shipped = std::fs::read_to_string(root.join("scenarios").join(name)).expect("shipped");
        let line = |line: &str| if line.starts_with("calibration_cases") { String::new() } else { format!("{line}\n") };
        let uncalibrated: String = shipped.lines().map(line).collect();
        std::fs::write(folder.join("scenarios").join(name), uncalibrated).expect("written");
    }
    let blocks = pages.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    let commands: Vec<&str> = blocks.flat_map(str::lines).collect();
    assert_eq!(commands.len(), 9, "{commands:?}");
    let script = "benches/peers/kinematic_cases.py";
    std::fs::create_dir_all(folder.join("benches/peers")).expect("made");
    std::fs::copy(root.join(script), folder.join(script)).expect("shipped");
    // The page's foreign program needs Python 3.11.
    let python = Command::new("python3").args(["-c", "import tomllib"]).output().is_ok_and(|it| it.status.success());
    let answer = folder.join("results/diagnosis/001");
    for line in commands {
        // Whether there is an effect to repair hangs on what the catalogue's laws draw.
        if line.contains("with_effect.toml") && !answer.join("with_effect.toml").exists() {
            continue;
        }
        let of_python = line.contains("python3") || line.contains("blind_foreign");
        if of_python && !python {
            continue;
        }
        let words: Vec<&str> = line.split(' ').collect();
        let (program, arguments) = match words[..] {
            ["cargo", "run", "--bin", program, ref arguments @ ..] => (program, arguments),
            ["python3", ref arguments @ ..] => ("python3", arguments),
            _ => panic!("{line}"),
        };
        let (program, more): (_, &[&str]) = match program {
            "generate" => (env!("CARGO_BIN_EXE_generate"), &[]),
            "sweep" if of_python => (env!("CARGO_BIN_EXE_sweep"), &["--seeds", "2"]),
            "sweep" => (env!("CARGO_BIN_EXE_sweep"), &[]),
            "python3" => ("python3", &["--cases", "2", "--duration-s", "60"]),
            "diagnose" => (env!("CARGO_BIN_EXE_diagnose"), &["--calibrate", "0"]),
            _ => panic!("{line}"),
        };
        let ran = Command::new(program).current_dir(&folder).args(arguments).args(more).output().expect("starts");
        assert!(ran.status.success(), "{line}: {}", String::from_utf8_lossy(&ran.stderr));
    }
    assert!(answer.join("diagnosis.json").exists() && answer.join("report.html").exists());
    let trials = folder.join("results/blind_try/trials.csv");
    assert_eq!(std::fs::read_to_string(trials).expect("written").lines().count(), 1 + 3 * 3);
}

/// Every key of a blind scenario, every measure and every column of its `trials.csv` has its place on the page.
#[test]
fn the_page_on_blind_sweeps_is_complete() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |name: &str| std::fs::read_to_string(root.join(name)).expect(name);
    let (page, source) = (read("docs/blind.md"), read("src/blind/scenario.rs"));
    let (_, fields) = source.split_once("pub struct Asked {").expect("the wire format");
    let fields = fields.split_once("\n}").expect("its end").0;
    let keys = fields.lines().filter_map(|line| line.trim().strip_prefix("pub ")?.split_once(':')).map(|(key, _)| key);
    let (_, measures) = source.split_once("pub enum Measure {").expect("the measures");
    let measures = measures.split_once("\n}").expect("their end").0;
    let measures = measures.lines().filter_map(|line| line.trim().strip_suffix(','));
    let snake = |word: &str| {
        let apart = |(i, letter): (usize, char)| match letter {
            letter if letter.is_uppercase() && i > 0 => format!("_{}", letter.to_ascii_lowercase()),
            letter => letter.to_ascii_lowercase().to_string(),
        };
        word.chars().enumerate().map(apart).collect::<String>()
    };
    let names: Vec<String> = keys
        .chain(asami::blind::rows::COLUMNS.split(','))
        .map(str::to_owned)
        .chain(measures.map(snake))
        .chain(asami::blind::scenario::DIAGNOSERS.map(str::to_owned))
        .collect();
    assert!(names.len() > 40, "{names:?}");
    for name in names {
        let written = ["`", "`[", "`[["].map(|before| format!("{before}{name}"));
        assert!(written.iter().any(|written| page.contains(written)), "{name} is not on the page");
    }
}

#[test]
fn every_command_of_the_readme_is_a_program() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = std::fs::read_to_string(root.join("README.md")).expect("README.md");
    let bins: Vec<&str> =
        readme.split("cargo run --bin ").skip(1).filter_map(|rest| rest.split([' ', '`']).next()).collect();
    assert!(bins.len() >= 6, "{bins:?}");
    for bin in bins {
        assert!(root.join("src/bin").join(format!("{bin}.rs")).exists(), "{bin}");
    }
}
