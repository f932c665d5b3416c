use super::*;

fn forward(t_s: f64, ay_m_per_s: f64) -> Command {
    Command { t_s, action: Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s, atheta_rad_per_s: 0.0 } }
}

/// What a base on two wheels loses in turns is a column's, what it gains in slight ones another's, and what those lack of a whole step a third's;
/// hats add up beside them.
#[test]
fn a_speed_in_a_turn_has_columns_of_its_own() {
    let wheels = |v_m_per_s: f64, omega_rad_per_s: f64| Command {
        t_s: 0.0,
        action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s },
    };
    let columns = Columns::new([wheels(0.2, 0.0), wheels(0.0, 0.5)].iter(), 3);
    let in_turns = columns.in_turns().unwrap();
    let of = |k: usize, v: f64, omega: f64| {
        let mut row = vec![0.0; columns.len()];
        columns.fill(&[wheels(v, omega)], 3.0, 3.05, &[], &mut row);
        row[in_turns.start + k]
    };
    let (lost, slight) = (|v, omega| of(0, v, omega), |v, omega| of(1, v, omega));
    assert!((lost(0.1, 0.25) - 0.125).abs() < 1e-12 && (lost(0.1, -0.25) - 0.125).abs() < 1e-12);
    assert_eq!([lost(0.2, 0.0), lost(0.0, 0.5)], [0.0; 2]);
    assert!((slight(0.1, 0.002) - 0.5).abs() < 1e-12 && (slight(0.1, -0.09) - 0.5).abs() < 1e-12);
    assert_eq!([slight(0.2, 0.0), slight(0.1, 0.2), slight(0.0, 0.05)], [0.0; 3]);
    let lacks = |v, omega| of(2, v, omega);
    assert!((lacks(0.1, 0.01) - 0.0228 / 0.5).abs() < 1e-12 && (lacks(0.1, 0.002) + 0.0348 / 0.5).abs() < 1e-12);
    assert_eq!([lacks(0.1, 0.0), lacks(0.1, 0.05), lacks(0.1, -0.4), lacks(0.0, 0.01)], [0.0; 4]);
    assert_eq!(Columns::new([forward(0.0, 0.3)].iter(), 1).in_turns(), None);
    assert_eq!(columns.bends().last().unwrap(), &vec![(in_turns.end - 1, 1.0)]);
}

/// Where a base on wheels stood, its speed now has columns of its own, by how long ago that was; where it did not it has none.
#[test]
fn a_start_has_columns_by_when_it_stood() {
    let wheels = |t_s: f64, v_m_per_s: f64, omega_rad_per_s: f64| Command {
        t_s,
        action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s },
    };
    let commands = [wheels(0.0, 0.2, 0.0), wheels(2.0, 0.0, 0.0), wheels(3.0, 0.1, -0.5), wheels(9.0, 0.2, 0.0)];
    let columns = Columns::new(commands.iter(), 3);
    let of = |t_s: f64, age: usize| {
        let mut row = vec![0.0; columns.len()];
        columns.fill(&commands, t_s, t_s + 1e-6, &[], &mut row);
        columns.started(age).map(|(axis, column)| (axis, row[column]))
    };
    // 0.12 s after the start it stood 0.15 s ago and more; from 0.1 to 0.15 s ago for three fifths of the time.
    for (age, share) in [(0, 0.0), (1, 0.0), (2, 0.6), (3, 1.0), (6, 1.0)] {
        let found = of(3.12, age);
        assert!(found.is_some_and(|(axis, v)| axis == 1 && (v - 0.5 * share).abs() < 1e-4), "{found:?} {share}");
    }
    assert!((0..8).all(|age| of(6.0, age) == Some((1, 0.0))), "it stood long ago");
    assert!((0..8).all(|age| of(2.5, age) == Some((1, 0.0))), "it stands");
    assert_eq!(Columns::new([forward(0.0, 0.3)].iter(), 1).started(0), None);
}

#[test]
fn a_steady_command_leaves_nothing_lingering_and_hats_add_up_to_one() {
    let commands = [forward(0.0, 0.3), forward(5.0, -0.15)];
    let columns = Columns::new(commands.iter(), 1);
    let mut row = vec![0.0; columns.len()];
    let now = columns.fill(&commands, 3.0, 3.05, &[], &mut row);
    assert!((now[1] - 1.0).abs() < 1e-12);
    assert!(row[columns.range(Group::Lingering)].iter().all(|it| it.abs() < 1e-12));
    assert!((row[columns.range(Group::Curve)].iter().sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn bends_of_a_fine_curve_are_the_hats_of_a_coarse_one() {
    let coarse = Columns::new([forward(0.0, 0.3)].iter(), 1);
    for fine in coarse.finer() {
        for speed_m_per_s in [-0.3, -0.231, -0.05, 0.0, 0.0125, 0.16, 0.3] {
            let commands = [forward(0.0, speed_m_per_s)];
            let [hats, knots] = [&coarse, &fine].map(|columns| {
                let mut row = vec![0.0; columns.len()];
                columns.fill(&commands, 3.0, 3.05, &[], &mut row);
                row
            });
            for (hat, bend) in hats[coarse.range(Group::Curve)].iter().zip(fine.bends()) {
                let made = bend.iter().fold(0.0, |sum, (column, share)| sum + share * knots[*column]);
                assert!((made - hat).abs() < 1e-12, "{speed_m_per_s}: {made} {hat}");
            }
        }
    }
}

#[test]
fn what_lingers_of_a_command_moves_through_the_ages() {
    let commands = [forward(0.0, 0.3), forward(5.0, -0.15)];
    let columns = Columns::new(commands.iter(), 1);
    let lingering = |from_s: f64| {
        let mut row = vec![0.0; columns.len()];
        columns.fill(&commands, from_s, from_s + 0.05, &[], &mut row);
        row[columns.range(Group::Lingering)].chunks(3).map(|it| it[1]).collect::<Vec<_>>()
    };
    // 0.125 s after the change, all of what is older than 0.15 s is still the command before: 1 against -0.5.
    let after = lingering(5.1);
    assert!((after[3] - 1.5).abs() < 1e-9 && (after[7] - 1.5).abs() < 1e-9, "{after:?}");
    assert!(after[0].abs() < 1e-9 && (after[2] - 0.75).abs() < 1e-9, "{after:?}");
    assert!(lingering(6.1).iter().all(|it| it.abs() < 1e-9));
}

#[test]
fn a_held_bearing_is_averaged_over_strides_and_shared_between_speeds() {
    let columns = Columns::new([forward(0.0, 0.3), forward(5.0, 0.0825)].iter(), 1);
    // Seen from frame to frame at 0.1 rad, swaying; and long ago at 0.3 rad.
    let swaying = |n: i32| (3.0 + 0.05 * f64::from(n), if n % 2 == 0 { 0.05 } else { 0.15 });
    let seen: Vec<(f64, f64)> = (0..60).map(swaying).collect();
    let held = |commands: &[Command], seen: &[(f64, f64)]| {
        let mut row = vec![0.0; columns.len()];
        columns.fill(commands, 5.75, 5.8, seen, &mut row);
        row[columns.range(Group::Held)].to_vec()
    };
    let fast = held(&[forward(0.0, 0.3)], &seen);
    let slow = held(&[forward(0.0, 0.0825)], &seen);
    for (fast, slow) in fast.chunks(4).zip(slow.chunks(4)) {
        // All at the last knot; half each at those of 0.15 and 0.4.
        assert!((fast[3] - 0.1).abs() < 0.01 && fast[..3].iter().all(|it| it.abs() < 1e-12), "{fast:?}");
        assert!((slow[1] - 0.05).abs() < 0.005 && (slow[2] - slow[1]).abs() < 1e-9, "{slow:?}");
    }
    assert!(held(&[forward(0.0, 0.0)], &seen).iter().all(|it| *it == 0.0), "a robot that stands holds nothing");
    assert!(held(&[forward(0.0, 0.3)], &[(1.0, 0.3)]).iter().all(|it| *it == 0.0), "what was long ago is forgotten");
}
