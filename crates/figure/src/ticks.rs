//! Positions of the marks of an axis.

/// Mark positions in display units, increasing.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Ticks {
    /// Labelled marks.
    pub(crate) major: Vec<f64>,
    /// Short marks without label.
    pub(crate) minor: Vec<f64>,
    /// Decimals that tell evenly spaced marks apart (negative: whole tens, hundreds and so on);
    /// none for multiples of powers of ten.
    pub(crate) decimals: Option<i32>,
}

/// Guards the ends of a range against rounding, over its span.
const SLACK: f64 = 1e-9;
/// Marks beyond which an axis is left without them.
const MOST: f64 = 500.0;

/// Target beyond which two marks are not sought.
const MOST_FOR_TWO: usize = 10;

/// Multiples of a power of ten that have short marks.
const MULTIPLES: [f64; 8] = [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];

/// Multiples of 1, 2 or 5 times a power of ten, at most about `target` of them labelled, and at least
/// two.
pub(crate) fn linear(low: f64, high: f64, target: usize) -> Ticks {
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return Ticks::default();
    }
    let least = span / target.max(1) as f64;
    let mut exponent = least.log10().floor() as i32;
    let fraction = least / 10f64.powi(exponent);
    // Slack in the comparison keeps 0.2/10 at 0.02 when the quotient is a hair above 2.
    let (mantissa, parts) = match fraction {
        f if f <= 1.0 + 1e-6 => (1.0, 5),
        f if f <= 2.0 + 1e-6 => (2.0, 4),
        f if f <= 5.0 + 1e-6 => (5.0, 5),
        _ => {
            exponent += 1;
            (1.0, 5)
        }
    };
    let multiples = |divisor: f64| -> Vec<f64> {
        let step = mantissa / divisor * 10f64.powi(exponent);
        let slack = SLACK * span / step;
        let (first, last) = ((low / step - slack).ceil(), (high / step + slack).floor());
        let count = last - first + 1.0;
        let count = if (1.0..MOST).contains(&count) { count as usize } else { 0 };
        // The power of ten divides where it is a fraction, so that 0.3 is the nearest double.
        let tick = |index: usize| {
            let multiple = (first + index as f64) * mantissa;
            if exponent < 0 {
                multiple / (10f64.powi(-exponent) * divisor) + 0.0
            } else {
                multiple / divisor * 10f64.powi(exponent) + 0.0
            }
        };
        (0..count).map(tick).collect()
    };
    let major = multiples(1.0);
    if major.len() < 2 && target < MOST_FOR_TWO {
        return linear(low, high, 2 * target.max(1));
    }
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * span / target.max(1) as f64;
    let minor =
        multiples(f64::from(parts)).into_iter().filter(|&m| !major.iter().any(|&t| near(m, t)));
    Ticks { minor: minor.collect(), major: major.clone(), decimals: Some(-exponent) }
}

/// Powers of ten with marks at their multiples, at most `target` labelled; within less than two
/// decades also 2 and 5 are labelled, and within a factor of about two the marks are linear.
pub(crate) fn logarithmic(low: f64, high: f64, target: usize) -> Ticks {
    if !(low > 0.0 && high > low && high.is_finite()) {
        return Ticks::default();
    }
    let inside = |value: &f64| *value >= low * (1.0 - SLACK) && *value <= high * (1.0 + SLACK);
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let within = |multiples: &[f64]| -> Vec<f64> {
        (first..=last)
            .flat_map(|decade| multiples.iter().map(move |multiple| power(*multiple, decade)))
            .filter(inside)
            .collect()
    };
    let decades = within(&[1.0]);
    if decades.len() >= 3 || (decades.len() == 2 && high / low > 50.0) {
        let stride = i32::try_from(decades.len().div_ceil(target.max(2))).unwrap_or(i32::MAX);
        // Strides count from 10^0, so that the labels do not move with the range.
        let labelled = |value: &f64| (value.log10().round() as i32).rem_euclid(stride) == 0;
        let (major, between): (Vec<f64>, Vec<f64>) = decades.into_iter().partition(labelled);
        let minor = if stride == 1 { within(&MULTIPLES) } else { between };
        return Ticks { major, minor, decimals: None };
    }
    let major = within(&[1.0, 2.0, 5.0]);
    if major.len() >= 2 && major.len() <= target.max(2) + 1 {
        let minor = within(&[3.0, 4.0, 6.0, 7.0, 8.0, 9.0]);
        return Ticks { major, minor, decimals: None };
    }
    if decades.len() >= 2 {
        let minor = within(&MULTIPLES);
        return Ticks { major: decades, minor, decimals: None };
    }
    linear(low, high, target)
}

/// `multiple` times ten to `exponent`, the nearest double where ten to it is exact.
fn power(multiple: f64, exponent: i32) -> f64 {
    if exponent < 0 { multiple / 10f64.powi(-exponent) } else { multiple * 10f64.powi(exponent) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_marks_are_nice_numbers() {
        let ticks = linear(0.0, 1.0, 5);
        assert_eq!(ticks.major, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(ticks.decimals, Some(1));
        assert_eq!(linear(-3.7, 12.2, 4).major, [0.0, 5.0, 10.0]);
        assert_eq!(linear(0.0, 5e9, 5).major, [0.0, 1e9, 2e9, 3e9, 4e9, 5e9]);
        assert_eq!(linear(0.0, 0.03, 3).major, [0.0, 0.01, 0.02, 0.03]);
        assert_eq!(linear(-950.0, 990.0, 2).major, [-500.0, 0.0, 500.0]);
    }

    #[test]
    fn minor_marks_divide_the_steps_and_skip_the_labelled() {
        let ticks = linear(0.0, 2.0, 2);
        assert_eq!(ticks.major, [0.0, 1.0, 2.0]);
        assert_eq!(ticks.minor, [0.2, 0.4, 0.6, 0.8, 1.2, 1.4, 1.6, 1.8]);
        let halves = linear(0.0, 40.0, 2);
        assert_eq!(halves.major, [0.0, 20.0, 40.0]);
        assert_eq!(halves.minor, [5.0, 10.0, 15.0, 25.0, 30.0, 35.0]);
    }

    #[test]
    fn decades_are_labelled_and_their_multiples_marked() {
        let ticks = logarithmic(1e-9, 1e-6, 6);
        assert_eq!(ticks.major, [1e-9, 1e-8, 1e-7, 1e-6]);
        assert_eq!(ticks.minor.len(), 3 * 8);
        assert_eq!(ticks.minor[0], 2e-9);
    }

    #[test]
    fn many_decades_are_labelled_in_strides() {
        let ticks = logarithmic(1e-20, 1.0, 6);
        assert!(ticks.major.len() <= 6);
        assert!(ticks.major.contains(&1.0));
    }

    #[test]
    fn short_logarithmic_ranges_still_have_labels() {
        assert_eq!(logarithmic(10.0, 60.0, 6).major, [10.0, 20.0, 50.0]);
        assert!(logarithmic(100.0, 130.0, 5).major.len() >= 2);
        assert!(logarithmic(3.0, 4.0, 5).major.len() >= 2);
    }

    #[test]
    fn degenerate_ranges_have_no_marks() {
        assert_eq!(linear(1.0, 1.0, 5), Ticks::default());
        assert_eq!(linear(f64::NAN, 1.0, 5), Ticks::default());
        assert_eq!(logarithmic(0.0, 1.0, 5), Ticks::default());
        // A span at the last bit of the values cannot be divided.
        assert!(linear(1e16, 1e16 + 2.0, 5).major.len() < 10);
    }
}
