//! Averaged frequency response function and its fundamental.

use asperity_signal::{
    Complex64, ExponentialWindow, Frf, FrfAverage, FrfForm, ResponseKind, circle_fit_of,
};

use crate::error::AnalysisError;
use crate::options::AnalysisOptions;
use crate::report::AverageFundamental;

/// Least force spectrum over its maximum, as for the peaks of a hit.
const FORCE_THRESHOLD: f64 = 0.02;

/// Averaged frequency response function, with its coherence and the range of sufficient force.
#[derive(Debug, Clone, PartialEq)]
pub struct AveragedFrf {
    /// Function in the requested form.
    pub frf: Frf,
    /// Coherence; `None` for one hit.
    pub coherence: Option<Vec<f64>>,
    /// True where the force spectrum has at least 2 % of its maximum.
    pub valid: Vec<bool>,
    /// Lowest frequency that is not valid \[Hz\].
    pub first_masked_hz: Option<f64>,
}

impl AveragedFrf {
    /// Averaged function, and its receptance.
    pub(crate) fn of(
        average: &FrfAverage,
        response: ResponseKind,
        options: &AnalysisOptions,
        exponential: Option<ExponentialWindow>,
    ) -> Result<(Self, Frf), AnalysisError> {
        let mut receptance = average.frf(options.estimator)?.to(FrfForm::Receptance);
        if let Some(window) = exponential {
            let lines = receptance.frequency_hz.iter().zip(&mut receptance.values);
            for (frequency, value) in lines.filter(|(frequency, _)| **frequency > 0.0) {
                *value = window.corrected_receptance(*frequency, *value, response);
            }
        }
        let mask = average.force_mask(FORCE_THRESHOLD)?;
        let coherence = average.coherence().ok().map(|coherence| coherence.values);
        let first_masked_hz = mask.first_masked_hz();
        let frf = receptance.to(options.form);
        Ok((Self { frf, coherence, valid: mask.valid, first_masked_hz }, receptance))
    }

    /// Largest peak of the receptance in a band.
    pub(crate) fn fundamental(
        &self,
        receptance: &Frf,
        (low, high): (f64, f64),
    ) -> Option<AverageFundamental> {
        let magnitude = receptance.magnitude();
        let frequency = &receptance.frequency_hz;
        let inside = |k: &usize| {
            let f = frequency[*k];
            let peak = magnitude[*k] > magnitude[k - 1] && magnitude[*k] >= magnitude[k + 1];
            f > low && f < high && self.valid[*k] && peak
        };
        let lines = 1..magnitude.len().saturating_sub(1);
        let top = lines.filter(inside).max_by(|&a, &b| magnitude[a].total_cmp(&magnitude[b]))?;
        // Parabola through the logarithms, in which a resonance is smooth.
        let [a, b, c] = [top - 1, top, top + 1].map(|k| magnitude[k].ln());
        let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
        let step = frequency[top + 1] - frequency[top];
        let above = |k: &usize| magnitude[*k] >= magnitude[top] * std::f64::consts::FRAC_1_SQRT_2;
        let first = (1..top).rev().take_while(above).last().unwrap_or(top);
        let last = (top..magnitude.len()).take_while(above).last().unwrap_or(top);
        let mobility: Vec<Complex64> = (first..=last)
            .map(|k| receptance.values[k] * Complex64::I * omega(frequency[k]))
            .collect();
        let coherence = self.coherence.as_ref().map(|values| values[top]);
        Some(AverageFundamental {
            frequency_hz: frequency[top] + shift * step,
            magnitude: (b - 0.25 * (a - c) * shift).exp(),
            damping_ratio: circle_fit_of(&frequency[first..=last], &mobility).map(|fit| fit.ratio),
            coherence: coherence.filter(|value| value.is_finite()),
        })
    }
}

fn omega(frequency_hz: f64) -> f64 {
    std::f64::consts::TAU * frequency_hz
}
