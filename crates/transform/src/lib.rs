//! Fast Fourier transforms of real samples.
//!
//! [`forward`] and [`inverse`] are the sums without factors; [`fast_length`] is a length at which they are fast. The transforms are those of `rustfft`, by `realfft`; this crate is the only one that compiles them, and
//! chooses their plans so that the bits of a result depend on its samples alone.
//!
//! ```
//! use asperity_transform::{forward, inverse};
//!
//! let values = forward(vec![1.0, 0.0, 0.0, 0.0]);
//! assert_eq!(values.len(), 3);
//! assert!(values.iter().all(|value| (value.re - 1.0).abs() < 1e-15 && value.im == 0.0));
//! assert_eq!(inverse(values, 4), [4.0, 0.0, 0.0, 0.0]);
//! ```

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

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

/// `X_k = sum_n x_n exp(-i 2 pi k n / M)` of M samples, for whole k from 0 to M/2.
///
/// Values are NaN where samples are not finite; no samples have the sum 0.
pub fn forward(mut samples: Vec<f64>) -> Vec<Complex64> {
    let length = samples.len();
    if length == 0 {
        return vec![Complex64::ZERO];
    }
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

/// M times the M real samples whose transform is `values`, for whole k from 0 to M/2.
///
/// The imaginary parts of the first value, and of the last of an even M, are taken for zero. NaN where there are not
/// as many values.
pub fn inverse(mut values: Vec<Complex64>, length: usize) -> Vec<f64> {
    if length == 0 {
        return Vec::new();
    }
    if let Some(first) = values.first_mut() {
        first.im = 0.0;
    }
    if length.is_multiple_of(2)
        && let Some(last) = values.last_mut()
    {
        last.im = 0.0;
    }
    let plan = PLANS.with_borrow_mut(|plans| {
        plan_of(&mut plans.inverse, length, |planner| planner.plan_fft_inverse(length))
    });
    let mut samples = plan.make_output_vec();
    // Fails where the number of values is another.
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
    use std::f64::consts::TAU;

    /// On new threads, after transforms of shorter lengths and without: the same bits.
    #[test]
    fn transforms_do_not_depend_on_earlier_ones() {
        let lengths: [usize; 13] =
            [96, 288, 320, 720, 864, 1152, 1500, 1920, 2304, 2400, 3840, 5760, 8640];
        let transforms = |earlier: Vec<usize>, length: usize| {
            let transform = move || {
                let samples = |n: usize| -> Vec<f64> { (0..n).map(|i| (i as f64).sin()).collect() };
                for other in earlier {
                    inverse(forward(samples(other)), other);
                }
                let values = forward(samples(length));
                (inverse(values.clone(), length), values)
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

    /// Against the sums themselves, of even and odd lengths, and back.
    #[test]
    fn transforms_are_their_sums() {
        for length in [1_usize, 2, 3, 8, 15, 30, 77, 240] {
            let samples: Vec<f64> = (0..length).map(|n| (1.3 * n as f64 + 0.4).sin()).collect();
            let values = forward(samples.clone());
            assert_eq!(values.len(), length / 2 + 1);
            for (k, value) in values.iter().enumerate() {
                let turn =
                    |n: usize| Complex64::cis(-TAU * (k * n % length) as f64 / length as f64);
                let sum: Complex64 = samples.iter().enumerate().map(|(n, x)| x * turn(n)).sum();
                assert!((value - sum).norm() < 1e-13 * length as f64, "{length} {k}");
            }
            for (back, sample) in inverse(values, length).iter().zip(&samples) {
                assert!((back / length as f64 - sample).abs() < 1e-14, "{length}");
            }
        }
        assert_eq!(forward(Vec::new()), [Complex64::ZERO]);
        assert_eq!(inverse(Vec::new(), 0), [0.0; 0]);
        assert!(inverse(vec![Complex64::ONE; 4], 4).iter().all(|sample| sample.is_nan()));
        assert!(inverse(Vec::new(), 4).iter().all(|sample| sample.is_nan()));
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
