//! The nearest known word to one that is not known.

/// Candidates beyond this many are not compared.
const MOST_COMPARED: usize = 1000;

/// The candidate nearest to `word`, if one is near enough to be meant.
///
/// Near enough: equal but for case and separators, one a prefix of the other
/// (at least three letters), or no more than a third of the letters mistyped.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = normalised(word);
    let letters = word.chars().count();
    if letters == 0 || letters > 200 {
        return None;
    }
    candidates
        .into_iter()
        .take(MOST_COMPARED)
        .filter_map(|candidate| {
            let known = normalised(candidate);
            let distance = strsim::damerau_levenshtein(&word, &known);
            let prefix = letters >= 3 && (known.starts_with(&word) || word.starts_with(&known));
            let near = distance <= (letters.max(known.chars().count()) / 3).max(1);
            let meant = prefix || (near && distance < letters);
            (meant && !known.is_empty()).then_some((distance, candidate))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// Lower case, with spaces and hyphens as underscores.
fn normalised(word: &str) -> String {
    word.trim().to_lowercase().replace([' ', '-'], "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_is_meant() {
        let keys = ["name", "length_m", "area_m2", "mass_kg", "density_kg_per_m3"];
        for (typed, meant) in [
            ("lenght_m", "length_m"),
            ("length", "length_m"),
            ("Mass-kg", "mass_kg"),
            ("density", "density_kg_per_m3"),
            ("nme", "name"),
            ("mass_g", "mass_kg"),
        ] {
            assert_eq!(nearest(typed, keys), Some(meant), "{typed}");
        }
    }

    #[test]
    fn stays_silent_when_nothing_is_near() {
        for typed in ["", "colour", "x", "temperature_k"] {
            assert_eq!(nearest(typed, ["name", "length_m", ""]), None, "{typed}");
        }
    }
}
