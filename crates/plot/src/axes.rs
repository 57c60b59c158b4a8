//! Axes of quantities and of values of a scenario: words, units, display units.

use asperity_figure::Axis;
use asperity_simulation::quantity::Quantity;

/// Display units of SI units, with their factors: one unit for each quantity in all figures.
const SHOWN: [(&str, &str, f64); 4] =
    [("Pa", "MPa", 1e-6), ("m/N", "nm/N", 1e9), ("m", "µm", 1e6), ("s", "ms", 1e3)];

/// Units of the endings of keys. Of two that fit, the longer comes first.
const ENDINGS: [(&str, &str); 24] = [
    ("_pa_per_m", "Pa/m"),
    ("_n_per_m", "N/m"),
    ("_ns_per_m", "N s/m"),
    ("_pa_s_per_m", "Pa s/m"),
    ("_kg_per_m3", "kg/m³"),
    ("_m_per_s2", "m/s²"),
    ("_m_per_s", "m/s"),
    ("_rad_per_s", "rad/s"),
    ("_m_per_n", "m/N"),
    ("_per_m2", "1/m²"),
    ("_per_m", "1/m"),
    ("_per_s", "1/s"),
    ("_kg_m2", "kg m²"),
    ("_pa", "Pa"),
    ("_kg", "kg"),
    ("_m2", "m²"),
    ("_m3", "m³"),
    ("_hz", "Hz"),
    ("_rad", "rad"),
    ("_deg", "°"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("_j", "J"),
];

/// Keys whose words are others than in the key.
const WORDS: [(&str, &str); 6] = [
    ("peak_n", "peak force"),
    ("amplitude_n", "force amplitude"),
    ("amplitude_m_per_s2", "acceleration amplitude"),
    ("rise_s", "rise time"),
    ("time_s", "time"),
    ("youngs_modulus_pa", "Young's modulus"),
];

/// Keys of objects that are named before a value in them.
const OWNERS: [&str; 2] = ["damping", "friction"];

/// Keys of lists, with one of their items.
const ITEMS: [(&str, &str); 5] = [
    ("bodies", "body"),
    ("interfaces", "interface"),
    ("sensors", "sensor"),
    ("loads", "load"),
    ("laws", ""),
];

/// A linear axis of values in an SI unit, in its display unit.
pub(super) fn axis(label: impl Into<String>, unit: &str) -> Axis {
    let (unit, factor) = shown(unit);
    Axis::linear(label, unit).scale(factor)
}

/// The display unit of an SI unit, and its factor.
pub(super) fn shown(unit: &str) -> (&str, f64) {
    let known = SHOWN.iter().find(|known| known.0 == unit);
    known.map_or((unit, 1.0), |(_, shown, factor)| (*shown, *factor))
}

/// The axis of a quantity under a label; ratios of damping are in per cent.
pub(super) fn quantity_axis(quantity: Quantity, label: impl Into<String>) -> Axis {
    match quantity {
        Quantity::DampingRatio | Quantity::DampingRatioDecrement => {
            Axis::linear(label, "%").scale(100.0)
        }
        _ => axis(label, quantity.unit()),
    }
}

/// Words and SI unit of the value at a JSON Pointer of a scenario, such as `Mass of body 1` and kg for
/// `/bodies/0/mass_kg`. Other names are their own words.
pub fn pointer_words(pointer: &str) -> (String, &'static str) {
    let Some(path) = pointer.strip_prefix('/') else {
        return (pointer.to_owned(), "");
    };
    let keys: Vec<String> =
        path.split('/').map(|key| key.replace("~1", "/").replace("~0", "~")).collect();
    let last = keys.last().map_or("", String::as_str);
    let ending = ENDINGS.iter().find(|(ending, _)| last.ends_with(ending));
    let unit = ending.map_or("", |(_, unit)| *unit);
    if keys.len() > 1 && keys[0] == "laws" && last == "coefficient" {
        return (format!("Coefficient C of {}", keys[1]), "Pa^{1−m}/m");
    }
    let words = WORDS.iter().find(|(key, _)| *key == last).map(|(_, words)| (*words).to_owned());
    let words = words.unwrap_or_else(|| {
        let stem = ending.map_or(last, |(ending, _)| last.strip_suffix(ending).unwrap_or(last));
        stem.replace('_', " ")
    });
    let owner = keys.iter().rev().skip(1).find(|key| OWNERS.contains(&key.as_str()));
    let words = match owner {
        Some(owner) if !words.starts_with(owner.as_str()) => format!("{owner} {words}"),
        _ => words,
    };
    let of = keys.windows(2).find_map(|pair| {
        let (_, item) = ITEMS.iter().find(|(list, _)| *list == pair[0])?;
        match pair[1].parse::<usize>() {
            Ok(index) if !item.is_empty() => Some(format!(" of {item} {}", index + 1)),
            _ if keys.len() > 2 => Some(format!(" of {}", pair[1])),
            _ => None,
        }
    });
    (super::capital(&words) + &of.unwrap_or_default(), unit)
}

/// The axis of the value at a JSON Pointer, its words cut to `most` characters.
pub(super) fn pointer_axis(pointer: &str, most: usize) -> Axis {
    let (words, unit) = pointer_words(pointer);
    axis(super::fitted(&words, most), unit)
}

/// The factor from the value at a JSON Pointer to what its axis shows.
pub(super) fn display_factor(pointer: &str) -> f64 {
    shown(pointer_words(pointer).1).1
}

/// A value at a JSON Pointer as a text with its unit, such as `13.6 N`.
pub(super) fn pointer_value(pointer: &str, value: &str) -> String {
    let (words, unit) = pointer_words(pointer);
    match value.parse::<f64>() {
        Ok(_) if unit.is_empty() => format!("{words} {value}"),
        Ok(number) => {
            let (unit, factor) = shown(unit);
            let digits = format!("{:.6e}", factor * number);
            format!("{} {unit}", digits.parse::<f64>().unwrap_or(number))
        }
        Err(_) => value.trim_matches('"').to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_a_scenario_have_words_and_units() {
        for (pointer, words, unit) in [
            ("/excitation/peak_n", "Peak force", "N"),
            ("/bodies/0/mass_kg", "Mass of body 1", "kg"),
            ("/bodies/1/youngs_modulus_pa", "Young's modulus of body 2", "Pa"),
            ("/damping/ratio", "Damping ratio", ""),
            ("/interfaces/0/damping/time_s", "Damping time of interface 1", "s"),
            ("/laws/pl/coefficient", "Coefficient C of pl", "Pa^{1−m}/m"),
            ("/laws/a~1b/stiffness_pa_per_m", "Stiffness of a/b", "Pa/m"),
            ("/gravity_m_per_s2", "Gravity", "m/s²"),
            ("/interfaces/1/law", "Law of interface 2", ""),
            ("/excitation/duration_s", "Duration", "s"),
            ("gain of the force", "gain of the force", ""),
        ] {
            assert_eq!(pointer_words(pointer), (words.to_owned(), unit), "{pointer}");
        }
        assert_eq!(pointer_value("/excitation/peak_n", "13.6"), "13.6 N");
        assert_eq!(pointer_value("/excitation/rise_s", "0.34e-3"), "0.34 ms");
        assert_eq!(pointer_value("/damping/ratio", "0.03"), "Damping ratio 0.03");
        assert_eq!(pointer_value("/interfaces/0/law", "pl"), "pl");
    }
}
