//! What a log cannot show, whatever parts it from the nominal world.

mod ride;

use asami_dataset::{Action, Command, CommandsAre, Frame, Log, Sighting};

/// Nothing can be said of the log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShowsNothing {
    /// No command.
    #[error("the log has no commands: what the nominal world would have done meanwhile cannot be played")]
    NoCommands,
    /// No command, but firings.
    #[error(
        "the log has no commands, so that what the nominal world would have done meanwhile cannot be played; with --real its laser \
         scanner is diagnosed by its scans alone"
    )]
    OnlyScans,
    /// No observation.
    #[error("the log has no sightings: nothing in it was observed that could part it from the nominal world")]
    NoSightings,
    /// A car without a laser scanner.
    #[error("the log has no laser firings: how a car moved, and how its scanner sees, is read off nothing else")]
    NoFirings,
    /// A car that tells nothing of its motion.
    #[error("the log has neither laser firings nor odometry: how the car moved is read off nothing else")]
    NoMotion,
    /// A log that is too short to set a part of it aside.
    #[error(
        "commands and odometry last {found_s:.1} s together; of less than {least_s} s no quarter, in pieces of 20 s, can be set aside"
    )]
    TooShortRide {
        /// How long they last.
        found_s: f64,
        /// How long they must.
        least_s: f64,
    },
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
        "the log lasts {found_s:.1} s, with {sightings} sightings once the filter has settled on its first ones; less \
         than {least_s} s and {least} sightings show nothing"
    )]
    TooShort {
        /// Its length.
        found_s: f64,
        /// Its sightings less those of the first seconds.
        sightings: usize,
        /// Least length.
        least_s: f64,
        /// Least number of sightings.
        least: usize,
    },
    /// Too short, as far as it is looked at.
    #[error(
        "the log has {rows} rows of one kind, of which the first {most} are looked at, since each of some thousand hypotheses filters \
         them all: they last {found_s:.1} s, and less than {least_s} s shows nothing; leave rows out"
    )]
    TooDense {
        /// Rows of the file with the most of them.
        rows: usize,
        /// As many are looked at.
        most: usize,
        /// How long they last.
        found_s: f64,
        /// Least length.
        least_s: f64,
    },
    /// A drive that jumps ahead by more than any lasts.
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

impl ShowsNothing {
    /// The same, said of the whole log where only its density made it too short.
    fn of(self, log: &Log) -> Self {
        let frames = log.frames.as_ref().map_or(0, |frames| frames.len());
        let rows = log.commands.len().max(log.sightings.len()).max(frames);
        let lasts_s = log.span_s().map_or(0.0, |(first_s, last_s)| last_s - first_s);
        match self {
            Self::TooShort { found_s, least_s, .. } if rows > MOST_ROWS && found_s < least_s && lasts_s >= least_s => {
                Self::TooDense { rows, most: MOST_ROWS, found_s, least_s }
            }
            _ => self,
        }
    }
}

/// Less than this is less than the filter takes to settle and to be scored at all.
const LEAST_S: f64 = 10.0;
const LEAST_SIGHTINGS: usize = 20;
/// Less of a drive than this does not show what is the street's, and what the scanner's.
const LEAST_SCANS_S: f64 = 3.0;
/// Less of a drive than this is hardly more than what it takes to be followed.
const LEAST_DRIVE_S: f64 = 20.0;
/// In a drive a gap of minutes is one; one of hours is a clock that was set.
const MOST_GAP_OF_DRIVE_S: f64 = 3600.0;
/// Sightings of so long after the first are spent on where the robot is.
const SETTLING_S: f64 = 5.0;
/// More is not looked at: probabilities are calibrated on logs of up to 900 s, and each of some thousand hypotheses filters
/// all of it.
const MOST_S: f64 = 1800.0;
const MOST_ROWS: usize = 100_000;
/// Where nothing is sighted for longer, the pose is lost: what follows is another log.
const MOST_GAP_S: f64 = 30.0;
/// On wheels it is lost later.
const MOST_GAP_ON_WHEELS_S: f64 = 120.0;
/// Without a sighting for so long, the pose is hardly known afterwards.
const GAP_S: f64 = 10.0;

/// A log as far as it is diagnosed.
#[derive(Clone, Debug, PartialEq)]
pub struct Limited {
    /// The log, or as much of it as is looked at, on a clock that began with it.
    pub log: Log,
    /// What it cannot show, in sentences.
    pub notes: Vec<String>,
}

/// What of a log is looked at, and what it cannot show.
///
/// # Errors
/// [`ShowsNothing`] where that is everything.
pub fn limits(log: &Log) -> Result<Limited, ShowsNothing> {
    if log.commands.is_empty() {
        return Err(if log.firings.is_some() { ShowsNothing::OnlyScans } else { ShowsNothing::NoCommands });
    }
    if log.known.robot == "car" {
        return Ok(Limited { log: log.clone(), notes: of_drive(log)? });
    }
    if log.sightings.is_empty() {
        return Err(ShowsNothing::NoSightings);
    }
    let (began_s, ended_s) = log.span_s().unwrap_or((0.0, 0.0));
    let (part, to_s) = looked_at(log, began_s, ended_s);
    let from_s = part.span_s().map_or(began_s, |(first_s, _)| first_s);
    let mut notes = Vec::new();
    if (from_s, to_s) != (began_s, ended_s) {
        notes.push(format!(
            "of the log, which lasts from {began_s:.1} s to {ended_s:.1} s, only the part from {from_s:.1} s to {to_s:.1} s is \
             looked at: what happens elsewhere does not show"
        ));
    }
    notes.extend(lacks(&part).map_err(|error| error.of(log))?);
    Ok(Limited { log: from_zero(part, began_s), notes })
}

/// The same of a real robot's log.
///
/// # Errors
/// [`ShowsNothing`] where that is everything.
pub fn of_real(log: &Log) -> Result<Limited, ShowsNothing> {
    match log.known.robot.as_str() {
        "car" if log.firings.is_some() => of_scanner(log),
        "car" => ride::of_ride(log),
        _ => limits(log),
    }
}

/// The same of a real laser scanner, which is diagnosed by its scans alone.
///
/// # Errors
/// [`ShowsNothing`] where that is everything.
pub fn of_scanner(log: &Log) -> Result<Limited, ShowsNothing> {
    follows(log, LEAST_SCANS_S)?;
    Ok(Limited { log: log.clone(), notes: Vec::new() })
}

/// The part of a log that is looked at, and its end: of parts between which nothing is sighted that with the most
/// sightings, from its first one on, and no more of it than can be.
fn looked_at(log: &Log, began_s: f64, ended_s: f64) -> (Log, f64) {
    let seen_s = |i: usize| log.sightings.get(i).map_or(ended_s, |seen| seen.t_s);
    let n = log.sightings.len();
    let most_s = if log.known.robot == "create" { MOST_GAP_ON_WHEELS_S } else { MOST_GAP_S };
    let after_a_gap = (1..n).filter(|i| seen_s(*i) - seen_s(i - 1) > most_s);
    let ends: Vec<usize> = std::iter::once(0).chain(after_a_gap).chain([n]).collect();
    let parts = ends.windows(2).map(|ends| ends[0]..ends[1]);
    let most = parts.reduce(|a, b| if b.len() > a.len() { b } else { a }).unwrap_or_default();
    // Before the first sighting nothing shows, whatever happens.
    let from_s = if most.start == 0 && seen_s(0) - began_s <= GAP_S { began_s } else { seen_s(most.start) };
    let part = log.window(from_s..if most.end < n { seen_s(most.end - 1) + GAP_S } else { f64::INFINITY });
    let row_s = [
        part.commands.get(MOST_ROWS).map(|row| row.t_s),
        part.frames.as_ref().and_then(|frames| frames.get(MOST_ROWS)).map(|row| row.t_s),
        part.sightings.get(MOST_ROWS).map(|row| row.t_s),
    ];
    let to_s = row_s.into_iter().flatten().fold(from_s + MOST_S, f64::min);
    let last_s = part.span_s().map_or(from_s, |(_, last_s)| last_s);
    if to_s <= last_s { (part.window(from_s..to_s), to_s) } else { (part, last_s) }
}

/// The log with times counted from `began_s`: what wears a robot out does so from the log's beginning. Not of a log with
/// firings, which are long and begin at 0.
fn from_zero(log: Log, began_s: f64) -> Log {
    if began_s == 0.0 || log.firings.is_some() {
        return log;
    }
    let commands = log.commands.iter().map(|row| Command { t_s: row.t_s - began_s, ..*row });
    let sightings = log.sightings.iter().map(|row| Sighting { t_s: row.t_s - began_s, ..*row });
    let frame = |row: &Frame| Frame { t_s: row.t_s - began_s, ..*row };
    let frames = log.frames.as_ref().map(|frames| frames.iter().map(frame).collect::<Vec<_>>().into());
    Log {
        commands: commands.collect::<Vec<_>>().into(),
        sightings: sightings.collect::<Vec<_>>().into(),
        frames,
        ..log
    }
}

/// Notes on what the log lacks.
fn lacks(log: &Log) -> Result<Vec<String>, ShowsNothing> {
    let (first_s, last_s) = log.span_s().unwrap_or((0.0, 0.0));
    let sighted_s = log.sightings.first().map_or(last_s, |seen| seen.t_s);
    let settled = log.sightings.iter().filter(|seen| seen.t_s >= sighted_s + SETTLING_S);
    let (found_s, sightings) = (last_s - first_s, settled.count());
    if found_s < LEAST_S || sightings < LEAST_SIGHTINGS {
        return Err(ShowsNothing::TooShort { found_s, sightings, least_s: LEAST_S, least: LEAST_SIGHTINGS });
    }
    let times_s: Vec<f64> = log.sightings.iter().map(|seen| seen.t_s).collect();
    let gaps = times_s.windows(2).filter(|pair| pair[1] - pair[0] > GAP_S);
    let gaps: Vec<[f64; 2]> = gaps.map(|pair| [pair[0], pair[1]]).collect();
    let mut notes = Vec::new();
    if let Some(longest) = gaps.iter().copied().reduce(|a, b| if b[1] - b[0] > a[1] - a[0] { b } else { a }) {
        let [from_s, to_s] = longest;
        notes.push(format!(
            "nothing is sighted between {from_s:.1} s and {to_s:.1} s ({} such gaps): what happens there does not show",
            gaps.len()
        ));
    }
    notes.extend(commanded_alike(log).then(|| ALIKE.to_owned()));
    notes.extend((log.known.commands_are == CommandsAre::Odometry).then(|| MEASURED.to_owned()));
    if log.frames.is_none() {
        notes.push("the log has no frames.csv: sightings that were missed cannot be seen".to_owned());
    }
    Ok(notes)
}

const MEASURED: &str =
    "odometry stands in for commands: what the robot and its wheels make of what they are told does not show";
const ALIKE: &str = "the command never changes: delays, lags and all that shows where commands change cannot be seen";

/// The same of a car with a laser scanner.
fn of_drive(log: &Log) -> Result<Vec<String>, ShowsNothing> {
    follows(log, LEAST_DRIVE_S)?;
    Ok(commanded_alike(log).then(|| ALIKE.to_owned()).into_iter().collect())
}

/// Whether firings last so long, and no longer than a drive does.
fn follows(log: &Log, least_s: f64) -> Result<(), ShowsNothing> {
    let firings = log.firings.as_deref().filter(|firings| !firings.is_empty()).ok_or(ShowsNothing::NoFirings)?;
    let found_s = firings.t_s.last().zip(firings.t_s.first()).map_or(0.0, |(last_s, first_s)| last_s - first_s);
    if found_s.is_nan() || found_s < least_s {
        return Err(ShowsNothing::TooShortDrive { found_s, least_s });
    }
    let jump = firings.t_s.windows(2).find(|pair| pair[1] - pair[0] > MOST_GAP_OF_DRIVE_S);
    if let Some(jump) = jump {
        return Err(ShowsNothing::Jump { from_s: jump[0], to_s: jump[1], most_s: MOST_GAP_OF_DRIVE_S });
    }
    Ok(())
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
    use asami_dataset::{Command, Known, Sighting, Size};

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
        let limits = |log: &Log| limits(log).map(|limited| limited.notes);
        assert_eq!(limits(&Log { commands: Vec::new().into(), ..whole.clone() }), Err(ShowsNothing::NoCommands));
        let blind = Log { sightings: Vec::new().into(), ..whole.clone() };
        assert_eq!(limits(&blind), Err(ShowsNothing::NoSightings));
        assert!(matches!(limits(&log(0.0, None, [0.1; 2])), Err(ShowsNothing::TooShort { sightings: 0, .. })));
        let early = Log { sightings: whole.sightings.window(&(0.0..5.0)), ..whole };
        assert!(matches!(limits(&early), Err(ShowsNothing::TooShort { sightings: 0, .. })));
    }

    #[test]
    fn a_log_of_too_many_rows_is_said_to_have_them() {
        let log = log(60.0, None, [0.1, 0.2]);
        let dense: Vec<Sighting> = (0..900_000)
            .map(|i| Sighting { t_s: 60.0 * f64::from(i) / 900_000.0, ..*log.sightings.first().unwrap() })
            .collect();
        let dense = limits(&Log { sightings: dense.into(), ..log }).unwrap_err();
        assert!(matches!(dense, ShowsNothing::TooDense { rows: 900_000, found_s, .. } if found_s < 7.0), "{dense}");
        let said = dense.to_string();
        assert!(said.ends_with("leave rows out") && !said.contains("  "), "{said}");
    }

    #[test]
    fn a_car_without_scans_is_refused() {
        let known = Known { robot: "car".to_owned(), ..Default::default() };
        let drive = Log { known: known.into(), ..log(60.0, None, [0.1, 0.2]) };
        assert_eq!(limits(&drive), Err(ShowsNothing::NoFirings));
        let firings = |until_s: f64| asami_dataset::Firings { t_s: vec![0.0, until_s], ..Default::default() };
        let with = |until_s: f64| Log { firings: Some(firings(until_s).into()), ..drive.clone() };
        assert!(matches!(limits(&with(12.0)), Err(ShowsNothing::TooShortDrive { .. })));
        assert!(matches!(limits(&with(9000.0)), Err(ShowsNothing::Jump { .. })));
        assert_eq!(limits(&with(60.0)).unwrap().notes, Vec::<String>::new());
        // A scanner's own table shows in less, and without a command.
        let scans = |until_s: f64| of_scanner(&Log { commands: Vec::new().into(), ..with(until_s) });
        assert_eq!(limits(&Log { commands: Vec::new().into(), ..with(60.0) }), Err(ShowsNothing::OnlyScans));
        assert_eq!(scans(12.0).unwrap().notes, Vec::<String>::new());
        assert!(matches!(scans(2.0), Err(ShowsNothing::TooShortDrive { .. })));
        assert_eq!(of_scanner(&drive), Err(ShowsNothing::NoFirings));
    }

    #[test]
    fn what_does_not_show_is_noted() {
        let notes = |log: &Log| limits(log).unwrap().notes.join("\n");
        assert!(notes(&log(60.0, None, [0.1; 2])).contains("the command never changes"));
        let known = Known { commands_are: CommandsAre::Odometry, ..Known::default() };
        let measured = Log { known: known.into(), ..log(60.0, None, [0.1, 0.2]) };
        assert!(notes(&measured).contains("odometry stands in for commands"));
        assert!(!notes(&log(60.0, None, [0.1, 0.2])).contains("odometry"));
        let gap = notes(&log(400.0, Some([30.0, 50.0]), [0.1, 0.2]));
        assert!(gap.contains("between 30.0 s and 50.0 s (1 such gaps)") && !gap.contains("never changes"), "{gap}");
        assert!(!gap.contains("is looked at"), "{gap}");
    }

    /// A clock that counts from 1970 says the same; of days, the first half hour with something in it is looked at.
    #[test]
    fn clocks_begin_anywhere_and_logs_of_days_are_cut() {
        let whole = log(60.0, None, [0.1, 0.2]);
        let day = from_zero(whole.clone(), -1.7e9);
        assert_eq!(day.commands[0].t_s, 1.7e9);
        assert_eq!(limits(&day), limits(&whole));
        assert_eq!(limits(&whole).unwrap().log, whole);

        // A clock that was set: the longer part is taken.
        let set = log(9000.0, Some([30.0, 8000.0]), [0.1, 0.2]);
        let limited = limits(&set).unwrap();
        assert_eq!(limited.log.span_s(), Some((8000.0, 9000.0)));

        let days = Log { sightings: log(2e5, Some([0.5, 600.0]), [0.1; 2]).sightings, ..log(2e5, None, [0.1, 0.2]) };
        let days = Log { sightings: days.sightings.window(&(600.0..1e9)), ..days };
        let limited = limits(&days).unwrap();
        assert_eq!(limited.log.span_s(), Some((600.0, 2399.5)));
        assert!(limited.notes[0].contains("only the part from 600.0 s to 2400.0 s is looked at"), "{limited:?}");
        // Too many rows in too little time.
        let dense = |n: usize| {
            let sighting = |i: usize| Sighting { t_s: i as f64 * 1e-3, ..whole.sightings[0] };
            Log { sightings: (0..n).map(sighting).collect::<Vec<_>>().into(), ..whole.clone() }
        };
        assert_eq!(limits(&dense(3 * MOST_ROWS)).unwrap().log.sightings.len(), MOST_ROWS);
        assert_eq!(limits(&dense(MOST_ROWS)).unwrap().log.sightings.len(), MOST_ROWS);
    }
}
