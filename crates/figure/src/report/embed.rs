//! Content embedded in an HTML page: pictures with unique identifiers, and the fonts.

use crate::text::{self, BundledFont};

/// The `svg` element with its identifiers and the references to them prefixed.
pub(super) fn inline(svg: &str, prefix: &str) -> String {
    let element = svg.find("<svg").map_or("", |start| &svg[start..]);
    let mut text = element.to_owned();
    for (from, end) in [(" id=", ""), ("href=", "#"), ("url(", "#")] {
        for quote in ["\"", "'", ""] {
            // Unquoted references occur in url(#id) only.
            if quote.is_empty() && from != "url(" {
                continue;
            }
            let opening = format!("{from}{quote}{end}");
            text = text.replace(&opening, &format!("{opening}{prefix}--"));
        }
    }
    text
}

/// The width an SVG text gives itself in millimetres.
pub(super) fn paper_width(svg: &str) -> Option<f64> {
    let head = svg.get(..svg.find('>')?)?;
    let rest = head.split_once(" width=\"")?.1;
    let value: f64 = rest.split_once("mm\"")?.0.parse().ok()?;
    (value > 0.0 && value.is_finite()).then_some(value)
}

/// The bundled fonts as style rules of a page, with their data.
pub fn embedded_fonts() -> String {
    text::BUNDLED_FONTS.iter().map(font_face).collect()
}

fn font_face(font: &BundledFont) -> String {
    let BundledFont { family, weight, data } = font;
    // Both containers start with their kind: "OTTO" for the PostScript outlines.
    let kind = if data.starts_with(b"OTTO") { "otf" } else { "ttf" };
    let data = base64(data);
    format!(
        "@font-face{{font-family:\"{family}\";font-weight:{weight};\
         src:url(data:font/{kind};base64,{data})}}\n"
    )
}

/// Base 64 with padding (RFC 4648).
fn base64(data: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(data.len().div_ceil(3) * 4);
    for chunk in data.chunks(3) {
        let byte = |index: usize| u32::from(chunk.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            text.push(if digit <= chunk.len() {
                char::from(DIGITS[(bits >> (18 - 6 * digit) & 63) as usize])
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_follows_the_standard() {
        // RFC 4648, section 10.
        for (data, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(data.as_bytes()), text);
        }
    }
}
