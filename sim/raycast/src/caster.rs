//! The door behind which every ray caster stands.

use crate::bundle::{Bundle, Hit, Hits, Ray};

/// Finds what rays meet first.
///
/// A ray meets a triangle from either side, at a range above zero and not above `reach`. A ray with a
/// NaN, an infinity or no direction meets nothing, and so does every ray where `reach` is no positive
/// number; triangles without area are never met.
pub trait Caster: Send + Sync {
    /// Casts 64 rays as far as `reach`, in lengths of their directions, and overwrites `hits`.
    fn cast(&self, bundle: &Bundle, reach: f32, hits: &mut Hits);

    /// Casts any number of rays, 64 neighbours of the slice at a time.
    fn cast_all(&self, rays: &[Ray], reach: f32) -> Vec<Option<Hit>> {
        let mut hits = Hits::none();
        let mut all = Vec::with_capacity(rays.len());
        for rays in rays.chunks(Bundle::RAYS) {
            self.cast(&Bundle::of(rays), reach, &mut hits);
            all.extend((0..rays.len()).map(|lane| hits.hit(lane)));
        }
        all
    }
}
