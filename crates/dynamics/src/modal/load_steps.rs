//! The load as steps see it.

use std::sync::Arc;

use asperity_structure::LoadCase;

/// A load by its mean and rise in every step, and its value at the step's end.
///
/// The mean is Simpson's, so that a step carries the impulse of the true force to fourth order.
/// Beyond [`steps`](Self::steps) the force is zero for good.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LoadSteps {
    pub(super) mean: Vec<f64>,
    pub(super) rise: Vec<f64>,
    pub(super) end: Vec<f64>,
}

impl LoadSteps {
    /// A load case of unit amplitude over at most `steps` steps of `h` \[s\].
    pub(super) fn new(case: &LoadCase, h: f64, steps: usize) -> Self {
        let lasting = (case.ends_at() / h).ceil();
        // One step more, whose end is the first zero; the cast saturates.
        let steps = steps.min((lasting as usize).saturating_add(1));
        let mut load =
            Self { mean: vec![0.0; steps], rise: vec![0.0; steps], end: vec![0.0; steps] };
        let mut start = case.unit_value(0.0);
        for n in 0..steps {
            let middle = case.unit_value((n as f64 + 0.5) * h);
            let end = case.unit_value((n as f64 + 1.0) * h);
            load.mean[n] = (start + 4.0 * middle + end) / 6.0;
            load.rise[n] = end - start;
            load.end[n] = end;
            start = end;
        }
        load
    }

    /// Multiplies the load by an amplitude.
    pub(super) fn scale(&mut self, amplitude: f64) {
        let columns = [&mut self.mean, &mut self.rise, &mut self.end];
        columns.into_iter().flatten().for_each(|value| *value *= amplitude);
    }

    /// Number of steps with a load.
    pub(super) fn steps(&self) -> usize {
        self.end.len()
    }
}

/// Loads already computed: cases of one shape differ by their amplitude.
#[derive(Debug, Default)]
pub(super) struct LoadShapes {
    known: Vec<(LoadCase, f64, usize, Arc<LoadSteps>)>,
}

/// Loads kept at a time.
const MOST_SHAPES: usize = 32;

impl LoadShapes {
    /// A load of unit amplitude in `steps` steps of `step` \[s\].
    pub(super) fn load_steps(
        &mut self,
        load: &LoadCase,
        step: f64,
        steps: usize,
    ) -> Arc<LoadSteps> {
        let same = |known: &&(LoadCase, f64, usize, Arc<LoadSteps>)| {
            known.1 == step && known.2 == steps && known.0.is_like(load)
        };
        if let Some(found) = self.known.iter().find(same) {
            return Arc::clone(&found.3);
        }
        let found = Arc::new(LoadSteps::new(load, step, steps));
        if self.known.len() >= MOST_SHAPES {
            self.known.clear();
        }
        self.known.push((load.clone(), step, steps, Arc::clone(&found)));
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_structure::TimeFunction;

    /// Against the closed-form impulse of the gamma pulse, F tr e^2 / 4: fourth order.
    #[test]
    fn the_impulse_is_kept_to_fourth_order() {
        let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 32.0);
        let exact = 0.34e-3 * 2.0_f64.exp() / 4.0;
        let error = |h: f64| {
            let load = LoadSteps::new(&pulse, h, usize::MAX);
            assert_eq!(*load.end.last().unwrap(), 0.0);
            (load.mean.iter().sum::<f64>() * h / exact - 1.0).abs()
        };
        let (coarse, fine) = (error(8e-5), error(4e-5));
        assert!(((coarse / fine).log2() - 4.0).abs() < 0.3, "{coarse} {fine}");
        // Found 1.25e-8.
        assert!(error(1e-5) < 2e-8, "{}", error(1e-5));
    }
}
