//! Lookup of one table row per lane.
//!
//! A gather of four coefficients per lane is four gather instructions, each as slow as its loads
//! one by one. A row is one load of its own, so the rows of all lanes are loaded whole and
//! transposed in registers: on the machines measured less than half the time of the gathers.

use pulp::Simd;

/// Coefficients of a cubic, lowest order first.
pub(in crate::modal) type TableRow = [f64; 4];

/// Row of a lane whose place is not a number: on these machines the maximum and the minimum
/// of such a place are not numbers either.
#[cfg(target_arch = "aarch64")]
const NOWHERE: TableRow = [f64::NAN; 4];

/// Vectors with table lookup.
pub(super) trait TableLookup: Simd {
    /// Coefficient by coefficient, the row of each lane: the low 32 bits of its bits are the
    /// row's number.
    ///
    /// The caller has clamped the number to the table, not-a-numbers included. The bounds check
    /// that is left ends in a panic that never happens: a call that came back would make the
    /// compiler keep every vector in memory across it.
    fn lookup(self, rows: &[TableRow], index: Self::f64s) -> [Self::f64s; 4];
}

impl TableLookup for pulp::Scalar {
    #[inline(always)]
    fn lookup(self, rows: &[TableRow], index: f64) -> [f64; 4] {
        rows[index.to_bits() as u32 as usize]
    }
}

#[cfg(target_arch = "x86_64")]
impl TableLookup for pulp::x86::V3 {
    #[inline(always)]
    fn lookup(self, rows: &[TableRow], index: pulp::f64x4) -> [pulp::f64x4; 4] {
        let bits: [u32; 8] = pulp::cast(index);
        let load = |lane: usize| pulp::cast(rows[bits[2 * lane] as usize]);
        let [r0, r1, r2, r3] = [load(0), load(1), load(2), load(3)];
        let (low01, high01) =
            (self.avx._mm256_unpacklo_pd(r0, r1), self.avx._mm256_unpackhi_pd(r0, r1));
        let (low23, high23) =
            (self.avx._mm256_unpacklo_pd(r2, r3), self.avx._mm256_unpackhi_pd(r2, r3));
        [
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x20>(low01, low23)),
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x20>(high01, high23)),
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x31>(low01, low23)),
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x31>(high01, high23)),
        ]
    }
}

#[cfg(target_arch = "x86_64")]
impl TableLookup for pulp::x86::V4 {
    #[inline(always)]
    fn lookup(self, rows: &[TableRow], index: pulp::f64x8) -> [pulp::f64x8; 4] {
        let f = self.avx512f;
        let low = f._mm512_cvtepi64_epi32(pulp::cast(index));
        let bits: [u32; 8] = pulp::cast(low);
        let load = |lane: usize| pulp::cast(rows[bits[lane] as usize]);
        // Lanes l and l + 4 in the halves of one register, then a transpose within the halves.
        let pair = |lane: usize| {
            f._mm512_insertf64x4::<1>(f._mm512_castpd256_pd512(load(lane)), load(lane + 4))
        };
        let [r0, r1, r2, r3] = [pair(0), pair(1), pair(2), pair(3)];
        let (low01, high01) = (f._mm512_unpacklo_pd(r0, r1), f._mm512_unpackhi_pd(r0, r1));
        let (low23, high23) = (f._mm512_unpacklo_pd(r2, r3), f._mm512_unpackhi_pd(r2, r3));
        let first = pulp::cast([0_u64, 1, 8, 9, 4, 5, 12, 13]);
        let second = pulp::cast([2_u64, 3, 10, 11, 6, 7, 14, 15]);
        [
            pulp::cast(f._mm512_permutex2var_pd(low01, first, low23)),
            pulp::cast(f._mm512_permutex2var_pd(high01, first, high23)),
            pulp::cast(f._mm512_permutex2var_pd(low01, second, low23)),
            pulp::cast(f._mm512_permutex2var_pd(high01, second, high23)),
        ]
    }
}

#[cfg(target_arch = "aarch64")]
impl TableLookup for pulp::aarch64::Neon {
    #[inline(always)]
    fn lookup(self, rows: &[TableRow], index: pulp::f64x2) -> [pulp::f64x2; 4] {
        let bits: [u64; 2] = pulp::cast(index);
        let row = |index: u64| rows.get(index as u32 as usize).unwrap_or(&NOWHERE);
        let (a, b) = (row(bits[0]), row(bits[1]));
        std::array::from_fn(|k| pulp::cast([a[k], b[k]]))
    }
}
