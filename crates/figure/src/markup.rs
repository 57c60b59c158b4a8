//! Lengths, numbers and text as SVG and HTML write them.

use std::fmt::Write as _;

/// CSS pixels a millimetre.
pub(crate) const PX_PER_MM: f64 = 96.0 / 25.4;
/// CSS pixels a point.
pub(crate) const PX_PER_PT: f64 = 96.0 / 72.0;

/// Rounded to 0.01 without trailing zeros; what is not finite is 0.
pub(crate) fn number(value: f64) -> String {
    let mut text = String::new();
    if value.is_finite() {
        push_rounded(&mut text, value, 2);
    } else {
        text.push('0');
    }
    text
}

/// Appends a finite value rounded to so many decimal places, without trailing zeros and sign of a zero.
///
/// By whole numbers: pictures hold ten thousands of coordinates, and the shortest text of a float takes five
/// times as long.
pub(crate) fn push_rounded(text: &mut String, value: f64, places: usize) {
    let unit = 10_u64.pow(places as u32);
    let scaled = (value * unit as f64).round();
    if scaled.abs() >= 9e15 {
        // Writing to a String cannot fail.
        let _ = write!(text, "{}", scaled / unit as f64);
        return;
    }
    if scaled < 0.0 {
        text.push('-');
    }
    let whole = scaled.abs() as u64;
    push_digits(text, whole / unit, 1);
    let mut fraction = whole % unit;
    if fraction > 0 {
        let mut digits = places;
        while fraction.is_multiple_of(10) {
            fraction /= 10;
            digits -= 1;
        }
        text.push('.');
        push_digits(text, fraction, digits);
    }
}

/// Appends a whole number in at least so many digits.
fn push_digits(text: &mut String, mut value: u64, least: usize) {
    let mut digits = [b'0'; 20];
    let mut start = digits.len();
    while value > 0 {
        start -= 1;
        digits[start] = b'0' + (value % 10) as u8;
        value /= 10;
    }
    let start = start.min(digits.len() - least);
    text.extend(digits[start..].iter().map(|&digit| char::from(digit)));
}

/// Text with the characters that mean something to XML replaced, and those XML forbids left out.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {}
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(1.0), "1");
        assert_eq!(number(-0.001), "0");
        assert_eq!(number(12.345_6), "12.35");
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(f64::NAN), "0");
        assert_eq!(number(-0.05), "-0.05");
        assert_eq!(number(-1234.5), "-1234.5");
        assert_eq!(number(100.0), "100");
        assert_eq!(number(-1e300), format!("-1{}", "0".repeat(300)));
    }

    /// As the float rounded to the places is written.
    #[test]
    fn numbers_are_the_shortest_of_the_rounded_value() {
        let mut random: u64 = 7;
        for place in 0..20_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let size = [1.0, 100.0, 5000.0, 1e7][place % 4];
            let value = size * ((random >> 11) as f64 / (1_u64 << 52) as f64 - 1.0);
            let rounded = (value * 1e3).round();
            let expected =
                if rounded == 0.0 { "0".to_owned() } else { format!("{}", rounded / 1e3) };
            let mut text = String::new();
            push_rounded(&mut text, value, 3);
            assert_eq!(text, expected, "{value}");
        }
    }

    #[test]
    fn markup_is_escaped() {
        assert_eq!(escape("a<b & \"c\" 'd'\u{7}"), "a&lt;b &amp; &quot;c&quot; &#39;d&#39;");
    }
}
