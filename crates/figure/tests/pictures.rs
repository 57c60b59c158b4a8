//! Figures as a reader gets them: sizes, determinism, refusals, what is on the page.

use asperity_figure::{
    Axis, Color, ColorBar, Figure, FigureError, Legend, Marker, Panel, Series, svg_to_png,
};

fn axes() -> Panel {
    Panel::new(Axis::linear("Time", "s"), Axis::linear("Force", "N"))
}

/// Width and height from the header of a PNG.
fn pixels(png: &[u8]) -> (u32, u32) {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]);
    (number(16), number(20))
}

fn noise(index: u32) -> f64 {
    f64::from(index.wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24) - 0.5
}

#[test]
fn a_picture_has_the_pixels_asked_for() {
    let figure = Figure::new("F")
        .width_mm(85.0)
        .row_height_mm(60.0)
        .panel(axes().series(Series::line("a", [0.0, 1.0], [0.0, 1.0])));
    assert_eq!(pixels(&figure.to_png(10.0).unwrap()), (850, 600));
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='40mm' height='20mm'/>";
    assert_eq!(pixels(&svg_to_png(svg, 12.0).unwrap()), (480, 240));
}

#[test]
fn text_leaves_ink_without_system_fonts() {
    let picture = |note: &str| Figure::new("F").panel(axes().note(0.5, 0.5, note)).to_png(8.0);
    assert_ne!(picture("").unwrap(), picture("k_{n} ∝ 𝑝^{1/2} µm").unwrap());
}

#[test]
fn the_same_numbers_give_the_same_bytes() {
    let draw = || {
        let x: Vec<f64> = (0..5000).map(f64::from).collect();
        let y: Vec<f64> = (0..5000).map(noise).collect();
        let points = Series::points("p", &x, &y).marker(Marker::Cross);
        let figure =
            Figure::new("F").panel(axes().series(Series::line("l", &x, &y)).series(points));
        (figure.to_svg(), figure.to_png(4.0).unwrap())
    };
    assert_eq!(draw(), draw());
}

#[test]
fn dense_series_stay_small() {
    let x: Vec<f64> = (0..24_000).map(f64::from).collect();
    let level = |k: u32| -> Vec<f64> { (0..24_000).map(|i| noise(i + 7919 * k)).collect() };
    let panel = axes().all_series((0..8).map(|k| Series::line(format!("level {k}"), &x, level(k))));
    let svg = Figure::new("F").panel(panel).to_svg();
    // Eight curves of 24 000 points of white noise, the worst that can be asked for.
    assert!(svg.len() < 300_000, "{} bytes", svg.len());
}

#[test]
fn gaps_are_left_where_there_is_no_number() {
    let x = [0.0, 1.0, 2.0, 3.0, 4.0];
    let y = [1.0, 2.0, f64::NAN, f64::INFINITY, 1.0];
    let broken = Figure::new("F").panel(axes().series(Series::line("a", x, y)));
    assert!(broken.check().is_ok());
    let svg = broken.to_svg();
    assert!(svg.contains("h0.01"), "the lone last point is a dot");
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn what_cannot_be_drawn_is_refused_and_named() {
    let empty = Series::line("nothing", [f64::NAN], [1.0]);
    let negative = Series::line("negative", [1.0, 2.0], [-1.0, 0.0]);
    let unequal = Series::line("unequal", [1.0, 2.0], [1.0]);
    let log = || Panel::new(Axis::linear("x", ""), Axis::log("y", ""));
    let refused = |panel: Panel| {
        let figure = Figure::new("F").panel(panel);
        // Shown in red where it would have been drawn.
        assert!(figure.to_svg().contains(&Color::RED.to_string()));
        figure.to_png(5.0).unwrap_err()
    };
    assert_eq!(
        refused(axes().series(empty)),
        FigureError::EmptySeries { series: "nothing".into() }
    );
    assert_eq!(
        refused(log().series(negative)),
        FigureError::EmptySeries { series: "negative".into() }
    );
    assert!(matches!(
        refused(axes().series(unequal)),
        FigureError::SeriesLengths { x: 2, y: 1, .. }
    ));
    let backwards = Panel::new(Axis::linear("x", "").range(1.0, 0.0), Axis::linear("y", ""));
    assert!(matches!(refused(backwards), FigureError::AxisRange { .. }));
    assert!(matches!(Figure::new("F").check(), Err(FigureError::NoPanel { .. })));
    assert!(Figure::new("F").to_svg().starts_with("<svg"));
}

#[test]
fn text_is_escaped_and_panels_are_tagged() {
    let panel = || {
        axes()
            .series(Series::line("<b>&", [0.0, 1.0], [0.0, 1.0]))
            .note(0.5, 0.5, "a < \"b\"")
            .title("]]>")
    };
    let svg = Figure::new("</title>").panel(panel()).panel(panel()).to_svg();
    assert!(svg.contains("&lt;b&gt;&amp;") && svg.contains("a &lt; &quot;b&quot;"));
    assert!(svg.contains("<title>&lt;/title&gt;</title>"));
    assert!(svg.contains(">(a)<") && svg.contains(">(b)<"));
    assert!(!svg.contains(" id=\""), "nothing to collide when several figures share a page");
    assert!(svg_to_png(&svg, 4.0).is_ok());
}

/// A band inside another of the same colour is told from it, in the panel and in the legend.
#[test]
fn a_band_inside_another_is_darker() {
    let band = |name: &str, half: f64| {
        Series::band(name, [0.0, 1.0], [-half, -half], [half, half]).color(Color::BLUE)
    };
    let panel = axes().series(band("outer", 1.0)).series(band("inner", 0.4).lightness(0.5));
    let svg = Figure::new("F").panel(panel).to_svg();
    for share in [0.78, 0.5] {
        let fill = format!("fill=\"{}\"", Color::BLUE.lighten(share));
        assert_eq!(svg.matches(&fill).count(), 2, "{fill}");
    }
}

#[test]
fn a_legend_without_a_free_place_goes_above_the_frame() {
    let x: Vec<f64> = (0..600).map(f64::from).collect();
    let y: Vec<f64> = (0..600).map(noise).collect();
    let crowded = Figure::new("F").panel(axes().series(Series::line("name", &x, &y)));
    let forced =
        Figure::new("F").panel(axes().series(Series::line("name", &x, &y)).legend(Legend::Above));
    assert_eq!(crowded.to_svg(), forced.to_svg());
    let straight = Figure::new("F").panel(axes().series(Series::line("name", &x, &x)));
    let corner =
        Figure::new("F").panel(axes().series(Series::line("name", &x, &x)).legend(Legend::TopLeft));
    assert_eq!(straight.to_svg(), corner.to_svg());
}

/// Ends of a bar on the page: abscissae and ordinates of the first two points of a path that is
/// drawn with the width of an error bar.
fn bars(svg: &str) -> Vec<[f64; 4]> {
    let paths = svg.lines().filter(|line| line.contains("stroke-width=\"0.93\""));
    let data = paths.filter_map(|line| line.split('"').nth(1));
    let parts = data.flat_map(|data| data.split('M').skip(1));
    let numbers = |part: &str| part.split(' ').flat_map(str::parse).collect::<Vec<f64>>();
    parts.filter_map(|part| numbers(part).try_into().ok()).collect()
}

#[test]
fn error_bars_reach_as_far_as_the_errors() {
    let panel = || Panel::new(Axis::linear("x", "").range(0.0, 5.9), Axis::linear("y", ""));
    let figure = |series: Series| Figure::new("F").panel(panel().series(series)).to_svg();
    let points = || Series::points("", [2.0, 5.0], [1.0, 4.0]);

    // Each bar has two caps; a bar of no length and one that is not known are left out.
    let drawn = bars(&figure(points().errors([1.0, 2.0])));
    assert_eq!(drawn.len(), 6);
    assert!(bars(&figure(points().errors([f64::NAN, 0.0]))).is_empty());
    // Twice the error is twice as long, about the same middle.
    let upright = |bar: &&[f64; 4]| bar[0] == bar[2];
    let bodies: Vec<_> = drawn.iter().filter(upright).collect();
    let length = |bar: &[f64; 4]| (bar[1] - bar[3]).abs();
    assert!((length(bodies[1]) / length(bodies[0]) - 2.0).abs() < 2e-3, "{bodies:?}");
    // The axis reaches the ends: 6 lies above the points.
    let wide = bars(&figure(points().horizontal_errors([1.0, 1.0])));
    assert_eq!(wide.iter().filter(|bar| bar[1] == bar[3]).count(), 2);
    assert!(figure(points().errors([1.0, 2.0])).contains(">6<"));
    assert!(!figure(points()).contains(">6<"));

    // On a logarithmic axis a bar through zero goes down to the frame.
    let log = Panel::new(Axis::linear("x", ""), Axis::log("y", "").range(0.1, 100.0));
    let log = log.series(Series::points("", [1.0], [1.0]).errors([2.0]));
    // The body and its upper cap.
    assert_eq!(bars(&Figure::new("F").panel(log).to_svg()).len(), 3);

    let short = Figure::new("F").panel(panel().series(points().errors([1.0])));
    assert!(matches!(short.check(), Err(FigureError::SeriesLengths { x: 2, y: 1, .. })));
}

#[test]
fn blank_places_draw_nothing_and_take_no_tag() {
    let panel = || axes().series(Series::line("", [0.0, 1.0], [0.0, 1.0]));
    let figure = Figure::new("F").columns(2).panel(panel()).panel(Panel::blank()).panel(panel());
    let svg = figure.to_svg();
    assert!(figure.check().is_ok());
    assert!(svg.contains(">(a)<") && svg.contains(">(b)<") && !svg.contains(">(c)<"));
    // The page, and the frames of two panels.
    assert_eq!(svg.matches("<rect").count(), 3);
}

#[test]
fn shades_stay_inside_the_frame() {
    let shaded = |from: f64, to: f64| {
        let panel = axes().series(Series::line("", [0.0, 10.0], [0.0, 1.0])).shade(from, to);
        let svg = Figure::new("F").panel(panel).to_svg();
        let line = svg.lines().find(|line| line.contains("#f0f0f0"))?.to_owned();
        let width = line.split("width=\"").nth(1)?.split('"').next()?.parse::<f64>();
        width.ok()
    };
    let whole = shaded(f64::NEG_INFINITY, f64::INFINITY).unwrap();
    assert!((shaded(0.0, 5.0).unwrap() / whole - 0.5).abs() < 1e-3);
    assert_eq!(shaded(-100.0, 100.0), Some(whole));
    assert_eq!(shaded(11.0, 12.0), None);
}

#[test]
fn hostile_sizes_do_not_panic() {
    let series = Series::line("a", [0.0, f64::MAX], [f64::MIN, f64::MAX]);
    for width in [f64::NAN, -5.0, 0.0, 1.0, 30.0] {
        let figure = Figure::new("F").width_mm(width).row_height_mm(width);
        let figure = figure.columns(3).panel(axes().series(series.clone())).panel(axes());
        assert!(figure.to_svg().ends_with("</svg>\n"));
    }
}

#[test]
fn frames_of_a_figure_are_equal_whatever_their_labels() {
    let wide =
        || Panel::new(Axis::linear("x", ""), Axis::linear("Long labels", "").range(0.0, 1e-3));
    let narrow = || Panel::new(Axis::linear("x", ""), Axis::linear("y", "").range(0.0, 9.0));
    let line = |name: &str| Series::line(name, [0.0, 1.0], [0.0, 5e-4]);
    let bar = ColorBar::continuous("Force", "N", 0.0, 1.0);
    let svg = Figure::new("F")
        .columns(2)
        .panel(narrow().series(line("a")).color_bar(bar))
        .panel(wide().series(line("b")))
        .panel(narrow().series(line("named")).legend(Legend::Above))
        .panel(wide().series(line("d")).title("Titled"))
        .to_svg();
    // Frames are the rectangles without fill that are larger than a colour bar.
    let attribute = |line: &str, name: &str| -> f64 {
        let rest = line.split_once(&format!(" {name}=\"")).unwrap().1;
        rest.split_once('"').unwrap().0.parse().unwrap()
    };
    let frames: Vec<(f64, f64)> = svg
        .lines()
        .filter(|line| line.starts_with("<rect x=") && line.contains("fill=\"none\""))
        .map(|line| (attribute(line, "width"), attribute(line, "height")))
        .filter(|frame| frame.0 > 40.0)
        .collect();
    assert_eq!(frames.len(), 4);
    for frame in &frames {
        let near = |a: f64, b: f64| (a - b).abs() < 0.02;
        assert!(near(frame.0, frames[0].0) && near(frame.1, frames[0].1), "{frames:?}");
    }
}
