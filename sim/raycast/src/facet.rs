//! Rays against triangles: the routine that computes every range, once for all widths.

use crate::bundle::Hits;
use crate::lanes::Lanes;
use crate::mesh;
use crate::slab::Inside;

/// A triangle, ready for rays: a corner, the edges from it (the second one turned around), and the normal.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Facet {
    corner: [f32; 3],
    normal: [f32; 3],
    to_third: [f32; 3],
    from_second: [f32; 3],
}

impl Facet {
    /// `None` if the triangle has no area.
    pub(crate) fn new(corners: [[f32; 3]; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let normal = mesh::normal(corners);
        let minus = |p: [f32; 3], q: [f32; 3]| std::array::from_fn(|k| p[k] - q[k]);
        let facet = Self { corner: a, normal, to_third: minus(c, a), from_second: minus(a, b) };
        (normal != [0.0; 3]).then_some(facet)
    }
}

/// What rays have met so far.
#[derive(Clone, Copy)]
pub(crate) struct Nearest<L> {
    /// As far as the rays go.
    pub(crate) range: L,
    /// Triangles' numbers, as the bits of positive floats: those order as the numbers do.
    pub(crate) triangle: L,
}

/// No triangle's number; above all of them.
const NOTHING: f32 = f32::INFINITY;

impl<L: Lanes> Nearest<L> {
    /// Nothing yet.
    ///
    /// # Safety
    /// That of [`Lanes`].
    #[inline(always)]
    pub(crate) unsafe fn none(reach: L) -> Self {
        // SAFETY: as the caller grants.
        Self { range: reach, triangle: unsafe { L::splat(NOTHING) } }
    }
}

/// Turns a lane's bits back into a number of a triangle.
pub(crate) fn number(triangle: f32) -> u32 {
    if triangle == NOTHING { Hits::NOTHING } else { triangle.to_bits() }
}

/// Lets rays that are inside the triangle's leaf meet the triangle.
///
/// Solves origin + t direction = corner + u (b - corner) + v (c - corner) by Cramer's rule, with the signs
/// of u and v tested before anything is divided (Möller and Trumbore 1997, with the normal at hand as in Embree). The range is kept within the leaf's box:
/// where a ray grazes the plane, its range is the most uncertain, and what comes out must not hang on whether the leaf was looked into.
///
/// # Safety
/// That of [`Lanes`].
#[inline(always)]
pub(crate) unsafe fn meet<L: Lanes>(
    facet: &Facet,
    triangle: u32,
    origin: &[L; 3],
    direction: &[L; 3],
    inside: &Inside<L>,
    nearest: &mut Nearest<L>,
) {
    // SAFETY: as the caller grants.
    unsafe {
        let corner: [L; 3] = splat(&facet.corner);
        let normal: [L; 3] = splat(&facet.normal);
        let away = [corner[0].sub(origin[0]), corner[1].sub(origin[1]), corner[2].sub(origin[2])];
        let turn = cross(&away, direction);
        let det = dot(&normal, direction);
        let u = dot(&splat(&facet.to_third), &turn).turned(det);
        let v = dot(&splat(&facet.from_second), &turn).turned(det);
        let (zero, det_abs) = (L::splat(0.0), det.abs());
        let met = L::and(L::and(zero.le(u), zero.le(v)), u.add(v).le(det_abs));
        if !L::any(met) {
            return;
        }
        let range = dot(&normal, &away).turned(det).div(det_abs);
        let met = L::and(L::and(met, zero.lt(det_abs)), L::and(zero.lt(range), inside.in_reach));
        let range = range.max(inside.near).min(inside.far);
        let (nearer, as_near) = (range.lt(nearest.range), L::and(met, range.eq(nearest.range)));
        let number = L::splat(f32::from_bits(triangle));
        let mut better = L::and(met, nearer);
        if L::any(as_near) {
            better = L::or(better, L::and(as_near, number.lt(nearest.triangle)));
        }
        nearest.range = range.or_else(better, nearest.range);
        nearest.triangle = number.or_else(better, nearest.triangle);
    }
}

// No closures here nor in what calls this: they would not be compiled for the caller's instructions.

#[inline(always)]
unsafe fn splat<L: Lanes>([x, y, z]: &[f32; 3]) -> [L; 3] {
    // SAFETY: as the caller grants.
    unsafe { [L::splat(*x), L::splat(*y), L::splat(*z)] }
}

#[inline(always)]
unsafe fn cross<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    // SAFETY: as the caller grants.
    unsafe {
        [a[1].mul(b[2]).sub(a[2].mul(b[1])), a[2].mul(b[0]).sub(a[0].mul(b[2])), a[0].mul(b[1]).sub(a[1].mul(b[0]))]
    }
}

#[inline(always)]
unsafe fn dot<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> L {
    // SAFETY: as the caller grants.
    unsafe { a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2])) }
}
