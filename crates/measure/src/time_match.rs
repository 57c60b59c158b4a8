//! Time vectors of a file with several, and the channels that each belongs to.

use crate::MeasureError;

/// A column or array, in the order of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vector<'a> {
    pub(crate) name: &'a str,
    /// Number of its values.
    pub(crate) length: usize,
    /// Its values, if it is a time vector.
    pub(crate) times: Option<&'a [f64]>,
}

/// Time vectors of the channels of a file.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum TimeVectors {
    /// Index of the time vector of each vector, which is its own index for a time vector.
    OfEach(Vec<usize>),
    /// The first time vector is that of all channels; these others hold the same instants, or those of
    /// another clock.
    First(Vec<usize>),
}

/// The time vectors of the channels, where there are two or more of them.
///
/// A time belongs to the channels that names say, such as `time_acc` for `acc`; else to those that
/// places say, each time before its channels or each after them; else to those of its length.
///
/// # Errors
/// [`MeasureError::AmbiguousTimes`] where nothing says it and the times differ.
pub(crate) fn time_vectors(
    file: &str,
    vectors: &[Vector<'_>],
) -> Result<TimeVectors, MeasureError> {
    let fits = |found: &Vec<usize>| {
        let same_length = |(at, time): (usize, &usize)| vectors[at].length == vectors[*time].length;
        found.iter().enumerate().all(same_length)
    };
    let found = by_names(vectors).filter(fits).or_else(|| by_places(vectors).filter(fits));
    if let Some(found) = found.or_else(|| by_lengths(vectors)) {
        return Ok(TimeVectors::OfEach(found));
    }
    let places = || (0..vectors.len()).filter(|at| vectors[*at].times.is_some());
    let first = places().next().and_then(|at| vectors[at].times).unwrap_or_default();
    let others: Vec<usize> = places().skip(1).collect();
    let span = |times: &[f64]| Some((*times.first()?, *times.last()?));
    let is_of_all = |at: &usize| {
        let own = vectors[*at].times.unwrap_or_default();
        match (span(first), span(own)) {
            (Some((begin, end)), Some((own_begin, own_end))) => {
                own_begin > end || own_end < begin || own == first
            }
            _ => false,
        }
    };
    let channels = vectors.len() - others.len() - 1;
    if channels != others.len() + 1 || others.iter().all(is_of_all) {
        return Ok(TimeVectors::First(others));
    }
    let time = |at: usize| match span(vectors[at].times.unwrap_or_default()) {
        Some((begin, end)) => {
            let rate = (vectors[at].length - 1) as f64 / (end - begin);
            format!("`{}` ({rate:.6} Hz from {begin} s)", vectors[at].name)
        }
        None => format!("`{}`", vectors[at].name),
    };
    let channels = vectors.iter().filter(|vector| vector.times.is_none());
    let channels: Vec<String> = channels.map(|vector| format!("`{}`", vector.name)).collect();
    Err(MeasureError::AmbiguousTimes {
        file: file.to_owned(),
        times: places().map(time).collect::<Vec<_>>().join(" and "),
        channels: channels.join(", "),
    })
}

/// The only time vector with the length of each channel.
fn by_lengths(vectors: &[Vector<'_>]) -> Option<Vec<usize>> {
    let time_of = |(at, vector): (usize, &Vector<'_>)| {
        if vector.times.is_some() {
            return Some(at);
        }
        let fits = |place: &usize| {
            vectors[*place].times.is_some() && vectors[*place].length == vector.length
        };
        let mut fitting = (0..vectors.len()).filter(fits);
        let first = fitting.next()?;
        fitting.next().is_none().then_some(first)
    };
    vectors.iter().enumerate().map(time_of).collect()
}

fn by_names(vectors: &[Vector<'_>]) -> Option<Vec<usize>> {
    // Words and numbers: `t1` is `t` and `1`.
    let words = |name: &str| -> Vec<String> {
        let lower = name.to_lowercase();
        let parts = lower.split(|c: char| !c.is_alphanumeric());
        let parts = parts.flat_map(|part| {
            let word = part.trim_end_matches(|c: char| c.is_numeric());
            let number = &part[word.len()..];
            [word, number]
        });
        parts.filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let is_of_time =
        |word: &String| ["time", "t", "zeit", "x", "of", "axis"].contains(&word.as_str());
    let of_time: Vec<(usize, Vec<String>)> = vectors
        .iter()
        .enumerate()
        .filter(|(_, vector)| vector.times.is_some())
        .map(|(at, vector)| {
            let mut kept = words(vector.name);
            kept.retain(|word| !is_of_time(word));
            (at, kept)
        })
        .collect();
    let time_of = |(at, vector): (usize, &Vector<'_>)| {
        if vector.times.is_some() {
            return Some(at);
        }
        let own = words(vector.name);
        let named = |(_, kept): &&(usize, Vec<String>)| {
            !kept.is_empty() && kept.iter().all(|word| own.contains(word))
        };
        let mut fitting = of_time.iter().filter(named);
        let first = fitting.next()?;
        fitting.next().is_none().then_some(first.0)
    };
    vectors.iter().enumerate().map(time_of).collect()
}

fn by_places(vectors: &[Vector<'_>]) -> Option<Vec<usize>> {
    let (first, last) = (vectors.first()?, vectors.last()?);
    let touching =
        vectors.windows(2).any(|pair| pair[0].times.is_some() && pair[1].times.is_some());
    if touching || first.times.is_some() == last.times.is_some() {
        return None;
    }
    let nearest = |at: usize| {
        let before = || (0..=at).rev().find(|place| vectors[*place].times.is_some());
        let after = || (at..vectors.len()).find(|place| vectors[*place].times.is_some());
        if first.times.is_some() { before() } else { after() }
    };
    (0..vectors.len()).map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matched(names: &[&str]) -> Result<TimeVectors, MeasureError> {
        let is_time =
            |name: &str| crate::ChannelQuantity::of_name(name) == crate::ChannelQuantity::Time;
        let starts: Vec<[f64; 3]> =
            (0..names.len()).map(|n| [0.0, 1.0, 2.0].map(|t| t + n as f64)).collect();
        let vectors: Vec<Vector<'_>> = names
            .iter()
            .zip(&starts)
            .map(|(name, times)| Vector {
                name,
                length: 3,
                times: is_time(name).then_some(&times[..]),
            })
            .collect();
        time_vectors("f", &vectors)
    }

    #[test]
    fn times_belong_by_name_or_by_place() {
        let of_each = |names: &[&str], expected: [usize; 4]| {
            assert_eq!(
                matched(names).unwrap(),
                TimeVectors::OfEach(expected.to_vec()),
                "{names:?}"
            );
        };
        of_each(&["hammer", "time_hammer", "acc", "time_acc"], [1, 1, 3, 3]);
        of_each(&["time acc", "time hammer", "hammer", "acc"], [0, 1, 1, 0]);
        of_each(&["F", "t1", "a", "t2"], [1, 1, 3, 3]);
        of_each(&["t1", "F", "t2", "a"], [0, 0, 2, 2]);
        of_each(&["t1", "t2", "F_1", "a_2"], [0, 1, 0, 1]);
        let error = matched(&["t1", "t2", "F", "a"]).unwrap_err().to_string();
        assert!(error.contains("from 0 s") && error.contains("from 1 s"), "{error}");
        assert_eq!(
            matched(&["time", "time utc", "F", "a", "b"]).unwrap(),
            TimeVectors::First(vec![1])
        );
    }
}
