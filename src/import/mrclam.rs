//! Five iRobot Create robots among 15 landmarks: the UTIAS Multi-Robot Cooperative Localization and Mapping data sets
//! (Leung, Halpern, Barfoot, Liu, IJRR 30 (2011) 969-974), one robot of one of them.
//!
//! A folder of text files, blanks between columns, `#` before remarks, each plain or `.gz`:
//!
//! | file | columns |
//! |---|---|
//! | `Barcodes.dat` | subject, barcode |
//! | `Landmark_Groundtruth.dat` | subject (6 to 20), x, y (m), their standard deviations |
//! | `RobotN_Odometry.dat` | time (s), forward (m/s) and turning (rad/s) velocity as commanded |
//! | `RobotN_Measurement.dat` | time (s), barcode, range (m), bearing (rad) |
//! | `RobotN_Groundtruth.dat` | time (s), x, y (m), orientation (rad) |
//!
//! In the source heading 0 faces +x. Here it faces +y: pi/2 is taken off every heading, and places stay as they are.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use asami_dataset::log::RangeBearing;
use asami_dataset::{Action, Beacon, Command, Known, Log, Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;

use super::{ImportError, Imported, Importer, Read, capture, clock, columns, units, words};

/// Subjects that are robots; landmarks come after them.
const ROBOTS: [u16; 5] = [1, 2, 3, 4, 5];

/// What a source is.
const HINT: &str = "the logs are the UTIAS MRCLAM data sets (Leung et al. 2011): a folder with Barcodes.dat, \
                    Landmark_Groundtruth.dat and three .dat files a robot, each plain or .gz";

/// The importer's row in the list.
pub static IMPORTER: Importer = Importer {
    name: "mrclam",
    what: "One of five iRobot Create robots among 15 landmarks: commands, ranges and bearings, motion capture (a folder \
           of .dat files, plain or .gz; choose --robot 1 to 5).",
    source: "UTIAS MRCLAM data sets: Leung, Halpern, Barfoot, Liu, IJRR 30 (2011) 969-974",
    read: Read::OneOf(&ROBOTS, read),
};

/// Reads the log of `robot` in the folder `source`.
///
/// # Errors
/// [`ImportError`] where there is no such log, or it is not as documented above.
pub fn read(source: &Path, robot: u16) -> Result<Imported, ImportError> {
    let file = |name: &str| columns::of_folder(source, name, HINT);
    let landmarks = landmarks(&file("Landmark_Groundtruth.dat")?)?;
    let subjects = subjects(&file("Barcodes.dat")?, &landmarks)?;
    let odometry = file(&format!("Robot{robot}_Odometry.dat"))?;
    let measurement = file(&format!("Robot{robot}_Measurement.dat"))?;
    let groundtruth = file(&format!("Robot{robot}_Groundtruth.dat"))?;
    let commanded = words::read(&odometry, ["time", "forward velocity", "angular velocity"])?;
    let measured = words::read(&measurement, ["time", "barcode", "range", "bearing"])?;
    let captured = words::read(&groundtruth, ["time", "x", "y", "orientation"])?;

    let firsts =
        [commanded.first().map(|it| it.1[0]), measured.first().map(|it| it.1[0]), captured.first().map(|it| it.1[0])];
    let zero_s = firsts.into_iter().flatten().reduce(f64::min).unwrap_or_default();
    let clock = Clock { zero_s };
    let mut notes = vec![
        "assumed: the odometry rows are velocity commands, each held until the next (commands.csv, robot \"create\")"
            .to_owned(),
        "assumed: heading 0 faces +x in the source; pi/2 is taken off, so that 0 faces +y; places stay".to_owned(),
        "assumed: ranges and bearings are measured from the robot's centre".to_owned(),
        "assumed: misses are unknown: a camera frame that read no barcode is not in the source".to_owned(),
        format!("assumed: time 0 is {zero_s:.3} s of the source's clock"),
    ];
    let commands = commands(&odometry, &commanded, &clock, &mut notes)?;
    let sightings = sightings(&measurement, &measured, &subjects, &clock, &mut notes)?;
    let track = track(&groundtruth, &captured, &clock, &mut notes)?;
    let max_range_m = sightings.iter().map(|seen| seen.size.value()).fold(f64::MIN_POSITIVE, f64::max);
    notes.push(format!("assumed: the camera's reach is the longest range in the log, {max_range_m:.3} m"));

    let known = Known {
        robot: "create".to_owned(),
        range_bearing: Some(RangeBearing { max_range_m, sensor_origin_m: [0.0, 0.0] }),
        landmarks,
        ..Known::default()
    };
    let log = Log { known: known.into(), commands: commands.into(), sightings: sightings.into(), ..Log::default() };
    Ok(capture::agreed(log, track, notes))
}

/// The source's clock, which counts from 1970.
struct Clock {
    zero_s: f64,
}

impl Clock {
    /// Seconds since the log began, in whole microseconds: what a double can hold of the source's times.
    fn since_zero_s(&self, t_s: f64) -> f64 {
        ((t_s - self.zero_s) * 1e6).round() / 1e6
    }
}

fn landmarks(file: &Path) -> Result<Vec<Beacon>, ImportError> {
    let mut landmarks: Vec<Beacon> = Vec::new();
    for (line, [subject, x_m, y_m, ..]) in words::read(file, ["subject", "x", "y", "x std-dev", "y std-dev"])? {
        let id = columns::whole(file, line, "subject", subject)?;
        if ROBOTS.contains(&id) || landmarks.last().is_some_and(|last| last.id >= id) {
            let rule = "must be greater than the one before and than any robot's";
            return Err(ImportError::Value {
                file: file.to_owned(),
                line,
                column: "subject".to_owned(),
                rule,
                found: id.to_string(),
            });
        }
        landmarks.push(Beacon { id, x_m, y_m, height_m: None });
    }
    Ok(landmarks)
}

/// Who carries which barcode.
fn subjects(file: &Path, landmarks: &[Beacon]) -> Result<BTreeMap<u16, u16>, ImportError> {
    let mut subjects = BTreeMap::new();
    for (line, [subject, barcode]) in words::read(file, ["subject", "barcode"])? {
        let subject = columns::whole(file, line, "subject", subject)?;
        let barcode = columns::whole(file, line, "barcode", barcode)?;
        let refused = |column: &str, rule, found: u16| {
            let column = column.to_owned();
            Err(ImportError::Value { file: file.to_owned(), line, column, rule, found: found.to_string() })
        };
        if !ROBOTS.contains(&subject) && !landmarks.iter().any(|landmark| landmark.id == subject) {
            return refused("subject", "must be a robot or a landmark of Landmark_Groundtruth.dat", subject);
        }
        if subjects.insert(barcode, subject).is_some() {
            return refused("barcode", "must belong to one subject", barcode);
        }
    }
    Ok(subjects)
}

type Rows<const N: usize> = [(u64, [f64; N])];

fn times<const N: usize>(rows: &Rows<N>, clock: &Clock) -> Vec<(u64, f64)> {
    rows.iter().map(|(line, values)| (*line, clock.since_zero_s(values[0]))).collect()
}

fn commands(file: &Path, rows: &Rows<3>, clock: &Clock, notes: &mut Vec<String>) -> Result<Vec<Command>, ImportError> {
    let mut times = times(rows, clock);
    clock::forward(file, "time", &times)?;
    let mut commands: Vec<Command> = Vec::new();
    for ((_, t_s), (_, [_, v_m_per_s, omega_rad_per_s])) in times.iter().zip(rows) {
        let (v_m_per_s, omega_rad_per_s) = (*v_m_per_s, *omega_rad_per_s);
        // Of two commands of one time none holds the first.
        commands.pop_if(|last| last.t_s == *t_s);
        commands.push(Command { t_s: *t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } });
    }
    let again = rows.len() - commands.len();
    times.dedup_by_key(|(_, t_s)| *t_s);
    notes.extend(clock::timing(file, "time", &times)?.notes("commands"));
    notes.push(format!("found: {} commands, and {again} replaced by another of the same time", commands.len()));
    notes.extend(units::hints_of_wheels(&commands, ["forward velocities", "angular velocities"]));
    Ok(commands)
}

fn sightings(
    file: &Path,
    rows: &Rows<4>,
    subjects: &BTreeMap<u16, u16>,
    clock: &Clock,
    notes: &mut Vec<String>,
) -> Result<Vec<Sighting>, ImportError> {
    let times = times(rows, clock);
    clock::forward(file, "time", &times)?;
    let (mut sightings, mut robots, mut unknown) = (Vec::new(), 0, 0);
    for ((_, t_s), (line, [_, barcode, range_m, bearing_rad])) in times.iter().zip(rows) {
        let size = Size::RangeM(units::range(file, *line, "range", *range_m)?);
        let bearing_rad = units::radians(file, *line, "bearing", *bearing_rad)?;
        match subjects.get(&columns::whole(file, *line, "barcode", *barcode)?) {
            Some(subject) if ROBOTS.contains(subject) => robots += 1,
            Some(&landmark) => sightings.push(Sighting { t_s: *t_s, landmark, size, bearing_rad }),
            None => unknown += 1,
        }
    }
    notes.push(format!("found: {} sightings of landmarks", sightings.len()));
    notes.push(format!("found: {robots} sightings of other robots, ignored"));
    notes.push(format!("found: {unknown} sightings of barcodes that nobody carries, ignored"));
    notes.extend(units::hint("ranges", sightings.iter().map(|seen| seen.size.value()), units::FAR_M, "m"));
    Ok(sightings)
}

fn track(file: &Path, rows: &Rows<4>, clock: &Clock, notes: &mut Vec<String>) -> Result<Vec<TruePose>, ImportError> {
    let times = times(rows, clock);
    notes.extend(clock::timing(file, "time", &times)?.notes("true poses"));
    let pose = |((_, t_s), (line, [_, x_m, y_m, orientation_rad])): (&(u64, f64), &(u64, [f64; 4]))| {
        let theta_rad = wrap_rad(units::radians(file, *line, "orientation", *orientation_rad)? - FRAC_PI_2);
        Ok(TruePose { t_s: *t_s, x_m: *x_m, y_m: *y_m, theta_rad, v_m_per_s: None })
    };
    times.iter().zip(rows).map(pose).collect()
}
