//! Laws and mode shapes.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_simulation::laws::LawTable;
use asperity_simulation::modes::LinearisedModes;

/// Stiffness against pressure, and pressure against closure, of every law.
pub fn laws(tables: &[LawTable]) -> Figure {
    let pressure = || Axis::linear("Contact pressure", "MPa").scale(1e-6);
    let mut stiffness = Panel::new(pressure(), Axis::linear("Contact stiffness", "Pa/m"));
    let mut closure = Panel::new(Axis::linear("Closure", "µm").scale(1e6), pressure());
    for (index, law) in tables.iter().enumerate() {
        let style = |series: Series| {
            let dash = [Dash::Solid, Dash::Dashed, Dash::DashDot][index % 3];
            series.color(Color::category(index)).dash(dash)
        };
        let name = law.name.as_str();
        stiffness = stiffness.series(style(Series::line(name, &law.pressure, &law.stiffness)));
        closure = closure.series(style(Series::line(name, &law.closure, &law.pressure)));
    }
    Figure::new("Contact laws").panel(stiffness).panel(closure).columns(2).width_mm(170.0)
}

/// Displacement along the stack, a line per mode.
pub fn modes(found: &LinearisedModes) -> Figure {
    let mut panel = Panel::new(
        Axis::linear("Distance from the top", "mm").scale(1e3),
        Axis::linear("Displacement over its largest", ""),
    )
    .legend(Legend::Above);
    for (index, (mode, shape)) in found.modes.iter().zip(&found.shapes).take(8).enumerate() {
        let name = format!("{:.1} Hz", mode.frequency_hz);
        panel =
            panel.series(Series::line(name, &found.positions, shape).color(Color::category(index)));
    }
    Figure::new("Mode shapes about static equilibrium").panel(panel).width_mm(120.0)
}
