//! Fig. 2: the numerical model, drawn from the scenario.

use anyhow::Result;
use asperity_figure::Color;
use asperity_table::Table;

use super::sketch::{Align, Sketch, Stroke};
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig02",
    title: "Fig. 2: the numerical model",
    caption: "The stack of the scenario on its finite-difference grid: guide bar Ω1, sample Ω2, \
              two contacts, rigid disc. Drawn from the table of nodes: lengths to scale (the \
              sample stretched five times), every eighth node shown, end nodes with half a cell's \
              mass hollow. The paper's panel (a) is a sketch of the bench; its lengths and masses \
              are those of Table 2.",
    compute,
    draw,
};

fn compute(rig: &Rig) -> Result<Computed> {
    let case = rig.struck(Law::Modified, 32.0)?;
    let (assembly, grid) = (case.assembly()?, case.grid()?);
    let (mut body, mut position, mut mass) = (Vec::new(), Vec::new(), Vec::new());
    let mut top = 0.0;
    for (index, bar) in grid.bars().iter().enumerate() {
        for node in 0..bar.nodes() {
            let at_end = node == 0 || node == bar.cells();
            body.push((index + 1) as f64);
            position.push(top + node as f64 * bar.cell_length());
            mass.push(if at_end { bar.end_mass() } else { bar.cell_mass() });
        }
        top += bar.cells() as f64 * bar.cell_length();
    }
    let table = Table::new()
        .with_column("body", body)?
        .with_column("position_m", position)?
        .with_column("mass_kg", mass)?;
    let pressures = assembly.structure.stack().static_pressures();
    Ok(Computed { table, values: vec![("static_pressure", pressures[0] / 1e6)] })
}

/// Left edge and width of the bars, and height of the drawing per metre of guide, in mm.
const LEFT: f64 = 34.0;
const WIDTH: f64 = 22.0;
const SCALE: f64 = 300.0;
const SAMPLE_STRETCH: f64 = 5.0;
const GAP: f64 = 9.0;

fn draw(table: &Table) -> Result<String> {
    let (body, x, mass) =
        (table.column("body")?, table.column("position_m")?, table.column("mass_kg")?);
    let mut drawing = Sketch::new("The numerical model", 85.0, 138.0);
    let centre = LEFT + WIDTH / 2.0;
    let line = Stroke::BLACK;
    let mut top = 16.0;
    drawing.arrow((centre, 3.0), (centre, top - 0.8), Stroke(Color::RED, 1.2));
    drawing.text((centre + 3.0, 7.5), "F(t)", 8.0, Align::Left, Color::BLACK);
    drawing.arrow((8.0, top), (8.0, top + 14.0), line);
    drawing.text((10.5, top + 12.5), "x, u", 8.0, Align::Left, Color::BLACK);

    for (number, label) in [(1.0, "Ω₁"), (2.0, "Ω₂")] {
        let nodes: Vec<usize> = (0..body.len()).filter(|&node| body[node] == number).collect();
        let (Some(&first), Some(&last)) = (nodes.first(), nodes.last()) else { continue };
        let stretch = if number == 1.0 { SCALE } else { SCALE * SAMPLE_STRETCH };
        let height = (x[last] - x[first]) * stretch;
        drawing.rect((LEFT, top), (WIDTH, height), Color::LIGHT_GREY.lighten(0.5), line);
        for &node in &nodes {
            let at_end = node == first || node == last;
            if at_end || (number == 2.0) || (node - first) % 8 == 0 {
                let fill = if at_end { Color::WHITE } else { Color::BLUE };
                let at = (centre, top + (x[node] - x[first]) * stretch);
                let radius = if number == 1.0 { 0.75 } else { 0.5 };
                drawing.circle(at, radius, fill, Stroke(Color::BLUE, 0.6));
            }
        }
        let total: f64 = nodes.iter().map(|&node| mass[node]).sum();
        let middle = top + height / 2.0;
        drawing.text((LEFT + 4.0, middle), label, 9.0, Align::Left, Color::BLACK);
        let right = LEFT + WIDTH + 3.0;
        drawing.height(
            (right, top),
            (right, top + height),
            &format!("{:.0} mm", 1e3 * (x[last] - x[first])),
            Stroke::THIN,
        );
        let words = format!("{} nodes", nodes.len());
        drawing.text((LEFT - 3.0, middle - 1.0), &words, 7.0, Align::Right, Color::BLACK);
        let words =
            if total < 0.1 { format!("{:.2} g", 1e3 * total) } else { format!("{total:.2} kg") };
        drawing.text((LEFT - 3.0, middle + 3.0), &words, 7.0, Align::Right, Color::BLACK);
        top += height;
        for place in [LEFT + 5.0, centre, LEFT + WIDTH - 5.0] {
            drawing.spring((place, top), (place, top + GAP), 3.0, Stroke(Color::RED, 0.7));
        }
        let name = if number == 1.0 { "K(p), contact 1" } else { "K(p), contact 2" };
        drawing.text(
            (LEFT + WIDTH + 3.0, top + GAP / 2.0 + 1.0),
            name,
            7.0,
            Align::Left,
            Color::BLACK,
        );
        top += GAP;
    }
    drawing.ground((LEFT - 8.0, top), (LEFT + WIDTH + 8.0, top), line);
    drawing.text((centre, top + 7.0), "disc", 8.0, Align::Center, Color::BLACK);
    Ok(drawing.to_svg())
}
