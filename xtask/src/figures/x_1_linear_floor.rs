//! x1: how much of A2/A1 is the second harmonic.

use anyhow::Result;
use asperity_figure::{Axis, Color, Dash, Legend, Marker, Panel, Series};
use asperity_signal::FrequencyResponse;
use asperity_table::Table;

use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

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

fn compute(rig: &Rig) -> Result<Computed> {
    let mut table = Table::new().with_column("force_n", FORCES)?;
    let signed: Vec<f64> = FORCES.iter().flat_map(|&force| [force, -force]).collect();
    for law in [Law::Power, Law::Modified] {
        let cases = rig.struck_with(law, &signed)?;
        let runs = rig.observe(&cases, |_, run| {
            let history = &run.transient.history;
            Ok((history.load.clone(), history.sensors[0].displacement.clone(), run.summary.clone()))
        })?;
        let rate = cases[0].scenario.output_rate_hz;
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for (pair, peak) in runs.chunks_exact(2).zip(FORCES) {
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
            table.push(format!("{}:{quantity}", law.key()), column)?;
        }
    }
    let assembly = rig.struck(Law::Constant, 32.0)?.assembly()?;
    let natural =
        asperity_simulation::static_state::StaticSummary::of(&assembly).natural_frequency_hz;
    let ratio = natural
        .map_or(f64::NAN, |f| assembly.structure.damping_rate() / (4.0 * std::f64::consts::PI * f));
    table.push("linear_floor", vec![2.0 * ratio / 3.0; FORCES.len()])?;
    Ok(Computed { table, values: Vec::new() })
}

fn draw(table: &Table) -> Result<String> {
    let force = table.column("force_n")?;
    let mut panel = Panel::new(Axis::log("Force", "N"), Axis::log("Ratio to the fundamental", ""))
        .legend(Legend::Above);
    for (name, label, marker, color) in [
        ("pl", "PL", Marker::Circle, Color::BLACK),
        ("modified", "Modified PL", Marker::Triangle, Color::BLUE),
    ] {
        let column = |quantity: &str| table.column(&format!("{name}:{quantity}"));
        let whole = Series::line(format!("{label}: +F"), force, column("ratio_at_2_f1")?);
        let even = Series::points(format!("{label}: even"), force, column("even_ratio")?);
        let odd = Series::line(format!("{label}: odd"), force, column("odd_ratio")?);
        let series = [whole, even.marker(marker), odd.dash(Dash::Dotted)];
        panel = panel.all_series(series.map(|series| series.color(color)));
    }
    let floor = Series::line("2 ξ / 3", force, table.column("linear_floor")?);
    let panel = panel.series(floor.color(Color::GREY).dash(Dash::Dashed));
    style::svg("The linear floor under A2/A1", [panel])
}
