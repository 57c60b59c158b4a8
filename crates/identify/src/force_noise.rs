//! Noise of a measured force in the receptances of its hit: an error that neighbouring lines share.
//!
//! White noise `n` of the force within its pulse adds `N` to the transform `F`, and to the receptance `H = X / F`
//! about
//!
//! ```text
//! dH_k = -H_k N_k / F_k,    N_k = dt sum_j n_j exp(-i w_k t_j)
//! ```
//!
//! at all lines `k`. Over a pulse of `T` seconds lines nearer to each other than `1 / T` have almost the same relative
//! error: as many of them as there are tell no more of the stiffness than one.

use std::f64::consts::TAU;
use std::ops::Range;

use asperity_inference::{CorrelatedErrors, InferenceError};
use asperity_signal::{Complex64, white_density};

use crate::data_files::ReceptanceLine;

/// Least variance of its own of an error, over the variance that it shares: far above rounding.
const OWN: f64 = 1e-10;

/// Noise of a force whose samples outside of the pulse are zero.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ForceNoise {
    /// Standard deviation of a sample \[N\]; 0 if not known.
    deviation_n: f64,
    /// Samples of the pulse.
    samples: Range<usize>,
    rate_hz: f64,
}

impl ForceNoise {
    /// The larger noise of the samples before the pulse and of the last ones, of which `tail` is the part of all, in a
    /// force before its samples outside of the pulse `samples` are set to zero.
    pub(super) fn of(force: &[f64], samples: Range<usize>, tail: usize, rate_hz: f64) -> Self {
        let quiet = [&force[..samples.start], &force[force.len() - force.len() / tail..]];
        let densities = quiet.iter().filter_map(|quiet| white_density(quiet, rate_hz));
        let density = densities.fold(0.0, f64::max);
        Self { deviation_n: (0.5 * density * rate_hz).sqrt(), samples, rate_hz }
    }

    /// Errors of real and imaginary parts of receptances with the transforms of their forces \[N s\], which have these
    /// standard deviations of their own \[m/N\], in the order of the lines; none without noise of the force.
    pub(super) fn errors(
        &self,
        lines: &[(ReceptanceLine, Complex64)],
        own: &[f64],
    ) -> Result<Option<CorrelatedErrors>, InferenceError> {
        if self.deviation_n == 0.0 || lines.is_empty() {
            return Ok(None);
        }
        let part = |(line, force): &(ReceptanceLine, Complex64)| -> [Vec<f64>; 2] {
            let factor = -line.value / force * (self.deviation_n / self.rate_hz);
            let turn = -TAU * line.frequency_hz / self.rate_hz;
            let of_sample = |n: usize| factor * Complex64::cis(turn * n as f64);
            self.samples.clone().map(of_sample).map(|error| (error.re, error.im)).unzip().into()
        };
        let parts: Vec<Vec<f64>> = lines.iter().flat_map(part).collect();
        // Without other errors than the shared ones, some lines would determine the others.
        let variance = |(deviation, shared): (&f64, &Vec<f64>)| {
            deviation * deviation + OWN * shared.iter().map(|part| part * part).sum::<f64>()
        };
        let variances: Vec<f64> = own.iter().zip(&parts).map(variance).collect();
        CorrelatedErrors::new(&variances, &parts).map(Some)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use asperity_inference::ForwardModel as _;
    use asperity_scenario::Document;
    use asperity_simulation::run::simulate;
    use serde_json::{Value, json};

    use crate::IdentificationProblem;

    /// Numbers of variance 1, nearly normal: sums of twelve uniform ones.
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            let mut uniform = || {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }
    }

    const RATE: f64 = 5e4;

    /// A block on a contact of unknown stiffness and damping, with these data.
    fn problem(data: &Value) -> IdentificationProblem {
        let scenario = json!({
            "schema": "asperity/scenario/1",
            "bodies": [{"name": "block", "length_m": 0.229, "mass_kg": 1.61, "youngs_modulus_pa": 71e9, "density_kg_per_m3": 2710}],
            "interfaces": [{"name": "foot", "area_m2": 1.15e-4, "law": "spring"}],
            "laws": {"spring": {"kind": "constant", "stiffness_pa_per_m": 4e11}},
            "support": {"kind": "rigid"},
            "damping": {"kind": "mass_proportional", "ratio": 0.03},
            "excitation": {"kind": "haversine", "peak_n": 2.0, "duration_s": 1e-3},
            "duration_s": 0.1, "output_rate_hz": RATE,
            "method": {"kind": "modal", "step_s": 1e-5, "modes_per_body": 2}
        });
        let unknowns = json!([
            {"kind": "scalar", "pointer": "/laws/spring/stiffness_pa_per_m", "bounds": [2e11, 8e11]},
            {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.01, 0.1]},
        ]);
        let whole = json!({"schema": "asperity/identify/1", "scenario": scenario,
            "unknowns": unknowns, "data": data});
        IdentificationProblem::of(Document::parse(&whole.to_string(), "problem.json").unwrap())
            .unwrap()
    }

    /// Force and acceleration without noise, from three milliseconds before the hit.
    fn clean() -> [Vec<f64>; 2] {
        let placeholder = json!([{"kind": "hits", "hits": [{"features":
            {"fundamental.frequency_hz": {"value": 870.0, "standard_deviation": 1.0}}}]}]);
        let scenario = problem(&placeholder).model().unwrap().forward.scenario.to_string();
        let document = Document::parse(&scenario, "rig.json").unwrap();
        let history = simulate(&document, &document.scenario().unwrap()).unwrap().transient.history;
        [&history.load, &history.sensors[0].acceleration]
            .map(|column| [&[0.0; 150][..], column].concat())
    }

    /// The problem of a hit whose channels have white noise of these parts of their largest samples.
    fn recorded(
        clean: &[Vec<f64>; 2],
        parts: [f64; 2],
        noise: &mut Noise,
    ) -> IdentificationProblem {
        let mut noisy = |place: usize| -> Vec<f64> {
            let largest = clean[place].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            clean[place].iter().map(|x| x + parts[place] * largest * noise.next()).collect()
        };
        let (force, response) = (noisy(0), noisy(1));
        let channels = json!([
            {"name": "force", "unit": "N", "data": force},
            {"name": "top", "unit": "m/s^2", "data": response},
        ]);
        let data = json!([{"kind": "records", "response": "top", "band_hz": [700, 1000],
            "files": [{"sample_rate_hz": RATE, "channels": channels}]}]);
        problem(&data)
    }

    /// A response of the other polarity, without noise, beside a force with noise: the first explanation of the misfit.
    #[test]
    fn the_other_polarity_is_told_beside_noise_of_the_force() {
        let mut clean = clean();
        clean[1].iter_mut().for_each(|x| *x = -*x);
        let found = crate::identify(&recorded(&clean, [2e-2, 0.0], &mut Noise(2))).unwrap();
        assert_eq!(found.judgement().usability, crate::Usability::No);
        let first = &found.explanations[0];
        assert!(first.cause.contains("other polarity"), "{:?}", found.explanations);
    }

    /// Stiffnesses from single hits whose force has noise: their distances from the truth are as large as their standard
    /// deviations say, and chi-square is that of independent errors; without the shared errors neither is.
    #[test]
    fn noise_of_the_force_is_in_the_standard_deviations() {
        const HITS: usize = 60;
        let clean = clean();
        let mut noise = Noise(1);
        // Mean square of the distance in standard deviations, and of the residuals, with shared errors and without.
        let (mut distances, mut residuals) = ([0.0; 2], [0.0; 2]);
        for _ in 0..HITS {
            let shared = recorded(&clean, [2e-2, 1e-4], &mut noise).model().unwrap().forward;
            assert_eq!(shared.hits[0].shared_errors.len(), 1);
            let mut alone = shared.with_scaled("", 1.0);
            alone.hits[0].shared_errors.clear();
            for (place, model) in [shared, alone].iter().enumerate() {
                let found = model.differentiate(&[4e11, 0.03]).unwrap().unwrap();
                let (mut normal, mut right, mut chi_square) = ([[0.0; 2]; 2], [0.0; 2], 0.0);
                for (i, observation) in model.observations.iter().enumerate() {
                    let residual = (found.values[i].unwrap() - observation.value)
                        / observation.standard_deviation;
                    let row = [0, 1]
                        .map(|j| found.jacobian[i][j].unwrap() / observation.standard_deviation);
                    chi_square += residual * residual;
                    for j in 0..2 {
                        right[j] += row[j] * residual;
                        for k in 0..2 {
                            normal[j][k] += row[j] * row[k];
                        }
                    }
                }
                let [[a, b], [_, d]] = normal;
                let determinant = a * d - b * b;
                let shift = (d * right[0] - b * right[1]) / determinant;
                distances[place] += shift * shift / (d / determinant) / HITS as f64;
                residuals[place] += chi_square / model.observations.len() as f64 / HITS as f64;
            }
        }
        // A mean square of sixty has a spread of 0.18; the lines of a hit share few independent errors.
        assert!((0.6..1.6).contains(&distances[0]), "{distances:?}");
        assert!((0.85..1.15).contains(&residuals[0]), "{residuals:?}");
        assert!(distances[1] > 3.0, "{distances:?}");
    }
}
