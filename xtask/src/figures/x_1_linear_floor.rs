//! x1: how much of A2/A1 is the second harmonic.

use anyhow::Result;
use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_signal::FrequencyResponse;
use asperity_table::Table;

use super::style;
use crate::reproduce::rig::{Case, Law, Rig};
use crate::reproduce::{Computed, PaperFigure};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x1",
    title: "x1: the linear floor under A2/A1",
    caption: "Each law struck with +F and with -F; half the sum of the two responses is their \
              even part, half the difference the odd part. Magnitude of the receptance at twice \
              the fundamental over that at the fundamental: the blow with +F (lines), the even \
              part (markers), which vanishes in proportion to the force, and the odd part \
              (dotted), which tends to the flank of a linear oscillator, nearly 2 xi / 3 \
              (dashed). Of a weak blow the ratio says nothing about the contact. The split ends \
              at 5 N: beyond, the pull is no mirror image of the push any more.",
    compute,
    draw,
};

/// Peak forces in N.
const FORCES: [f64; 14] =
    [0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 9.0, 12.0, 16.0, 20.0, 25.0, 32.0];
/// The largest of them at which the response is split, in N.
const SPLIT: f64 = 5.0;
const LAWS: [(Law, &str); 2] = [(Law::Power, "pl"), (Law::Modified, "modified")];

fn compute(rig: &Rig) -> Result<Computed> {
    let forces = FORCES;
    let mut table = Table::new().with_column("force_n", forces)?;
    for (law, name) in LAWS {
        let signed: Vec<f64> = forces.iter().flat_map(|&force| [force, -force]).collect();
        let cases: Vec<Case> =
            signed.iter().map(|&force| rig.struck(law, force)).collect::<Result<_>>()?;
        let runs = rig.observe(&cases, |_, run| {
            let history = &run.transient.history;
            Ok((history.force.clone(), history.displacement.clone(), run.summary.clone()))
        })?;
        let rate = cases[0].scenario.output_rate_hz;
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for (pair, peak) in runs.chunks_exact(2).zip(forces) {
            let ((force, push, summary), (_, pull, _)) = (&pair[0], &pair[1]);
            let half = |sign: f64| -> Vec<f64> {
                push.iter().zip(pull).map(|(a, b)| 0.5 * (a + sign * b)).collect()
            };
            let odd = FrequencyResponse::from_displacement(force, &half(-1.0), rate)?;
            let even = FrequencyResponse::from_displacement(force, &half(1.0), rate)?;
            let first = summary.fundamental.map_or(f64::NAN, |peak| peak.frequency_hz);
            let ratio = |of: &FrequencyResponse, over: &FrequencyResponse| {
                of.receptance_at(2.0 * first).norm() / over.receptance_at(first).norm()
            };
            let whole = FrequencyResponse::from_displacement(force, push, rate)?;
            columns[0].push(ratio(&whole, &whole));
            let split = peak <= SPLIT;
            columns[1].push(if split { ratio(&even, &odd) } else { f64::NAN });
            columns[2].push(if split { ratio(&odd, &odd) } else { f64::NAN });
        }
        for (quantity, column) in ["ratio_at_2_f1", "even_ratio", "odd_ratio"].iter().zip(columns) {
            table.push(format!("{name}:{quantity}"), column)?;
        }
    }
    let assembly = rig.struck(Law::Constant, 32.0)?.assembly()?;
    let natural = asperity_study::static_state::StaticSummary::of(&assembly).natural_frequency_hz;
    let ratio = natural
        .map_or(f64::NAN, |f| assembly.structure.damping_rate() / (4.0 * std::f64::consts::PI * f));
    table.push("linear_floor", vec![2.0 * ratio / 3.0; forces.len()])?;
    Ok(Computed { table, values: Vec::new() })
}

fn draw(table: &Table) -> Result<String> {
    let force = table.column("force_n")?;
    let mut panel = Panel::new(Axis::log("Force", "N"), Axis::log("Ratio to the fundamental", ""))
        .legend(Legend::Above);
    for (name, label) in [("pl", "PL"), ("modified", "Modified PL")] {
        let column = |quantity: &str| table.column(&format!("{name}:{quantity}"));
        let mark = |series: Series| {
            if name == "pl" { style::power(series) } else { style::modified(series) }
        };
        let color = if name == "pl" { Color::BLACK } else { Color::BLUE };
        panel = panel
            .series(
                Series::line(format!("{label}: +F"), force, column("ratio_at_2_f1")?).color(color),
            )
            .series(mark(Series::points(format!("{label}: even"), force, column("even_ratio")?)))
            .series(
                Series::line(format!("{label}: odd"), force, column("odd_ratio")?)
                    .color(color)
                    .dash(Dash::Dotted),
            );
    }
    let floor = Series::line("2 ξ / 3", force, table.column("linear_floor")?);
    let panel = panel.series(floor.color(Color::GREY).dash(Dash::Dashed));
    let figure = Figure::new("The linear floor under A2/A1").panel(panel);
    style::svg(&figure.width_mm(style::COLUMN))
}
