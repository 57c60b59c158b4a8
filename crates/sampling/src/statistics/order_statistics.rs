//! Order statistics of values that are read several times instead of held.
//!
//! Values are counted by the leading bits of their key, an integer in the order of the numbers, 16 bits
//! more in each pass, until those that share their leading bits with one that is wanted are few enough
//! to be sorted.

use std::collections::BTreeMap;

/// Values that can be read again and again, each time the same, such as a column on the disk.
pub trait ValueColumn {
    /// Errors of reading.
    type Error;

    /// Visits all values in their order, part by part.
    ///
    /// # Errors
    /// Those of reading.
    fn scan(&self, visit: &mut dyn FnMut(&[f64])) -> Result<(), Self::Error>;
}

/// Bits of the key that a pass counts by.
const DIGIT: u32 = 16;

/// Most values that are sorted at once, 8 MB.
const MOST_SORTED: u64 = 1 << 20;

/// Most ranks that are found together, with 512 kB of counts for each.
const MOST_RANKS: usize = 64;

/// Values whose keys begin with the same bits.
struct Part {
    /// Number of values below all of them.
    below: u64,
    /// Their number.
    count: u64,
}

/// The finite values of `column` at these `ranks`, from 0, among its `count` finite values.
///
/// Every rank must be less than `count`.
pub(super) fn order_statistics<C: ValueColumn>(
    column: &C,
    count: u64,
    ranks: &[u64],
) -> Result<BTreeMap<u64, f64>, C::Error> {
    let mut ranks = ranks.to_vec();
    ranks.sort_unstable();
    ranks.dedup();
    let mut found = BTreeMap::new();
    for ranks in ranks.chunks(MOST_RANKS) {
        found.extend(order_statistics_within(column, count, ranks, MOST_SORTED)?);
    }
    Ok(found)
}

/// The values at ascending ranks.
fn order_statistics_within<C: ValueColumn>(
    column: &C,
    count: u64,
    ranks: &[u64],
    most_sorted: u64,
) -> Result<BTreeMap<u64, f64>, C::Error> {
    // Parts that hold a wanted rank, by their leading bits.
    let mut parts = BTreeMap::from([(0_u64, Part { below: 0, count })]);
    let mut bits = 0;
    while bits < u64::BITS && parts.values().map(|part| part.count).sum::<u64>() > most_sorted {
        parts = refined(column, &parts, bits, ranks)?;
        bits += DIGIT;
    }
    let mut found = BTreeMap::new();
    if bits == u64::BITS {
        for (&key, part) in &parts {
            found.extend(part.held(ranks).iter().map(|&rank| (rank, value_of(key))));
        }
        return Ok(found);
    }
    let mut keys = Vec::new();
    column.scan(&mut |values| {
        let kept = values.iter().filter(|value| value.is_finite()).map(|&value| key_of(value));
        keys.extend(kept.filter(|&key| parts.contains_key(&leading(key, bits))));
    })?;
    keys.sort_unstable();
    let mut first = 0;
    for part in parts.values() {
        for &rank in part.held(ranks) {
            found.insert(rank, value_of(keys[(first + rank - part.below) as usize]));
        }
        first += part.count;
    }
    Ok(found)
}

impl Part {
    /// Those of the ascending `ranks` that are in this part.
    fn held<'a>(&self, ranks: &'a [u64]) -> &'a [u64] {
        let before = |end: u64| ranks.partition_point(|&rank| rank < end);
        &ranks[before(self.below)..before(self.below + self.count)]
    }
}

/// The parts of one digit more that hold a wanted rank.
fn refined<C: ValueColumn>(
    column: &C,
    parts: &BTreeMap<u64, Part>,
    bits: u32,
    ranks: &[u64],
) -> Result<BTreeMap<u64, Part>, C::Error> {
    let prefixes: Vec<u64> = parts.keys().copied().collect();
    let mut counts = vec![0_u64; prefixes.len() << DIGIT];
    column.scan(&mut |values| {
        for &value in values.iter().filter(|value| value.is_finite()) {
            let key = key_of(value);
            if let Ok(place) = prefixes.binary_search(&leading(key, bits)) {
                let digit = leading(key << bits, DIGIT);
                counts[place << DIGIT | digit as usize] += 1;
            }
        }
    })?;
    let mut finer = BTreeMap::new();
    for ((prefix, part), counts) in parts.iter().zip(counts.chunks_exact(1 << DIGIT)) {
        let mut below = part.below;
        for (digit, &count) in (0..).zip(counts) {
            let part = Part { below, count };
            if count > 0 && !part.held(ranks).is_empty() {
                finer.insert(prefix << DIGIT | digit, part);
            }
            below += count;
        }
    }
    Ok(finer)
}

/// The first bits of a key.
fn leading(key: u64, bits: u32) -> u64 {
    key.checked_shr(u64::BITS - bits).unwrap_or(0)
}

/// An integer in the order of the numbers.
fn key_of(value: f64) -> u64 {
    // Both zeros are one number.
    let bits = (value + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

fn value_of(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 0 { !key } else { key & !(1 << 63) })
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::convert::Infallible;

    use super::*;
    use crate::hash::{hash, open_unit};

    struct Held(Vec<f64>, Cell<usize>);

    impl ValueColumn for Held {
        type Error = Infallible;

        fn scan(&self, visit: &mut dyn FnMut(&[f64])) -> Result<(), Infallible> {
            self.1.set(self.1.get() + 1);
            self.0.chunks(100).for_each(visit);
            Ok(())
        }
    }

    #[test]
    fn every_rank_is_that_of_sorted_values_in_few_passes() {
        let number = |k| open_unit(hash(7, &[k]));
        let spread = |k| (number(k) - 0.3) * 10_f64.powf(40.0 * number(k + 10_000) - 20.0);
        let columns: [Vec<f64>; 5] = [
            (0..4000).map(spread).collect(),
            (0..4000).map(|k| 1.0 + 1e-13 * number(k)).collect(),
            (0..4000).map(|k| (number(k) * 5.0).floor() - 2.0).collect(),
            (0..4000).map(|k| if k % 7 == 0 { f64::NAN } else { number(k) }).collect(),
            vec![-0.0, 0.0, f64::MIN, f64::MAX, f64::MIN_POSITIVE, -5e-324, f64::INFINITY, 0.0],
        ];
        for values in columns {
            let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
            sorted.sort_by(f64::total_cmp);
            let last = sorted.len() - 1;
            let some = |every: usize| (0..=last).step_by(every).map(|rank| rank as u64).collect();
            let ranks: [Vec<u64>; 2] = [some(last / 30 + 1), vec![last as u64 / 3, last as u64]];
            for (ranks, most) in ranks.into_iter().zip([50, 2]) {
                let column = Held(values.clone(), Cell::new(0));
                let count = sorted.len() as u64;
                let Ok(found) = order_statistics_within(&column, count, &ranks, most);
                assert!(column.1.get() <= 5, "{} passes", column.1.get());
                assert_eq!(found.len(), ranks.len());
                for (rank, value) in found {
                    assert_eq!(value, sorted[rank as usize], "rank {rank}");
                }
            }
        }
    }
}
