//! Continuation of a signal that rings.

/// Samples before the end from which a signal is continued, at most.
const MOST_SAMPLES: usize = 256;
/// Coefficients of the prediction, at most.
const MOST_COEFFICIENTS: usize = 48;

/// The `count` samples that follow `samples`, each predicted from those before it:
///
/// ```text
/// x_n = - sum_k a_k x_{n-k}
/// ```
///
/// The coefficients are those of Burg's method from the last 256 samples, a third as many as samples and at most
/// 48. Decaying sinusoids fulfil such a recurrence exactly with two coefficients each; the method gives it up to the
/// beats that the samples do not show. The recurrence is stable, but a prediction may grow for a while. Too few samples for a coefficient give zeros.
///
/// Source: J. P. Burg, *Maximum Entropy Spectral Analysis*, Ph.D. thesis, Stanford University, 1975; S. M. Kay and S. L.
/// Marple, "Spectrum analysis - a modern perspective", Proc. IEEE 69 (1981) 1380-1419.
pub(crate) fn continued(samples: &[f64], count: usize) -> Vec<f64> {
    let known = &samples[samples.len().saturating_sub(MOST_SAMPLES)..];
    let coefficients = prediction(known);
    let mut all = known.to_vec();
    for _ in 0..count {
        let latest = all.iter().rev().zip(&coefficients);
        all.push(-latest.map(|(sample, coefficient)| sample * coefficient).sum::<f64>());
    }
    all.split_off(known.len())
}

/// The coefficients `a_1, a_2, ...` of the samples.
fn prediction(samples: &[f64]) -> Vec<f64> {
    let (mut forward, mut backward) = (samples.to_vec(), samples.to_vec());
    let mut coefficients: Vec<f64> = Vec::new();
    for order in 1..=MOST_COEFFICIENTS.min(samples.len() / 3) {
        // Errors of the prediction of sample n from those before it, and of sample n - order from those behind.
        let pairs = || forward[order..].iter().zip(&backward[order - 1..]);
        let product: f64 = pairs().map(|(f, b)| f * b).sum();
        let power: f64 = pairs().map(|(f, b)| f * f + b * b).sum();
        if power == 0.0 {
            break;
        }
        let reflection = -2.0 * product / power;
        for n in (order..samples.len()).rev() {
            let (f, b) = (forward[n], backward[n - 1]);
            (forward[n], backward[n]) = (f + reflection * b, b + reflection * f);
        }
        let mirrored = coefficients.iter().rev().map(|a| reflection * a).collect::<Vec<_>>();
        coefficients.iter_mut().zip(mirrored).for_each(|(a, mirrored)| *a += mirrored);
        coefficients.push(reflection);
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::continued;

    /// Four modes that beat, 15 samples a period of the lowest.
    fn ringing(n: usize) -> f64 {
        let t = n as f64 / 15.0;
        [(1.0, 1.0, 0.05_f64), (1.57, 0.6, 0.1), (3.1, 0.1, 0.02), (4.7, 0.02, 0.0)]
            .iter()
            .map(|(f, size, decay)| size * (-decay * t).exp() * (TAU * f * t + size).sin())
            .sum()
    }

    #[test]
    fn beating_modes_are_continued_over_a_period_and_a_half() {
        let all: Vec<f64> = (0..600).map(ringing).collect();
        for (length, bound) in [(150, 0.01), (300, 2e-3), (500, 2e-3)] {
            let largest =
                all[length..length + 22].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let found = continued(&all[..length], 22);
            let error = found.iter().zip(&all[length..]).map(|(x, y)| (x - y).abs());
            let error = error.fold(0.0, f64::max) / largest;
            assert!(found.len() == 22 && error < bound, "{length}: {error}");
        }
    }

    #[test]
    fn predictions_of_few_samples_or_of_none_stay_bounded() {
        assert_eq!(continued(&[], 2), [0.0, 0.0]);
        assert_eq!(continued(&[1.0, 2.0], 2), [0.0, 0.0]);
        assert_eq!(continued(&[0.0; 50], 1), [0.0]);
        let tone: Vec<f64> = (0..200).map(|n| (0.4 * f64::from(n)).sin()).collect();
        assert!(continued(&tone, 1000).iter().all(|x| x.abs() <= 1.01));
    }
}
