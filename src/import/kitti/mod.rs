//! Revolutions of a real HDL-64E as pictures of their raw firings, and the car's inertial navigation: KITTI raw (Geiger, Lenz, Stiller and
//! Urtasun 2013), point clouds turned back into firings.
//!
//! A folder with
//!
//! | what | holds |
//! |---|---|
//! | `range/*.png` | one revolution each, in order of name: 16-bit grey, a column a firing; rows 0 to 63 the ranges in units of 2 mm (0: no return), lasers by increasing vertical angle; row 64 the encoder's angle, clockwise, hundredths of a degree |
//! | `oxts.txt` | KITTI's 30 columns, a row a revolution; of these the forward speed and the rate of turn are read |
//! | `calib.txt` | may be absent, or have no such row: `Tr_imu_to_velo` says where the navigation unit stands |
//!
//! Columns go by the encoder's angle from ahead on, but a revolution begins and ends where the unit looks back: what a picture shows
//! first was measured last. (Ranges run on from a picture's last column to its first one, and jump in its middle.) A row of navigation is
//! taken to be of the revolution's beginning: on drive 5 its turning rates agree with scan matching's when it is dated 0.06 s before the unit looks
//! ahead, half a revolution.

mod lever;
mod unit;

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use asami_dataset::firings::ENCODER_STEPS;
use asami_dataset::log::Velodyne;
use asami_dataset::{Dataset, Firings, Known, Log, Survey, TruePose, Truth};

use self::lever::Lever;
use self::unit::KITTI_DEG;
use super::columns::{find, of_folder};
use super::track::{Moving, added_up};
use super::{ImportError, Imported, Importer, Read, words};

/// The importer's row in the list.
pub static IMPORTER: Importer = Importer {
    name: "kitti",
    what: "Revolutions of an HDL-64E as pictures of its raw firings, and inertial navigation (range/*.png and oxts.txt).",
    source: "A. Geiger, P. Lenz, C. Stiller and R. Urtasun, Vision meets robotics: the KITTI dataset (2013)",
    read: Read::One(read),
};

/// How long a revolution takes: not recorded, but the data set's rate.
const TURN_S: f64 = 0.1036;
/// Of the sensor over the ground (the data set's documentation).
const SENSOR_HEIGHT_M: f64 = 1.73;
/// More columns than any revolution has.
const MOST_COLUMNS: u32 = 8192;

const HINT: &str = "it is a folder with range/*.png and oxts.txt, made of KITTI raw data";
const OXTS: [&str; 30] = [
    "lat", "lon", "alt", "roll", "pitch", "yaw", "vn", "ve", "vf", "vl", "vu", "ax", "ay", "az", "af", "al", "au",
    "wx", "wy", "wz", "wf", "wl", "wu", "posacc", "velacc", "navstat", "numsats", "posmode", "velmode", "orimode",
];
/// Column of the forward speed, and that of the rate of turn about the vertical.
const VF: usize = 8;
const WU: usize = 22;

/// Reads the drive in the folder `source`.
///
/// # Errors
/// [`ImportError`] where there is no such drive, or it is not as documented above.
pub fn read(source: &Path) -> Result<Imported, ImportError> {
    let lever = find(source, "calib.txt").map(|file| lever::read(&file)).transpose()?.flatten();
    let track = track(&of_folder(source, "oxts.txt", HINT)?, lever.unwrap_or_default())?;
    let firings = firings(&pictures(&source.join("range"))?)?;
    let turns = firings.t_s.last().map_or(0.0, |last| (last / TURN_S).ceil());
    let rate_hz = firings.len() as f64 / (turns.max(1.0) * TURN_S);
    let notes = vec![
        format!("found: {} firings of {} lasers in {turns} revolutions", firings.len(), firings.lasers()),
        format!(
            "assumed: each revolution takes {TURN_S} s and begins where the unit looks back, when its row of oxts.txt was taken"
        ),
        "assumed: the unit looks ahead at encoder angle 0, so that theta_b is 90 degrees".to_owned(),
        "assumed: positions are the forward speed and rate of turn added up".to_owned(),
        match lever {
            Some(Lever { ahead_m, left_m }) => {
                format!(
                    "found: the unit is {ahead_m:.2} m ahead of the navigation and {left_m:.2} m to its left; the track is the unit's"
                )
            }
            None => {
                "assumed: the navigation is where the unit is, for no calib.txt has a row Tr_imu_to_velo".to_owned()
            }
        },
    ];
    let velodyne = Velodyne {
        vertical_angles_rad: vertical_angles_rad(),
        firing_rate_hz: rate_hz,
        turn_rate_hz: 1.0 / TURN_S,
        sensor_height_m: SENSOR_HEIGHT_M,
        left_m: Vec::new(),
        up_m: Vec::new(),
    };
    let ahead_rad = std::f64::consts::FRAC_PI_2;
    let survey = Survey {
        horizontal_angles_rad: KITTI_DEG.iter().map(|[_, rotational]| rotational.to_radians() + ahead_rad).collect(),
        theta_b_rad: Some(ahead_rad),
        ..Survey::default()
    };
    let known = Known { robot: "car".to_owned(), velodyne: Some(velodyne), ..Known::default() };
    let log = Log { known: known.into(), firings: Some(Arc::new(firings)), ..Log::default() };
    Ok(Imported {
        dataset: Dataset { log, truth: Truth { track: track.into(), survey: Some(survey) }, provenance: None },
        notes,
    })
}

/// Of the lasers of this unit, increasing.
#[must_use]
pub fn vertical_angles_rad() -> Vec<f64> {
    KITTI_DEG.iter().map(|[vertical, _]| vertical.to_radians()).collect()
}

/// The revolutions' pictures, in order of name.
fn pictures(folder: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let listed = std::fs::read_dir(folder).map_err(|_| ImportError::Absent { path: folder.to_owned(), hint: HINT })?;
    let mut files: Vec<PathBuf> = listed
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "png"))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(ImportError::TooShort { file: folder.to_owned(), needed: 1, found: 0 });
    }
    Ok(files)
}

/// All firings in order of time; a firing's time is its place in the turn.
fn firings(files: &[PathBuf]) -> Result<Firings, ImportError> {
    let lasers = KITTI_DEG.len();
    let mut firings = Firings { range_2mm: vec![Vec::new(); lasers], ..Firings::default() };
    for (turn, file) in files.iter().enumerate() {
        let [rows @ .., encoder] = &picture(file)?;
        let shares = shares(file, encoder)?;
        // Where the unit looked back: there the revolution began.
        let began = shares.partition_point(|share| *share < 0.5);
        let in_time = |column: usize| (column + began) % encoder.len();
        let mut latest_s = firings.t_s.last().copied().unwrap_or(0.0);
        for column in (0..encoder.len()).map(in_time) {
            let passed = if column < began { shares[column] + 0.5 } else { shares[column] - 0.5 };
            latest_s = latest_s.max((turn as f64 + passed) * TURN_S);
            firings.t_s.push(latest_s);
            firings.encoder_cdeg.push(encoder[column]);
        }
        for (all, row) in firings.range_2mm.iter_mut().zip(rows) {
            all.extend((0..encoder.len()).map(|column| row[in_time(column)]));
        }
    }
    Ok(firings)
}

/// How far the unit has turned from ahead on at each column, in turns. The first may look a little to the left of ahead, the last a
/// little to the right.
fn shares(file: &Path, encoder: &[u16]) -> Result<Vec<f64>, ImportError> {
    let mut shares = Vec::with_capacity(encoder.len());
    for (column, &angle) in encoder.iter().enumerate() {
        if angle >= ENCODER_STEPS {
            let rule = "must be an angle in 0..36000 hundredths of a degree";
            return Err(value(file, column, rule, u32::from(angle)));
        }
        let share = f64::from(angle) / f64::from(ENCODER_STEPS);
        shares.push(match column < encoder.len() / 2 {
            true if share > 0.75 => share - 1.0,
            false if share < 0.25 => share + 1.0,
            _ => share,
        });
    }
    Ok(shares)
}

/// The rows of one picture: 64 of ranges and one of angles.
fn picture(file: &Path) -> Result<[Vec<u16>; 65], ImportError> {
    let unreadable = |why: String| ImportError::Unreadable { file: file.to_owned(), why };
    let open = File::open(file).map_err(|error| unreadable(error.to_string()))?;
    let mut reader =
        png::Decoder::new(BufReader::new(open)).read_info().map_err(|error| unreadable(error.to_string()))?;
    let info = reader.info();
    let (width, height) = (info.width, info.height);
    if info.color_type != png::ColorType::Grayscale || info.bit_depth != png::BitDepth::Sixteen || info.interlaced {
        return Err(unreadable("a picture of firings is 16-bit grey, not interlaced".to_owned()));
    }
    if height != 65 || !(1..=MOST_COLUMNS).contains(&width) {
        let why = format!("a picture of firings has 65 rows and 1 to {MOST_COLUMNS} columns, not {height} and {width}");
        return Err(unreadable(why));
    }
    let mut rows = [(); 65].map(|()| Vec::with_capacity(width as usize));
    for row in &mut rows {
        let bytes = reader.next_row().map_err(|error| unreadable(error.to_string()))?;
        let bytes = bytes.ok_or_else(|| unreadable("the picture breaks off".to_owned()))?;
        row.extend(bytes.data().chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])));
    }
    Ok(rows)
}

fn value(file: &Path, column: usize, rule: &'static str, found: u32) -> ImportError {
    let (file, line) = (file.to_owned(), column as u64 + 1);
    ImportError::Value { file, line, column: "encoder".to_owned(), rule, found: found.to_string() }
}

/// The unit's poses at the revolutions' beginnings.
fn track(file: &Path, lever: Lever) -> Result<Vec<TruePose>, ImportError> {
    let rows = words::read(file, OXTS)?;
    let moving = |(turn, (_, row)): (usize, &(u64, [f64; 30]))| Moving {
        t_s: turn as f64 * TURN_S,
        v_m_per_s: row[VF],
        omega_rad_per_s: row[WU],
    };
    let moving: Vec<Moving> = rows.iter().enumerate().map(moving).collect();
    Ok(lever.end(&added_up(&moving), &moving))
}
