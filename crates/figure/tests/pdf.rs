//! PDF pages as other programs read them.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stderr, reason = "a test without its program says that it was skipped")]

use std::path::Path;
use std::process::Command;

use asperity_figure::{
    Axis, Color, Dash, Figure, FigureError, Marker, Panel, Series, svg_to_pdf, svg_to_png,
};

/// Curves, dashes, bands, markers, notes with a rim, turned titles, scripts and mathematical signs.
fn figure() -> Figure {
    let x: Vec<f64> = (0..200).map(f64::from).collect();
    let y: Vec<f64> = x.iter().map(|x| (0.07 * x).sin() + 1.3).collect();
    let low: Vec<f64> = y.iter().map(|y| y - 0.2).collect();
    let panel = Panel::new(Axis::linear("Frequency", "Hz"), Axis::log("Receptance 𝑘_{n}", "µm/N"))
        .series(Series::band("band", &x, &low, &y).color(Color::BLUE))
        .series(Series::line("model", &x, &y).color(Color::BLUE).dash(Dash::Dashed))
        .series(Series::points("measured", [20.0, 60.0], [1.0, 2.0]).marker(Marker::Diamond))
        .vertical(100.0, "f_{1}")
        .note(60.0, 2.0, "875.5 Hz");
    Figure::new("Page").panel(panel).width_mm(100.0).row_height_mm(70.0)
}

/// Output of a program, or none where it is not installed.
fn output(program: &str, arguments: &[&Path]) -> Option<Vec<u8>> {
    let output = Command::new(program).args(arguments).output().ok()?;
    assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
    Some(output.stdout)
}

/// Width, height and bytes of a binary portable pixmap.
fn pixmap(data: &[u8]) -> (usize, usize, &[u8]) {
    let mut rest = data;
    let mut numbers = Vec::new();
    for _ in 0..4 {
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap();
        numbers.push(std::str::from_utf8(&rest[..end]).unwrap());
        rest = &rest[end + 1..];
    }
    assert_eq!((numbers[0], numbers[3]), ("P6", "255"));
    (numbers[1].parse().unwrap(), numbers[2].parse().unwrap(), rest)
}

#[test]
fn a_page_has_the_size_of_the_figure_and_the_same_bytes_each_time() {
    let pdf = figure().to_pdf().unwrap();
    assert_eq!(pdf, figure().to_pdf().unwrap());
    assert!(pdf.starts_with(b"%PDF-1.7") && pdf.trim_ascii_end().ends_with(b"%%EOF"));
    let text = String::from_utf8_lossy(&pdf);
    let sizes = text.split_once("/MediaBox [").unwrap().1.split_once(']').unwrap().0;
    let sizes: Vec<f64> = sizes.split(' ').map(|size| size.parse().unwrap()).collect();
    // 72 points an inch; lengths in the SVG text are rounded to 0.01 mm.
    for (size, mm) in sizes.iter().zip([0.0, 0.0, 100.0, 70.0]) {
        assert!((size - mm * 72.0 / 25.4).abs() < 0.03, "{sizes:?}");
    }
    assert!(text.contains("/FontFile3") && text.contains("/FontFile2"));
}

#[test]
fn fonts_without_a_glyph_on_the_page_are_left_out() {
    let pdf = svg_to_pdf("<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm'/>");
    assert!(!String::from_utf8_lossy(&pdf.unwrap()).contains("/FontFile"));
}

#[test]
fn what_has_no_pdf_form_is_refused_by_name() {
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm'>\
               <rect width='9' height='9' opacity='0.5'/></svg>";
    let refused = svg_to_pdf(svg).unwrap_err();
    assert!(matches!(refused, FigureError::NotInPdf { .. }));
    assert!(refused.to_string().contains("transparency"));
}

#[test]
fn another_program_reads_the_texts_and_draws_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (page, image) = (folder.path().join("page.pdf"), folder.path().join("page.ppm"));
    let svg = figure().to_svg();
    std::fs::write(&page, svg_to_pdf(&svg).unwrap()).unwrap();
    let Some(words) = output("pdftotext", &["-raw".as_ref(), &page, "-".as_ref()]) else {
        eprintln!("skipped: pdftotext is not installed");
        return;
    };
    let words = String::from_utf8(words).unwrap();
    for word in ["Frequency (Hz)", "875.5 Hz", "measured", "model", "𝑘"] {
        assert!(words.contains(word), "{word} is not in {words}");
    }

    let mut drawn = Command::new("pdftoppm");
    drawn.args(["-scale-to-x", "1000", "-scale-to-y", "700", "-singlefile"]);
    let drawn = drawn.arg(&page).arg(image.with_extension("")).status();
    assert!(drawn.is_ok_and(|status| status.success()));
    let data = std::fs::read(&image).unwrap();
    let (width, height, theirs) = pixmap(&data);
    assert_eq!((width, height), (1000, 700));
    let png = resvg::tiny_skia::Pixmap::decode_png(&svg_to_png(&svg, 10.0).unwrap()).unwrap();
    let ours = png.data().chunks(4).flat_map(|pixel| &pixel[..3]);
    let mut far = 0;
    for (ours, theirs) in ours.zip(theirs) {
        far += usize::from(ours.abs_diff(*theirs) > 128);
    }
    let share = far as f64 / theirs.len() as f64;
    assert!(share < 0.002, "{far} of {} samples differ", theirs.len());
}
