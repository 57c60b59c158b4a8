//! Dependence on rounding, by a twin under a slightly larger force.

use asperity_dynamics::{Excitation, HitResponse};

/// Relative change of the force of the twin that shows dependence on rounding.
const PERTURBATION: f64 = 1e-12;

/// Difference of two displacements, over the largest, from which on they count as parted.
const PARTED: f64 = 1e-3;

/// The force of a response that shows dependence on rounding.
pub(crate) fn perturbed(excitation: &Excitation) -> Excitation {
    excitation.scaled(1.0 + PERTURBATION)
}

/// Sample from which on two displacements differ.
pub(crate) fn parting_sample(a: &[f64], b: &[f64]) -> Option<usize> {
    let largest = a.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    a.iter().zip(b).position(|(a, b)| (a - b).abs() > PARTED * largest)
}

/// Time \[s\] from which on the displacements of two responses differ.
pub(super) fn parting(a: &HitResponse, b: &HitResponse) -> Option<f64> {
    let sample = parting_sample(&a.displacement, &b.displacement)?;
    // The filter delays by half its length.
    let steps = (sample * a.decimation.factor).saturating_sub(a.decimation.taps.len() / 2);
    Some(steps as f64 * a.step)
}
