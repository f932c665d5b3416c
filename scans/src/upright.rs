//! What stands up, and what lies: the ground, seen as rings about the sensor, goes with the car.

use asami_dataset::firings::RANGE_STEP_M;
use asami_math::angle::wrap_rad;

use crate::drive::Drive;

/// Tells returns of surfaces that stand from those of the ground by what the lasers above and below see the same way.
///
/// A limit on heights does not do it: where a car brakes or pulls away it pitches, and the ground farther off comes up to the sensor's
/// height. Its rings would have scans matched as if the car stood still.
#[derive(Debug)]
pub(crate) struct Upright<'a> {
    drive: &'a Drive<'a>,
    /// Of each laser the next lower and the next higher, and how many firings later they look its way.
    beside: Vec<[Option<(usize, i64)>; 2]>,
    least_slope: f64,
}

impl<'a> Upright<'a> {
    /// Of surfaces with a slope of at least `least_slope`, as its tangent; `None` for 0, where all are.
    pub(crate) fn new(drive: &'a Drive<'a>, angles_rad: &[f64], least_slope: f64) -> Option<Self> {
        if least_slope <= 0.0 {
            return None;
        }
        let mut rising: Vec<usize> = (0..angles_rad.len().min(drive.elevation.len())).collect();
        rising.sort_by(|a, b| drive.elevation[*a].0.total_cmp(&drive.elevation[*b].0));
        let mut beside = vec![[None; 2]; rising.len()];
        for pair in rising.windows(2) {
            let later = |from: usize, to: usize| {
                let off_rad = wrap_rad(angles_rad[to] - angles_rad[from]);
                (to, (off_rad / drive.step_rad).round() as i64)
            };
            beside[pair[1]][0] = Some(later(pair[1], pair[0]));
            beside[pair[0]][1] = Some(later(pair[0], pair[1]));
        }
        Some(Self { drive, beside, least_slope })
    }

    /// Whether a return, so far off over the ground and so high over the sensor, and that of a neighbour are of a surface that stands.
    pub(crate) fn stands(&self, laser: usize, firing: usize, flat_m: f64, z_m: f64) -> bool {
        self.beside[laser].iter().flatten().any(|(other, later)| {
            let at = usize::try_from(firing as i64 + later).ok();
            let steps = at.and_then(|at| self.drive.firings.range_2mm[*other].get(at)).copied().unwrap_or(0);
            let (rise, reach) = self.drive.elevation[*other];
            let range_m = f64::from(steps) * RANGE_STEP_M;
            let (across_m, up_m) = (range_m * reach - flat_m, self.drive.place_m(*other)[1] + range_m * rise - z_m);
            steps > 0 && up_m.abs() >= self.least_slope * across_m.abs()
        })
    }
}
