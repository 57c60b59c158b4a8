//! Pairwise sums of magnitudes.

/// Samples added without compensation at the leaves of the pairwise sum.
const LEAF: usize = 64;

/// Time average of a contact stiffness over a run.
///
/// ```text
/// K_avr = (1/T) sum |K_c(t)|
/// ```
///
/// - `stiffness`: equally spaced samples in Pa/m (or any one unit, which the
///   result keeps), zero while contact is lost.
///
/// Valid for any finite samples; no samples give NaN. Summed pairwise, so the
/// relative rounding error grows with the logarithm of the number of samples
/// (below `1e-14` for any length that fits in memory). A constant stiffness is its own average.
///
/// Source: Nouira et al., Lubricants 2020, 8(7), 73,
/// doi 10.3390/lubricants8070073, Eq. (8), with `T` the number of samples.
pub fn average_stiffness(stiffness: &[f64]) -> f64 {
    absolute_sum(stiffness) / stiffness.len() as f64
}

/// `sum |x|` by halves.
pub(crate) fn absolute_sum(values: &[f64]) -> f64 {
    if values.len() <= LEAF {
        values.iter().map(|value| value.abs()).sum()
    } else {
        let (left, right) = values.split_at(values.len() / 2);
        absolute_sum(left) + absolute_sum(right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verified against the exact sum of integers, which f64 holds exactly.
    #[test]
    fn the_mean_magnitude_of_alternating_integers_is_exact() {
        let samples: Vec<f64> =
            (1..=100_000).map(|n| if n % 2 == 0 { f64::from(n) } else { -f64::from(n) }).collect();
        assert_eq!(average_stiffness(&samples), 50_000.5);
    }

    /// Verified against the definition: 10^7 times 0.1 summed naively is wrong by 1.6e-10
    /// relative; pairwise rounding allows (64 + log2(10^7 / 64)) units in the last place.
    #[test]
    fn a_constant_is_its_own_average() {
        let samples = vec![0.1; 10_000_000];
        assert!((average_stiffness(&samples) / 0.1 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn no_samples_have_no_average() {
        assert!(average_stiffness(&[]).is_nan());
    }
}
