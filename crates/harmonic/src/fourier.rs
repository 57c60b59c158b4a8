//! Real Fourier series on equal samples of a period.
#![allow(
    clippy::inline_always,
    reason = "kernels must be compiled with their caller, for the vector instructions chosen"
)]

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::vector_instructions::vectorised;

/// Tables that take a series of H harmonics to N samples of a period, and samples to 2H harmonics.
///
/// A series is stored as mean, then cosine and sine coefficient of each harmonic,
/// `x = x[0] + sum_k x[2k-1] cos(k th) + x[2k] sin(k th)`, at `th = 2 pi n / N`. For the small
/// numbers in question, sums over tables are faster than an FFT.
#[derive(Debug, Clone)]
pub(crate) struct Fourier {
    harmonics: usize,
    samples: usize,
    /// Rows of `samples` values: 1, cos th, sin th, cos 2 th, ... up to harmonic 2H.
    rows: Vec<f64>,
}

impl Fourier {
    pub(crate) fn new(harmonics: usize, samples: usize) -> Self {
        let mut rows = vec![1.0; samples];
        for k in 1..=2 * harmonics {
            let angle = |n: usize| TAU * ((k * n) % samples) as f64 / samples as f64;
            rows.extend((0..samples).map(|n| angle(n).cos()));
            rows.extend((0..samples).map(|n| angle(n).sin()));
        }
        Self { harmonics, samples, rows }
    }

    /// Tables for [`synthesise`](Self::synthesise) alone, at `shares` of each of equal steps of the
    /// period, step after step.
    pub(crate) fn at_places(harmonics: usize, steps: usize, shares: &[f64]) -> Self {
        let turn = |part: f64| Complex64::from_polar(1.0, TAU * part / steps as f64);
        let starts: Vec<Complex64> = (0..steps).map(|step| turn(step as f64)).collect();
        let samples = steps * shares.len();
        let mut rows = vec![1.0; samples];
        for k in 1..=harmonics {
            let inside: Vec<Complex64> =
                shares.iter().map(|share| turn(k as f64 * share)).collect();
            let at = |step: usize| starts[(k * step) % steps];
            let places = || (0..steps).flat_map(|n| inside.iter().map(move |turn| at(n) * turn));
            rows.extend(places().map(|place| place.re));
            rows.extend(places().map(|place| place.im));
        }
        Self { harmonics, samples, rows }
    }

    /// Tables at any angles, up to harmonic 2H.
    pub(crate) fn at_angles(harmonics: usize, angles: &[f64]) -> Self {
        let mut tables = Self { harmonics, samples: 0, rows: Vec::new() };
        tables.move_to(angles);
        tables
    }

    /// Moves the tables to other angles, as many as are given.
    pub(crate) fn move_to(&mut self, angles: &[f64]) {
        let count = angles.len();
        self.samples = count;
        self.rows.resize((4 * self.harmonics + 1) * count, 0.0);
        let (ones, rest) = self.rows.split_at_mut(count);
        ones.fill(1.0);
        let (cos, sin) = rest.split_at_mut(count);
        for ((angle, cos), sin) in angles.iter().zip(cos).zip(sin) {
            (*sin, *cos) = angle.sin_cos();
        }
        vectorised(
            #[inline(always)]
            || {
                for k in 2..=2 * self.harmonics {
                    let (before, after) = self.rows.split_at_mut((2 * k - 1) * count);
                    let (cos, sin) = after.split_at_mut(count);
                    let (cos_1, sin_1) = before[count..3 * count].split_at(count);
                    let (last_cos, last_sin) = before[(2 * k - 3) * count..].split_at(count);
                    let (sin, last_sin) = (&mut sin[..count], &last_sin[..count]);
                    for n in 0..count {
                        cos[n] = last_cos[n] * cos_1[n] - last_sin[n] * sin_1[n];
                        sin[n] = last_sin[n] * cos_1[n] + last_cos[n] * sin_1[n];
                    }
                }
            },
        );
    }

    pub(crate) fn harmonics(&self) -> usize {
        self.harmonics
    }

    pub(crate) fn samples(&self) -> usize {
        self.samples
    }

    /// Coefficients of a series of H harmonics.
    pub(crate) fn terms(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Term `row` of a series, 1, cos th, sin th, ..., at the samples.
    pub(crate) fn row(&self, row: usize) -> &[f64] {
        &self.rows[row * self.samples..(row + 1) * self.samples]
    }

    /// Rate of change of term `row` at a sample, at the angular frequency `w` \[rad/s\] \[1/s\].
    pub(crate) fn rate(&self, row: usize, sample: usize, w: f64) -> f64 {
        let turning = row.div_ceil(2) as f64 * w;
        match row {
            0 => 0.0,
            cos if cos % 2 == 1 => -turning * self.row(cos + 1)[sample],
            sin => turning * self.row(sin - 1)[sample],
        }
    }

    /// The samples of a series.
    pub(crate) fn synthesise(&self, series: &[f64], samples: &mut [f64]) {
        vectorised(
            #[inline(always)]
            || {
                samples.fill(series[0]);
                for (row, pair) in series[1..].chunks_exact(2).enumerate() {
                    let (cos, sin) = (self.row(2 * row + 1), self.row(2 * row + 2));
                    for ((x, c), s) in samples.iter_mut().zip(cos).zip(sin) {
                        *x += pair[0] * c + pair[1] * s;
                    }
                }
            },
        );
    }

    /// The leading coefficients of the series of samples, as many as `series` holds: up to
    /// `4 H + 1`.
    pub(crate) fn analyse(&self, samples: &[f64], series: &mut [f64]) {
        let scale = 2.0 / self.samples as f64;
        vectorised(
            #[inline(always)]
            || {
                for (row, coefficient) in series.iter_mut().enumerate() {
                    *coefficient = scale * long_dot(self.row(row), samples);
                }
            },
        );
        series[0] *= 0.5;
    }

    /// Derivative of the series of `p(x(th))` with respect to that of x, from the series (to 2H) of the
    /// tangent dp/dx: a square matrix of `terms` rows.
    ///
    /// With `C_k`, `S_k` the cosine and sine coefficients of the tangent and `C_0` twice its mean,
    /// the products of two harmonics give `(C_|j-k| +- C_j+k) / 2` and `(S_j+k +- S_j-k) / 2`, exactly
    /// the derivative of the sampled sums.
    pub(crate) fn product(&self, tangent: &[f64], matrix: &mut [f64]) {
        let terms = self.terms();
        let cos = |k: usize| if k == 0 { 2.0 * tangent[0] } else { tangent[2 * k - 1] };
        let sin = |k: usize| if k == 0 { 0.0 } else { tangent[2 * k] };
        matrix[0] = tangent[0];
        for k in 1..=self.harmonics {
            matrix[2 * k - 1] = 0.5 * cos(k);
            matrix[2 * k] = 0.5 * sin(k);
            matrix[(2 * k - 1) * terms] = cos(k);
            matrix[2 * k * terms] = sin(k);
            for j in 1..=k {
                let (sum, difference) = (cos(j + k), cos(k - j));
                let (sine_sum, sine_difference) = (sin(j + k), sin(k - j));
                let at = |row: usize, column: usize| row * terms + column;
                let (cj, sj, ck, sk) = (2 * j - 1, 2 * j, 2 * k - 1, 2 * k);
                let cc = 0.5 * (difference + sum);
                let ss = 0.5 * (difference - sum);
                let cs = 0.5 * (sine_sum + sine_difference);
                let sc = 0.5 * (sine_sum - sine_difference);
                matrix[at(cj, ck)] = cc;
                matrix[at(ck, cj)] = cc;
                matrix[at(sj, sk)] = ss;
                matrix[at(sk, sj)] = ss;
                // cos j with sin k, and sin j with cos k, for j <= k.
                matrix[at(cj, sk)] = cs;
                matrix[at(sk, cj)] = cs;
                matrix[at(sj, ck)] = sc;
                matrix[at(ck, sj)] = sc;
            }
        }
    }

    /// Adds the derivative of a series with respect to that of x to `matrix`, from its derivative
    /// `product` with respect to the series of the rate of x at the angular frequency `w` \[rad/s\].
    pub(crate) fn add_rates(&self, product: &[f64], w: f64, matrix: &mut [f64]) {
        let terms = self.terms();
        for (row, damped) in matrix.chunks_exact_mut(terms).zip(product.chunks_exact(terms)) {
            for k in 1..=self.harmonics {
                let turning = k as f64 * w;
                row[2 * k - 1] -= turning * damped[2 * k];
                row[2 * k] += turning * damped[2 * k - 1];
            }
        }
    }
}

/// Complex amplitude of harmonic k >= 1 of a series: `a - i b` for `a cos + b sin`.
pub(crate) fn amplitude_of(series: &[f64], k: usize) -> Complex64 {
    Complex64::new(series[2 * k - 1], -series[2 * k])
}

/// Series of the rate of change of `series` at the angular frequency `w` \[rad/s\].
pub(crate) fn rate_of(series: &[f64], w: f64, rate: &mut [f64]) {
    rate[0] = 0.0;
    let pairs = series[1..].chunks_exact(2).zip(rate[1..].chunks_exact_mut(2));
    for (k, (pair, rate)) in (1..).map(f64::from).zip(pairs) {
        (rate[0], rate[1]) = (k * w * pair[1], -k * w * pair[0]);
    }
}

/// Value of a series at the angle `th`, and its first two derivatives.
pub(crate) fn value_at(series: &[f64], th: f64) -> [f64; 3] {
    let mut sum = [series[0], 0.0, 0.0];
    let turn = Complex64::cis(th);
    let mut turned = Complex64::ONE;
    for (k, pair) in (1..).map(f64::from).zip(series[1..].chunks_exact(2)) {
        turned *= turn;
        let (sin, cos) = (turned.im, turned.re);
        let value = pair[0] * cos + pair[1] * sin;
        sum[0] += value;
        sum[1] += k * (pair[1] * cos - pair[0] * sin);
        sum[2] -= k * k * value;
    }
    sum
}

/// Sums of a scalar product: additions to two vectors of 512 bits do not wait for each other.
const SUMS: usize = 16;

/// Scalar product in [`SUMS`] sums, which the compiler may keep in vector registers.
#[inline(always)]
pub(crate) fn long_dot(a: &[f64], b: &[f64]) -> f64 {
    let (blocks_a, rest_a) = a.as_chunks::<SUMS>();
    let (blocks_b, rest_b) = b.as_chunks::<SUMS>();
    let mut sums = [0.0; SUMS];
    for (a, b) in blocks_a.iter().zip(blocks_b) {
        for i in 0..SUMS {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    rest + sums.iter().sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(terms: usize) -> Vec<f64> {
        (0..terms).map(|i| (1.7 * i as f64 + 0.3).sin() / (1.0 + i as f64)).collect()
    }

    #[test]
    fn samples_and_back_is_the_identity() {
        let fourier = Fourier::new(5, 44);
        let x = series(11);
        let mut samples = vec![0.0; 44];
        fourier.synthesise(&x, &mut samples);
        let th = TAU * 7.0 / 44.0;
        assert!((samples[7] - value_at(&x, th)[0]).abs() < 1e-14);
        let mut back = vec![0.0; 11];
        fourier.analyse(&samples, &mut back);
        for (a, b) in x.iter().zip(&back) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    /// The matrix against the series of the product, computed by samples.
    #[test]
    fn the_product_matrix_multiplies_series() {
        let fourier = Fourier::new(4, 40);
        let (tangent, x) = (series(17), series(9));
        let (mut a, mut b) = (vec![0.0; 40], vec![0.0; 40]);
        fourier.synthesise(&tangent, &mut a);
        fourier.synthesise(&x, &mut b);
        let product: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a * b).collect();
        let mut expected = vec![0.0; 9];
        fourier.analyse(&product, &mut expected);
        let mut matrix = vec![f64::NAN; 81];
        fourier.product(&tangent, &mut matrix);
        for (row, expected) in matrix.chunks_exact(9).zip(&expected) {
            let found: f64 = row.iter().zip(&x).map(|(m, x)| m * x).sum();
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
}
