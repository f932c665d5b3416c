//! 64 rays' common way through the hierarchy, for any width of lanes.
//!
//! The rays stand in groups of as many as there are lanes. Of the groups only the first that still meets
//! the box at hand is tested, and takes the others down with it; what the others miss, they miss at the leaves. So a box costs
//! a test or two for all 64 rays.

use crate::bundle::{Bundle, Hits};
use crate::bvh::{Bvh, DEEPEST, Inner, Node};
use crate::facet::{self, Nearest, meet};
use crate::lanes::Lanes;
use crate::slab::{Octant, Slabs};

/// Directions with a component above the first and all components below the second are cast as they are.
const LENGTHS: [f32; 2] = [1e-3, 1e3];

/// A group of rays.
#[derive(Clone, Copy)]
struct Group<L> {
    origin: [L; 3],
    direction: [L; 3],
    slabs: Slabs<L>,
    nearest: Nearest<L>,
}

/// Whether a ray can be cast as it is: near enough for the padding of boxes, and of a usual length.
pub(crate) fn is_plain(bound: f32, origin: [f32; 3], direction: [f32; 3]) -> bool {
    let longest = direction.iter().fold(0.0_f32, |longest, x| longest.max(x.abs()));
    origin.iter().chain(&direction).all(|x| x.is_finite())
        && origin.iter().all(|x| x.abs() <= bound)
        && (LENGTHS[0]..=LENGTHS[1]).contains(&longest)
}

/// Casts the plain rays of a bundle, and says whether there were others: those have met nothing.
///
/// # Safety
/// That of [`Lanes`]. `W` groups of `L` must make a bundle.
#[inline(always)]
pub(crate) unsafe fn trace<L: Lanes, const W: usize>(bvh: &Bvh, bundle: &Bundle, reach: f32, hits: &mut Hits) -> bool {
    const { assert!(W * L::WIDTH == Bundle::RAYS) };
    // SAFETY: as the caller grants.
    unsafe {
        let (group, mut all_plain) = gather(bundle, 0, bvh.bound, reach);
        let mut groups: [Group<L>; W] = [group; W];
        let mut w = 1;
        while w < W {
            let (group, plain) = gather(bundle, w * L::WIDTH, bvh.bound, reach);
            groups[w] = group;
            all_plain &= plain;
            w += 1;
        }
        let all = u32::MAX >> (32 - L::WIDTH as u32);
        let (mut any_negative, mut all_negative) = ([false; 3], [true; 3]);
        for group in &groups {
            for axis in 0..3 {
                let negative = group.slabs.negative(axis);
                any_negative[axis] |= negative != 0;
                all_negative[axis] &= negative == all;
            }
        }
        let octant = Octant::of(any_negative, all_negative);
        if octant.shared {
            descend::<L, W, true>(bvh, octant, &mut groups);
        } else {
            descend::<L, W, false>(bvh, octant, &mut groups);
        }
        for (w, group) in groups.iter().enumerate() {
            scatter(group, w * L::WIDTH, hits);
        }
        !all_plain
    }
}

/// A group out of a bundle; lanes of rays that are not plain meet nothing.
///
/// # Safety
/// That of [`Lanes`].
#[inline(always)]
unsafe fn gather<L: Lanes>(bundle: &Bundle, from: usize, bound: f32, reach: f32) -> (Group<L>, bool) {
    // SAFETY: as the caller grants; a slice of at least as many numbers as there are lanes is read.
    unsafe {
        let zero = L::splat(0.0);
        let (mut origin, mut direction) = ([zero; 3], [zero; 3]);
        let mut longest = zero;
        let mut plain = zero.le(zero);
        let (bound, length) = (L::splat(bound), L::splat(LENGTHS[1]));
        for k in 0..3 {
            origin[k] = L::load(bundle.origin[k][from..from + L::WIDTH].as_ptr());
            direction[k] = L::load(bundle.direction[k][from..from + L::WIDTH].as_ptr());
            // Comparisons with a NaN say no.
            let within = L::and(origin[k].abs().le(bound), direction[k].abs().le(length));
            plain = L::and(plain, within);
            longest = longest.max(direction[k].abs());
        }
        plain = L::and(plain, L::splat(LENGTHS[0]).le(longest));
        for k in 0..3 {
            origin[k] = origin[k].or_else(plain, zero);
            direction[k] = direction[k].or_else(plain, L::splat(1.0));
        }
        let nearest = Nearest::none(L::splat(reach).or_else(plain, L::splat(-1.0)));
        let slabs = Slabs::new(&origin, &direction);
        let all_plain = L::bits(plain) == u32::MAX >> (32 - L::WIDTH as u32);
        (Group { origin, direction, slabs, nearest }, all_plain)
    }
}

/// # Safety
/// That of [`Lanes`].
#[inline(always)]
unsafe fn scatter<L: Lanes>(group: &Group<L>, to: usize, hits: &mut Hits) {
    let mut triangles = [0.0_f32; Bundle::RAYS];
    let (ranges, triangles) = (&mut hits.range[to..to + L::WIDTH], &mut triangles[..L::WIDTH]);
    // SAFETY: as the caller grants; as many numbers are written as there are lanes.
    unsafe {
        let none = L::splat(f32::INFINITY);
        let met = group.nearest.triangle.lt(none);
        group.nearest.range.or_else(met, none).store(ranges.as_mut_ptr());
        group.nearest.triangle.store(triangles.as_mut_ptr());
    }
    for (number, triangle) in hits.triangle[to..to + L::WIDTH].iter_mut().zip(triangles) {
        *number = facet::number(*triangle);
    }
}

/// # Safety
/// That of [`Lanes`].
#[inline(always)]
unsafe fn descend<L: Lanes, const W: usize, const SHARED: bool>(bvh: &Bvh, octant: Octant, groups: &mut [Group<L>; W]) {
    let nodes = bvh.nodes.as_ptr().cast::<Node>();
    let mut waiting = [(0_u32, 0_u32); DEEPEST];
    let mut count = 0;
    let (mut at, mut first) = (0_u32, 0_usize);
    loop {
        // SAFETY: `at` is the root or a child's place, and those are in range, see Bvh; a Pair is two Nodes.
        let node = unsafe { &*nodes.add(at as usize) };
        match node.inner() {
            Inner::Children { first: children, axis } => {
                // SAFETY: as the caller grants.
                unsafe {
                    L::prefetch(nodes.wrapping_add(children as usize).cast());
                    while first < W
                        && !L::any(groups[first].slabs.may_meet::<SHARED>(node, octant, groups[first].nearest.range))
                    {
                        first += 1;
                    }
                }
                if first < W {
                    let (near, far) =
                        if octant.upper_first(axis) { (children + 1, children) } else { (children, children + 1) };
                    waiting[count] = (far, first as u32);
                    count += 1;
                    at = near;
                    continue;
                }
            }
            Inner::Triangles { first: triangle, count } => {
                let of = triangle as usize..(triangle + count) as usize;
                // SAFETY: as the caller grants.
                unsafe { visit::<L, SHARED>(bvh, node, of, octant, &mut groups[first..]) };
            }
        }
        if count == 0 {
            return;
        }
        count -= 1;
        let (next, group) = waiting[count];
        (at, first) = (next, group as usize);
    }
}

/// # Safety
/// That of [`Lanes`].
#[inline(always)]
unsafe fn visit<L: Lanes, const SHARED: bool>(
    bvh: &Bvh,
    leaf: &Node,
    of: std::ops::Range<usize>,
    octant: Octant,
    groups: &mut [Group<L>],
) {
    let (facets, numbers) = (&bvh.facets[of.clone()], &bvh.numbers[of]);
    for group in groups {
        // SAFETY: as the caller grants.
        unsafe {
            let inside = group.slabs.inside::<SHARED>(leaf, octant, group.nearest.range);
            if L::any(inside.in_reach) {
                for (facet, number) in facets.iter().zip(numbers) {
                    meet(facet, *number, &group.origin, &group.direction, &inside, &mut group.nearest);
                }
            }
        }
    }
}
