//! Rays against boxes.
//!
//! Two tests. The *exact* one is made on leaves: its operations are never fused, so that all widths get
//! the same bits, for the interval goes into the answer. The *loose* one is made on all boxes above, which
//! are padded twice as much: whatever its rounding, it passes where the exact test of a box inside passes.
//!
//! Why: in lengths along an axis, lo * inv - origin * inv is off by at most (2 |origin| + 3 |lo|) 2^-24
//! in either test, see the trap below; `origin` and `lo` are at most [`Bvh::bound`](crate::bvh::Bvh),
//! and the padding is 16 * 2^-24 of that, once for a leaf and twice above it. The reciprocal's own error is the same
//! in both tests and goes out of the comparison.
//!
//! The trap: 400 m from the world's origin, the products above are wrong by 0.05 mm and more, and an
//! unpadded test misses flat boxes such as a pavement's.

use crate::bvh::Node;
use crate::lanes::Lanes;

/// A component of a direction below this is taken for this much: the ray then leaves a slab 500 m wide after 5e17 of its lengths.
const LEAST_DIRECTION: f32 = 1e-15;

/// Rays, ready for being tested against boxes.
#[derive(Clone, Copy)]
pub(crate) struct Slabs<L> {
    inverse: [L; 3],
    /// origin * inverse.
    start: [L; 3],
}

/// Where the lines of rays are inside a box.
#[derive(Clone, Copy)]
pub(crate) struct Inside<L: Lanes> {
    pub(crate) near: L,
    pub(crate) far: L,
    /// Whether they are inside anywhere ahead of the rays' starts and within reach.
    pub(crate) in_reach: L::Mask,
}

/// Which of a box's corners rays meet first, axis by axis.
#[derive(Clone, Copy)]
pub(crate) struct Octant {
    /// Places in a node's eight numbers, see [`Node`].
    near: [usize; 3],
    /// Whether all rays agree. If not, both corners must be tried.
    pub(crate) shared: bool,
}

impl Octant {
    /// Of rays of which on each axis some, or all, go to the negative side.
    pub(crate) fn of(any_negative: [bool; 3], all_negative: [bool; 3]) -> Self {
        Self {
            near: std::array::from_fn(|k| if any_negative[k] { 4 + k } else { k }),
            shared: any_negative == all_negative,
        }
    }

    /// Whether rays meet the upper of two boxes that stand side by side along `axis` first.
    #[inline(always)]
    pub(crate) fn upper_first(self, axis: usize) -> bool {
        self.near[axis] >= 4
    }
}

impl<L: Lanes> Slabs<L> {
    /// # Safety
    /// That of [`Lanes`].
    #[inline(always)]
    pub(crate) unsafe fn new(origin: &[L; 3], direction: &[L; 3]) -> Self {
        // SAFETY: as the caller grants.
        unsafe {
            let inverse = [reciprocal(direction[0]), reciprocal(direction[1]), reciprocal(direction[2])];
            let start = [origin[0].mul(inverse[0]), origin[1].mul(inverse[1]), origin[2].mul(inverse[2])];
            Self { inverse, start }
        }
    }

    /// Which lanes go to the negative side of an axis, one bit a lane.
    ///
    /// # Safety
    /// That of [`Lanes`].
    #[inline(always)]
    pub(crate) unsafe fn negative(&self, axis: usize) -> u32 {
        // SAFETY: as the caller grants.
        unsafe { L::bits(self.inverse[axis].lt(L::splat(0.0))) }
    }

    /// The loose test: which rays may meet something in the box no farther than `reach`.
    ///
    /// # Safety
    /// That of [`Lanes`].
    #[inline(always)]
    pub(crate) unsafe fn may_meet<const SHARED: bool>(&self, node: &Node, octant: Octant, reach: L) -> L::Mask {
        // SAFETY: as the caller grants.
        unsafe {
            let (near, far) = self.interval::<SHARED, false>(node, octant);
            near.le(far.min(reach))
        }
    }

    /// The exact test, with the interval.
    ///
    /// # Safety
    /// That of [`Lanes`].
    #[inline(always)]
    pub(crate) unsafe fn inside<const SHARED: bool>(&self, leaf: &Node, octant: Octant, reach: L) -> Inside<L> {
        // SAFETY: as the caller grants.
        unsafe {
            let (near, far) = self.interval::<SHARED, true>(leaf, octant);
            Inside { near, far, in_reach: near.le(far.min(reach)) }
        }
    }

    /// From the last slab entered, or the start, to the first one left. The entry is above zero, so that a
    /// range between the two is.
    #[inline(always)]
    unsafe fn interval<const SHARED: bool, const EXACT: bool>(&self, node: &Node, octant: Octant) -> (L, L) {
        let [x, y, z] = if SHARED { octant.near } else { [0, 1, 2] };
        // SAFETY: as the caller grants.
        unsafe {
            let mut near =
                [self.pass::<EXACT>(node, x, 0), self.pass::<EXACT>(node, y, 1), self.pass::<EXACT>(node, z, 2)];
            let (x, y, z) = (x ^ 4, y ^ 4, z ^ 4);
            let mut far =
                [self.pass::<EXACT>(node, x, 0), self.pass::<EXACT>(node, y, 1), self.pass::<EXACT>(node, z, 2)];
            if !SHARED {
                let mut k = 0;
                while k < 3 {
                    (near[k], far[k]) = (near[k].min(far[k]), near[k].max(far[k]));
                    k += 1;
                }
            }
            let soonest = L::splat(f32::MIN_POSITIVE);
            (near[0].max(near[1]).max(near[2].max(soonest)), far[0].min(far[1]).min(far[2]))
        }
    }

    /// When rays pass one side of a box.
    #[inline(always)]
    unsafe fn pass<const EXACT: bool>(&self, node: &Node, word: usize, axis: usize) -> L {
        // SAFETY: as the caller grants.
        unsafe {
            let side = L::splat(f32::from_bits(node.words[word & 7]));
            if EXACT {
                side.mul(self.inverse[axis]).sub(self.start[axis])
            } else {
                side.loose_mul_sub(self.inverse[axis], self.start[axis])
            }
        }
    }
}

#[inline(always)]
unsafe fn reciprocal<L: Lanes>(direction: L) -> L {
    // SAFETY: as the caller grants.
    unsafe {
        let least = L::splat(LEAST_DIRECTION);
        L::splat(1.0).div(least.turned(direction).or_else(direction.abs().lt(least), direction))
    }
}
