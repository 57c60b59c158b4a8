//! Variations: places of a scenario and the values they take.

use thiserror::Error;

/// Most runs of one sweep: values, results and their table take about 1.5 kB a run,
/// 1.5 GB in all.
pub const MOST_RUNS: usize = 1_000_000;

/// One place of the scenario and the values it takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variation {
    /// JSON Pointer into the scenario.
    pub pointer: String,
    /// The values, as JSON or bare text.
    pub values: Vec<String>,
}

/// A variation that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum VariationError {
    /// There is no equals sign.
    #[error("`{0}` has no \"=\"; accepted: POINTER=start:stop:count or POINTER=v1,v2,...")]
    NoEquals(String),
    /// There are no values.
    #[error("{0}: no values; accepted: start:stop:count or v1,v2,...")]
    Empty(String),
    /// A range that is not two numbers and a count.
    #[error(
        "{pointer}: `{text}` is not a range; accepted: start:stop:count with finite numbers and a count from 1 to {}",
        MOST_RUNS
    )]
    Range {
        /// The pointer.
        pointer: String,
        /// The values as given.
        text: String,
    },
    /// More runs than a sweep takes.
    #[error("the sweep would take {} runs; at most {} are accepted", .0, MOST_RUNS)]
    TooMany(u128),
}

impl Variation {
    /// Reads `POINTER=start:stop:count` (linear, ends included) or `POINTER=v1,v2,...`.
    ///
    /// # Errors
    /// [`VariationError`] when it is neither.
    pub fn parse(text: &str) -> Result<Self, VariationError> {
        let (pointer, values) =
            text.split_once('=').ok_or_else(|| VariationError::NoEquals(text.to_owned()))?;
        let pointer = pointer.to_owned();
        if values.trim().is_empty() {
            return Err(VariationError::Empty(pointer));
        }
        let values = if values.contains(':') && !values.contains(['{', '[', '"', ',']) {
            range(values).ok_or(VariationError::Range {
                pointer: pointer.clone(),
                text: values.to_owned(),
            })?
        } else {
            values.split(',').map(|value| value.trim().to_owned()).collect()
        };
        Ok(Self { pointer, values })
    }
}

/// The numbers of `start:stop:count`, ends included and met exactly.
fn range(text: &str) -> Option<Vec<String>> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let [start, stop, count] = parts.as_slice() else { return None };
    let (start, stop): (f64, f64) = (start.parse().ok()?, stop.parse().ok()?);
    let count: usize = count.parse().ok()?;
    if !start.is_finite() || !stop.is_finite() || !(1..=MOST_RUNS).contains(&count) {
        return None;
    }
    let last = (count - 1).max(1) as f64;
    let value = |i: usize| {
        if i + 1 == count && count > 1 {
            return stop;
        }
        // This form gives whole numbers exactly; the other does not overflow.
        let value = start + (stop - start) * i as f64 / last;
        let fraction = i as f64 / last;
        if value.is_finite() { value } else { start * (1.0 - fraction) + stop * fraction }
    };
    Some((0..count).map(|i| value(i).to_string()).collect())
}

/// The number of runs of a sweep over `variations`.
///
/// # Errors
/// [`VariationError::TooMany`] beyond [`MOST_RUNS`].
pub fn number_of_runs(variations: &[Variation]) -> Result<usize, VariationError> {
    let product = variations
        .iter()
        .try_fold(1u128, |runs, variation| runs.checked_mul(variation.values.len() as u128))
        .unwrap_or(u128::MAX);
    match usize::try_from(product) {
        Ok(runs) if runs <= MOST_RUNS => Ok(runs),
        _ => Err(VariationError::TooMany(product)),
    }
}

/// The value of each variation in a run, the last varying fastest.
pub(super) fn chosen_values(run: usize, variations: &[Variation]) -> Vec<&str> {
    let digits = digits(run, variations.iter().map(|variation| variation.values.len()));
    digits.into_iter().zip(variations).map(|(at, one)| one.values[at].as_str()).collect()
}

/// `number` in mixed radices, the last fastest.
pub(super) fn digits(number: usize, radices: impl DoubleEndedIterator<Item = usize>) -> Vec<usize> {
    let mut rest = number;
    let mut digits: Vec<usize> = radices
        .rev()
        .map(|radix| {
            let digit = rest % radix;
            rest /= radix;
            digit
        })
        .collect();
    digits.reverse();
    digits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_the_largest_numbers_do_not_overflow() {
        let numbers = |text: &str| -> Vec<f64> {
            let values = Variation::parse(text).unwrap().values;
            values.iter().map(|value| value.parse().unwrap()).collect()
        };
        assert_eq!(numbers("/a=-1e308:1e308:3"), [-1e308, 0.0, 1e308]);
        let rising = numbers("/a=0:1e308:1000");
        assert!(rising.windows(2).all(|pair| pair[0] < pair[1]) && rising[999] == 1e308);
    }

    #[test]
    fn ranges_meet_their_ends_and_lists_are_taken_as_they_are() {
        let linear = Variation::parse("/excitation/peak_n=9:32:24").unwrap();
        assert_eq!(linear.values.len(), 24);
        assert_eq!((linear.values[0].as_str(), linear.values[23].as_str()), ("9", "32"));
        assert_eq!(Variation::parse("/a=0.1:0.3:3").unwrap().values[2], "0.3");
        assert_eq!(Variation::parse("/a=5:9:1").unwrap().values, ["5"]);
        let laws = Variation::parse("/interfaces/0/law=modified, pl").unwrap();
        assert_eq!(laws.values, ["modified", "pl"]);
    }

    #[test]
    fn invalid_variations_are_errors() {
        for text in ["/a", "/a=", "/a=1:2", "/a=1:2:0", "/a=x:2:3", "/a=1:inf:3", "/a=1:2:3:4"] {
            assert!(Variation::parse(text).is_err(), "{text}");
        }
        let many = Variation::parse("/a=0:1:9999").unwrap();
        let variations = vec![many.clone(), many.clone(), many];
        assert!(number_of_runs(&variations).is_err());
    }
}
