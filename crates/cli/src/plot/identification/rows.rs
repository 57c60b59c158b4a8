//! Observations with their predictions and bands.

use asperity_identify::{Identification, Observed};

/// What kind of number an observation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A number of a hit, over its peak force \[N\].
    Hit,
    /// A part of a receptance \[m/N\], over frequency \[Hz\].
    Receptance,
    /// The frequency \[Hz\] along a decay, over amplitude \[m\].
    Backbone,
    /// The stiffness \[Pa/m\] of a law, over pressure \[Pa\].
    Stiffness,
}

/// One observation with its prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row<'a> {
    pub(super) kind: Kind,
    pub(super) data: &'a str,
    pub(super) feature: &'a str,
    /// The abscissa of its kind; NaN for a hit of the scenario's own force.
    pub(super) at: f64,
    pub(super) value: f64,
    pub(super) standard_deviation: f64,
    /// As predicted by the best fit; NaN where it predicts nothing.
    pub(super) predicted: f64,
    /// Ends of the interval of the prediction; NaN where there is none.
    pub(super) band: [f64; 2],
    /// Predicted less measured, in standard deviations; NaN where nothing is predicted.
    pub(super) residual: f64,
}

/// The observations of an identification, in its order.
pub(super) fn rows(found: &Identification) -> Vec<Row<'_>> {
    let ends = found.predicted_band();
    let end = |side: usize, i: usize| ends[side].get(i).copied().unwrap_or(f64::NAN);
    found.observed().enumerate().map(|(i, of)| row(of, [end(0, i), end(1, i)])).collect()
}

fn row(of: Observed<'_>, band: [f64; 2]) -> Row<'_> {
    Row {
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

fn kind(feature: &str) -> Kind {
    if feature.starts_with("stiffness of ") {
        Kind::Stiffness
    } else if feature.starts_with("receptance, ") {
        Kind::Receptance
    } else if feature.starts_with("backbone.") {
        Kind::Backbone
    } else {
        Kind::Hit
    }
}

/// The rows in groups of one key, in the order in which the keys come.
pub(super) fn groups<'a>(
    rows: impl IntoIterator<Item = &'a Row<'a>>,
    key: fn(&Row<'a>) -> &'a str,
) -> Vec<(&'a str, Vec<&'a Row<'a>>)> {
    let mut groups: Vec<(&str, Vec<&Row<'_>>)> = Vec::new();
    for row in rows {
        let name = key(row);
        match groups.iter_mut().find(|group| group.0 == name) {
            Some(group) => group.1.push(row),
            None => groups.push((name, vec![row])),
        }
    }
    groups
}

/// One column of some rows.
pub(super) fn column(rows: &[&Row<'_>], value: impl Fn(&Row<'_>) -> f64) -> Vec<f64> {
    rows.iter().map(|row| value(row)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_know_their_abscissa_and_what_is_missing() {
        let of = Observed {
            data: "d",
            feature: "stiffness of pl",
            at: Some(1e5),
            value: 1e12,
            standard_deviation: 1e11,
            predicted: None,
            residual: 10.0,
        };
        let row = row(of, [f64::NAN; 2]);
        assert_eq!((row.kind, row.at), (Kind::Stiffness, 1e5));
        // The stand-in for a missing prediction is no residual.
        assert!(row.residual.is_nan() && row.predicted.is_nan());
        assert_eq!(kind("receptance, real part"), Kind::Receptance);
        assert_eq!(kind("backbone.frequency_hz"), Kind::Backbone);
        assert_eq!(kind("ratio of harmonic_ratio"), Kind::Hit);
    }
}
