//! Names and units of features for readers.

/// Endings of a feature's name and the unit that they carry, longer ones first.
const UNITS: [(&str, &str); 8] = [
    ("_pa_per_m", "Pa/m"),
    ("_m_per_n", "m/N"),
    ("_hz", "Hz"),
    ("_pa", "Pa"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("_j", "J"),
];

/// Features with a name of their own, in the order in which they are drawn.
const NAMES: [(&str, &str); 8] = [
    ("fundamental.frequency_hz", "Fundamental f_{1}"),
    ("fundamental.receptance_m_per_n", "Amplitude A_{1}"),
    ("second_harmonic.frequency_hz", "Harmonic f_{2}"),
    ("second_harmonic.receptance_m_per_n", "Amplitude A_{2}"),
    ("harmonic_ratio", "Ratio A_{2}/A_{1}"),
    ("fundamental.damping_ratio", "Damping ratio"),
    ("backbone.frequency_hz", "Frequency"),
    ("static.natural_frequency_hz", "Natural frequency at rest"),
];

/// Label and unit of a feature.
pub(super) fn feature_name(feature: &str) -> (String, &'static str) {
    if let Some(of) = feature.strip_prefix("ratio of ") {
        return (format!("Ratio of hits: {}", feature_name(of).0), "");
    }
    if feature.starts_with("receptance, ") {
        return (capital(feature), "m/N");
    }
    if feature.starts_with("stiffness of ") {
        return (capital(feature), "Pa/m");
    }
    let (stem, unit) = UNITS
        .iter()
        .find_map(|(ending, unit)| Some((feature.strip_suffix(ending)?, *unit)))
        .unwrap_or((feature, ""));
    if let Some((_, name)) = NAMES.iter().find(|(known, _)| *known == feature) {
        return ((*name).to_owned(), unit);
    }
    // interfaces.guide-sample.pressure_min is the pressure min of guide-sample.
    let mut parts: Vec<&str> = stem.split('.').collect();
    let last = parts.pop().unwrap_or_default().replace('_', " ");
    let of = parts.last().map_or_else(String::new, |of| format!(", {of}"));
    (format!("{}{of}", capital(&last)), unit)
}

/// Place of a feature among others: those with a name of their own come first.
pub(super) fn order(feature: &str) -> usize {
    NAMES.iter().position(|(known, _)| *known == feature).unwrap_or(NAMES.len())
}

/// The text with a capital first.
pub(super) fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_uppercase().collect::<String>());
    first.unwrap_or_default() + characters.as_str()
}

#[cfg(test)]
mod tests {
    use super::feature_name;

    #[test]
    fn features_have_names_and_units() {
        for (feature, label, unit) in [
            ("fundamental.frequency_hz", "Fundamental f_{1}", "Hz"),
            ("fundamental.receptance_m_per_n", "Amplitude A_{1}", "m/N"),
            ("harmonic_ratio", "Ratio A_{2}/A_{1}", ""),
            ("ratio of fundamental.frequency_hz", "Ratio of hits: Fundamental f_{1}", ""),
            ("receptance, real part", "Receptance, real part", "m/N"),
            ("stiffness of pl", "Stiffness of pl", "Pa/m"),
            ("interfaces.top.pressure_min_pa", "Pressure min, top", "Pa"),
            ("interfaces.top.stiffness_average_pa_per_m", "Stiffness average, top", "Pa/m"),
            ("energy.residual_relative", "Residual relative, energy", ""),
        ] {
            assert_eq!(feature_name(feature), (label.to_owned(), unit), "{feature}");
        }
    }
}
