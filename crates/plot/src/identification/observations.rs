//! Observations with their predictions and bands, and the labels of their features.

use asperity_identify::{Identification, PredictedObservation};
use asperity_simulation::quantity::Quantity;

use crate::capital;

/// Kind of an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ObservationKind {
    /// A number of a hit, over its peak force \[N\].
    Hit,
    /// A part of a receptance \[m/N\], over frequency \[Hz\].
    Receptance,
    /// The frequency \[Hz\] or damping ratio along a decay, over amplitude \[m\].
    Backbone,
    /// Amplitude \[m\] or phase \[rad\] of a steady response, over frequency \[Hz\].
    Steady,
    /// The stiffness \[Pa/m\] of a law, over pressure \[Pa\].
    Stiffness,
}

/// One observation with its prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ObservationRow<'a> {
    pub(super) kind: ObservationKind,
    pub(super) data: &'a str,
    pub(super) feature: &'a str,
    /// The abscissa of its kind; NaN for a hit of the scenario's own force.
    pub(super) at: f64,
    pub(super) value: f64,
    pub(super) standard_deviation: f64,
    /// Prediction of the best fit; NaN without one.
    pub(super) predicted: f64,
    /// Ends of the interval of the prediction; NaN where there is none.
    pub(super) band: [f64; 2],
    /// Predicted less measured, in standard deviations; NaN without a prediction.
    pub(super) residual: f64,
}

/// The observations of an identification, in its order.
pub(super) fn rows(found: &Identification) -> Vec<ObservationRow<'_>> {
    let ends = found.predicted_band();
    let end = |side: usize, i: usize| ends[side].get(i).copied().unwrap_or(f64::NAN);
    found.observations().enumerate().map(|(i, of)| row(of, [end(0, i), end(1, i)])).collect()
}

fn row(of: PredictedObservation<'_>, band: [f64; 2]) -> ObservationRow<'_> {
    ObservationRow {
        kind: kind(of.feature),
        data: of.data,
        feature: of.feature,
        at: of.at.unwrap_or(f64::NAN),
        value: of.value,
        standard_deviation: of.standard_deviation,
        predicted: of.predicted.unwrap_or(f64::NAN),
        band,
        residual: of.predicted.map_or(f64::NAN, |_| of.residual),
    }
}

fn kind(feature: &str) -> ObservationKind {
    if feature.starts_with("stiffness of ") {
        ObservationKind::Stiffness
    } else if feature.starts_with("receptance, ") {
        ObservationKind::Receptance
    } else if feature.starts_with("steady ") {
        ObservationKind::Steady
    } else if feature.starts_with("backbone.") {
        ObservationKind::Backbone
    } else {
        ObservationKind::Hit
    }
}

/// The items in groups of one key, keys in order of first appearance.
pub(super) fn groups<'a, T, K: PartialEq>(
    items: impl IntoIterator<Item = &'a T>,
    key: fn(&'a T) -> K,
) -> Vec<(K, Vec<&'a T>)> {
    let mut groups: Vec<(K, Vec<&T>)> = Vec::new();
    for item in items {
        let name = key(item);
        match groups.iter_mut().find(|group| group.0 == name) {
            Some(group) => group.1.push(item),
            None => groups.push((name, vec![item])),
        }
    }
    groups
}

/// One value of each observation.
pub(super) fn column(
    rows: &[&ObservationRow<'_>],
    value: impl Fn(&ObservationRow<'_>) -> f64,
) -> Vec<f64> {
    rows.iter().map(|row| value(row)).collect()
}

/// Quantities that are drawn first, in this order.
const FIRST: [Quantity; 6] = [
    Quantity::FundamentalFrequency,
    Quantity::FundamentalReceptance,
    Quantity::SecondHarmonicFrequency,
    Quantity::SecondHarmonicReceptance,
    Quantity::HarmonicRatio,
    Quantity::DampingRatio,
];

/// Label and unit of an observable of a run, by its column, or of another feature of measured data; the
/// label has subscripts such as `f_{1}`.
pub fn feature_name(feature: &str) -> (String, &'static str) {
    if let Some(of) = feature.strip_prefix("ratio of ") {
        return (format!("Ratio of hits: {}", feature_name(of).0), "");
    }
    if feature.starts_with("receptance, ") {
        return (capital(feature), "m/N");
    }
    if feature.starts_with("stiffness of ") {
        return (capital(feature), "Pa/m");
    }
    if let Some(level) = feature.strip_prefix("steady amplitude_m at ") {
        return (format!("Amplitude at {level}"), "m");
    }
    if let Some(level) = feature.strip_prefix("steady phase_rad at ") {
        return (format!("Phase at {level}"), "rad");
    }
    if feature == "backbone.frequency_hz" {
        return ("Frequency".to_owned(), "Hz");
    }
    if feature == "backbone.damping_ratio" {
        return ("Damping ratio".to_owned(), "");
    }
    match Quantity::of_name(feature) {
        Some((quantity, None)) => (quantity.label().to_owned(), quantity.unit()),
        Some((quantity, Some(interface))) => {
            (format!("{}, {interface}", quantity.label()), quantity.unit())
        }
        None => (capital(feature), ""),
    }
}

/// Place of a feature among others.
pub(super) fn order(feature: &str) -> usize {
    let quantity = Quantity::of_name(feature).map(|(quantity, _)| quantity);
    FIRST.iter().position(|first| Some(*first) == quantity).unwrap_or(FIRST.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn observations_have_an_abscissa_and_nan_for_missing_values() {
        let of = PredictedObservation {
            data: "d",
            feature: "stiffness of pl",
            at: Some(1e5),
            value: 1e12,
            standard_deviation: 1e11,
            predicted: None,
            residual: 10.0,
        };
        let row = row(of, [f64::NAN; 2]);
        assert_eq!((row.kind, row.at), (ObservationKind::Stiffness, 1e5));
        // The stand-in for a missing prediction is no residual.
        assert!(row.residual.is_nan() && row.predicted.is_nan());
        assert_eq!(kind("receptance, real part"), ObservationKind::Receptance);
        assert_eq!(kind("backbone.frequency_hz"), ObservationKind::Backbone);
        assert_eq!(kind("ratio of harmonic_ratio"), ObservationKind::Hit);
    }

    #[test]
    fn features_have_names_and_units() {
        for (feature, label, unit) in [
            ("fundamental.frequency_hz", "Fundamental f_{1}", "Hz"),
            ("fundamental.receptance_m_per_n", "Amplitude A_{1}", "m/N"),
            ("harmonic_ratio", "Ratio A_{2}/A_{1}", ""),
            ("ratio of fundamental.frequency_hz", "Ratio of hits: Fundamental f_{1}", ""),
            ("receptance, real part", "Receptance, real part", "m/N"),
            ("stiffness of pl", "Stiffness of pl", "Pa/m"),
            ("interfaces.top.pressure_min_pa", "Lowest pressure, top", "Pa"),
            ("interfaces.top.stiffness_average_pa_per_m", "Average stiffness, top", "Pa/m"),
            ("energy.residual_relative", "Residual of the energy balance", ""),
        ] {
            assert_eq!(feature_name(feature), (label.to_owned(), unit), "{feature}");
        }
    }
}
