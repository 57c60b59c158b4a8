//! Correlation of residuals: a misfit is the same error in neighbouring observations and in repeated hits.
//!
//! Uncertainties that take the residuals for independent errors are too small by the root of
//!
//! ```text
//! t = tau (1 + (n - 1) rho),    tau = 1 + 2 sum_k rho_k,
//! ```
//!
//! with the autocorrelation `rho_k` along frequency, amplitude or force, and the mean correlation `rho` of the
//! `n` hits with each other. Source: for `tau` e.g. A. Sokal, *Monte Carlo Methods in Statistical Mechanics*,
//! 1997, section 2.

use std::collections::BTreeMap;

use crate::built_model::ObservationLabel;
use crate::observed_quantity::{ComplexPart, ObservedQuantity};

/// Autocorrelation at which the sum ends.
const LEAST: f64 = 0.05;

/// Fewest pairs of residuals of a correlation.
const FEWEST: usize = 8;

/// A row of residuals along one abscissa: its kind, and the hit or sweep.
type RowKey = (u8, usize, usize);

/// The factor `t` of standardised residuals, at least 1.
pub(super) fn correlation_factor(
    quantities: &[ObservedQuantity],
    about: &[ObservationLabel],
    residuals: &[f64],
) -> f64 {
    let mut rows: BTreeMap<RowKey, Vec<(f64, f64)>> = BTreeMap::new();
    for ((quantity, about), residual) in quantities.iter().zip(about).zip(residuals) {
        if let (Some(key), Some(at)) = (row_of(quantity), about.at) {
            rows.entry(key).or_default().push((at, *residual));
        }
    }
    for row in rows.values_mut() {
        row.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let lists: Vec<(RowKey, Vec<f64>)> = rows
        .into_iter()
        .map(|(key, row)| (key, row.into_iter().map(|one| one.1).collect()))
        .collect();
    along(&lists) * between(&lists)
}

/// The row of an observation; features of hits are one over their force.
fn row_of(quantity: &ObservedQuantity) -> Option<RowKey> {
    Some(match *quantity {
        ObservedQuantity::Receptance { hit, part: ComplexPart::Real, .. } => (0, 0, hit),
        ObservedQuantity::Receptance { hit, part: ComplexPart::Imaginary, .. } => (1, 0, hit),
        ObservedQuantity::Backbone { hit, is_damping, .. } => (2 + u8::from(is_damping), 0, hit),
        ObservedQuantity::SteadyAmplitude { .. } => (4, 0, 0),
        ObservedQuantity::SteadyPhase { .. } => (5, 0, 0),
        ObservedQuantity::Feature { column, .. } => (6, column, 0),
        ObservedQuantity::Ratio { .. } | ObservedQuantity::Stiffness { .. } => return None,
    })
}

/// Integrated autocorrelation along the rows.
fn along(rows: &[(RowKey, Vec<f64>)]) -> f64 {
    let longest = rows.iter().map(|row| row.1.len()).max().unwrap_or(0);
    let mean = |lag: usize| {
        let pairs = rows.iter().flat_map(|(_, row)| row.iter().zip(row.iter().skip(lag)));
        let (count, sum) = pairs.fold((0, 0.0), |(count, sum), (a, b)| (count + 1, sum + a * b));
        (count >= FEWEST).then(|| sum / count as f64)
    };
    let Some(variance) = mean(0).filter(|variance| *variance > 0.0) else { return 1.0 };
    let correlations = (1..=longest / 2).map_while(mean).map(|sum| sum / variance);
    1.0 + 2.0 * correlations.take_while(|rho| *rho > LEAST).sum::<f64>()
}

/// One plus the mean correlation of the other hits with each, over rows of one kind and length.
fn between(rows: &[(RowKey, Vec<f64>)]) -> f64 {
    let (mut product, mut size, mut count, mut most) = (0.0, 0.0, 0, 1);
    for kind in rows.chunk_by(|a, b| (a.0.0, a.0.1) == (b.0.0, b.0.1)) {
        most = most.max(kind.len());
        for (place, (_, one)) in kind.iter().enumerate() {
            for (_, other) in kind[place + 1..].iter().filter(|(_, o)| o.len() == one.len()) {
                for (a, b) in one.iter().zip(other) {
                    product += a * b;
                    size += 0.5 * (a * a + b * b);
                    count += 1;
                }
            }
        }
    }
    if count < FEWEST || size == 0.0 {
        return 1.0;
    }
    1.0 + (most - 1) as f64 * (product / size).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(hits: usize, lines: usize, residual: &dyn Fn(usize, usize) -> f64) -> f64 {
        let (mut quantities, mut about, mut residuals) = (Vec::new(), Vec::new(), Vec::new());
        for hit in 0..hits {
            for place in 0..lines {
                let part = ComplexPart::Real;
                quantities.push(ObservedQuantity::Receptance { hit, place, part });
                about.push(ObservationLabel::new("data", "receptance", Some(place as f64)));
                residuals.push(residual(hit, place));
            }
        }
        correlation_factor(&quantities, &about, &residuals)
    }

    /// Numbers without order, between -1 and 1.
    fn noise(hit: usize, place: usize) -> f64 {
        let x = (12.9898 * hit as f64 + 78.233 * place as f64).sin() * 43_758.545;
        2.0 * (x - x.floor()) - 1.0
    }

    #[test]
    fn independent_residuals_have_none_and_a_common_misfit_has_that_of_its_length_and_hits() {
        let white = factor(6, 200, &noise);
        assert!((1.0..1.5).contains(&white), "{white}");
        // A wave of 40 lines in each hit at a phase of its own: the first zero is at 10 lines.
        let wave = |hit: usize, place: usize| (0.157 * place as f64 + 2.1 * hit as f64).sin();
        let own = factor(3, 200, &wave);
        let common = factor(3, 200, &|_, place| wave(0, place));
        assert!((8.0..20.0).contains(&own), "{own}");
        assert!((common / own / 3.0 - 1.0).abs() < 0.4, "{own} {common}");
    }
}
