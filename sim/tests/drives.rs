//! The policies of chapters 3 and 4: which actions there are, how evenly they are executed, and that they stay
//! on the field.

use std::f64::consts::PI;

use asami_dataset::{Action, Known, Seed, Sighting, Size, TruePose};
use asami_math::elementary::sin_cos;
use asami_sim::drives::explore::{Explore, Exploring};
use asami_sim::drives::pace::{Pace, Pacing};
use asami_sim::drives::suite::{Suite, normalised};
use asami_sim::world::{Drive, Record, Seen, World, run};

fn legs(action: &Action) -> (u16, [f64; 3]) {
    let Action::Legs { id: Some(id), ax_m_per_s, ay_m_per_s, atheta_rad_per_s } = *action else {
        panic!("no discrete action of a legged robot: {action:?}")
    };
    (id, [ax_m_per_s, ay_m_per_s, atheta_rad_per_s])
}

#[test]
fn the_suite_is_that_of_equations_4_29_to_4_31() {
    let suite = Suite { max_right_m_per_s: 2.0, max_forward_m_per_s: 3.0, max_turn_rad_per_s: 5.0 };
    let actions = suite.actions();
    assert_eq!((actions.len(), normalised().count()), (40, 40));
    let mut pairs = Vec::new();
    for (i, action) in actions.iter().enumerate() {
        let (id, [ax, ay, atheta]) = legs(action);
        let (right, forward, turn) = (ax / 2.0, ay / 3.0, atheta / 5.0);
        assert_eq!(usize::from(id), i);
        assert!((right * right + forward * forward + turn * turn - 1.0).abs() < 1e-14);
        // psi and omega as the ids have them: counter-clockwise from right, and increasing.
        let psi = (forward.atan2(right) / (PI / 4.0)).rem_euclid(8.0);
        assert!((psi - (i % 8) as f64).abs() < 1e-12, "{i}: {psi}");
        pairs.push((i / 8, (6.0 * turn).round() as i32));
        assert!((6.0 * turn - (6.0 * turn).round()).abs() < 1e-14, "{turn}");
    }
    let turns: Vec<i32> = (0..40).map(|i| [-3, -1, 0, 1, 3][i / 8]).collect();
    assert_eq!(pairs, (0..40).map(|i| i / 8).zip(turns).collect::<Vec<_>>());
}

#[test]
fn the_strides_are_those_of_section_4_4_3() {
    let strides = Suite { max_forward_m_per_s: 0.3, ..Suite::default() }.strides();
    assert_eq!(strides.len(), 21);
    for (i, stride) in strides.iter().enumerate() {
        let (id, [ax, ay, atheta]) = legs(stride);
        assert_eq!((usize::from(id), ax, atheta), (i, 0.0, 0.0));
        assert!((ay - 0.03 * (i as f64 - 10.0)).abs() < 1e-15);
    }
}

#[test]
fn pacing_among_strides_keeps_its_phases_and_uses_every_stride() {
    let strides = Suite::default().strides();
    let mut pace = Pace::among(strides, Pacing::default(), Seed(1000).stream("drive"));
    let mut seen = Seen::default();
    let (mut executed, mut near) = ([0_i32; 21], false);
    for tick in 0..3000 {
        let t_s = f64::from(tick) * 3.0;
        let (id, [_, ay, _]) = legs(&pace.act(t_s, &seen));
        assert!(if near { ay <= 0.0 } else { ay >= 0.0 }, "{ay} in the wrong phase");
        executed[usize::from(id)] += 1;
        near = tick % 20 >= 10;
        let size = Size::HeightPx(if near { 34.0 } else { 11.0 });
        seen.sightings.push(Sighting { t_s, landmark: 0, size, bearing_rad: 0.0 });
    }
    // 1500 draws among 11 in either phase: 136, with a standard deviation of 11; standing is in both.
    for (id, count) in executed.into_iter().enumerate() {
        let expected = if id == 10 { 273 } else { 136 };
        assert!((count - expected).abs() < 65, "{id}: {count} times");
    }
}

/// Speeds of `pace` as it turns round after every `walk` commands.
fn paced_speeds(mut pace: Pace, walk: i32, commands: i32) -> Vec<f64> {
    let mut seen = Seen::default();
    let mut speeds = Vec::new();
    for i in 0..commands {
        let t_s = f64::from(i) * 3.0;
        let Action::Legs { ay_m_per_s, .. } = pace.act(t_s, &seen) else { panic!("no stride") };
        speeds.push(ay_m_per_s);
        let near = (i + 1) / walk % 2 == 1;
        let size = Size::HeightPx(if near { 34.0 } else { 11.0 });
        seen.sightings.push(Sighting { t_s, landmark: 0, size, bearing_rad: 0.0 });
    }
    speeds
}

#[test]
fn few_commands_of_strata_make_an_even_mix_and_all_together_are_uniform() {
    let of = |strata: u32| {
        let pacing = Pacing { strata, ..Pacing::default() };
        // Walks of 7: no round of 3 ends where a walk does.
        paced_speeds(Pace::new(pacing, Seed(1000).stream("drive")), 7, 8400)
    };
    let [apart, even] = [of(1), of(3)];
    for sign in [1.0, -1.0] {
        let one_way = |speeds: &[f64]| -> Vec<f64> {
            speeds.iter().map(|ay| ay * sign / 0.3).filter(|share| *share > 0.0).collect()
        };
        let [apart, even] = [one_way(&apart), one_way(&even)];
        assert_eq!((apart.len(), even.len()), (4200, 4200), "a command the wrong way");
        let parts = |round: &[f64]| -> Vec<u32> {
            let mut parts: Vec<u32> = round.iter().map(|share| (3.0 * share) as u32).collect();
            parts.sort_unstable();
            parts
        };
        assert!(even.chunks(3).all(|round| parts(round) == [0, 1, 2]));
        assert!(!apart.chunks(3).all(|round| parts(round) == [0, 1, 2]));
        // All orders occur alike: the first of 1400 rounds is in each part 467 times, give or take four of 18.
        for part in 0..3 {
            let first = even.chunks(3).filter(|round| (3.0 * round[0]) as u32 == part).count() as i32;
            assert!((first - 467).abs() < 72, "part {part} first {first} times");
        }
        for speeds in [apart, even] {
            // Tenths of the range: 420 of 4200, give or take four standard deviations of less than 20.
            for tenth in 0..10 {
                let count = speeds.iter().filter(|share| (10.0 * **share) as i32 == tenth).count() as i32;
                assert!((count - 420).abs() < 80, "tenth {tenth}: {count}");
            }
        }
    }
}

/// Does exactly what is attempted, times a factor, and sees nothing.
struct Obedient {
    pose: TruePose,
    ticks: u32,
    factor: f64,
}

const TICK_S: f64 = 0.05;

impl Obedient {
    fn new(factor: f64) -> Self {
        Self { pose: TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None }, ticks: 0, factor }
    }
}

impl World for Obedient {
    fn known(&self) -> Known {
        Known::default()
    }

    fn t_s(&self) -> f64 {
        f64::from(self.ticks) * TICK_S
    }

    fn pose(&self) -> TruePose {
        self.pose
    }

    fn tick(&mut self, action: Action, record: &mut Record) {
        let (_, [ax, ay, atheta]) = legs(&action);
        let step = TICK_S * self.factor;
        let (sin, cos) = sin_cos(self.pose.theta_rad + 0.5 * atheta * step);
        self.pose.x_m += (ax * cos - ay * sin) * step;
        self.pose.y_m += (ax * sin + ay * cos) * step;
        self.pose.theta_rad += atheta * step;
        self.ticks += 1;
        self.pose.t_s = self.t_s();
        record.track.push(self.pose);
    }
}

/// Fifteen minutes of it: how often each action was executed, and the share of time off the field with the
/// farthest point.
fn explored(factor: f64, seed: u64) -> ([u32; 40], f64, f64) {
    let mut drive = Explore::new(Exploring::default(), Suite::default().actions(), Seed(seed).stream("drive"));
    let (mut world, mut executed) = (Obedient::new(factor), [0; 40]);
    let dataset = run(&mut world, &mut drive, 900.0);
    // An action that follows itself makes one row: counted by its length.
    let ends = dataset.log.commands.iter().skip(1).map(|row| row.t_s).chain([900.0]);
    for (command, end_s) in dataset.log.commands.iter().zip(ends) {
        let times = (end_s - command.t_s) / 5.0;
        assert!((times - times.round()).abs() < 1e-9, "held for {} s", end_s - command.t_s);
        executed[usize::from(legs(&command.action).0)] += times.round() as u32;
    }
    let track = &dataset.truth.track;
    let beyond = |pose: &TruePose| (pose.x_m.abs() - 1.8).max(pose.y_m.abs() - 2.7);
    let off = track.iter().filter(|pose| beyond(pose) > 0.0).count() as f64 / track.len() as f64;
    (executed, off, track.iter().map(beyond).fold(f64::NEG_INFINITY, f64::max))
}

#[test]
fn every_action_is_executed_roughly_four_times_and_the_field_is_kept() {
    for seed in 1000..1020 {
        let (executed, off, farthest_m) = explored(1.0, seed);
        assert_eq!(executed.iter().sum::<u32>(), 180, "{seed}");
        assert!(executed.iter().all(|times| (2..=7).contains(times)), "{seed}: {executed:?}");
        assert!(off == 0.0, "{seed}: {farthest_m} m off the field");
    }
}

/// The localisation makes up for wrong predictions, one action at a time: 2 m attempted are 0.5 m more or less.
#[test]
fn a_robot_that_does_something_else_than_attempted_strays_by_its_error_only() {
    for seed in 1000..1010 {
        for factor in [0.75, 1.25] {
            let (executed, off, farthest_m) = explored(factor, seed);
            assert!(executed.iter().all(|times| (2..=7).contains(times)), "{seed}: {executed:?}");
            assert!(off < 0.05 && farthest_m < 0.6, "{seed}, {factor}: {off} of the time, {farthest_m} m");
        }
    }
}
