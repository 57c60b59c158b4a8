//! Laws and mode shapes.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_scenario::four_digits;
use asperity_simulation::laws::LawTable;
use asperity_simulation::modes::LinearisedModes;

/// Pressures that a law has been at.
#[derive(Debug, Clone, PartialEq)]
pub struct VisitedRange {
    /// Name of the law.
    pub law: String,
    /// Lowest pressure \[Pa\].
    pub low: f64,
    /// Highest pressure \[Pa\].
    pub high: f64,
}

/// Stiffness against pressure, and pressure against closure, of every law.
pub fn laws(tables: &[LawTable]) -> Figure {
    laws_visited(tables, &[])
}

/// As [`laws`], with the parts of the laws that have been visited as wide lines.
pub fn laws_visited(tables: &[LawTable], visited: &[VisitedRange]) -> Figure {
    let pressure = || Axis::linear("Contact pressure", "MPa").scale(1e-6);
    let mut stiffness = Panel::new(pressure(), Axis::linear("Contact stiffness", "Pa/m"));
    let mut closure = Panel::new(Axis::linear("Closure", "µm").scale(1e6), pressure());
    for (index, law) in tables.iter().enumerate() {
        let name = law.name.as_str();
        for range in visited.iter().filter(|range| range.law == law.name) {
            let wide = |x: &[f64], y: &[f64]| {
                let part = |values: &[f64]| interpolated(&law.pressure, values, range);
                let line = Series::line("", part(x), part(y)).category(index).dash(Dash::Solid);
                line.color(Color::category(index).lighten(0.6)).width(5.0)
            };
            stiffness = stiffness.series(wide(&law.pressure, &law.stiffness));
            closure = closure.series(wide(&law.closure, &law.pressure));
        }
        let line = Series::line(name, &law.pressure, &law.stiffness);
        stiffness = stiffness.series(line.category(index));
        closure = closure.series(Series::line("", &law.closure, &law.pressure).category(index));
    }
    Figure::new("Contact laws").panel(stiffness).panel(closure).columns(2).width_mm(170.0)
}

/// The part of a column over increasing pressures that belongs to a range, its ends interpolated.
fn interpolated(pressure: &[f64], values: &[f64], range: &VisitedRange) -> Vec<f64> {
    let at = |wanted: f64| {
        let above = pressure.partition_point(|one| *one < wanted).min(pressure.len() - 1);
        let below = above.saturating_sub(1);
        let width = pressure[above] - pressure[below];
        let part =
            if width > 0.0 { ((wanted - pressure[below]) / width).clamp(0.0, 1.0) } else { 0.0 };
        values[below] + part * (values[above] - values[below])
    };
    if pressure.is_empty() {
        return Vec::new();
    }
    let inside = pressure.iter().zip(values);
    let inside =
        inside.filter(|(p, _)| (range.low..=range.high).contains(p)).map(|(_, value)| *value);
    std::iter::once(at(range.low)).chain(inside).chain([at(range.high)]).collect()
}

/// Displacement along the stack over its largest, a line per mode, broken at the interfaces.
pub fn modes(found: &LinearisedModes) -> Figure {
    let mut panel = Panel::new(
        Axis::linear("Distance from the top", "mm").scale(1e3),
        Axis::linear("Displacement over its largest", ""),
    )
    .legend(Legend::Above);
    // The two sides of an interface are at one position.
    let interfaces: Vec<usize> = (1..found.positions.len())
        .filter(|&at| found.positions[at] <= found.positions[at - 1])
        .collect();
    let broken = |values: &[f64], gap: &dyn Fn(usize) -> f64, factor: f64| -> Vec<f64> {
        let value = |(at, value): (usize, &f64)| {
            let gap = interfaces.contains(&at).then(|| gap(at));
            gap.into_iter().chain([factor * value])
        };
        values.iter().enumerate().flat_map(value).collect()
    };
    let x = broken(&found.positions, &|at| found.positions[at], 1.0);
    for (index, (mode, shape)) in found.modes.iter().zip(&found.shapes).take(8).enumerate() {
        let largest = shape.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let y = broken(shape, &|_| f64::NAN, if largest > 0.0 { 1.0 / largest } else { 1.0 });
        let name = format!("{} Hz", four_digits(mode.frequency_hz));
        panel = panel.series(Series::line(name, &x, y).category(index));
    }
    for at in interfaces {
        panel = panel.vertical(found.positions[at], "");
    }
    Figure::new("Mode shapes about static equilibrium").panel(panel).width_mm(120.0)
}
