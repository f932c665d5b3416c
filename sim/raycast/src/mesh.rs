//! Triangles as a scene gives them: what a caster accepts, and how to close the cracks between them.

use std::collections::BTreeMap;

/// Coordinates beyond this many metres leave single precision nothing to say about ranges.
const FARTHEST_M: f32 = 1e6;
/// Numbers of triangles are kept in bits that order as floats do, see [`crate::facet`].
const MOST_TRIANGLES: usize = 0x7f00_0000;

/// Why a mesh cannot be cast at.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A coordinate is NaN, infinite or out of reach of single precision.
    #[error("vertex {vertex} is at {at:?}; coordinates must lie in -{FARTHEST_M}..={FARTHEST_M}")]
    Vertex {
        /// Number of the vertex.
        vertex: usize,
        /// Its coordinates.
        at: [f32; 3],
    },
    /// A triangle has a corner that does not exist.
    #[error("triangle {triangle} has the corners {corners:?}, but there are {vertices} vertices")]
    Corner {
        /// Number of the triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
        /// How many vertices there are.
        vertices: usize,
    },
    /// There are more triangles than can be numbered.
    #[error("{0} triangles are more than {MOST_TRIANGLES}")]
    TooMany(usize),
}

/// Refuses what no caster could give a meaning to.
pub(crate) fn check(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.len() > MOST_TRIANGLES {
        return Err(MeshError::TooMany(triangles.len()));
    }
    // A NaN fails this as well.
    let fits = |x: &f32| x.abs() <= FARTHEST_M;
    if let Some((vertex, at)) = vertices.iter().enumerate().find(|(_, at)| !at.iter().all(fits)) {
        return Err(MeshError::Vertex { vertex, at: *at });
    }
    let exists = |corner: &u32| (*corner as usize) < vertices.len();
    match triangles.iter().enumerate().find(|(_, corners)| !corners.iter().all(exists)) {
        Some((triangle, corners)) => Err(MeshError::Corner { triangle, corners: *corners, vertices: vertices.len() }),
        None => Ok(()),
    }
}

/// The triangle's corners.
pub(crate) fn corners(vertices: &[[f32; 3]], triangle: [u32; 3]) -> [[f32; 3]; 3] {
    triangle.map(|corner| vertices[corner as usize])
}

/// Twice the triangle's area vector, computed in double precision; zero in single precision where the
/// triangle has no area to speak of.
pub(crate) fn normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let edge = |to: [f32; 3]| -> [f64; 3] { std::array::from_fn(|k| f64::from(to[k]) - f64::from(a[k])) };
    let (u, v) = (edge(b), edge(c));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]].map(|x| x as f32)
}

/// Merges vertices that lie within `within_m` of one another, so that triangles which are meant to
/// share an edge do, and no ray slips through between them: the vertices left, in the order of their
/// first appearance, and the triangles with the same numbers as before (some may have lost their area).
/// Vertices that are not finite stay as they are.
#[must_use]
pub fn weld(vertices: &[[f32; 3]], triangles: &[[u32; 3]], within_m: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let cell_of = |at: &[f32; 3]| at.map(|x| (f64::from(x) / f64::from(within_m)).floor() as i64);
    let mut kept: Vec<[f32; 3]> = Vec::new();
    let mut cells: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
    let becomes: Vec<u32> = vertices
        .iter()
        .map(|at| {
            let cell = cell_of(at);
            let near = |other: &u32| {
                let apart = |k: usize| f64::from(kept[*other as usize][k]) - f64::from(at[k]);
                (0..3).map(|k| apart(k) * apart(k)).sum::<f64>() <= f64::from(within_m) * f64::from(within_m)
            };
            let known = neighbours(cell).filter_map(|cell| cells.get(&cell)).flatten().copied().filter(near).min();
            known.unwrap_or_else(|| {
                let new = kept.len() as u32;
                kept.push(*at);
                cells.entry(cell).or_default().push(new);
                new
            })
        })
        .collect();
    let merged = |corner: &u32| becomes.get(*corner as usize).copied().unwrap_or(u32::MAX);
    (kept, triangles.iter().map(|corners| std::array::from_fn(|k| merged(&corners[k]))).collect())
}

fn neighbours(cell: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |i| {
        let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
        std::array::from_fn(|k| cell[k].saturating_add(step[k]))
    })
}
