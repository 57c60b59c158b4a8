//! The parts of a response that its quantities are read from.

use asperity_dynamics::{ContactExtremes, ContactMeasures, EnergyLedger};
use std::borrow::Cow;

use asperity_signal::{FrequencyResponse, ReceptanceFeatures, SignalError, UNDECAYED_RATIO};
use asperity_structure::PreloadedContact;

use crate::static_state::StaticSummary;
use crate::warning::{MOST_RESIDUAL, Warning};

/// Force over its peak up to which the decay of a response counts as free.
const FREE: f64 = 1e-3;

/// The parts of a response that its quantities are read from.
#[derive(Debug)]
pub(crate) struct ResponseParts<'a> {
    pub(crate) at_rest: &'a StaticSummary,
    pub(crate) interfaces: &'a [PreloadedContact],
    pub(crate) peaks: PeakValues,
    /// Frequencies of maxima where the force is too weak \[Hz\].
    pub(crate) masked_hz: Vec<f64>,
    /// Frequencies of maxima that hardly are peaks, or hardly are none \[Hz\].
    pub(crate) marginal_hz: Vec<f64>,
    /// Frequency of the largest response where the force is too weak, if the fundamental is another \[Hz\].
    pub(crate) hidden_hz: Option<f64>,
    /// Part of the decay that remains where it ends, if that is more than [`UNDECAYED_RATIO`].
    pub(crate) remaining: Option<f64>,
    pub(crate) contacts: Vec<ContactMeasures>,
    /// Time without contact at each interface \[s\]; empty where it is not counted.
    pub(crate) contact_lost: Vec<f64>,
    /// The energy balance, if there is one.
    pub(crate) energy: Option<EnergyLedger>,
    /// Integration step \[s\].
    pub(crate) step: f64,
    pub(crate) steps: usize,
}

impl<'a> ResponseParts<'a> {
    /// The parts of a response of which integrators have recorded `records` at `interfaces`.
    pub(crate) fn new(
        at_rest: &'a StaticSummary,
        interfaces: &'a [PreloadedContact],
        features: &ReceptanceFeatures,
        records: &[ContactExtremes],
        energy: EnergyLedger,
        (step, steps): (f64, usize),
    ) -> Self {
        let measures = |(interface, record): (&PreloadedContact, &ContactExtremes)| {
            let law = interface.law();
            ContactMeasures {
                pressure_min: record.pressure_min,
                pressure_max: record.pressure_max,
                stiffness_average: record.stiffness_average,
                stiffness_at_pressure_min: law.stiffness(record.pressure_min),
            }
        };
        Self {
            at_rest,
            interfaces,
            peaks: PeakValues::of(features),
            masked_hz: features.harmonics.masked_hz.clone(),
            marginal_hz: features.harmonics.marginal_hz.clone(),
            hidden_hz: features.harmonics.hidden_hz,
            remaining: features.remaining.filter(|remaining| *remaining > UNDECAYED_RATIO),
            contacts: interfaces.iter().zip(records).map(measures).collect(),
            contact_lost: records.iter().map(|record| record.lost).collect(),
            energy: Some(energy),
            step,
            steps,
        }
    }

    /// Warnings about the response.
    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let pairs = self.interfaces.iter().zip(&self.contacts);
        let outside = pairs.filter_map(|(interface, measures)| {
            let ContactMeasures { pressure_min, pressure_max, .. } = *measures;
            Warning::outside_measured_range(interface, pressure_min, pressure_max)
        });
        let residual = self.energy.map(|energy| energy.residual_relative());
        let suspect = residual.filter(|residual| *residual > MOST_RESIDUAL);
        let balance = suspect.map(|residual_relative| Warning::EnergyBalance { residual_relative });
        let peak = |&frequency_hz: &f64| Warning::MarginalPeak { frequency_hz };
        let hidden = self.hidden_hz.map(|frequency_hz| Warning::HiddenResonance { frequency_hz });
        let peaks = hidden.into_iter().chain(self.marginal_hz.iter().map(peak));
        let undecayed = self.remaining.map(|remaining| Warning::NotDecayed { remaining });
        outside.chain(balance).chain(peaks).chain(undecayed).collect()
    }
}

/// Numbers of the receptance peaks and the decay, or their derivatives with respect to a parameter;
/// none where the response has no such peak.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PeakValues {
    /// f1 \[Hz\] and A1 \[m/N\].
    pub(crate) fundamental: Option<(f64, f64)>,
    /// f2 \[Hz\] and A2 \[m/N\].
    pub(crate) second: Option<(f64, f64)>,
    /// A2/A1.
    pub(crate) ratio: Option<f64>,
    /// Half-power damping ratio of the fundamental.
    pub(crate) damping_ratio: Option<f64>,
    /// Damping ratio by the logarithmic decrement.
    pub(crate) damping_ratio_decrement: Option<f64>,
}

impl PeakValues {
    pub(crate) fn of(features: &ReceptanceFeatures) -> Self {
        let harmonics = &features.harmonics;
        Self {
            fundamental: harmonics.fundamental.map(|peak| (peak.frequency_hz, peak.magnitude)),
            second: harmonics.second.map(|peak| (peak.frequency_hz, peak.magnitude)),
            ratio: harmonics.ratio(),
            damping_ratio: features.damping_ratio(),
            damping_ratio_decrement: features.damping_ratio_decrement,
        }
    }
}

/// First sample after which no force exceeds a thousandth of `peak`.
pub fn free_from(force: &[f64], peak: f64) -> usize {
    force.iter().rposition(|force| force.abs() > FREE * peak).map_or(0, |last| last + 1)
}

/// Frequency response of samples at `rate` \[Hz\]: force \[N\] to displacement \[m\]; none without
/// a force.
///
/// - `has_friction`: as for [`displacement_to_rest`].
pub(crate) fn frequency_response(
    force: &[f64],
    displacement: &[f64],
    rate: f64,
    has_friction: bool,
) -> Result<Option<FrequencyResponse>, SignalError> {
    if force.iter().all(|&force| force == 0.0) {
        return Ok(None);
    }
    let displacement = displacement_to_rest(displacement, has_friction);
    FrequencyResponse::from_displacement(force, &displacement, rate).map(Some)
}

/// The fewest readings for each output sample, of those that divide its `steps`, that are at least `least` and at most
/// `most`; else the most of them.
///
/// The error of sums over samples `h` apart is of second order, `(w h)^2 / 12` of what the end of a record or a bend of the
/// force adds. The output rate is for files and figures; integrators that hand out no filtered record are read more often, at
/// whole steps, so that neither the steps nor the output change.
pub(crate) fn readings(steps: usize, least: f64, most: usize) -> usize {
    // The cast saturates.
    let least = least.ceil().max(1.0) as usize;
    let enough = (least..=steps.min(most)).find(|parts| steps.is_multiple_of(*parts));
    enough.unwrap_or_else(|| most_readings(steps, most))
}

/// The most readings for each output sample that divide its `steps` and are at most `most`; at least one.
pub(crate) fn most_readings(steps: usize, most: usize) -> usize {
    (1..=steps.min(most)).rev().find(|parts| steps.is_multiple_of(*parts)).unwrap_or(1)
}

/// [`frequency_response`] of a history at its sample rate, [to its end](to_end).
pub(crate) fn history_response(
    force: &[f64],
    displacement: &[f64],
    rate: f64,
    has_friction: bool,
) -> Result<Option<FrequencyResponse>, SignalError> {
    let displacement = displacement_to_rest(displacement, has_friction);
    frequency_response(&to_end(force), &to_end(&displacement), rate, false)
}

/// Samples of a history to the end of its duration. A sum over `n` samples at times `k dt` is the integral up to
/// `(n - 1/2) dt`, which moves the ripples of a record that ends while it rings. Half of the sample at the end of the
/// duration, on the line through the last two, is added: to second order the sum is the integral up to `n dt`, at any rate.
pub(crate) fn to_end(samples: &[f64]) -> Vec<f64> {
    let end = match samples {
        [.., before, last] => last - 0.5 * before,
        _ => 0.0,
    };
    samples.iter().copied().chain([end]).collect()
}

/// The displacement less a smooth passage from zero to its last value over the record, where friction may hold
/// a structure away from its equilibrium.
///
/// A response that stays at `u_T` after the record has the transform `U + u_T exp(-i w T) / (i w)`, which is also what
/// velocity and acceleration give. The transform of the passage `s = x^3 (10 - 15 x + 6 x^2)`, `x = t/T`, kept after the
/// record, is at most `120 / (w T)^3` of that of the jump: the displacement less the passage has the transform wanted,
/// and ends at zero.
pub fn displacement_to_rest(displacement: &[f64], has_friction: bool) -> Cow<'_, [f64]> {
    let last = displacement.last().copied().unwrap_or(0.0);
    if !has_friction || last == 0.0 {
        return Cow::Borrowed(displacement);
    }
    let passage = passage_to_rest(0, displacement.len());
    Cow::Owned(
        displacement.iter().zip(passage).map(|(value, passed)| value - last * passed).collect(),
    )
}

/// The passage `x^3 (10 - 15 x + 6 x^2)` from zero to one over `count` samples, from sample `first` on.
pub(crate) fn passage_to_rest(first: usize, count: usize) -> Vec<f64> {
    let passed = |place: usize| {
        let x = (place + 1) as f64 / count as f64;
        x.powi(3) * (10.0 + x * (6.0 * x - 15.0))
    };
    (first..count).map(passed).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::f64::consts::TAU;

    use asperity_signal::{Complex64, transform_at};

    use super::*;

    #[test]
    fn readings_divide_the_steps_of_a_sample() {
        assert_eq!([2.5, 3.0, 12.5, 40.0].map(|least| readings(28, least, 100)), [4, 4, 14, 28]);
        assert_eq!([0.3, 1.5].map(|least| readings(29, least, 100)), [1, 29]);
        // Not more than memory has room for.
        assert_eq!([28, 13, 1, 0].map(|most| readings(28, 20.0, most)), [28, 7, 1, 1]);
        assert_eq!([most_readings(1, 9), most_readings(12, 9), most_readings(12, 0)], [1, 6, 1]);
    }

    /// A record that ends while it rings: its receptance is that of the integral over the duration, in closed form, to
    /// second order; without the end it is to first order.
    #[test]
    fn a_history_reaches_to_its_end() {
        let (duration, decay, frequency) = (0.18, 4.1, 113.0);
        let pole = Complex64::new(-decay, TAU * frequency);
        let at = 224.0;
        let w = Complex64::new(0.0, TAU * at);
        let part = |pole: Complex64| (((pole - w) * duration).exp() - 1.0) / (pole - w);
        let exact = (part(pole) - part(pole.conj())) / Complex64::new(0.0, 2.0);
        let off = |rate: f64, reaches: bool| {
            let count = (duration * rate).round() as usize;
            let ring = |n: usize| {
                let time = n as f64 / rate;
                (-decay * time).exp() * (TAU * frequency * time).sin()
            };
            let displacement: Vec<f64> = (0..count).map(ring).collect();
            let mut force = vec![0.0; count];
            force[0] = rate;
            let response = if reaches { history_response } else { frequency_response };
            let found = response(&force, &displacement, rate, false).unwrap().unwrap();
            (found.receptance_at(at) - exact).norm() / exact.norm()
        };
        for rate in [1e4, 2e4, 4e4] {
            let [coarse, fine] = [rate, 2.0 * rate].map(|rate| off(rate, true));
            let order = (coarse / fine).log2();
            let of_sum = (off(rate, false) / off(2.0 * rate, false)).log2();
            assert!((1.9..2.4).contains(&order), "{rate}: {coarse} {fine}");
            assert!((0.95..1.05).contains(&of_sum), "{rate}: {of_sum}");
        }
        // Found 0.208 and 0.0106.
        assert!(off(1e4, false) > 0.2 && off(1e4, true) < 0.012, "{}", off(1e4, true));
    }

    /// A decay to a displacement that remains, against the sum over all samples with the last one repeated for ever, a
    /// geometric series.
    #[test]
    fn a_displacement_that_remains_is_kept_after_the_record() {
        let (rate, count, rest) = (25_600.0, 3072, 0.02);
        let displacement: Vec<f64> = (0..count)
            .map(|n| {
                let (time, phase) = (n as f64 / rate, TAU * 780.0 * n as f64 / rate);
                let decay = (-250.0 * time).exp();
                decay * phase.sin() + rest * (1.0 - decay)
            })
            .collect();
        let mut force = vec![0.0; count];
        force[..6].fill(1.0);
        let [kept, cut] = [true, false]
            .map(|kept| frequency_response(&force, &displacement, rate, kept).unwrap().unwrap());
        for frequency in [700.0, 760.0, 830.0] {
            let [within, of_force] =
                [&displacement, &force].map(|samples| transform_at(samples, rate, frequency));
            let turn = |samples: f64| Complex64::cis(-TAU * frequency * samples / rate);
            let after = displacement[count - 1] * turn(count as f64) / (1.0 - turn(1.0)) / rate;
            let exact = (within + after) / of_force;
            let [kept, cut] = [&kept, &cut]
                .map(|one| (one.receptance_at(frequency) - exact).norm() / exact.norm());
            assert!(kept < 1e-6 && cut > 2e-3, "{frequency}: {kept} {cut}");
        }
    }
}
