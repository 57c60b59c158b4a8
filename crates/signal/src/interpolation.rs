//! The Fourier sum at any frequency by interpolation of one FFT.

use crate::bessel::bessel_i0;
use crate::spectrum::Spectrum;
use asperity_transform::fast_length;
use num_complex::Complex64;
use std::cell::RefCell;
use std::f64::consts::{PI, TAU};
use std::rc::Rc;

/// Grid points on either side of a frequency in an interpolated value.
const REACH: usize = 9;
/// Grid points of an interpolated value.
const POINTS: usize = 2 * REACH;
/// Smallest ratio of the points of the FFT to the samples.
const OVERSAMPLING: usize = 2;
/// `pi (2 - 1 / OVERSAMPLING)`: the end of the window's transform, in radians a grid point.
const EDGE: f64 = 1.5 * PI;

/// The transform of one signal, and its derivative, at any frequency.
///
/// The transform of `N` samples is smooth on the grid of an FFT of `M >= 2 N` points, and any value
/// is a short sum over neighbours, with the Kaiser-Bessel window `w` and its transform `W`:
///
/// ```text
/// sum_n x_n exp(-i 2 pi v n / M) = sum_l w(v - l) G_l,   |v - l| <= 9,
/// G = FFT(x_n / W(n)),   w(t) = sinh(b r) / (pi r),  r = sqrt(81 - t^2),  b = 1.5 pi,
/// W(n) = I0(9 sqrt(b^2 - (2 pi n / M)^2)),   |n| <= N / 2.
/// ```
///
/// The truncation error is `1 / W(M/4)` of `sum |x_n|`, below 1e-16; rounding of exponentials of
/// up to 42 makes it 2e-14, twice the error of the direct sum. One value costs 18 products for any
/// `N`.
///
/// Source: J. Keiner, S. Kunis and D. Potts, "Using NFFT 3: a software library for various
/// nonequispaced fast Fourier transforms", ACM Trans. Math. Softw. 36 (2009), 19, appendix C,
/// doi 10.1145/1555386.1555388.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Interpolation {
    /// `G` of the samples, and of the samples times their index.
    plain: Vec<Complex64>,
    ramped: Vec<Complex64>,
    /// Points of the FFT.
    length: usize,
    /// Index of the sample at time zero: the middle one.
    middle: usize,
    sample_rate_hz: f64,
}

impl Interpolation {
    /// The interpolation of checked samples, not empty.
    pub(crate) fn new(samples: &[f64], sample_rate_hz: f64) -> Self {
        let length = fast_length(OVERSAMPLING * samples.len());
        let middle = samples.len() / 2;
        let over = reciprocals(length);
        let (mut plain, mut ramped) = (vec![0.0; length], vec![0.0; length]);
        let (before, after) = samples.split_at(middle);
        for (n, (x, over)) in after.iter().zip(over.iter()).enumerate() {
            plain[n] = x * over;
            ramped[n] = n as f64 * plain[n];
        }
        for (n, (x, over)) in (1..).zip(before.iter().rev().zip(&over[1..])) {
            plain[length - n] = x * over;
            ramped[length - n] = -(n as f64) * plain[length - n];
        }
        let transform = |padded| Spectrum::of(padded, sample_rate_hz).into_values();
        let (plain, ramped) = (transform(plain), transform(ramped));
        Self { plain, ramped, length, middle, sample_rate_hz }
    }

    /// `X(f) exp(i 2 pi f t)`, with the time `t` of the middle sample: the factor of signals of one
    /// length is the same and cancels in their ratios.
    pub(crate) fn value(&self, frequency_hz: f64) -> Complex64 {
        self.stencil(frequency_hz).sum(&self.plain, self.length)
    }

    /// `X` and `dX/df`, both with the factor of [`Interpolation::value`].
    pub(crate) fn value_and_slope(&self, frequency_hz: f64) -> (Complex64, Complex64) {
        let stencil = self.stencil(frequency_hz);
        let value = stencil.sum(&self.plain, self.length);
        let ramped = stencil.sum(&self.ramped, self.length);
        let turn = Complex64::new(0.0, -TAU / self.sample_rate_hz);
        (value, turn * (ramped + value * self.middle as f64))
    }

    /// The values at `k step` for all `k` up to just beyond `high` (Hz), with the factor of
    /// [`Interpolation::value`]; `step` is `rate / (parts length)`.
    pub(crate) fn grid(&self, parts: usize, high: f64) -> Vec<Complex64> {
        let step = self.step(parts);
        let keep = ((high / step).ceil() as usize).saturating_add(2);
        let count = keep.min(parts * (self.length / 2) + 1);
        let windows: Vec<[f64; POINTS]> =
            (0..parts).map(|part| window(part as f64 / parts as f64)).collect();
        let value = |k: usize| {
            let stencil = GridStencil { below: k / parts, weights: windows[k % parts] };
            stencil.sum(&self.plain, self.length)
        };
        (0..count).map(value).collect()
    }

    /// Spacing of the values of [`Interpolation::grid`], in hertz.
    pub(crate) fn step(&self, parts: usize) -> f64 {
        self.sample_rate_hz / (parts * self.length) as f64
    }

    fn stencil(&self, frequency_hz: f64) -> GridStencil {
        let length = self.length as f64;
        // The rounding error of the product is carried along; whole turns are left out.
        let cycles = frequency_hz / self.sample_rate_hz;
        let cycles_tail =
            (-cycles).mul_add(self.sample_rate_hz, frequency_hz) / self.sample_rate_hz;
        let product = cycles * length;
        let tail = cycles.mul_add(length, -product) + cycles_tail * length;
        let below = product.floor();
        let whole = below - length * (below / length).floor();
        GridStencil { below: whole as usize, weights: window(product - below + tail) }
    }
}

/// Weights of the grid points about a frequency.
struct GridStencil {
    /// Index of the grid point below, less than the length of the FFT.
    below: usize,
    weights: [f64; POINTS],
}

impl GridStencil {
    fn sum(&self, values: &[Complex64], length: usize) -> Complex64 {
        let first = self.below.checked_sub(REACH - 1);
        let inside = first.and_then(|at| values.get(at..at + POINTS));
        if let Some(values) = inside {
            let pairs = values.iter().zip(&self.weights);
            return pairs.fold(Complex64::ZERO, |sum, (value, weight)| sum + value * weight);
        }
        // The signal is real: beyond either end lies the mirror image.
        let at = |index: usize| {
            let index = index % length;
            if index < values.len() { values[index] } else { values[length - index].conj() }
        };
        let first = self.below + REACH * length - (REACH - 1);
        let pairs = (first..).zip(&self.weights);
        pairs.fold(Complex64::ZERO, |sum, (index, weight)| sum + at(index) * weight)
    }
}

/// `w` at the 18 grid points about a frequency that lies `fraction` of a step above the ninth.
fn window(fraction: f64) -> [f64; POINTS] {
    std::array::from_fn(|point| {
        let distance = fraction + (REACH as f64 - 1.0) - point as f64;
        let square = (REACH * REACH) as f64 - distance * distance;
        let root = square.max(0.0).sqrt();
        if root > 0.0 { (EDGE * root).sinh() / (PI * root) } else { EDGE / PI }
    })
}

thread_local! {
    /// The last table used; the hits of a test mostly have one length.
    static RECIPROCALS: RefCell<Option<(usize, Rc<[f64]>)>> = const { RefCell::new(None) };
}

/// `1 / W(n)` for `n` up to a quarter of an FFT's length.
fn reciprocals(length: usize) -> Rc<[f64]> {
    RECIPROCALS.with_borrow_mut(|kept| match kept {
        Some((of, table)) if *of == length => Rc::clone(table),
        _ => {
            let reciprocal = |n: usize| {
                let phase = TAU * n as f64 / length as f64;
                1.0 / bessel_i0(REACH as f64 * (EDGE * EDGE - phase * phase).sqrt())
            };
            let table: Rc<[f64]> = (0..=length / (2 * OVERSAMPLING)).map(reciprocal).collect();
            *kept = Some((length, Rc::clone(&table)));
            table
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::absolute_sum;
    use crate::transform::FourierKernel;

    fn noise(count: usize) -> Vec<f64> {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        let next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        std::iter::repeat_with(next).take(count).collect()
    }

    /// Verified against the direct sum, for white noise and for a pulse at either end, at
    /// frequencies over the whole range and beyond, to 2e-14 of `dt sum |x|`, times `2 pi T` for the
    /// slope.
    #[test]
    fn values_and_slopes_are_those_of_the_direct_sum() {
        let rate = 51_200.0;
        for count in [1, 2, 17, 1000, 20_001] {
            let mut ends = vec![0.0; count];
            ends[0] = 1.0;
            ends[count - 1] = -0.7;
            for samples in [noise(count), ends] {
                let fine = Interpolation::new(&samples, rate);
                let absolute = absolute_sum(&samples) / rate;
                let duration = count as f64 / rate;
                for part in [0.0, 1e-7, 1e-3, 0.015_627, 0.123_4, 0.3, 0.499_99, 0.5, 0.7, -0.2] {
                    let frequency = part * rate;
                    let kernel = FourierKernel::new(rate, frequency);
                    let (value, slope) = kernel.transform_and_slope(&samples, 0);
                    let shift = FourierKernel::new(rate, -frequency).transform(&[rate], count / 2);
                    let (found, found_slope) = fine.value_and_slope(frequency);
                    assert_eq!(found, fine.value(frequency));
                    let off = (found - value * shift).norm();
                    assert!(off < 2e-14 * absolute, "{count} {part}: {off:e} of {absolute:e}");
                    let off = (found_slope - slope * shift).norm();
                    assert!(off < 2e-14 * absolute * TAU * duration.max(1.0 / rate), "{off:e}");
                }
            }
        }
    }

    /// Verified against values at single frequencies.
    #[test]
    fn the_grid_has_the_values_of_its_frequencies() {
        let (samples, rate) = (noise(777), 1000.0);
        let fine = Interpolation::new(&samples, rate);
        let absolute = absolute_sum(&samples) / rate;
        for parts in [1, 2, 3] {
            let grid = fine.grid(parts, 123.0);
            let step = fine.step(parts);
            assert!((grid.len() - 1) as f64 * step > 123.0);
            for (k, value) in grid.iter().enumerate() {
                let off = (value - fine.value(k as f64 * step)).norm();
                assert!(off < 2e-14 * absolute, "{parts} {k}: {off:e}");
            }
        }
        assert_eq!(fine.grid(2, f64::INFINITY).len(), 2 * (fine.length / 2) + 1);
    }
}
