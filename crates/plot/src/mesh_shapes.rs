//! Mode shapes on the mesh of a body.

use asperity_figure::{Axis, Color, ColorBar, Figure, Panel, Series};
use asperity_simulation::patches::MeshModes;

/// Most modes of a figure, and panels side by side.
const MOST_MODES: usize = 6;
const COLUMNS: usize = 3;

/// Width of a frame, of a panel about it, and of the colours beside them, least and largest height of a frame, and room of
/// titles \[mm\].
const FRAME_MM: f64 = 47.0;
const PANEL_MM: f64 = 56.5;
const BAR_MM: f64 = 10.5;
const HEIGHTS_MM: (f64, f64) = (32.0, 110.0);
const TITLES_MM: f64 = 12.0;

/// Largest displacement that is drawn, over the size of the mesh.
const DRAWN: f64 = 0.08;

/// Colours of displacements.
const COLORS: usize = 10;

/// Towards the eye: all axes are seen at the same angle.
const EYE: [f64; 3] = [1.0, 1.0, 1.0];

/// The lowest elastic modes of a body: the edges of its mesh that are seen along the diagonal of the axes, moved and coloured
/// by the displacement over its largest, above the edges at rest in grey. None without elements, or elastic modes that move them.
pub fn mesh_shapes(mesh: &MeshModes) -> Option<Figure> {
    let (places, edges) = (mesh.places(), mesh.edges_seen(EYE));
    if edges.is_empty() {
        return None;
    }
    let at_rest: Vec<[f64; 2]> = places.iter().map(|&place| projected(place)).collect();
    let range = |axis: usize| {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        let seen = edges.iter().flatten().map(|&node| at_rest[node][axis]);
        seen.fold(start, |(low, high), x| (low.min(x), high.max(x)))
    };
    let ranges = [range(0), range(1)];
    let extents = ranges.map(|(low, high)| high - low);
    let size = extents[0].hypot(extents[1]);
    let needed = extents.map(|extent| extent + 2.4 * DRAWN * size);
    let height = (FRAME_MM * needed[1] / needed[0]).clamp(HEIGHTS_MM.0, HEIGHTS_MM.1);
    // One length of both axes is as long on paper.
    let per_mm = (needed[0] / FRAME_MM).max(needed[1] / height);
    let axis = |(low, high): (f64, f64), mm: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * per_mm * mm);
        let unlabelled = Axis::linear("", "").ticks(std::iter::empty::<(f64, String)>());
        unlabelled.range(middle - half, middle + half)
    };
    let largest = |shape: &[[f64; 3]]| shape.iter().map(|&moved| length(moved)).fold(0.0, f64::max);
    let elastic =
        mesh.shapes().filter(|(frequency, shape)| *frequency > 0.0 && largest(shape) > 0.0);
    let drawn: Vec<_> = elastic.take(MOST_MODES).collect();
    let columns = COLUMNS.min(drawn.len());
    let mut figure = Figure::new(format!("Mode shapes of {}", mesh.body()));
    for (number, &(frequency, shape)) in (1..).zip(&drawn) {
        let largest = largest(shape);
        let factor = DRAWN * size / largest;
        let moved = |node: usize| {
            let by = projected(shape[node]);
            [0, 1].map(|k| at_rest[node][k] + factor * by[k])
        };
        let title = format!("{frequency:.1} Hz");
        let mut panel = Panel::new(axis(ranges[0], FRAME_MM), axis(ranges[1], height)).title(title);
        let still = lines(edges.iter().map(|edge| edge.map(|node| at_rest[node])));
        panel = panel.series(still.color(Color::GREY.lighten(0.5)).width(0.3));
        let bar = ColorBar::continuous("Motion over largest", "", 0.0, 1.0);
        for class in 0..COLORS {
            let is_of = |edge: &&[usize; 2]| {
                let mean = edge.iter().map(|&node| length(shape[node])).sum::<f64>() / 2.0;
                ((COLORS as f64 * mean / largest) as usize).min(COLORS - 1) == class
            };
            let own = edges.iter().filter(is_of).map(|edge| edge.map(moved));
            let color = bar.color((class as f64 + 0.5) / COLORS as f64);
            panel = panel.series_if_visible(lines(own).color(color).width(0.6));
        }
        figure = figure.panel(if number == columns { panel.color_bar(bar) } else { panel });
    }
    let width = columns as f64 * PANEL_MM + BAR_MM;
    let figure = figure.columns(columns).width_mm(width).row_height_mm(height + TITLES_MM);
    (!drawn.is_empty()).then_some(figure)
}

/// Lines that are not joined, as one series.
fn lines(ends: impl Iterator<Item = [[f64; 2]; 2]>) -> Series {
    let gap = [f64::NAN; 2];
    let points: Vec<[f64; 2]> = ends.flat_map(|[from, to]| [from, to, gap]).collect();
    let [x, y] = [0, 1].map(|k| points.iter().map(|point| point[k]).collect::<Vec<f64>>());
    Series::line("", x, y)
}

/// A vector as it is seen from [`EYE`], with z upwards.
fn projected([x, y, z]: [f64; 3]) -> [f64; 2] {
    [(y - x) / 2.0_f64.sqrt(), (2.0 * z - x - y) / 6.0_f64.sqrt()]
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}
