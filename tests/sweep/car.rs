//! Chapter 5's sweep: columns that are agreed, tables with the dissertation's numbers, angles that are learned.

use crate::{number, rows, sweep};

/// Two short drives: angles are learned from a few turns; of acceleration, speed and yaw rate nothing is asked.
const SCENARIO: &str = r#"
schema = 1
about = "Does the machinery work in traffic?"
study = "car"
robot = "car"
duration_s = 12
seeds = 2
first_seed = 1000
unit = "redrawn"
[town]
detail = 0.0
[velodyne]
turn_rate_hz = 10.0
[divergence]
r2_min = 0.0
[[rows]]
learner = "car_graph"
with = { most_turns = 40 }
[[expect]]
learner = "car_graph"
median_max = { angle_rms_common_removed_deg = 1.0 }
"#;

#[test]
fn columns_are_those_agreed_and_angles_are_learned() {
    let folder = tempfile::tempdir().expect("made");
    let finished = sweep(SCENARIO, folder.path(), 2);
    assert!(!finished.has_errors, "{}", finished.text);
    let text = std::fs::read_to_string(folder.path().join("trials.csv")).expect("there");
    let agreed = "scenario,learner,starting_model,seed,angle_rms_deg,angle_rms_common_removed_deg,worst_pair_deg,\
                  odometry_v_rmse_m_per_s,odometry_omega_rmse_rad_per_s,acceleration_rmse_m_per_s2,speed_rmse_m_per_s,\
                  yaw_rate_rmse_rad_per_s,converged,";
    assert!(text.starts_with(agreed), "{}", text.lines().next().unwrap_or_default());
    let trials = rows(&folder.path().join("trials.csv"));
    assert_eq!(trials.len(), 2);
    for trial in &trials {
        // The published error is 0.544 degrees of 18, from 200 s.
        assert!(number(trial, "angle_rms_common_removed_deg") < 1.0, "{trial:?}");
        assert!(number(trial, "odometry_v_rmse_m_per_s") < 1.0, "{trial:?}");
    }
    let table = rows(&folder.path().join("table_5_1.csv"));
    let line = |source: &str, learner: &str| {
        let found = table.iter().find(|row| row["source"] == source && row["learner"] == learner);
        found.unwrap_or_else(|| panic!("no {learner} of {source} in {table:?}"))
    };
    assert_eq!(number(line("dissertation", "car_published"), "speed_rmse_m_per_s_median"), 1.04);
    assert_eq!(number(line("dissertation", "from_truth"), "speed_rmse_m_per_s_median"), 0.64);
    // Twelve seconds hardly determine what the brake does: the reference's roll-out is there, and not judged.
    assert!(number(line("reference", "from_truth"), "yaw_rate_rmse_rad_per_s_median").is_finite());
    assert_eq!(line("asami", "car_graph")["converged"].len(), 1);
}
