//! Markdown, as far as the rules need it: prose, code spans and code blocks.

/// A piece of a document on one line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece<'a> {
    /// Text between code spans.
    Prose(&'a str),
    /// Code between backticks.
    Span(&'a str),
    /// A line of a code block, and the block's language.
    Block {
        /// First word after the fence; empty if there is none.
        language: &'a str,
        /// The line.
        line: &'a str,
    },
}

/// The pieces of `text` with their line numbers, from 1.
pub(super) fn pieces(text: &str) -> Vec<(usize, Piece<'_>)> {
    let mut pieces = Vec::new();
    let mut open: Option<(&str, &str)> = None;
    for (number, line) in (1..).zip(text.lines()) {
        let start = line.trim_start();
        let fence = ["```", "~~~"].into_iter().find(|fence| start.starts_with(fence));
        match (open, fence) {
            (Some((opened, _)), Some(fence)) if fence == opened => open = None,
            (Some((_, language)), _) => pieces.push((number, Piece::Block { language, line })),
            (None, Some(fence)) => {
                let info = start.trim_start_matches(&fence[..1]).trim();
                open = Some((fence, info.split([',', ' ']).next().unwrap_or_default()));
            }
            (None, None) => {
                for (index, part) in line.split('`').enumerate() {
                    let span = index % 2 == 1;
                    pieces
                        .push((number, if span { Piece::Span(part) } else { Piece::Prose(part) }));
                }
            }
        }
    }
    pieces
}

/// Targets of the links of a document, with line numbers: `[text](target)`,
/// `[name]: target`, and the `src` and `href` of HTML.
pub(super) fn links(text: &str) -> Vec<(usize, String)> {
    let mut links = Vec::new();
    let mut lines: Vec<(usize, String)> = Vec::new();
    for (number, piece) in pieces(text) {
        // A code span may be the text of a link: it is left out, the link kept.
        let Piece::Prose(part) = piece else { continue };
        match lines.last_mut() {
            Some((last, line)) if *last == number => line.push_str(part),
            _ => lines.push((number, part.to_owned())),
        }
    }
    for (number, line) in &lines {
        for (mark, end) in [("](", ')'), ("src=\"", '"'), ("href=\"", '"')] {
            for after in line.split(mark).skip(1) {
                let target = after.split(end).next().unwrap_or_default();
                links.push((*number, first_word(target)));
            }
        }
        let definition = line.strip_prefix('[').and_then(|line| line.split_once("]: "));
        links.extend(definition.map(|(_, target)| (*number, first_word(target))));
    }
    links
}

fn first_word(text: &str) -> String {
    let word = text.split_whitespace().next().unwrap_or_default();
    word.trim_start_matches('<').trim_end_matches('>').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_spans_and_blocks_are_told_apart() {
        let text = "Run `cargo test` now.\n```sh\nasperity check\n```\n~~~\n`x`\n~~~";
        let found = pieces(text);
        assert_eq!(found[1], (1, Piece::Span("cargo test")));
        assert_eq!(found[3], (3, Piece::Block { language: "sh", line: "asperity check" }));
        assert_eq!(found[4], (6, Piece::Block { language: "", line: "`x`" }));
    }

    #[test]
    fn links_are_found_outside_code() {
        let text = "[a](b.md#c) and ![`d`](<e.svg> \"title\")\n`[f](g.md)`\n[h]: i.md\n<img src=\"j.png\">";
        let found: Vec<_> = links(text).into_iter().map(|(_, target)| target).collect();
        assert_eq!(found, ["b.md#c", "e.svg", "i.md", "j.png"]);
    }
}
