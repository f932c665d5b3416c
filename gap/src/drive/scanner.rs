//! Whether a scanner agrees with itself: numbers that each of its faults moves in a way of its own.
//!
//! A log is cut into segments of [`SEGMENT_S`]; of each, its scans give the [`STATISTICS`]. The ground under all lasers
//! tells how the base leans and where single lasers point ([`super::ground`]), walls that neighbouring lasers see tell
//! ranges and places of lasers ([`super::walls`]), and the rest is counted here.

use asami_dataset::firings::{ENCODER_STEPS, RANGE_STEP_M};
use asami_math::elementary::{cos, ln};
use asami_scans::{Drive, Scan};

use super::ground::Ground;
use super::motion::{Moved, Step};
use super::walls::Walls;

/// Length of a segment.
pub const SEGMENT_S: f64 = 20.0;

/// What is told of each segment, and the channel that it belongs to.
pub const STATISTICS: [(&str, &str); COUNT] = [
    ("spin rate", "timing"),
    ("steps at the turn's seam", "timing"),
    ("pitch", "lidar_angle"),
    ("roll", "lidar_angle"),
    ("height", "lidar_angle"),
    ("cone", "lidar_angle"),
    ("ranges on the ground", "lidar_range"),
    ("angles laser by laser", "lidar_angle"),
    ("near ranges laser by laser", "lidar_range"),
    ("walls laser by laser", "lidar_range"),
    ("sides laser by laser", "lidar_angle"),
    ("noise", "lidar_range"),
    ("losses", "detection"),
    ("things in the other lane", "detection"),
    ("step between the banks", "lidar_angle"),
];

/// How many statistics there are.
pub const COUNT: usize = 15;

/// Which of them are logarithms of what grows with an effect's size.
pub const IN_LOGARITHMS: [bool; COUNT] =
    [false, false, false, false, false, false, false, true, true, true, false, true, true, true, false];

/// The flexible block in which each would show an effect that is in nobody's list, and by how much.
pub const BLOCKS: [(&str, f64); COUNT] = [
    ("sensor", 0.01),
    ("timing", 0.3),
    ("sensor", 0.01),
    ("sensor", 0.01),
    ("sensor", 0.02),
    ("sensor", 0.005),
    ("sensor", 0.05),
    ("sensor", 2.5),
    ("sensor", 2.5),
    ("sensor", 1.5),
    ("sensor", 0.02),
    ("noise", 0.5),
    ("noise", 1.5),
    ("noise", 1.5),
    ("sensor", 0.02),
];

/// One segment's statistics; no number where the segment did not show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// When it ends.
    pub t_s: f64,
    /// In the order of [`STATISTICS`].
    pub values: [f64; COUNT],
}

/// The segments of a log; what is left over at its end is less than half of one, or part of the last.
#[must_use]
pub fn segments(moved: &Moved<'_>, turn_rate_hz: f64, height_m: f64) -> Vec<Segment> {
    let times = &moved.drive.firings.t_s;
    let (Some(first_s), Some(last_s)) = (times.first(), times.last()) else { return Vec::new() };
    let count = (((last_s - first_s) / SEGMENT_S).round() as usize).max(1);
    let ends_s = |i: usize| if i == count { last_s + 1.0 } else { first_s + i as f64 * SEGMENT_S };
    let segment = |i: usize| {
        let span_s = ends_s(i)..ends_s(i + 1);
        Segment { t_s: span_s.end.min(*last_s), values: values(moved, span_s, turn_rate_hz, height_m) }
    };
    (0..count).map(segment).collect()
}

fn values(moved: &Moved<'_>, span_s: std::ops::Range<f64>, turn_rate_hz: f64, height_m: f64) -> [f64; COUNT] {
    let drive = &moved.drive;
    let scans: Vec<&Scan> = moved.scans.iter().filter(|scan| span_s.contains(&scan.t_s)).collect();
    let (mut ground, mut walls, mut counts) = (Ground::new(drive, height_m), Walls::new(drive), Counts::default());
    for scan in &scans {
        let plane = ground.take(moved, scan);
        walls.take(moved, scan, speed(&moved.steps, scan.t_s));
        counts.take(drive, scan);
        if let Some(plane) = plane {
            counts.look_left(moved, scan, &plane, turning(&moved.steps, scan.t_s));
        }
    }
    let firings = drive.firings.within(&span_s);
    let [pitch, roll, height] = ground.posture();
    let [cone, on_ground, angles, near, banks] = ground.lasers();
    let [on_walls, sides] = walls.lasers();
    [
        spin(drive, firings.clone(), turn_rate_hz),
        seam(moved, firings),
        pitch,
        roll,
        height,
        cone,
        on_ground,
        angles,
        near,
        on_walls,
        sides,
        counts.noise(),
        counts.losses(),
        counts.on_the_left(),
        banks,
    ]
}

/// Speed at a time, in straight lines between means.
pub(crate) fn speed(steps: &[Step], t_s: f64) -> f64 {
    let after = steps.partition_point(|step| step.t_s + 0.5 * step.dt_s <= t_s);
    let of = |i: usize| steps.get(i).map(|step| (step.t_s + 0.5 * step.dt_s, step.v_m_per_s));
    match (after.checked_sub(1).and_then(of), of(after)) {
        (Some((a_s, a)), Some((b_s, b))) => a + (b - a) * (t_s - a_s) / (b_s - a_s).max(1e-9),
        (Some((_, v)), None) | (None, Some((_, v))) => v,
        (None, None) => 0.0,
    }
}

/// Turning rate at a time.
fn turning(steps: &[Step], t_s: f64) -> f64 {
    let after = steps.partition_point(|step| step.t_s <= t_s);
    steps.get(after.saturating_sub(1)).map_or(0.0, |step| step.omega_rad_per_s)
}

/// Logarithm of the turning rate over the one that is set.
fn spin(drive: &Drive<'_>, firings: std::ops::Range<usize>, turn_rate_hz: f64) -> f64 {
    if firings.len() < 2 {
        return f64::NAN;
    }
    let (first, last) = (firings.start, firings.end - 1);
    let turns = (drive.turned_cdeg[last] - drive.turned_cdeg[first]) as f64 / f64::from(ENCODER_STEPS);
    ln(turns / (drive.firings.t_s[last] - drive.firings.t_s[first]) / turn_rate_hz)
}

/// Share of the motion during a turn by which ranges jump where one turn ends and the next begins.
fn seam(moved: &Moved<'_>, firings: std::ops::Range<usize>) -> f64 {
    let drive = &moved.drive;
    let turn = i64::from(ENCODER_STEPS);
    let turned = &drive.turned_cdeg;
    let (mut products, mut squares) = (0.0, 0.0);
    for i in firings.start.max(2)..firings.end.min(turned.len().saturating_sub(1)) {
        if turned[i].div_euclid(turn) == turned[i - 1].div_euclid(turn) {
            continue;
        }
        let v = speed(&moved.steps, drive.firings.t_s[i]);
        if v < 1.0 {
            continue;
        }
        // A turn takes as long as so many firings.
        let lasts_s = std::f64::consts::TAU / drive.step_rad * (drive.firings.t_s[i] - drive.firings.t_s[i - 1]);
        for (laser, ranges) in drive.firings.range_2mm.iter().enumerate() {
            let r = [i - 2, i - 1, i, i + 1].map(|k| f64::from(ranges[k]) * RANGE_STEP_M);
            if r.contains(&0.0) || r[1] * drive.elevation[laser].0 < -1.0 {
                continue;
            }
            let (before, step, after) = (r[1] - r[0], r[2] - r[1], r[3] - r[2]);
            let jump = step - 0.5 * (before + after);
            if before.abs() < 0.1 && after.abs() < 0.1 && jump.abs() < 1.2 {
                let expected = -v * lasts_s * cos(moved.angles_rad[laser]) * drive.elevation[laser].1;
                products += jump * expected;
                squares += expected * expected;
            }
        }
    }
    if squares > 1.0 { products / squares } else { f64::NAN }
}

/// What is counted.
#[derive(Default)]
struct Counts {
    second_differences_m: f64,
    differences: usize,
    lost: usize,
    held: usize,
    straight: usize,
    left: usize,
}

/// Ground and walls within this are dense enough to judge single returns by those beside them.
const NEAR_M: f64 = 10.0;
/// Second differences of ranges beyond this are of edges.
const ROUGH_M: f64 = 0.15;

impl Counts {
    fn take(&mut self, drive: &Drive<'_>, scan: &Scan) {
        for ranges in &drive.firings.range_2mm {
            let ranges = &ranges[scan.first..scan.end];
            for (k, three) in ranges.windows(3).enumerate() {
                let [a, b, c] = [three[0], three[1], three[2]].map(|r| f64::from(r) * RANGE_STEP_M);
                if a == 0.0 || c == 0.0 || a > 3.0 * NEAR_M || (a - c).abs() > 0.3 {
                    continue;
                }
                self.held += 1;
                if b == 0.0 {
                    self.lost += 1;
                } else if a < NEAR_M && k % 7 == 0 {
                    self.second_differences_m += (a - 2.0 * b + c).abs().min(ROUGH_M);
                    self.differences += 1;
                }
            }
        }
    }

    /// Returns from where cars come the other way, between bumper and roof.
    fn look_left(&mut self, moved: &Moved<'_>, scan: &Scan, plane: &[f64; 4], turning_rad_per_s: f64) {
        // In a corner it is the pavement that lies there.
        if turning_rad_per_s.abs() > 0.03 {
            return;
        }
        self.straight += 1;
        moved.drive.returns(scan, &moved.angles_rad, -2.0, |_, _, [x, y, z]| {
            if x.abs() < 25.0 && (1.1..2.9).contains(&y) {
                let above_m = z - (plane[0] + plane[1] * x + plane[2] * y + plane[3] * x * x);
                self.left += usize::from((0.4..1.6).contains(&above_m));
            }
        });
    }

    /// Logarithm of the mean second difference of ranges.
    fn noise(&self) -> f64 {
        if self.differences < 100 {
            f64::NAN
        } else {
            ln((self.second_differences_m / self.differences as f64).max(1e-4))
        }
    }

    /// Log-odds of a return's being lost where those beside it are not.
    fn losses(&self) -> f64 {
        if self.held < 1000 {
            return f64::NAN;
        }
        ln((self.lost as f64 + 0.5) / ((self.held - self.lost) as f64 + 0.5))
    }

    fn on_the_left(&self) -> f64 {
        if self.straight < 5 { f64::NAN } else { ln(1.0 + self.left as f64 / self.straight as f64) }
    }
}
