//! The caster of the house: 64 rays at a time, with the widest instructions that the processor has.

use crate::bundle::{Bundle, Hit, Hits, Ray};
use crate::bvh::Bvh;
use crate::caster::Caster;
use crate::lanes::{self, Lanes};
use crate::mesh::MeshError;
use crate::traverse::{is_plain, trace};

/// Instructions to cast with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// 16 rays at a time, on x86-64 with AVX-512.
    Avx512,
    /// 8 rays at a time, on x86-64 with AVX2 and FMA.
    Avx2,
    /// Any processor.
    Portable,
}

impl Instructions {
    /// All there are, the quickest first.
    pub const ALL: [Self; 3] = [Self::Avx512, Self::Avx2, Self::Portable];

    /// Whether this processor has them.
    #[must_use]
    pub fn are_here(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => std::arch::is_x86_feature_detected!("avx512f"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma"),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx512 | Self::Avx2 => false,
            Self::Portable => true,
        }
    }
}

/// Casts bundles of rays together. Same answers, to the bit, on every processor.
#[derive(Clone, Debug)]
pub struct Packets {
    bvh: Bvh,
    instructions: Instructions,
}

impl Packets {
    /// A caster at these triangles, with the best instructions of this processor.
    ///
    /// # Errors
    /// Where the mesh has no meaning, see [`MeshError`].
    pub fn new(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let instructions = Instructions::ALL.into_iter().find(|kind| kind.are_here()).unwrap_or(Instructions::Portable);
        Ok(Self { bvh: Bvh::new(vertices, triangles)?, instructions })
    }

    /// The same with other instructions; `None` if this processor does not have them.
    #[must_use]
    pub fn with(self, instructions: Instructions) -> Option<Self> {
        instructions.are_here().then_some(Self { instructions, ..self })
    }

    /// What this caster casts with.
    #[must_use]
    pub fn instructions(&self) -> Instructions {
        self.instructions
    }

    #[cfg(test)]
    pub(crate) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Casts the rays of which single precision can make no sense where they are: from the edge of the scene, with a direction of a
    /// usual length.
    fn cast_others(&self, bundle: &Bundle, reach: f32, hits: &mut Hits) {
        for lane in 0..Bundle::RAYS {
            let ray = bundle.ray(lane);
            if !is_plain(self.bvh.bound, ray.origin, ray.direction) {
                hits.put(lane, self.cast_from_afar(&ray, reach));
            }
        }
    }

    fn cast_from_afar(&self, ray: &Ray, reach: f32) -> Option<Hit> {
        let near = Near::of(ray, &self.bvh)?;
        let left = ((f64::from(reach) - near.skipped) * near.length) as f32;
        if left <= 0.0 {
            return None;
        }
        let mut hits = Hits::none();
        // From too far away even double precision does not bring it near: then it is not plain, and meets nothing.
        trace_portable(&self.bvh, &Bundle::of(&[near.ray]), left, &mut hits);
        let range = |range: f32| (f64::from(range) / near.length + near.skipped) as f32;
        hits.hit(0).map(|hit| Hit { range: range(hit.range), ..hit })
    }
}

impl Caster for Packets {
    fn cast(&self, bundle: &Bundle, reach: f32, hits: &mut Hits) {
        if self.bvh.facets.is_empty() || reach.is_nan() || reach <= 0.0 {
            *hits = Hits::none();
            return;
        }
        let others = match self.instructions {
            // SAFETY: a caster with these instructions is only made where the processor has them.
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 => unsafe { trace_avx512(&self.bvh, bundle, reach, hits) },
            // SAFETY: likewise.
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => unsafe { trace_avx2(&self.bvh, bundle, reach, hits) },
            _ => trace_portable(&self.bvh, bundle, reach, hits),
        };
        if others {
            self.cast_others(bundle, reach, hits);
        }
    }
}

/// # Safety
/// The processor has AVX-512F.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
unsafe fn trace_avx512(bvh: &Bvh, bundle: &Bundle, reach: f32, hits: &mut Hits) -> bool {
    // SAFETY: as the caller grants.
    unsafe { trace::<lanes::Avx512, { Bundle::RAYS / lanes::Avx512::WIDTH }>(bvh, bundle, reach, hits) }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn trace_avx2(bvh: &Bvh, bundle: &Bundle, reach: f32, hits: &mut Hits) -> bool {
    // SAFETY: as the caller grants.
    unsafe { trace::<lanes::Avx2, { Bundle::RAYS / lanes::Avx2::WIDTH }>(bvh, bundle, reach, hits) }
}

fn trace_portable(bvh: &Bvh, bundle: &Bundle, reach: f32, hits: &mut Hits) -> bool {
    // SAFETY: there is no processor without these instructions.
    unsafe { trace::<lanes::Portable, { Bundle::RAYS / lanes::Portable::WIDTH }>(bvh, bundle, reach, hits) }
}

/// A ray, moved along its line to the edge of the scene and given a usual length.
struct Near {
    ray: Ray,
    /// By how much it was moved, in its own lengths.
    skipped: f64,
    /// The new length of the direction in old ones.
    length: f64,
}

impl Near {
    /// `None` if the ray is not finite, has no direction, or passes by.
    fn of(ray: &Ray, bvh: &Bvh) -> Option<Self> {
        let (origin, direction) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
        let longest = direction.iter().fold(0.0_f64, |longest, x| longest.max(x.abs()));
        let finite = origin.iter().chain(&direction).all(|x| x.is_finite());
        if !finite || longest <= 0.0 {
            return None;
        }
        let margin = 1e-6 * f64::from(bvh.bound);
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for k in 0..3 {
            let [lo, hi] = [f64::from(bvh.around.lo[k]) - margin, f64::from(bvh.around.hi[k]) + margin];
            if direction[k] == 0.0 {
                if !(lo..=hi).contains(&origin[k]) {
                    return None;
                }
            } else {
                let (a, b) = ((lo - origin[k]) / direction[k], (hi - origin[k]) / direction[k]);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        let at = |t: f64| std::array::from_fn(|k| (origin[k] + t * direction[k]) as f32);
        // A little before the edge, so that nothing that stands there is behind the start.
        let skipped = (enter - margin / longest).max(0.0);
        let ray = Ray { origin: at(skipped), direction: direction.map(|x| (x / longest) as f32) };
        (enter <= leave).then_some(Self { ray, skipped, length: longest })
    }
}
