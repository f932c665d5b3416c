//! A robot among 17 tubes: Tim Barfoot's "Lost in the Woods" course data (University of Toronto Institute for
//! Aerospace Studies), a log of chapter 4 from a real robot.
//!
//! A folder with three files, each plain or `.gz`:
//!
//! | file | columns |
//! |---|---|
//! | `landmarks.csv` | `landmark,x_m,y_m`: the tubes' true places |
//! | `odometry_and_truth.csv` | `t_s,v_odometry_m_per_s,omega_odometry_rad_per_s,x_true_m,y_true_m,theta_true_rad,truth_valid` |
//! | `sightings.csv` | `t_s,landmark,range_m,bearing_rad`, from the laser |
//!
//! In the source heading 0 faces +x. Here it faces +y: pi/2 is taken off every heading, and places stay as they are.

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use asami_dataset::log::RangeBearing;
use asami_dataset::{Action, Beacon, Command, CommandsAre, Frame, Known, Log, Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;

use super::columns::{self, required};
use super::{ImportError, Imported, Importer, Read, capture, clock, units};

/// How far the laser sits ahead of the robot's centre (the data set's documentation).
const LASER_AHEAD_M: f64 = 0.219016;

/// What a source is.
const HINT: &str = "the log is T. Barfoot's \"Lost in the Woods\" course data (University of Toronto), as a folder with \
                    landmarks.csv, odometry_and_truth.csv and sightings.csv, each plain or .gz";

const LANDMARKS: [&str; 3] = ["landmark", "x_m", "y_m"];
const TRACK: [&str; 7] =
    ["t_s", "v_odometry_m_per_s", "omega_odometry_rad_per_s", "x_true_m", "y_true_m", "theta_true_rad", "truth_valid"];
const SIGHTINGS: [&str; 4] = ["t_s", "landmark", "range_m", "bearing_rad"];

/// The importer's row in the list.
pub static IMPORTER: Importer = Importer {
    name: "barfoot-2d",
    what: "A robot among 17 tubes: wheel speeds, laser ranges and bearings, motion capture (a folder of three CSV files).",
    source: "T. Barfoot, University of Toronto: the \"Lost in the Woods\" course data",
    read: Read::One(read),
};

/// Reads the log in the folder `source`.
///
/// # Errors
/// [`ImportError`] where there is no such log, or it is not as documented above.
pub fn read(source: &Path) -> Result<Imported, ImportError> {
    let file = |name: &str| columns::of_folder(source, name, HINT);
    let landmarks = landmarks(&file("landmarks.csv")?)?;
    let (commands, frames, track, mut notes) = track(&file("odometry_and_truth.csv")?)?;
    let (sightings, others) = sightings(&file("sightings.csv")?, &landmarks, &frames)?;
    notes.extend(others);
    let max_range_m = sightings.iter().map(|seen| seen.size.value()).fold(f64::MIN_POSITIVE, f64::max);
    notes.push(format!("assumed: the laser's reach is the longest range in the log, {max_range_m:.6} m"));

    let known = Known {
        robot: "create".to_owned(),
        command_rate_hz: Some(10.0),
        commands_are: CommandsAre::Odometry,
        range_bearing: Some(RangeBearing { max_range_m, sensor_origin_m: [0.0, LASER_AHEAD_M] }),
        landmarks,
        ..Known::default()
    };
    let log = Log {
        known: known.into(),
        commands: commands.into(),
        frames: Some(frames.into()),
        sightings: sightings.into(),
        ..Log::default()
    };
    Ok(capture::agreed(log, track, notes))
}

fn landmarks(file: &Path) -> Result<Vec<Beacon>, ImportError> {
    let mut landmarks: Vec<Beacon> = Vec::new();
    for (line, [id, x, y]) in columns::read(file, LANDMARKS)? {
        let id = columns::whole(file, line, "landmark", required(file, line, "landmark", id)?)?;
        if landmarks.last().is_some_and(|last| last.id >= id) {
            let (rule, found) = ("must increase", id.to_string());
            return Err(ImportError::Value { file: file.to_owned(), line, column: "landmark".to_owned(), rule, found });
        }
        let (x_m, y_m) = (required(file, line, "x_m", x)?, required(file, line, "y_m", y)?);
        landmarks.push(Beacon { id, x_m, y_m, height_m: None });
    }
    Ok(landmarks)
}

type Track = (Vec<Command>, Vec<Frame>, Vec<TruePose>, Vec<String>);

fn track(file: &Path) -> Result<Track, ImportError> {
    let (mut commands, mut frames, mut track, mut times) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (line, values) in columns::read(file, TRACK)? {
        let must = |column: usize| required(file, line, TRACK[column], values[column]);
        let t_s = must(0)?;
        times.push((line, t_s));
        let action = Action::Wheels { id: None, v_m_per_s: must(1)?, omega_rad_per_s: must(2)? };
        commands.push(Command { t_s, action });
        frames.push(Frame { t_s, head_pan_rad: 0.0 });
        if must(6)? != 0.0 {
            let theta_rad = wrap_rad(units::radians(file, line, TRACK[5], must(5)?)? - FRAC_PI_2);
            track.push(TruePose { t_s, x_m: must(3)?, y_m: must(4)?, theta_rad, v_m_per_s: None });
        }
    }
    let timing = clock::timing(file, "t_s", &times)?;
    let span_s = times[times.len() - 1].1 - times[0].1;
    let mut notes = vec![
        "assumed: the wheels' speeds stand in for the command, held until the next (commands.csv, robot \"create\")"
            .to_owned(),
        "assumed: heading 0 faces +x in the source; pi/2 is taken off, so that 0 faces +y; places stay".to_owned(),
        format!("assumed: ranges and bearings are the laser's, {LASER_AHEAD_M} m ahead of the robot's centre"),
        "assumed: every row is a frame of the laser, also where no tube was seen".to_owned(),
        format!("found: {} rows over {span_s:.1} s, {} of them without truth", times.len(), times.len() - track.len()),
    ];
    notes.extend(timing.notes("rows"));
    notes.extend(units::hints_of_wheels(&commands, ["wheel speeds", "turning rates"]));
    Ok((commands, frames, track, notes))
}

fn sightings(file: &Path, landmarks: &[Beacon], frames: &[Frame]) -> Result<(Vec<Sighting>, Vec<String>), ImportError> {
    let (mut sightings, mut times) = (Vec::new(), Vec::new());
    for (line, values) in columns::read(file, SIGHTINGS)? {
        let must = |column: usize| required(file, line, SIGHTINGS[column], values[column]);
        let refused = |column: &str, rule, found: f64| {
            let column = column.to_owned();
            Err(ImportError::Value { file: file.to_owned(), line, column, rule, found: found.to_string() })
        };
        let t_s = must(0)?;
        times.push((line, t_s));
        if frames.binary_search_by(|frame| frame.t_s.total_cmp(&t_s)).is_err() {
            return refused("t_s", "must be the time of a row of odometry_and_truth.csv", t_s);
        }
        let landmark = columns::whole(file, line, "landmark", must(1)?)?;
        if !landmarks.iter().any(|it| it.id == landmark) {
            return refused("landmark", "must be one of landmarks.csv", f64::from(landmark));
        }
        sightings.push(Sighting {
            t_s,
            landmark,
            size: Size::RangeM(units::range(file, line, "range_m", must(2)?)?),
            bearing_rad: units::radians(file, line, "bearing_rad", must(3)?)?,
        });
    }
    clock::forward(file, "t_s", &times)?;
    let mut notes = vec![format!("found: {} sightings of {} tubes", sightings.len(), landmarks.len())];
    let ranges = sightings.iter().map(|seen| seen.size.value());
    notes.extend(units::hint("ranges", ranges, units::FAR_M, "m"));
    Ok((sightings, notes))
}
