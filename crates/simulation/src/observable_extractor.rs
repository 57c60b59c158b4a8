//! From the decimated records of many hits to their observables.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{CaseResponse, Decimation, TransientCase};
use asperity_signal::{
    Complex64, DecimationFilter, FrequencyResponse, HarmonicOptions, ReceptanceFeatures,
    SharedForce, SignalError, UnfilteredEnd, transform_at,
};
use asperity_structure::LoadCase;

use crate::assemble::Interfaces as _;
use crate::error::SimulationError;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;
use crate::response_parts::{ResponseParts, free_from, frequency_response, passage_to_rest};

/// Error of peaks by the filter, over the largest value, unless a small accuracy is asked for.
const FILTER_ERROR: f64 = 1e-5;

/// Forces kept at a time.
const MOST_KEPT: usize = 32;

/// Extracts the observables of hits from their records; filters and transforms of forces that hits
/// share are computed once.
#[derive(Debug, Default)]
pub struct ObservableExtractor {
    filters: Mutex<Vec<Arc<Filter>>>,
    /// The latest filter, with the frequency, the step, the error and the ending it was made for, in bits.
    latest: Mutex<Option<([u64; 4], Arc<Decimation>)>>,
    forces: Mutex<Vec<Arc<DecimatedForce>>>,
}

/// A low-pass filter, as integrator and analysis take it.
#[derive(Debug)]
struct Filter {
    decimation: Arc<Decimation>,
    decimator: DecimationFilter,
}

/// The force of hits of one shape, of unit peak, decimated.
#[derive(Debug)]
struct DecimatedForce {
    shape: LoadCase,
    step: f64,
    steps: usize,
    decimation: Arc<Decimation>,
    samples: Vec<f64>,
    shared: Option<SharedForce>,
    /// Place in the decimated samples from which on there is no force.
    free: f64,
    /// The [passage to rest](passage_to_rest) of unit height, decimated; empty without friction.
    passage: Vec<f64>,
}

impl ObservableExtractor {
    /// The filter for the output of a hit at `step` \[s\]: it keeps the windows in which peaks are
    /// sought about the static frequency `natural` \[Hz\], and all below `wanted` \[Hz\]; and the end of the output in
    /// which the size of ripples is read.
    pub fn decimation(&self, natural: Option<f64>, wanted: f64, step: f64) -> Arc<Decimation> {
        self.decimation_within(FILTER_ERROR, natural, wanted, step)
    }

    /// The same for peaks to a relative `accuracy`: the filter's own error is a hundredth of it at most.
    pub(crate) fn decimation_to(
        &self,
        accuracy: f64,
        natural: Option<f64>,
        wanted: f64,
        step: f64,
    ) -> Arc<Decimation> {
        self.decimation_within(FILTER_ERROR.min(0.01 * accuracy), natural, wanted, step)
    }

    fn decimation_within(
        &self,
        error: f64,
        natural: Option<f64>,
        wanted: f64,
        step: f64,
    ) -> Arc<Decimation> {
        let options = HarmonicOptions::default();
        let band = options.fundamental_window.1 * options.second_window.1.max(1.0);
        let high = natural.map_or(f64::INFINITY, |natural| (band * natural).max(wanted));
        // That of the lowest fundamental in its window; a round number, that many hits share one filter. The cast saturates.
        let longest = natural.map_or(0.0, |natural| 1.0 / (options.fundamental_window.0 * natural));
        let least = ((UnfilteredEnd::PERIODS * longest / step).ceil() as usize).max(8);
        let ending = least.next_multiple_of(least.next_power_of_two() / 8);
        let key = [high, step, error, ending as f64].map(f64::to_bits);
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, decimation)) = latest.as_ref().filter(|latest| latest.0 == key) {
            return Arc::clone(decimation);
        }
        let decimator = DecimationFilter::keeping_within(1.0 / step, high, error);
        let mut filters = self.filters.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |filter: &&Arc<Filter>| {
            filter.decimator == decimator && filter.decimation.ending == ending
        };
        let known = filters.iter().find(same).map(|filter| Arc::clone(&filter.decimation));
        let decimation = known.unwrap_or_else(|| {
            let taps = decimator.taps().into();
            let decimation = Arc::new(Decimation { factor: decimator.factor(), taps, ending });
            filters.push(Arc::new(Filter { decimation: Arc::clone(&decimation), decimator }));
            decimation
        });
        *latest = Some((key, Arc::clone(&decimation)));
        decimation
    }

    /// The decimated force of a hit's shape, and the factor on it; none without a force.
    fn force(
        &self,
        hit: &TransientCase,
        record: &CaseResponse,
    ) -> Option<(Arc<DecimatedForce>, f64)> {
        if hit.load.peak() == 0.0 {
            return None;
        }
        let (shape, factor) = (hit.load.with_amplitude(1.0), hit.load.amplitude());
        let mut forces = self.forces.lock().unwrap_or_else(PoisonError::into_inner);
        let has_friction = hit.model.preloaded().has_friction();
        let same = |force: &&Arc<DecimatedForce>| {
            (force.step, force.steps) == (record.step, record.steps)
                && (!has_friction || !force.passage.is_empty())
                && Arc::ptr_eq(&force.decimation, &record.decimation)
                && force.shape.is_like(&shape)
        };
        if let Some(force) = forces.iter().find(same) {
            return Some((Arc::clone(force), factor));
        }
        let sample = |n: usize| shape.unit_value(n as f64 * record.step);
        let samples: Vec<f64> = (0..record.steps).map(sample).collect();
        let free = free_from(&samples, shape.peak());
        let filters = self.filters.lock().unwrap_or_else(PoisonError::into_inner);
        let filter = filters.iter().find(|f| Arc::ptr_eq(&f.decimation, &record.decimation))?;
        let delay = filter.decimator.taps().len() / 2;
        let decimate = |samples: &[f64]| {
            let mut decimated = filter.decimator.apply(samples, &(0..samples.len()));
            decimated.truncate(record.displacement.len());
            decimated
        };
        let decimated = decimate(&samples);
        let passage =
            if has_friction { decimate(&passage_to_rest(0, record.steps)) } else { Vec::new() };
        let rate = sample_rate(record);
        let force = Arc::new(DecimatedForce {
            shared: SharedForce::new(&decimated, rate, DecimationFilter::highest_kept(rate)),
            shape,
            step: record.step,
            steps: record.steps,
            decimation: Arc::clone(&record.decimation),
            samples: decimated,
            passage,
            free: (free + delay) as f64 / filter.decimator.factor() as f64,
        });
        if forces.len() >= MOST_KEPT {
            forces.clear();
        }
        forces.push(Arc::clone(&force));
        Some((force, factor))
    }

    /// The receptance of a hit at some `frequencies` \[Hz\] that its filter keeps \[m/N\]; none
    /// without a force.
    pub fn receptance(
        &self,
        hit: &TransientCase,
        record: &CaseResponse,
        frequencies: &[f64],
    ) -> Option<Vec<Complex64>> {
        let (force, factor) = self.force(hit, record)?;
        let (rate, (displacement, _)) = (sample_rate(record), force.to_rest(record));
        let at = |&frequency: &f64| {
            let [response, force] = [&displacement[..], &force.samples[..]]
                .map(|samples| transform_at(samples, rate, frequency));
            response / (factor * force)
        };
        Some(frequencies.iter().map(at).collect())
    }

    /// The displacement of a hit after its force \[m\], and its sample rate \[Hz\]; none without
    /// a force.
    pub fn decay<'a>(
        &self,
        hit: &TransientCase,
        record: &'a CaseResponse,
    ) -> Option<(&'a [f64], f64)> {
        let (force, _) = self.force(hit, record)?;
        Some((force.decay(record), sample_rate(record)))
    }

    /// The observables of a hit from its record.
    ///
    /// # Errors
    /// [`SimulationError::Signal`] when the record cannot be analysed.
    pub fn observables(
        &self,
        prepared: &PreparedScenario,
        hit: &TransientCase,
        record: &CaseResponse,
    ) -> Result<Observables, SimulationError> {
        let mut features = ReceptanceFeatures::default();
        let natural = prepared.at_rest.natural_frequency_hz;
        if let (Some(natural), Some((force, factor))) = (natural, self.force(hit, record)) {
            let (displacement, ending) = force.to_rest(record);
            let end = UnfilteredEnd { samples: &ending, sample_rate_hz: 1.0 / record.step };
            let shared = force.shared.as_ref();
            let options = HarmonicOptions::default();
            let found = shared.and_then(|shared| {
                shared.analyse((&displacement, Some(end)), factor, natural, &options)
            });
            let found = if let Some(found) = found {
                found
            } else {
                let rate = sample_rate(record);
                force.analyse_exactly(factor, (&displacement, rate), end, natural)?
            };
            // From the sample before the end of the force on, up to the last whose filter is filled by the run; the motion
            // ends half a filter later.
            let factor = record.decimation.factor.max(1);
            let last = record.steps.saturating_sub(1);
            let begin = force.free as usize;
            let decay = record.displacement.get(begin..=last / factor).unwrap_or_default();
            let end = (last + record.decimation.taps.len() / 2) as f64 / factor as f64;
            let free = force.free.fract()..end - begin as f64;
            features = found.with_decay(decay, free, sample_rate(record));
        }
        Ok(Observables::of(&ResponseParts::new(
            &prepared.at_rest,
            prepared.assembly.structure.contacts(),
            &features,
            &record.contacts,
            record.energy,
            (record.step, record.steps),
        )))
    }
}

/// Sample rate of a decimated record \[Hz\].
fn sample_rate(record: &CaseResponse) -> f64 {
    1.0 / (record.step * record.decimation.factor as f64)
}

impl DecimatedForce {
    /// The displacement of a record, and its end before the filter, less its passage to rest, as [`displacement_to_rest`];
    /// the last sample whose filter is filled by the run shows the height.
    ///
    /// [`displacement_to_rest`]: crate::observables::displacement_to_rest
    fn to_rest<'a>(&self, record: &'a CaseResponse) -> (Cow<'a, [f64]>, Cow<'a, [f64]>) {
        let last = record.steps.saturating_sub(1) / record.decimation.factor.max(1);
        let (Some(&reached), Some(&passed)) =
            (record.displacement.get(last), self.passage.get(last))
        else {
            return (Cow::Borrowed(&record.displacement), Cow::Borrowed(&record.ending));
        };
        let height = reached / passed;
        let pairs = record.displacement.iter().zip(&self.passage);
        let displacement = pairs.map(|(u, passage)| u - height * passage).collect();
        let passage = passage_to_rest(record.steps - record.ending.len(), record.steps);
        let ending =
            record.ending.iter().zip(passage).map(|(u, passage)| u - height * passage).collect();
        (Cow::Owned(displacement), Cow::Owned(ending))
    }

    /// The part of a record after the force.
    fn decay<'a>(&self, record: &'a CaseResponse) -> &'a [f64] {
        record.displacement.get(self.free.ceil() as usize..).unwrap_or_default()
    }

    /// The features of a displacement at a rate \[Hz\] whose spectrum cannot be interpolated, with its end before the filter,
    /// for a force of this factor.
    fn analyse_exactly(
        &self,
        factor: f64,
        (displacement, rate): (&[f64], f64),
        end: UnfilteredEnd<'_>,
        natural: f64,
    ) -> Result<ReceptanceFeatures, SignalError> {
        let force: Vec<f64> = self.samples.iter().map(|force| factor * force).collect();
        let response = frequency_response(&force, displacement, rate, false)?;
        let features = |response: FrequencyResponse| {
            let response = response.with_unfiltered_end(end);
            ReceptanceFeatures::of(&response, natural, &HarmonicOptions::default())
        };
        Ok(response.map(features).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever was asked for before, of two structures between which only the longest period differs; and the ending has
    /// room for that period and the window about its ends.
    #[test]
    fn a_filter_depends_on_its_own_request_alone() {
        let (wanted, step) = (5000.0, 1e-5);
        let used = ObservableExtractor::default();
        for natural in [900.0, 300.0, 310.0, 900.0] {
            let found = used.decimation(Some(natural), wanted, step);
            assert_eq!(
                found,
                ObservableExtractor::default().decimation(Some(natural), wanted, step)
            );
            let period = 2.5 / natural / step;
            let least = UnfilteredEnd::PERIODS * period;
            assert!((least..=1.25 * least + 1.0).contains(&(found.ending as f64)), "{natural}");
        }
        // Structures alike share one.
        let [a, b] = [300.0, 301.0].map(|natural| used.decimation(Some(natural), wanted, step));
        assert!(Arc::ptr_eq(&a, &b));
    }
}
