//! x4: loss of contact and its influence on the response.

use anyhow::Result;
use asperity_figure::{Axis, Legend, Panel};
use asperity_simulation::summary::Summary;
use asperity_table::Table;

use super::levels::{
    CONTACT_LOST, FREQUENCY, HARMONIC_RATIO, Observable, PRESSURE_MIN, both_laws, column,
};
use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x4",
    title: "x4: loss of contact",
    caption: "Both laws struck with 5 to 80 N, beyond the paper's range, which ends at the dashed \
              line: (a) time without contact between guide bar and sample, (b) fundamental, (c) \
              A2/A1 and (d) lowest contact pressure. The power law loses contact within the \
              paper's range, from the threshold in the table on; its fundamental then falls \
              faster and its A2/A1 overtakes that of the modified law. The modified law, soft \
              at low pressure, keeps contact throughout.",
    compute,
    draw,
};

/// Tolerance of the thresholds, in N.
const TOLERANCE: f64 = 0.02;

const QUANTITIES: [(&str, Observable); 5] = [
    ("contact_lost_s", CONTACT_LOST),
    ("frequency_hz", FREQUENCY),
    ("harmonic_ratio", HARMONIC_RATIO),
    ("pressure_min_pa", PRESSURE_MIN),
    ("pressure_max_pa", |summary| Some(summary.interfaces.first()?.pressure_max_pa)),
];

fn compute(rig: &Rig) -> Result<Computed> {
    let forces: Vec<f64> = (2..=32).map(|n| 2.5 * f64::from(n)).collect();
    let mut columns = Columns::default();
    columns.push("force_n", forces.as_slice());
    for law in [Law::Power, Law::Modified] {
        let summaries = rig.summaries(&rig.struck_with(law, &forces)?)?;
        for (quantity, of) in QUANTITIES {
            columns.push(format!("{}:{quantity}", law.key()), column(&summaries, of));
        }
        let first = summaries.iter().position(|summary| lost(summary));
        let threshold = match first {
            Some(index) if index > 0 => bisect(rig, law, forces[index - 1], forces[index])?,
            _ => f64::NAN,
        };
        columns.push(format!("{}:threshold_n", law.key()), [threshold]);
    }
    columns.computed()
}

/// True if any contact was lost.
fn lost(summary: &Summary) -> bool {
    summary.interfaces.iter().any(|contact| contact.contact_lost_s > 0.0)
}

/// The force above which contact is lost, between one that keeps it and one that does not.
fn bisect(rig: &Rig, law: Law, mut keeps: f64, mut loses: f64) -> Result<f64> {
    while loses - keeps > TOLERANCE {
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
    let panel = |quantity: &str, axis: Axis, legend: Legend| -> Result<Panel> {
        let force = Axis::linear("Force", "N").range(0.0, 82.0);
        Ok(both_laws(table, quantity, force, axis)?.vertical(32.0, "").legend(legend))
    };
    let lost = Axis::linear("Time without contact", "ms").scale(1e3);
    let frequency = Axis::linear("Frequency f_{1}", "Hz");
    let ratio = Axis::linear("Ratio A_{2}/A_{1}", "").low(0.0);
    let lowest = Axis::linear("Lowest pressure", "MPa").scale(1e-6);
    let panels = [
        panel("contact_lost_s", lost, Legend::TopLeft)?,
        panel("frequency_hz", frequency, Legend::None)?,
        panel("harmonic_ratio", ratio, Legend::None)?,
        panel("pressure_min_pa", lowest, Legend::None)?,
    ];
    style::svg("Loss of contact", panels)
}
