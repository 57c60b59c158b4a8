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
        best
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
        let (mut count, mut last) = (0, 0);
        for field in self.fields(line) {
            count += 1;
            if !field.is_empty() {
                last = count;
                self.number(field)?;
            }
        }
        (last > 0).then_some(last)
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
