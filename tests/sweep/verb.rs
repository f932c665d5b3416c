//! The verb `sweep` as a user runs it: exit codes, being killed, a real robot's log.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use asami::scenario;
use asami::sweep::Silent;
use asami::sweep::line::carry_out;
use asami::sweep::verb::{self, Asked, plan};

use crate::{options, rows};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn command(arguments: &[&str], out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweep"));
    command.current_dir(root()).args(arguments).arg("-o").arg(out);
    command
}

fn sweep(arguments: &[&str], out: &Path) -> Output {
    command(arguments, out).output().expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The shipped scenario with logs of seconds and a survey of a few paces.
fn short_scenario(folder: &Path) -> PathBuf {
    let text = std::fs::read_to_string(root().join("scenarios/aibo_1d.toml")).expect("shipped");
    let text = text.replace("duration_s = 300", "duration_s = 20").replace("duration_s = 150", "duration_s = 10");
    let survey = "\n[survey]\ntimings = 1\nspeed_step_m_per_s = 0.15\nslow_time_s = 1.0\ncourse_m = 0.3\nrun_up_s = 0.5\n\
                  distance_step_m = 1.2\nreadings = 2\n";
    let text = text.replacen("\n[divergence]", &format!("{survey}\n[divergence]"), 1);
    let path = folder.join("short.toml");
    std::fs::write(&path, text).expect("written");
    path
}

#[test]
fn what_the_user_must_mend_is_exit_2() {
    let folder = tempfile::tempdir().expect("made");
    let missing = sweep(&["scenarios/no_such.toml"], folder.path());
    assert_eq!(missing.status.code(), Some(2));
    assert!(stderr(&missing).contains("no_such.toml"), "{}", stderr(&missing));

    let broken = folder.path().join("broken.toml");
    std::fs::write(&broken, "schema = 1\nabuot = \"what?\"\n").expect("written");
    let broken = sweep(&[&broken.display().to_string()], folder.path());
    assert_eq!(broken.status.code(), Some(2));
    assert!(stderr(&broken).contains("broken.toml:2:1"), "{}", stderr(&broken));
    assert!(stderr(&broken).contains("did you mean `about`?"), "{}", stderr(&broken));

    let nowhere = folder.path().join("nowhere").display().to_string();
    let no_data = sweep(&["scenarios/barfoot_1d.toml", "--data", &nowhere], folder.path());
    assert_eq!(no_data.status.code(), Some(2));
    assert!(stderr(&no_data).contains("Giant Glass of Milk"), "{}", stderr(&no_data));

    let seeds = sweep(&["scenarios/barfoot_1d.toml", "--seeds", "3"], folder.path());
    assert_eq!(seeds.status.code(), Some(2));
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 1, "nothing but our broken.toml");
}

#[test]
fn killed_for_good_and_gone_on_with_is_as_never_stopped() {
    let folder = tempfile::tempdir().expect("made");
    let scenario = short_scenario(folder.path()).display().to_string();
    let (whole, stopped) = (folder.path().join("whole"), folder.path().join("stopped"));
    let done = sweep(&[&scenario, "--seeds", "4", "--jobs", "2"], &whole);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));

    let mut child = command(&[&scenario, "--seeds", "4", "--jobs", "1"], &stopped)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let began = Instant::now();
    // A file that is still being written aside is no case that is done.
    let is_kept = |entry: std::fs::DirEntry| entry.path().extension().is_some_and(|extension| extension == "json");
    let any_kept = || std::fs::read_dir(stopped.join("cases")).is_ok_and(|found| found.flatten().any(is_kept));
    while !any_kept() && began.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("still running, or just done");
    child.wait().expect("ends");

    let resumed = sweep(&[&scenario, "--seeds", "4", "--jobs", "1"], &stopped);
    assert_eq!(resumed.status.code(), Some(0), "{}", stderr(&resumed));
    assert!(stderr(&resumed).contains("going on where it stopped: "), "{}", stderr(&resumed));
    assert_eq!(done.stdout, resumed.stdout);
    for name in ["trials.csv", "table_3_1.csv", "table_3_1.md", "table_3_1.tex", "statistics.csv"] {
        let [a, b] = [&whole, &stopped].map(|folder| std::fs::read(folder.join(name)).expect(name));
        assert!(a == b, "{name} differs");
    }
}

/// The best learners on the logs of six real robots: what must hold of each of their trials.
#[test]
fn real_robots_in_the_plane_are_learned() {
    let within = |row: &BTreeMap<String, String>, column: &str, most: f64| {
        let value: f64 = row[column].parse().expect(column);
        assert!(value <= most, "{column} {value} > {most}: {row:?}");
    };
    for (name, data, learner, start, trials) in
        [("barfoot_2d", "barfoot_2d", "em_shared", "published", 2), ("mrclam", "mrclam6", "em_robust", "attempted", 5)]
    {
        let mut scenario = scenario::read(&root().join(format!("scenarios/{name}.toml"))).expect("shipped");
        if !root().join("../shared/data").join(data).exists() {
            eprintln!("skipped: the data of scenarios/{name}.toml are not there");
            continue;
        }
        scenario.rows.retain(|row| row.label == learner && row.start.is_some_and(|it| it.name() == start));
        scenario.expect.clear();
        let plan = plan(scenario, &Asked::default()).expect("the data are sound");
        let folder = tempfile::tempdir().expect("made");
        let finished = verb::carry_out(&plan, &options(folder.path(), 2), &Silent).expect("files can be written");
        assert!(!finished.has_errors, "{}", finished.text);
        let rows = rows(&folder.path().join("trials.csv"));
        assert_eq!(rows.len(), trials);
        for row in rows {
            assert_eq!(row["converged"], "true", "{row:?}");
            match name {
                "barfoot_2d" => {
                    within(&row, "vx_rmse_mm_per_s", 9.4);
                    within(&row, "vy_rmse_mm_per_s", 13.4);
                    within(&row, "vtheta_rmse_rad_per_s", 0.0183);
                }
                _ => {
                    within(&row, "vx_rmse_mm_per_s", 5.0);
                    within(&row, "vtheta_percent", 5.0);
                }
            }
        }
    }
}

/// The expected answers of the scenario on a real robot's log, which takes a second.
#[test]
fn a_real_robot_gives_the_expected_answers() {
    let scenario = scenario::read(&root().join("scenarios/barfoot_1d.toml")).expect("shipped");
    if !root().join("../shared/data/barfoot_1d").exists() {
        eprintln!("skipped: the data of scenarios/barfoot_1d.toml are not there");
        return;
    }
    let plan = plan(scenario, &Asked::default()).expect("the data are sound");
    let folder = tempfile::tempdir().expect("made");
    let outcome = carry_out(&plan, &options(folder.path(), 2), &Silent).expect("files can be written");
    assert!(!outcome.results.has_errors());
    assert!(!outcome.verdicts.is_empty());
    for verdict in &outcome.verdicts {
        assert!(verdict.holds, "{}", verdict.claim);
    }

    let mut reader = csv::Reader::from_path(folder.path().join("trials.csv")).expect("there");
    let columns: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let first = [
        "scenario",
        "learner",
        "starting_model",
        "seed",
        "duration_s",
        "converged",
        "sensor_rmse_mm",
        "action_rmse_mm_per_s",
        "scale_ratio",
        "window_start_s",
        "overlapping",
        "floor_sensor_rmse_mm",
    ];
    assert_eq!(columns[..first.len()], first);
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().expect("a table");
    let starts_s = |overlapping: &str| -> Vec<f64> {
        let rows = rows.iter().filter(|row| &row[1] == "canonical" && &row[10] == overlapping);
        rows.map(|row| row[9].parse().expect("a number")).collect()
    };
    assert_eq!(starts_s("false"), [75.0, 225.0, 375.0, 525.0]);
    assert_eq!(starts_s("true"), (0..19).map(|i| 75.0 + 25.0 * f64::from(i)).collect::<Vec<_>>());
    // Window by window, not only on average: within 3 % of the best cubic.
    for row in rows.iter().filter(|row| &row[1] == "canonical" && &row[10] == "false") {
        let [error, floor] = [&row[6], &row[11]].map(|field| field.parse::<f64>().expect("a number"));
        assert!(&row[5] == "true" && error <= 1.03 * floor, "{row:?}");
    }
}
