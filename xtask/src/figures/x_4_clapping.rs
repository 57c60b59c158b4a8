//! x4: where contact is lost, and what follows.

use anyhow::Result;
use asperity_figure::{Axis, Figure, Legend, Panel, Series};
use asperity_study::summary::Summary;
use asperity_table::Table;

use super::style;
use crate::reproduce::rig::{Case, Law, Rig};
use crate::reproduce::{Computed, PaperFigure};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x4",
    title: "x4: where contact is lost",
    caption: "Both laws struck with 5 to 80 N, beyond the paper's range, which ends at the dashed \
              line: (a) time without contact between guide bar and sample, (b) fundamental, (c) \
              A2/A1 and (d) lowest contact pressure. The power law loses contact within the \
              paper's range, from the threshold in the table on; its fundamental then falls \
              faster and its A2/A1 overtakes that of the modified law. The modified law, soft \
              at low pressure, keeps contact throughout.",
    compute,
    draw,
};

const LAWS: [(Law, &str); 2] = [(Law::Power, "pl"), (Law::Modified, "modified")];
/// Tolerance of the thresholds, in N.
const CLOSE: f64 = 0.02;

type Quantity = (&'static str, fn(&Summary) -> Option<f64>);
const QUANTITIES: [Quantity; 5] = [
    ("contact_lost_s", |summary| summary.interfaces.first().map(|c| c.contact_lost_s)),
    ("frequency_hz", |summary| summary.fundamental.map(|peak| peak.frequency_hz)),
    ("harmonic_ratio", |summary| summary.harmonic_ratio),
    ("pressure_min_pa", |summary| summary.interfaces.first().map(|c| c.pressure_min_pa)),
    ("pressure_max_pa", |summary| summary.interfaces.first().map(|c| c.pressure_max_pa)),
];

fn compute(rig: &Rig) -> Result<Computed> {
    let forces: Vec<f64> = (2..=32).map(|n| 2.5 * f64::from(n)).collect();
    let mut table = Table::new().with_column("force_n", forces.as_slice())?;
    for (law, name) in LAWS {
        let cases: Vec<Case> =
            forces.iter().map(|&force| rig.struck(law, force)).collect::<Result<_>>()?;
        let summaries = rig.summaries(&cases)?;
        for (quantity, of) in QUANTITIES {
            let column: Vec<f64> =
                summaries.iter().map(|summary| of(summary).unwrap_or(f64::NAN)).collect();
            table.push(format!("{name}:{quantity}"), column)?;
        }
        let first = summaries.iter().position(|summary| lost(summary));
        let threshold = match first {
            Some(index) if index > 0 => bisect(rig, law, forces[index - 1], forces[index])?,
            _ => f64::NAN,
        };
        let mut column = vec![f64::NAN; forces.len()];
        column[0] = threshold;
        table.push(format!("{name}:threshold_n"), column)?;
    }
    Ok(Computed { table, values: Vec::new() })
}

/// True if any contact was lost.
fn lost(summary: &Summary) -> bool {
    summary.interfaces.iter().any(|contact| contact.contact_lost_s > 0.0)
}

/// The force above which contact is lost, between one that keeps it and one that does not.
fn bisect(rig: &Rig, law: Law, mut keeps: f64, mut loses: f64) -> Result<f64> {
    while loses - keeps > CLOSE {
        let middle = 0.5 * (keeps + loses);
        let summaries = rig.summaries(&[rig.struck(law, middle)?])?;
        if lost(&summaries[0]) {
            loses = middle;
        } else {
            keeps = middle;
        }
    }
    Ok(0.5 * (keeps + loses))
}

fn draw(table: &Table) -> Result<String> {
    let force = table.column("force_n")?;
    let panel = |quantity: &str, axis: Axis, legend: Legend| -> Result<Panel> {
        let series = |label: &str, law: &str| -> Result<Series> {
            let column = table.column(&format!("{law}:{quantity}"))?;
            Ok(Series::line_points(label, force, column).width(0.6))
        };
        Ok(Panel::new(Axis::linear("Force", "N").range(0.0, 82.0), axis)
            .series(style::power(series("PL", "pl")?))
            .series(style::modified(series("Modified PL", "modified")?))
            .vertical(32.0, "")
            .legend(legend))
    };
    let lost = Axis::linear("Time without contact", "ms").scale(1e3);
    let lowest = Axis::linear("Lowest pressure", "MPa").scale(1e-6);
    let figure = Figure::new("Where contact is lost")
        .panel(panel("contact_lost_s", lost, Legend::TopLeft)?)
        .panel(panel("frequency_hz", Axis::linear("Frequency f_{1}", "Hz"), Legend::None)?)
        .panel(panel(
            "harmonic_ratio",
            Axis::linear("Ratio A_{2}/A_{1}", "").low(0.0),
            Legend::None,
        )?)
        .panel(panel("pressure_min_pa", lowest, Legend::None)?);
    style::svg(&figure.columns(2).width_mm(style::PAGE))
}
