//! What the methods of chapter 5 read of a log with laser firings.

use asami_dataset::firings::{ENCODER_STEP_RAD, ENCODER_STEPS, RANGE_STEP_M};
use asami_dataset::{Firings, Log};
use asami_math::elementary::sin_cos;

use crate::CannotScan;

/// Firings that fit together, and the elevations of their lasers.
#[derive(Clone, Debug)]
pub struct Drive<'a> {
    /// What was fired.
    pub firings: &'a Firings,
    /// Sine and cosine of each laser's vertical angle.
    pub elevation: Vec<(f64, f64)>,
    /// How far each stands to the left of where it looks, and up; empty: all stand where they are thought to meet.
    pub places_m: Vec<[f64; 2]>,
    /// How far the unit turns clockwise from one firing to the next, on average.
    pub step_rad: f64,
    /// The encoder's angle with whole turns counted, in hundredths of a degree; one per firing.
    pub turned_cdeg: Vec<i64>,
}

/// A full turn of the unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scan {
    /// When it begins.
    pub t_s: f64,
    /// Its first firing.
    pub first: usize,
    /// One past its last.
    pub end: usize,
}

impl<'a> TryFrom<&'a Log> for Drive<'a> {
    type Error = CannotScan;

    fn try_from(log: &'a Log) -> Result<Self, CannotScan> {
        let firings = log.firings.as_deref().filter(|firings| !firings.is_empty()).ok_or(CannotScan::NoFirings)?;
        firings.check()?;
        let known = log.known.velodyne.as_ref().map_or(&[][..], |unit| &unit.vertical_angles_rad);
        if known.len() != firings.lasers() || known.iter().any(|angle| !angle.is_finite()) {
            return Err(CannotScan::UnknownLasers { found: firings.lasers(), known: known.len() });
        }
        let turned_cdeg = turned(&firings.encoder_cdeg);
        let step_rad = step_cdeg(&turned_cdeg) * ENCODER_STEP_RAD;
        if step_rad <= 0.0 {
            return Err(CannotScan::TooShort { found: firings.len(), needed: usize::from(ENCODER_STEPS) / 46 });
        }
        let elevation = known.iter().map(|angle| sin_cos(*angle)).collect();
        Ok(Self { firings, elevation, places_m: places_m(log), step_rad, turned_cdeg })
    }
}

/// Where the lasers stand, as far as that is known.
fn places_m(log: &Log) -> Vec<[f64; 2]> {
    let Some(unit) = &log.known.velodyne else { return Vec::new() };
    let of = |places: &[f64], laser: usize| places.get(laser).copied().unwrap_or(0.0);
    let count = unit.left_m.len().max(unit.up_m.len());
    (0..count).map(|laser| [of(&unit.left_m, laser), of(&unit.up_m, laser)]).collect()
}

/// The encoder's angle with turns counted; it never turns back.
fn turned(encoder_cdeg: &[u16]) -> Vec<i64> {
    let turn = i64::from(ENCODER_STEPS);
    let mut total = encoder_cdeg.first().map_or(0, |first| i64::from(*first));
    let mut before = total;
    encoder_cdeg
        .iter()
        .map(|now| {
            let now = i64::from(*now);
            total += (now - before).rem_euclid(turn);
            before = now;
            total
        })
        .collect()
}

/// Mean advance of the encoder a firing, jumps over lost firings left out; 0 where it does not turn.
fn step_cdeg(turned_cdeg: &[i64]) -> f64 {
    let steps: Vec<i64> = turned_cdeg.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = steps.clone();
    sorted.sort_unstable();
    let Some(&usual) = sorted.get(sorted.len() / 2) else { return 0.0 };
    let (n, sum) =
        steps.iter().filter(|step| **step <= 4 * usual).fold((0i64, 0i64), |(n, sum), step| (n + 1, sum + step));
    sum as f64 / n.max(1) as f64
}

impl Drive<'_> {
    /// How far a laser stands to the left of where it looks, and up.
    #[must_use]
    pub fn place_m(&self, laser: usize) -> [f64; 2] {
        self.places_m.get(laser).copied().unwrap_or_default()
    }

    /// How many lasers there are.
    #[must_use]
    pub fn lasers(&self) -> usize {
        self.firings.lasers()
    }

    /// Firings in an angle, rounded up; never more than there are.
    #[must_use]
    pub fn firings_in(&self, angle_rad: f64) -> usize {
        ((angle_rad / self.step_rad).ceil().max(0.0) as usize).min(self.firings.len())
    }

    /// Full turns that begin `every_s` apart (every turn, if 0 or shorter than one). A turn that the log cuts off is left out.
    #[must_use]
    pub fn scans(&self, every_s: f64) -> Vec<Scan> {
        let (times, mut scans) = (&self.firings.t_s, Vec::new());
        let (Some(&start_s), mut first) = (times.first(), 0) else { return scans };
        while first < times.len() {
            let ends_at = self.turned_cdeg[first] + i64::from(ENCODER_STEPS);
            let end = self.turned_cdeg.partition_point(|turned| *turned < ends_at);
            if end >= times.len() && self.turned_cdeg[times.len() - 1] + 200 < ends_at {
                break;
            }
            scans.push(Scan { t_s: times[first], first, end });
            // Times are counted from the start: rounding does not add up.
            let next = if every_s > 0.0 {
                let passed = ((times[first] - start_s) / every_s + 1e-6).floor() + 1.0;
                times.partition_point(|t| *t < start_s + passed * every_s - 1e-9)
            } else {
                end
            };
            first = next.max(if every_s > 0.0 { first + 1 } else { end.max(first + 1) });
        }
        scans
    }

    /// Calls `with` for every return of some firings of which the height over the sensor is `lowest_m` or more: the laser, the
    /// firing, and the point's x, y and z in a frame at the sensor in which laser l looks along `angles_rad[l]` at
    /// encoder angle 0 (eq. 2.35).
    pub fn returns(
        &self,
        scan: &Scan,
        angles_rad: &[f64],
        lowest_m: f64,
        mut with: impl FnMut(usize, usize, [f64; 3]),
    ) {
        let turns: Vec<(f64, f64)> = (scan.first..scan.end)
            .map(|i| sin_cos(-f64::from(self.firings.encoder_cdeg[i]) * ENCODER_STEP_RAD))
            .collect();
        for (laser, (ranges, (angle_rad, (rise, reach)))) in
            self.firings.range_2mm.iter().zip(angles_rad.iter().zip(&self.elevation)).enumerate()
        {
            let (sin_l, cos_l) = sin_cos(*angle_rad);
            let [left, up] = self.place_m(laser);
            for (i, (&steps, (sin_r, cos_r))) in ranges[scan.first..scan.end].iter().zip(&turns).enumerate() {
                let d = f64::from(steps) * RANGE_STEP_M;
                let z = up + d * rise;
                if steps > 0 && z >= lowest_m {
                    let flat = d * reach;
                    let (ahead_x, ahead_y) = (cos_l * cos_r - sin_l * sin_r, sin_l * cos_r + cos_l * sin_r);
                    let (x, y) = (flat * ahead_x - left * ahead_y, flat * ahead_y + left * ahead_x);
                    with(laser, scan.first + i, [x, y, z]);
                }
            }
        }
    }
}
