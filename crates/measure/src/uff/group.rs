//! Functions sampled together.
//!
//! The format does not contain this information. Consecutive functions with the same
//! axis, or with times of one rate that overlap, belong to one record, up to one that the record already has: with
//! the same nodes, the same quantity, and the same name but for the number of
//! the hit.

use std::collections::HashSet;

use crate::uff::header::FunctionHeader;
use crate::uff::index::Group;

/// Divides the entries into groups, in their order.
pub(crate) fn groups(entries: Group) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let mut seen = HashSet::new();
    for entry in entries {
        let identity = identity(&entry.header);
        let first = groups.last().and_then(|group| group.first());
        let same_record = first.is_some_and(|first| same_axis(&first.header, &entry.header))
            && !seen.contains(&identity);
        if let Some(group) = groups.last_mut().filter(|_| same_record) {
            group.push(entry);
        } else {
            groups.push(vec![entry]);
            seen.clear();
        }
        seen.insert(identity);
    }
    groups
}

fn same_axis(one: &FunctionHeader, other: &FunctionHeader) -> bool {
    one.points == other.points
        && one.even == other.even
        && starts_together(one, other)
        && one.step == other.step
        && one.abscissa.kind == other.abscissa.kind
        && (one.function == 1) == (other.function == 1)
}

/// True for the same start, or for times of one rate that overlap.
fn starts_together(one: &FunctionHeader, other: &FunctionHeader) -> bool {
    let in_time = one.function == 1 && other.function == 1 && one.even && one.step > 0.0;
    let apart = (one.start - other.start).abs();
    apart == 0.0 || in_time && apart < one.points as f64 * one.step
}

/// Identity of a channel in different hits.
fn identity(header: &FunctionHeader) -> String {
    let node = |freedom: &Option<crate::DegreeOfFreedom>| {
        freedom.as_ref().map_or_else(String::new, |freedom| {
            format!("{} {} {}", freedom.entity, freedom.node, freedom.direction)
        })
    };
    format!(
        "{}|{}|{}|{}|{}|{}",
        header.function,
        node(&header.response),
        node(&header.reference),
        header.ordinate.kind,
        header.ordinate.unit,
        without_hit_number(&header.name)
    )
}

/// The name without the number after a word such as `hit`:
/// `acc 1` and `acc 2` are two channels, `hit 1 acc` and `hit 2 acc` are one.
fn without_hit_number(name: &str) -> String {
    const WORDS: [&str; 10] = [
        "hit",
        "hits",
        "impact",
        "run",
        "record",
        "test",
        "measurement",
        "shot",
        "trial",
        "average",
    ];
    let mut kept = String::with_capacity(name.len());
    let (mut word, mut after_word) = (String::new(), false);
    for character in name.to_lowercase().chars() {
        if character.is_alphabetic() {
            word.push(character);
            after_word = false;
        } else if !word.is_empty() {
            after_word = WORDS.contains(&word.as_str());
            word.clear();
        }
        if !(after_word && character.is_ascii_digit()) {
            kept.push(character);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_the_hit_does_not_count_and_others_do() {
        assert_eq!(without_hit_number("hit 1 force"), without_hit_number("hit 12 force"));
        assert_eq!(without_hit_number("Run_3: acc 1"), without_hit_number("run_4: acc 1"));
        assert_ne!(without_hit_number("acc 1"), without_hit_number("acc 2"));
        assert_ne!(without_hit_number("hit 1 acc 1"), without_hit_number("hit 1 acc 2"));
    }
}
