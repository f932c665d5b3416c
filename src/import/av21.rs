//! A full-size driverless race car on an oval: the log of the Cavalier Autonomous Racing team's AV-21 with which Deep Dynamics was made
//! (Chrosniak, Ning and Behl 2024), an action model of chapter 5 from a real car.
//!
//! A file `*.csv` or `*.csv.gz` with a row every 0.04 s and, among others, the columns
//!
//! | column | unit | what |
//! |---|---|---|
//! | `# time(s)` | s | time |
//! | `vx(m/s)` | m/s | forward speed, by the car's inertial navigation |
//! | `omega(rad/s)` | rad/s | turning rate by the same, counter-clockwise |
//! | `delta(rad)` | rad | angle of the front wheels, left positive |
//! | `throttle_ped_cmd(%)` | % | throttle as commanded |
//! | `brake_ped_cmd(kPa)` | kPa | pressure of the brakes as commanded |

use std::path::{Path, PathBuf};

use asami_dataset::log::Odometry;
use asami_dataset::{Action, Command, Dataset, Known, Log, TruePose, Truth};

use super::columns::required;
use super::track::{Moving, added_up};
use super::{ImportError, Imported, Importer, Read, clock, columns};

/// The importer's row in the list.
pub static IMPORTER: Importer = Importer {
    name: "av21",
    what: "A driverless race car: throttle, brake and steering, speed and yaw rate (a .csv or .csv.gz of Deep Dynamics).",
    source: "J. Chrosniak, J. Ning and M. Behl, Deep Dynamics (2024): logs of the AV-21 at the Las Vegas Motor Speedway",
    read: Read::One(read),
};

/// Angle of the front wheels at full lock, which counts as 1: the steering motor's 240 deg at 15 to 1.
const FULL_LOCK_RAD: f64 = 16.0 / 180.0 * std::f64::consts::PI;
/// Brake pressure that counts as 1: 400 psi, the greatest that is ever commanded.
const FULL_BRAKE_KPA: f64 = 2757.9;

const HINT: &str = "it is a .csv or .csv.gz of linklab-uva/deep-dynamics, or a folder with one";
const NAMES: [&str; 6] =
    ["# time(s)", "vx(m/s)", "omega(rad/s)", "delta(rad)", "throttle_ped_cmd(%)", "brake_ped_cmd(kPa)"];

/// Reads the log at `source`, a file or the folder that holds one.
///
/// # Errors
/// [`ImportError`] where there is no such log, or it is not as documented above.
pub fn read(source: &Path) -> Result<Imported, ImportError> {
    let file = find(source, HINT, |name| name.ends_with(".csv") || name.ends_with(".csv.gz"))?;
    let rows = columns::read(&file, NAMES)?;
    let full = |(line, values): &columns::Row<6>| {
        let mut all = [0.0; 6];
        for ((slot, value), name) in all.iter_mut().zip(values).zip(NAMES) {
            *slot = required(&file, *line, name, *value)?;
        }
        Ok((*line, all))
    };
    let rows: Vec<(u64, [f64; 6])> = rows.iter().map(full).collect::<Result<_, ImportError>>()?;
    let times: Vec<(u64, f64)> = rows.iter().map(|(line, row)| (*line, row[0])).collect();
    let timing = clock::timing(&file, NAMES[0], &times)?;
    let start_s = times.first().map_or(0.0, |first| first.1);
    let mut log = Log { known: Known { robot: "car".to_owned(), ..Known::default() }.into(), ..Log::default() };
    let (mut commands, mut odometry) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
    let mut moving = Vec::with_capacity(rows.len());
    for (_, [t_s, v_m_per_s, omega_rad_per_s, delta, throttle, brake]) in rows {
        let t_s = t_s - start_s;
        let (throttle, brake) = ((throttle / 100.0).clamp(0.0, 1.0), (brake / FULL_BRAKE_KPA).clamp(0.0, 1.0));
        let steering = (delta / FULL_LOCK_RAD).clamp(-1.0, 1.0);
        commands.push(Command { t_s, action: Action::Pedals { throttle, brake, steering } });
        odometry.push(Odometry { t_s, v_m_per_s, omega_rad_per_s });
        moving.push(Moving { t_s, v_m_per_s, omega_rad_per_s });
    }
    let track: Vec<TruePose> = added_up(&moving);
    let mut notes = vec![
        "assumed: times count from the first row".to_owned(),
        format!(
            "assumed: throttle is its share of 100 %, brake that of {FULL_BRAKE_KPA} kPa, steering the wheels' angle's of {FULL_LOCK_RAD:.4} rad"
        ),
        "assumed: speed and yaw rate of the inertial navigation are what the car may measure itself (odometry.csv), and the truth".to_owned(),
        "assumed: positions are the forward speed and rate of turn added up".to_owned(),
    ];
    notes.extend(timing.notes("rows"));
    (log.commands, log.odometry) = (commands.into(), odometry.into());
    let truth = Truth { track: track.into(), survey: None };
    Ok(Imported { dataset: Dataset { log, truth, provenance: None }, notes })
}

/// `source`, if it is a file; or the first file in that folder whose name `is_one`.
///
/// # Errors
/// [`ImportError::Absent`] with `hint` where there is none.
pub(super) fn find(source: &Path, hint: &'static str, is_one: impl Fn(&str) -> bool) -> Result<PathBuf, ImportError> {
    if source.is_file() {
        return Ok(source.to_owned());
    }
    let listed = std::fs::read_dir(source).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let named = |path: &PathBuf| path.is_file() && path.file_name().is_some_and(|name| is_one(&name.to_string_lossy()));
    listed.filter(named).min().ok_or_else(|| ImportError::Absent { path: source.to_owned(), hint })
}
