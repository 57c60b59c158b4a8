//! Suggestion of a known word for a misspelt one.

/// Most candidates that are compared.
const MAX_COMPARED: usize = 1000;

/// Candidate nearest to `word` in the Damerau-Levenshtein distance, if it is a likely misspelling.
///
/// A likely misspelling differs in case and separators only, is a prefix (or has one) of at least
/// three letters, or differs in at most a third of the letters.
pub(crate) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let word = normalised(word);
    let letters = word.chars().count();
    if letters == 0 || letters > 200 {
        return None;
    }
    candidates
        .into_iter()
        .take(MAX_COMPARED)
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
    fn the_nearest_word_is_found() {
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
    fn a_distant_word_has_no_suggestion() {
        for typed in ["", "colour", "x", "temperature_k"] {
            assert_eq!(nearest(typed, ["name", "length_m", ""]), None, "{typed}");
        }
    }
}
