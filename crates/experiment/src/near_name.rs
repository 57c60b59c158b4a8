//! The known name that is nearest to one that names nothing.

/// The nearest of `known`: the same but for its case, else with few letters that differ.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = name.trim().to_lowercase();
    let most = (wanted.chars().count() / 3).clamp(1, 3);
    known
        .map(|known| (distance(&wanted, &known.trim().to_lowercase()), known))
        .filter(|(distance, _)| *distance <= most)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, known)| known)
}

/// Letters to insert, remove or replace (Levenshtein).
fn distance(one: &str, other: &str) -> usize {
    let other: Vec<char> = other.chars().collect();
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (index, a) in one.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], index + 1);
        for (column, b) in other.iter().enumerate() {
            let replaced = diagonal + usize::from(a != *b);
            diagonal = row[column + 1];
            row[column + 1] = replaced.min(row[column] + 1).min(diagonal + 1);
        }
    }
    row.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_a_slip_are_found() {
        let known = ["hammer", "top (front)", "top (rear)"];
        let of = |name: &str| nearest(name, known.into_iter());
        assert_eq!(of("Hammer"), Some("hammer"));
        assert_eq!(of("hamer "), Some("hammer"));
        assert_eq!(of("top (raer)"), Some("top (rear)"));
        assert_eq!(of("foo"), None);
        assert_eq!((distance("", "abc"), distance("kitten", "sitting")), (3, 3));
    }
}
