use asami_dataset::Action;

use super::*;

const C: [f64; 6] = [-0.1, 3.0, -0.05, -0.6, 0.002, 0.25];

/// Pedals that change with every step, and a track on which every step's speed and turning rate are just what eqs 5.3 and
/// 5.4 make of them.
fn drive(count: usize) -> (Channel<TruePose>, Channel<Command>) {
    let (mut v, mut pose) = (0.5, TruePose { t_s: 0.0, x_m: 1.0, y_m: 2.0, theta_rad: 0.3, v_m_per_s: None });
    let (mut track, mut commands) = (vec![pose], Vec::new());
    let model = Coefficients { c: C, se: None };
    for i in 0..count {
        let phase = i as f64;
        let held @ [throttle, brake, steering] =
            [0.3 + 0.3 * (0.7 * phase).sin(), 0.2 + 0.2 * (1.3 * phase).cos(), 0.5 * (0.37 * phase).sin()];
        commands.push(Command { t_s: pose.t_s, action: Action::Pedals { throttle, brake, steering } });
        let turn_rad = STEP_S * model.turning(v, held);
        let (sin, cos) = (pose.theta_rad + 0.5 * turn_rad).sin_cos();
        pose.x_m -= STEP_S * v * sin;
        pose.y_m += STEP_S * v * cos;
        pose.theta_rad = wrap_rad(pose.theta_rad + turn_rad);
        pose.t_s = STEP_S * (i + 1) as f64;
        v += STEP_S * model.acceleration(v, held);
        track.push(pose);
    }
    (track.into(), commands.into())
}

fn yardstick(angles_rad: Vec<f64>) -> Yardstick {
    let (track, commands) = drive(60);
    Yardstick::of(angles_rad, &track, &track, &commands)
}

fn model(c: [f64; 6], delay_s: f64) -> Models {
    Models { action: Some(ActionModel::Car { c, se: None, delay_s }), ..Models::default() }
}

#[test]
fn the_very_model_of_a_drive_errs_by_nothing_and_is_found_from_truth() {
    let yardstick = yardstick(Vec::new());
    assert_eq!(yardstick.steps.len(), 60);
    let scores = yardstick.score(&model(C, 0.0));
    assert!(scores.rolled_rmse.unwrap().iter().all(|rmse| *rmse < 1e-9), "{scores:?}");
    assert!(scores.one_step_rmse.unwrap() < 1e-9);
    assert!(yardstick.faults(&scores, 0.999).is_empty());
    let Some(ActionModel::Car { c, .. }) = yardstick.from_truth().unwrap().action else { panic!() };
    assert!(c.iter().zip(C).all(|(found, truth)| (found - truth).abs() < 1e-6), "{c:?}");
    // A model that does nothing explains nothing of the speed, and none is a fault.
    let still = yardstick.score(&model([0.0; 6], 0.0));
    assert!(still.rolled_r2.unwrap()[1] <= 0.0);
    assert_eq!(yardstick.faults(&Scores::default(), 0.5).len(), 3);
}

/// What acts half a second later happens a step later.
#[test]
fn a_delay_shifts_the_roll_out() {
    let pedals = |i: usize| Action::Pedals { throttle: if i < 6 { 0.0 } else { 0.4 }, brake: 0.0, steering: 0.2 };
    let commands: Vec<_> = (0..40).map(|i| Command { t_s: 0.5 * i as f64, action: pedals(i) }).collect();
    let still = |i: usize| TruePose { t_s: 0.5 * i as f64, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
    let track: Channel<TruePose> = (0..=40).map(still).collect::<Vec<_>>().into();
    let yardstick = Yardstick::of(Vec::new(), &track, &track, &commands.into());
    let rolled =
        |delay_s: f64| yardstick.rolled(&ActionModel::Car { c: [0.0, 2.0, -0.1, -1.0, 0.0, 0.3], se: None, delay_s });
    let (sooner, later) = (rolled(0.5), rolled(1.0));
    assert!(sooner[20][1] > 1.0);
    for (a, b) in sooner.iter().zip(&later[1..]) {
        assert!((a[1] - b[1]).abs() < 1e-9 && (a[2] - b[2]).abs() < 1e-9, "{a:?} {b:?}");
    }
    // The mean of what a throttle of 0.4 makes, v = 8 (1 - exp(-0.1 t)), over a step that begins 6.5 s after it does.
    let mean = 8.0 - 80.0 / 0.5 * ((-0.65f64).exp() - (-0.7f64).exp());
    assert!((sooner[20][1] - mean).abs() < 1e-3, "{} {mean}", sooner[20][1]);
}

#[test]
fn angles_are_held_against_the_truth_as_they_are_and_less_their_common_offset() {
    let truth: Vec<f64> = (0..64).map(|i| 3.0 + 0.16 * f64::from(i % 7) / 7.0).collect();
    let yardstick = Yardstick { angles_rad: truth.clone(), ..Yardstick::default() };
    let score = |learned: Vec<f64>| {
        let sensor = SensorModel::Angles { horizontal_angles_rad: learned, se_rad: vec![0.01; 64] };
        yardstick.score(&Models { sensor: Some(sensor), ..Models::default() }).angles.unwrap()
    };
    // Past the half turn, where angles wrap.
    let turned = score(truth.iter().map(|angle| wrap_rad(angle + 0.015)).collect());
    assert!((turned.rms_rad - 0.015).abs() < 1e-12 && turned.rms_common_removed_rad < 1e-12, "{turned:?}");
    assert!(turned.worst_pair_rad < 1e-12 && turned.covered == [64, 64]);
    let mut one_off = truth.clone();
    one_off[10] += 0.08;
    let one_off = score(one_off);
    assert!((one_off.rms_rad - 0.01).abs() < 1e-12 && (one_off.worst_pair_rad - 0.08).abs() < 1e-12, "{one_off:?}");
    assert_eq!(one_off.covered, [63, 64]);
    let short = SensorModel::Angles { horizontal_angles_rad: vec![0.0; 3], se_rad: Vec::new() };
    assert_eq!(yardstick.score(&Models { sensor: Some(short), ..Models::default() }).angles, None);
}
