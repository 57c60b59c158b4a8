//! Mode shapes and motion on the mesh of a body.

use asperity_figure::{Axis, Color, ColorBar, Figure, Panel, Series};
use asperity_simulation::patches::{MeshModes, MeshMotion};

/// Width of a frame and of a panel about it, least and largest height of a frame, and room of titles \[mm\].
const FRAME_MM: f64 = 47.0;
const PANEL_MM: f64 = 56.5;
const HEIGHTS_MM: (f64, f64) = (32.0, 110.0);
const TITLES_MM: f64 = 12.0;

/// Width of the colours beside the panels \[mm\].
const BAR_MM: f64 = 10.5;

/// Largest displacement that is drawn, over the size of the mesh.
const DRAWN: f64 = 0.08;

/// Colours of displacements.
const COLORS: usize = 10;

/// Most panels of a figure, and panels side by side.
const MOST_PANELS: usize = 6;
const COLUMNS: usize = 3;

/// Towards the eye: all axes are seen at the same angle.
const EYE: [f64; 3] = [1.0, 1.0, 1.0];

/// The lowest elastic modes of a body: the edges of its mesh that are seen along the diagonal of the axes, moved and coloured
/// by the displacement over its largest, above the edges at rest in grey. None without elements, or elastic modes that move them.
pub fn mesh_shapes(mesh: &MeshModes) -> Option<Figure> {
    let view = MeshView::new(&mesh.places(), mesh.edges_seen(EYE))?;
    let elastic =
        mesh.shapes().filter(|(frequency, shape)| *frequency > 0.0 && largest(shape) > 0.0);
    let drawn: Vec<_> = elastic.take(MOST_PANELS).collect();
    let bar = ColorBar::continuous("Motion over largest", "", 0.0, 1.0);
    let panels = drawn.iter().map(|(frequency, shape)| {
        let title = format!("{frequency:.1} Hz");
        view.panel(&title, shape, largest(shape), (&bar, 1.0))
    });
    let title = format!("Mode shapes of {}", mesh.body());
    (!drawn.is_empty()).then(|| view.figure(&title, panels.collect(), &bar))
}

/// Motion of a body at instants of a response, of more than six of them at six: as [`mesh_shapes`], with one scale and the
/// colours of displacements from rest. None without elements, or where they do not move.
pub fn mesh_motion(mesh: &MeshMotion) -> Option<Figure> {
    let view = MeshView::new(&mesh.places(), mesh.edges_seen(EYE))?;
    let all: Vec<_> = mesh.instants().collect();
    let count = all.len().min(MOST_PANELS);
    let drawn: Vec<_> = (1..=count).map(|k| all[k * all.len() / count - 1]).collect();
    let most = drawn.iter().map(|(_, displacements)| largest(displacements)).fold(0.0, f64::max);
    let bar = ColorBar::continuous("Displacement", "µm", 0.0, 1e6 * most);
    let panels = drawn.iter().map(|(time, displacements)| {
        view.panel(&format!("{:.4} ms", 1e3 * time), displacements, most, (&bar, 1e6 * most))
    });
    let title = format!("Motion of {}", mesh.body());
    (most > 0.0).then(|| view.figure(&title, panels.collect(), &bar))
}

/// The edges of a mesh that are seen, projected, with the frame of a panel.
struct MeshView {
    at_rest: Vec<[f64; 2]>,
    edges: Vec<[usize; 2]>,
    size: f64,
    height: f64,
    /// Ranges of the axes.
    frame: [(f64, f64); 2],
}

impl MeshView {
    /// The view of nodes at these places, with the edges between them that are seen from [`EYE`]; none without edges.
    fn new(places: &[[f64; 3]], edges: Vec<[usize; 2]>) -> Option<Self> {
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
        let around = |(low, high): (f64, f64), mm: f64| {
            let (middle, half) = (0.5 * (low + high), 0.5 * per_mm * mm);
            (middle - half, middle + half)
        };
        let frame = [around(ranges[0], FRAME_MM), around(ranges[1], height)];
        Some(Self { at_rest, edges, size, height, frame })
    }

    /// The edges moved by these displacements of the nodes and coloured by their size, above the edges at rest in grey. The
    /// `largest` is drawn as 8 % of the size of the mesh, in the colour of the value `top` of `bar`.
    fn panel(
        &self,
        title: &str,
        displacements: &[[f64; 3]],
        largest: f64,
        (bar, top): (&ColorBar, f64),
    ) -> Panel {
        let axis = |(low, high): (f64, f64)| {
            let unlabelled = Axis::linear("", "").ticks(std::iter::empty::<(f64, String)>());
            unlabelled.range(low, high)
        };
        let factor = DRAWN * self.size / largest;
        let moved = |node: usize| {
            let by = projected(displacements[node]);
            [0, 1].map(|k| self.at_rest[node][k] + factor * by[k])
        };
        let [across, up] = self.frame.map(axis);
        let still = lines(self.edges.iter().map(|edge| edge.map(|node| self.at_rest[node])));
        let still = still.color(Color::GREY.lighten(0.5)).width(0.3);
        let panel = Panel::new(across, up).title(title).series(still);
        (0..COLORS).fold(panel, |panel, class| {
            let is_of = |edge: &&[usize; 2]| {
                let mean = edge.iter().map(|&node| length(displacements[node])).sum::<f64>() / 2.0;
                ((COLORS as f64 * mean / largest) as usize).min(COLORS - 1) == class
            };
            let own = self.edges.iter().filter(is_of).map(|edge| edge.map(moved));
            let color = bar.color(top * (class as f64 + 0.5) / COLORS as f64);
            panel.series_if_visible(lines(own).color(color).width(0.6))
        })
    }

    /// A figure of panels with the colours beside the first row.
    fn figure(&self, title: &str, panels: Vec<Panel>, bar: &ColorBar) -> Figure {
        let columns = COLUMNS.min(panels.len());
        let mut figure = Figure::new(title);
        for (number, panel) in (1..).zip(panels) {
            let is_last = number == columns;
            figure = figure.panel(if is_last { panel.color_bar(bar.clone()) } else { panel });
        }
        let width = columns as f64 * PANEL_MM + BAR_MM;
        figure.columns(columns).width_mm(width).row_height_mm(self.height + TITLES_MM)
    }
}

/// Largest size of the displacements of nodes.
fn largest(displacements: &[[f64; 3]]) -> f64 {
    displacements.iter().map(|&moved| length(moved)).fold(0.0, f64::max)
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
