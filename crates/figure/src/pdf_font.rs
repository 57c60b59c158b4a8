//! The bundled fonts in a PDF: embedded where a glyph of them is shown, with widths and characters.

use crate::{FigureError, text};
use flate2::{Compression, write::ZlibEncoder};
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use resvg::usvg::{self, fontdb, layout::PositionedGlyph};
use skrifa::{FontRef, GlyphId, MetadataProvider as _, instance::LocationRef, instance::Size};
use std::collections::BTreeMap;
use std::io::Write as _;

/// Objects of one font.
const OBJECTS: i32 = 5;
const SYSTEM: SystemInfo<'_> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The fonts of a page and the glyphs shown of each, with their characters.
pub(crate) struct Fonts<'a> {
    database: &'a fontdb::Database,
    /// Glyphs used of each of [`text::BUNDLED_FONTS`].
    used: [BTreeMap<u16, String>; 3],
    places: BTreeMap<fontdb::ID, Option<usize>>,
}

/// A glyph of a bundled font.
pub(crate) struct UsedFont {
    pub(crate) name: String,
    pub(crate) units_per_em: f32,
    pub(crate) glyph: u16,
}

/// The name of a font in the page and its object.
pub(crate) struct FontResources {
    pub(crate) name: String,
    pub(crate) object: Ref,
}

impl<'a> Fonts<'a> {
    pub(crate) fn new(tree: &'a usvg::Tree) -> Self {
        Self { database: tree.fontdb(), used: Default::default(), places: BTreeMap::new() }
    }

    /// Records a glyph as shown; the font that it is from.
    pub(crate) fn use_glyph(&mut self, glyph: &PositionedGlyph) -> Result<UsedFont, FigureError> {
        let database = self.database;
        let place = self.places.entry(glyph.font).or_insert_with(|| {
            let same = |data: &[u8]| text::BUNDLED_FONTS.iter().position(|font| font.data == data);
            database.with_face_data(glyph.font, |data, _| same(data)).flatten()
        });
        let index = place.ok_or(FigureError::NotInPdf { what: "fonts that are not bundled" })?;
        let id = u16::try_from(glyph.id.0);
        let id = id.map_err(|_| FigureError::NotInPdf { what: "glyphs beyond 65,535" })?;
        self.used[index].entry(id).or_insert_with(|| glyph.text.clone());
        let units_per_em = f32::from(metrics(&font(index)?).units_per_em);
        Ok(UsedFont { name: resource_name(index), units_per_em, glyph: id })
    }

    /// Writes the fonts used, as objects from `first` on.
    pub(crate) fn write(
        &self,
        pdf: &mut Pdf,
        first: i32,
    ) -> Result<Vec<FontResources>, FigureError> {
        let mut resources = Vec::new();
        let used = self.used.iter().enumerate().filter(|(_, used)| !used.is_empty());
        for ((index, glyphs), number) in used.zip(0..) {
            let object = first + OBJECTS * number;
            write(pdf, index, glyphs, object)?;
            resources.push(FontResources { name: resource_name(index), object: Ref::new(object) });
        }
        Ok(resources)
    }
}

fn resource_name(index: usize) -> String {
    format!("F{index}")
}

fn font(index: usize) -> Result<FontRef<'static>, FigureError> {
    FontRef::new(text::BUNDLED_FONTS[index].data)
        .map_err(|error| FigureError::Encoding { reason: error.to_string() })
}

fn metrics(font: &FontRef<'_>) -> skrifa::metrics::Metrics {
    font.metrics(Size::unscaled(), LocationRef::default())
}

/// One font: the composite font, its descendant, its descriptor, its file and its characters.
fn write(
    pdf: &mut Pdf,
    index: usize,
    glyphs: &BTreeMap<u16, String>,
    first: i32,
) -> Result<(), FigureError> {
    let [composite, descendant, descriptor, file, characters] =
        [0, 1, 2, 3, 4].map(|offset| Ref::new(first + offset));
    let name = Name([&b"Inter-Regular"[..], b"Inter-Bold", b"NotoSansMath-Regular"][index]);
    let data = text::BUNDLED_FONTS[index].data;
    // Both containers start with their kind: "OTTO" for the PostScript outlines.
    let postscript = data.starts_with(b"OTTO");
    let font = font(index)?;
    let metrics = metrics(&font);
    let em = 1000.0 / f32::from(metrics.units_per_em);

    pdf.type0_font(composite)
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(descendant)
        .to_unicode(characters);

    let mut cid = pdf.cid_font(descendant);
    cid.subtype(if postscript { CidFontType::Type0 } else { CidFontType::Type2 });
    cid.base_font(name).system_info(SYSTEM).font_descriptor(descriptor);
    if !postscript {
        cid.cid_to_gid_map_predefined(Name(b"Identity"));
    }
    let advances = font.glyph_metrics(Size::unscaled(), LocationRef::default());
    let mut widths = cid.widths();
    for &glyph in glyphs.keys() {
        let width = advances.advance_width(GlyphId::from(glyph)).unwrap_or_default();
        widths.same(glyph, glyph, width * em);
    }
    widths.finish();
    cid.finish();

    let bounds = metrics.bounds.unwrap_or_default();
    let bounds = [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|length| length * em);
    let mut described = pdf.font_descriptor(descriptor);
    described
        .name(name)
        .flags(FontFlags::NON_SYMBOLIC)
        .bbox(Rect::new(bounds[0], bounds[1], bounds[2], bounds[3]))
        .italic_angle(0.0)
        .ascent(metrics.ascent * em)
        .descent(metrics.descent * em)
        .cap_height(metrics.cap_height.unwrap_or(metrics.ascent) * em)
        .stem_v(if index == 1 { 140.0 } else { 90.0 });
    if postscript {
        described.font_file3(file);
    } else {
        described.font_file2(file);
    }
    described.finish();

    let packed = deflated(data)?;
    let mut stream = pdf.stream(file, &packed);
    stream.filter(Filter::FlateDecode);
    if postscript {
        stream.pair(Name(b"Subtype"), Name(b"OpenType"));
    } else {
        stream.pair(Name(b"Length1"), i32::try_from(data.len()).unwrap_or(i32::MAX));
    }
    stream.finish();

    let mut map = UnicodeCmap::new(Name(b"Custom"), SYSTEM);
    for (&glyph, text) in glyphs {
        map.pair_with_multiple(glyph, text.chars());
    }
    pdf.cmap(characters, &map.finish()).system_info(SYSTEM);
    Ok(())
}

/// Data as a stream of zlib.
pub(crate) fn deflated(data: &[u8]) -> Result<Vec<u8>, FigureError> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    let done = encoder.write_all(data).and_then(|()| encoder.finish());
    done.map_err(|error| FigureError::Encoding { reason: error.to_string() })
}
