//! Sample rates from printed steps.
//!
//! A step printed with six digits has a relative error of up to 5e-6: at 51.2 kHz
//! half a sample in 200 000. Since converters run at whole rates, the
//! whole rate within the rounding of the printed step is used.

use crate::MeasureError;
use crate::notice::{Notice, Notices};

/// The rate of an exact `step`, whole if it is so to the last bits.
pub(crate) fn of_step(step: f64) -> f64 {
    let rate = 1.0 / step;
    let whole = rate.round();
    if whole >= 1.0 && (rate - whole).abs() <= 4.0 * f64::EPSILON * whole { whole } else { rate }
}

/// The rate of the options for a file without one, with a notice.
pub(crate) fn of_options(
    file: &str,
    rate_hz: Option<f64>,
    notices: &mut Notices,
) -> Result<f64, MeasureError> {
    let rate_hz = rate_hz.ok_or_else(|| MeasureError::NoSampleRate { file: file.to_owned() })?;
    notices.add(Notice::RateOfOptions { rate_hz });
    Ok(rate_hz)
}

/// The step of the roundest whole rate within the `uncertainty` of `step`, with a notice if the rate
/// differs; else `step`.
pub(crate) fn snapped_step(step: f64, uncertainty: f64, notices: &mut Notices) -> f64 {
    let Some(rate) = whole_rate(step, uncertainty) else { return step };
    let written_hz = 1.0 / step;
    if (written_hz - rate).abs() > 1e-9 * rate {
        notices.add(Notice::RateSnapped { written_hz, taken_hz: rate });
    }
    1.0 / rate
}

/// The roundest whole rate within the uncertainty; none if there is none, or
/// if the uncertainty exceeds the spacing of whole rates.
fn whole_rate(step: f64, uncertainty: f64) -> Option<f64> {
    let uncertainty = uncertainty.max(4.0 * f64::EPSILON * step);
    if !(step > 0.0 && step.is_finite() && uncertainty < 1e-4 * step) {
        return None;
    }
    let (low, high) = (1.0 / (step + uncertainty), 1.0 / (step - uncertainty));
    // Beyond 2^53 every double is whole.
    if !(0.5..9e15).contains(&high) {
        return None;
    }
    let mut unit = 10f64.powi(15);
    while unit >= 1.0 {
        let candidate = (1.0 / step / unit).round() * unit;
        if candidate >= 1.0 && (low..=high).contains(&candidate) {
            return Some(candidate);
        }
        unit /= 10.0;
    }
    None
}

/// Half a unit of the last digit of a printed number, and its significant digits.
pub(crate) fn rounding_of(text: &str) -> (f64, u32) {
    let text = text.trim().trim_start_matches(['+', '-']);
    let marks = ['e', 'E', 'd', 'D'];
    let (mantissa, exponent) = text.split_once(marks).unwrap_or((text, "0"));
    let exponent: i32 = exponent.trim_start_matches('+').parse().unwrap_or(0);
    let decimals = mantissa.split_once(['.', ',']).map_or(0, |(_, after)| after.len());
    let significant = significant_digits(mantissa);
    let decimals = i32::try_from(decimals).unwrap_or(i32::MAX).min(400);
    let power = exponent.saturating_sub(decimals).clamp(-400, 400);
    (0.5 * 10f64.powi(power), significant)
}

/// Digits from the first to the last that is not zero.
fn significant_digits(mantissa: &str) -> u32 {
    let digits = mantissa.bytes().filter(u8::is_ascii_digit).skip_while(|digit| *digit == b'0');
    let (_, significant) = digits.fold((0, 0), |(count, significant), digit| {
        (count + 1, if digit == b'0' { significant } else { count + 1 })
    });
    significant
}

/// Uncertainty of a printed step. One of three digits or fewer is taken as exact, such as 3
/// microseconds.
pub(crate) fn uncertainty_of_printed_step(text: &str) -> f64 {
    let (half_unit, significant) = rounding_of(text);
    if significant <= 3 { 0.0 } else { half_unit }
}

/// True if all `values` are `start + index * step` to within `tolerance(value, expected)`.
pub(crate) fn is_even(
    values: &[f64],
    (start, step): (f64, f64),
    tolerance: impl Fn(f64, f64) -> f64,
) -> bool {
    values.iter().enumerate().all(|(index, &value)| {
        let expected = start + index as f64 * step;
        (value - expected).abs() <= tolerance(value, expected)
    })
}

/// Start and step of evenly spaced `values`, each known to within `tolerance(value)`, with the step
/// of a whole rate; none for others.
pub(crate) fn even_axis(
    values: &[f64],
    tolerance: impl Fn(f64) -> f64,
    notices: &mut Notices,
) -> Option<(f64, f64)> {
    let (first, last) = (*values.first()?, *values.last()?);
    let steps = values.len() - 1;
    let mut step = (last - first) / steps as f64;
    if steps == 0 || !step.is_finite() || step <= 0.0 {
        return None;
    }
    // Times summed up step by step have an error of some bits of the last of them.
    let summed = 1e-12 * first.abs().max(last.abs());
    let fits = |start: f64, step: f64| {
        // The rounding of this value and that of the ends between which it lies.
        let rounding = |value, _| 2.0 * tolerance(value).max(tolerance(last)) + summed;
        is_even(values, (start, step), rounding)
    };
    // The step must exceed the rounding.
    if step <= 10.0 * tolerance(last) || !fits(first, step) {
        return None;
    }
    let uncertainty = (tolerance(first) + tolerance(last) + summed) / steps as f64;
    let mut found = Notices::default();
    let snapped = snapped_step(step, uncertainty, &mut found);
    if snapped != step && fits(first, snapped) {
        step = snapped;
        // A rate that changes the axis by less than a sample needs no notice.
        found.into_all().into_iter().for_each(|notice| notices.add(notice));
    }
    Some((first, step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_in_six_digits_are_those_of_whole_rates() {
        for (printed, rate) in [
            ("1.95313e-05", 51_200.0),
            ("1.52588E-05", 65_536.0),
            ("1.22070e-06", 819_200.0),
            ("3.90625e-05", 25_600.0),
            ("2.26757e-05", 44_100.0),
            ("1.00000e-06", 1e6),
            ("4.88281e-06", 204_800.0),
        ] {
            let step: f64 = printed.parse().unwrap();
            let mut notices = Notices::default();
            let snapped = snapped_step(step, uncertainty_of_printed_step(printed), &mut notices);
            assert_eq!(of_step(snapped), rate, "{printed}");
            assert_eq!(notices.all().is_empty(), (1.0 / step - rate).abs() < 1e-6, "{printed}");
        }
    }

    #[test]
    fn steps_that_are_meant_stay() {
        for printed in ["3.00000e-06", "7.00000e-06", "1.50000e-05", "3.33333e+00"] {
            let step: f64 = printed.parse().unwrap();
            let mut notices = Notices::default();
            let kept = snapped_step(step, uncertainty_of_printed_step(printed), &mut notices);
            assert!((kept / step - 1.0).abs() < 1e-15, "{printed} became {kept}");
            assert!(notices.all().is_empty());
        }
    }

    #[test]
    fn the_rounding_of_printed_numbers() {
        assert_eq!(rounding_of("0.125"), (0.5e-3, 3));
        assert_eq!(rounding_of("-1.50E-05").1, 2);
        assert!((rounding_of("1.95313e-05").0 / 0.5e-10 - 1.0).abs() < 1e-12);
        assert_eq!(rounding_of("12,5"), (0.05, 3));
        // Invalid text gives some number, without overflow.
        let _ = rounding_of("1e99999999999");
        let _ = rounding_of("");
    }

    #[test]
    fn an_axis_in_eight_digits_is_even_and_its_rate_whole() {
        let values: Vec<f64> = (0..25_600)
            .map(|n| format!("{:.7e}", f64::from(n) / 25_600.0).parse().unwrap())
            .collect();
        let (start, step) =
            even_axis(&values, |value| 5e-8 * value.abs(), &mut Notices::default()).unwrap();
        assert_eq!((start, of_step(step)), (0.0, 25_600.0));
        let mut bent = values;
        bent[100] += 1e-5;
        assert_eq!(even_axis(&bent, |_| 5e-9, &mut Notices::default()), None);
    }
}
