//! SVG text of shapes in CSS pixels, written and read.

use crate::{
    Color, FigureError,
    markup::{PX_PER_MM, escape, number},
    text,
};
use resvg::usvg;
use std::fmt::Write as _;
use std::sync::Arc;

/// Horizontal alignment of a text on its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    /// The text starts at the point.
    Left,
    /// The text is centred on the point.
    Center,
    /// The text ends at the point.
    Right,
}

/// Size, weight, alignment and colour of a text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TextStyle {
    pub(crate) size: f64,
    pub(crate) bold: bool,
    pub(crate) align: Align,
    pub(crate) color: Color,
    /// Degrees, anticlockwise.
    pub(crate) turn: f64,
    /// A white rim that keeps the text legible over lines.
    pub(crate) halo: bool,
}

impl TextStyle {
    pub(crate) fn new(size: f64, align: Align) -> Self {
        Self { size, bold: false, align, color: Color::BLACK, turn: 0.0, halo: false }
    }

    pub(crate) fn turned(mut self, degrees: f64) -> Self {
        self.turn = degrees;
        self
    }

    pub(crate) fn bold(mut self) -> Self {
        self.bold = true;
        self
    }

    pub(crate) fn color(mut self, color: Color) -> Self {
        self.color = color;
        self
    }

    pub(crate) fn halo(mut self) -> Self {
        self.halo = true;
        self
    }
}

/// An SVG document in the making; lengths in CSS pixels, y downwards.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Canvas {
    body: String,
    /// True where the parts that a zoom replaces are grouped.
    grouped: bool,
}

impl Canvas {
    /// A document in which the parts of a panel that a zoom replaces are grouped.
    pub(crate) fn grouped() -> Self {
        Self { grouped: true, ..Self::default() }
    }

    pub(crate) fn is_grouped(&self) -> bool {
        self.grouped
    }

    /// Opens a group of panel `number`, in a document with groups.
    pub(crate) fn open(&mut self, number: usize) {
        if self.grouped {
            self.element(format_args!(r#"<g data-panel="{number}">"#));
        }
    }

    /// Closes the group opened last.
    pub(crate) fn close(&mut self) {
        if self.grouped {
            self.element(format_args!("</g>"));
        }
    }

    /// Adds one element; writing to a `String` cannot fail.
    fn element(&mut self, arguments: std::fmt::Arguments<'_>) {
        let _ = self.body.write_fmt(arguments);
        self.body.push('\n');
    }

    /// A path with `data` and the attributes `style`.
    pub(crate) fn path(&mut self, data: &str, style: &str) {
        if !data.is_empty() {
            self.element(format_args!(r#"<path d="{data}" {style}/>"#));
        }
    }

    /// A rectangle by its corner and size.
    pub(crate) fn rectangle(&mut self, x: f64, y: f64, width: f64, height: f64, style: &str) {
        let [x, y, width, height] = [x, y, width, height].map(number);
        self.element(format_args!(
            r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" {style}/>"#
        ));
    }

    /// A text with its baseline at `(x, y)`; `_{}` and `^{}` are set low and high.
    pub(crate) fn text(&mut self, x: f64, y: f64, content: &str, style: TextStyle) {
        if content.is_empty() {
            return;
        }
        let mut attributes = format!(r#"font-size="{}""#, number(style.size));
        match style.align {
            Align::Left => {}
            Align::Center => attributes.push_str(r#" text-anchor="middle""#),
            Align::Right => attributes.push_str(r#" text-anchor="end""#),
        }
        if style.bold {
            attributes.push_str(r#" font-weight="700""#);
        }
        if style.color != Color::BLACK {
            let _ = write!(attributes, r#" fill="{}""#, style.color);
        }
        if style.halo {
            let width = number(style.size * 0.28);
            let _ = write!(
                attributes,
                r##" stroke="#ffffff" stroke-width="{width}" stroke-linejoin="round" paint-order="stroke""##
            );
        }
        if style.turn != 0.0 {
            let (turn, x, y) = (number(-style.turn), number(x), number(y));
            let _ = write!(attributes, r#" transform="rotate({turn} {x} {y})""#);
        }
        let spans = text::spans(content, style.size);
        let (x, y) = (number(x), number(y));
        self.element(format_args!(r#"<text x="{x}" y="{y}" {attributes}>{spans}</text>"#));
    }

    /// The document, `width` by `height`, with an accessible title.
    pub(crate) fn finish(self, width: f64, height: f64, title: &str) -> String {
        let [width_mm, height_mm] = [width / PX_PER_MM, height / PX_PER_MM].map(number);
        let [width, height] = [width, height].map(number);
        let title = escape(title);
        let family = format!("{}, {}", text::FAMILY, text::MATH_FAMILY);
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width_mm}mm" height="{height_mm}mm" viewBox="0 0 {width} {height}" font-family="{family}, Helvetica, Arial, sans-serif" role="img">
<title>{title}</title>
<rect width="{width}" height="{height}" fill="#ffffff"/>
{}</svg>
"##,
            self.body
        )
    }
}

/// Reads an SVG text. Fonts other than the bundled ones are ignored, so that the shapes are the same
/// on every machine.
pub(crate) fn parse(svg: &str) -> Result<usvg::Tree, FigureError> {
    let mut fonts = usvg::fontdb::Database::new();
    for font in text::BUNDLED_FONTS {
        fonts.load_font_data(font.data.to_vec());
    }
    fonts.set_sans_serif_family(text::FAMILY);
    fonts.set_serif_family(text::FAMILY);
    fonts.set_monospace_family(text::FAMILY);
    let options = usvg::Options {
        font_family: text::FAMILY.to_owned(),
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    };
    usvg::Tree::from_str(svg, &options)
        .map_err(|error| FigureError::InvalidSvg { reason: error.to_string() })
}
