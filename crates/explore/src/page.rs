//! The page: HTML, style and script, inside the program.

use std::sync::LazyLock;

use asperity_figure::{BUNDLED_FONTS, INTERACTIVE_SCRIPT};

/// The page.
pub(crate) const HTML: &str = include_str!("page/index.html");

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
        fonts + include_str!("page/style.css")
    });
    &STYLE
}

/// The script of the figures, an ES module.
pub(crate) fn figures() -> &'static str {
    static FIGURES: LazyLock<String> = LazyLock::new(|| {
        format!("{INTERACTIVE_SCRIPT}\nexport {{ clamp, interactive, make, placeOf, valueAt }};\n")
    });
    &FIGURES
}

/// File name of a font.
pub(crate) fn font_name(number: usize) -> String {
    format!("font-{number}.otf")
}
