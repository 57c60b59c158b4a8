//! x6: the natural frequencies under each reading of the paper's gaps.

use anyhow::Result;
use asperity_figure::{Axis, Color, Legend, Panel, Series};
use asperity_law::fit_power;
use asperity_table::Table;

use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Case, Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x6",
    title: "x6: natural frequencies under each reading",
    caption: "Lowest (filled) and next (hollow) natural frequency at rest. 1: each body with its \
              own section, constant 8.5e11 Pa/m, the reading taken. 2: Table 2 with the section \
              S2 for the guide bar and only its density scaled to its mass, same stiffness. 3 \
              and 4: the stiffnesses quoted with Fig. 9, 0.4e12 and 0.12e12 Pa/m, as averages. \
              5: power law. 6: modified power law. Dashed: the paper's 800 Hz. The table also \
              has the damping factor h = 2 xi w0 of each, and Table 3 fitted as ln K and as K.",
    compute,
    draw,
};

/// The rig with a constant stiffness at both contacts, and `more` changes.
fn constant(rig: &Rig, stiffness: f64, more: &[(&str, String)]) -> Result<Case> {
    let stiffness = ("/laws/constant/stiffness_pa_per_m", stiffness.to_string());
    rig.with(Law::Constant, &[&[stiffness], more].concat())
}

fn compute(rig: &Rig) -> Result<Computed> {
    // The density that gives a guide bar of section S2 its mass of 1.61 kg.
    let structure = rig.struck(Law::Constant, 32.0)?.assembly()?.structure;
    let (guide, area) = (&structure.stack().bodies()[0], structure.contacts()[0].area());
    let density = guide.mass() / (guide.length() * area);
    let cases = [
        constant(rig, 8.5e11, &[])?,
        constant(rig, 8.5e11, &[("/bodies/0/density_kg_per_m3", density.to_string())])?,
        constant(rig, 0.4e12, &[])?,
        constant(rig, 0.12e12, &[])?,
        rig.struck(Law::Power, 32.0)?,
        rig.struck(Law::Modified, 32.0)?,
    ];
    let (mut lowest, mut next, mut damping) = (Vec::new(), Vec::new(), Vec::new());
    for case in &cases {
        let [first, second] = case.natural_frequencies()?;
        lowest.push(first);
        next.push(second);
        damping.push(case.assembly()?.structure.damping_rate());
    }
    let points = cases[0].table_3()?;
    let logarithms = fit_power(&points)?;
    let (coefficient, exponent) = fit_stiffness(&points);
    let mut columns = Columns::default();
    columns.push("reading", (1..=cases.len()).map(|n| n as f64).collect::<Vec<_>>());
    columns.push("natural_frequency_hz", lowest);
    columns.push("next_mode_hz", next);
    columns.push("damping_rate_1_per_s", damping);
    columns.push("fit_of_logarithms:coefficient", [logarithms.coefficient]);
    columns.push("fit_of_logarithms:exponent", [logarithms.exponent]);
    columns.push("fit_of_stiffness:coefficient", [coefficient]);
    columns.push("fit_of_stiffness:exponent", [exponent]);
    columns.computed()
}

/// Coefficient and exponent that make the squares of `K - C p^m` least.
fn fit_stiffness(points: &[(f64, f64)]) -> (f64, f64) {
    let coefficient = |m: f64| {
        let above: f64 = points.iter().map(|(p, k)| k * p.powf(m)).sum();
        above / points.iter().map(|(p, _)| p.powf(2.0 * m)).sum::<f64>()
    };
    let squares = |m: f64| -> f64 {
        let c = coefficient(m);
        points.iter().map(|(p, k)| (k - c * p.powf(m)).powi(2)).sum()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let third = (high - low) / 3.0;
        if squares(low + third) < squares(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    let exponent = 0.5 * (low + high);
    (coefficient(exponent), exponent)
}

fn draw(table: &Table) -> Result<String> {
    let reading = table.column("reading")?;
    let ticks: Vec<(f64, String)> = reading.iter().map(|&n| (n, format!("{n:.0}"))).collect();
    let series = |label: &str, column: &str| -> Result<Series> {
        let series = Series::points(label, reading, table.column(column)?);
        Ok(series.color(Color::BLUE).marker_size(5.0))
    };
    let panel = Panel::new(
        Axis::linear("Reading", "").range(0.5, reading.len() as f64 + 0.5).ticks(ticks),
        Axis::log("Natural frequency", "Hz").range(200.0, 20000.0),
    )
    .series(series("lowest", "natural_frequency_hz")?.filled(true))
    .series(series("next", "next_mode_hz")?)
    .horizontal(800.0, "")
    .legend(Legend::Above);
    style::svg("Natural frequencies", [panel])
}
