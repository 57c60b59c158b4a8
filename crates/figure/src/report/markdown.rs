//! A report as Markdown.

use super::{Report, ReportBlock, TableCell, is_numeric};
use crate::text;

impl Report {
    /// The report as Markdown (GitHub's flavour); `figure_path` gives the path of the picture of a
    /// figure from its identifier.
    pub fn to_markdown(&self, figure_path: impl Fn(&str) -> String) -> String {
        let mut parts = vec![format!("# {}", line(&self.title))];
        parts.extend(self.intro.iter().map(|text| line(text)));
        let mut number = 0;
        for block in &self.blocks {
            parts.push(match block {
                ReportBlock::Section { title } => format!("## {}", line(title)),
                ReportBlock::Subsection { title } => format!("### {}", line(title)),
                ReportBlock::Paragraph { text } => line(text),
                ReportBlock::Figure { id, caption, .. } => {
                    number += 1;
                    let path = figure_path(id);
                    let caption = line(caption);
                    format!("![Figure {number}](<{path}>)\n\n**Figure {number}.** {caption}")
                }
                ReportBlock::Table { headers, rows } => table(headers, rows),
                ReportBlock::KeyValues { pairs } => {
                    let items = pairs
                        .iter()
                        .map(|(key, value)| format!("- **{}:** {}", line(key), line(value)));
                    items.collect::<Vec<_>>().join("\n")
                }
            });
        }
        parts.join("\n\n") + "\n"
    }
}

fn table(headers: &[String], rows: &[Vec<TableCell>]) -> String {
    let row = |cells: Vec<String>| format!("| {} |", cells.join(" | "));
    let cell = |text: &str| line(text).replace('|', "\\|");
    let mut lines = vec![
        row(headers.iter().map(|header| cell(header)).collect()),
        row((0..headers.len())
            .map(|column| if is_numeric(rows, column) { "---:" } else { "---" }.to_owned())
            .collect()),
    ];
    for cells in rows {
        let texts = cells.iter().map(|content| match content {
            TableCell::Text(text) | TableCell::Number(text) => cell(text),
            TableCell::Outcome(outcome) => format!("{} {}", outcome.shown().2, outcome.word()),
        });
        lines.push(row(texts.collect()));
    }
    lines.join("\n")
}

/// One line of text in which nothing is markup but `_{...}` and `^{...}`.
fn line(text: &str) -> String {
    let joined = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text::tagged(&joined, escaped)
}

fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '\\' | '`' | '*' | '_' | '[' | ']' | '#' | '~' => escaped.extend(['\\', character]),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::ClaimOutcome;

    #[test]
    fn text_is_not_markup() {
        assert_eq!(line("a*b* <k_c> k_{c}\n # x"), "a\\*b\\* &lt;k\\_c&gt; k<sub>c</sub> \\# x");
    }

    #[test]
    fn figures_are_linked_and_tables_aligned() {
        let report = Report::new("R").figure("fig-1", "Gain | phase", "<svg/>").table(
            ["a|b", "v"],
            [vec!["x".into(), TableCell::from(1.5)], vec![ClaimOutcome::Fail.into()]],
        );
        let text = report.to_markdown(|id| format!("plots/{id}.svg"));
        assert!(text.contains("![Figure 1](<plots/fig-1.svg>)"));
        assert!(text.contains("| a\\|b | v |\n| --- | ---: |\n| x | 1.500 |\n| ✗ fail |  |"));
    }
}
