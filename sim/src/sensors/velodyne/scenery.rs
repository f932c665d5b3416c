//! What lasers see of a scene: triangles, how they face, and how much they reflect.

use asami_raycast::{Caster, MeshError, Packets};

/// Triangles to be scanned.
pub struct Scenery {
    caster: Box<dyn Caster>,
    facets: Vec<Facet>,
}

/// How a triangle answers light.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
struct Facet {
    brightness: [f32; 3],
}

impl Scenery {
    /// A scene of triangles, seen by the house's own ray caster. `reflectivity` gives the diffuse reflectivity of a
    /// triangle, 0 to 1, by its number.
    ///
    /// # Errors
    /// Where the mesh has no meaning.
    pub fn new(
        vertices: &[[f32; 3]],
        triangles: &[[u32; 3]],
        reflectivity: impl Fn(usize) -> f64,
    ) -> Result<Self, MeshError> {
        let caster = Packets::new(vertices, triangles)?;
        Ok(Self::seen_by(Box::new(caster), vertices, triangles, reflectivity))
    }

    /// The same, seen by another ray caster at the same triangles.
    #[must_use]
    pub fn seen_by(
        caster: Box<dyn Caster>,
        vertices: &[[f32; 3]],
        triangles: &[[u32; 3]],
        reflectivity: impl Fn(usize) -> f64,
    ) -> Self {
        let corner = |corner: u32| vertices.get(corner as usize).map_or([0.0; 3], |at| at.map(f64::from));
        let facets = triangles.iter().enumerate().map(|(i, triangle)| {
            let [a, b, c] = triangle.map(corner);
            let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| to[k] - a[k]) };
            let (u, v) = (edge(b), edge(c));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            let scale = if length > 0.0 { reflectivity(i) / length } else { 0.0 };
            Facet { brightness: normal.map(|x| (scale * x) as f32) }
        });
        Self { facets: facets.collect(), caster }
    }

    pub(super) fn caster(&self) -> &dyn Caster {
        &*self.caster
    }

    /// The unit normal of a triangle, times its reflectivity: the product with a beam's direction is the share of the light that
    /// comes back. Nothing comes back from no triangle.
    #[inline]
    pub(super) fn brightness(&self, triangle: u32) -> [f32; 3] {
        self.facets.get(triangle as usize).map_or([0.0; 3], |facet| facet.brightness)
    }
}
