//! From a hit's record to its summary.

use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{Excitation, Hit, HitRecord, Thinning};
use asperity_signal::{
    Complex64, DecimationFilter, FrequencyResponse, HarmonicOptions, SharedForce,
    SharedForceFeatures, find_harmonics, half_power, logarithmic_decrement, transform_at,
};

use super::Case;
use crate::error::StudyError;
use crate::summary::{
    EnergySummary, Fundamental, InterfaceSummary, Numerics, Provenance, SUMMARY_SCHEMA,
    SecondHarmonic, Summary,
};

/// Drives and filters kept at a time.
const MOST_KEPT: usize = 32;

/// Force over its peak below which a decay counts as free.
pub const FREE: f64 = 1e-3;

/// What hits share when their records are analysed.
#[derive(Debug, Default)]
pub struct Observer {
    filters: Mutex<Vec<Arc<Filter>>>,
    /// The filter for a rig's frequency and a step, both in bits, that was asked for last.
    latest: Mutex<Option<(u64, u64, Arc<Thinning>)>>,
    drives: Mutex<Vec<Arc<Drive>>>,
}

/// A low-pass filter, as integrator and analysis take it.
#[derive(Debug)]
struct Filter {
    thinning: Arc<Thinning>,
    decimator: DecimationFilter,
}

/// The drive of hits of one shape, thinned.
#[derive(Debug)]
struct Drive {
    shape: Excitation,
    step: f64,
    steps: usize,
    thinning: Arc<Thinning>,
    force: Vec<f64>,
    shared: Option<SharedForce>,
    /// Thinned sample from which on there is no force.
    free: usize,
}

impl Observer {
    /// The filter for the output of a hit at `step` \[s\]: it keeps the windows in which peaks are
    /// looked for, those of a rig of frequency `natural` \[Hz\], and all below `wanted` \[Hz\].
    pub fn thinning(&self, natural: Option<f64>, wanted: f64, step: f64) -> Arc<Thinning> {
        let options = HarmonicOptions::default();
        let band = options.fundamental_window.1 * options.second_window.1.max(1.0);
        let high = natural.map_or(f64::INFINITY, |natural| (band * natural).max(wanted));
        let (rig, bits) = (high.to_bits(), step.to_bits());
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, _, thinning)) = latest.as_ref().filter(|l| (l.0, l.1) == (rig, bits)) {
            return Arc::clone(thinning);
        }
        let decimator = DecimationFilter::keeping(1.0 / step, high);
        let mut filters = self.filters.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |filter: &&Arc<Filter>| filter.thinning.factor == decimator.factor();
        let known = filters.iter().find(same).map(|filter| Arc::clone(&filter.thinning));
        let thinning = known.unwrap_or_else(|| {
            let thinning =
                Arc::new(Thinning { factor: decimator.factor(), taps: decimator.taps().into() });
            filters.push(Arc::new(Filter { thinning: Arc::clone(&thinning), decimator }));
            thinning
        });
        *latest = Some((rig, bits, Arc::clone(&thinning)));
        thinning
    }

    fn drive(&self, hit: &Hit, record: &HitRecord) -> Option<(Arc<Drive>, f64)> {
        let (shape, factor) = hit.excitation.unit();
        if shape.peak() == 0.0 {
            return None;
        }
        let mut drives = self.drives.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |drive: &&Arc<Drive>| {
            (drive.step, drive.steps) == (record.step, record.steps)
                && Arc::ptr_eq(&drive.thinning, &record.thinning)
                && drive.shape == shape
        };
        if let Some(drive) = drives.iter().find(same) {
            return Some((Arc::clone(drive), factor));
        }
        let mut force = vec![0.0; record.steps];
        shape.sample_into(0.0, record.step, &mut force);
        let floor = FREE * shape.peak();
        let last = force.iter().rposition(|force| force.abs() > floor).unwrap_or(0);
        let filters = self.filters.lock().unwrap_or_else(PoisonError::into_inner);
        let filter = filters.iter().find(|f| Arc::ptr_eq(&f.thinning, &record.thinning))?;
        let every = filter.decimator.factor();
        let late = filter.decimator.taps().len() / 2;
        let mut thinned = filter.decimator.apply(&force, &(0..force.len()));
        thinned.truncate(record.displacement.len());
        let rate = 1.0 / (record.step * every as f64);
        // The filter keeps this much; what lies above it is not to be read.
        let kept = rate / 4.4;
        let drive = Arc::new(Drive {
            shared: SharedForce::new(&thinned, rate, kept),
            shape,
            step: record.step,
            steps: record.steps,
            thinning: Arc::clone(&record.thinning),
            force: thinned,
            free: (last + late) / every + 1,
        });
        if drives.len() >= MOST_KEPT {
            drives.clear();
        }
        drives.push(Arc::clone(&drive));
        Some((drive, factor))
    }

    /// The receptance of a hit at some `frequencies` \[Hz\] that its filter keeps \[m/N\]; none
    /// without a force.
    pub fn receptance(
        &self,
        hit: &Hit,
        record: &HitRecord,
        frequencies: &[f64],
    ) -> Option<Vec<Complex64>> {
        let (drive, factor) = self.drive(hit, record)?;
        let rate = 1.0 / (record.step * record.thinning.factor as f64);
        let at = |&frequency: &f64| {
            let [response, force] = [&record.displacement, &drive.force]
                .map(|samples| transform_at(samples, rate, frequency));
            response / (factor * force)
        };
        Some(frequencies.iter().map(at).collect())
    }

    /// The displacement of a hit after its force \[m\], and its rate \[Hz\]; none without a force.
    pub fn decay<'a>(&self, hit: &Hit, record: &'a HitRecord) -> Option<(&'a [f64], f64)> {
        let (drive, _) = self.drive(hit, record)?;
        let rate = 1.0 / (record.step * record.thinning.factor as f64);
        Some((record.displacement.get(drive.free..).unwrap_or_default(), rate))
    }

    /// The summary of a hit from its record.
    pub fn summary(
        &self,
        case: &Case,
        hit: &Hit,
        record: &HitRecord,
        instructions: &str,
    ) -> Result<Summary, StudyError> {
        let mut observed = SharedForceFeatures::default();
        let mut decrement = None;
        let drive = self.drive(hit, record);
        if let (Some(natural), Some((drive, factor))) = (case.at_rest.natural_frequency_hz, &drive)
        {
            let options = HarmonicOptions::default();
            let quick = drive.shared.as_ref();
            let quick =
                quick.and_then(|s| s.analyse(&record.displacement, *factor, natural, &options));
            observed = match quick {
                Some(observed) => observed,
                None => exactly(drive, *factor, record, natural)?,
            };
            if let Some(first) = observed.harmonics.fundamental {
                let rate = 1.0 / (record.step * record.thinning.factor as f64);
                let decay = record.displacement.get(drive.free..).unwrap_or_default();
                decrement = logarithmic_decrement(decay, rate, first.frequency_hz);
            }
        }
        let harmonics = &observed.harmonics;
        let energy = &record.energy;
        Ok(Summary {
            schema: SUMMARY_SCHEMA,
            title: None,
            at_rest: case.at_rest.clone(),
            fundamental: harmonics.fundamental.map(|peak| Fundamental {
                frequency_hz: peak.frequency_hz,
                receptance_m_per_n: peak.magnitude,
                damping_ratio: observed.damping_ratio,
                damping_ratio_decrement: decrement.map(|decrement| decrement.ratio),
            }),
            second_harmonic: harmonics.second.map(|peak| SecondHarmonic {
                frequency_hz: peak.frequency_hz,
                receptance_m_per_n: peak.magnitude,
            }),
            harmonic_ratio: harmonics.ratio(),
            interfaces: interfaces(case, record),
            energy: EnergySummary {
                input_j: energy.input,
                dissipated_j: energy.dissipated,
                stored_j: energy.stored(),
                numerical_loss_j: energy.numerical_loss,
                residual_relative: energy.residual_relative(),
            },
            numerics: Numerics {
                method: case.assembly.method.name(),
                step_s: record.step,
                steps: record.steps,
                instructions: instructions.to_owned(),
                wall_s: 0.0,
            },
            provenance: Provenance::new(String::new()),
        })
    }
}

/// The analysis of a record that cannot be interpolated.
fn exactly(
    drive: &Drive,
    factor: f64,
    record: &HitRecord,
    natural: f64,
) -> Result<SharedForceFeatures, StudyError> {
    let rate = 1.0 / (record.step * record.thinning.factor as f64);
    let force: Vec<f64> = drive.force.iter().map(|force| factor * force).collect();
    let response = FrequencyResponse::from_displacement(&force, &record.displacement, rate)?;
    let harmonics = find_harmonics(&response, natural, &HarmonicOptions::default());
    let damping_ratio = harmonics.fundamental.and_then(|peak| half_power(&response, &peak));
    Ok(SharedForceFeatures { harmonics, damping_ratio })
}

fn interfaces(case: &Case, record: &HitRecord) -> Vec<InterfaceSummary> {
    let named = case.assembly.structure.contacts().iter();
    named
        .zip(&record.contacts)
        .map(|(interface, contact)| InterfaceSummary {
            name: interface.name().to_owned(),
            pressure_min_pa: contact.pressure_min,
            pressure_max_pa: contact.pressure_max,
            stiffness_average_pa_per_m: contact.stiffness_average,
            stiffness_at_pressure_min_pa_per_m: interface.law().stiffness(contact.pressure_min),
            contact_lost_s: contact.lost,
        })
        .collect()
}
