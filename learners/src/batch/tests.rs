//! The linearised system against finite differences.

use std::sync::Arc;

use asami_dataset::log::Frame;
use asami_dataset::{Action, Beacon, Command, Known, Log, Sighting, Size};
use asami_math::bordered::Link;

use nalgebra::{DMatrix, Vector3};

use super::bound::noise_information;
use super::joint::{Estimate, Hold, Joint, KINDS};
use super::spread::Spread;
use crate::em::curve::{MOST, SizeCurve};
use crate::em::parameters::Parameters;
use crate::em::start::nowhere;
use crate::plane::Plane;

const STEPS: usize = 12;

/// A short log of two actions and two landmarks, of round numbers.
fn log() -> Log {
    let legs = |id: u16| Action::Legs { id: Some(id), ax_m_per_s: 0.1, ay_m_per_s: 0.2, atheta_rad_per_s: 0.0 };
    let t_s = |i: usize| 0.1 * i as f64;
    let commands: Vec<Command> = [0, 5, 8].map(|i| Command { t_s: t_s(i), action: legs(u16::from(i == 5)) }).into();
    let sightings = (0..STEPS).filter(|i| i % 2 == 1).map(|i| Sighting {
        t_s: t_s(i),
        landmark: u16::from(i % 3 == 0),
        size: Size::HeightPx(14.0 + 0.3 * i as f64),
        bearing_rad: 0.2 - 0.05 * i as f64,
    });
    let place = |id, x_m, y_m| Beacon { id, x_m, y_m, height_m: None };
    let known = Known { landmarks: vec![place(0, -1.0, 2.0), place(1, 1.5, 1.8)], ..Known::default() };
    Log {
        known: Arc::new(known),
        commands: commands.into(),
        frames: Some((0..STEPS).map(|i| Frame { t_s: t_s(i), head_pan_rad: 0.0 }).collect::<Vec<_>>().into()),
        sightings: sightings.collect::<Vec<_>>().into(),
        ..Log::default()
    }
}

fn estimate() -> Estimate {
    let poses =
        (0..STEPS).map(|i| i as f64).map(|i| [0.03 * i, -0.5 + 0.02 * i + 0.01 * (i * i) / 12.0, 0.3 - 0.02 * i]);
    Estimate {
        poses: poses.collect(),
        parameters: vec![0.1, 0.2, -0.1, 0.25, -0.1, 0.3, 15.0, -8.0, 3.0, -1.0],
        variances: [1.3, 0.2, 1e-4, 3e-4, 4e-3],
    }
}

fn joint(plane: &Plane) -> Joint<'_> {
    let prior = (0..10).map(|i| [0.1 + 0.01 * f64::from(i), 0.2]).collect();
    let f = SizeCurve { c: [0.0; MOST], n: 4, centre_m: 2.5, scale_m: 2.0 };
    let still = plane.actions.iter().map(|_| Vector3::zeros()).collect::<Vec<_>>();
    let start = Parameters {
        motion_var: still.clone(),
        velocity: still,
        f,
        size_var: 1.0,
        bearing_var: 1.0,
        common_share: 0.0,
        false_share: 0.0,
        false_log_density: 0.0,
        prior: nowhere(),
    };
    let mut joint = Joint::new(plane, &start, prior);
    // Any covariance will do.
    let mut link = Link { rows: 6, width: 6, entries: vec![0.0; 36] };
    for i in 0..6usize {
        for j in 0..6usize {
            let near = 1.0 / (1.0 + (i % 3).abs_diff(j % 3) as f64);
            *link.at_mut(i, j) = 0.02 * near * if i == j { 1.5 } else { 1.0 };
        }
    }
    joint.spreads = vec![Spread::of(&link); STEPS];
    joint
}

fn right_hand_side(joint: &Joint, estimate: &Estimate) -> (Vec<[f64; 3]>, Vec<f64>) {
    // What the sides sum to, collected by the system that is solved, with a matrix of ones.
    let mut states = vec![[0.0; 3]; STEPS];
    let mut parameters: Vec<f64> = joint.pull(estimate).iter().map(|pull| pull[1]).collect();
    for t in 0..STEPS - 1 {
        let (rows, columns) = (13, KINDS + 1);
        let mut link = Link { rows, width: rows + columns, entries: vec![0.0; rows * (rows + columns)] };
        joint.fill(estimate, Hold { poses: 0.0, sensor: true }, t, &mut link);
        let side = |i: usize| (0..columns).map(|c| link.at(i, rows + c)).sum::<f64>();
        let first = 3 * joint.plane.frames[t].action;
        for i in 0..rows {
            match i {
                0..3 => states[t][i] += side(i),
                3..6 => states[t + 1][i - 3] += side(i),
                6..9 => parameters[first + i - 6] += side(i),
                _ => parameters[6 + i - 9] += side(i),
            }
        }
    }
    (states, parameters)
}

#[test]
fn right_hand_sides_are_the_slope_of_the_cost() {
    let log = log();
    let plane = Plane::try_from(&log).unwrap();
    let (joint, here) = (joint(&plane), estimate());
    let (states, parameters) = right_hand_side(&joint, &here);
    let slope = |shift: &dyn Fn(&mut Estimate, f64)| {
        let at = |h: f64| {
            let mut moved = here.clone();
            shift(&mut moved, h);
            joint.misfit(&moved).cost
        };
        -0.5 * (at(1e-6) - at(-1e-6)) / 2e-6
    };
    let close = |a: f64, b: f64| (a - b).abs() < 1e-4 * (1.0 + a.abs());
    for (t, state) in states.iter().enumerate() {
        for (i, side) in state.iter().enumerate() {
            let by = slope(&|estimate, h| estimate.poses[t][i] += h);
            assert!(close(by, *side), "pose {t} {i}: {by} {side}");
        }
    }
    for (i, side) in parameters.iter().enumerate() {
        let by = slope(&|estimate, h| estimate.parameters[i] += h);
        assert!(close(by, *side), "parameter {i}: {by} {side}");
    }
}

/// Against traces of dense matrices: no elimination, no differences.
#[test]
fn information_of_the_noise_is_that_of_the_dense_rows() {
    let log = log();
    let plane = Plane::try_from(&log).unwrap();
    let mut joint = joint(&plane);
    joint.spreads = vec![Spread::default(); STEPS];
    let here = estimate();
    let n = 3 * STEPS + here.parameters.len();
    let (mut kinds, mut rows) = (Vec::new(), Vec::new());
    for t in 0..STEPS - 1 {
        joint.rows(&here, t, &mut |row| {
            let mut dense = vec![0.0; n];
            for by in row.by {
                let at = match by.at {
                    0..6 => 3 * t + by.at,
                    6..9 => 3 * STEPS + 3 * plane.frames[t].action + by.at - 6,
                    _ => 3 * STEPS + 6 + by.at - 9,
                };
                dense[at] += by.mean * (row.weight / here.variances[row.kind]).sqrt();
            }
            kinds.push(row.kind);
            rows.extend(dense);
        });
    }
    let a = DMatrix::from_row_slice(kinds.len(), n, &rows);
    let mut normal = a.transpose() * &a;
    for i in 0..n {
        normal[(i, i)] += if i < 3 { 1e-4 } else { 0.0 };
        normal[(i, i)] += if i >= 3 * STEPS { joint.prior[i - 3 * STEPS][0] } else { 0.0 };
    }
    let m = DMatrix::identity(kinds.len(), kinds.len()) - &a * normal.try_inverse().unwrap() * a.transpose();
    let information = noise_information(&joint, &here).unwrap();
    for (i, row) in information.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let pairs = (0..kinds.len()).flat_map(|k| (0..kinds.len()).map(move |l| (k, l)));
            let of = pairs.filter(|(k, l)| kinds[*k] == i && kinds[*l] == j);
            let dense = 0.5 * of.map(|at| m[at] * m[at]).sum::<f64>();
            assert!((entry - dense).abs() < 1e-4 * (1.0 + dense), "{i} {j}: {entry} {dense}");
        }
    }
}
