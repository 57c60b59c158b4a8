//! Statistics of a column that is read several times instead of held.

use super::interval::{check_threshold, of_probability, quantile_shares};
use super::order_statistics::{ValueColumn, order_statistics};
use super::{IntervalEstimate, check_probability};
use crate::error::DesignError;

/// Bins of a histogram.
const HISTOGRAM_BINS: usize = 40;

/// The histogram reaches from the quantile at this probability to that at 1 minus it.
const TAIL: f64 = 0.005;

/// Places of an exceedance curve.
const CURVE_BINS: usize = 200;

/// Statistics that are asked of a column.
#[derive(Debug, Clone, PartialEq)]
pub struct SummaryRequest {
    /// Confidence level of intervals.
    pub level: f64,
    /// Probabilities of the quantiles.
    pub probabilities: Vec<f64>,
    /// Thresholds that values may exceed.
    pub thresholds: Vec<f64>,
}

/// Statistics of the finite values of a column, all of equal weight.
///
/// They are those of [`WeightedSample`](crate::WeightedSample) of equal weights, but for rounding. The
/// column is read at most eight times; of 2^20 values or less, three times. Memory does not grow with
/// their number. Quantiles are exact.
///
/// ```
/// use asperity_sampling::{ColumnSummary, DesignError, SummaryRequest, ValueColumn};
///
/// struct Squares;
///
/// impl ValueColumn for Squares {
///     type Error = DesignError;
///     fn scan(&self, visit: &mut dyn FnMut(&[f64])) -> Result<(), DesignError> {
///         (0..1001_u32).for_each(|k| visit(&[f64::from(k).powi(2)]));
///         Ok(())
///     }
/// }
///
/// let asked = SummaryRequest { level: 0.95, probabilities: vec![0.5], thresholds: vec![810_000.0] };
/// let summary = ColumnSummary::of(&Squares, &asked)?.unwrap();
/// assert_eq!((summary.count, summary.quantiles[0].value), (1001, 250_000.0));
/// assert_eq!(summary.exceedances[0].value, 100.0 / 1001.0);
/// # Ok::<(), DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnSummary {
    /// Number of finite values.
    pub count: u64,
    /// Number of others.
    pub left_out: u64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of the distribution; zero for a single value.
    pub standard_deviation: f64,
    /// Least and greatest value.
    pub range: [f64; 2],
    /// Quantiles at the probabilities asked for.
    pub quantiles: Vec<IntervalEstimate>,
    /// Probabilities of values above the thresholds asked for.
    pub exceedances: Vec<IntervalEstimate>,
    /// Numbers of values in 40 bins between the quantiles at 0.005 and 0.995; none if they are equal.
    pub histogram: Option<Histogram>,
    /// 200 places at equal distances from the least value on, each with the probability of values at
    /// or above it; empty for values that are all the same.
    pub exceedance_curve: Vec<(f64, IntervalEstimate)>,
}

/// Numbers of values in bins of equal width.
///
/// Bin `i` of `n` holds the values `x` with `e_i <= x < e_(i+1)`, the last one those at its upper edge,
/// too; `e_i = low + (high - low) i / n`.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Lower edge of the first bin.
    pub low: f64,
    /// Upper edge of the last bin.
    pub high: f64,
    /// Number of values in each bin.
    pub counts: Vec<u64>,
    /// Number of values below the first bin.
    pub below: u64,
    /// Number of values above the last bin.
    pub above: u64,
}

impl Histogram {
    fn new(low: f64, high: f64, bins: usize) -> Option<Self> {
        let is_wide = low < high && ((high - low) / bins as f64).is_finite();
        is_wide.then(|| Self { low, high, counts: vec![0; bins], below: 0, above: 0 })
    }

    fn add(&mut self, value: f64) {
        let bins = self.counts.len();
        if value < self.low {
            self.below += 1;
        } else if value > self.high {
            self.above += 1;
        } else {
            let place = (value - self.low) / (self.high - self.low) * bins as f64;
            self.counts[(place as usize).min(bins - 1)] += 1;
        }
    }

    /// The edges of the bins, one more than there are bins.
    pub fn edges(&self) -> Vec<f64> {
        let bins = self.counts.len();
        let edge = |at: usize| self.low + (self.high - self.low) * at as f64 / bins as f64;
        (0..=bins).map(edge).collect()
    }
}

/// Count, mean and spread, in one pass.
struct Moments {
    count: u64,
    left_out: u64,
    mean: f64,
    squares: f64,
    range: [f64; 2],
    above: Vec<u64>,
}

impl Moments {
    fn of<C: ValueColumn>(column: &C, thresholds: &[f64]) -> Result<Self, C::Error> {
        let mut found = Self {
            count: 0,
            left_out: 0,
            mean: 0.0,
            squares: 0.0,
            range: [f64::INFINITY, f64::NEG_INFINITY],
            above: vec![0; thresholds.len()],
        };
        column.scan(&mut |values| {
            for &value in values {
                if !value.is_finite() {
                    found.left_out += 1;
                    continue;
                }
                found.count += 1;
                // Welford's recurrence.
                let difference = value - found.mean;
                found.mean += difference / found.count as f64;
                found.squares += difference * (value - found.mean);
                found.range = [found.range[0].min(value), found.range[1].max(value)];
                for (above, threshold) in found.above.iter_mut().zip(thresholds) {
                    *above += u64::from(value > *threshold);
                }
            }
        })?;
        Ok(found)
    }
}

impl ColumnSummary {
    /// The statistics of a column; none without a finite value.
    ///
    /// # Errors
    /// [`DesignError::Value`] for a probability or a level that is not between 0 and 1 or a threshold
    /// that is not a number, and those of reading.
    pub fn of<C: ValueColumn>(column: &C, asked: &SummaryRequest) -> Result<Option<Self>, C::Error>
    where
        C::Error: From<DesignError>,
    {
        check_probability("the level of an interval", asked.level)?;
        asked.thresholds.iter().try_for_each(|&threshold| check_threshold(threshold))?;
        let moments = Moments::of(column, &asked.thresholds)?;
        let n = moments.count as f64;
        let mut shares = vec![[TAIL; 3], [1.0 - TAIL; 3]];
        for &probability in &asked.probabilities {
            let [low, high] = quantile_shares(probability, asked.level, n)?;
            shares.push([low, probability, high]);
        }
        if moments.count == 0 {
            return Ok(None);
        }
        let wanted: Vec<Rank> = shares.iter().flatten().map(|&share| Rank::of(share, n)).collect();
        let ranks: Vec<u64> = wanted.iter().flat_map(Rank::neighbours).collect();
        let found = order_statistics(column, moments.count, &ranks)?;
        let value = |rank: &Rank| {
            let [below, above] = rank.neighbours().map(|rank| found[&rank]);
            below * (1.0 - rank.fraction) + above * rank.fraction
        };
        let quantile = |ranks: &[Rank]| IntervalEstimate {
            value: value(&ranks[1]),
            low: if ranks[0].is_below { f64::NEG_INFINITY } else { value(&ranks[0]) },
            high: if ranks[2].is_above { f64::INFINITY } else { value(&ranks[2]) },
        };
        let mut quantiles: Vec<IntervalEstimate> = wanted.chunks_exact(3).map(quantile).collect();
        let asked_for = quantiles.split_off(2);
        let mut histogram = Histogram::new(quantiles[0].value, quantiles[1].value, HISTOGRAM_BINS);
        let mut steps = Histogram::new(moments.range[0], moments.range[1], CURVE_BINS);
        if histogram.is_some() || steps.is_some() {
            column.scan(&mut |values| {
                for &value in values.iter().filter(|value| value.is_finite()) {
                    histogram.iter_mut().chain(&mut steps).for_each(|bins| bins.add(value));
                }
            })?;
        }
        let share = |count: u64| of_probability(count as f64 / n, asked.level, n);
        let exceedances = moments.above.iter().map(|&above| share(above));
        Ok(Some(Self {
            count: moments.count,
            left_out: moments.left_out,
            mean: moments.mean,
            standard_deviation: (moments.squares / (n - 1.0).max(1.0)).sqrt(),
            range: moments.range,
            quantiles: asked_for,
            exceedances: exceedances.collect::<Result<_, _>>()?,
            histogram,
            exceedance_curve: steps.map_or(Ok(Vec::new()), |steps| curve(&steps, share))?,
        }))
    }
}

/// The lower edges of bins with the probabilities of values at or above them.
fn curve(
    steps: &Histogram,
    share: impl Fn(u64) -> Result<IntervalEstimate, DesignError>,
) -> Result<Vec<(f64, IntervalEstimate)>, DesignError> {
    let mut above: u64 = steps.counts.iter().sum();
    let mut curve = Vec::new();
    for (edge, count) in steps.edges().into_iter().zip(&steps.counts) {
        curve.push((edge, share(above)?));
        above -= count;
    }
    Ok(curve)
}

/// A share of the values: two neighbouring ranks, and the part of the way between them.
struct Rank {
    first: u64,
    fraction: f64,
    last: u64,
    is_below: bool,
    is_above: bool,
}

impl Rank {
    /// Values stand at the middles of their weights.
    fn of(share: f64, n: f64) -> Self {
        let place = share * n - 0.5;
        let last = n as u64 - 1;
        let inside = place.clamp(0.0, last as f64);
        Self {
            first: inside as u64,
            fraction: inside.fract(),
            last,
            is_below: place < 0.0,
            is_above: place > last as f64,
        }
    }

    fn neighbours(&self) -> [u64; 2] {
        [self.first, (self.first + 1).min(self.last)]
    }
}
