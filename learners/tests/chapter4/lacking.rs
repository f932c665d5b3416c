//! Logs that cannot determine the models: what is missing is said, and what is learned is no surer than it may be.

use asami_dataset::{Action, ActionModel, Command, Log, Models};
use asami_learners::{Lack, Needs, Verdict};

use crate::synthetic::{Walker, learn, published, score, truth};

fn names() -> Vec<&'static str> {
    let all = asami_learners::catalogue().into_iter();
    all.filter(|about| about.needs == Needs::Both && about.name.starts_with("em_") && !about.name.contains("1d"))
        .map(|about| about.name)
        .collect()
}

fn standard_errors(models: &Models) -> Vec<(u16, Option<[f64; 3]>)> {
    let Some(ActionModel::Table(entries)) = &models.action else { panic!("no table") };
    entries.iter().map(|entry| (entry.action, entry.se)).collect()
}

#[test]
fn actions_hardly_or_never_executed() {
    let walker = Walker { steps: 3_000, sigma2_rad: 0.1, ..Walker::default() };
    let mut log = walker.log(1003);
    // Action 7 only ever for the last half second, 39 never.
    let mut commands: Vec<Command> = log
        .commands
        .iter()
        .map(|row| {
            let Action::Legs { id: Some(id), ax_m_per_s, ay_m_per_s, atheta_rad_per_s } = row.action else {
                panic!("{row:?}")
            };
            let id = Some(if id == 7 || id == 39 { 6 } else { id });
            Command { action: Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s }, ..*row }
        })
        .collect();
    commands.push(Command {
        t_s: 149.5,
        action: Action::Legs { id: Some(7), ax_m_per_s: 0.1, ay_m_per_s: 0.1, atheta_rad_per_s: 0.0 },
    });
    log.commands = commands.into();
    for name in names() {
        let learned = learn(name, &[("max_iterations", 25.0)], &log, &truth(&walker)).unwrap();
        let rare = |lack: &Lack| matches!(lack, Lack::RareActions { actions, .. } if actions.contains(&7));
        assert!(learned.lacks.iter().any(rare), "{name}: {:?}", learned.lacks);
        let unused = |lack: &Lack| matches!(lack, Lack::UnusedActions { actions } if actions.contains(&39));
        assert!(learned.lacks.iter().any(unused), "{name}: {:?}", learned.lacks);
        let errors = standard_errors(&learned.models);
        assert!(errors.iter().all(|(action, _)| *action != 39));
        let of = |action: u16| errors.iter().find(|error| error.0 == action).and_then(|error| error.1).unwrap();
        if name != "em_shared" {
            assert!(of(7)[1] > 3.0 * of(6)[1], "{name}: {:?} {:?}", of(7), of(6));
        }
    }
}

#[test]
fn a_robot_that_stands_still() {
    let walker = Walker { steps: 2_000, motion_sd: [0.0; 3], actions: 1, speed: 0.0, ..Walker::default() };
    let log = walker.log(1004);
    for name in names() {
        let learned = learn(name, &[("max_iterations", 25.0)], &log, &published()).unwrap();
        let narrow = |lack: &Lack| matches!(lack, Lack::NarrowObservations { .. });
        assert!(learned.lacks.iter().any(narrow), "{name}: {:?}", learned.lacks);
        // From one place f is seen at two or three distances: some of its four coefficients is open.
        let Some(asami_dataset::SensorModel::HeightOfDistance(curve)) = &learned.models.sensor else { panic!() };
        assert!(curve.se.is_empty() || curve.se.iter().any(|se| *se > 1.0), "{name}: {:?}", curve.se);
    }
}

#[test]
fn one_landmark() {
    let walker = Walker { beacons: vec![2], steps: 6_000, ..Walker::default() };
    let all = Walker { steps: 6_000, ..Walker::default() };
    let learned = |walker: &Walker, name: &str| -> (Vec<Lack>, f64) {
        let log: Log = walker.log(1005);
        let learned = learn(name, &[("max_iterations", 25.0)], &log, &truth(walker)).unwrap();
        assert_eq!(learned.verdict, Verdict::Converged);
        let squares = standard_errors(&learned.models).iter().filter_map(|error| error.1).map(|se| se[0] * se[0]).sum();
        (learned.lacks, squares)
    };
    for name in ["em_published", "em_best"] {
        let (lacks, alone) = learned(&walker, name);
        assert!(lacks.contains(&Lack::OneLandmark { landmark: 2 }), "{name}: {lacks:?}");
        let (lacks, together) = learned(&all, name);
        assert!(lacks.is_empty(), "{name}: {lacks:?}");
        assert!(alone > 3.0 * together, "{name}: {alone} {together}");
    }
    assert!(score(&all, &truth(&all)).sensor_px < 0.3);
}
