//! Text: the bundled font, the width of a line, sub- and superscripts.

use crate::markup::{PX_PER_PT, escape, number};
use skrifa::{FontRef, MetadataProvider as _, instance::LocationRef, instance::Size};
use std::fmt::Write as _;
use std::sync::LazyLock;

/// Family name of the bundled font.
pub(crate) const FAMILY: &str = "Inter";
/// Inter Regular, subset (see `assets/LICENSE-fonts.txt`).
pub(crate) const REGULAR: &[u8] = include_bytes!("../assets/Inter-Regular.otf");
/// Inter Bold, subset (see `assets/LICENSE-fonts.txt`).
pub(crate) const BOLD: &[u8] = include_bytes!("../assets/Inter-Bold.otf");
/// Family name of the font for signs the first does not have.
pub(crate) const MATH_FAMILY: &str = "Noto Sans Math";
/// Noto Sans Math, subset (see `assets/LICENSE-fonts.txt`).
pub(crate) const MATH: &[u8] = include_bytes!("../assets/NotoSansMath-Regular.ttf");

/// A font of the figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BundledFont {
    /// Name of the family.
    pub family: &'static str,
    /// Weight of CSS: 400 regular, 700 bold.
    pub weight: u16,
    /// Its file, of the OpenType format.
    pub data: &'static [u8],
}

/// The fonts of the figures, for pages that show them.
pub const BUNDLED_FONTS: [BundledFont; 3] = [
    BundledFont { family: FAMILY, weight: 400, data: REGULAR },
    BundledFont { family: FAMILY, weight: 700, data: BOLD },
    BundledFont { family: MATH_FAMILY, weight: 400, data: MATH },
];

/// Font size of tick labels, notes and legends, 7 pt.
pub(crate) const LABEL_FONT: f64 = 7.0 * PX_PER_PT;
/// Font size of titles and tags, 8 pt.
pub(crate) const TITLE_FONT: f64 = 8.0 * PX_PER_PT;
/// Height of a capital over the font size.
pub(crate) const CAP_HEIGHT: f64 = 0.727;
/// Size of a sub- or superscript over the size of the text.
const SCRIPT_SIZE: f64 = 0.7;
/// Rise of a superscript over the font size.
const SUPER_RISE: f64 = 0.36;
/// Drop of a subscript over the font size.
const SUB_DROP: f64 = 0.18;
/// Width taken for a character the font does not have, over the font size.
const UNKNOWN_WIDTH: f64 = 0.65;

/// A run of text on one level: `rise` 0 on the line, positive above, negative below.
#[derive(Debug, Clone, PartialEq)]
struct TextRun {
    text: String,
    rise: i8,
}

/// Splits `_{...}` and `^{...}` from the text around them; an unclosed brace is plain text.
fn runs(content: &str) -> Vec<TextRun> {
    let mut runs = Vec::new();
    let mut plain = String::new();
    let mut rest = content;
    while let Some(character) = rest.chars().next() {
        let script = match rest.get(..2) {
            Some("_{") => Some(-1),
            Some("^{") => Some(1),
            _ => None,
        };
        if let (Some(rise), Some(end)) = (script, rest.find('}')) {
            runs.push(TextRun { text: std::mem::take(&mut plain), rise: 0 });
            runs.push(TextRun { text: rest[2..end].to_owned(), rise });
            rest = &rest[end + 1..];
        } else {
            plain.push(character);
            rest = &rest[character.len_utf8()..];
        }
    }
    runs.push(TextRun { text: plain, rise: 0 });
    runs.retain(|run| !run.text.is_empty());
    runs
}

/// The content of an SVG text element, escaped.
pub(crate) fn spans(content: &str, size: f64) -> String {
    let mut spans = String::new();
    let mut height = 0.0;
    for run in runs(content) {
        let target = match run.rise {
            1 => SUPER_RISE * size,
            -1 => -SUB_DROP * size,
            _ => 0.0,
        };
        let text = escape(&run.text);
        let shift = height - target;
        if run.rise == 0 && shift == 0.0 {
            spans.push_str(&text);
        } else {
            let font = if run.rise == 0 { size } else { size * SCRIPT_SIZE };
            let (shift, font) = (number(shift), number(font));
            // Writing to a String cannot fail.
            let _ = write!(spans, r#"<tspan dy="{shift}" font-size="{font}">{text}</tspan>"#);
        }
        height = target;
    }
    spans
}

/// The content of an HTML element, escaped, with `<sub>` and `<sup>`.
pub(crate) fn tagged(content: &str, escape: impl Fn(&str) -> String) -> String {
    runs(content)
        .iter()
        .map(|run| match (run.rise, escape(&run.text)) {
            (1, text) => format!("<sup>{text}</sup>"),
            (-1, text) => format!("<sub>{text}</sub>"),
            (_, text) => text,
        })
        .collect()
}

/// Width of a line of text in the bundled font, in the unit of `size`.
pub(crate) fn width(content: &str, size: f64) -> f64 {
    runs(content)
        .iter()
        .map(|run| {
            let size = if run.rise == 0 { size } else { size * SCRIPT_SIZE };
            run.text.chars().map(advance).sum::<f64>() * size
        })
        .sum()
}

/// Width of a character over the size of the font.
fn advance(character: char) -> f64 {
    /// Widths of Latin and Greek characters, which labels are made of.
    static KNOWN: LazyLock<Vec<f64>> =
        LazyLock::new(|| ('\0'..'\u{400}').map(measured_advance).collect());
    let known = KNOWN.get(character as usize).copied();
    known.unwrap_or_else(|| measured_advance(character))
}

fn measured_advance(character: char) -> f64 {
    let width = [REGULAR, MATH].map(FontRef::new).into_iter().flatten().find_map(|font| {
        let glyph = font.charmap().map(character)?;
        font.glyph_metrics(Size::new(1.0), LocationRef::default()).advance_width(glyph)
    });
    width.map_or(UNKNOWN_WIDTH, f64::from)
}

/// Width of the widest of the labels of marks, in the label font.
pub(crate) fn widest(marks: &[(f64, String)]) -> f64 {
    marks.iter().map(|mark| width(&mark.1, LABEL_FONT)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_split_and_escaped() {
        assert_eq!(spans("a<b", 10.0), "a&lt;b");
        assert_eq!(
            spans("10^{3} N", 10.0),
            r#"10<tspan dy="-3.6" font-size="7">3</tspan><tspan dy="3.6" font-size="10"> N</tspan>"#
        );
        assert_eq!(spans("k_c and k_{c", 10.0), "k_c and k_{c");
    }

    #[test]
    fn width_follows_the_font() {
        // Digits of Inter are 1308 to 1808 of 2816 units wide.
        let digits = width("0123456789", 2816.0);
        assert!((13_080.0..18_080.0).contains(&digits), "{digits}");
        assert!(width("x^{2}", 10.0) < width("x2", 10.0));
    }

    #[test]
    fn the_fonts_have_the_signs_labels_need() {
        let needed = "µ°±×·−–—≤≥≈≠∞√∂∇∫∑∏→←↔αβγδεζηθκλμνξπρστφχψωΓΔΘΛΣΦΨΩ₀₁₂₃₄₅₆₇₈₉ₙₐₑₓᵣᵥ\
                      ⁰¹²³⁴⁵⁶⁷⁸⁹⁻✓✗|∥⊥∝∼≪≫∈⟨⟩𝑘𝑝𝜔𝜁";
        for text in [REGULAR, BOLD] {
            let fonts = [FontRef::new(text).unwrap(), FontRef::new(MATH).unwrap()];
            for character in needed.chars() {
                let found = fonts.iter().any(|font| font.charmap().map(character).is_some());
                assert!(found, "no glyph for {character}");
            }
        }
    }
}
