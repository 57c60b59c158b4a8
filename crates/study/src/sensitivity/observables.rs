//! From the derivatives of a response to those of the answers.

use asperity_dynamics::{ContactMeasures, Course, Sensitivity, central_difference};
use asperity_signal::{
    FrequencyResponse, HarmonicOptions, Peak, PeakSensitivity, SignalError, find_harmonics,
    half_power_crossings,
};

use crate::summary::StaticSummary;

/// The derivative of an answer from those of displacement and force.
type Rate<'a> = dyn Fn(&[f64], &[f64]) -> Option<f64> + 'a;

/// Answers and their derivatives, row by row.
#[derive(Debug, Default)]
pub struct Table {
    /// Names of the answers.
    pub columns: Vec<String>,
    /// The answers.
    pub values: Vec<Option<f64>>,
    /// Row per answer, column per parameter.
    pub jacobian: Vec<Vec<Option<f64>>>,
}

impl Table {
    fn push(&mut self, name: String, value: Option<f64>, rates: Vec<Option<f64>>) {
        self.columns.push(name);
        self.values.push(value);
        self.jacobian.push(rates);
    }

    /// The state at rest, from those at the places of the stencil.
    pub fn rest(&mut self, at_rest: &StaticSummary, four: &[&[StaticSummary; 4]], steps: &[f64]) {
        let mut push = |name: String, of: &dyn Fn(&StaticSummary) -> Option<f64>| {
            let slope = |(four, &step): (&&[StaticSummary; 4], &f64)| {
                let [a, b, c, d] = four.each_ref().map(of);
                Some(central_difference([a?, b?, c?, d?], step))
            };
            self.push(name, of(at_rest), four.iter().zip(steps).map(slope).collect());
        };
        push("static.natural_frequency_hz".to_owned(), &|rest| rest.natural_frequency_hz);
        for (i, interface) in at_rest.interfaces.iter().enumerate() {
            let name = |key: &str| format!("static.interfaces.{}.{key}", interface.name);
            push(name("pressure_pa"), &|rest| Some(rest.interfaces[i].pressure_pa));
            push(name("stiffness_pa_per_m"), &|rest| Some(rest.interfaces[i].stiffness_pa_per_m));
            push(name("closure_m"), &|rest| Some(rest.interfaces[i].closure_m));
        }
    }

    /// Fundamental, second harmonic and damping of the response.
    pub fn peaks(&mut self, found: &Sensitivity, natural: Option<f64>) -> Result<(), SignalError> {
        // The state at the very end is beyond the samples.
        let count = found.values.displacement.len() - 1;
        let Course { force, displacement, .. } = &found.values;
        let struck = force[..count].iter().any(|force| *force != 0.0);
        let response = if struck && natural.is_some() {
            let rate = 1.0 / found.step;
            Some(FrequencyResponse::from_displacement(
                &force[..count],
                &displacement[..count],
                rate,
            )?)
        } else {
            None
        };
        let harmonics = match (&response, natural) {
            (Some(response), Some(natural)) => {
                find_harmonics(response, natural, &HarmonicOptions::default())
            }
            _ => asperity_signal::Harmonics::default(),
        };
        let signals: Vec<(&[f64], &[f64])> = found
            .rates
            .iter()
            .map(|rate| (&rate.displacement[..count], &rate.force[..count]))
            .collect();
        let tangent = |peak: Option<Peak>, damped: bool| {
            let (peak, response) = (peak?, response.as_ref()?);
            let crossings = if damped { half_power_crossings(response, &peak) } else { None };
            let ratio = crossings.map(|crossings| crossings.ratio());
            Some((peak, ratio, PeakSensitivity::new(response, &peak, crossings)))
        };
        let first = tangent(harmonics.fundamental, true);
        let second = tangent(harmonics.second, false);
        let rates = |of: &Rate<'_>| -> Vec<Option<f64>> {
            signals.iter().map(|(displacement, force)| of(displacement, force)).collect()
        };
        for (key, found) in [("fundamental", &first), ("second_harmonic", &second)] {
            let found = found.as_ref();
            let peak = found.map(|(peak, ..)| peak);
            let moves = |u: &[f64], f: &[f64]| found.map(|(.., tangent)| tangent.peak(u, f));
            let frequency = rates(&|u, f| Some(moves(u, f)?.frequency_hz));
            self.push(format!("{key}.frequency_hz"), peak.map(|p| p.frequency_hz), frequency);
            let height = rates(&|u, f| Some(moves(u, f)?.magnitude));
            self.push(format!("{key}.receptance_m_per_n"), peak.map(|p| p.magnitude), height);
            if key == "fundamental" {
                let damping =
                    rates(&|u, f| found.and_then(|(.., tangent)| tangent.damping_ratio(u, f)));
                let ratio = found.and_then(|(_, ratio, _)| *ratio);
                self.push("fundamental.damping_ratio".to_owned(), ratio, damping);
            }
        }
        let ratio = rates(&|u, f| {
            let ((peak, _, tangent), (other, _, over)) = (first.as_ref()?, second.as_ref()?);
            let (below, above) = (tangent.peak(u, f), over.peak(u, f));
            let relative = above.magnitude / other.magnitude - below.magnitude / peak.magnitude;
            Some(relative * other.magnitude / peak.magnitude)
        });
        self.push("harmonic_ratio".to_owned(), harmonics.ratio(), ratio);
        Ok(())
    }

    /// Extremes and stiffnesses of the interfaces, of these `names`.
    pub fn contacts(&mut self, found: &Sensitivity, names: &[&str]) {
        type Of = fn(&ContactMeasures) -> f64;
        let measures: [(&str, Of); 4] = [
            ("pressure_min_pa", |contact| contact.pressure_min),
            ("pressure_max_pa", |contact| contact.pressure_max),
            ("stiffness_average_pa_per_m", |contact| contact.stiffness_average),
            ("stiffness_at_pressure_min_pa_per_m", |contact| contact.stiffness_at_pressure_min),
        ];
        for (i, interface) in names.iter().enumerate() {
            for (key, of) in measures {
                let rates = found.rates.iter().map(|rate| Some(of(&rate.contacts[i])));
                let value = Some(of(&found.values.contacts[i]));
                self.push(format!("interfaces.{interface}.{key}"), value, rates.collect());
            }
        }
    }
}
