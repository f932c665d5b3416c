//! Numbers side by side: what one instruction works on, 1, 8 or 16 at a time.
//!
//! All operations but [`Lanes::loose_mul_sub`] round as IEEE 754 says, once, so that every width
//! gives the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
pub(crate) use portable::Portable;

/// Lanes of single precision.
///
/// # Safety
/// One rule for all the methods: the processor has the instructions that the implementing type is named
/// for. [`Lanes::load`] and [`Lanes::store`] ask for memory as well.
pub(crate) trait Lanes: Copy {
    /// How many.
    const WIDTH: usize;
    /// Yes or no, lane by lane.
    type Mask: Copy;

    /// The same number in every lane.
    unsafe fn splat(x: f32) -> Self;
    /// Reads [`Self::WIDTH`] numbers, which must be readable.
    unsafe fn load(from: *const f32) -> Self;
    /// Writes [`Self::WIDTH`] numbers, which must be writable.
    unsafe fn store(self, to: *mut f32);

    unsafe fn add(self, other: Self) -> Self;
    unsafe fn sub(self, other: Self) -> Self;
    unsafe fn mul(self, other: Self) -> Self;
    unsafe fn div(self, other: Self) -> Self;
    /// The lesser; `other` where the two are equal or either is NaN.
    unsafe fn min(self, other: Self) -> Self;
    /// The greater; `other` where the two are equal or either is NaN.
    unsafe fn max(self, other: Self) -> Self;
    /// `self * by - less`, fused where that is quicker: not the same bits on every processor.
    unsafe fn loose_mul_sub(self, by: Self, less: Self) -> Self;
    /// Without its sign.
    unsafe fn abs(self) -> Self;
    /// With its sign turned where `by` is negative (or -0).
    unsafe fn turned(self, by: Self) -> Self;

    /// Below; no where either is NaN, as in the next two.
    unsafe fn lt(self, other: Self) -> Self::Mask;
    /// Below or equal.
    unsafe fn le(self, other: Self) -> Self::Mask;
    /// Equal.
    unsafe fn eq(self, other: Self) -> Self::Mask;
    unsafe fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    unsafe fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// One bit a lane, the first lane's the lowest.
    unsafe fn bits(mask: Self::Mask) -> u32;
    /// `self` where `mask` says yes, else `other`.
    unsafe fn or_else(self, mask: Self::Mask, other: Self) -> Self;

    /// Says that the cache line at `address`, which need not be readable, will be wanted.
    unsafe fn prefetch(address: *const u8);

    /// Whether any lane says yes.
    #[inline(always)]
    unsafe fn any(mask: Self::Mask) -> bool {
        // SAFETY: the trait's one rule, handed on.
        unsafe { Self::bits(mask) != 0 }
    }
}
