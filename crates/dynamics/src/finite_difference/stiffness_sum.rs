//! The sum of a contact's stiffness over the steps.

/// Sum of the stiffness \[Pa/m\] of one contact over the steps of a run.
///
/// A law is too dear to be read in every step. So the stiffness is read many steps apart and taken
/// to be linear between two readings (trapezoidal rule, of second order in their distance). Where
/// contact opens or closes the stiffness jumps between zero and the law's at zero pressure; these
/// steps are counted exactly, with that stiffness as a reading of its own. Without that the sum of
/// a contact that is closed for a hundred readings would be off by up to one of them, 1 %.
#[derive(Debug, Clone, Copy)]
pub(super) struct StiffnessSum {
    /// Sum up to the latest reading \[Pa/m\].
    sum: f64,
    /// The latest reading \[Pa/m\], zero while the contact is open; none before the first.
    latest: Option<f64>,
    /// Steps since, or since the run's beginning half a step before the first.
    steps: f64,
    open: bool,
}

impl StiffnessSum {
    /// The sum before the first step.
    pub(super) const EMPTY: Self = Self { sum: 0.0, latest: None, steps: -0.5, open: false };

    /// Counts a step; true if the contact, `open` or not, has changed sides in it.
    #[inline(always)]
    pub(super) fn count(&mut self, open: bool) -> bool {
        self.steps += 1.0;
        open != self.open
    }

    /// The contact has opened or closed half a step before the one counted last, at the `stiffness`
    /// \[Pa/m\] of its law at zero pressure.
    pub(super) fn change_sides(&mut self, stiffness: f64) {
        self.steps -= 0.5;
        self.read(stiffness);
        self.open = !self.open;
        self.latest = Some(if self.open { 0.0 } else { stiffness });
        self.steps = 0.5;
    }

    /// Takes up the `stiffness` \[Pa/m\] at the step counted last.
    pub(super) fn read(&mut self, stiffness: f64) {
        let stiffness = if self.open { 0.0 } else { stiffness };
        self.sum += 0.5 * (self.latest.unwrap_or(stiffness) + stiffness) * self.steps;
        self.latest = Some(stiffness);
        self.steps = 0.0;
    }

    /// The sum up to the end of the step counted last, which was read.
    pub(super) fn total(&self) -> f64 {
        self.sum + 0.5 * self.latest.unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::StiffnessSum;

    /// The sum of `stiffness` over steps with readings 32 steps apart and in the last one; the
    /// contact is open where it is zero, and has the stiffness 2 at zero pressure.
    fn summed(stiffness: impl Fn(usize) -> f64, steps: usize) -> f64 {
        let mut sum = StiffnessSum::EMPTY;
        for step in 0..steps {
            let value = stiffness(step);
            if sum.count(value == 0.0) {
                sum.change_sides(2.0);
            }
            if step % 32 == 0 || step + 1 == steps {
                sum.read(value);
            }
        }
        sum.total()
    }

    #[test]
    fn a_constant_stiffness_counts_once_for_each_step() {
        assert_eq!(summed(|_| 3.0, 1), 3.0);
        assert_eq!(summed(|_| 3.0, 1000), 3000.0);
    }

    #[test]
    fn steps_in_which_the_contact_is_open_do_not_count() {
        // Opened and closed between two readings, once for less than 32 steps and once for more.
        let open = |step| (45..52).contains(&step) || (107..301).contains(&step);
        let sum = summed(|step| if open(step) { 0.0 } else { 2.0 }, 500);
        assert_eq!(sum, 2.0 * (500.0 - 7.0 - 194.0));
        // Closed between two readings.
        assert_eq!(summed(|step| if (10..=20).contains(&step) { 2.0 } else { 0.0 }, 40), 22.0);
    }

    #[test]
    fn a_stiffness_that_falls_to_opening_is_linear_between_readings() {
        // From 10 at step 0 to 2 half a step after step 200, then open.
        let stiffness = |step: usize| {
            if step > 200 { 0.0 } else { 10.0 - 8.0 * step as f64 / 200.5 }
        };
        let exact: f64 = (0..=200).map(stiffness).sum();
        assert!((summed(stiffness, 400) / exact - 1.0).abs() < 1e-4);
    }
}
