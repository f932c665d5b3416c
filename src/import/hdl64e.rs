//! A capture of a Velodyne HDL-64E as the network carried it: a pcap file of its data packets, as of any car with such a scanner.
//!
//! What a capture does not say is taken from the unit on KITTI's car, of the same make: which of its lasers is which, and the vertical
//! angle of each. The horizontal angles are left for learning.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

use asami_dataset::firings::ENCODER_STEPS;
use asami_dataset::log::Velodyne;
use asami_dataset::packets::{self, Order, Start, Tally};
use asami_dataset::{Dataset, Firings, Known, Log, Truth};

use super::av21::find;
use super::kitti::vertical_angles_rad;
use super::{ImportError, Imported, Importer, Read};

/// The importer's row in the list.
pub static IMPORTER: Importer = Importer {
    name: "hdl64e-pcap",
    what: "Raw data packets of a Velodyne HDL-64E (a .pcap file).",
    source: "any capture of the unit's UDP packets; the manual of the Velodyne HDL-64E S2 and S3",
    read: Read::One(read),
};

const HINT: &str = "it is a capture of a Velodyne HDL-64E, a .pcap file, or a folder with one";
/// Of a scanner on the roof of a car: a capture does not say.
const SENSOR_HEIGHT_M: f64 = 1.73;

/// Reads the capture at `source`, a file or the folder that holds one.
///
/// # Errors
/// [`ImportError`] where there is no such capture, or for the first packet that a sound one does not hold.
pub fn read(source: &Path) -> Result<Imported, ImportError> {
    let file = find(source, HINT, |name| name.ends_with(".pcap"))?;
    let unreadable = |why: String| ImportError::Unreadable { file: file.clone(), why };
    let open = File::open(&file).map_err(|error| unreadable(error.to_string()))?;
    let (firings, tally) = packets::read(BufReader::new(open), &Order::UPPER_ABOVE, Start::FirstPacket)
        .map_err(|error| unreadable(error.to_string()))?;
    if firings.len() < 2 {
        return Err(ImportError::TooShort { file, needed: 2, found: firings.len() });
    }
    let mut notes = vec![
        "assumed: times count from the first data packet".to_owned(),
        "assumed: lasers are numbered, and look up and down, as those of KITTI's HDL-64E S2".to_owned(),
        format!("assumed: the sensor is {SENSOR_HEIGHT_M} m over the ground"),
        format!("found: {} firings of {} lasers", firings.len(), firings.lasers()),
    ];
    notes.extend(in_words(&tally));
    let [firing_rate_hz, turn_rate_hz] = rates_hz(&firings);
    let velodyne = Velodyne {
        vertical_angles_rad: vertical_angles_rad(),
        firing_rate_hz,
        turn_rate_hz,
        sensor_height_m: SENSOR_HEIGHT_M,
        left_m: Vec::new(),
        up_m: Vec::new(),
    };
    let known = Known { robot: "car".to_owned(), velodyne: Some(velodyne), ..Known::default() };
    let log = Log { known: known.into(), firings: Some(Arc::new(firings)), ..Log::default() };
    Ok(Imported { dataset: Dataset { log, truth: Truth::default(), provenance: None }, notes })
}

/// What a capture held and lacks, a sentence each.
fn in_words(tally: &Tally) -> Vec<String> {
    let Tally { packets, skipped, gaps, lost_packets, jumps } = tally;
    vec![
        format!("found: {packets} data packets, {skipped} others passed over"),
        format!(
            "found: {lost_packets} data packets missing in {gaps} gaps, and {jumps} jumps of the encoder beside them"
        ),
    ]
}

/// Firings and turns a second.
fn rates_hz(firings: &Firings) -> [f64; 2] {
    let lasts_s = firings.t_s.last().zip(firings.t_s.first()).map_or(0.0, |(last, first)| last - first);
    let turn = i32::from(ENCODER_STEPS);
    let step = |pair: &[u16]| f64::from((i32::from(pair[1]) - i32::from(pair[0])).rem_euclid(turn));
    let turned = firings.encoder_cdeg.windows(2).map(step).fold(0.0, |sum, step| sum + step) / f64::from(turn);
    let rate = |count: f64| if lasts_s > 0.0 { count / lasts_s } else { 0.0 };
    [rate(firings.len() as f64 - 1.0), rate(turned)]
}
