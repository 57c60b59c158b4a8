//! The Fourier sum on the grid of an FFT.

use crate::error::{Result, SignalError, check_rate, check_samples};
use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

/// Largest zero padding; use [`transform_at`](crate::transform_at) for denser grids.
pub(crate) const PADDING_LIMIT: usize = 1024;

/// Plans of either direction kept by a thread.
const MOST_PLANS: usize = 64;

/// Plans of the lengths that a thread has transformed: a sweep transforms thousands of records of one
/// length.
///
/// Each is of a planner of its own. One planner for all would build a plan on parts of earlier
/// ones, and the last bits of a transform would depend on what the thread had transformed before.
#[derive(Default)]
struct Plans {
    forward: HashMap<usize, Arc<dyn RealToComplex<f64>>>,
    inverse: HashMap<usize, Arc<dyn ComplexToReal<f64>>>,
}

thread_local! {
    static PLANS: RefCell<Plans> = RefCell::new(Plans::default());
}

/// The plan of a length among `plans`, made where there is none.
fn plan_of<P: ?Sized>(
    plans: &mut HashMap<usize, Arc<P>>,
    length: usize,
    make: impl FnOnce(&mut RealFftPlanner<f64>) -> Arc<P>,
) -> Arc<P> {
    if plans.len() >= MOST_PLANS && !plans.contains_key(&length) {
        plans.clear();
    }
    let plan = plans.entry(length).or_insert_with(|| make(&mut RealFftPlanner::new()));
    Arc::clone(plan)
}

/// One-sided Fourier transform of a real signal by the rectangle rule.
///
/// ```text
/// X(f_k) = dt * sum_n x_n exp(-i 2 pi f_k n dt),   f_k = k / (M dt),   0 <= k <= M/2
/// ```
///
/// Rectangular window and no detrending: the record is the whole
/// transient. Zero padding to `M` samples interpolates the transform and adds
/// no information. The values have the unit of the samples times seconds and
/// tend to the continuous transform as `dt` tends to zero.
///
/// ```
/// use asperity_signal::Spectrum;
///
/// let spectrum = Spectrum::new(&[1.0; 8], 8.0, 1)?;
/// assert_eq!(spectrum.frequency_step(), 1.0);
/// assert!((spectrum.values()[0].re - 1.0).abs() < 1e-15);
/// assert!(spectrum.values()[1].norm() < 1e-15);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    values: Vec<Complex64>,
    frequency_step: f64,
}

impl Spectrum {
    /// Transforms `samples`, zero-padded to [`fast_length`]`(padding * samples.len())`.
    ///
    /// - `samples`: any unit, the first at time zero.
    /// - `sample_rate_hz`: positive, in hertz.
    /// - `padding`: 1 (none) to 1024.
    ///
    /// # Errors
    /// [`SignalError::Empty`], [`SignalError::NotFinite`], [`SignalError::SampleRate`], [`SignalError::Padding`].
    pub fn new(samples: &[f64], sample_rate_hz: f64, padding: usize) -> Result<Self> {
        check_samples("signal", samples)?;
        check_rate(sample_rate_hz)?;
        if !(1..=PADDING_LIMIT).contains(&padding) {
            return Err(SignalError::Padding { value: padding, limit: PADDING_LIMIT });
        }
        let length = fast_length(padding * samples.len());
        Ok(Self::padded_to(samples, sample_rate_hz, length))
    }

    /// The transform of checked samples, zero-padded to an even `length` they fit in.
    pub(crate) fn padded_to(samples: &[f64], sample_rate_hz: f64, length: usize) -> Self {
        let mut padded = vec![0.0; length];
        padded[..samples.len()].copy_from_slice(samples);
        Self::of(padded, sample_rate_hz)
    }

    /// The transform of an even number of checked samples.
    pub(crate) fn of(samples: Vec<f64>, sample_rate_hz: f64) -> Self {
        let frequency_step = sample_rate_hz / samples.len() as f64;
        let mut values = forward_transform(samples);
        let time_step = 1.0 / sample_rate_hz;
        for value in &mut values {
            *value *= time_step;
        }
        Self { values, frequency_step }
    }

    /// Spacing of the bins `1 / (M dt)`, in hertz.
    pub fn frequency_step(&self) -> f64 {
        self.frequency_step
    }

    /// Frequency of bin `index`, in hertz.
    pub fn frequency(&self, index: usize) -> f64 {
        index as f64 * self.frequency_step
    }

    /// The transform from zero to half the sample rate, both included.
    pub fn values(&self) -> &[Complex64] {
        &self.values
    }

    /// The transform, by value.
    pub(crate) fn into_values(self) -> Vec<Complex64> {
        self.values
    }
}

/// `sum_n x_n exp(-i 2 pi k n / M)` of an even number M of samples, for k from 0 to M/2.
pub(crate) fn forward_transform(mut samples: Vec<f64>) -> Vec<Complex64> {
    let length = samples.len();
    let plan = PLANS.with_borrow_mut(|plans| {
        plan_of(&mut plans.forward, length, |planner| planner.plan_fft_forward(length))
    });
    let mut values = plan.make_output_vec();
    // Cannot fail, since the plan made the buffer; NaN otherwise.
    if plan.process(&mut samples, &mut values).is_err() {
        values.fill(Complex64::new(f64::NAN, f64::NAN));
    }
    values
}

/// `length` times the real samples with the transform `values`, from bins 0 to `length / 2`.
pub(crate) fn inverse_transform(mut values: Vec<Complex64>, length: usize) -> Vec<f64> {
    for real in [0, length / 2] {
        values[real].im = 0.0;
    }
    let plan = PLANS.with_borrow_mut(|plans| {
        plan_of(&mut plans.inverse, length, |planner| planner.plan_fft_inverse(length))
    });
    let mut samples = plan.make_output_vec();
    // Cannot fail, since the plan fits the buffers; NaN otherwise.
    if plan.process(&mut values, &mut samples).is_err() {
        samples.fill(f64::NAN);
    }
    samples
}

/// The smallest even `2^a 3^b 5^c` not below `minimum`, a fast length of an FFT.
///
/// Even, so that the last bin is at half the sample rate; zero gives 2.
pub fn fast_length(minimum: usize) -> usize {
    let half = minimum.div_ceil(2).max(1);
    let mut best = half.next_power_of_two();
    let mut fives = 1;
    while fives < best {
        let mut odd = fives;
        while odd < best {
            let twos = half.div_ceil(odd).next_power_of_two();
            best = best.min(odd * twos);
            odd *= 3;
        }
        fives *= 5;
    }
    2 * best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On new threads, after transforms of shorter lengths and without: the same bits.
    #[test]
    fn transforms_do_not_depend_on_earlier_ones() {
        let lengths: [usize; 13] =
            [96, 288, 320, 720, 864, 1152, 1500, 1920, 2304, 2400, 3840, 5760, 8640];
        let transforms = |earlier: Vec<usize>, length: usize| {
            let transform = move || {
                let samples = |n: usize| -> Vec<f64> { (0..n).map(|i| (i as f64).sin()).collect() };
                for other in earlier {
                    inverse_transform(forward_transform(samples(other)), other);
                }
                let values = forward_transform(samples(length));
                (inverse_transform(values.clone(), length), values)
            };
            std::thread::spawn(transform).join().unwrap()
        };
        for length in lengths {
            let divisors = (2..length).filter(|n| length.is_multiple_of(*n) && n % 2 == 0);
            let (alone, after) =
                (transforms(Vec::new(), length), transforms(divisors.collect(), length));
            assert_eq!(alone, after, "{length}");
        }
    }

    /// Verified against exhaustive factorisation.
    #[test]
    fn fast_length_is_the_smallest_even_five_smooth_number() {
        let smooth = |mut n: usize| {
            for prime in [2, 3, 5] {
                while n.is_multiple_of(prime) {
                    n /= prime;
                }
            }
            n == 1
        };
        for minimum in 1..3000_usize {
            let expected =
                (minimum..=2 * minimum + 2).find(|n| n.is_multiple_of(2) && smooth(*n)).unwrap();
            assert_eq!(fast_length(minimum), expected, "minimum {minimum}");
        }
        assert_eq!(fast_length(0), 2);
    }
}
