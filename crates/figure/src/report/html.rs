//! A report as one HTML page: style, font and figures inside, nothing fetched.

use super::embed::{embedded_fonts, inline, paper_width};
use super::{ClaimOutcome, Report, ReportBlock, TableCell, is_numeric};
use crate::{
    interactive::INTERACTIVE_SCRIPT,
    markup::{escape, number},
    text,
};
use std::collections::HashSet;

const STYLE: &str = include_str!("style.css");
const FIGURES: &str = include_str!("figures.js");
const HINT: &str = "Figures: drag to zoom, double-click for the whole, shift and drag to move; values \
                    are shown at the pointer.";
/// Most columns of a table that stays within the width of the text.
const MOST_COLUMNS: usize = 7;
/// Size of a figure on the screen over its size on paper.
const ZOOM: f64 = 1.4;

impl Report {
    /// The report as one self-contained HTML page: style, font and figures inside.
    pub fn to_html(&self) -> String {
        let mut page = HtmlPage::default();
        let main: String = self.blocks.iter().map(|block| page.block(block)).collect();
        let intro: String =
            self.intro.iter().map(|text| element("p class=\"lead\"", text)).collect();
        let navigation = if page.contents.is_empty() {
            String::new()
        } else {
            let contents = &page.contents;
            format!("<nav aria-label=\"Contents\"><h2>Contents</h2>\n<ol>\n{contents}</ol></nav>\n")
        };
        let (title, heading) = (escape(&self.title), element("h1", &self.title));
        let (fonts, summary) = (embedded_fonts(), summary(self));
        let (hint, script) = if page.interactive {
            let script =
                format!("(() => {{\n\"use strict\";\n{INTERACTIVE_SCRIPT}{FIGURES}}})();\n");
            (format!("<p class=\"hint\">{HINT}</p>\n"), format!("<script>\n{script}</script>\n"))
        } else {
            (String::new(), String::new())
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{fonts}{STYLE}</style>\n</head>\n<body>\n\
             <header>\n{heading}{intro}{summary}{hint}</header>\n{navigation}\
             <main>\n{main}</main>\n{script}</body>\n</html>\n"
        )
    }
}

/// Counters of a page while its blocks are written.
#[derive(Debug, Default)]
struct HtmlPage {
    anchors: Anchors,
    contents: String,
    figures: usize,
    interactive: bool,
}

impl HtmlPage {
    fn block(&mut self, block: &ReportBlock) -> String {
        match block {
            ReportBlock::Section { title } => {
                let anchor = self.anchors.unique(title);
                let entry = format!("<li><a href=\"#{anchor}\">{}</a></li>\n", rich(title));
                self.contents.push_str(&entry);
                element(&format!("h2 id=\"{anchor}\""), title)
            }
            ReportBlock::Subsection { title } => element("h3", title),
            ReportBlock::Paragraph { text } => element("p", text),
            ReportBlock::Figure { id, caption, svg, data } => self.figure(id, caption, svg, data),
            ReportBlock::Table { headers, rows } => table(headers, rows),
            ReportBlock::KeyValues { pairs } => {
                let pair =
                    |(key, value): &(String, String)| element("dt", key) + &element("dd", value);
                format!("<dl>\n{}</dl>\n", pairs.iter().map(pair).collect::<String>())
            }
        }
    }

    fn figure(&mut self, id: &str, caption: &str, svg: &str, data: &str) -> String {
        self.figures += 1;
        let (anchor, count) = (self.anchors.unique(id), self.figures);
        let width = paper_width(svg).map_or_else(String::new, |width| {
            let (screen, paper) = (number(width * ZOOM), number(width));
            format!(" style=\"--screen:{screen}mm;--paper:{paper}mm\"")
        });
        let (svg, caption) = (inline(svg, &anchor), rich(caption));
        let data = if data.is_empty() {
            String::new()
        } else {
            self.interactive = true;
            format!("<script type=\"application/json\" class=\"panels\">{data}</script>\n")
        };
        format!(
            "<figure id=\"{anchor}\">\n<div class=\"picture\"{width}>{svg}</div>\n{data}\
             <figcaption><b>Figure {count}.</b> {caption}</figcaption>\n</figure>\n"
        )
    }
}

/// An element with rich text; `tag` may hold attributes.
fn element(tag: &str, text: &str) -> String {
    let name = tag.split(' ').next().unwrap_or(tag);
    format!("<{tag}>{}</{name}>\n", rich(text))
}

/// Escaped text with sub- and superscripts.
fn rich(text: &str) -> String {
    text::tagged(text, escape)
}

fn table(headers: &[String], rows: &[Vec<TableCell>]) -> String {
    let class = |column: usize| if is_numeric(rows, column) { " class=\"number\"" } else { "" };
    let head: Vec<String> = headers
        .iter()
        .enumerate()
        .map(|(column, text)| element(&format!("th scope=\"col\"{}", class(column)), text))
        .collect();
    let row = |cells: &Vec<TableCell>| {
        let cell = |(column, cell): (usize, &TableCell)| {
            let content = match cell {
                TableCell::Text(text) | TableCell::Number(text) => rich(text),
                TableCell::Outcome(outcome) => badge(*outcome, outcome.word()),
            };
            format!("<td{}>{content}</td>", class(column))
        };
        let cells: Vec<String> = cells.iter().enumerate().map(cell).collect();
        format!("<tr>{}</tr>\n", cells.concat())
    };
    let (head, body) = (head.concat(), rows.iter().map(row).collect::<Vec<_>>().concat());
    let wide = if headers.len() > MOST_COLUMNS { " wide" } else { "" };
    format!(
        "<div class=\"table{wide}\"><table>\n<thead><tr>{head}</tr></thead>\n\
         <tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

fn badge(outcome: ClaimOutcome, text: &str) -> String {
    format!("<span class=\"badge {}\">{text}</span>", outcome.shown().1)
}

/// Counts of the outcomes in all tables; empty if there are none.
fn summary(report: &Report) -> String {
    let mut badges = String::new();
    for outcome in [ClaimOutcome::Pass, ClaimOutcome::Fail, ClaimOutcome::Warn] {
        let tables = report.blocks.iter().filter_map(|block| match block {
            ReportBlock::Table { rows, .. } => Some(rows),
            _ => None,
        });
        let count = tables.flatten().flatten().filter(|cell| **cell == outcome.into()).count();
        if count > 0 {
            badges.push_str(&badge(outcome, &format!("{count} {}", outcome.word())));
        }
    }
    if badges.is_empty() { badges } else { format!("<p class=\"summary\">{badges}</p>\n") }
}

/// Anchors used so far on the page.
#[derive(Debug, Default)]
struct Anchors(HashSet<String>);

impl Anchors {
    /// A lower-case anchor for `text` that no other text of the page has.
    fn unique(&mut self, text: &str) -> String {
        let mut slug = String::new();
        for character in text.chars() {
            if character.is_ascii_alphanumeric() {
                slug.push(character.to_ascii_lowercase());
            } else if !slug.is_empty() && !slug.ends_with('-') {
                slug.push('-');
            }
        }
        let slug = slug.trim_matches('-');
        let slug = if slug.is_empty() { "part" } else { slug };
        let mut anchor = slug.to_owned();
        let mut count = 1;
        while !self.0.insert(anchor.clone()) {
            count += 1;
            anchor = format!("{slug}-{count}");
        }
        anchor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_unique_on_the_page() {
        let svg = "<?xml version='1.0'?><svg width=\"85mm\"><clipPath id=\"c\"/>\
                   <g clip-path=\"url(#c)\"/><use href=\"#c\"/></svg>";
        let page = Report::new("R")
            .section("Same")
            .section("Same")
            .figure("same", "one", svg)
            .figure("f", "two", svg)
            .figure("f", "three", svg)
            .to_html();
        let ids: Vec<&str> =
            page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        let distinct: HashSet<&str> = ids.iter().copied().collect();
        assert_eq!(ids.len(), 2 + 3 + 3);
        assert_eq!(distinct.len(), ids.len(), "{ids:?}");
        for id in ["same-3--c", "f--c", "f-2--c"] {
            assert!(distinct.contains(id), "{ids:?}");
            assert!(page.contains(&format!("url(#{id})")) && page.contains(&format!("\"#{id}\"")));
        }
        assert!(!page.contains("<?xml"));
    }

    #[test]
    fn nothing_from_outside_is_markup() {
        let evil = "<script>alert('x')</script> & \"y\"";
        let page = Report::new(evil)
            .intro(evil)
            .section(evil)
            .paragraph(evil)
            .figure(evil, evil, "<svg/>")
            .table([evil], [vec![evil.into()]])
            .key_values([(evil, evil)])
            .to_html();
        assert!(!page.contains("<script") && !page.contains("alert('"));
        assert!(page.contains("&lt;script&gt;"));
    }
}
