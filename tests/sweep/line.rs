//! A sweep gives the same bytes on one thread or two, interrupted or not, and outlives what goes
//! wrong inside it. On a plain world of our own, so that a sweep takes milliseconds.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use asami::scenario::{self, Scenario};
use asami::sweep::cases::Count;
use asami::sweep::line::{self, Outcome};
use asami::sweep::source::Source;
use asami::sweep::{Options, Plan, Silent, Timing, Watcher};
use asami::trial::{Case, Ending};
use asami_dataset::survey::{Height, Speed};
use asami_dataset::{Action, Command, Dataset, Known, Log, Rng, Seed, Sighting, Size, Survey, Truth};
use asami_learners::canonical::Canonical;
use asami_learners::{About, CannotLearn, Declared, Learned, Learner};
use rand::RngExt;

use crate::{options, rows};

const SCENARIO: &str = r#"
schema = 1
about = "Does the machinery work?"
robot = "aibo"
duration_s = 150
seeds = 4
[[field.beacons]]
id = 0
body = { x_m = 0.0, y_m = 0.0, radius_m = 0.05, base_m = 0.1, height_m = 0.2, bands = ["pink", "yellow"] }
[[rows]]
learner = "algorithm1"
start = "c"
[[rows]]
learner = "algorithm1"
start = "one"
[[rows]]
learner = "canonical"
[[rows]]
learner = "canonical"
duration_s = 60
[[expect]]
learner = "algorithm1"
start = "c"
converged_share_min = 1.0
action_to_floor_max = 5.0
"#;

/// True forward speed at a command: a curve that no polynomial follows quite.
fn speed_m_per_s(command: f64) -> f64 {
    command / (1.0 + 2.0 * command.abs())
}

/// A robot on a line before a beacon, commanded at random every three seconds.
struct Line {
    seeds: u64,
    made: AtomicUsize,
}

impl Source for Line {
    fn cases(&self) -> Vec<Case> {
        (1..=self.seeds).map(|seed| Case { seed, ..Case::default() }).collect()
    }

    fn dataset(&self, case: &Case) -> Result<Dataset, String> {
        self.made.fetch_add(1, Ordering::Relaxed);
        let mut rng = Seed(case.seed).stream("line");
        let (mut commands, mut sightings) = (Vec::new(), Vec::new());
        let (mut distance_m, mut forward, mut command) = (2.4, true, 0.0);
        for tick in 0..150 * 20 {
            let t_s = f64::from(tick) * 0.05;
            let turns = if forward { distance_m < 1.3 } else { distance_m > 3.5 };
            if turns || tick % 60 == 0 {
                forward ^= turns;
                command = 0.3 * rng.random::<f64>() * if forward { 1.0 } else { -1.0 };
                let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: command, atheta_rad_per_s: 0.0 };
                commands.push(Command { t_s, action });
            }
            distance_m -= 0.05 * speed_m_per_s(command);
            let noise: f64 = rng.random::<f64>() - 0.5;
            let size = Size::HeightPx(38.3887 / distance_m + noise);
            sightings.push(Sighting { t_s: t_s + 0.05, landmark: 0, size, bearing_rad: 0.0 });
        }
        let known = Known { robot: "plain".into(), ..Known::default() };
        let log = Log { known: known.into(), commands: commands.into(), sightings: sightings.into(), ..Log::default() };
        Ok(Dataset { log, truth: Truth { survey: self.survey(), ..Truth::default() }, provenance: None })
    }

    fn fingerprint(&self) -> String {
        "line".into()
    }

    fn survey(&self) -> Option<Survey> {
        let speed = |i: i32| {
            let command_m_per_s = f64::from(i) * 0.02;
            Speed { command_m_per_s, speed_m_per_s: speed_m_per_s(command_m_per_s), sd_m_per_s: 0.0, timings: 5 }
        };
        let height = |i: i32| {
            let distance_m = 1.2 + 0.2 * f64::from(i);
            let height_px = 38.3887 / distance_m;
            Height { distance_m, height_px, sd_px: 0.3, bearing_sd_rad: 0.0, readings: 100 }
        };
        Some(Survey {
            speed_by_command: (-15..=15).map(speed).collect(),
            height_by_distance: (0..13).map(height).collect(),
            ..Survey::default()
        })
    }
}

fn checked() -> Scenario {
    scenario::parse("line", "line.toml", SCENARIO).expect("the scenario is sound")
}

fn plan(seeds: u64) -> Plan {
    let scenario = checked();
    let learners = scenario.rows.iter().map(|row| scenario.learners.configured(&row.learner, &row.with));
    let learners = learners.collect::<Result<Vec<_>, _>>().expect("checked");
    Plan { scenario, source: Box::new(Line { seeds, made: AtomicUsize::new(0) }), learners }
}

fn run(plan: &Plan, out: &Path, jobs: usize) -> Outcome {
    line::carry_out(plan, &options(out, jobs), &Silent).expect("files can be written")
}

/// Every file but those that hold times, by name.
fn files(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for folder in [out.to_owned(), out.join("models")] {
        for entry in std::fs::read_dir(folder).expect("there") {
            let path = entry.expect("readable").path();
            let name = path.file_name().expect("named").to_string_lossy().into_owned();
            if path.is_file() && name != "timings.csv" {
                files.insert(name, std::fs::read(&path).expect("readable"));
            }
        }
    }
    files
}

fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (files(a), files(b));
    assert!(a.keys().eq(b.keys()), "{:?} {:?}", a.keys(), b.keys());
    for (name, bytes) in &a {
        assert!(*bytes == b[name], "{name} differs");
    }
}

#[test]
fn one_thread_and_two_give_the_same_bytes() {
    let folders = [tempfile::tempdir().expect("made"), tempfile::tempdir().expect("made")];
    let outcome = run(&plan(4), folders[0].path(), 1);
    run(&plan(4), folders[1].path(), 2);
    assert_same(folders[0].path(), folders[1].path());
    let trials = String::from_utf8(files(folders[0].path())["trials.csv"].clone()).expect("text");
    assert_eq!(trials.lines().count(), 1 + 4 * 4);
    assert!(!outcome.results.has_errors());
    assert!(outcome.verdicts.iter().all(|verdict| verdict.holds), "{:?}", outcome.verdicts);
}

/// Counts what was done already.
#[derive(Default)]
struct Counts(AtomicUsize, AtomicUsize);

impl Watcher for Counts {
    fn begins(&self, found: &Count, _trials_per_case: usize) {
        self.0.store(found.done, Ordering::Relaxed);
        self.1.store(usize::from(found.stale), Ordering::Relaxed);
    }
    fn finished(&self, _case: &Case, _timing: &Timing) {}
}

#[test]
fn killed_and_gone_on_with_is_as_never_stopped() {
    let folders = [tempfile::tempdir().expect("made"), tempfile::tempdir().expect("made")];
    run(&plan(4), folders[0].path(), 1);
    // What a process killed half-way leaves behind: some cases, and half a file under the name that
    // files are written aside by; no tables.
    run(&plan(2), folders[1].path(), 1);
    for name in ["trials.csv", "table_3_1.csv", "manifest.json"] {
        std::fs::remove_file(folders[1].path().join(name)).expect("was there");
    }
    std::fs::write(folders[1].path().join("cases/3.json.part"), "{\"key\":").expect("written");
    let counts = Counts::default();
    line::carry_out(&plan(4), &options(folders[1].path(), 2), &counts).expect("goes on");
    assert_eq!((counts.0.into_inner(), counts.1.into_inner()), (2, 0));
    assert_same(folders[0].path(), folders[1].path());
}

#[test]
fn another_program_or_scenario_starts_anew_and_says_so() {
    let folder = tempfile::tempdir().expect("made");
    run(&plan(2), folder.path(), 1);
    let again = Counts::default();
    line::carry_out(&plan(2), &options(folder.path(), 1), &again).expect("goes on");
    assert_eq!((again.0.into_inner(), again.1.into_inner()), (2, 0));

    let other = Options { program: "another".into(), ..options(folder.path(), 1) };
    let anew = Counts::default();
    line::carry_out(&plan(2), &other, &anew).expect("starts anew");
    assert_eq!((anew.0.into_inner(), anew.1.into_inner()), (0, 1));

    let mut changed = plan(2);
    changed.scenario.divergence.r2_min = 0.5;
    let anew = Counts::default();
    line::carry_out(&changed, &other, &anew).expect("starts anew");
    assert_eq!((anew.0.into_inner(), anew.1.into_inner()), (0, 1));
}

#[test]
fn more_seeds_go_on_with_the_fewer() {
    let folder = tempfile::tempdir().expect("made");
    run(&plan(2), folder.path(), 1);
    let counts = Counts::default();
    line::carry_out(&plan(4), &options(folder.path(), 1), &counts).expect("goes on");
    assert_eq!((counts.0.into_inner(), counts.1.into_inner()), (2, 0));
}

/// A learner with a mistake in it.
struct Broken;

impl Declared for Broken {
    fn about(&self) -> &'static About {
        Canonical::about()
    }
}

impl Learner for Broken {
    fn learn(&self, log: &Log, _: &asami_dataset::Models, _: &mut Rng) -> Result<Learned, CannotLearn> {
        panic!("index {} out of range", log.commands.len())
    }
}

/// A learner that says what it lacks.
struct Lacking;

impl Declared for Lacking {
    fn about(&self) -> &'static About {
        Canonical::about()
    }
}

impl Learner for Lacking {
    fn learn(&self, _: &Log, _: &asami_dataset::Models, _: &mut Rng) -> Result<Learned, CannotLearn> {
        Err(CannotLearn::NotGiven("an action model, and a comma"))
    }
}

#[test]
fn a_panic_in_a_trial_is_a_row_and_so_is_what_a_learner_lacks() {
    let folder = tempfile::tempdir().expect("made");
    let mut plan = plan(2);
    plan.learners[2] = Box::new(Broken);
    plan.learners[3] = Box::new(Lacking);
    let outcome = run(&plan, folder.path(), 2);
    assert!(outcome.results.has_errors());
    let endings: Vec<Ending> = outcome.results.trials().map(|(_, trial)| trial.ending).collect();
    assert_eq!(&endings[4..], [Ending::Error, Ending::Error, Ending::CannotLearn, Ending::CannotLearn]);
    let rows = rows(&folder.path().join("trials.csv"));
    assert_eq!(rows.len(), 8);
    assert_eq!((&*rows[4]["verdict"], &*rows[4]["converged"], &*rows[4]["sensor_rmse_mm"]), ("error", "false", ""));
    assert!(rows[4]["reason"].contains("panicked: index"), "{}", rows[4]["reason"]);
    assert!(rows[6]["reason"].ends_with("and a comma"), "{}", rows[6]["reason"]);
    // A case with an error is tried again.
    assert_eq!(std::fs::read_dir(folder.path().join("cases")).expect("there").count(), 0);
}

#[test]
fn a_log_that_cannot_be_made_makes_its_trials_errors() {
    struct None;
    impl Source for None {
        fn cases(&self) -> Vec<Case> {
            vec![Case { seed: 1, ..Case::default() }]
        }
        fn dataset(&self, _: &Case) -> Result<Dataset, String> {
            Err("the robot fell".into())
        }
        fn fingerprint(&self) -> String {
            String::new()
        }
        fn survey(&self) -> Option<Survey> {
            Option::None
        }
    }
    let folder = tempfile::tempdir().expect("made");
    let outcome = run(&Plan { source: Box::new(None), ..plan(1) }, folder.path(), 1);
    assert!(
        outcome.results.trials().all(|(_, trial)| trial.ending == Ending::Error && trial.reason == "the robot fell")
    );
}

/// The columns are a contract, and the paper's number stands under ours.
#[test]
fn the_table_has_the_agreed_columns_and_the_published_rows() {
    let folder = tempfile::tempdir().expect("made");
    let outcome = run(&plan(3), folder.path(), 2);
    let table = std::fs::read_to_string(folder.path().join("table_3_1.csv")).expect("there");
    let mut lines = table.lines();
    let header = "source,learner,starting_model,duration_s,sensor_rmse_mm_mean,sensor_rmse_mm_sd,\
                  action_rmse_mm_per_s_mean,action_rmse_mm_per_s_sd,converged,trials";
    assert_eq!(lines.next(), Some(header));
    let ours = lines.next().expect("a row");
    assert!(ours.starts_with("asami,algorithm1,c,150.0,") && ours.ends_with(",3,3"), "{ours}");
    assert_eq!(lines.next(), Some("dissertation,algorithm1,c,150.0,70.4,13.9,29.6,12.4,15,15"));
    let floors: Vec<&str> = lines.filter(|line| line.contains(",floor,")).collect();
    assert!(floors[0].starts_with("reference,floor,,,") && floors[0].ends_with(",,,"), "{floors:?}");
    assert_eq!(floors[1], "dissertation,floor,,,48.8,,17.2,,,");

    // The mean in the table is the mean of the raw rows.
    let mut reader = csv::Reader::from_path(folder.path().join("trials.csv")).expect("there");
    let header = reader.headers().expect("a header").iter().collect::<Vec<_>>().join(",");
    let agreed =
        "scenario,learner,starting_model,seed,duration_s,converged,sensor_rmse_mm,action_rmse_mm_per_s,scale_ratio";
    assert!(header.starts_with(agreed), "{header}");
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().expect("a table");
    let of_first: Vec<f64> = rows[..3].iter().map(|row| row[6].parse().expect("a number")).collect();
    let mean: f64 = ours.split(',').nth(4).expect("a field").parse().expect("a number");
    assert!((mean - of_first.iter().sum::<f64>() / 3.0).abs() < 1e-9 * mean);

    // What the file of a learner says is what was scored: read back, it scores the same.
    let models = asami_dataset::store::read_models(&folder.path().join("models/algorithm1-c-1.toml")).expect("ours").1;
    let survey = outcome.results.survey.expect("surveyed");
    let scores = asami::scorer::line::Yardstick::surveyed(&survey).score(&models);
    assert_eq!(scores.sensor_rmse_m.map(|metres| metres * 1000.0), Some(of_first[0]));
}

#[test]
fn an_answer_that_was_not_expected_is_said_to_be_so() {
    let folder = tempfile::tempdir().expect("made");
    let text =
        SCENARIO.replace("converged_share_min = 1.0", "converged_share_max = 0.5").replace("max = 5.0", "max = 1.0");
    let scenario = scenario::parse("line", "line.toml", &text).expect("sound");
    let outcome = run(&Plan { scenario, ..plan(2) }, folder.path(), 2);
    assert_eq!(outcome.verdicts.iter().map(|verdict| verdict.holds).collect::<Vec<_>>(), [false, false]);
    let said = "NOT as expected: algorithm1 from c, 150 s: at most 50 % converge (2 of 2)";
    assert!(outcome.text().contains(said), "{}", outcome.text());
}
