//! What a laser scanner sees: Figures 2.4b and 5.2 of Stronger (2008), and a turn as the lasers measured it.

use asami_dataset::Log;
use asami_dataset::firings::RANGE_STEP_M;
use asami_learners::lidar::{Drive, Scan};

use super::Plate;
use crate::draw::Picture;

/// From one scan of Figure 5.2 to the other.
const APART_S: f64 = 0.5;
/// Side of the square in Figure 5.2.
const SIDE_M: f64 = 300.0;
/// Lower points, of the ground, are left out of it.
const LOWEST_M: f64 = -1.0;
const SIDE_PX: usize = 680;

/// Figure 2.4b looks at so much to each side, from behind and above.
const ACROSS_M: f64 = 45.0;
const WIDE_PX: usize = 900;
const HIGH_PX: usize = 460;

/// Ranges from here on are white in the picture of a turn, and this near black.
const FAR_M: f64 = 80.0;
const NEAR_M: f64 = 2.0;
/// Rows of pixels a laser.
const ROWS: usize = 4;

const RED: [u8; 3] = [200, 40, 40];
const BLUE: [u8; 3] = [40, 70, 200];
const BLACK: [u8; 3] = [0, 0, 0];

/// Pictures of the scans in the midst of `log`, with lasers that look along `angles_rad`; none of a log without them.
#[must_use]
pub fn plates(log: &Log, angles_rad: &[f64]) -> Vec<Plate> {
    let Ok(drive) = Drive::try_from(log) else { return Vec::new() };
    let scans = drive.scans(APART_S);
    let Some([first, second]) = scans.get(scans.len().saturating_sub(2) / 2..).and_then(|rest| rest.first_chunk())
    else {
        return Vec::new();
    };
    let pictures = [points(&drive, first, angles_rad), two(&drive, [first, second], angles_rad), turn(&drive, first)];
    pictures.iter().map(Plate::from).collect()
}

/// White pixels that points are drawn on.
struct Canvas {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self { width, height, rgb: vec![255; 3 * width * height] }
    }

    fn dot(&mut self, x: f64, y: f64, colour: [u8; 3]) {
        if (0.0..self.width as f64).contains(&x) && (0.0..self.height as f64).contains(&y) {
            let at = 3 * (y as usize * self.width + x as usize);
            self.rgb[at..at + 3].copy_from_slice(&colour);
        }
    }

    fn picture(self, name: &str, title: &str) -> Picture {
        Picture::new(name, title, self.width as u32, self.height as u32, self.rgb).magnified(1)
    }
}

/// Figure 2.4b: the points of a turn from behind and above, the farthest first.
fn points(drive: &Drive<'_>, scan: &Scan, angles_rad: &[f64]) -> Picture {
    let mut seen: Vec<[f64; 3]> = Vec::new();
    drive.returns(scan, angles_rad, f64::NEG_INFINITY, |_, _, point| seen.push(point));
    seen.sort_by(|a, b| b[1].total_cmp(&a[1]));
    let mut canvas = Canvas::new(WIDE_PX, HIGH_PX);
    let px_per_m = WIDE_PX as f64 / (2.0 * ACROSS_M);
    for [x, y, z] in seen {
        // A parallel projection: depth is seen at two fifths, height at nine tenths of its size.
        let (across, up) = (x * px_per_m, (0.4 * y + 0.9 * z) * px_per_m);
        canvas.dot(WIDE_PX as f64 / 2.0 + across, 0.55 * HIGH_PX as f64 - up, by_height(z));
    }
    canvas.picture("Figure 2.4b", "The points of one turn").caption(
        "All returns of one turn of the unit, seen from behind and above; colour is height, from the road (blue) to roofs (red). \
         Good: circles on the road about the car, and upright walls. Circles that wobble from laser to laser are angles that \
         are wrong.",
    )
}

/// From blue, two metres under the sensor, to red, four metres over it.
fn by_height(z_m: f64) -> [u8; 3] {
    let share = ((z_m + 2.0) / 6.0).clamp(0.0, 1.0);
    let mix = |low: u8, high: u8| (f64::from(low) + share * (f64::from(high) - f64::from(low))) as u8;
    [mix(BLUE[0], RED[0]), mix(BLUE[1], RED[1]), mix(BLUE[2], RED[2])]
}

/// Figure 5.2: two scans from above, each where the sensor saw it.
fn two(drive: &Drive<'_>, scans: [&Scan; 2], angles_rad: &[f64]) -> Picture {
    let mut canvas = Canvas::new(SIDE_PX, SIDE_PX);
    let (px_per_m, middle) = (SIDE_PX as f64 / SIDE_M, SIDE_PX as f64 / 2.0);
    for (scan, colour) in scans.into_iter().zip([RED, BLUE]) {
        drive.returns(scan, angles_rad, LOWEST_M, |_, _, [x, y, _]| {
            canvas.dot(middle + px_per_m * x, middle - px_per_m * y, colour);
        });
    }
    for i in -6..=6 {
        let along = f64::from(i);
        canvas.dot(middle + along, middle + along, BLACK);
        canvas.dot(middle + along, middle - along, BLACK);
    }
    canvas.picture("Figure 5.2", "Two scans, half a second apart").caption(
        "The earlier (red) and the later (blue) from above, each as the sensor, the black cross, saw it; 300 m a side, points of the \
         ground left out. What brings the one onto the other is how the car moved.",
    )
}

/// A turn as the lasers measured it: a column a firing, a row a laser, the highest on top.
fn turn(drive: &Drive<'_>, scan: &Scan) -> Picture {
    let columns = scan.end - scan.first;
    let mut canvas = Canvas::new(columns, ROWS * drive.lasers());
    for (laser, ranges) in drive.firings.range_2mm.iter().rev().enumerate() {
        for (column, steps) in ranges[scan.first..scan.end].iter().enumerate() {
            for row in 0..ROWS {
                canvas.dot(column as f64, (ROWS * laser + row) as f64, by_range(f64::from(*steps) * RANGE_STEP_M));
            }
        }
    }
    canvas.picture("A turn", "One turn as the lasers measured it").caption(
        "Ranges by laser (the highest on top) and firing, near ones dark; red is no return. Rows are jagged against each other: \
         each laser looks along a horizontal angle of its own, and how far the rows must be shifted to fit is what section 5.1 \
         learns.",
    )
}

fn by_range(range_m: f64) -> [u8; 3] {
    if range_m <= 0.0 {
        return RED;
    }
    let share = ((range_m / NEAR_M).ln() / (FAR_M / NEAR_M).ln()).clamp(0.0, 1.0);
    [(255.0 * share) as u8; 3]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;
    use std::sync::Arc;

    use asami_dataset::log::Velodyne;
    use asami_dataset::{Firings, Known};

    use super::*;

    /// Three turns a second apart of two lasers that see a wall all around, 10 m away.
    fn log() -> Log {
        let firings: Vec<usize> = (0..3 * 360).collect();
        let velodyne = Velodyne {
            vertical_angles_rad: vec![-0.1, 0.0],
            firing_rate_hz: 360.0,
            turn_rate_hz: 1.0,
            sensor_height_m: 2.0,
            left_m: Vec::new(),
            up_m: Vec::new(),
        };
        let firings = Firings {
            t_s: firings.iter().map(|i| *i as f64 / 360.0).collect(),
            encoder_cdeg: firings.iter().map(|i| (i % 360 * 100) as u16).collect(),
            range_2mm: vec![vec![5000; firings.len()]; 2],
            intensity: Vec::new(),
        };
        let known = Known { velodyne: Some(velodyne), ..Known::default() };
        Log { known: known.into(), firings: Some(Arc::new(firings)), ..Log::default() }
    }

    #[test]
    fn a_round_wall_is_a_circle() {
        let log = log();
        let drive = Drive::try_from(&log).unwrap();
        let scans = drive.scans(APART_S);
        let picture = two(&drive, [&scans[0], &scans[1]], &[FRAC_PI_2; 2]);
        let mut expected = Canvas::new(SIDE_PX, SIDE_PX);
        let (px_per_m, middle) = (SIDE_PX as f64 / SIDE_M, SIDE_PX as f64 / 2.0);
        expected.dot(middle, middle - 10.0 * px_per_m, BLUE);
        let at = expected.rgb.iter().position(|byte| *byte != 255).unwrap();
        let drawn = picture.rgb();
        assert_eq!(drawn[at..at + 3], BLUE);
        let radius = |i: usize| {
            let (x, y) = ((i % SIDE_PX) as f64 - middle, (i / SIDE_PX) as f64 - middle);
            x.hypot(y) / px_per_m
        };
        let blue = drawn.chunks(3).enumerate().filter(|(_, pixel)| *pixel == BLUE).map(|(i, _)| radius(i));
        assert!(blue.clone().count() > 100 && blue.into_iter().all(|r| (r - 10.0).abs() < 0.7));
        assert_eq!(plates(&log, &[FRAC_PI_2; 2]).len(), 3);
    }

    #[test]
    fn a_log_without_firings_has_no_pictures() {
        assert!(plates(&Log::default(), &[]).is_empty());
    }
}
