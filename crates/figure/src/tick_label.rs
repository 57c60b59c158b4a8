//! Labels of the marks of an axis, and the axis title with its unit.

/// Largest shown value from which a linear axis takes out a power of ten.
const LARGE: f64 = 1e5;
/// Largest shown value below which a linear axis takes out a power of ten.
const SMALL: f64 = 1e-2;

/// The power of ten, a multiple of three, that a linear axis over this range takes out of its
/// labels and writes once, before the unit.
pub(crate) fn common_exponent(low: f64, high: f64) -> i32 {
    let largest = low.abs().max(high.abs());
    if largest == 0.0 || !largest.is_finite() || (SMALL..LARGE).contains(&largest) {
        return 0;
    }
    // Slack so that 1e9 written as 999999999.9999999 counts as 1e9.
    ((largest.log10() + 1e-9) / 3.0).floor() as i32 * 3
}

/// Label, then the power of ten and the unit in parentheses.
pub(crate) fn title(label: &str, unit: &str, exponent: i32) -> String {
    match (unit.is_empty(), exponent) {
        (true, 0) => label.to_owned(),
        (false, 0) => format!("{label} ({unit})"),
        (true, _) => format!("{label} (×{})", power_of_ten(exponent)),
        (false, _) => format!("{label} ({} {unit})", power_of_ten(exponent)),
    }
}

/// A value of a linear axis with the decimals that tell its marks apart.
pub(crate) fn linear(value: f64, exponent: i32, decimals: i32) -> String {
    let places = (decimals + exponent).clamp(0, 12) as usize;
    grouped(&format!("{:.places$}", value / 10f64.powi(exponent)))
}

/// Values of a logarithmic axis: plain where all are easily read, else powers of ten.
pub(crate) fn logarithmic(values: &[f64]) -> Vec<String> {
    let plain = values.iter().all(|&value| (0.99e-3..1.01e4).contains(&value))
        && values.iter().any(|&value| (0.09..1.01e3).contains(&value));
    values
        .iter()
        .map(|&value| if plain { grouped(&short(value)) } else { scientific(value) })
        .collect()
}

/// At most six significant decimals of a positive value, without trailing zeros.
fn short(value: f64) -> String {
    let places = (5 - value.log10().floor() as i32).clamp(0, 12) as usize;
    let text = format!("{value:.places$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A positive value as mantissa times a power of ten; the mantissa is left out where it is 1.
fn scientific(value: f64) -> String {
    let exponent = (value.log10() + 1e-9).floor() as i32;
    let mantissa = short(value / 10f64.powi(exponent));
    match mantissa.as_str() {
        "1" => power_of_ten(exponent),
        _ => format!("{}×{}", grouped(&mantissa), power_of_ten(exponent)),
    }
}

fn power_of_ten(exponent: i32) -> String {
    format!("10^{{{}}}", grouped(&exponent.to_string()))
}

/// A decimal with a true minus sign, and thin spaces between thousands from five digits on.
fn grouped(decimal: &str) -> String {
    let (sign, digits) = match decimal.strip_prefix('-') {
        Some(rest) if rest.chars().any(|c| ('1'..='9').contains(&c)) => ("−", rest),
        Some(rest) => ("", rest),
        None => ("", decimal),
    };
    let (whole, fraction) = digits.split_once('.').map_or((digits, None), |(w, f)| (w, Some(f)));
    let mut text = sign.to_owned();
    for (index, digit) in whole.chars().enumerate() {
        if whole.len() > 4 && index > 0 && (whole.len() - index) % 3 == 0 {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    if let Some(fraction) = fraction {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_labels_share_their_decimals() {
        assert_eq!(linear(0.5, 0, 1), "0.5");
        assert_eq!(linear(-20_000.0, 0, 0), "−20\u{2009}000");
        assert_eq!(linear(-0.0, 0, 1), "0.0");
        assert_eq!(linear(2.5e9, 9, -8), "2.5");
        assert_eq!(linear(2e-7, -6, 7), "0.2");
    }

    #[test]
    fn a_power_of_ten_is_taken_out_once() {
        assert_eq!(common_exponent(0.0, 3.5e9), 9);
        assert_eq!(common_exponent(-2e-5, 1e-6), -6);
        assert_eq!(common_exponent(0.0, 20_000.0), 0);
        assert_eq!(common_exponent(0.0, 0.0), 0);
        assert_eq!(title("Stiffness", "N/m³", 9), "Stiffness (10^{9} N/m³)");
        assert_eq!(title("Ratio", "", -3), "Ratio (×10^{−3})");
        assert_eq!(title("Ratio", "", 0), "Ratio");
        assert_eq!(title("Force", "N", 0), "Force (N)");
    }

    #[test]
    fn logarithmic_labels_are_plain_or_powers() {
        assert_eq!(logarithmic(&[0.1, 1.0, 10.0, 100.0]), ["0.1", "1", "10", "100"]);
        assert_eq!(logarithmic(&[1e-9, 1e-8]), ["10^{−9}", "10^{−8}"]);
        assert_eq!(logarithmic(&[0.1 + 0.2]), ["0.3"]);
        assert_eq!(logarithmic(&[2e-7, 5e-7]), ["2×10^{−7}", "5×10^{−7}"]);
    }
}
