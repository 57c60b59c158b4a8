//! The lines of a text that an error is about, with the place underlined.

use std::ops::Range;
use std::path::Path;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::progress::{show_line, show_styled, takes_colors};

/// Characters shown of a long line before and after the start of a place.
const BEFORE: usize = 50;
const AFTER: usize = 140;

/// Width of an excerpt at most, with its line number, so that it is not cut again.
const WIDTH: usize = 400;

/// A place of a text and a word about it.
#[derive(Debug)]
pub(crate) struct Label {
    /// Bytes of the text.
    pub(crate) span: Range<usize>,
    pub(crate) text: String,
}

/// Shows the line of each label on standard error. `labels` are in the order of the text.
pub(crate) fn show_excerpts(path: &Path, text: &str, labels: &[Label]) {
    let renderer = if takes_colors() { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.term_width(WIDTH);
    for excerpt in Excerpts::new(text, labels).0 {
        let Excerpt { line, column, shown, marks } = &excerpt;
        let digits = line.to_string().len();
        show_line(&format!("{:digits$}--> {}:{line}:{column}", "", path.display()));
        let marks = marks
            .iter()
            .map(|(span, label)| AnnotationKind::Primary.span(span.clone()).label(*label));
        let snippet = Snippet::source(shown.as_str()).line_start(*line).annotations(marks);
        show_styled(&renderer.render(&[Group::with_level(Level::NOTE).element(snippet)]));
    }
}

/// Parts of a text, in its order.
#[derive(Debug, PartialEq)]
struct Excerpts<'a>(Vec<Excerpt<'a>>);

/// A line of a text, or the part of a long line around a place.
#[derive(Debug, PartialEq)]
struct Excerpt<'a> {
    /// Line, from 1.
    line: usize,
    /// Column of the first place in characters, from 1.
    column: usize,
    /// Text, with an ellipsis where the line is cut.
    shown: String,
    /// Bytes of `shown` to underline, and their labels.
    marks: Vec<(Range<usize>, &'a str)>,
}

impl<'a> Excerpts<'a> {
    /// One excerpt a line, and in a long line one a place, in one pass over the text.
    fn new(text: &str, labels: &'a [Label]) -> Self {
        let mut excerpts: Vec<Excerpt<'a>> = Vec::new();
        // Line and column, from 0, of the byte `at`, and the first byte of its line.
        let (mut at, mut start, mut line, mut column) = (0, 0, 0, 0);
        for Label { span, text: label } in labels {
            let Some(between) = text.get(at..span.start) else { continue };
            for (offset, character) in between.char_indices() {
                column += 1;
                if character == '\n' {
                    (start, line, column) = (at + offset + 1, line + 1, 0);
                }
            }
            at = span.start;
            let before = &text[start..at];
            let after = text[at..].split('\n').next().unwrap_or_default().trim_end_matches('\r');
            let marked = after.len().min(span.len());
            // Characters have at most four bytes.
            let is_long =
                |part: &str, most: usize| part.len() > 4 * most || part.chars().count() > most;
            if !is_long(before, AFTER) && !is_long(after, AFTER) {
                let mark = (before.len()..before.len() + marked, label.as_str());
                match excerpts.last_mut().filter(|last| last.line == line + 1) {
                    Some(last) => last.marks.push(mark),
                    None => excerpts.push(Excerpt {
                        line: line + 1,
                        column: column + 1,
                        shown: format!("{before}{after}"),
                        marks: vec![mark],
                    }),
                }
                continue;
            }
            let cut = before.char_indices().rev().nth(BEFORE - 1).map_or(0, |(cut, _)| cut);
            let mut shown = if cut > 0 { "…".to_owned() } else { String::new() };
            shown.push_str(&before[cut..]);
            let from = shown.len();
            let end = after.char_indices().nth(AFTER).map_or(after.len(), |(end, _)| end);
            shown.push_str(&after[..end]);
            let to = from + marked.min(end);
            if end < after.len() {
                shown.push('…');
            }
            let marks = vec![(from..to, label.as_str())];
            excerpts.push(Excerpt { line: line + 1, column: column + 1, shown, marks });
        }
        Self(excerpts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(span: Range<usize>, text: &str) -> Label {
        Label { span, text: text.to_owned() }
    }

    #[test]
    fn places_on_one_short_line_share_an_excerpt() {
        let text = "{\n  \"é\": 1, \"b\": {\r\n}}";
        let labels = [label(10..11, "one"), label(18..23, "object")];
        let Excerpts(found) = Excerpts::new(text, &labels);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].line, found[0].column), (2, 8));
        assert_eq!(found[0].shown, "  \"é\": 1, \"b\": {");
        let marked = |mark: usize| &found[0].shown[found[0].marks[mark].0.clone()];
        assert_eq!((marked(0), marked(1)), ("1", "{"));
    }

    #[test]
    fn a_long_line_is_cut_around_each_place() {
        let text =
            format!("\n{}X{}Y{}", "é".repeat(70_000), " ".repeat(70_000), "z".repeat(70_000));
        let places = [text.find('X').unwrap(), text.find('Y').unwrap()];
        let labels = places.map(|place| label(place..place + 1, "here"));
        let Excerpts(found) = Excerpts::new(&text, &labels);
        let columns: Vec<_> = found.iter().map(|one| (one.line, one.column)).collect();
        assert_eq!(columns, [(2, 70_001), (2, 140_002)]);
        for (excerpt, marked) in found.iter().zip(["X", "Y"]) {
            assert_eq!(&excerpt.shown[excerpt.marks[0].0.clone()], marked);
            assert_eq!(excerpt.shown.chars().count(), BEFORE + AFTER + 2);
            assert!(excerpt.shown.starts_with('…') && excerpt.shown.ends_with('…'));
        }
    }
}
