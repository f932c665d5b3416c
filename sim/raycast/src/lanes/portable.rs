//! Eight lanes for any processor, in plain Rust.

use super::Lanes;

/// Eight numbers; the compiler may use what every processor of the target has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable([f32; 8]);

impl Portable {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> [u32; 8] {
        std::array::from_fn(|i| if f(self.0[i], other.0[i]) { u32::MAX } else { 0 })
    }
}

// Of these methods only load and store can go wrong; all are unsafe because the trait's are.
impl Lanes for Portable {
    const WIDTH: usize = 8;
    type Mask = [u32; 8];

    #[inline(always)]
    unsafe fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the caller grants eight readable numbers; read_unaligned asks for no more.
        Self(unsafe { from.cast::<[f32; 8]>().read_unaligned() })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: the caller grants eight writable numbers; write_unaligned asks for no more.
        unsafe { to.cast::<[f32; 8]>().write_unaligned(self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
    #[inline(always)]
    unsafe fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
    #[inline(always)]
    unsafe fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
    #[inline(always)]
    unsafe fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
    #[inline(always)]
    unsafe fn min(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    unsafe fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    unsafe fn loose_mul_sub(self, by: Self, less: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] * by.0[i] - less.0[i]))
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }
    #[inline(always)]
    unsafe fn turned(self, by: Self) -> Self {
        self.with(by, |a, b| f32::from_bits(a.to_bits() ^ (b.to_bits() & 0x8000_0000)))
    }
    #[inline(always)]
    unsafe fn lt(self, other: Self) -> Self::Mask {
        self.compare(other, |a, b| a < b)
    }
    #[inline(always)]
    unsafe fn le(self, other: Self) -> Self::Mask {
        self.compare(other, |a, b| a <= b)
    }
    #[inline(always)]
    unsafe fn eq(self, other: Self) -> Self::Mask {
        self.compare(other, |a, b| a == b)
    }
    #[inline(always)]
    unsafe fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        std::array::from_fn(|i| a[i] & b[i])
    }
    #[inline(always)]
    unsafe fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        std::array::from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    unsafe fn bits(mask: Self::Mask) -> u32 {
        (0..8).fold(0, |bits, i| bits | (mask[i] & 1) << i)
    }
    #[inline(always)]
    unsafe fn or_else(self, mask: Self::Mask, other: Self) -> Self {
        Self(std::array::from_fn(|i| {
            f32::from_bits((self.0[i].to_bits() & mask[i]) | (other.0[i].to_bits() & !mask[i]))
        }))
    }
    #[inline(always)]
    unsafe fn prefetch(_: *const u8) {}
    #[inline(always)]
    unsafe fn any(mask: Self::Mask) -> bool {
        mask.iter().fold(0, |any, lane| any | lane) != 0
    }
}

/// One lane: the scalar routine, against which the tests hold the others.
#[cfg(test)]
impl Lanes for f32 {
    const WIDTH: usize = 1;
    type Mask = bool;

    unsafe fn splat(x: f32) -> Self {
        x
    }
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the caller grants one readable number.
        unsafe { from.read_unaligned() }
    }
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: the caller grants one writable number.
        unsafe { to.write_unaligned(self) }
    }
    unsafe fn add(self, other: Self) -> Self {
        self + other
    }
    unsafe fn sub(self, other: Self) -> Self {
        self - other
    }
    unsafe fn mul(self, other: Self) -> Self {
        self * other
    }
    unsafe fn div(self, other: Self) -> Self {
        self / other
    }
    unsafe fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    unsafe fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    unsafe fn loose_mul_sub(self, by: Self, less: Self) -> Self {
        self * by - less
    }
    unsafe fn abs(self) -> Self {
        f32::abs(self)
    }
    unsafe fn turned(self, by: Self) -> Self {
        if by.is_sign_negative() { -self } else { self }
    }
    unsafe fn lt(self, other: Self) -> bool {
        self < other
    }
    unsafe fn le(self, other: Self) -> bool {
        self <= other
    }
    unsafe fn eq(self, other: Self) -> bool {
        self == other
    }
    unsafe fn and(a: bool, b: bool) -> bool {
        a && b
    }
    unsafe fn or(a: bool, b: bool) -> bool {
        a || b
    }
    unsafe fn bits(mask: bool) -> u32 {
        u32::from(mask)
    }
    unsafe fn or_else(self, mask: bool, other: Self) -> Self {
        if mask { self } else { other }
    }
    unsafe fn prefetch(_: *const u8) {}
}
