//! A robot on a rail facing a cylinder: Tim Barfoot's "Giant Glass of Milk" course data (University of
//! Toronto Institute for Aerospace Studies), a log of chapter 3 from a real robot.
//!
//! A file `log.csv` or `log.csv.gz` with the columns
//!
//! | column | unit | what |
//! |---|---|---|
//! | `t_s` | s | time, 10 Hz |
//! | `v_odometry_m_per_s` | m/s | forward speed by the wheels: it stands in for the command |
//! | `range_m` | m | laser range to the cylinder's centre; empty: not seen |
//! | `x_true_m` | m | place along the rail by motion capture |
//!
//! On the rail the robot faces +x. Here it faces +y: the rail becomes the world's y axis.

use std::path::{Path, PathBuf};

use asami_dataset::log::RangeBearing;
use asami_dataset::{
    Action, Beacon, Command, CommandsAre, Dataset, Frame, Known, Log, Sighting, Size, Survey, TruePose, Truth,
};

use super::clock::{self, Timing};
use super::columns::{self, Row, required};
use super::{ImportError, Imported, Importer, Read, units};

/// Place of the cylinder along the rail (the data set's documentation).
const LANDMARK_M: f64 = 4.428479;
/// Variance of the range in m^2 (the data set's documentation).
const RANGE_VAR_M2: f64 = 3.669e-4;

const COLUMNS: [&str; 4] = ["t_s", "v_odometry_m_per_s", "range_m", "x_true_m"];

/// The importer's row in the list.
pub static IMPORTER: Importer = Importer {
    name: "barfoot-1d",
    what: "A robot on a rail facing a cylinder: wheel speed, laser range, motion capture (log.csv or log.csv.gz).",
    source: "T. Barfoot, University of Toronto: the \"Giant Glass of Milk\" course data",
    read: Read::One(read),
};

/// Reads the log at `source`, a file or the folder that holds it.
///
/// # Errors
/// [`ImportError`] where there is no such log, or it is not as documented above.
pub fn read(source: &Path) -> Result<Imported, ImportError> {
    let file = find(source)?;
    let rows = columns::read(&file, COLUMNS)?;
    let times: Vec<(u64, f64)> = rows
        .iter()
        .map(|(line, values)| required(&file, *line, "t_s", values[0]).map(|t_s| (*line, t_s)))
        .collect::<Result<_, _>>()?;
    let timing = clock::timing(&file, "t_s", &times)?;
    let dataset = dataset(&file, &rows, &timing)?;
    let notes = notes(&dataset, &timing);
    Ok(Imported { dataset, notes })
}

fn find(source: &Path) -> Result<PathBuf, ImportError> {
    columns::find(source, "log.csv").ok_or_else(|| ImportError::Absent {
        path: source.to_owned(),
        hint: "the log is T. Barfoot's \"Giant Glass of Milk\" course data (University of Toronto), as log.csv or log.csv.gz",
    })
}

fn dataset(file: &Path, rows: &[Row<4>], timing: &Timing) -> Result<Dataset, ImportError> {
    let (mut commands, mut frames, mut sightings, mut track) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (line, [t_s, v, range, x_true]) in rows {
        let t_s = required(file, *line, "t_s", *t_s)?;
        let v_m_per_s = required(file, *line, "v_odometry_m_per_s", *v)?;
        commands.push(Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s: 0.0 } });
        frames.push(Frame { t_s, head_pan_rad: 0.0 });
        if let Some(range_m) = *range {
            let range_m = units::range(file, *line, "range_m", range_m)?;
            sightings.push(Sighting { t_s, landmark: 0, size: Size::RangeM(range_m), bearing_rad: 0.0 });
        }
        if let Some(y_m) = *x_true {
            track.push(TruePose { t_s, x_m: 0.0, y_m, theta_rad: 0.0, v_m_per_s: None });
        }
    }
    let max_range_m = sightings.iter().map(|seen| seen.size.value()).fold(f64::MIN_POSITIVE, f64::max);
    let known = Known {
        robot: "create".to_owned(),
        command_rate_hz: Some((timing.rate_hz * 1e6).round() / 1e6),
        commands_are: CommandsAre::Odometry,
        range_bearing: Some(RangeBearing { max_range_m, sensor_origin_m: [0.0, 0.0] }),
        landmarks: vec![Beacon { id: 0, x_m: 0.0, y_m: LANDMARK_M, height_m: None }],
        ..Known::default()
    };
    let log = Log {
        known: known.into(),
        commands: commands.into(),
        frames: Some(frames.into()),
        sightings: sightings.into(),
        ..Log::default()
    };
    let survey = Survey { sigma1_m: Some(RANGE_VAR_M2.sqrt()), ..Survey::default() };
    Ok(Dataset { log, truth: Truth { track: track.into(), survey: Some(survey) }, provenance: None })
}

fn notes(dataset: &Dataset, timing: &Timing) -> Vec<String> {
    let Dataset { log, truth, .. } = dataset;
    let frames = log.commands.len();
    let span_s = log.span_s().map_or(0.0, |(first_s, last_s)| last_s - first_s);
    let max_range_m = log.known.range_bearing.map_or(0.0, |sensor| sensor.max_range_m);
    let mut notes = vec![
        "assumed: the wheel speed stands in for the command, held until the next (commands.csv, robot \"create\")"
            .to_owned(),
        format!(
            "assumed: the cylinder stands {LANDMARK_M} m along the rail; bearings are 0: the rail keeps the heading"
        ),
        "assumed: the rail, +x in the source, is the world's y axis, and the robot faces +y (theta 0)".to_owned(),
        format!("assumed: the laser's reach is the longest range in the log, {max_range_m:.6} m"),
        format!("assumed: the range's variance is {RANGE_VAR_M2} m^2, as documented (survey.toml, sigma1_m)"),
        format!("found: {frames} rows over {span_s:.1} s, times increasing"),
        format!("found: {} frames without a range", frames - log.sightings.len()),
    ];
    notes.extend(timing.notes("rows"));
    notes.extend(units::hints_of_wheels(&log.commands, ["wheel speeds", "turning rates"]));
    notes.extend(units::hint("ranges", log.sightings.iter().map(|seen| seen.size.value()), units::FAR_M, "m"));
    if let Some(lead_s) = lead_s(log, &truth.track) {
        notes.push(format!("found: the range runs ahead of the motion capture by {lead_s:.3} s; left as it is"));
    }
    notes
}

/// How long the measured range runs ahead of the true distance `d`: the slope of `range - d` over
/// `dd/dt`, since `d(t + lead) = d(t) + lead dd/dt` for short times.
fn lead_s(log: &Log, track: &[TruePose]) -> Option<f64> {
    let (mut covariance, mut variance) = (0.0, 0.0);
    for three in track.windows(3) {
        let rate = -(three[2].y_m - three[0].y_m) / (three[2].t_s - three[0].t_s);
        let at = log.sightings.partition_point(|seen| seen.t_s < three[1].t_s);
        let Some(seen) = log.sightings.get(at).filter(|seen| seen.t_s == three[1].t_s) else { continue };
        covariance += rate * (seen.size.value() - (LANDMARK_M - three[1].y_m));
        variance += rate * rate;
    }
    Some(covariance / variance).filter(|lead_s| lead_s.is_finite())
}
