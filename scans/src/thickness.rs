//! How thick surfaces are in a scan, and how far the next one lies off them: measures of how well lasers agree that no calibration
//! here is made by.

use std::collections::BTreeMap;

use asami_math::rigid::Rigid;
use nalgebra::{Matrix3, Vector3};

use crate::drive::{Drive, Scan};

/// Side of the cubes that are looked at.
const CUBE_M: f64 = 0.5;
/// Farther returns are too few.
const FARTHEST_M: f64 = 25.0;
/// Points, and lasers, that make a surface.
const LEAST: (usize, usize) = (12, 3);
/// A normal that is upright by more is of something flat, one that is by less of something upright.
const UPRIGHT: (f64, f64) = (0.9, 0.3);

/// Medians over cubes of the standard deviation across the plane through a cube's points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thickness {
    /// Of the ground and what else lies flat.
    pub flat_m: f64,
    /// Of walls.
    pub upright_m: f64,
}

/// The thickness of surfaces, each turn by itself, laser l looking along `angles_rad[l]` at encoder angle 0: the mean plane variance of
/// Razlaw, Droeschel, Holz and Behnke (2015), as a median. `None` where no surface shows.
#[must_use]
pub fn thickness(drive: &Drive<'_>, scans: &[Scan], angles_rad: &[f64]) -> Option<Thickness> {
    let (mut flat, mut upright) = (Vec::new(), Vec::new());
    for scan in scans {
        for points in cubes(drive, scan, angles_rad).into_values() {
            let Some(Plane { normal, sd_m, .. }) = plane(&points) else { continue };
            if normal.z.abs() > UPRIGHT.0 {
                flat.push(sd_m);
            } else if normal.z.abs() < UPRIGHT.1 {
                upright.push(sd_m);
            }
        }
    }
    let median = |values: &[f64]| asami_math::statistics::median(values);
    Some(Thickness { flat_m: median(&flat)?, upright_m: median(&upright)? })
}

/// How far the points of a turn lie off the planes through an earlier one's, the sensor having moved by `motion` on the plane in between,
/// seen from the earlier: the median distance. `None` where no plane is met.
#[must_use]
pub fn off_planes(drive: &Drive<'_>, [earlier, later]: [&Scan; 2], angles_rad: &[f64], motion: &Rigid) -> Option<f64> {
    let planes: BTreeMap<[i32; 3], Plane> = cubes(drive, earlier, angles_rad)
        .into_iter()
        .filter_map(|(cube, points)| Some((cube, plane(&points)?)))
        .collect();
    let mut off_m = Vec::new();
    drive.returns(later, angles_rad, f64::NEG_INFINITY, |_, _, [x, y, z]| {
        let [x, y] = motion.apply([x, y]);
        if let Some(Plane { mean, normal, .. }) = planes.get(&cube([x, y, z])) {
            off_m.push((Vector3::new(x, y, z) - mean).dot(normal).abs());
        }
    });
    asami_math::statistics::median(&off_m)
}

fn cube(point: [f64; 3]) -> [i32; 3] {
    point.map(|it| (it / CUBE_M).floor() as i32)
}

/// Points with their lasers, by cube.
type Cubes = BTreeMap<[i32; 3], Vec<(usize, Vector3<f64>)>>;

fn cubes(drive: &Drive<'_>, scan: &Scan, angles_rad: &[f64]) -> Cubes {
    let mut cubes = Cubes::new();
    drive.returns(scan, angles_rad, f64::NEG_INFINITY, |laser, _, point| {
        if point[0] * point[0] + point[1] * point[1] < FARTHEST_M * FARTHEST_M {
            cubes.entry(cube(point)).or_default().push((laser, Vector3::from(point)));
        }
    });
    cubes
}

/// A plane through points.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane {
    mean: Vector3<f64>,
    normal: Vector3<f64>,
    /// Standard deviation across it.
    sd_m: f64,
}

/// The plane through these points, if they are enough.
fn plane(points: &[(usize, Vector3<f64>)]) -> Option<Plane> {
    // Points come laser by laser.
    let lasers = points.chunk_by(|a, b| a.0 == b.0).count();
    if points.len() < LEAST.0 || lasers < LEAST.1 {
        return None;
    }
    let n = points.len() as f64;
    let mean = points.iter().fold(Vector3::zeros(), |sum, (_, point)| sum + point) / n;
    let scatter =
        |sum: Matrix3<f64>, (_, point): &(usize, Vector3<f64>)| sum + (point - mean) * (point - mean).transpose();
    let eigen = (points.iter().fold(Matrix3::zeros(), scatter) / n).symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let sd_m = eigen.eigenvalues[least].max(0.0).sqrt();
    Some(Plane { mean, normal: eigen.eigenvectors.column(least).into(), sd_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a tilted plane with points put 2 cm off it to either side, and of too few lasers.
    #[test]
    fn a_planes_thickness_is_that_of_its_noise() {
        let (normal, along) = (Vector3::new(0.6, 0.0, 0.8), Vector3::new(0.8, 0.0, -0.6));
        let point = |laser: usize, i: u32| {
            // Up, down, down, up: neither leans along the plane.
            let off = if (i + 1) & 2 == 0 { 0.02 } else { -0.02 };
            (laser, along * (0.03 * f64::from(i)) + Vector3::y() * (0.1 * laser as f64) + normal * off)
        };
        let points: Vec<_> = (0..4).flat_map(|laser| (0..8).map(move |i| point(laser, i))).collect();
        let Plane { normal, sd_m, .. } = plane(&points).unwrap();
        let up = normal.z.abs();
        assert!((sd_m - 0.02).abs() < 1e-9 && (up - 0.8).abs() < 1e-9, "{sd_m} {up}");
        assert_eq!(plane(&points[..16]), None);
        assert_eq!(plane(&points[..8]), None);
    }
}
