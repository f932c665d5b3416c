//! Eight lanes for processors with AVX2 and FMA.

use std::arch::x86_64::*;

use super::Lanes;

/// 8 numbers in one register.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(__m256);

// Every intrinsic below asks for the instructions that this type is named for, and for nothing else, but where it
// touches memory: the trait's one rule grants them.
impl Lanes for Avx2 {
    const WIDTH: usize = 8;
    type Mask = __m256;

    #[inline(always)]
    unsafe fn splat(x: f32) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the instructions are there by the trait's rule, and the caller grants 8 readable numbers.
        Self(unsafe { _mm256_loadu_ps(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: the instructions are there by the trait's rule, and the caller grants 8 writable numbers.
        unsafe { _mm256_storeu_ps(to, self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, other: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_add_ps(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn sub(self, other: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_sub_ps(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn mul(self, other: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_mul_ps(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn div(self, other: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_div_ps(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn min(self, other: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn max(self, other: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn loose_mul_sub(self, by: Self, less: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_fmsub_ps(self.0, by.0, less.0) })
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    unsafe fn turned(self, by: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(by.0, _mm256_set1_ps(-0.0))) })
    }
    #[inline(always)]
    unsafe fn lt(self, other: Self) -> Self::Mask {
        // SAFETY: the instructions are there by the trait's rule.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    unsafe fn le(self, other: Self) -> Self::Mask {
        // SAFETY: the instructions are there by the trait's rule.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    unsafe fn eq(self, other: Self) -> Self::Mask {
        // SAFETY: the instructions are there by the trait's rule.
        unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    unsafe fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: the instructions are there by the trait's rule.
        unsafe { _mm256_and_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: the instructions are there by the trait's rule.
        unsafe { _mm256_or_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn bits(mask: Self::Mask) -> u32 {
        // SAFETY: the instructions are there by the trait's rule.
        unsafe { _mm256_movemask_ps(mask) as u32 }
    }
    #[inline(always)]
    unsafe fn or_else(self, mask: Self::Mask, other: Self) -> Self {
        // SAFETY: the instructions are there by the trait's rule.
        Self(unsafe { _mm256_blendv_ps(other.0, self.0, mask) })
    }
    #[inline(always)]
    unsafe fn prefetch(address: *const u8) {
        // SAFETY: every x86-64 prefetches, and a prefetch never faults.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
    }
}
