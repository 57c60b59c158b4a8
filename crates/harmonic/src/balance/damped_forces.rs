//! Damped contact forces at the samples of a period.

use crate::fourier::{Fourier, rate_of};

/// Damped contact forces at the samples of a period, and the dependence of all forces on the
/// frequency.
#[derive(Debug, Clone)]
pub(super) struct DampedForces {
    rate_series: Vec<f64>,
    /// Rates of the contact last evaluated \[m/s\], and its dampers \[N s/m\].
    pub(super) rates: Vec<f64>,
    pub(super) dampers: Vec<f64>,
    damper_series: Vec<f64>,
    product: Vec<f64>,
    scaled: Vec<f64>,
    /// Derivatives of `P_k` with respect to the angular frequency, of each pair.
    pub(super) d_frequency: Vec<f64>,
}

impl DampedForces {
    pub(super) fn new(fourier: &Fourier, pairs: usize) -> Self {
        let (terms, samples) = (fourier.terms(), fourier.samples());
        Self {
            rate_series: vec![0.0; terms],
            rates: vec![0.0; samples],
            dampers: vec![0.0; samples],
            damper_series: vec![0.0; 2 * terms - 1],
            product: vec![0.0; terms * terms],
            scaled: vec![0.0; samples],
            d_frequency: vec![0.0; terms * pairs],
        }
    }

    /// Samples the rates of a closure's series at the angular frequency `w` \[rad/s\].
    pub(super) fn sample_rates(&mut self, fourier: &Fourier, series: &[f64], w: f64) {
        rate_of(series, w, &mut self.rate_series);
        fourier.synthesise(&self.rate_series, &mut self.rates);
    }

    /// Adds the dampers' part of the derivative of contact `i`'s force with respect to its closure
    /// to `product`, and finds that with respect to the frequency; false if one is not finite.
    pub(super) fn differentiate(
        &mut self,
        fourier: &Fourier,
        i: usize,
        w: f64,
        product: &mut [f64],
    ) -> bool {
        let terms = fourier.terms();
        fourier.analyse(&self.dampers, &mut self.damper_series);
        if !self.damper_series.iter().all(|value| value.is_finite()) {
            return false;
        }
        fourier.product(&self.damper_series, &mut self.product);
        fourier.add_rates(&self.product, w, product);
        // The forces grow by c x' / w per frequency.
        for ((scaled, rate), damper) in self.scaled.iter_mut().zip(&self.rates).zip(&self.dampers) {
            *scaled = rate * damper / w;
        }
        fourier.analyse(&self.scaled, &mut self.d_frequency[i * terms..(i + 1) * terms]);
        true
    }
}
