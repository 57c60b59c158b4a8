//! Pressure maps of contact patches.

use asperity_figure::{Axis, Color, ColorBar, Figure, Marker, Panel, Series};
use asperity_simulation::patches::{CellPlace, PatchMap};

/// Width of a figure and of a frame in it, and least and largest height of a row \[mm\].
const WIDTH_MM: f64 = 120.0;
const FRAME_MM: f64 = 85.0;
const HEIGHTS_MM: (f64, f64) = (35.0, 120.0);

/// Room of titles and labels of a row \[mm\].
const LABELS_MM: f64 = 18.0;

/// Pressure at rest of the cells of each patch, seen along the axis in which the patch is thinnest; open cells are empty.
/// None without cells that have a place.
pub fn pressure_maps(maps: &[PatchMap]) -> Option<Figure> {
    let maps: Vec<&PatchMap> = maps.iter().filter(|map| !map.cells.is_empty()).collect();
    if maps.is_empty() {
        return None;
    }
    let (mut figure, mut heights) = (Figure::new("Contact pressure at rest"), Vec::new());
    for map in maps {
        let places = || map.cells.iter().flat_map(|cell| cell.polygons.iter().flatten());
        let range = |axis: usize| {
            let start = (f64::INFINITY, f64::NEG_INFINITY);
            places().fold(start, |(low, high), place| (low.min(place[axis]), high.max(place[axis])))
        };
        let extents = [0, 1, 2].map(|axis| range(axis).1 - range(axis).0);
        let thinnest = (0..3).min_by(|a, b| extents[*a].total_cmp(&extents[*b])).unwrap_or(2);
        let [across, up] = [[1, 2], [0, 2], [0, 1]][thinnest];
        let axis = |axis: usize| Axis::linear(["x", "y", "z"][axis], "mm").scale(1e3);
        let highest = map.cells.iter().map(|cell| cell.pressure_pa).fold(0.0, f64::max);
        let bar = ColorBar::continuous("Pressure", "MPa", 0.0, 1e-6 * highest.max(1.0));
        let mut panel = Panel::new(axis(across), axis(up)).title(&map.name);
        for cell in &map.cells {
            panel = panel.all_series(drawn(cell, [across, up], &bar));
        }
        heights.push(FRAME_MM * extents[up] / extents[across] + LABELS_MM);
        figure = figure.panel(panel.color_bar(bar));
    }
    let height = heights.into_iter().fold(HEIGHTS_MM.0, f64::max).min(HEIGHTS_MM.1);
    Some(figure.columns(1).width_mm(WIDTH_MM).row_height_mm(height))
}

/// A cell: its polygons filled and their edges, or a marker at its centre.
fn drawn(cell: &CellPlace, axes: [usize; 2], bar: &ColorBar) -> Vec<Series> {
    let open = cell.gap_m > 0.0;
    let color = bar.color(1e-6 * cell.pressure_pa);
    let mut series = Vec::new();
    for polygon in &cell.polygons {
        let corners: Vec<[f64; 2]> =
            polygon.iter().map(|place| axes.map(|axis| place[axis])).collect();
        let [x, y] = [0, 1].map(|k| corners.iter().map(|corner| corner[k]).collect::<Vec<f64>>());
        if corners.len() < 3 {
            let marker = Series::points("", &x, &y).marker(Marker::Square).filled(!open);
            series.push(marker.marker_size(6.0).color(if open { Color::GREY } else { color }));
            continue;
        }
        if !open {
            let (x, lower, upper) = chains(&corners);
            series.push(Series::band("", x, lower, upper).color(color).lightness(0.0));
        }
        let closed = |values: &[f64]| [values, &values[..1]].concat();
        let edge = Series::line("", closed(&x), closed(&y)).color(Color::GREY).width(0.4);
        series.push(edge);
    }
    series
}

/// The lower and the upper edge of a polygon at the abscissae of its corners.
fn chains(corners: &[[f64; 2]]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let mut abscissae: Vec<f64> = corners.iter().map(|corner| corner[0]).collect();
    abscissae.sort_by(f64::total_cmp);
    abscissae.dedup();
    let at = |x: f64| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            if (a[0] - x) * (b[0] - x) > 0.0 {
                continue;
            }
            let ends = if a[0] == b[0] {
                [a[1], b[1]]
            } else {
                [a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]); 2]
            };
            for y in ends {
                (low, high) = (low.min(y), high.max(y));
            }
        }
        (low, high)
    };
    let edges = abscissae.iter().map(|&x| at(x));
    let (lower, upper) = edges.unzip();
    (abscissae, lower, upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_a_polygon_are_its_chains() {
        let diamond = [[0.0, 0.0], [1.0, -1.0], [2.0, 0.0], [1.0, 2.0]];
        let (x, lower, upper) = chains(&diamond);
        assert_eq!(x, [0.0, 1.0, 2.0]);
        assert_eq!((lower, upper), (vec![0.0, -1.0, 0.0], vec![0.0, 2.0, 0.0]));
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(chains(&square), (vec![0.0, 1.0], vec![0.0, 0.0], vec![1.0, 1.0]));
    }

    #[test]
    fn closed_cells_are_filled_and_open_ones_are_not() {
        let cell = |x: f64, gap_m: f64| CellPlace {
            polygons: vec![vec![
                [x, 0.0, 0.5],
                [x + 1e-3, 0.0, 0.5],
                [x + 1e-3, 2e-3, 0.5],
                [x, 2e-3, 0.5],
            ]],
            area_m2: 2e-6,
            pressure_pa: if gap_m > 0.0 { 0.0 } else { 2e6 },
            gap_m,
        };
        let cells = vec![cell(0.0, 0.0), cell(1e-3, 1e-7)];
        let bar = ColorBar::continuous("Pressure", "MPa", 0.0, 2.0);
        let series = cells.iter().map(|cell| drawn(cell, [0, 1], &bar).len());
        assert_eq!(series.collect::<Vec<_>>(), [2, 1]);
        let map = PatchMap { name: "lap".to_owned(), cells };
        let svg = pressure_maps(&[map]).map(|figure| figure.to_svg()).unwrap_or_default();
        assert!(svg.contains("lap") && svg.contains("Pressure"), "{svg}");
        assert_eq!(pressure_maps(&[]), None);
    }
}
