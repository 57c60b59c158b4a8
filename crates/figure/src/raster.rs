//! SVG to PNG with the bundled fonts alone.

use crate::{FigureError, markup::PX_PER_MM, svg};
use resvg::tiny_skia;

/// Pixels beyond which a picture is refused.
const MOST_PIXELS: f64 = 4e8;

/// Rasterises an SVG text on white.
///
/// `pixels_per_mm` is the resolution (12 is about 300 dpi). Fonts other than the bundled ones are
/// ignored, so that the picture is the same on every machine.
///
/// ```
/// let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="10mm" height="5mm"/>"#;
/// let png = asperity_figure::svg_to_png(svg, 12.0)?;
/// assert!(png.starts_with(b"\x89PNG"));
/// # Ok::<(), asperity_figure::FigureError>(())
/// ```
///
/// # Errors
/// [`FigureError::InvalidSvg`], [`FigureError::PictureSize`] or [`FigureError::Encoding`].
pub fn svg_to_png(svg: &str, pixels_per_mm: f64) -> Result<Vec<u8>, FigureError> {
    let tree = svg::parse(svg)?;
    let scale = pixels_per_mm / PX_PER_MM;
    let width = (f64::from(tree.size().width()) * scale).round();
    let height = (f64::from(tree.size().height()) * scale).round();
    let refused = FigureError::PictureSize { width, height };
    if !(width >= 1.0 && height >= 1.0 && width * height <= MOST_PIXELS) {
        return Err(refused);
    }
    let mut pixmap = tiny_skia::Pixmap::new(width as u32, height as u32).ok_or(refused)?;
    pixmap.fill(tiny_skia::Color::WHITE);
    let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| FigureError::Encoding { reason: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_is_no_picture() {
        assert!(matches!(svg_to_png("<svg", 10.0), Err(FigureError::InvalidSvg { .. })));
        let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='10mm' height='10mm'/>";
        assert!(matches!(svg_to_png(svg, 0.0), Err(FigureError::PictureSize { .. })));
        assert!(matches!(svg_to_png(svg, f64::NAN), Err(FigureError::PictureSize { .. })));
        assert!(matches!(svg_to_png(svg, 1e9), Err(FigureError::PictureSize { .. })));
    }
}
