//! x3: convergence of each reported number with the cell.

use anyhow::{Context, Result};
use asperity_figure::{Axis, Color, Dash, Legend, Marker, Panel, Series};
use asperity_law::fit_power;
use asperity_table::Table;

use super::levels::{
    FREQUENCY, HARMONIC_RATIO, Observable, PRESSURE_MIN, RECEPTANCE, STIFFNESS_AVERAGE, column,
};
use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Case, Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x3",
    title: "x3: convergence with the cell",
    caption: "Relative error of each reported number against the cell of the sample, modified \
              power law at 32 N, with (a) the centred contact step used everywhere here and (b) \
              the contact at the new level, the plain reading of the paper's scheme. The \
              reference is the centred step at its two finest cells, 0.25 and 0.125 mm, \
              extrapolated linearly to none. The table has the slopes and the reference. All \
              other figures use 1 mm.",
    compute,
    draw,
};

/// Cells in m, the coarsest first; the last is the reference.
const CELLS: [f64; 5] = [2.2e-3, 1e-3, 0.5e-3, 0.25e-3, 0.125e-3];
/// Number of cells that are shown.
const SHOWN: usize = CELLS.len() - 1;

const QUANTITIES: [(&str, &str, Marker, Observable); 5] = [
    ("frequency", "f_{1}", Marker::Circle, FREQUENCY),
    ("receptance", "A_{1}", Marker::Triangle, RECEPTANCE),
    ("harmonic_ratio", "A_{2}/A_{1}", Marker::Square, HARMONIC_RATIO),
    ("pressure_min", "p_{min}", Marker::Diamond, PRESSURE_MIN),
    ("stiffness_average", "K_{avr}", Marker::Cross, STIFFNESS_AVERAGE),
];

fn case(rig: &Rig, contact: &str, cell: f64) -> Result<Case> {
    let changes = [
        ("/excitation/peak_n", "32".to_owned()),
        ("/method/contact", contact.to_owned()),
        ("/method/cell_m", cell.to_string()),
    ];
    rig.with(Law::Modified, &changes)
}

fn compute(rig: &Rig) -> Result<Computed> {
    let forms = ["centred", "new_level"];
    // The longest run first, so that the others go on beside it.
    let mut cases = vec![case(rig, "centred", CELLS[SHOWN])?];
    for form in forms {
        for cell in CELLS[..SHOWN].iter().rev() {
            cases.push(case(rig, form, *cell)?);
        }
    }
    let summaries = rig.summaries(&cases)?;
    let lengths: Vec<f64> =
        cases[1..=SHOWN].iter().rev().map(cell_length).collect::<Result<_>>()?;
    // Linear in the cell, through the reference run and the finest one shown.
    let (finest, fine) = (cell_length(&cases[0])?, lengths[SHOWN - 1]);
    let exact = |of: Observable| {
        let ends = column(&summaries[..2], of);
        ends[0] + (ends[0] - ends[1]) * finest / (fine - finest)
    };
    let mut columns = Columns::default();
    columns.push("cell_m", lengths.as_slice());
    for (number, form) in forms.iter().enumerate() {
        let runs = &summaries[1 + number * SHOWN..][..SHOWN];
        for (quantity, .., of) in QUANTITIES {
            let values = column(runs, of).into_iter().rev();
            let errors: Vec<f64> = values.map(|value| (value / exact(of) - 1.0).abs()).collect();
            let slope = slope(&lengths, &errors);
            columns.push(format!("{form}:{quantity}_error"), errors);
            columns.push(format!("{form}:{quantity}_slope"), [slope]);
        }
    }
    for (quantity, .., of) in QUANTITIES {
        columns.push(format!("reference:{quantity}"), [exact(of)]);
    }
    columns.computed()
}

/// Length of the sample's cells, in m.
fn cell_length(case: &Case) -> Result<f64> {
    Ok(case.grid()?.bars().last().context("the rig has no sample")?.cell_length())
}

/// Slope of the least-squares line through the logarithms.
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    fit_power(&points).map_or(f64::NAN, |fit| fit.exponent)
}

fn draw(table: &Table) -> Result<String> {
    let cell = table.column("cell_m")?;
    let mut panels = Vec::new();
    for (form, title, level, legend) in [
        ("centred", "centred", 3e-4, Legend::TopLeft),
        ("new_level", "new level", 3e-3, Legend::BottomRight),
    ] {
        let axis = Axis::log("Cell of the sample", "mm").scale(1e3).range(0.2, 3.0);
        let error = Axis::log("Relative error", "").range(1e-7, 0.1);
        let guide: Vec<f64> = cell.iter().map(|c| level * c / 1e-3).collect();
        let guide = Series::line("slope 1", cell, guide).color(Color::GREY).dash(Dash::Dashed);
        let mut panel = Panel::new(axis, error).title(title).legend(legend).series(guide);
        for (quantity, label, marker, _) in QUANTITIES {
            let error = table.column(&format!("{form}:{quantity}_error"))?;
            panel = panel.series(Series::line_points(label, cell, error).marker(marker));
        }
        panels.push(panel);
    }
    style::svg("Convergence with the cell", panels)
}
