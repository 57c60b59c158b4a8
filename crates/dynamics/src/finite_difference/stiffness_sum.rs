//! The sum of a contact's stiffness over the steps.

/// Most ratio between the first pressure of a group of steps and any other of it.
const MOST_RATIO: f64 = 1.06;

/// Sum of the stiffness \[Pa/m\] of one contact over the steps of a run in which it is closed.
///
/// A law is too dear to be read in every step. So steps are grouped for as long as their pressures differ by
/// no more than 6 % from the first of them, and a group of n steps counts with the stiffness at one standard
/// deviation s below and above its mean pressure p, `n (K(p - s) + K(p + s)) / 2`. That is exact up to K's
/// second derivative; the third enters with the third moment of the pressures, for a power law of exponent m
/// with less than `|m (m - 1) (m - 2)| 4e-5` of the sum. It does not matter how many steps a group has, in
/// which order they come, or how often contact opens between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct StiffnessSum {
    /// Sum over the groups before \[Pa/m\].
    sum: f64,
    /// First pressure \[Pa\] of the latest group.
    first: f64,
    /// Steps of it, and the sums of their pressures beyond the first \[Pa\] and of the squares of these.
    moments: [f64; 3],
    /// Lowest and highest pressure \[Pa\] that it takes.
    range: [f64; 2],
}

impl StiffnessSum {
    /// The sum before the first step.
    pub(super) const EMPTY: Self =
        Self { sum: 0.0, first: 0.0, moments: [0.0; 3], range: [f64::INFINITY, f64::NEG_INFINITY] };

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
    }

    /// Begins a group with a step that has this `pressure` \[Pa\].
    #[cold]
    #[inline(never)]
    fn begin(&mut self, pressure: f64, stiffness: impl Fn(f64) -> f64) {
        self.sum = self.total(stiffness);
        (self.first, self.moments) = (pressure, [0.0; 3]);
        self.range = if pressure > 0.0 {
            [pressure / MOST_RATIO, pressure * MOST_RATIO]
        } else {
            // A contact that carries tension has a constant stiffness.
            [f64::NEG_INFINITY, 0.0]
        };
    }

    /// The sum over all steps that were counted, of a law with that `stiffness` \[Pa/m\].
    pub(super) fn total(&self, stiffness: impl Fn(f64) -> f64) -> f64 {
        let [steps, sum, squares] = self.moments;
        if steps == 0.0 {
            return self.sum;
        }
        let mean = sum / steps;
        let deviation = (squares / steps - mean * mean).max(0.0).sqrt();
        let pressure = self.first + mean;
        let values = stiffness(pressure - deviation) + stiffness(pressure + deviation);
        self.sum + 0.5 * steps * values
    }
}

#[cfg(test)]
mod tests {
    use super::StiffnessSum;

    /// The sum over `pressures` of a law with that `stiffness`, and how often that was read.
    fn summed(pressures: &[f64], stiffness: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut sum = StiffnessSum::EMPTY;
        let readings = std::cell::Cell::new(0);
        let stiffness = |pressure| {
            readings.set(readings.get() + 1);
            stiffness(pressure)
        };
        pressures.iter().for_each(|pressure| sum.count(*pressure, &stiffness));
        (sum.total(stiffness), readings.get())
    }

    #[test]
    fn a_constant_stiffness_counts_once_for_each_step() {
        assert_eq!(summed(&[], |_| 3.0), (0.0, 0));
        assert_eq!(summed(&[1.0], |_| 3.0), (3.0, 2));
        assert_eq!(summed(&[1.0; 1000], |_| 3.0), (3000.0, 2));
        let tension: Vec<_> = (0..100).map(|step| 20.0 - f64::from(step)).collect();
        let (sum, readings) = summed(&tension, |_| 3.0);
        assert_eq!(sum, 300.0);
        assert!(readings < 40, "{readings}");
    }

    /// Contacts that close and open in a half sine of 3 to 3000 steps, as of hits: `stiffness` off by less
    /// than `bound`.
    fn assert_close(bound: f64, stiffness: impl Fn(f64) -> f64) {
        for length in [3, 20, 100, 700, 3000] {
            let phase = |step| (f64::from(step) + 0.3) / f64::from(length);
            let pressure = |step| 2e6 * (std::f64::consts::PI * phase(step)).sin();
            let pressures: Vec<_> = (0..length).map(pressure).collect();
            let exact: f64 = pressures.iter().map(|pressure| stiffness(*pressure)).sum();
            let (sum, readings) = summed(&pressures, &stiffness);
            assert!((sum / exact - 1.0).abs() < bound, "{length}: {sum} {exact}");
            assert!(readings <= 2 * length.min(160) as usize, "{length}: {readings}");
        }
    }

    #[test]
    fn stiffnesses_of_power_laws_are_within_their_bound() {
        for exponent in [0.1, 0.4, 1.0, 2.5] {
            let bound = f64::abs(exponent * (exponent - 1.0) * (exponent - 2.0)) * 4e-5 + 1e-13;
            assert_close(bound, |pressure| pressure.powf(exponent));
        }
    }

    /// Stiffnesses that do not vanish at zero pressure, and rise by half within a part of the pressures.
    #[test]
    fn a_stiffness_that_changes_within_the_first_pressures_is_read_there() {
        for share in [1e-4, 5e-3, 0.1] {
            let rise = |pressure: f64| 0.5 * pressure / (share * 2e6 + pressure);
            assert_close(2e-5, |pressure| 1.0 + rise(pressure));
        }
    }
}
