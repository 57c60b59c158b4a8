//! The strongest resonance of free decays.

use crate::error::Result;
use crate::noise::median_of;
use crate::spectrum::Spectrum;

/// Zero padding of the spectra.
const PADDING: usize = 4;
/// Least height of a neighbouring resonance over the height of the strongest, and the largest
/// minimum between both over the height of the neighbour.
const NEIGHBOUR: f64 = 0.02;
const VALLEY: f64 = 0.3;
/// Least power of a neighbour over the median about the strongest resonance: the largest of a
/// thousand lines of noise is ten times theirs.
const ABOVE_NOISE: f64 = 30.0;
/// Part of the distance to a neighbour that a band extends.
const SHARE: f64 = 0.5;

/// A resonance in the spectra of free decays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayResonance {
    /// Frequency of the largest line, in hertz.
    pub frequency_hz: f64,
    /// Half of the distance to the next resonance, in hertz; infinite without one.
    pub half_width_hz: f64,
}

impl DecayResonance {
    /// The strongest resonance of some responses in a band, by their summed spectra as velocities.
    ///
    /// In a velocity modes of equal decay rate and energy are equally high. Each response is divided
    /// by its largest line in the band. Other maxima count as resonances from 2 % of the strongest
    /// and well above the noise, if the spectrum between both falls below 0.3 of theirs.
    ///
    /// - `responses`: the free decay, and the derivatives of the displacement that it is (0 to 2).
    /// - `band_hz`: lower and upper limit, in hertz.
    ///
    /// `None` without a maximum in the band.
    ///
    /// # Errors
    /// Those of [`Spectrum::new`].
    pub fn strongest(
        responses: &[(&[f64], i32)],
        sample_rate_hz: f64,
        band_hz: (f64, f64),
    ) -> Result<Option<Self>> {
        let mut sum: Vec<f64> = Vec::new();
        let mut step = 1.0;
        for (samples, derivatives) in responses {
            let spectrum = Spectrum::new(samples, sample_rate_hz, PADDING)?;
            step = spectrum.frequency_step();
            let power = |index: usize| {
                let frequency = spectrum.frequency(index);
                let weight = frequency.powi(1 - derivatives);
                spectrum.values()[index].norm_sqr() * weight * weight
            };
            let own: Vec<f64> = (0..spectrum.values().len())
                .map(|index| if index == 0 { 0.0 } else { power(index) })
                .collect();
            let inside = own
                .iter()
                .enumerate()
                .filter(|(index, _)| (band_hz.0..=band_hz.1).contains(&(*index as f64 * step)));
            let largest = inside.map(|(_, power)| *power).fold(0.0, f64::max);
            sum.resize(own.len(), 0.0);
            if largest > 0.0 {
                sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own / largest);
            }
        }
        let maxima: Vec<usize> = (1..sum.len().saturating_sub(1))
            .filter(|&k| sum[k] > sum[k - 1] && sum[k] >= sum[k + 1])
            .collect();
        let inside = |k: &usize| (band_hz.0..=band_hz.1).contains(&(*k as f64 * step));
        let strongest =
            maxima.iter().copied().filter(inside).max_by(|&a, &b| sum[a].total_cmp(&sum[b]));
        let Some(top) = strongest else { return Ok(None) };
        let about = &sum[top / 2..(top + top / 2).min(sum.len())];
        let noise = median_of(&mut about.to_vec()).unwrap_or(0.0);
        let least = (NEIGHBOUR * NEIGHBOUR * sum[top]).max(ABOVE_NOISE * noise);
        // The nearest on each side: outwards, with the smallest value so far.
        let nearest = |mut outwards: &mut dyn Iterator<Item = usize>| {
            let mut valley = sum[top];
            Iterator::find(&mut outwards, |&k| {
                valley = valley.min(sum[k]);
                let is_maximum =
                    k > 0 && k + 1 < sum.len() && sum[k] > sum[k - 1] && sum[k] >= sum[k + 1];
                is_maximum && sum[k] >= least && valley < VALLEY * VALLEY * sum[k]
            })
        };
        let neighbours = [nearest(&mut (0..top).rev()), nearest(&mut (top + 1..sum.len()))];
        let distance = neighbours
            .into_iter()
            .flatten()
            .map(|k| k.abs_diff(top))
            .min()
            .map_or(f64::INFINITY, |lines| lines as f64 * step);
        Ok(Some(Self { frequency_hz: top as f64 * step, half_width_hz: SHARE * distance }))
    }
}
