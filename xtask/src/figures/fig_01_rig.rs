//! Fig. 1: the rig, as a schematic with the numbers of Tables 1 and 2.

use anyhow::Result;
use asperity_figure::Color;
use asperity_table::Table;

use super::sketch::{Align, Sketch, Stroke};
use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig01",
    title: "Fig. 1: the rig",
    caption: "Schematic of the bench; the paper's Fig. 1 is a photograph. An instrumented hammer \
              strikes the guide bar, which moves freely in its air bearing and rests on the \
              aluminium sample on a massive steel disc. Numbers of Tables 1 and 2 from the \
              scenario; not to scale.",
    compute,
    draw,
};

fn compute(rig: &Rig) -> Result<Computed> {
    let assembly = rig.struck(Law::Modified, 32.0)?.assembly()?;
    let stack = assembly.structure.stack();
    let mut table = Table::new();
    for (name, body) in ["guide", "sample"].iter().zip(stack.bodies()) {
        table.push(format!("{name}:length_m"), [body.length()])?;
        table.push(format!("{name}:mass_kg"), [body.mass()])?;
        table.push(format!("{name}:youngs_modulus_pa"), [body.youngs_modulus()])?;
        table.push(format!("{name}:density_kg_per_m3"), [body.density()])?;
    }
    table.push("contact:area_m2", [stack.interfaces()[0].area()])?;
    table.push("contact:pressure_pa", [stack.static_pressures()[0]])?;
    Ok(Computed { table, values: Vec::new() })
}

/// Middle of the stack, in mm from the left.
const AXIS: f64 = 34.0;
/// Position of the labels.
const WORDS: f64 = 53.0;
const ALUMINIUM: Color = Color::hex(0xd5_dde6);
const STEEL: Color = Color::hex(0xb4_b9c0);
const FRAME: Color = Color::hex(0xec_ecec);

fn draw(table: &Table) -> Result<String> {
    let value = |name: &str| -> Result<f64> { Ok(table.column(name)?[0]) };
    let mut drawing = Sketch::new("The rig", style::COLUMN, 118.0);
    let line = Stroke::BLACK;
    let body = |drawing: &mut Sketch, top: f64, width: f64, height: f64, fill: Color| {
        drawing.rect((AXIS - width / 2.0, top), (width, height), fill, line);
    };
    let words = |drawing: &mut Sketch, y: f64, lines: &[String]| {
        for (number, text) in lines.iter().enumerate() {
            let size = if number == 0 { 8.0 } else { 7.0 };
            drawing.text((WORDS, y + 3.9 * number as f64), text, size, Align::Left, Color::BLACK);
        }
    };
    let lead = |drawing: &mut Sketch, from: f64, y: f64| {
        drawing.line(&[(from, y), (WORDS - 1.5, y)], Stroke::THIN);
    };

    // Hammer: handle, head, tip.
    drawing.rect((6.0, 5.2), (AXIS - 10.0, 2.6), FRAME, line);
    body(&mut drawing, 2.5, 8.0, 8.0, STEEL);
    body(&mut drawing, 10.5, 3.0, 2.2, Color::GREY);
    drawing.arrow((AXIS, 13.4), (AXIS, 17.6), Stroke(Color::RED, 1.2));
    drawing.text((AXIS + 2.0, 15.0), "F(t)", 7.0, Align::Left, Color::RED);
    lead(&mut drawing, AXIS + 4.0, 6.5);
    words(&mut drawing, 6.5, &["hammer".to_owned(), "9 to 32 N".to_owned()]);

    // Guide bar with the accelerometer on its top, in its air bearing.
    body(&mut drawing, 18.0, 18.0, 62.0, ALUMINIUM);
    drawing.rect((AXIS - 7.5, 14.8), (4.0, 3.2), Color::BLUE, line);
    drawing.text((AXIS - 10.0, 15.2), "accelerometer", 7.0, Align::Right, Color::BLACK);
    for side in [-1.0, 1.0] {
        let left = if side < 0.0 { AXIS - 16.5 } else { AXIS + 10.0 };
        drawing.rect((left, 32.0), (6.5, 22.0), FRAME, line);
        drawing.hatch((left, 32.0), (6.5, 22.0), 1.8, Stroke::THIN);
        for row in 0..4 {
            let y = 35.0 + 5.4 * f64::from(row);
            let from = AXIS + side * 12.2;
            drawing.arrow((from, y), (AXIS + side * 9.2, y), Stroke(Color::SKY, 0.7));
        }
    }
    drawing.text((AXIS - 18.0, 43.0), "air bearing", 7.0, Align::Right, Color::BLACK);
    lead(&mut drawing, AXIS + 9.0, 60.0);
    let guide = [
        "guide bar Ω₁".to_owned(),
        format!("L = {:.0} mm", 1e3 * value("guide:length_m")?),
        format!("m = {:.2} kg", value("guide:mass_kg")?),
        format!("E = {:.0} GPa", 1e-9 * value("guide:youngs_modulus_pa")?),
        format!("ρ = {:.0} kg/m³", value("guide:density_kg_per_m3")?),
    ];
    words(&mut drawing, 60.0, &guide);

    // The disc, and the sample between its two rough contacts.
    body(&mut drawing, 97.0, 56.0, 9.0, STEEL);
    drawing.text((AXIS, 101.7), "massive steel disc", 8.0, Align::Center, Color::BLACK);
    drawing.rect((AXIS - 4.0, 106.0), (8.0, 5.0), STEEL, line);
    drawing.ground((AXIS - 14.0, 111.0), (AXIS + 14.0, 111.0), line);
    body(&mut drawing, 80.0, 7.0, 17.0, ALUMINIUM.mix(Color::ORANGE, 0.25));
    for y in [80.0, 97.0] {
        let rough: Vec<(f64, f64)> = (0..=14)
            .map(|n| (AXIS - 3.5 + 0.5 * f64::from(n), y + if n % 2 == 0 { -0.45 } else { 0.45 }))
            .collect();
        drawing.line(&rough, Stroke(Color::RED, 0.8));
    }
    lead(&mut drawing, AXIS + 3.5, 84.5);
    let sample = [
        "sample Ω₂, aluminium".to_owned(),
        format!("L = {:.0} mm", 1e3 * value("sample:length_m")?),
        format!("m = {:.2} g", 1e3 * value("sample:mass_kg")?),
    ];
    words(&mut drawing, 84.5, &sample);
    let red = |drawing: &mut Sketch, y: f64, text: &str| {
        drawing.text((AXIS - 6.0, y), text, 7.0, Align::Right, Color::RED);
    };
    red(&mut drawing, 85.0, "rough contacts");
    red(&mut drawing, 88.9, &format!("S₂ = {:.0} mm²", 1e6 * value("contact:area_m2")?));
    let pressure = format!("σ₀ = {:.2} MPa", 1e-6 * value("contact:pressure_pa")?);
    red(&mut drawing, 92.8, &pressure);
    Ok(drawing.to_svg())
}
