//! Mode shapes on the mesh of a body.

use asperity_figure::{Axis, Color, ColorBar, Figure, Panel, Series};
use asperity_simulation::patches::MeshModes;

/// Most modes of a figure, and panels side by side.
const MOST_MODES: usize = 6;
const COLUMNS: usize = 3;

/// Width of a figure and of a frame in it, least and largest height of a frame, and room of titles \[mm\].
const WIDTH_MM: f64 = 180.0;
const FRAME_MM: f64 = 47.0;
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
    let [across, up] = [range(0), range(1)];
    let extents = [across.1 - across.0, up.1 - up.0];
    let size = extents[0].hypot(extents[1]);
    let margin = 1.2 * DRAWN * size;
    let axis = |(low, high): (f64, f64)| {
        let unlabelled = Axis::linear("", "").ticks(std::iter::empty::<(f64, String)>());
        unlabelled.range(low - margin, high + margin)
    };
    let largest = |shape: &[[f64; 3]]| shape.iter().map(|&moved| length(moved)).fold(0.0, f64::max);
    let elastic =
        mesh.shapes().filter(|(frequency, shape)| *frequency > 0.0 && largest(shape) > 0.0);
    let mut figure = Figure::new(format!("Mode shapes of {}", mesh.body()));
    let mut is_empty = true;
    for (number, (frequency, shape)) in elastic.take(MOST_MODES).enumerate() {
        let largest = largest(shape);
        let factor = DRAWN * size / largest;
        let moved = |node: usize| {
            let by = projected(shape[node]);
            [0, 1].map(|k| at_rest[node][k] + factor * by[k])
        };
        let title = format!("{frequency:.1} Hz");
        let mut panel = Panel::new(axis(across), axis(up)).title(title);
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
        let is_last = number % COLUMNS == COLUMNS - 1;
        figure = figure.panel(if is_last { panel.color_bar(bar) } else { panel });
        is_empty = false;
    }
    let frame = (FRAME_MM * (extents[1] + 2.0 * margin) / (extents[0] + 2.0 * margin))
        .clamp(HEIGHTS_MM.0, HEIGHTS_MM.1);
    (!is_empty).then(|| figure.columns(COLUMNS).width_mm(WIDTH_MM).row_height_mm(frame + TITLES_MM))
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
