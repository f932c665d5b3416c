//! What a real car's own odometry cannot show.

use asami_dataset::Log;

use super::{ALIKE, Limited, MOST_S, ShowsNothing, commanded_alike};

/// A quarter of it, in pieces of 20 s, is set aside.
const LEAST_S: f64 = 80.0;

/// What of a car's log is looked at that tells its own motion, and what it cannot show.
///
/// # Errors
/// [`ShowsNothing`] where that is everything.
pub(super) fn of_ride(log: &Log) -> Result<Limited, ShowsNothing> {
    let (Some(told), Some(told_last)) = (log.commands.first(), log.commands.last()) else {
        return Err(ShowsNothing::NoCommands);
    };
    let (Some(read), Some(read_last)) = (log.odometry.first(), log.odometry.last()) else {
        return Err(ShowsNothing::NoMotion);
    };
    let (from_s, to_s) = (told.t_s.max(read.t_s), told_last.t_s.min(read_last.t_s));
    let part = log.window(from_s..(to_s + 1e-9).min(from_s + MOST_S));
    let found_s = if part.commands.is_empty() || part.odometry.is_empty() { 0.0 } else { (to_s - from_s).max(0.0) };
    if found_s < LEAST_S {
        return Err(ShowsNothing::TooShortRide { found_s, least_s: LEAST_S });
    }
    let long = found_s > MOST_S;
    let mut notes: Vec<String> =
        long.then(|| format!("only the first {MOST_S} s of {found_s:.1} s are looked at")).into_iter().collect();
    notes.extend(commanded_alike(&part).then(|| ALIKE.to_owned()));
    Ok(Limited { log: part, notes })
}

#[cfg(test)]
mod tests {
    use asami_dataset::log::Odometry;
    use asami_dataset::{Action, Command, Known};

    use super::super::of_real;
    use super::*;

    /// A command a second and a reading every tenth of one, each within some time.
    fn ride(told_s: [f64; 2], read_s: [f64; 2]) -> Log {
        let rows = |[from_s, to_s]: [f64; 2], step_s: f64| {
            (0..).map(move |i| from_s + f64::from(i) * step_s).take_while(move |t_s| *t_s <= to_s)
        };
        let command = |t_s: f64| Command {
            t_s,
            action: Action::Pedals { throttle: 0.1 + 0.1 * (t_s % 2.0), brake: 0.0, steering: 0.0 },
        };
        let known = Known { robot: "car".to_owned(), ..Known::default() };
        Log {
            known: known.into(),
            commands: rows(told_s, 1.0).map(command).collect::<Vec<_>>().into(),
            odometry: rows(read_s, 0.1)
                .map(|t_s| Odometry { t_s, v_m_per_s: 5.0, omega_rad_per_s: 0.0 })
                .collect::<Vec<_>>()
                .into(),
            ..Log::default()
        }
    }

    #[test]
    fn a_ride_that_shows_nothing_is_refused_and_says_why() {
        let whole = ride([0.0, 200.0], [0.0, 200.0]);
        assert_eq!(of_real(&whole).unwrap().notes, Vec::<String>::new());
        assert_eq!(of_real(&Log { commands: Vec::new().into(), ..whole.clone() }), Err(ShowsNothing::NoCommands));
        assert_eq!(of_real(&Log { odometry: Vec::new().into(), ..whole }), Err(ShowsNothing::NoMotion));
        let short = |told_s, read_s| match of_real(&ride(told_s, read_s)) {
            Err(ShowsNothing::TooShortRide { found_s, .. }) => found_s,
            other => panic!("{other:?}"),
        };
        assert!((short([0.0, 60.0], [0.0, 200.0]) - 60.0).abs() < 1e-6);
        assert_eq!(short([0.0, 100.0], [1e6, 1e6 + 200.0]), 0.0);
    }

    #[test]
    fn a_clock_that_jumps_is_not_played_for_ever() {
        let mut jumps = ride([0.0, 200.0], [0.0, 200.0]);
        let later = ride([1e9, 1e9 + 10.0], [1e9, 1e9 + 10.0]);
        jumps.commands = jumps.commands.iter().chain(later.commands.iter()).copied().collect::<Vec<_>>().into();
        jumps.odometry = jumps.odometry.iter().chain(later.odometry.iter()).copied().collect::<Vec<_>>().into();
        let limited = of_real(&jumps).unwrap();
        assert!(limited.log.span_s().is_some_and(|(from_s, to_s)| to_s - from_s <= MOST_S), "{:?}", limited.notes);
        assert_eq!(limited.notes.len(), 1);
    }
}
