//! Figures that a page zooms and reads out: the SVG with its moving parts grouped, and their points.
//!
//! Points are in the coordinates of the page, so that the script of the page needs no scale but to
//! name values and marks.

use crate::{
    Figure, Marker, mark,
    markup::{PX_PER_PT, escape, push_rounded},
    plot::Plot,
    series::{Join, Series},
    text, tick_label, trace,
};
use std::fmt::Write as _;

/// The script that zooms interactive figures and shows their values at the pointer, as the top level of an ES
/// module: `interactive(svg, data, id)` takes the `svg` element of a figure on the page, its parsed data and
/// an identifier that is unique on the page. Values appear in an element of the class `tip`.
pub const INTERACTIVE_SCRIPT: &str = include_str!("interactive.js");

/// A figure that [`INTERACTIVE_SCRIPT`] zooms and reads out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InteractiveFigure {
    /// SVG text.
    pub svg: String,
    /// Points, axes and frames of its panels as JSON.
    pub data: String,
}

/// Most points of a line: four a column.
const COLUMNS: (usize, usize) = (400, 5000);

/// The data of a figure as JSON, an object for each panel that is not blank.
pub(crate) fn data<'a, 'b: 'a>(
    figure: &Figure,
    plots: impl Iterator<Item = &'a Plot<'b>>,
    columns: usize,
) -> String {
    let plots = plots.filter(|plot| !plot.panel.blank);
    let panels: Vec<String> = plots.map(|plot| panel(plot, columns)).collect();
    format!("{{\"title\":{},\"panels\":[{}]}}", quoted(&figure.title), panels.join(",\n"))
}

fn panel(plot: &Plot<'_>, columns: usize) -> String {
    let frame = &plot.frame;
    let frame = numbers([frame.left, frame.top, frame.right, frame.bottom]);
    let axis = |ruler: &crate::ruler::Ruler, axis: &crate::Axis| {
        let (low, high, log) = (ruler.scale.low, ruler.scale.high, ruler.scale.log);
        let plain = log || axis.ticks.is_some();
        let exponent = if plain { 0 } else { tick_label::common_exponent(low, high) };
        let ticks = axis.ticks.as_ref().map_or_else(
            || "null".to_owned(),
            |_| {
                let marks = ruler.major.iter();
                let mark = |(at, label): &(f64, String)| {
                    format!("[{},{}]", coordinate(*at), quoted(&html(label)))
                };
                format!("[{}]", marks.map(mark).collect::<Vec<_>>().join(","))
            },
        );
        format!(
            "{{\"low\":{low:e},\"high\":{high:e},\"log\":{log},\"exponent\":{exponent},\
             \"factor\":{:e},\"label\":{},\"unit\":{},\"ticks\":{ticks}}}",
            axis.factor,
            quoted(&html(&axis.label)),
            quoted(&html(&axis.unit))
        )
    };
    let lines = plot.panel.series.iter().filter(|series| series.join == Join::Line).count();
    let columns = (columns / lines.max(1)).clamp(COLUMNS.0, COLUMNS.1);
    let column = plot.frame.width() / columns as f64;
    let series = plot.panel.series.iter().enumerate();
    let series: Vec<String> =
        series.map(|(index, series)| curve(plot, index, series, column)).collect();
    let references: Vec<String> = plot
        .panel
        .references
        .iter()
        .filter_map(|reference| {
            let at = if reference.vertical {
                plot.x.scale.datum(reference.at)
            } else {
                plot.y.scale.datum(reference.at)
            };
            let text = quoted(&html(&reference.text));
            at.is_finite().then(|| format!("[{},{},{text}]", reference.vertical, coordinate(at)))
        })
        .collect();
    let shades: Vec<String> = plot
        .panel
        .shades
        .iter()
        .map(|&(from, to)| {
            let place = |at: f64, open: f64| {
                let at = plot.x.scale.datum(at);
                coordinate(if at.is_nan() { open } else { at })
            };
            format!("[{},{}]", place(from, plot.frame.left), place(to, plot.frame.right))
        })
        .collect();
    let notes: Vec<String> = plot
        .panel
        .notes
        .iter()
        .map(|note| {
            let (x, y) = (plot.x.scale.datum(note.x), plot.y.scale.datum(note.y));
            let text = quoted(&html(&note.text));
            format!("[{},{},{text},\"{}\"]", coordinate(x), coordinate(y), note.color)
        })
        .collect();
    format!(
        "{{\"frame\":{frame},\"xAxis\":{},\"yAxis\":{},\"series\":[{}],\"references\":[{}],\
         \"shades\":[{}],\"notes\":[{}]}}",
        axis(&plot.x, &plot.panel.x_axis),
        axis(&plot.y, &plot.panel.y_axis),
        series.join(","),
        references.join(","),
        shades.join(","),
        notes.join(",")
    )
}

/// One series: its look, its runs of points, its areas, markers and error bars.
fn curve(plot: &Plot<'_>, index: usize, series: &Series, column: f64) -> String {
    let points = plot.points(series);
    let flat = |points: &[(f64, f64)]| numbers(points.iter().flat_map(|point| [point.0, point.1]));
    let runs = match series.join {
        Join::Line => trace::finite_runs(&points),
        Join::Points | Join::Band => Vec::new(),
    };
    let runs: Vec<String> = runs.iter().map(|run| flat(&trace::decimated(run, column))).collect();
    let areas: Vec<String> = plot.bands(series).iter().map(|area| flat(area)).collect();
    let marked = series.marker != Marker::None;
    let marks = points.iter().step_by(series.marker_every).filter(|_| marked).copied();
    let marks: Vec<(f64, f64)> =
        marks.filter(|point| point.0.is_finite() && point.1.is_finite()).collect();
    let errors = plot.error_segments(series);
    let errors = errors.iter().flat_map(|[a, b]| [a.0, a.1, b.0, b.1]);
    let mut text = format!(
        "{{\"name\":{},\"color\":\"{}\",\"width\":{},\"dash\":{},\"runs\":[{}],\"areas\":[{}],\
         \"marks\":{},\"errors\":{}",
        quoted(&html(&series.name)),
        plot.panel.series_color(index),
        coordinate(series.width * PX_PER_PT),
        quoted(&crate::line::dash_array(series.dash, series.width)),
        runs.join(","),
        areas.join(","),
        flat(&marks),
        numbers(errors),
    );
    if !marks.is_empty() {
        let color = plot.panel.series_color(index);
        let (symbol, style) = mark::at_origin(series, color);
        // Writing to a String cannot fail.
        let _ = write!(text, ",\"symbol\":{},\"style\":{}", quoted(&symbol), quoted(&style));
    }
    text.push('}');
    text
}

/// A text as HTML with sub- and superscripts.
fn html(content: &str) -> String {
    text::tagged(content, escape)
}

fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    let mut text = String::from("[");
    for (index, value) in values.into_iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        push_coordinate(&mut text, value);
    }
    text.push(']');
    text
}

/// A length on the page, rounded to 0.001; null where there is none.
fn coordinate(value: f64) -> String {
    let mut text = String::new();
    push_coordinate(&mut text, value);
    text
}

fn push_coordinate(text: &mut String, value: f64) {
    if value.is_finite() {
        push_rounded(text, value, 3);
    } else {
        text.push_str("null");
    }
}

/// A text as a JSON string that may stand in a script element.
fn quoted(content: &str) -> String {
    let mut text = String::from("\"");
    for character in content.chars() {
        match character {
            '"' => text.push_str("\\\""),
            '\\' => text.push_str("\\\\"),
            '<' => text.push_str("\\u003c"),
            character if character.is_control() || matches!(character, '\u{2028}' | '\u{2029}') => {
                let _ = write!(text, "\\u{:04x}", u32::from(character));
            }
            character => text.push(character),
        }
    }
    text.push('"');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_end_their_script() {
        assert_eq!(quoted("a\"</script>\\\n"), r#""a\"\u003c/script>\\\u000a""#);
    }

    #[test]
    fn coordinates_are_json_numbers() {
        assert_eq!(numbers([1.0, -0.25, 1e-9, f64::NAN]), "[1,-0.25,0,null]");
    }
}
