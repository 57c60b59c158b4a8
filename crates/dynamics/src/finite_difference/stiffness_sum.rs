//! The sum of a contact's stiffness over the steps.

/// Most change of the stiffness, over itself, expected from one reading to the next.
const MOST_CHANGE: f64 = 0.1;

/// Most steps from one reading to the next, over those since contact has closed.
const MOST_SHARE: f64 = 0.125;

/// Sum of the stiffness \[Pa/m\] of one contact over the steps of a run.
///
/// A law is too dear to be read in every step. So the stiffness is read many steps apart and taken
/// to be linear between two readings (trapezoidal rule, of second order in their distance). Where it
/// changes by more than a tenth, as before contact opens, and after contact has closed it is read more
/// often. Where contact opens or closes it jumps between zero and the stiffness of the law at zero pressure;
/// these steps are counted exactly, with that stiffness as a reading of its own. Without that the sum
/// of a contact that is closed for a hundred readings would be off by up to one of them, 1 %.
#[derive(Debug, Clone, Copy)]
pub(super) struct StiffnessSum {
    /// Sum up to the latest reading \[Pa/m\].
    sum: f64,
    /// The latest reading \[Pa/m\], zero while the contact is open; none before the first.
    latest: Option<f64>,
    /// Steps since, or since the run's beginning half a step before the first.
    steps: f64,
    /// Steps from one reading to the next, at least one; others may come before.
    distance: f64,
    /// Steps from closing to the latest reading.
    closed: f64,
    open: bool,
}

impl StiffnessSum {
    /// The sum before the first step.
    pub(super) const EMPTY: Self = Self {
        sum: 0.0,
        latest: None,
        steps: -0.5,
        distance: f64::INFINITY,
        closed: f64::INFINITY,
        open: false,
    };

    /// Counts a step; true if the contact, `open` or not, has changed sides in it, or is to be read.
    #[inline(always)]
    pub(super) fn count(&mut self, open: bool) -> bool {
        self.steps += 1.0;
        open != self.open || self.steps >= self.distance
    }

    /// Takes up the `stiffness` \[Pa/m\] at the step counted last, of a contact that is `open` then or not.
    /// If it has changed sides, it did half a step before; `at_zero` is the stiffness of its law at zero
    /// pressure \[Pa/m\], with which it opens.
    pub(super) fn read(&mut self, open: bool, stiffness: f64, at_zero: impl FnOnce() -> f64) {
        match (self.open, open) {
            (false, false) => self.join(stiffness),
            (false, true) => {
                self.steps -= 0.5;
                // Within a step of a reading the shape of the law does not show.
                let latest = self.latest.filter(|_| self.steps < 1.0);
                self.join(latest.unwrap_or_else(at_zero));
                (self.latest, self.steps, self.distance) = (Some(0.0), 0.5, f64::INFINITY);
            }
            (true, false) => {
                self.sum += 0.5 * stiffness;
                (self.latest, self.steps, self.distance) = (Some(stiffness), 0.0, 1.0);
                self.closed = 0.5;
            }
            (true, true) => {}
        }
        self.open = open;
    }

    /// Joins a `stiffness` \[Pa/m\] to the latest one.
    fn join(&mut self, stiffness: f64) {
        let latest = self.latest.unwrap_or(stiffness);
        self.sum += 0.5 * (latest + stiffness) * self.steps;
        self.closed += self.steps;
        let change = (stiffness - latest).abs();
        let distance = if change > 0.0 {
            MOST_CHANGE * self.steps * stiffness / change
        } else {
            f64::INFINITY
        };
        self.distance = distance.min(MOST_SHARE * self.closed).max(1.0);
        (self.latest, self.steps) = (Some(stiffness), 0.0);
    }

    /// The sum up to the end of the step counted last, which was read.
    pub(super) fn total(&self) -> f64 {
        self.sum + 0.5 * self.latest.unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::StiffnessSum;

    /// The sum of `stiffness` over steps with readings 32 steps apart and in the last one, and the number of
    /// readings; the contact is open where it is zero, and has the stiffness `at_zero` at zero pressure.
    fn summed(stiffness: impl Fn(usize) -> f64, at_zero: f64, steps: usize) -> (f64, usize) {
        let (mut sum, mut readings) = (StiffnessSum::EMPTY, 0);
        for step in 0..steps {
            let value = stiffness(step);
            let is_due = sum.count(value == 0.0);
            if is_due || step % 32 == 0 || step + 1 == steps {
                sum.read(value == 0.0, value, || at_zero);
                readings += 1;
            }
        }
        (sum.total(), readings)
    }

    #[test]
    fn a_constant_stiffness_counts_once_for_each_step() {
        assert_eq!(summed(|_| 3.0, 0.0, 1), (3.0, 1));
        assert_eq!(summed(|_| 3.0, 0.0, 1000), (3000.0, 33));
    }

    #[test]
    fn steps_in_which_the_contact_is_open_do_not_count() {
        // Opened and closed between two readings, once for less than 32 steps and once for more.
        let open = |step| (45..52).contains(&step) || (107..301).contains(&step);
        let (sum, _) = summed(|step| if open(step) { 0.0 } else { 2.0 }, 2.0, 500);
        assert_eq!(sum, 2.0 * (500.0 - 7.0 - 194.0));
        // Closed between two readings.
        let closed = |step| (10..=20).contains(&step);
        assert_eq!(summed(|step| if closed(step) { 2.0 } else { 0.0 }, 2.0, 40).0, 22.0);
    }

    /// Contacts that last from 3 to 3000 steps, with stiffnesses as of power laws that rise from zero and fall
    /// to it: vertically, linearly, and with a horizontal tangent.
    #[test]
    fn a_stiffness_that_opens_is_read_more_often() {
        for power in [0.4, 1.0, 2.5] {
            for length in [3.0, 20.0, 100.0, 700.0, 3000.0] {
                let start = 5.3;
                let stiffness = |step: usize| {
                    let phase = (step as f64 - start) / length;
                    let is_closed = phase > 0.0 && phase < 1.0;
                    if is_closed { (std::f64::consts::PI * phase).sin().powf(power) } else { 0.0 }
                };
                let steps = 2 * (start + length) as usize;
                let exact: f64 = (0..steps).map(stiffness).sum();
                let (sum, readings) = summed(stiffness, 0.0, steps);
                assert!((sum / exact - 1.0).abs() < 6e-3, "{power} {length}: {sum} {exact}");
                assert!(readings < steps / 32 + 180, "{power} {length}: {readings}");
            }
        }
    }
}
