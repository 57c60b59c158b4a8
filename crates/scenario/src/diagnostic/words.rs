//! How values appear inside a message.

/// Longest text quoted in full.
const LONGEST_QUOTE: usize = 60;

/// Most words listed in full.
const LONGEST_LIST: usize = 24;

/// A text in quotes, escaped, cut when it is long.
pub(crate) fn brief(text: &str) -> String {
    let mut shown: String = text.chars().take(LONGEST_QUOTE).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    serde_json::Value::String(shown).to_string()
}

/// A text with its control characters escaped, cut when it is long.
pub(crate) fn one_line(text: &str) -> String {
    let quoted = if text.chars().count() <= 4 * LONGEST_QUOTE {
        serde_json::Value::from(text).to_string()
    } else {
        let start: String = text.chars().take(4 * LONGEST_QUOTE).collect();
        serde_json::Value::String(start + "…").to_string()
    };
    let inner = quoted.strip_prefix('"').unwrap_or(&quoted);
    inner.strip_suffix('"').unwrap_or(inner).to_owned()
}

/// Words separated by commas; a long list is cut and its rest counted.
pub(crate) fn list<S: AsRef<str>>(words: impl IntoIterator<Item = S>) -> String {
    let mut shown = String::new();
    let mut count = 0_usize;
    for word in words {
        count += 1;
        if count <= LONGEST_LIST {
            if count > 1 {
                shown.push_str(", ");
            }
            shown.push_str(word.as_ref());
        }
    }
    if count > LONGEST_LIST {
        let rest = count - LONGEST_LIST;
        return format!("{shown} and {rest} more");
    }
    shown
}

/// A number in its shortest form, with an exponent when it is far from 1.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e6).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// A computed number, to four digits.
pub fn rounded(value: f64) -> String {
    let digits = format!("{value:.3e}");
    digits.parse().map_or(digits, number)
}

/// Words in quotes, joined by `joint` before the last one.
pub(crate) fn joined(words: &[String], joint: &str) -> String {
    let quoted: Vec<String> = words.iter().map(|word| brief(word)).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} {joint} {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

/// A count with its noun.
pub(crate) fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_and_odd_texts_stay_one_short_line() {
        assert_eq!(brief("a\nb"), r#""a\nb""#);
        assert!(brief(&"x".repeat(1000)).len() < 80);
        assert_eq!(one_line("/a\tb"), r"/a\tb");
        let many: Vec<String> = (0..30).map(|index| index.to_string()).collect();
        assert!(list(&many).ends_with("22, 23 and 6 more"));
    }

    #[test]
    fn numbers_read_as_a_person_writes_them() {
        let shown: Vec<String> = [0.0, 0.95, 200_000.0, 8.5e11, -1.15e-4].map(number).into();
        assert_eq!(rounded(1.297_295_983e12), "1.297e12");
        assert_eq!(rounded(f64::INFINITY), "inf");
        assert_eq!(shown, ["0", "0.95", "200000", "8.5e11", "-1.15e-4"]);
    }
}
