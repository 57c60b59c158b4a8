//! Averaged frequency response function and its fundamental.

use asperity_signal::{
    ExponentialWindow, Frf, FrfAverage, FrfEstimator, FrfForm, HammerOptions, ModeFeatures,
    ResponseKind, dominant_frequency, find_harmonics,
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

/// A measured function in the requested form, corrected for an exponential window.
pub(crate) fn corrected(
    measured: &Frf,
    response: ResponseKind,
    options: &AnalysisOptions,
    exponential: Option<ExponentialWindow>,
) -> Frf {
    let mut receptance = measured.to(FrfForm::Receptance);
    if let Some(window) = exponential {
        let lines = receptance.frequency_hz.iter().zip(&mut receptance.values);
        for (frequency, value) in lines.filter(|(frequency, _)| **frequency > 0.0) {
            *value = window.corrected_receptance(*frequency, *value, response);
        }
    }
    receptance.to(options.form)
}

impl AveragedFrf {
    /// Averaged function at its lines.
    pub(crate) fn of(
        average: &FrfAverage,
        response: ResponseKind,
        options: &AnalysisOptions,
        exponential: Option<ExponentialWindow>,
    ) -> Result<Self, AnalysisError> {
        let frf = corrected(&average.frf(options.estimator)?, response, options, exponential);
        let mask = average.force_mask(FORCE_THRESHOLD)?;
        let coherence = average.coherence().ok().map(|coherence| coherence.values);
        let first_masked_hz = mask.first_masked_hz();
        Ok(Self { frf, coherence, valid: mask.valid, first_masked_hz })
    }

    /// Largest peak of the averaged receptance in a band, found and corrected as the peaks of hits
    /// are.
    pub(crate) fn fundamental(
        &self,
        average: &FrfAverage,
        estimator: FrfEstimator,
        limits: (f64, f64),
        hammer: &HammerOptions,
    ) -> Option<AverageFundamental> {
        let response = average.response(estimator).ok()?;
        let threshold = hammer.harmonics.force_threshold;
        let reference = dominant_frequency(&response, limits, FrfForm::Receptance, threshold)?;
        let peak = find_harmonics(&response, reference, &hammer.harmonics).fundamental?;
        let mode = ModeFeatures::of(&response, &peak, &[], hammer.windows.exponential);
        let step = self.frf.frequency_hz.get(1)?;
        let line = (peak.frequency_hz / step).round() as usize;
        let coherence = self.coherence.as_ref().and_then(|values| values.get(line).copied());
        Some(AverageFundamental {
            frequency_hz: mode.frequency_hz?,
            magnitude: mode.magnitude?,
            damping_ratio: mode.damping.half_power,
            damping_ratio_circle: mode.damping.circle,
            coherence: coherence.filter(|value| value.is_finite()),
        })
    }
}
