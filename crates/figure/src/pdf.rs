//! SVG to PDF: paths as paths, text as text in the bundled fonts.

use crate::{
    FigureError,
    markup::PX_PER_PT,
    pdf_font::{FontResources, Fonts, deflated},
    svg,
};
use pdf_writer::types::{LineCapStyle, LineJoinStyle, TextRenderingMode};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use resvg::usvg::{self, Group, Node, Paint, tiny_skia_path};
use tiny_skia_path::{PathSegment, Transform};

/// The catalogue, the page tree, the page and its content; fonts follow.
const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const FIRST_FONT: i32 = 5;

/// One PDF page of the size of an SVG text.
///
/// Paths and solid colours are drawn as such and text stays text, set in the bundled fonts, which
/// are embedded. The same text gives the same bytes on every machine.
///
/// ```
/// let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="10mm" height="5mm"/>"#;
/// let pdf = asperity_figure::svg_to_pdf(svg)?;
/// assert!(pdf.starts_with(b"%PDF-1.7"));
/// # Ok::<(), asperity_figure::FigureError>(())
/// ```
///
/// # Errors
/// [`FigureError::InvalidSvg`]; [`FigureError::NotInPdf`] for gradients, patterns, pictures, clips,
/// masks, filters and transparency, which no figure of this crate holds.
pub fn svg_to_pdf(svg: &str) -> Result<Vec<u8>, FigureError> {
    let tree = svg::parse(svg)?;
    let scale = (1.0 / PX_PER_PT) as f32;
    let (width, height) = (tree.size().width() * scale, tree.size().height() * scale);
    let mut page = Page { content: Content::new(), fonts: Fonts::new(&tree) };
    // SVG counts downwards in pixels, PDF upwards in points.
    page.content.transform([scale, 0.0, 0.0, -scale, 0.0, height]);
    page.group(tree.root())?;

    let mut pdf = Pdf::new();
    pdf.catalog(CATALOG).pages(PAGES);
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let resources = page.fonts.write(&mut pdf, FIRST_FONT)?;
    let mut described = pdf.page(PAGE);
    described.parent(PAGES).media_box(Rect::new(0.0, 0.0, width, height)).contents(CONTENT);
    let mut listed = described.resources();
    let mut fonts = listed.fonts();
    for FontResources { name, object } in &resources {
        fonts.pair(Name(name.as_bytes()), *object);
    }
    fonts.finish();
    listed.finish();
    described.finish();
    pdf.stream(CONTENT, &deflated(&page.content.finish())?).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}

/// The page being drawn.
struct Page<'a> {
    content: Content,
    fonts: Fonts<'a>,
}

impl Page<'_> {
    fn group(&mut self, group: &Group) -> Result<(), FigureError> {
        let plain = group.opacity().get() == 1.0
            && group.clip_path().is_none()
            && group.mask().is_none()
            && group.filters().is_empty();
        if !plain {
            return Err(FigureError::NotInPdf { what: "clips, masks, filters and transparency" });
        }
        group.children().iter().try_for_each(|node| match node {
            Node::Group(group) => self.group(group),
            Node::Path(path) if !path.is_visible() => Ok(()),
            Node::Path(path) => self.path(path),
            Node::Text(text) => self.text(text),
            Node::Image(_) => Err(FigureError::NotInPdf { what: "pictures" }),
        })
    }

    fn path(&mut self, path: &usvg::Path) -> Result<(), FigureError> {
        self.content.save_state();
        self.content.transform(matrix(path.abs_transform()));
        let fill = path.fill().map(|fill| self.fill_color(fill)).transpose()?;
        let stroke = path.stroke().map(|stroke| self.stroke_style(stroke)).transpose()?;
        self.outline(path.data());
        match (fill, stroke) {
            (None, None) => self.content.end_path(),
            (None, Some(())) => self.content.stroke(),
            (Some(usvg::FillRule::NonZero), None) => self.content.fill_nonzero(),
            (Some(usvg::FillRule::EvenOdd), None) => self.content.fill_even_odd(),
            (Some(usvg::FillRule::NonZero), Some(())) => self.content.fill_nonzero_and_stroke(),
            (Some(usvg::FillRule::EvenOdd), Some(())) => self.content.fill_even_odd_and_stroke(),
        };
        self.content.restore_state();
        Ok(())
    }

    fn outline(&mut self, path: &tiny_skia_path::Path) {
        let mut last = tiny_skia_path::Point::zero();
        for segment in path.segments() {
            match segment {
                PathSegment::MoveTo(to) => {
                    self.content.move_to(to.x, to.y);
                    last = to;
                }
                PathSegment::LineTo(to) => {
                    self.content.line_to(to.x, to.y);
                    last = to;
                }
                PathSegment::QuadTo(by, to) => {
                    // A quadratic as a cubic: its control points lie two thirds of the way to `by`.
                    let third = |a: f32, b: f32| a + 2.0 / 3.0 * (b - a);
                    let (x1, y1) = (third(last.x, by.x), third(last.y, by.y));
                    let (x2, y2) = (third(to.x, by.x), third(to.y, by.y));
                    self.content.cubic_to(x1, y1, x2, y2, to.x, to.y);
                    last = to;
                }
                PathSegment::CubicTo(a, b, to) => {
                    self.content.cubic_to(a.x, a.y, b.x, b.y, to.x, to.y);
                    last = to;
                }
                PathSegment::Close => {
                    self.content.close_path();
                }
            }
        }
    }

    fn text(&mut self, text: &usvg::Text) -> Result<(), FigureError> {
        for span in text.layouted().iter().filter(|span| span.visible) {
            // The rim of a text lies under its fill.
            if let Some(stroke) = &span.stroke {
                self.content.save_state();
                self.stroke_style(stroke)?;
                self.glyphs(text, span, TextRenderingMode::Stroke)?;
                self.content.restore_state();
            }
            if let Some(fill) = &span.fill {
                self.content.save_state();
                self.fill_color(fill)?;
                self.glyphs(text, span, TextRenderingMode::Fill)?;
                self.content.restore_state();
            }
        }
        Ok(())
    }

    fn glyphs(
        &mut self,
        text: &usvg::Text,
        span: &usvg::layout::Span,
        mode: TextRenderingMode,
    ) -> Result<(), FigureError> {
        self.content.begin_text();
        self.content.set_text_rendering_mode(mode);
        let mut current = None;
        for glyph in &span.positioned_glyphs {
            let font = self.fonts.use_glyph(glyph)?;
            if current.as_ref() != Some(&font.name) {
                self.content.set_font(Name(font.name.as_bytes()), 1.0);
                current = Some(font.name.clone());
            }
            let em = font.units_per_em;
            let place = text.abs_transform().pre_concat(glyph.outline_transform());
            self.content.set_text_matrix(matrix(place.pre_scale(em, em)));
            self.content.show(Str(&font.glyph.to_be_bytes()));
        }
        self.content.end_text();
        Ok(())
    }

    fn fill_color(&mut self, fill: &usvg::Fill) -> Result<usvg::FillRule, FigureError> {
        let [red, green, blue] = color(fill.paint(), fill.opacity())?;
        self.content.set_fill_rgb(red, green, blue);
        Ok(fill.rule())
    }

    fn stroke_style(&mut self, stroke: &usvg::Stroke) -> Result<(), FigureError> {
        let [red, green, blue] = color(stroke.paint(), stroke.opacity())?;
        self.content.set_stroke_rgb(red, green, blue);
        self.content.set_line_width(stroke.width().get());
        self.content.set_line_cap(match stroke.linecap() {
            usvg::LineCap::Butt => LineCapStyle::ButtCap,
            usvg::LineCap::Round => LineCapStyle::RoundCap,
            usvg::LineCap::Square => LineCapStyle::ProjectingSquareCap,
        });
        self.content.set_line_join(match stroke.linejoin() {
            usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => LineJoinStyle::MiterJoin,
            usvg::LineJoin::Round => LineJoinStyle::RoundJoin,
            usvg::LineJoin::Bevel => LineJoinStyle::BevelJoin,
        });
        self.content.set_miter_limit(stroke.miterlimit().get());
        if let Some(lengths) = stroke.dasharray() {
            self.content.set_dash_pattern(lengths.iter().copied(), stroke.dashoffset());
        }
        Ok(())
    }
}

/// Red, green and blue of an opaque colour, from 0 to 1.
fn color(paint: &Paint, opacity: usvg::Opacity) -> Result<[f32; 3], FigureError> {
    match paint {
        Paint::Color(color) if opacity.get() == 1.0 => {
            Ok([color.red, color.green, color.blue].map(|part| f32::from(part) / 255.0))
        }
        Paint::Color(_) => Err(FigureError::NotInPdf { what: "transparency" }),
        _ => Err(FigureError::NotInPdf { what: "gradients and patterns" }),
    }
}

fn matrix(transform: Transform) -> [f32; 6] {
    let Transform { sx, kx, ky, sy, tx, ty } = transform;
    [sx, ky, kx, sy, tx, ty]
}
