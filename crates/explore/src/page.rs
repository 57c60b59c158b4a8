//! The page: HTML, style and script, inside the program.

use std::sync::LazyLock;

use asperity_figure::report::embedded_fonts;
use asperity_figure::{BUNDLED_FONTS, INTERACTIVE_SCRIPT};

/// The page.
pub(crate) const HTML: &str = include_str!("page/index.html");

const RULES: &str = include_str!("page/style.css");

/// The script of the page, an ES module.
pub(crate) const SCRIPT: &str = include_str!("page/explore.js");

/// The style of the page, with the fonts of the figures.
pub(crate) fn style() -> &'static str {
    static STYLE: LazyLock<String> = LazyLock::new(|| {
        let face = |(number, font): (usize, &asperity_figure::BundledFont)| {
            format!(
                "@font-face{{font-family:\"{}\";font-weight:{};src:url({})}}\n",
                font.family,
                font.weight,
                font_name(number)
            )
        };
        let fonts: String = BUNDLED_FONTS.iter().enumerate().map(face).collect();
        fonts + RULES
    });
    &STYLE
}

/// The script of the figures, an ES module.
pub(crate) fn figures() -> &'static str {
    static FIGURES: LazyLock<String> =
        LazyLock::new(|| format!("{INTERACTIVE_SCRIPT}\nexport {USED};\n"));
    &FIGURES
}

/// The page with everything in it, for a frame of another page.
pub(crate) fn framed() -> String {
    // The script of the figures in a scope of its own, as a module has.
    let figures =
        format!("const {USED} = (() => {{\n{INTERACTIVE_SCRIPT}\nreturn {USED};\n}})();\n");
    let script = SCRIPT.replace(&format!("import {USED} from \"./figures.js\";"), &figures);
    let style = format!("<style>{}{RULES}</style>", embedded_fonts());
    let script = format!("<script type=\"module\">\n{FRAME}{script}</script>");
    HTML.replace(STYLE_LINK, &style).replace(SCRIPT_LINK, &script)
}

/// Style and script that the page loads.
const STYLE_LINK: &str = "<link rel=\"stylesheet\" href=\"style.css\">";
const SCRIPT_LINK: &str = "<script type=\"module\" src=\"explore.js\"></script>";

/// Names of the script of the figures that the page uses.
const USED: &str = "{ clamp, interactive, make, placeOf, valueAt }";

/// The script that carries requests out of a frame.
const FRAME: &str = include_str!("page/frame.js");

/// File name of a font.
pub(crate) fn font_name(number: usize) -> String {
    format!("font-{number}.otf")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_a_frame_loads_nothing() {
        let page = framed();
        for loaded in ["href=\"style.css", "src=\"explore.js", "url(font-", "./figures.js"] {
            assert!(HTML.contains(loaded) || style().contains(loaded) || SCRIPT.contains(loaded));
            assert!(!page.contains(loaded), "{loaded}");
        }
    }
}
