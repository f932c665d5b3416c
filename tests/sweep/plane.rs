//! Chapter 4's sweep in the plane: columns that are agreed, tables that say what the rows say, the same bytes on
//! any number of threads.

use asami::scenario;
use asami::sweep::verb::{Asked, plan};

use crate::{number, rows, sweep};

/// The dissertation's own simulator with little noise, for some minutes.
const SCENARIO: &str = r#"
schema = 1
about = "Does the machinery work in the plane?"
study = "plane"
robot = "plain"
duration_s = 400
seeds = 3
first_seed = 1000
[start]
y_m = 0.0
[plain.sight]
sigma2_rad = 0.05
[[field.beacons]]
id = 0
body = { x_m = 1.95, y_m = 1.35, radius_m = 0.05, base_m = 0.1, height_m = 0.2, bands = ["pink", "yellow"] }
[[field.beacons]]
id = 1
body = { x_m = -1.95, y_m = 1.35, radius_m = 0.05, base_m = 0.1, height_m = 0.2, bands = ["yellow", "pink"] }
[[field.beacons]]
id = 2
body = { x_m = 0.0, y_m = -2.7, radius_m = 0.05, base_m = 0.1, height_m = 0.2, bands = ["pink", "blue"] }
[survey]
near_m = 1.275
far_m = 4.175
distance_step_m = 0.1
[learners.em_published]
max_iterations = 25
[[rows]]
learner = "em_published"
starts = ["published", "attempted"]
[[rows]]
learner = "em_rts"
start = "attempted"
with = { max_iterations = 25.0 }
[[expect]]
learner = "em_published"
start = "attempted"
median_max = { vtheta_rmse_rad_per_s = 0.2, sigma1_off_percent = 0.0 }
median_min = { observations = 300 }
"#;

#[test]
fn columns_are_those_agreed_and_tables_say_what_rows_say() {
    let folder = tempfile::tempdir().expect("made");
    let finished = sweep(SCENARIO, folder.path(), 2);
    assert!(!finished.has_errors, "{}", finished.text);

    let text = std::fs::read_to_string(folder.path().join("trials.csv")).expect("there");
    let agreed = "scenario,learner,starting_model,seed,converged,iterations,vx_rmse_mm_per_s,vy_rmse_mm_per_s,\
                  vtheta_rmse_rad_per_s,sensor_rmse_px,sensor_rmse_mm,sigma1_px,sigma1_mm,sigma2_rad,sigma1_true_px,\
                  sigma1_true_mm,sigma2_true_rad,";
    assert!(text.starts_with(agreed), "{}", text.lines().next().unwrap_or_default());
    let trials = rows(&folder.path().join("trials.csv"));
    assert_eq!(trials.len(), 9);
    for trial in &trials {
        // Heights, not ranges; the plain robot's noise is what the scenario says, at every distance.
        assert!(
            trial["sensor_rmse_mm"].is_empty() && trial["sigma1_mm"].is_empty() && trial["sigma1_true_mm"].is_empty()
        );
        assert_eq!((number(trial, "sigma1_true_px"), number(trial, "sigma2_true_rad")), (1.0, 0.05));
        assert!((0.5..1.5).contains(&number(trial, "nis")) || trial["converged"] == "false", "{trial:?}");
    }

    // The dissertation's numbers stand under the row that they are of, once.
    // In short: from the published start alone.
    let short = rows(&folder.path().join("table_4.csv"));
    assert!(short.iter().all(|row| ["published", ""].contains(&&*row["starting_model"])), "{short:?}");
    let table = rows(&folder.path().join("table_4_velocities.csv"));
    let sources: Vec<&str> = table.iter().map(|row| &*row["source"]).collect();
    assert_eq!(sources, ["asami", "dissertation", "asami", "asami", "reference", "reference", "reference"]);
    assert_eq!(number(&table[1], "vx_rmse_mm_per_s_median"), 23.06);
    assert_eq!([4, 5, 6].map(|i| &*table[i]["learner"]), ["unlearned", "unlearned", "bound"]);
    assert_eq!(number(&table[6], "vx_to_bound_median"), 1.0);
    let mut of_third: Vec<f64> = trials
        .iter()
        .filter(|row| {
            (&*row["learner"], &*row["starting_model"], &*row["converged"]) == ("em_published", "attempted", "true")
        })
        .map(|row| number(row, "vtheta_rmse_rad_per_s"))
        .collect();
    of_third.sort_by(f64::total_cmp);
    assert_eq!(of_third.len().to_string(), table[2]["converged"]);
    assert_eq!(number(&table[2], "vtheta_rmse_rad_per_s_median"), of_third[of_third.len() / 2]);
    for name in ["sensor", "noise", "convergence", "consistency"] {
        for extension in ["csv", "md", "tex"] {
            let path = folder.path().join(format!("table_4_{name}.{extension}"));
            assert!(std::fs::metadata(&path).expect("there").len() > 100, "{}", path.display());
        }
    }

    // A bound that nothing meets is said not to hold; the others hold.
    let said: Vec<&str> = finished.text.lines().filter(|line| line.contains("as expected: ")).collect();
    assert_eq!(said.len(), 3, "{}", finished.text);
    for line in said {
        assert_eq!(line.starts_with("NOT "), line.contains("sigma1_off_percent"), "{line}");
    }
}

#[test]
fn one_thread_and_two_give_the_same_bytes() {
    let folders = [tempfile::tempdir().expect("made"), tempfile::tempdir().expect("made")];
    let said = [1, 2].map(|jobs| sweep(SCENARIO, folders[jobs - 1].path(), jobs));
    assert_eq!(said[0], said[1]);
    for name in ["trials.csv", "statistics.csv", "comparisons.csv", "table_4_velocities.md", "table_4_noise.tex"] {
        let [a, b] = [0, 1].map(|i| std::fs::read(folders[i].path().join(name)).expect(name));
        assert!(a == b, "{name} differs");
    }
}

/// `--only`: the rows asked for, what is expected of them, and the name that was meant.
#[test]
fn only_some_rows_are_swept_if_asked() {
    let folder = tempfile::tempdir().expect("made");
    let plan_of = |only: &[&str]| {
        let scenario = scenario::parse("plane", "plane.toml", SCENARIO).expect("sound");
        let only = only.iter().map(|name| (*name).to_owned()).collect();
        plan(scenario, &Asked { out: folder.path().to_owned(), only, ..Asked::default() })
    };
    let plan = plan_of(&["em_rts"]).expect("sound");
    assert_eq!((plan.scenario.rows.len(), plan.learners.len(), plan.scenario.expect.len()), (1, 1, 0));
    let Err(refused) = plan_of(&["em_rst"]) else { panic!("there is no such row") };
    assert!(refused.to_string().contains("no row called em_rst (did you mean em_rts?)"), "{refused}");
}
