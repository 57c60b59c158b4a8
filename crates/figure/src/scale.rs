//! Data to page: the range of an axis and the position of a value on it.

use crate::{Axis, FigureError};

/// Free space at an end that follows the data, over the span of the data.
const PADDING: f64 = 0.05;

/// Maps data to a coordinate on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AxisScale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) log: bool,
    factor: f64,
    start: f64,
    end: f64,
}

impl AxisScale {
    /// The scale that shows `range` (display units) from page coordinate `start` to `end`.
    pub(crate) fn new(axis: &Axis, range: (f64, f64), start: f64, end: f64) -> Self {
        Self { low: range.0, high: range.1, log: axis.log, factor: axis.factor, start, end }
    }

    /// Position of a datum, NaN where it cannot be shown.
    pub(crate) fn datum(&self, datum: f64) -> f64 {
        self.shown(datum * self.factor)
    }

    /// Position of a value in display units, NaN where it cannot be shown.
    pub(crate) fn shown(&self, value: f64) -> f64 {
        let position = if self.log {
            (value / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        let page = self.start + position * (self.end - self.start);
        if page.is_finite() { page } else { f64::NAN }
    }
}

/// Both ends of an axis in display units: those it fixes, else those of `data`, with free space
/// where `padded`. Always finite and increasing, and positive on a logarithmic axis.
pub(crate) fn range(axis: &Axis, data: impl Iterator<Item = f64>, padded: bool) -> (f64, f64) {
    let place = |value: f64| if axis.log { value.log10() } else { value };
    let back = |value: f64| if axis.log { 10f64.powf(value) } else { value };
    let usable = |end: &f64| axis.can_show(*end);
    let (fixed_low, fixed_high) = (axis.low.filter(usable), axis.high.filter(usable));

    let mut bounds: Option<(f64, f64)> = None;
    for value in data.map(|datum| axis.shown(datum)).filter(|value| !value.is_nan()) {
        let (low, high) = bounds.unwrap_or((value, value));
        bounds = Some((low.min(value), high.max(value)));
    }
    let (data_low, data_high) = bounds.unwrap_or(if axis.log { (1.0, 10.0) } else { (0.0, 1.0) });
    let (mut low, mut high) = (place(data_low), place(data_high));
    let level = high - low <= 1e-12 * low.abs().max(high.abs());
    let padding = if level {
        if axis.log { 0.5 } else { (0.1 * low.abs()).max(f64::MIN_POSITIVE.sqrt()) }
    } else if padded {
        PADDING * (high - low)
    } else {
        0.0
    };
    (low, high) = (low - padding, high + padding);
    if level && data_low == 0.0 && !axis.log {
        (low, high) = (-1.0, 1.0);
    } else if !axis.log && data_low >= 0.0 {
        low = low.max(0.0);
    } else if !axis.log && data_high <= 0.0 {
        high = high.min(0.0);
    }

    let low = fixed_low.unwrap_or(back(low));
    let high = fixed_high.unwrap_or(back(high));
    if low < high && usable(&low) && usable(&high) {
        (low, high)
    } else if fixed_low.is_some() && fixed_high.is_none() && usable(&low) {
        (low, if axis.log { low * 10.0 } else { low + low.abs().max(1.0) })
    } else if fixed_high.is_some() && fixed_low.is_none() && usable(&high) {
        (if axis.log { high / 10.0 } else { high - high.abs().max(1.0) }, high)
    } else if axis.log {
        (1.0, 10.0)
    } else {
        (0.0, 1.0)
    }
}

/// Checks the ends and the factor that an axis fixes.
pub(crate) fn check(axis: &Axis) -> Result<(), FigureError> {
    let (low, high) = (axis.low, axis.high);
    let end = |value: f64| axis.can_show(value);
    let increasing = low.zip(high).is_none_or(|(low, high)| low < high);
    let factor = axis.factor.is_finite() && axis.factor != 0.0;
    if increasing && factor && low.is_none_or(end) && high.is_none_or(end) {
        return Ok(());
    }
    Err(FigureError::AxisRange {
        axis: axis.label.clone(),
        low: low.unwrap_or(f64::NAN),
        high: high.unwrap_or(f64::NAN),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_factor_acts_before_the_range() {
        let axis = Axis::linear("Pressure", "MPa").scale(1e-6).range(0.0, 5.0);
        let scale = AxisScale::new(&axis, range(&axis, [].into_iter(), true), 100.0, 200.0);
        assert!((scale.datum(2.5e6) - 150.0).abs() < 1e-9);
        assert!((scale.shown(2.5) - 150.0).abs() < 1e-9);
    }

    #[test]
    fn decades_are_equally_long() {
        let axis = Axis::log("Receptance", "m/N").range(1e-9, 1e-5);
        let scale = AxisScale::new(&axis, (1e-9, 1e-5), 0.0, 4.0);
        for (decade, value) in [1e-9, 1e-8, 1e-7, 1e-6, 1e-5].into_iter().enumerate() {
            assert!((scale.datum(value) - decade as f64).abs() < 1e-12);
        }
        assert!(scale.datum(0.0).is_nan());
        assert!(scale.datum(-1.0).is_nan());
    }

    #[test]
    fn a_range_is_usable_whatever_the_data() {
        let data = [
            vec![],
            vec![f64::NAN],
            vec![0.0],
            vec![3.0, 3.0],
            vec![-1.0, f64::INFINITY],
            vec![5e-324],
            vec![f64::MAX],
        ];
        for axis in [Axis::linear("a", ""), Axis::log("a", ""), Axis::log("a", "").low(1e9)] {
            for values in &data {
                let (low, high) = range(&axis, values.iter().copied(), true);
                assert!(low < high && low.is_finite() && high.is_finite(), "{values:?}");
                assert!(!axis.log || low > 0.0);
            }
        }
    }

    #[test]
    fn free_space_does_not_cross_zero() {
        let axis = Axis::linear("a", "");
        assert_eq!(range(&axis, [0.0, 1.0].into_iter(), true), (0.0, 1.05));
        assert_eq!(range(&axis, [0.0, 1.0].into_iter(), false), (0.0, 1.0));
    }

    #[test]
    fn unusable_ranges_are_refused() {
        assert!(check(&Axis::linear("a", "").range(1.0, 1.0)).is_err());
        assert!(check(&Axis::log("a", "").low(0.0)).is_err());
        assert!(check(&Axis::linear("a", "").scale(0.0)).is_err());
        assert!(check(&Axis::linear("a", "").high(f64::NAN)).is_err());
        assert!(check(&Axis::log("a", "").range(1e-9, 1.0)).is_ok());
    }
}
