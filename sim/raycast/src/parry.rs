//! The reference: parry3d's rays against a triangle mesh, one at a time.

use parry3d::math::Vector;
use parry3d::query;
use parry3d::shape::{CompositeShapeRef, TriMesh};

use crate::bundle::{Bundle, Hit, Hits, Ray};
use crate::caster::Caster;
use crate::facet::Facet;
use crate::mesh::{self, MeshError};

/// Casts with parry3d.
#[derive(Clone)]
pub struct Parry {
    /// `None` if no triangle has an area.
    mesh: Option<TriMesh>,
    /// The triangles' numbers.
    numbers: Vec<u32>,
}

impl Parry {
    /// A caster at these triangles.
    ///
    /// # Errors
    /// Where the mesh has no meaning, see [`MeshError`].
    pub fn new(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        mesh::check(vertices, triangles)?;
        let has_area = |triangle: &[u32; 3]| Facet::new(mesh::corners(vertices, *triangle)).is_some();
        let (numbers, kept): (Vec<u32>, Vec<[u32; 3]>) =
            (0..).zip(triangles.iter().copied()).filter(|(_, triangle)| has_area(triangle)).unzip();
        // It refuses only a mesh without triangles.
        let mesh = TriMesh::new(vertices.iter().map(|at| Vector::from(*at)).collect(), kept).ok();
        Ok(Self { mesh, numbers })
    }

    fn cast_one(&self, ray: &Ray, reach: f32) -> Option<Hit> {
        let finite = ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite());
        if !finite || ray.direction == [0.0; 3] || reach.is_nan() || reach <= 0.0 {
            return None;
        }
        let ray = query::Ray::new(Vector::from(ray.origin), Vector::from(ray.direction));
        // parry3d looks for what is nearer than it is told.
        let beyond = reach.next_up();
        let (part, range) = CompositeShapeRef(self.mesh.as_ref()?).cast_local_ray(&ray, beyond, true)?;
        (range > 0.0).then_some(Hit { range, triangle: *self.numbers.get(part as usize)? })
    }
}

impl Caster for Parry {
    fn cast(&self, bundle: &Bundle, reach: f32, hits: &mut Hits) {
        for lane in 0..Bundle::RAYS {
            hits.put(lane, self.cast_one(&bundle.ray(lane), reach));
        }
    }
}
