//! Numbers, strings and lists inside a message.

use serde_json::Value;

/// Longest string quoted in full.
const MAX_QUOTE: usize = 60;

/// Most words listed in full.
const MAX_LIST: usize = 24;

/// Number to four significant digits, with an exponent outside 1e-3 to 1e6, as messages print it.
///
/// ```
/// use asperity_scenario::four_digits;
///
/// assert_eq!(four_digits(1.297_295_983e12), "1.297e12");
/// assert_eq!(four_digits(0.25), "0.25");
/// ```
pub fn four_digits(value: f64) -> String {
    with_digits(value, 4)
}

/// The number of significant digits, at least `least` and at most 12, with which values are told from each
/// other: the smallest difference of two neighbours has one digit or more. Equal values and values that
/// are not finite do not count.
///
/// ```
/// use asperity_scenario::digits_apart;
///
/// assert_eq!(digits_apart(&[946.12, 946.65, 951.0], 4), 5);
/// assert_eq!(digits_apart(&[1.0, 2.0], 4), 4);
/// ```
pub fn digits_apart(values: &[f64], least: usize) -> usize {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let largest = sorted.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let gap = gaps.filter(|gap| *gap > 1e-12 * largest).fold(f64::INFINITY, f64::min);
    let digits = (largest / gap).log10().ceil() + 1.0;
    (digits.clamp(0.0, 12.0) as usize).max(least)
}

/// Number to `digits` significant digits, with an exponent outside 1e-3 to 1e6.
pub fn with_digits(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    text.parse().map_or(text, number)
}

/// Number in its shortest form, with an exponent outside 1e-3 to 1e6.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e6).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// JSON value as a message names it.
pub(crate) fn found(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(truth) => truth.to_string(),
        Value::Number(size) => format!("the number {}", number(size.as_f64().unwrap_or(f64::NAN))),
        Value::String(text) => format!("the string {}", brief(text)),
        Value::Array(_) => "an array".to_owned(),
        Value::Object(_) => "an object".to_owned(),
    }
}

/// String in quotes, escaped, and shortened if it is long.
pub(crate) fn brief(text: &str) -> String {
    quoted(text, MAX_QUOTE)
}

/// String with its control characters escaped, and shortened if it is long.
pub(crate) fn one_line(text: &str) -> String {
    let quoted = quoted(text, 4 * MAX_QUOTE);
    let inner = quoted.strip_prefix('"').unwrap_or(&quoted);
    inner.strip_suffix('"').unwrap_or(inner).to_owned()
}

fn quoted(text: &str, max: usize) -> String {
    let mut shown: String = text.chars().take(max).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    Value::String(shown).to_string()
}

/// Words separated by commas; of a long list the rest is counted.
pub(crate) fn list<S: AsRef<str>>(words: impl IntoIterator<Item = S>) -> String {
    let mut words = words.into_iter();
    let shown: Vec<String> = words.by_ref().take(MAX_LIST).map(|w| w.as_ref().into()).collect();
    match (shown.join(", "), words.count()) {
        (shown, 0) => shown,
        (shown, rest) => format!("{shown} and {rest} more"),
    }
}

/// Words in quotes, with `conjunction` before the last one.
pub(crate) fn joined(words: &[String], conjunction: &str) -> String {
    let quoted: Vec<String> = words.iter().map(|word| brief(word)).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => {
            format!("{} {conjunction} {last}", rest.join(", "))
        }
        _ => quoted.concat(),
    }
}

/// Count with its noun.
pub(crate) fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_strings_and_control_characters_give_one_short_line() {
        assert_eq!(brief("a\nb"), r#""a\nb""#);
        assert!(brief(&"x".repeat(1000)).len() < 80);
        assert_eq!(one_line("/a\tb"), r"/a\tb");
        let many: Vec<String> = (0..30).map(|index| index.to_string()).collect();
        assert!(list(&many).ends_with("22, 23 and 6 more"));
    }

    #[test]
    fn numbers_are_printed_in_their_shortest_form() {
        let shown: Vec<String> = [0.0, 0.95, 200_000.0, 8.5e11, -1.15e-4].map(number).into();
        assert_eq!(four_digits(1.297_295_983e12), "1.297e12");
        assert_eq!(four_digits(f64::INFINITY), "inf");
        assert_eq!(shown, ["0", "0.95", "200000", "8.5e11", "-1.15e-4"]);
    }
}
