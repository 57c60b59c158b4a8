//! Delimiter, decimal mark and first row of numbers of a text.

use crate::source::decode_text;

/// Delimiter and decimal mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dialect {
    /// Byte between fields; a blank stands for any run of blanks.
    pub(crate) delimiter: u8,
    /// `.` or `,`.
    pub(crate) decimal: u8,
}

/// All dialects, in order of preference.
const CANDIDATES: [Dialect; 7] = [
    Dialect { delimiter: b'\t', decimal: b'.' },
    Dialect { delimiter: b'\t', decimal: b',' },
    Dialect { delimiter: b';', decimal: b'.' },
    Dialect { delimiter: b';', decimal: b',' },
    Dialect { delimiter: b',', decimal: b'.' },
    Dialect { delimiter: b' ', decimal: b'.' },
    Dialect { delimiter: b' ', decimal: b',' },
];

/// A run of lines of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct NumberRun {
    /// First line, from zero.
    pub(crate) start: usize,
    /// Lines of numbers.
    pub(crate) lines: usize,
    /// Fields of each line, without empty ones at the end.
    pub(crate) fields: usize,
}

impl Dialect {
    /// The dialect whose longest run of rows of equally many numbers
    /// has the most numbers, and that run; none without a row.
    pub(crate) fn sniff(lines: &[&[u8]]) -> Option<(Self, NumberRun)> {
        let mut best: Option<(Self, NumberRun)> = None;
        for dialect in CANDIDATES {
            let run = dialect.longest_run(lines);
            // By numbers, not lines: a single number above the data is not part of them.
            let better =
                best.is_none_or(|(_, known)| run.lines * run.fields > known.lines * known.fields);
            if run.lines > 0 && better {
                best = Some((dialect, run));
            }
        }
        best.map(|(dialect, run)| (dialect, dialect.with_rows_above(lines, run)))
    }

    fn longest_run(self, lines: &[&[u8]]) -> NumberRun {
        let (mut best, mut run) = (NumberRun::default(), NumberRun::default());
        for (index, line) in lines.iter().enumerate() {
            if is_passed_over(line) {
                continue;
            }
            match self.numbers_in(line) {
                Some(fields) if run.lines > 0 && fields == run.fields => run.lines += 1,
                Some(fields) => run = NumberRun { start: index, lines: 1, fields },
                None => run = NumberRun::default(),
            }
            if run.lines > best.lines {
                best = run;
            }
        }
        best
    }

    /// Number of fields of a row of numbers; none if a field is not a number, or all are empty.
    fn numbers_in(self, line: &[u8]) -> Option<usize> {
        let (mut count, mut last, mut numbers) = (0, 0, 0);
        for field in self.fields(line) {
            count += 1;
            if !field.is_empty() {
                last = count;
                if self.number(field).is_some() {
                    numbers += 1;
                } else if !is_placeholder(field) {
                    return None;
                }
            }
        }
        (numbers > 0).then_some(last)
    }

    /// The run with the rows above it that belong to it: rows of numbers that only lines beginning with
    /// a number separate from it, and broken rows whose first number continues the first column.
    ///
    /// A broken row has a field that is neither a number nor a placeholder, or too few fields. It is an
    /// error where it is read; above the data it would turn the rows before it into headings.
    fn with_rows_above(self, lines: &[&[u8]], run: NumberRun) -> NumberRun {
        const FEWEST: usize = 2;
        let first = |line: &[u8]| self.fields(line).next().and_then(|field| self.number(field));
        let starts_as_row = |line: &[u8]| {
            let field = self.fields(line).next().unwrap_or_default();
            self.number(field).is_some() || is_placeholder(field)
        };
        let (mut joined, mut widths) = (run, Vec::new());
        for (index, line) in lines[..run.start].iter().enumerate().rev() {
            if is_passed_over(line) {
                continue;
            }
            if !starts_as_row(line) {
                break;
            }
            let Some(fields) = self.numbers_in(line).filter(|fields| *fields >= run.fields) else {
                continue;
            };
            widths.push((fields, index));
            let widest = widths.iter().map(|(fields, _)| *fields).max().unwrap_or(run.fields);
            let mut of_widest = widths.iter().rev().filter(|(fields, _)| *fields == widest);
            if of_widest.clone().count() >= FEWEST {
                joined.fields = widest;
                joined.start = of_widest.next().map_or(joined.start, |(_, index)| *index);
            }
        }
        let rows = |from: usize| lines[from..].iter().filter(|line| !is_passed_over(line));
        let column: Vec<f64> =
            rows(joined.start).take(FEWEST).filter_map(|row| first(row)).collect();
        if let [begin, next] = column[..]
            && begin != next
        {
            let broken = lines[..joined.start].iter().enumerate().rev();
            let broken = broken.filter(|(_, line)| !is_passed_over(line));
            for (before, (index, line)) in broken.enumerate() {
                let expected = begin - (before as f64 + 1.0) * (next - begin);
                let continues = |x: f64| (x - expected).abs() < 0.5 * (next - begin).abs();
                let fields = self.fields(line).count();
                if fields < 2 || fields > joined.fields || !first(line).is_some_and(continues) {
                    break;
                }
                joined.start = index;
            }
        }
        joined.lines += rows(joined.start).count() - rows(run.start).count();
        joined
    }

    /// Index of the first and number of the rows above the headings that have the width of the run, if
    /// there are two or more.
    pub(crate) fn rows_above(self, lines: &[&[u8]], run: NumberRun) -> Option<(usize, usize)> {
        let is_row = |line: &[u8]| {
            !is_passed_over(line) && self.numbers_in(line) == Some(run.fields) && run.fields > 1
        };
        let rows = lines.iter().enumerate().filter(|(_, line)| is_row(line));
        let (first, count) = (rows.clone().next()?.0, rows.count());
        (count > 1).then_some((first, count))
    }

    /// The fields of a line, without blanks around them.
    pub(crate) fn fields(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        let blanks = self.delimiter == b' ';
        let is_delimiter = move |byte: &u8| {
            if blanks { byte.is_ascii_whitespace() } else { *byte == self.delimiter }
        };
        line.split(is_delimiter)
            .filter(move |field| !(blanks && field.is_empty()))
            .map(<[u8]>::trim_ascii)
    }

    /// The number in a field, possibly in quotes.
    pub(crate) fn number(self, field: &[u8]) -> Option<f64> {
        const LONGEST: usize = 64;
        let inner = field.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
        let field = inner.unwrap_or(field);
        // `inf` and `nan` are numbers, words like `infinity` are not.
        if field.len() > LONGEST || !field.last()?.is_ascii_digit() && !ends_otherwise(field) {
            return None;
        }
        if self.decimal == b'.' {
            return std::str::from_utf8(field).ok()?.parse().ok();
        }
        let mut copy = [0; LONGEST];
        for (to, from) in copy.iter_mut().zip(field) {
            *to = match from {
                b',' => b'.',
                b'.' => return None,
                other => *other,
            };
        }
        std::str::from_utf8(&copy[..field.len()]).ok()?.parse().ok()
    }
}

/// Numbers that do not end with a digit: `1.`, `nan`, `inf`.
/// True for a text that stands in place of a number: an overload, or a missing value.
fn is_placeholder(field: &[u8]) -> bool {
    const WORDS: [&str; 18] = [
        "ovl",
        "ovld",
        "ovr",
        "ol",
        "over",
        "overload",
        "overflow",
        "under",
        "underflow",
        "clip",
        "na",
        "n/a",
        "#n/a",
        "null",
        "none",
        "nan",
        "inf",
        "infinity",
    ];
    let text = decode_text(field).0;
    let bare = text.trim_matches('"').trim().trim_start_matches(['+', '-']).to_lowercase();
    if text.is_empty() {
        return false;
    }
    // `---`, `***`, `?`, an infinity as UTF-8, and numbers of Visual C such as `-1.#IND`.
    bare.chars().all(|c| "-*?_.\u{221e}\u{2014}\u{2013}".contains(c))
        || WORDS.contains(&bare.as_str())
        || ["1.#", "#num", "#div", "#value", "err"].iter().any(|start| bare.starts_with(start))
}

fn ends_otherwise(field: &[u8]) -> bool {
    let bare = field.strip_prefix(b"-").unwrap_or(field);
    matches!(field.last(), Some(b'.' | b','))
        || bare.eq_ignore_ascii_case(b"nan")
        || bare.eq_ignore_ascii_case(b"inf")
}

/// True for an empty line or a comment.
pub(crate) fn is_passed_over(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.is_empty() || line.starts_with(b"#") || line.starts_with(b"%") || line.starts_with(b"//")
}

/// The fields of a line of words; delimiters in quotes are part of a word.
pub(crate) fn words(line: &[u8], delimiter: u8) -> Vec<String> {
    let line = decode_text(line).0;
    let mut words = Vec::new();
    let (mut word, mut quoted) = (String::new(), false);
    for character in line.chars() {
        let ends = !quoted
            && if delimiter == b' ' {
                character.is_whitespace()
            } else {
                character == char::from(delimiter)
            };
        if ends {
            words.push(word.trim().to_owned());
            word.clear();
        } else if character == '"' {
            quoted = !quoted;
        } else {
            word.push(character);
        }
    }
    words.push(word.trim().to_owned());
    if delimiter == b' ' {
        words.retain(|word| !word.is_empty());
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sniff(text: &str) -> (char, char, NumberRun) {
        let lines: Vec<&[u8]> = text.lines().map(str::as_bytes).collect();
        let (dialect, run) = Dialect::sniff(&lines).unwrap();
        (char::from(dialect.delimiter), char::from(dialect.decimal), run)
    }

    #[test]
    fn dialects_are_distinguished() {
        for (text, delimiter, decimal, fields) in [
            ("t,f\n0,1\n1,2\n", ',', '.', 2),
            ("t;f\n0,5;1,25\n1,5;2\n", ';', ',', 2),
            ("0.5;1.25\n1.5;2\n", ';', '.', 2),
            ("0,5\t1,25\n1,5\t2\n", '\t', ',', 2),
            ("  0.5   1.25\n  1.5   2\n", ' ', '.', 2),
            ("0,5 1,25\n1,5 2\n", ' ', ',', 2),
            ("1.5, 2.5\n3.5, 4.5\n", ',', '.', 2),
            ("1.5\n2.5\n", '\t', '.', 1),
            ("1,5\n2,5\n3,5\n", ',', '.', 2),
        ] {
            let (found_delimiter, found_decimal, run) = sniff(text);
            assert_eq!(
                (found_delimiter, found_decimal, run.fields),
                (delimiter, decimal, fields),
                "{text}"
            );
        }
        assert_eq!(Dialect::sniff(&[b"no", b"numbers"]), None);
    }

    #[test]
    fn the_longest_run_is_the_data() {
        let (_, _, run) = sniff("Serial\n1234\nRange\n5\n\n# c\n0,1\n1,2\n# c\n\n2,3\n");
        assert_eq!(run, NumberRun { start: 6, lines: 3, fields: 2 });
    }

    #[test]
    fn delimiters_in_quotes_are_part_of_a_word() {
        assert_eq!(words(b"\"a, b\",c , d\"\"", b','), ["a, b", "c", "d"]);
        assert_eq!(words(b"  a   b ", b' '), ["a", "b"]);
    }
}
