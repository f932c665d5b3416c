//! Boxes in boxes: the hierarchy in which rays look for triangles.

mod build;
mod cost;

use crate::facet::Facet;
use crate::mesh::{self, MeshError};

/// A box with either two boxes or some triangles in it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Node {
    /// The lower corner; the first child or the first triangle; the upper corner; [`LEAF`] and the
    /// count of triangles, or the axis along which the children stand side by side. Coordinates as bits.
    pub(crate) words: [u32; 8],
}

/// Marks a leaf.
const LEAF: u32 = 0x8000_0000;
/// Levels of boxes; what waits to be visited is never more than one box a level.
pub(crate) const DEEPEST: usize = 96;
/// Padding as a share of the bound, see [`crate::slab`].
const PADDING: f32 = 16.0 / 16_777_216.0;

/// What a node holds.
pub(crate) enum Inner {
    /// Two nodes, the first of them this one.
    Children { first: u32, axis: usize },
    /// Triangles, by their places in [`Bvh::facets`].
    Triangles { first: u32, count: u32 },
}

impl Node {
    pub(crate) const EMPTY: Self = Self { words: [0; 8] };

    #[inline(always)]
    pub(crate) fn inner(&self) -> Inner {
        let (first, tag) = (self.words[3], self.words[7]);
        if tag & LEAF == 0 {
            Inner::Children { first, axis: tag as usize }
        } else {
            Inner::Triangles { first, count: tag & !LEAF }
        }
    }
}

/// The hierarchy. Children's and triangles' places are in range, children stand behind their parents, and no node is deeper than [`DEEPEST`].
#[derive(Clone, Debug)]
pub(crate) struct Bvh {
    /// By twos, a cache line each; the root, then nothing, then children.
    pub(crate) nodes: Vec<Pair>,
    pub(crate) facets: Vec<Facet>,
    /// The facets' numbers in the mesh.
    pub(crate) numbers: Vec<u32>,
    /// No coordinate of the mesh is farther out, and no ray that is cast directly may start farther out.
    pub(crate) bound: f32,
    /// The box around all triangles; inside out if there are none.
    pub(crate) around: cost::Bounds,
}

/// Two children.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Pair(pub(crate) [Node; 2]);

impl Bvh {
    /// Over all triangles that have an area.
    pub(crate) fn new(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        mesh::check(vertices, triangles)?;
        let corners = triangles.iter().map(|triangle| mesh::corners(vertices, *triangle));
        let (numbers, kept): (Vec<u32>, Vec<_>) =
            (0..).zip(corners).filter(|(_, corners)| Facet::new(*corners).is_some()).unzip();
        Ok(build::build(&kept, &numbers))
    }
}
