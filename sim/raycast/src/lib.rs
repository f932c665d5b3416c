//! Rays against triangles: the first triangle that each ray meets, and how far away.
//!
//! [`Packets`] is the caster to use: bundles of 64 rays that go about the same way descend together
//! through a hierarchy of boxes, 16, 8 or 4 rays to an instruction, whichever the processor offers at
//! run time. Its answers have the same bits on every processor. [`Parry`] is the reference: parry3d's,
//! one ray at a time. Both stand behind [`Caster`].
//!
//! What a ray meets is defined without regard to how it is found. For every triangle that the ray
//! passes, `facet` gives a range, in operations that are never fused, written once for every width;
//! the answer is the smallest range, and among equal ranges the smallest number of a triangle. The
//! hierarchy only leaves out triangles that cannot be the answer: boxes are padded for that, see `bvh`.
//!
//! Coordinates are single precision: keep the scene about a local origin. At 500 m from it a coordinate
//! is known to 0.03 mm, at 50 km to 4 mm.

pub mod bundle;
pub mod caster;
pub mod mesh;
pub mod packets;
pub mod parry;

mod bvh;
mod facet;
mod lanes;
#[cfg(test)]
mod oracle;
mod slab;
mod traverse;

pub use bundle::{Bundle, Hit, Hits, Ray};
pub use caster::Caster;
pub use mesh::{MeshError, weld};
pub use packets::{Instructions, Packets};
pub use parry::Parry;
