//! What bodies meet: the ground that wheels roll on, and boxes about everything else.

/// An upright box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Its middle, x, y, z in the world.
    pub centre_m: [f64; 3],
    /// Half its extents along its own axes.
    pub half_m: [f64; 3],
    /// Its own x axis in the world, of length 1.
    pub along: [f64; 2],
}

/// The ground, and what stands on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ground {
    /// x, y, z in metres.
    pub vertices: Vec<[f32; 3]>,
    /// Corners, counter-clockwise from above; none make a level plane at height 0 without end.
    pub triangles: Vec<[u32; 3]>,
    /// Walls, trunks, poles, parked cars.
    pub solids: Vec<Solid>,
}

impl Ground {
    /// A level plane at height 0 without end.
    #[must_use]
    pub fn endless() -> Self {
        Self::default()
    }

    /// A level square at height 0 about the origin.
    #[must_use]
    pub fn level(half_m: f32) -> Self {
        Self::profile(half_m, &[[-half_m, 0.0], [half_m, 0.0]])
    }

    /// Heights over world y, the same for all x within `half_m`: points `[y, z]` in order of y.
    #[must_use]
    pub fn profile(half_m: f32, points: &[[f32; 2]]) -> Self {
        let vertices = points.iter().flat_map(|&[y, z]| [[-half_m, y, z], [half_m, y, z]]).collect();
        let strip = |i: u32| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]];
        let triangles = (1..points.len() as u32).flat_map(|i| strip(i - 1)).collect();
        Self { vertices, triangles, solids: Vec::new() }
    }
}
