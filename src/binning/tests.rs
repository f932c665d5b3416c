use std::collections::BTreeMap;

use asami_dataset::{Action, Command, Log, Seed, Sighting, Size, TruePose};
use rand::RngExt;

use super::{Binning, velocities};

fn wheels(t_s: f64, v_m_per_s: f64, omega_rad_per_s: f64) -> Command {
    Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } }
}

/// A log of these commands that lasts until `end_s`.
fn log(commands: Vec<Command>, end_s: f64) -> Log {
    let end = Sighting { t_s: end_s, landmark: 0, size: Size::RangeM(1.0), bearing_rad: 0.0 };
    Log { commands: commands.into(), sightings: vec![end].into(), ..Log::default() }
}

fn ids(log: &Log) -> Vec<u16> {
    let id = |command: &Command| match command.action {
        Action::Wheels { id, .. } => id,
        _ => None,
    };
    log.commands.iter().filter_map(id).collect()
}

fn by_quantiles(v_cells: u16, omega_cells: u16) -> Binning {
    Binning { v_cells: Some(v_cells), omega_cells: Some(omega_cells), ..Binning::default() }
}

#[test]
fn cells_by_quantiles_are_in_force_for_equal_times() {
    let mut rng = Seed(1000).stream("commands");
    let commands: Vec<Command> = (0..4000)
        .map(|n| {
            let v = rng.random::<f64>();
            wheels(f64::from(n) * 0.1, v, v * (rng.random::<f64>() - 0.5))
        })
        .collect();
    let binned = by_quantiles(4, 5).binned(&log(commands.clone(), 400.0));
    let mut counts = BTreeMap::new();
    ids(&binned).into_iter().for_each(|id| *counts.entry(id).or_insert(0) += 1);
    assert_eq!(counts.keys().copied().collect::<Vec<_>>(), (0..20).collect::<Vec<u16>>());
    assert!(counts.values().all(|count| (199..=201).contains(count)), "{counts:?}");
    // Ids go up with the speed, and within a band of it with the turning rate.
    for (a, id_a) in commands.iter().zip(ids(&binned)).step_by(37) {
        for (b, id_b) in commands.iter().zip(ids(&binned)).step_by(41) {
            let (
                Action::Wheels { v_m_per_s: v_a, omega_rad_per_s: o_a, .. },
                Action::Wheels { v_m_per_s: v_b, omega_rad_per_s: o_b, .. },
            ) = (a.action, b.action)
            else {
                unreachable!()
            };
            assert!(id_a / 5 >= id_b / 5 || v_a < v_b);
            assert!(id_a / 5 != id_b / 5 || id_a >= id_b || o_a < o_b);
        }
    }
}

#[test]
fn a_command_that_is_in_force_for_long_is_in_one_cell() {
    // Half of the time it stands still; the rest is spread.
    let speeds = (0..100).map(|n| if n % 2 == 0 { 0.0 } else { 0.001 * f64::from(n) });
    let commands = speeds.enumerate().map(|(n, v)| wheels(n as f64, v, 0.0)).collect();
    let ids = ids(&by_quantiles(4, 3).binned(&log(commands, 100.0)));
    assert!(ids.iter().step_by(2).all(|id| *id == ids[0]));
    assert!(ids.iter().skip(1).step_by(2).all(|id| *id != ids[0]), "moving is another action: {ids:?}");
}

#[test]
fn edges_that_are_given_hold_whatever_the_log() {
    let binning = Binning {
        v_edges_m_per_s: Some(vec![0.1]),
        omega_edges_rad_per_s: Some(vec![-0.2, 0.2]),
        ..Binning::default()
    };
    let commands = vec![wheels(0.0, 0.05, -0.3), wheels(1.0, 0.1, 0.2), wheels(2.0, 0.11, 0.0), wheels(3.0, 9.0, 9.0)];
    assert_eq!(ids(&binning.binned(&log(commands, 4.0))), [0, 1, 4, 5]);
}

#[test]
fn averaging_over_steps_keeps_the_way_and_the_turn() {
    let mut rng = Seed(1001).stream("commands");
    let mut t_s = 3.0;
    let commands: Vec<Command> = (0..500)
        .map(|_| {
            t_s += 0.01 + rng.random::<f64>();
            wheels(t_s, rng.random::<f64>(), rng.random::<f64>() - 0.5)
        })
        .collect();
    let log = log(commands, t_s + 0.3);
    let binned = Binning { step_s: Some(0.37), ..by_quantiles(3, 3) }.binned(&log);
    let totals = |log: &Log| {
        let ends = log.commands.iter().skip(1).map(|next| next.t_s).chain([t_s + 0.3]);
        log.commands.iter().zip(ends).fold([0.0; 2], |[way, turn], (command, end_s)| match command.action {
            Action::Wheels { v_m_per_s, omega_rad_per_s, .. } => {
                let held_s = end_s - command.t_s;
                [way + v_m_per_s * held_s, turn + omega_rad_per_s * held_s]
            }
            _ => [way, turn],
        })
    };
    let ([way, turn], [way_after, turn_after]) = (totals(&log), totals(&binned));
    assert!(
        (way - way_after).abs() < 1e-9 && (turn - turn_after).abs() < 1e-9,
        "{way} {way_after} {turn} {turn_after}"
    );
    assert!(binned.commands.windows(2).all(|pair| (pair[1].t_s - pair[0].t_s - 0.37).abs() < 1e-9));
}

#[test]
fn on_an_arc_the_velocity_is_along_the_heading() {
    // 0.4 m/s and 0.5 rad/s counter-clockwise; then 0.2 m/s backwards. Poses at times of their own.
    let (v, omega) = (0.4, 0.5);
    let arc = |t_s: f64| TruePose {
        t_s,
        x_m: v / omega * ((omega * t_s).cos() - 1.0),
        y_m: v / omega * (omega * t_s).sin(),
        theta_rad: asami_math::angle::wrap_rad(omega * t_s),
        v_m_per_s: None,
    };
    let turned = arc(30.0);
    let back = |t_s: f64| TruePose {
        t_s,
        x_m: turned.x_m + 0.2 * (t_s - 30.0) * turned.theta_rad.sin(),
        y_m: turned.y_m - 0.2 * (t_s - 30.0) * turned.theta_rad.cos(),
        ..turned
    };
    let times = (0..6000).map(|n| 0.01 * f64::from(n));
    let track: Vec<TruePose> = times.map(|t_s| if t_s < 30.0 { arc(t_s) } else { back(t_s) }).collect();
    let commands = (0..590).map(|n| wheels(0.1 * f64::from(n), if n < 300 { 0.4 } else { -0.2 }, 0.0)).collect();
    let log = by_quantiles(2, 1).binned(&log(commands, 59.0));
    let found = velocities(&log, &track, 0.0);
    assert_eq!(found.iter().map(|it| it.action).collect::<Vec<_>>(), [0, 1]);
    let expected = [[0.0, -0.2, 0.0], [0.0, v, omega]];
    for (found, expected) in found.iter().zip(expected) {
        let found = [found.vx_m_per_s, found.vy_m_per_s, found.vtheta_rad_per_s];
        // A chord of 0.05 rad is shorter than its arc by 1e-4 of it.
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-5), "{found:?} {expected:?}");
    }
}

#[test]
fn an_action_that_was_hardly_seen_has_no_truth() {
    let commands = vec![wheels(0.0, 0.1, 0.0), wheels(0.1, 0.2, 0.0), wheels(0.2, 0.1, 0.0), wheels(0.3, 0.1, 0.0)];
    let track: Vec<TruePose> = (0..5)
        .map(|n| TruePose { t_s: 0.1 * f64::from(n), x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None })
        .collect();
    assert!(velocities(&by_quantiles(2, 1).binned(&log(commands, 0.4)), &track, 0.0).is_empty());
}

#[test]
fn a_command_that_acts_later_is_dated_later() {
    let log = log(vec![wheels(0.0, 0.1, 0.0), wheels(1.0, 0.2, 0.0)], 4.0);
    let late = Binning { delay_s: Some(0.25), ..by_quantiles(2, 1) }.binned(&log);
    assert_eq!(late.commands.iter().map(|command| command.t_s).collect::<Vec<_>>(), [0.25, 1.25]);
    assert_eq!(ids(&late), ids(&by_quantiles(2, 1).binned(&log)));
}

#[test]
fn a_robot_that_gets_going_late_is_timed_once_it_goes() {
    // Told to go at 0.3 m/s for 4 s, then to stand for 4 s, it heeds each half a second late.
    let speed = |t_s: f64| if t_s >= 0.5 && (t_s - 0.5).rem_euclid(8.0) < 4.0 { 0.3 } else { 0.0 };
    let mut y_m = 0.0;
    let track: Vec<TruePose> = (0..16_000)
        .map(|n| {
            let pose = TruePose { t_s: 0.01 * f64::from(n), x_m: 0.0, y_m, theta_rad: 0.0, v_m_per_s: None };
            y_m += 0.01 * speed(pose.t_s + 0.005);
            pose
        })
        .collect();
    let commands = (0..1590).map(|n| wheels(0.1 * f64::from(n), if n % 80 < 40 { 0.3 } else { 0.0 }, 0.0)).collect();
    let log = by_quantiles(2, 1).binned(&log(commands, 159.0));
    let forward = |settle_s| velocities(&log, &track, settle_s).iter().map(|it| it.vy_m_per_s).collect::<Vec<_>>();
    let (at_once, settled) = (forward(0.0), forward(0.5));
    // Of each 4 s half a second belongs to the command before.
    assert!((at_once[0] - 0.3 / 8.0).abs() < 2e-3 && (at_once[1] - 0.3 * 7.0 / 8.0).abs() < 2e-3, "{at_once:?}");
    assert!(settled[0].abs() < 1e-9 && (settled[1] - 0.3).abs() < 1e-9, "{settled:?}");
}

#[test]
fn what_makes_no_cells_is_refused() {
    let mut faults = Vec::new();
    let wrong = Binning {
        step_s: Some(0.0),
        delay_s: Some(-0.1),
        v_cells: Some(0),
        v_edges_m_per_s: Some(vec![0.2, 0.1]),
        ..Binning::default()
    };
    wrong.check("binning", &mut faults);
    let messages: Vec<&str> = faults.iter().map(|fault| fault.message.as_str()).collect();
    assert_eq!(
        messages,
        [
            "step_s must lie in 0.001..=10 s, not 0",
            "delay_s must lie in 0..=5 s, not -0.1",
            "a binning must have v_cells or v_edges_m_per_s; both are given",
            "v_cells must lie in 1..=64, not 0",
            "v_edges_m_per_s must be numbers that increase, not [0.2, 0.1]",
            "a binning must have omega_cells or omega_edges_rad_per_s; neither is given",
        ]
    );
}
