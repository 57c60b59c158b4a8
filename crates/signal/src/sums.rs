//! Sums and largest magnitudes of samples.

/// Partial sums of a dot product, so that the compiler can use vector registers.
const LANES: usize = 8;

/// `sum a_j b_j` over the shorter of two slices.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let b = &b[..a.len().min(b.len())];
    let (chunks, rest) = a.as_chunks::<LANES>();
    let (others, other_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (x, y) in chunks.iter().zip(others) {
        for lane in 0..LANES {
            sums[lane] += x[lane] * y[lane];
        }
    }
    let tail: f64 = rest.iter().zip(other_rest).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + tail
}

/// Samples added one by one at the leaves of the pairwise sum.
const LEAF: usize = 64;

/// `sum |x|`, pairwise: the relative rounding error grows with the logarithm of the number of
/// samples.
pub(crate) fn absolute_sum(values: &[f64]) -> f64 {
    if values.len() <= LEAF {
        values.iter().map(|value| value.abs()).sum()
    } else {
        let (left, right) = values.split_at(values.len() / 2);
        absolute_sum(left) + absolute_sum(right)
    }
}

/// `max |x|`; zero without samples.
pub(crate) fn largest_magnitude(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verified against the exact sum of integers, and against 10^7 times 0.1, whose naive sum has
    /// a relative error of 1.6e-10; pairwise rounding allows (64 + log2(10^7 / 64)) units in the
    /// last place.
    #[test]
    fn pairwise_sums_are_exact_to_rounding() {
        let integers: Vec<f64> =
            (1..=100_000).map(|n| if n % 2 == 0 { f64::from(n) } else { -f64::from(n) }).collect();
        assert_eq!(absolute_sum(&integers), 5_000_050_000.0);
        let samples = vec![0.1; 10_000_000];
        assert!((absolute_sum(&samples) / 1e6 - 1.0).abs() < 1e-14);
    }
}
