//! The parts of the method, each against its definition.

use asami_dataset::{Action, Command, Seed};
use asami_learners::lidar::{
    Angles, Coefficients, Distance, FreeRun, Matching, PairLag, Registered, Stretch, Target, align, chain, free_run,
    graph, pairs, regress, roll_out,
};
use asami_math::correlation::Peak;
use asami_math::rigid::Rigid;
use proptest::prelude::*;
use rand::RngExt;

/// Corners of rooms: walls along and across, and some poles.
fn cloud(seed: u64) -> Vec<[f64; 2]> {
    let mut rng = Seed(seed).stream("test");
    let mut points = Vec::new();
    for _ in 0..14 {
        let (x, y, length) =
            (60.0 * (rng.random::<f64>() - 0.5), 60.0 * (rng.random::<f64>() - 0.5), 3.0 + 9.0 * rng.random::<f64>());
        let along = rng.random::<f64>() < 0.5;
        points.extend((0..(length / 0.1) as usize).map(|i| {
            let s = 0.1 * i as f64;
            if along { [x + s, y] } else { [x, y + s] }
        }));
    }
    points
}

#[test]
fn a_moved_cloud_is_moved_back() {
    let points = cloud(1000);
    let truth = Rigid { turn_rad: 0.02, x: 0.35, y: -0.2 };
    let seen: Vec<[f64; 2]> = points.iter().map(|p| truth.inverse().apply(*p)).collect();
    // Points lie 0.1 m apart along the walls: point to point, half of that holds a wall lengthwise.
    let lines = Matching { distance: Distance::Lines { scale_m: 0.3 }, shrink: 3.0, ..Matching::published() };
    for (matching, within) in
        [(lines, 1e-6), (Matching { tolerance_m: 1e-9, shrink: 2.0, ..Matching::published() }, 0.05)]
    {
        let found = align(&seen, &Target::new(&points, &matching), Rigid::default(), &matching).unwrap();
        let error = found.motion.after(&truth.inverse());
        assert!(
            error.x.abs() < within && error.y.abs() < within && error.turn_rad.abs() < within,
            "{matching:?}: {found:?}"
        );
    }
}

#[test]
fn clouds_without_points_in_common_do_not_match() {
    let matching = Matching::published();
    let points = cloud(1001);
    let far: Vec<[f64; 2]> = points.iter().map(|[x, y]| [x + 500.0, *y]).collect();
    assert!(align(&far, &Target::new(&points, &matching), Rigid::default(), &matching).is_none());
    assert!(align(&[], &Target::new(&points, &matching), Rigid::default(), &matching).is_none());
    assert!(align(&points, &Target::new(&[], &matching), Rigid::default(), &matching).is_none());
    // All points in one place: nothing holds the turn.
    assert!(align(&[[0.0; 2]; 50], &Target::new(&[[0.0; 2]; 50], &matching), Rigid::default(), &matching).is_none());
}

fn lag(a: usize, b: usize, angle_rad: f64) -> Option<PairLag> {
    let peak = Peak { lag: 0, coefficient: 0.9, sub_step: 0.0, curvature: 0.1, second: 0.2 };
    Some(PairLag { a, b, step_angle_rad: angle_rad, angle_rad, peak })
}

proptest! {
    #[test]
    fn chain_and_graph_undo_differences_and_the_graph_bears_wrong_pairs(
        truth in proptest::collection::vec(-0.2..0.2f64, 12), wrong in proptest::collection::vec((0..11usize, 0.1..0.4f64), 0..3),
    ) {
        let mean = truth.iter().sum::<f64>() / 12.0;
        let differences: Vec<Option<f64>> = truth.windows(2).map(|w| Some(w[1] - w[0])).collect();
        let near = |found: &Angles, within: f64| found.angle_rad.iter().zip(&truth).all(|(a, b)| (a - (b - mean)).abs() < within);
        prop_assert!(near(&chain(&differences, 0.008), 1e-12));
        let mut lags: Vec<Option<PairLag>> = pairs(12, 4).iter().map(|&(a, b)| lag(a, b, truth[b] - truth[a])).collect();
        prop_assert!(near(&graph(12, &lags, 0.005).unwrap(), 1e-9));
        // Adjacent pairs only: the others hold the lasers.
        let adjacent: Vec<usize> = (0..lags.len()).filter(|i| lags[*i].is_some_and(|lag| lag.b - lag.a == 1)).collect();
        for (pair, by) in wrong {
            if let Some(lag) = &mut lags[adjacent[pair]] {
                lag.angle_rad += by;
            }
        }
        prop_assert!(near(&graph(12, &lags, 0.005).unwrap(), 2e-3));
    }
}

#[test]
fn a_laser_that_no_pair_holds_leaves_the_graph_open() {
    let lags: Vec<Option<PairLag>> =
        pairs(5, 2).iter().map(|&(a, b)| if b == 4 { None } else { lag(a, b, 0.1) }).collect();
    assert!(graph(5, &lags, 0.01).is_none());
}

#[test]
fn errors_of_a_chain_grow_from_the_middle() {
    // Monte Carlo: differences rounded to a step.
    let (mut rng, lasers, step) = (Seed(1002).stream("test"), 20, 0.008);
    let mut squares = vec![0.0; lasers];
    let mut stated = Vec::new();
    for _ in 0..4000 {
        let differences: Vec<Option<f64>> = (1..lasers).map(|_| Some(step * (rng.random::<f64>() - 0.5))).collect();
        let found = chain(&differences, step);
        squares.iter_mut().zip(&found.angle_rad).for_each(|(sum, a)| *sum += a * a / 4000.0);
        stated = found.se_rad;
    }
    for (square, se) in squares.iter().zip(&stated) {
        // A standard deviation out of 4000 draws: five of its own.
        assert!((square.sqrt() / se - 1.0).abs() < 5.0 / 8000f64.sqrt(), "{} and {se}", square.sqrt());
    }
}

#[test]
fn stretches_made_by_the_model_give_the_model() {
    let c = [0.2, 4.0, -0.3, -0.6, 0.001, 0.09];
    let mut rng = Seed(1003).stream("test");
    let mut v = 3.0;
    let stretches: Vec<Stretch> = (0..60)
        .map(|i| {
            let pedals = [rng.random::<f64>(), rng.random::<f64>(), rng.random::<f64>() - 0.5];
            let omega_rad_per_s = c[4] * v + c[5] * v * pedals[2];
            let now = Stretch { t_s: 0.5 * f64::from(i), dt_s: 0.5, v_m_per_s: v, omega_rad_per_s, pedals };
            v += 0.5 * (c[0] + c[1] * pedals[0] + c[2] * v + c[3] * v * pedals[1]);
            now
        })
        .collect();
    let found = regress(&stretches).unwrap();
    assert!(found.c.iter().zip(c).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
    // Eq. 5.5 from the first speed on.
    assert!(roll_out(&found, &stretches).iter().zip(&stretches).all(|(v, s)| (v - s.v_m_per_s).abs() < 1e-7));
    // A gap: the stretch after it does not follow, and is no acceleration.
    let broken: Vec<Stretch> = stretches.iter().enumerate().filter(|(i, _)| *i != 30).map(|(_, s)| *s).collect();
    assert!(regress(&broken).unwrap().c.iter().zip(c).all(|(a, b)| (a - b).abs() < 1e-9));
}

/// Odometry at 100 Hz of a car that follows the model, its actuators `delay_s` late.
fn delayed(delay_s: f64, brake: bool) -> (Vec<Stretch>, Vec<Command>) {
    let mut rng = Seed(1004).stream("test");
    let commands: Vec<Command> = (0..1600)
        .map(|i| {
            let held = i / 20 % 3;
            let (throttle, brake) = if held == 2 && brake {
                (0.0, 0.5 * rng.random::<f64>())
            } else {
                (0.1 + 0.2 * held as f64 + 0.2 * rng.random::<f64>(), 0.0)
            };
            Command { t_s: 0.05 * f64::from(i), action: Action::Pedals { throttle, brake, steering: 0.3 } }
        })
        .collect();
    let (c, mut v) = ([0.2, 4.0, -0.3, -0.6, 0.001, 0.09], 3.0);
    let mut speeds = Vec::new();
    for i in 0..8000 {
        let at = commands.partition_point(|command| command.t_s <= 0.01 * f64::from(i) - delay_s + 1e-9).max(1) - 1;
        let Action::Pedals { throttle, brake, .. } = commands[at].action else { unreachable!() };
        speeds.push(v);
        v += 0.01 * (c[0] + c[1] * throttle + c[2] * v + c[3] * v * brake);
    }
    let stretches = (2..158)
        .map(|k| {
            let t_s = 0.5 * f64::from(k);
            let v_m_per_s = speeds[50 * k as usize..50 * (k as usize + 1)].iter().sum::<f64>() / 50.0;
            let pedals = mean_pedals(&commands, t_s);
            Stretch { t_s, dt_s: 0.5, v_m_per_s, omega_rad_per_s: v_m_per_s * (c[4] + 0.3 * c[5]), pedals }
        })
        .collect();
    (stretches, commands)
}

/// Means over half a second: ten commands.
fn mean_pedals(commands: &[Command], t_s: f64) -> [f64; 3] {
    let first = (t_s / 0.05).round() as usize;
    let mut means = [0.0; 3];
    for command in &commands[first..first + 10] {
        let Action::Pedals { throttle, brake, steering } = command.action else { unreachable!() };
        means.iter_mut().zip([throttle, brake, steering]).for_each(|(mean, value)| *mean += value / 10.0);
    }
    means
}

#[test]
fn registered_accelerations_tell_the_delay_and_fit_better() {
    let fit = Registered { most_delay_s: 0.5, grip: 1.0 };
    for delay_s in [0.0, 0.2, 0.35] {
        let (stretches, commands) = delayed(delay_s, true);
        let (found, found_s) = fit.learn(&stretches, &commands).unwrap();
        assert!((found_s - delay_s).abs() < 0.051, "{delay_s}: {found_s}");
        let published = regress(&stretches).unwrap();
        let off = |c: &[f64; 6]| (c[1] / 4.0 - 1.0).abs() + (c[3] / -0.6 - 1.0).abs();
        assert!(off(&found.c) < off(&published.c).min(0.4), "{delay_s}: {found:?} and {published:?}");
    }
}

#[test]
fn a_brake_that_was_never_touched_gets_no_coefficient() {
    let (mut stretches, commands) = delayed(0.0, false);
    // Noise on a pedal at rest, and on the speeds.
    let mut rng = Seed(1005).stream("test");
    stretches.iter_mut().for_each(|s| s.v_m_per_s += 0.05 * (rng.random::<f64>() - 0.5));
    let commands: Vec<Command> = commands
        .iter()
        .map(|command| {
            let Action::Pedals { throttle, steering, .. } = command.action else { unreachable!() };
            Command { action: Action::Pedals { throttle, brake: 1e-4 * rng.random::<f64>(), steering }, ..*command }
        })
        .collect();
    stretches.iter_mut().for_each(|s| s.pedals = mean_pedals(&commands, s.t_s));
    let fastest = stretches.iter().map(|s| s.v_m_per_s).fold(0.0, f64::max);
    let (found, _) = Registered { most_delay_s: 0.0, grip: 1.0 }.learn(&stretches, &commands).unwrap();
    // Within what tyres hold at full brake; the free regression has no such bound.
    assert!((found.c[3] * fastest).abs() < 9.81, "{found:?}");
    assert!((regress(&stretches).unwrap().c[3] * fastest).abs() > 9.81);
    assert!((found.c[1] / 4.0 - 1.0).abs() < 0.1, "{found:?}");
}

#[test]
fn a_free_run_changes_with_its_coefficients_as_its_gradient_says() {
    let (stretches, commands) = delayed(0.2, true);
    let run = |c: [f64; 6]| free_run(&Coefficients { c, se: None }, &stretches, &commands, 0.2, true);
    let c = [0.3, 3.5, -0.25, -0.5, 0.001, 0.09];
    let middle = run(c);
    for k in 0..4 {
        let step = 1e-5;
        let [mut more, mut less] = [c; 2];
        (more[k], less[k]) = (c[k] + step, c[k] - step);
        for ((more, less), now) in run(more).iter().zip(run(less)).zip(&middle) {
            let difference = (more.v_m_per_s - less.v_m_per_s) / (2.0 * step);
            assert!((difference - now.gradient[k]).abs() < 1e-5 * (1.0 + difference.abs()), "{k}: {difference}");
        }
    }
}

/// A car whose pedals do what the model has no term for: the regression explains each acceleration best, the free run the speed.
#[test]
fn a_free_run_is_nearer_where_the_model_is_wrong() {
    let from = Registered { most_delay_s: 0.5, grip: 1.0 };
    let speed_rms = |(found, delay_s): (Coefficients, f64), stretches: &[Stretch], commands: &[Command]| {
        let runs = free_run(&found, stretches, commands, delay_s, false);
        let squares = runs.iter().zip(stretches).map(|(run, now)| (run.v_m_per_s - now.v_m_per_s).powi(2));
        (squares.sum::<f64>() / stretches.len() as f64).sqrt()
    };
    let (stretches, commands) = delayed(0.2, true);
    let (found, delay_s) = FreeRun { from }.learn(&stretches, &commands).unwrap();
    assert!((delay_s - 0.2).abs() < 0.051, "{delay_s}");
    assert!((found.c[1] / 4.0 - 1.0).abs() < 0.05 && (found.c[3] / -0.6 - 1.0).abs() < 0.1, "{found:?}");
    // Drag that grows with the square of the speed.
    let mut v = stretches[0].v_m_per_s;
    let dragged: Vec<Stretch> = stretches
        .iter()
        .map(|now| {
            let before = v;
            v += 0.5 * (0.2 + 4.0 * now.pedals[0] - 0.15 * v * v - 0.6 * v * now.pedals[1]);
            Stretch { v_m_per_s: 0.5 * (before + v), ..*now }
        })
        .collect();
    let free = speed_rms(FreeRun { from }.learn(&dragged, &commands).unwrap(), &dragged, &commands);
    let stepwise = speed_rms(from.learn(&dragged, &commands).unwrap(), &dragged, &commands);
    assert!(free < stepwise, "{free} and {stepwise}");
}
