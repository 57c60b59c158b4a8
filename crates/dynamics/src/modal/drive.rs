//! The drive force as steps see it.

use crate::Excitation;

/// A drive force by its mean and rise in every step, and its value at the step's end.
///
/// The mean is Simpson's, so that a step carries the impulse of the true force to fourth order.
/// Beyond [`steps`](Self::steps) the force is zero for good.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DriveForce {
    pub(super) mean: Vec<f64>,
    pub(super) rise: Vec<f64>,
    pub(super) end: Vec<f64>,
}

impl DriveForce {
    /// The drive of `excitation` over at most `steps` steps of `h` \[s\].
    pub(super) fn new(excitation: &Excitation, h: f64, steps: usize) -> Self {
        let lasting = (excitation.ends_at() / h).ceil();
        // One step more, whose end is the first zero; the cast saturates.
        let steps = steps.min((lasting as usize).saturating_add(1));
        let mut drive =
            Self { mean: vec![0.0; steps], rise: vec![0.0; steps], end: vec![0.0; steps] };
        let mut start = excitation.force(0.0);
        for n in 0..steps {
            let middle = excitation.force((n as f64 + 0.5) * h);
            let end = excitation.force((n as f64 + 1.0) * h);
            drive.mean[n] = (start + 4.0 * middle + end) / 6.0;
            drive.rise[n] = end - start;
            drive.end[n] = end;
            start = end;
        }
        drive
    }

    /// Number of steps with a force.
    pub(super) fn steps(&self) -> usize {
        self.end.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the closed-form impulse of the gamma pulse, F tr e^2 / 4: fourth order.
    #[test]
    fn the_impulse_is_kept_to_fourth_order() {
        let pulse = Excitation::GammaPulse { peak: 32.0, rise: 0.34e-3 };
        let exact = 32.0 * 0.34e-3 * 2.0_f64.exp() / 4.0;
        let error = |h: f64| {
            let drive = DriveForce::new(&pulse, h, usize::MAX);
            assert_eq!(*drive.end.last().unwrap(), 0.0);
            (drive.mean.iter().sum::<f64>() * h / exact - 1.0).abs()
        };
        let (coarse, fine) = (error(8e-5), error(4e-5));
        assert!(((coarse / fine).log2() - 4.0).abs() < 0.3, "{coarse} {fine}");
        // Found 1.25e-8.
        assert!(error(1e-5) < 2e-8, "{}", error(1e-5));
    }
}
