//! Fields of fixed width, as written by Fortran.

/// The text of columns `start..start + width`, shorter at the end of the line.
pub(crate) fn columns(line: &str, start: usize, width: usize) -> &str {
    let from = boundary(line, start);
    let to = boundary(line, start.saturating_add(width));
    line[from..to].trim()
}

/// Byte index of column `column`.
fn boundary(line: &str, column: usize) -> usize {
    line.char_indices().nth(column).map_or(line.len(), |(index, _)| index)
}

/// Divides a line into fields of the given widths, or at blanks if a field is neither a number nor
/// blank.
pub(crate) fn numbers<'a>(line: &'a str, widths: &[usize]) -> Vec<&'a str> {
    let mut start = 0;
    let fixed: Vec<&str> = widths
        .iter()
        .map(|&width| {
            let field = columns(line, start, width);
            start += width;
            field
        })
        .collect();
    let numeric = |field: &&str| field.is_empty() || real(field).is_some();
    if fixed.iter().all(numeric) && line.trim_end().len() <= boundary(line, start) {
        return fixed;
    }
    line.split_ascii_whitespace().collect()
}

/// A whole number; blank is zero.
pub(crate) fn integer(field: &str) -> Option<i64> {
    if field.is_empty() { Some(0) } else { field.trim_start_matches('+').parse().ok() }
}

/// A number; `D` marks an exponent as `E` does, and a three-digit exponent
/// may come without a mark.
pub(crate) fn real(field: &str) -> Option<f64> {
    let plain = field.parse().ok();
    // Other writers print names of numbers such as `nan`.
    plain.or_else(|| {
        let field = field.replace(['d', 'D'], "e");
        field.parse().ok().or_else(|| {
            let sign = field.char_indices().skip(1).find(|(_, c)| matches!(c, '+' | '-'))?.0;
            let (mantissa, exponent) = field.split_at(sign);
            let digits = mantissa.ends_with(|c: char| c.is_ascii_digit() || c == '.');
            digits.then(|| format!("{mantissa}e{exponent}").parse().ok())?
        })
    })
}

/// Free text; empty for `NONE`.
pub(crate) fn text(field: &str) -> String {
    let field = field.trim();
    if field.eq_ignore_ascii_case("none") { String::new() } else { field.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fortran_numbers() {
        for (field, value) in [
            ("1.5E+02", 150.0),
            ("1.5D-02", 0.015),
            ("-2.50000-101", -2.5e-101),
            ("1.0+100", 1e100),
            ("-3", -3.0),
        ] {
            assert_eq!(real(field), Some(value), "{field}");
        }
        for field in ["", "x", "1.0e", "--1", "1-2-3", "e5"] {
            assert_eq!(real(field), None, "{field}");
        }
    }

    #[test]
    fn fields_touch_or_stand_apart() {
        let line = "         4     25600         1 -1.00000E-01-3.90625e-05  0.00000e+00";
        let cut = numbers(line, &[10, 10, 10, 13, 13, 13]);
        assert_eq!(cut, ["4", "25600", "1", "-1.00000E-01", "-3.90625e-05", "0.00000e+00"]);
        assert_eq!(numbers("4 25600 1 0. 1e-3 0.", &[10, 10, 10, 13, 13, 13]).len(), 6);
        assert_eq!(columns("äb c", 1, 3), "b c");
        assert_eq!(columns("short", 10, 5), "");
    }
}
