//! Length of a decay in a record.

/// Share of the energy of a decay, over noise, up to which time is counted.
const SHARE: f64 = 0.995;
/// Length returned over the time in which that energy arrives.
const MARGIN: f64 = 1.5;
/// Part of the record at its end that gives the noise.
const TAIL: usize = 10;
/// Least energy of a decay over the energy of the record.
const LEAST: f64 = 0.1;

/// Number of samples in which a decay falls to about 2 % of its start; the whole record if it does
/// not decay in it.
///
/// The time in which 99.5 % of the energy has arrived, times 1.5. Of `exp(-a t)` these are
/// `ln(200) / (2 a)` and `3.97 / a`, when the amplitude is 1.9 %. The energy of each sample is taken
/// less the mean square of the last tenth of the record, which is noise where the decay has ended.
///
/// - `samples`: the decay from the excitation on, about zero, in any unit.
pub fn decay_length(samples: &[f64]) -> usize {
    let all = samples.len();
    let tail = &samples[all - all / TAIL..];
    let energy = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>();
    let noise = if tail.is_empty() { 0.0 } else { energy(tail) / tail.len() as f64 };
    let whole = energy(samples);
    let decay = whole - noise * all as f64;
    let measurable = decay > LEAST * whole;
    if !measurable {
        return all;
    }
    let mut sum = 0.0;
    let arrived = samples.iter().position(|x| {
        sum += x * x - noise;
        sum >= SHARE * decay
    });
    arrived.map_or(all, |sample| ((MARGIN * (sample + 1) as f64).ceil() as usize).min(all))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ringing(rate_per_sample: f64, count: u32, noise: f64) -> Vec<f64> {
        let random =
            |n: u32| f64::from(n.wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24);
        let decay = |n: u32| (-rate_per_sample * f64::from(n)).exp() * (0.3 * f64::from(n)).cos();
        (0..count).map(|n| decay(n) + noise * (random(n) - 0.5)).collect()
    }

    #[test]
    fn an_exponential_decay_has_its_exact_length() {
        let length = decay_length(&ringing(0.002, 20_000, 0.0)) as f64;
        let exact = 1.5 * 200_f64.ln() / (2.0 * 0.002);
        assert!((length - exact).abs() < 0.01 * exact, "{length}, not {exact}");
    }

    #[test]
    fn noise_does_not_lengthen_a_decay() {
        let (quiet, noisy) = (ringing(0.01, 20_000, 0.0), ringing(0.01, 20_000, 0.05));
        let (quiet, noisy) = (decay_length(&quiet) as f64, decay_length(&noisy) as f64);
        assert!((noisy / quiet - 1.0).abs() < 0.3, "{quiet} and {noisy}");
    }

    #[test]
    fn what_does_not_decay_is_kept_whole() {
        assert_eq!(decay_length(&ringing(0.0, 5_000, 0.0)), 5_000);
        assert_eq!(decay_length(&[0.0; 50]), 50);
        assert_eq!(decay_length(&[]), 0);
        assert_eq!(decay_length(&[f64::NAN; 30]), 30);
    }
}
