//! The Fourier sum at any frequency.

use num_complex::Complex64;
use std::f64::consts::TAU;

/// Samples per table of phasors; the phase is computed anew for each block.
const BLOCK: usize = 256;
/// Independent partial sums, so that the compiler can use vector registers.
const LANES: usize = 8;
/// Side of the phasor table: `BLOCK = SIDE * SIDE`.
const SIDE: usize = 16;

/// One-sided Fourier transform by the rectangle rule at one frequency.
///
/// ```text
/// X(f) = dt * sum_n x_n exp(-i 2 pi f n dt)
/// ```
///
/// This is the sum of [`Spectrum`](crate::Spectrum) at any frequency.
///
/// - `samples`: any unit, the first at time zero; empty gives zero.
/// - `sample_rate_hz`: positive, in hertz.
/// - `frequency_hz`: any finite frequency in hertz; negative gives the conjugate.
///
/// The result has the unit of the samples times seconds. The rounding error is below `1e-14` of
/// `dt * sum |x_n|`, besides that of the frequency itself, which changes
/// the phase of sample `n` by up to `2 pi f n dt * 1.1e-16`.
///
/// Samples or rates that are not finite give NaN. Limiting case: the rectangle-rule integral of the
/// samples at `f = 0`.
///
/// ```
/// use asperity_signal::transform_at;
///
/// let cosine: Vec<f64> =
///     (0..1000).map(|n| (std::f64::consts::TAU * 5.0 * f64::from(n) / 1000.0).cos()).collect();
/// assert!((transform_at(&cosine, 1000.0, 5.0).re - 0.5).abs() < 1e-12);
/// ```
pub fn transform_at(samples: &[f64], sample_rate_hz: f64, frequency_hz: f64) -> Complex64 {
    FourierKernel::new(sample_rate_hz, frequency_hz).transform(samples, 0)
}

/// [`transform_at`] of two signals sampled together, from one table of phasors.
pub fn transform_pair_at(
    first: &[f64],
    second: &[f64],
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> (Complex64, Complex64) {
    let kernel = FourierKernel::new(sample_rate_hz, frequency_hz);
    (kernel.transform(first, 0), kernel.transform(second, 0))
}

/// Phasors of one frequency: `cos` and `sin` of `2 pi f j dt` over a block.
#[derive(Debug)]
pub(crate) struct FourierKernel {
    cosine: [f64; BLOCK],
    sine: [f64; BLOCK],
    /// Cycles per sample `f dt`, and its rounding error.
    cycles: f64,
    cycles_tail: f64,
    time_step: f64,
}

/// Sums over one block: `sum x e` and `sum j x e`, `j` counted from its start.
struct BlockSums {
    plain: Complex64,
    ramped: Complex64,
}

impl FourierKernel {
    pub(crate) fn new(sample_rate_hz: f64, frequency_hz: f64) -> Self {
        let cycles = frequency_hz / sample_rate_hz;
        let cycles_tail = (-cycles).mul_add(sample_rate_hz, frequency_hz) / sample_rate_hz;
        let mut kernel = Self {
            cosine: [0.0; BLOCK],
            sine: [0.0; BLOCK],
            cycles,
            cycles_tail,
            time_step: 1.0 / sample_rate_hz,
        };
        // exp(i a (SIDE p + q)) = exp(i a SIDE p) exp(i a q): 32 sines and cosines, not 256.
        let fine: [(f64, f64); SIDE] = std::array::from_fn(|q| kernel.phase(q).sin_cos());
        for p in 0..SIDE {
            let (coarse_sine, coarse_cosine) = kernel.phase(SIDE * p).sin_cos();
            for (q, &(sine, cosine)) in fine.iter().enumerate() {
                kernel.cosine[SIDE * p + q] = coarse_cosine * cosine - coarse_sine * sine;
                kernel.sine[SIDE * p + q] = coarse_sine * cosine + coarse_cosine * sine;
            }
        }
        kernel
    }

    /// `2 pi f n dt` reduced to `[-pi, pi]`, the product carried in two terms.
    fn phase(&self, index: usize) -> f64 {
        let n = index as f64;
        let product = self.cycles * n;
        let tail = self.cycles.mul_add(n, -product) + self.cycles_tail * n;
        TAU * ((product - product.round()) + tail)
    }

    /// `dt * sum x_n exp(-i 2 pi f n dt)`, where the first sample has the index `first`.
    pub(crate) fn transform(&self, samples: &[f64], first: usize) -> Complex64 {
        let mut total = Complex64::ZERO;
        for (block, values) in samples.chunks(BLOCK).enumerate() {
            total += self.turn(first + block * BLOCK) * self.block_sums::<false>(values).plain;
        }
        total * self.time_step
    }

    /// The transform `X` and its derivative `dX/df = dt * sum -i 2 pi n dt x_n e`.
    pub(crate) fn transform_and_slope(
        &self,
        samples: &[f64],
        first: usize,
    ) -> (Complex64, Complex64) {
        let (mut total, mut ramped) = (Complex64::ZERO, Complex64::ZERO);
        for (block, values) in samples.chunks(BLOCK).enumerate() {
            let start = first + block * BLOCK;
            let turn = self.turn(start);
            let sums = self.block_sums::<true>(values);
            total += turn * sums.plain;
            ramped += turn * (sums.plain * start as f64 + sums.ramped);
        }
        let dt = self.time_step;
        (total * dt, Complex64::new(0.0, -TAU * dt * dt) * ramped)
    }

    /// `exp(-i 2 pi f n dt)`.
    fn turn(&self, index: usize) -> Complex64 {
        let (sine, cosine) = self.phase(index).sin_cos();
        Complex64::new(cosine, -sine)
    }

    /// The sums over a block; `ramped` is zero unless `RAMPED`.
    fn block_sums<const RAMPED: bool>(&self, values: &[f64]) -> BlockSums {
        let (mut real, mut imaginary) = ([0.0; LANES], [0.0; LANES]);
        let (mut ramped_real, mut ramped_imaginary) = ([0.0; LANES], [0.0; LANES]);
        let (chunks, rest) = values.as_chunks::<LANES>();
        let (cosines, _) = self.cosine.as_chunks::<LANES>();
        let (sines, _) = self.sine.as_chunks::<LANES>();
        let mut ramp: [f64; LANES] = std::array::from_fn(|lane| lane as f64);
        for ((x, c), s) in chunks.iter().zip(cosines).zip(sines) {
            for lane in 0..LANES {
                let (even, odd) = (x[lane] * c[lane], x[lane] * s[lane]);
                real[lane] += even;
                imaginary[lane] += odd;
                if RAMPED {
                    ramped_real[lane] += ramp[lane] * even;
                    ramped_imaginary[lane] += ramp[lane] * odd;
                    ramp[lane] += LANES as f64;
                }
            }
        }
        for (j, x) in (chunks.len() * LANES..).zip(rest) {
            let (even, odd) = (x * self.cosine[j], x * self.sine[j]);
            real[0] += even;
            imaginary[0] += odd;
            if RAMPED {
                ramped_real[0] += j as f64 * even;
                ramped_imaginary[0] += j as f64 * odd;
            }
        }
        BlockSums {
            plain: Complex64::new(lane_sum(&real), -lane_sum(&imaginary)),
            ramped: Complex64::new(lane_sum(&ramped_real), -lane_sum(&ramped_imaginary)),
        }
    }
}

/// Adds the lanes in pairs.
fn lane_sum(lanes: &[f64; LANES]) -> f64 {
    ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3]))
        + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]))
}
