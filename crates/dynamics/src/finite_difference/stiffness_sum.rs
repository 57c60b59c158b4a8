//! The sum of a contact's stiffness over the steps.

/// Most ratio between the first pressure of a group of steps and any other of it.
const MOST_RATIO: f64 = 1.06;

/// Sum of the stiffness \[Pa/m\] of one contact over the steps of a run in which it is closed.
///
/// A law is too dear to be read in every step. So steps are grouped for as long as their pressures differ by
/// no more than 6 % from the first of them, and a group counts with the stiffness at two pressures, with
/// shares: those that have the mean, variance and third moment of the group's pressures, as in Gauss's
/// quadrature of two points. That is exact up to K's third derivative; for a power law of exponent m it is off by
/// less than `|m (m - 1) (m - 2) (m - 3)| 5e-7` of the sum. A group does not reach over a kink of the law. It does
/// not matter how many steps a group has, in which order they come, or how often contact opens between them.
#[derive(Debug)]
pub(super) struct StiffnessSum {
    /// Sum over the groups before \[Pa/m\].
    sum: f64,
    /// First pressure \[Pa\] of the latest group.
    first: f64,
    /// Sums over its steps of the powers zero to three of what their pressures are beyond the first \[Pa\].
    moments: [f64; 4],
    /// Lowest and highest pressure \[Pa\] that it takes.
    range: [f64; 2],
    /// Pressures \[Pa\], ascending, at which the stiffness or its slope is not smooth.
    kinks: Vec<f64>,
}

impl StiffnessSum {
    /// The sum before the first step, for a law with `kinks` at these pressures \[Pa\], ascending.
    pub(super) fn new(kinks: Vec<f64>) -> Self {
        let range = [f64::INFINITY, f64::NEG_INFINITY];
        Self { sum: 0.0, first: 0.0, moments: [0.0; 4], range, kinks }
    }

    /// Counts a step with a `pressure` \[Pa\], closed, of a law with that `stiffness` \[Pa/m\].
    #[inline(always)]
    pub(super) fn count(&mut self, pressure: f64, stiffness: impl Fn(f64) -> f64) {
        if pressure < self.range[0] || pressure > self.range[1] {
            self.begin(pressure, stiffness);
        }
        let beyond = pressure - self.first;
        self.moments[0] += 1.0;
        self.moments[1] += beyond;
        self.moments[2] += beyond * beyond;
        self.moments[3] += beyond * beyond * beyond;
    }

    /// Begins a group with a step that has this `pressure` \[Pa\].
    #[cold]
    #[inline(never)]
    fn begin(&mut self, pressure: f64, stiffness: impl Fn(f64) -> f64) {
        self.sum = self.total(stiffness);
        (self.first, self.moments) = (pressure, [0.0; 4]);
        self.range = if pressure > 0.0 {
            [pressure / MOST_RATIO, pressure * MOST_RATIO]
        } else {
            // A contact that carries tension has a constant stiffness.
            [f64::NEG_INFINITY, 0.0]
        };
        let above = self.kinks.partition_point(|kink| *kink <= pressure);
        if let Some(kink) = above.checked_sub(1).map(|below| self.kinks[below]) {
            self.range[0] = self.range[0].max(kink);
        }
        if let Some(kink) = self.kinks.get(above) {
            self.range[1] = self.range[1].min(*kink);
        }
    }

    /// The sum over all steps that were counted, of a law with that `stiffness` \[Pa/m\].
    pub(super) fn total(&self, stiffness: impl Fn(f64) -> f64) -> f64 {
        let [steps, first, second, third] = self.moments;
        if steps == 0.0 {
            return self.sum;
        }
        let mean = first / steps;
        let variance = second / steps - mean * mean;
        let skew = third / steps - mean * (3.0 * variance + mean * mean);
        // The points lie at the roots x of x^2 - (skew / variance) x - variance about the mean. A variance of
        // rounding errors, of which a skew means nothing, is none.
        let pressure = self.first + mean;
        if variance <= 1e-12 * pressure * pressure {
            return self.sum + steps * stiffness(pressure);
        }
        let middle = 0.5 * skew / variance;
        let half = (variance + middle * middle).sqrt();
        let share = 0.5 - 0.5 * middle / half;
        let [low, high] = [middle - half, middle + half].map(|x| stiffness(pressure + x));
        self.sum + steps * (low + share * (high - low))
    }
}

#[cfg(test)]
mod tests {
    use super::StiffnessSum;

    /// The sum over `pressures` of a law with that `stiffness` and `kinks`, and how often it was read.
    fn summed(pressures: &[f64], kinks: &[f64], stiffness: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut sum = StiffnessSum::new(kinks.to_vec());
        let readings = std::cell::Cell::new(0);
        let stiffness = |pressure| {
            readings.set(readings.get() + 1);
            stiffness(pressure)
        };
        for pressure in pressures {
            sum.count(*pressure, stiffness);
        }
        (sum.total(stiffness), readings.get())
    }

    #[test]
    fn a_constant_stiffness_counts_once_for_each_step() {
        assert_eq!(summed(&[], &[], |_| 3.0), (0.0, 0));
        assert_eq!(summed(&[1.0], &[], |_| 3.0), (3.0, 1));
        assert_eq!(summed(&[1.0; 1000], &[], |_| 3.0), (3000.0, 1));
        let tension: Vec<_> = (0..100).map(|step| 20.0 - f64::from(step)).collect();
        let (sum, readings) = summed(&tension, &[], |_| 3.0);
        assert_eq!(sum, 300.0);
        assert!(readings < 40, "{readings}");
    }

    /// Contacts that close and open in a half sine of 3 to 3000 steps, as of hits: `stiffness` off by less
    /// than `bound`.
    fn assert_close(bound: f64, kinks: &[f64], stiffness: impl Fn(f64) -> f64) {
        for length in [3, 20, 100, 700, 3000] {
            let phase = |step| (f64::from(step) + 0.3) / f64::from(length);
            let pressure = |step| 2e6 * (std::f64::consts::PI * phase(step)).sin();
            let pressures: Vec<_> = (0..length).map(pressure).collect();
            let exact: f64 = pressures.iter().map(|pressure| stiffness(*pressure)).sum();
            let (sum, readings) = summed(&pressures, kinks, &stiffness);
            assert!((sum / exact - 1.0).abs() < bound, "{length}: {sum} {exact}");
            assert!(readings <= 2 * length.min(160) as usize, "{length}: {readings}");
        }
    }

    #[test]
    fn stiffnesses_of_power_laws_are_within_their_bound() {
        for exponent in [0.1, 0.4, 1.0, 2.5] {
            let product: f64 = (0..4).map(|k| exponent - f64::from(k)).product();
            let bound = product.abs() * 5e-7 + 1e-12;
            assert_close(bound, &[], |pressure| pressure.powf(exponent));
        }
    }

    /// Stiffnesses that do not vanish at zero pressure, and rise by half within a part of the pressures.
    #[test]
    fn a_stiffness_that_changes_within_the_first_pressures_is_read_there() {
        for share in [1e-4, 5e-3, 0.1] {
            let rise = |pressure: f64| 0.5 * pressure / (share * 2e6 + pressure);
            assert_close(1e-6, &[], |pressure| 1.0 + rise(pressure));
        }
    }

    /// A stiffness whose slope jumps at a tenth of the highest pressure, as in tables that are joined linearly.
    #[test]
    fn groups_end_at_kinks_of_the_law() {
        let stiffness = |pressure: f64| 1.0 + pressure.min(2e5) / 2e5;
        assert_close(1e-12, &[2e5], stiffness);
    }
}
