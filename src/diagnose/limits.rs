//! What a log cannot show, whatever parts it from the nominal world.

use asami_dataset::{Action, Log};

/// Nothing can be said of the log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShowsNothing {
    /// No command.
    #[error("the log has no commands: what the nominal world would have done meanwhile cannot be played")]
    NoCommands,
    /// No observation.
    #[error("the log has no sightings: nothing in it was observed that could part it from the nominal world")]
    NoSightings,
    /// A car without a laser scanner.
    #[error("the log has no laser firings: how a car moved, and how its scanner sees, is read off nothing else")]
    NoFirings,
    /// A drive that is too short.
    #[error("the firings last {found_s:.1} s; less than {least_s} s show nothing")]
    TooShortDrive {
        /// How long they last.
        found_s: f64,
        /// How long they must.
        least_s: f64,
    },
    /// Too short.
    #[error(
        "the log lasts {found_s:.1} s with {sightings} sightings; less than {least_s} s and {least} sightings show nothing"
    )]
    TooShort {
        /// Its length.
        found_s: f64,
        /// Its sightings.
        sightings: usize,
        /// Least length.
        least_s: f64,
        /// Least number of sightings.
        least: usize,
    },
    /// It jumps ahead by more than any log lasts.
    #[error(
        "the log has nothing between {from_s:.1} s and {to_s:.1} s: more than {most_s} s is no gap but another log"
    )]
    Jump {
        /// The last time before.
        from_s: f64,
        /// The first time after.
        to_s: f64,
        /// The longest gap.
        most_s: f64,
    },
}

/// Less than this is less than the filter takes to settle and to be scored at all.
const LEAST_S: f64 = 10.0;
const LEAST_SIGHTINGS: usize = 20;
/// Less of a drive than this is hardly more than what it takes to be followed.
const LEAST_DRIVE_S: f64 = 20.0;
/// A gap of minutes is one; one of hours is a clock that was set.
const MOST_GAP_S: f64 = 3600.0;
/// Without a sighting for so long, the pose is hardly known afterwards.
const GAP_S: f64 = 10.0;

/// Notes on what the log cannot show.
///
/// # Errors
/// [`ShowsNothing`] where that is everything.
pub fn limits(log: &Log) -> Result<Vec<String>, ShowsNothing> {
    if log.commands.is_empty() {
        return Err(ShowsNothing::NoCommands);
    }
    if log.known.robot == "car" {
        return of_drive(log);
    }
    if log.sightings.is_empty() {
        return Err(ShowsNothing::NoSightings);
    }
    let (first_s, last_s) = log.span_s().unwrap_or((0.0, 0.0));
    let (found_s, sightings) = (last_s - first_s, log.sightings.len());
    if found_s < LEAST_S || sightings < LEAST_SIGHTINGS {
        return Err(ShowsNothing::TooShort { found_s, sightings, least_s: LEAST_S, least: LEAST_SIGHTINGS });
    }
    let times_s: Vec<f64> = log.sightings.iter().map(|seen| seen.t_s).collect();
    let gaps = times_s.windows(2).filter(|pair| pair[1] - pair[0] > GAP_S);
    let gaps: Vec<[f64; 2]> = gaps.map(|pair| [pair[0], pair[1]]).collect();
    if let Some([from_s, to_s]) = gaps.iter().copied().find(|[from_s, to_s]| to_s - from_s > MOST_GAP_S) {
        return Err(ShowsNothing::Jump { from_s, to_s, most_s: MOST_GAP_S });
    }
    let mut notes = Vec::new();
    if let Some(longest) = gaps.iter().copied().reduce(|a, b| if b[1] - b[0] > a[1] - a[0] { b } else { a }) {
        let [from_s, to_s] = longest;
        notes.push(format!(
            "nothing is sighted between {from_s:.1} s and {to_s:.1} s ({} such gaps): what happens there does not show",
            gaps.len()
        ));
    }
    notes.extend(commanded_alike(log).then(|| ALIKE.to_owned()));
    if log.frames.is_none() {
        notes.push("the log has no frames.csv: sightings that were missed cannot be seen".to_owned());
    }
    Ok(notes)
}

const ALIKE: &str = "the command never changes: delays, lags and all that shows where commands change cannot be seen";

/// The same of a car with a laser scanner.
fn of_drive(log: &Log) -> Result<Vec<String>, ShowsNothing> {
    let firings = log.firings.as_deref().filter(|firings| !firings.is_empty()).ok_or(ShowsNothing::NoFirings)?;
    let found_s = firings.t_s.last().zip(firings.t_s.first()).map_or(0.0, |(last_s, first_s)| last_s - first_s);
    if found_s.is_nan() || found_s < LEAST_DRIVE_S {
        return Err(ShowsNothing::TooShortDrive { found_s, least_s: LEAST_DRIVE_S });
    }
    let jump = firings.t_s.windows(2).find(|pair| pair[1] - pair[0] > MOST_GAP_S);
    if let Some(jump) = jump {
        return Err(ShowsNothing::Jump { from_s: jump[0], to_s: jump[1], most_s: MOST_GAP_S });
    }
    Ok(commanded_alike(log).then(|| ALIKE.to_owned()).into_iter().collect())
}

/// Whether all commands are the same.
fn commanded_alike(log: &Log) -> bool {
    let values = |action: &Action| match *action {
        Action::Legs { ax_m_per_s, ay_m_per_s, atheta_rad_per_s, .. } => [ax_m_per_s, ay_m_per_s, atheta_rad_per_s],
        Action::Wheels { v_m_per_s, omega_rad_per_s, .. } => [v_m_per_s, 0.0, omega_rad_per_s],
        Action::Pedals { throttle, brake, steering } => [throttle, brake, steering],
    };
    log.commands.windows(2).all(|pair| values(&pair[0].action) == values(&pair[1].action))
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Command, Sighting, Size};

    use super::*;

    fn log(until_s: f64, gap: Option<[f64; 2]>, speeds: [f64; 2]) -> Log {
        let outside = |t_s: &f64| gap.is_none_or(|[from_s, to_s]| *t_s <= from_s || *t_s >= to_s);
        let times: Vec<f64> = (0..).map(|i| f64::from(i) * 0.5).take_while(|t_s| *t_s <= until_s).collect();
        let seen = times.iter().copied().filter(outside);
        let sighting = |t_s| Sighting { t_s, landmark: 0, size: Size::HeightPx(20.0), bearing_rad: 0.0 };
        let command = |(i, t_s): (usize, &f64)| Command {
            t_s: *t_s,
            action: Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: speeds[i % 2], atheta_rad_per_s: 0.0 },
        };
        let commands: Vec<Command> = times.iter().enumerate().map(command).collect();
        Log { commands: commands.into(), sightings: seen.map(sighting).collect::<Vec<_>>().into(), ..Log::default() }
    }

    #[test]
    fn logs_that_show_nothing_are_refused_and_say_why() {
        let whole = log(60.0, None, [0.1, 0.2]);
        assert_eq!(limits(&Log { commands: Vec::new().into(), ..whole.clone() }), Err(ShowsNothing::NoCommands));
        assert_eq!(limits(&Log { sightings: Vec::new().into(), ..whole }), Err(ShowsNothing::NoSightings));
        assert!(matches!(limits(&log(0.0, None, [0.1; 2])), Err(ShowsNothing::TooShort { sightings: 1, .. })));
        let jump = log(9000.0, Some([30.0, 8000.0]), [0.1, 0.2]);
        assert!(matches!(limits(&jump), Err(ShowsNothing::Jump { from_s: 30.0, to_s: 8000.0, .. })));
    }

    #[test]
    fn a_car_without_scans_is_refused() {
        let known = asami_dataset::Known { robot: "car".to_owned(), ..Default::default() };
        let drive = Log { known: known.into(), ..log(60.0, None, [0.1, 0.2]) };
        assert_eq!(limits(&drive), Err(ShowsNothing::NoFirings));
        let firings = |until_s: f64| asami_dataset::Firings { t_s: vec![0.0, until_s], ..Default::default() };
        let with = |until_s: f64| Log { firings: Some(firings(until_s).into()), ..drive.clone() };
        assert!(matches!(limits(&with(12.0)), Err(ShowsNothing::TooShortDrive { .. })));
        assert!(matches!(limits(&with(9000.0)), Err(ShowsNothing::Jump { .. })));
        assert_eq!(limits(&with(60.0)), Ok(Vec::new()));
    }

    #[test]
    fn what_does_not_show_is_noted() {
        let notes = |log: &Log| limits(log).unwrap().join("\n");
        assert!(notes(&log(60.0, None, [0.1; 2])).contains("the command never changes"));
        let gap = notes(&log(400.0, Some([30.0, 200.0]), [0.1, 0.2]));
        assert!(gap.contains("between 30.0 s and 200.0 s (1 such gaps)") && !gap.contains("never changes"), "{gap}");
    }
}
