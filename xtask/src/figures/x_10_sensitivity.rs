//! x10: which inputs decide the response, by Sobol indices.

use anyhow::{Context, Result, bail, ensure};
use asperity_figure::{Axis, Color, Legend, Marker, Panel, Series};
use asperity_sampling::{IntervalEstimate, SensitivitySums, SobolIndices};
use asperity_scenario::Document;
use asperity_simulation::quantity::Quantity;
use asperity_study::StudyPlan;
use asperity_study::spec::{DistributionSpec, StudyDesign};
use asperity_table::Table;

use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x10",
    title: "x10: which inputs decide the response at 32 N",
    caption: "Sobol indices of eight inputs with 95 % bootstrap intervals: first (hollow), the share \
              of the variance that an input explains alone, and total (filled), the share that \
              remains if all others are known. Even distributions: K(0.078 MPa) and K(0.14 MPa) \
              within 15 % of the reconstruction, as Table 3 scatters about its power law; C within \
              10 %, which Table 3 leaves to it; damping ratio within 20 %, rise of the gamma pulse \
              within 15 %, peak force, mass of the bar, and area of sample and contacts within 5 %. \
              Saltelli's design of 256 base rows, 2560 modal runs. The rise of the pulse decides the \
              lowest pressure and is the first of four inputs that decide f1; K(0.14 MPa) and the \
              damping ratio decide A1; K(0.14 MPa) and K(0.078 MPa) are the first for A2/A1. The \
              table has the ranges, means and standard deviations, too.",
    compute,
    draw,
};

/// Base rows of a first look.
const QUICK_BASE_ROWS: &str = "16";

const REPLICATES: usize = 500;
const LEVEL: f64 = 0.95;

/// Labels of the inputs, in the order of the study.
const INPUTS: [&str; 8] =
    ["K(0.078 MPa)", "K(0.14 MPa)", "C", "damping", "peak force", "rise", "bar mass", "area"];
const K_0_078: usize = 0;
const K_0_14: usize = 1;
const DAMPING: usize = 3;
const RISE: usize = 5;

/// An output: its column, the quantity, its interface, and the inputs that the caption names for it.
struct Output {
    column: &'static str,
    quantity: Quantity,
    interface: Option<usize>,
    label: &'static str,
    leading: &'static [usize],
}

const OUTPUTS: [Output; 4] = [
    Output {
        column: "frequency_hz",
        quantity: Quantity::FundamentalFrequency,
        interface: None,
        label: "f_{1}",
        leading: &[RISE],
    },
    Output {
        column: "receptance_m_per_n",
        quantity: Quantity::FundamentalReceptance,
        interface: None,
        label: "A_{1}",
        leading: &[K_0_14, DAMPING],
    },
    Output {
        column: "harmonic_ratio",
        quantity: Quantity::HarmonicRatio,
        interface: None,
        label: "A_{2}/A_{1}",
        leading: &[K_0_14, K_0_078],
    },
    Output {
        column: "pressure_min_pa",
        quantity: Quantity::PressureMin,
        interface: Some(0),
        label: "lowest pressure",
        leading: &[RISE],
    },
];

fn compute(rig: &Rig) -> Result<Computed> {
    let mut document =
        Document::read(crate::workspace::workspace_root().join("fixtures/paper/sensitivity.json"))?;
    if rig.is_quick() {
        document.set("/design/base_rows", QUICK_BASE_ROWS)?;
    }
    let plan = StudyPlan::of(document)?;
    let same = rig.with(Law::Modified, &[("/method", "modal".to_owned())])?;
    ensure!(plan.scenario().value() == same.document.value(), "the study is of another rig");
    ensure!(plan.dimensions() == INPUTS.len(), "the study has other inputs");
    let StudyDesign::Saltelli { seed, .. } = plan.spec().design else {
        bail!("Sobol indices need Saltelli's design");
    };
    let rows = plan.values(0..plan.rows())?;
    let runs = plan.simulator()?.run(&rows).into_iter().collect::<Result<Vec<_>, _>>()?;

    let mut columns = Columns::default();
    columns.push("input", (1..=INPUTS.len()).map(|number| number as f64).collect::<Vec<_>>());
    let ends = ranges(&plan)?;
    columns.push("range:low", ends.iter().map(|end| end[0]).collect::<Vec<_>>());
    columns.push("range:high", ends.iter().map(|end| end[1]).collect::<Vec<_>>());
    for output in &OUTPUTS {
        let mut sums = SensitivitySums::new(INPUTS.len(), REPLICATES, seed)?;
        for (base, runs) in (0..).zip(runs.chunks_exact(INPUTS.len() + 2)) {
            let value = |run: &asperity_simulation::observables::Observables| {
                run.get(output.quantity, output.interface).unwrap_or(f64::NAN)
            };
            sums.add(base, &runs.iter().map(value).collect::<Vec<_>>());
        }
        let indices = sums.indices(LEVEL)?;
        ensure!(indices.left_out == 0, "{}: {} rows without it", output.column, indices.left_out);
        if !rig.is_quick() {
            check_leading(output, &indices)?;
        }
        push(&mut columns, output.column, &indices);
    }
    columns.computed()
}

/// Ends of the even distribution of each input.
fn ranges(plan: &StudyPlan) -> Result<Vec<[f64; 2]>> {
    let ends = |input: &asperity_study::spec::InputSpec| match input.distribution {
        Some(DistributionSpec::Uniform { lower, upper }) => Ok([lower, upper]),
        _ => bail!("the caption states even distributions; {} has another", input.pointer),
    };
    plan.spec().inputs.iter().map(ends).collect()
}

/// The inputs that the caption names must have the largest total indices.
fn check_leading(output: &Output, indices: &SobolIndices) -> Result<()> {
    let total = |input: &usize| indices.total[*input].value;
    let least = output.leading.iter().map(total).min_by(f64::total_cmp).context("an input")?;
    let others = (0..INPUTS.len()).filter(|input| !output.leading.contains(input));
    let largest = others.map(|input| total(&input)).fold(0.0, f64::max);
    ensure!(least > largest, "{}: the caption names other inputs", output.column);
    Ok(())
}

fn push(columns: &mut Columns, output: &str, indices: &SobolIndices) {
    for (order, all) in [("first", &indices.first), ("total", &indices.total)] {
        let mut column = |name: &str, of: fn(&IntervalEstimate) -> f64| {
            let values: Vec<f64> = all.iter().map(of).collect();
            columns.push(format!("{output}:{order}:{name}"), values);
        };
        column("fit", |index| index.value);
        column("lower", |index| index.low);
        column("upper", |index| index.high);
    }
    columns.push(format!("{output}:mean:fit"), [indices.mean]);
    columns.push(format!("{output}:standard_deviation:fit"), [indices.variance.sqrt()]);
}

fn draw(table: &Table) -> Result<String> {
    // The first input on top.
    let place = |input: usize| (INPUTS.len() - input) as f64;
    let ticks: Vec<(f64, &str)> =
        INPUTS.iter().enumerate().map(|(input, name)| (place(input), *name)).collect();
    let panel = |output: &Output| -> Result<Panel> {
        let x_axis = Axis::linear("Sobol index", "").range(-0.2, 1.1);
        let y_axis = Axis::linear("Input", "").range(0.4, INPUTS.len() as f64 + 0.6);
        let mut panel = Panel::new(x_axis, y_axis.ticks(ticks.clone())).title(output.label);
        let orders = [("first", 0.16, Color::BLUE, false), ("total", -0.16, Color::ORANGE, true)];
        for (order, offset, color, filled) in orders {
            let column = |name: &str| table.column(&format!("{}:{order}:{name}", output.column));
            let (value, low, high) = (column("fit")?, column("lower")?, column("upper")?);
            let at = |input: usize| place(input) + offset;
            let (mut x, mut y) = (Vec::new(), Vec::new());
            for input in 0..INPUTS.len() {
                // A gap between intervals.
                x.extend([low[input], high[input], f64::NAN]);
                y.extend([at(input), at(input), f64::NAN]);
            }
            let heights: Vec<f64> = (0..INPUTS.len()).map(at).collect();
            panel = panel.series(Series::line("", x, y).color(color).width(0.9)).series(
                Series::points(order, value, heights)
                    .color(color)
                    .marker(if filled { Marker::Circle } else { Marker::Diamond })
                    .filled(filled)
                    .marker_size(4.0),
            );
        }
        Ok(panel.legend(Legend::BottomRight))
    };
    let panels = OUTPUTS.iter().map(panel).collect::<Result<Vec<_>>>()?;
    let figure = style::figure("Inputs that decide the response", panels);
    style::checked(&figure.row_height_mm(64.0))
}
