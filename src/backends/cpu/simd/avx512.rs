//! The instructions of AVX-512 F.
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use std::arch::x86_64::__m512;

use super::Simd;
use crate::optics::{LANES, Lanes, Mask};

/// By the instructions of AVX-512 F, on a processor that has them.
#[derive(Clone, Copy, Debug)]
pub(in crate::backends::cpu) struct ByAvx512(());

impl ByAvx512 {
    /// # Safety
    /// The processor must have AVX-512 F.
    pub(in crate::backends::cpu) unsafe fn new() -> Self {
        Self(())
    }
}

impl Simd for ByAvx512 {
    type Vector = __m512;

    #[inline(always)]
    fn load(self, from: &Lanes) -> Self::Vector {
        // SAFETY: whoever made `self` vouched for the processor.
        unsafe { kernels::load(from) }
    }

    #[inline(always)]
    fn store(self, vector: Self::Vector, to: &mut Lanes) {
        // SAFETY: as above.
        unsafe { kernels::store(vector, to) }
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::splat(value) }
    }

    #[inline(always)]
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::add(a, b) }
    }

    #[inline(always)]
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::mul(a, b) }
    }

    #[inline(always)]
    fn abs(self, a: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::abs(a) }
    }

    #[inline(always)]
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::min(a, b) }
    }

    #[inline(always)]
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::max(a, b) }
    }

    #[inline(always)]
    fn splat_mask(self, mask: u32) -> Self::Vector {
        self.splat(f32::from_bits(mask))
    }

    #[inline(always)]
    fn select(self, mask: Self::Vector, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::select(mask, a, b) }
    }

    #[inline(always)]
    fn bits_where_less(self, a: Self::Vector, b: Self::Vector) -> u16 {
        // SAFETY: as above.
        unsafe { kernels::bits_where_less(a, b) }
    }

    #[inline(always)]
    fn pack(self, lanes: u16, from: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::pack(lanes, from) }
    }

    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        // SAFETY: as above.
        unsafe { kernels::bits(mask) }
    }

    #[inline(always)]
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { kernels::compress(lanes, from) }
    }

    #[inline(always)]
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        // SAFETY: as above.
        unsafe { kernels::expand(lanes, packed, elsewhere) }
    }

    #[inline(always)]
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { kernels::put(lanes, value, elsewhere) }
    }

    #[inline(always)]
    fn rows(self, table: &[[f32; 4]], at: &[u32; LANES]) -> [Lanes; 4] {
        // SAFETY: as above.
        unsafe { kernels::rows(table, at) }
    }

    #[inline(always)]
    fn pairs(self, table: &[[u32; 2]], at: &[u32; LANES]) -> [[u32; LANES]; 2] {
        // SAFETY: as above.
        unsafe { kernels::pairs(table, at) }
    }
}

/// What hands vectors to functions without these features, as `bytemuck::cast` and closures in them, waits in memory for a second pass of
/// optimisation: none does here.
mod kernels {
    use std::arch::x86_64::{
        __m128, __m512, __m512i, _CMP_LT_OQ, _mm_castpd_ps, _mm_castsi128_pd, _mm_loadh_pd, _mm_loadl_epi64,
        _mm_loadu_ps, _mm512_abs_ps, _mm512_add_ps, _mm512_castpd_ps, _mm512_castps_pd, _mm512_castps_si512,
        _mm512_castps128_ps512, _mm512_castsi512_ps, _mm512_cmp_ps_mask, _mm512_cmpge_epu32_mask, _mm512_insertf32x4,
        _mm512_loadu_epi32, _mm512_loadu_ps, _mm512_mask_expand_ps, _mm512_mask_mov_ps, _mm512_maskz_compress_ps,
        _mm512_max_ps, _mm512_min_ps, _mm512_mul_ps, _mm512_permutex2var_epi32, _mm512_set1_epi32, _mm512_set1_ps,
        _mm512_storeu_epi32, _mm512_storeu_ps, _mm512_ternarylogic_epi32, _mm512_test_epi32_mask, _mm512_unpackhi_pd,
        _mm512_unpackhi_ps, _mm512_unpacklo_pd, _mm512_unpacklo_ps,
    };

    use crate::optics::{LANES, Lanes, Mask};

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn load(from: &Lanes) -> __m512 {
        // SAFETY: sixteen numbers are read from sixteen.
        unsafe { _mm512_loadu_ps(from.as_ptr()) }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn store(vector: __m512, to: &mut Lanes) {
        // SAFETY: sixteen numbers are written to sixteen.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), vector) }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn load_bits(from: &[u32; LANES]) -> __m512i {
        // SAFETY: sixteen numbers are read from sixteen.
        unsafe { _mm512_loadu_epi32(from.as_ptr().cast()) }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn stored(vector: __m512) -> Lanes {
        let mut to = [0.0; LANES];
        store(vector, &mut to);
        to
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn splat(value: f32) -> __m512 {
        _mm512_set1_ps(value)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn add(a: __m512, b: __m512) -> __m512 {
        _mm512_add_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn mul(a: __m512, b: __m512) -> __m512 {
        _mm512_mul_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn abs(a: __m512) -> __m512 {
        _mm512_abs_ps(a)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn min(a: __m512, b: __m512) -> __m512 {
        _mm512_min_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn max(a: __m512, b: __m512) -> __m512 {
        _mm512_max_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn select(mask: __m512, a: __m512, b: __m512) -> __m512 {
        // (mask & a) | (!mask & b), as a table of the three bits.
        const CHOOSE: i32 = 0b1100_1010;
        let (mask, a, b) = (_mm512_castps_si512(mask), _mm512_castps_si512(a), _mm512_castps_si512(b));
        _mm512_castsi512_ps(_mm512_ternarylogic_epi32::<CHOOSE>(mask, a, b))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn bits_where_less(a: __m512, b: __m512) -> u16 {
        _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn pack(lanes: u16, from: __m512) -> __m512 {
        _mm512_maskz_compress_ps(lanes, from)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn bits(mask: &Mask) -> u16 {
        let mask = load_bits(mask);
        _mm512_test_epi32_mask(mask, mask)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn compress(lanes: u16, from: &Lanes) -> Lanes {
        stored(_mm512_maskz_compress_ps(lanes, load(from)))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn expand(lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        let elsewhere = _mm512_set1_ps(elsewhere);
        stored(_mm512_mask_expand_ps(elsewhere, lanes, load(packed)))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn put(lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        stored(_mm512_mask_mov_ps(load(elsewhere), lanes, _mm512_set1_ps(value)))
    }

    /// Panics unless all of `at` are below `len`, in one comparison.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn check(at: &[u32; LANES], len: usize) {
        let len = u32::try_from(len).unwrap_or(u32::MAX);
        let is_beyond = _mm512_cmpge_epu32_mask(load_bits(at), _mm512_set1_epi32(len as i32));
        assert!(is_beyond == 0, "no such row");
    }

    /// One of sixteen numbers, read from memory: of numbers that are in a register already the compiler would take each one out, which
    /// is dearer.
    #[inline]
    fn number(at: &[u32; LANES], lane: usize) -> usize {
        // SAFETY: a reference to a number can be read.
        unsafe { std::ptr::read_volatile(&raw const at[lane]) as usize }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn rows(table: &[[f32; 4]], at: &[u32; LANES]) -> [Lanes; 4] {
        check(at, table.len());
        // SAFETY: `check` compared all of them with the length.
        let (a, b, c, d) = unsafe { (four(table, at, 0), four(table, at, 1), four(table, at, 2), four(table, at, 3)) };
        let (ab_low, ab_high) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        let (ab_low, ab_high) = (_mm512_castps_pd(ab_low), _mm512_castps_pd(ab_high));
        let (cd_low, cd_high) = (_mm512_castps_pd(cd_low), _mm512_castps_pd(cd_high));
        [
            stored(_mm512_castpd_ps(_mm512_unpacklo_pd(ab_low, cd_low))),
            stored(_mm512_castpd_ps(_mm512_unpackhi_pd(ab_low, cd_low))),
            stored(_mm512_castpd_ps(_mm512_unpacklo_pd(ab_high, cd_high))),
            stored(_mm512_castpd_ps(_mm512_unpackhi_pd(ab_high, cd_high))),
        ]
    }

    /// Four rows, four lanes apart, so that unpacking by pairs ends in the order of the lanes.
    ///
    /// # Safety
    /// All of `at` are below the table's length.
    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn four(table: &[[f32; 4]], at: &[u32; LANES], lane: usize) -> __m512 {
        // SAFETY: the caller compared `at` with the length; a row has as many bytes as are loaded.
        unsafe {
            let table = table.as_ptr();
            let rows = _mm512_castps128_ps512(_mm_loadu_ps(table.add(number(at, lane)).cast()));
            let rows = _mm512_insertf32x4::<1>(rows, _mm_loadu_ps(table.add(number(at, lane + 4)).cast()));
            let rows = _mm512_insertf32x4::<2>(rows, _mm_loadu_ps(table.add(number(at, lane + 8)).cast()));
            _mm512_insertf32x4::<3>(rows, _mm_loadu_ps(table.add(number(at, lane + 12)).cast()))
        }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn pairs(table: &[[u32; 2]], at: &[u32; LANES]) -> [[u32; LANES]; 2] {
        const FIRST: [u32; LANES] = [0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30];
        const SECOND: [u32; LANES] = [1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31];
        check(at, table.len());
        // SAFETY: `check` compared all of them with the length.
        let (low, high) = unsafe { (eight(table, at, 0), eight(table, at, 8)) };
        [
            stored_bits(_mm512_permutex2var_epi32(low, load_bits(&FIRST), high)),
            stored_bits(_mm512_permutex2var_epi32(low, load_bits(&SECOND), high)),
        ]
    }

    /// The rows of eight lanes.
    ///
    /// # Safety
    /// All of `at` are below the table's length.
    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn eight(table: &[[u32; 2]], at: &[u32; LANES], lane: usize) -> __m512i {
        // SAFETY: the caller compared `at` with the length.
        unsafe {
            let rows = _mm512_castps128_ps512(two(table, at, lane));
            let rows = _mm512_insertf32x4::<1>(rows, two(table, at, lane + 2));
            let rows = _mm512_insertf32x4::<2>(rows, two(table, at, lane + 4));
            _mm512_castps_si512(_mm512_insertf32x4::<3>(rows, two(table, at, lane + 6)))
        }
    }

    /// The rows of two lanes.
    ///
    /// # Safety
    /// All of `at` are below the table's length.
    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn two(table: &[[u32; 2]], at: &[u32; LANES], lane: usize) -> __m128 {
        // SAFETY: the caller compared `at` with the length; a row has as many bytes as are loaded.
        unsafe {
            let first = _mm_castsi128_pd(_mm_loadl_epi64(table.as_ptr().add(number(at, lane)).cast()));
            _mm_castpd_ps(_mm_loadh_pd(first, table.as_ptr().add(number(at, lane + 1)).cast()))
        }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn stored_bits(vector: __m512i) -> [u32; LANES] {
        let mut to = [0; LANES];
        // SAFETY: sixteen numbers are written to sixteen.
        unsafe { _mm512_storeu_epi32(to.as_mut_ptr().cast(), vector) };
        to
    }
}
