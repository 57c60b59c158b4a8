//! x11: Figs. 8, 11 and 12 with the uncertainty of the identified law and pulse.

use anyhow::{Result, ensure};
use asperity_figure::{Axis, Color, Dash, Legend, Marker, Panel, Series};
use asperity_identify::Identification;
use asperity_sampling::WeightedSample;
use asperity_simulation::observables::Observables;
use asperity_simulation::quantity::Quantity;
use asperity_simulation::row_simulator::{Places, RowSimulator};
use asperity_table::Table;
use serde_json::{Value, json};

use super::levels::{FREQUENCY, HARMONIC_RATIO, Observable, RECEPTANCE, column, force_axis};
use super::style;
use super::x_8_identified_law::{Top, modified};
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig, few_levels};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x11",
    title: "x11: Figs. 8, 11 and 12 with the uncertainty of the identified law",
    caption: "Fundamental, its receptance and the second-harmonic ratio of the law and pulse of \
              figure x8: best fit (green line) with bands of 50 % and 95 % of the posterior, each of \
              whose draws was struck with 13 forces; the reconstruction (blue, dashed). Bands hold \
              the uncertainty of law and pulse alone, with the rig, its damping and the shape of the \
              pulse as stated. Red: the experiment as far as the text states it, as ranges: f1 about \
              13 % below the computed one and its drop of 5 %, A1 at 32 N within 10 % of the computed \
              one. The measured points themselves are published as pictures only.",
    compute,
    draw,
};

/// Ends of the bands and the median.
const PROBABILITIES: [(&str, f64); 5] = [
    ("95:lower", 0.025),
    ("50:lower", 0.25),
    ("median", 0.5),
    ("50:upper", 0.75),
    ("95:upper", 0.975),
];

const QUANTITIES: [(&str, Quantity, Observable); 3] = [
    ("frequency_hz", Quantity::FundamentalFrequency, FREQUENCY),
    ("receptance_m_per_n", Quantity::FundamentalReceptance, RECEPTANCE),
    ("harmonic_ratio", Quantity::HarmonicRatio, HARMONIC_RATIO),
];
const AMPLITUDE: usize = 1;
const RATIO: usize = 2;

/// Fundamental at 32 N that the paper computes, in Hz: that of its constant stiffness.
const COMPUTED_FREQUENCY: f64 = 830.9;
/// By how much the measured fundamental is lower, as a share, with half a unit of its last digit.
const OFFSET: [f64; 2] = [0.13, 0.005];
/// Drop of the measured fundamental from 9 to 32 N, likewise.
const DROP: [f64; 2] = [0.05, 0.005];
/// Largest distance of the measured A1 from the computed one, as a share.
const AMPLITUDE_RANGE: f64 = 0.1;

/// A number of the experiment that the text states as a range.
struct Stated {
    quantity: usize,
    force: f64,
    low: f64,
    high: f64,
}

fn compute(rig: &Rig) -> Result<Computed> {
    let found = rig.identified()?;
    let forces = few_levels();
    let draws: Vec<&[f64]> = found.posterior.draws.iter().map(Vec::as_slice).collect();
    let of_draws = curves(&found, &draws, &forces)?;
    let best = curves(&found, &[&found.fit.point], &forces)?;
    let reconstruction = rig.summaries(&rig.struck_with(Law::Modified, &forces)?)?;
    let weights = &found.posterior.weights;

    let mut columns = Columns::default();
    columns.push("force_n", forces.as_slice());
    let mut outer = Vec::new();
    for (number, (name, _, of_summary)) in QUANTITIES.into_iter().enumerate() {
        let band = band(&of_draws, weights, number, forces.len())?;
        columns.push(format!("{name}:fit"), best[0][number].as_slice());
        for ((end, _), values) in PROBABILITIES.iter().zip(&band) {
            columns.push(format!("{name}:{end}"), values.as_slice());
        }
        columns.push(format!("reconstruction:{name}"), column(&reconstruction, of_summary));
        outer.push([band[0].clone(), band[PROBABILITIES.len() - 1].clone()]);
    }
    let computed_amplitude = column(&reconstruction, RECEPTANCE)[forces.len() - 1];
    let stated = stated(computed_amplitude);
    let in_band = |one: &&Stated| {
        let at = forces.iter().position(|force| *force == one.force);
        let [low, high] = &outer[one.quantity];
        at.is_some_and(|at| one.low <= high[at] && low[at] <= one.high)
    };
    let count = stated.iter().filter(in_band).count() as f64;
    let push = |columns: &mut Columns, name: &str, of: &dyn Fn(&Stated) -> f64| {
        columns.push(format!("stated:{name}"), stated.iter().map(of).collect::<Vec<_>>());
    };
    push(&mut columns, "quantity", &|one| one.quantity as f64);
    push(&mut columns, "force_n", &|one| one.force);
    push(&mut columns, "low", &|one| one.low);
    push(&mut columns, "high", &|one| one.high);
    push(&mut columns, "in_band", &|one| super::levels::yes(in_band(&one)));

    let share = |holds: &dyn Fn(&Vec<Vec<f64>>) -> bool| -> f64 {
        let pairs = of_draws.iter().zip(weights).filter(|(curves, _)| holds(curves));
        // Weights sum to 1 but for rounding.
        pairs.map(|(_, weight)| weight).sum::<f64>().min(1.0)
    };
    let rises = share(&|curves| {
        let amplitude = &curves[AMPLITUDE];
        amplitude.last() > amplitude.first()
    });
    let grows = share(&|curves| curves[RATIO].windows(2).all(|pair| pair[1] > pair[0]));
    let mut done = columns.computed()?;
    done.values = vec![
        ("identified_amplitude_rises", rises),
        ("identified_ratio_rises", grows),
        ("stated_experiment_in_band", count),
    ];
    Ok(done)
}

/// The three quantities against force for each point of the parameters.
fn curves(found: &Identification, points: &[&[f64]], forces: &[f64]) -> Result<Vec<Vec<Vec<f64>>>> {
    let document = Rig::identified_scenario()?;
    let scenario = document.scenario()?;
    let (knots, power) = modified(&scenario.laws)?;
    let top = Top::new(knots, power);
    let knot = |number: usize| format!("/laws/modified/knots/{number}/1");
    let mut places: Vec<Places> = (0..knots.len()).map(|number| vec![knot(number)]).collect();
    places.extend(["/excitation/rise_s", "/excitation/peak_n"].map(|place| vec![place.into()]));
    ensure!(found.names.len() == knots.len() + 1, "the identification has other parameters");
    let row = |point: &[f64], force: f64| -> Vec<Value> {
        let (steps, rise) = point.split_at(knots.len());
        let stiffnesses = top.stiffnesses(steps);
        stiffnesses.iter().chain(rise).chain([&force]).map(|value| json!(value)).collect()
    };
    let rows: Vec<Vec<Value>> =
        points.iter().flat_map(|point| forces.iter().map(|&force| row(point, force))).collect();
    let runs = RowSimulator::new(document, places)?.run(&rows);
    let runs = runs.into_iter().collect::<Result<Vec<Observables>, _>>()?;
    let of_point = |runs: &[Observables]| {
        let of = |quantity| runs.iter().map(move |run| run.get(quantity, None).unwrap_or(f64::NAN));
        QUANTITIES.map(|(_, quantity, _)| of(quantity).collect()).to_vec()
    };
    Ok(runs.chunks_exact(forces.len()).map(of_point).collect())
}

/// Quantiles of one quantity at each force, in the order of [`PROBABILITIES`].
fn band(
    curves: &[Vec<Vec<f64>>],
    weights: &[f64],
    quantity: usize,
    forces: usize,
) -> Result<Vec<Vec<f64>>> {
    let mut ends = vec![Vec::new(); PROBABILITIES.len()];
    for at in 0..forces {
        let values = curves.iter().map(|curves| curves[quantity][at]);
        let sample = WeightedSample::new(values.zip(weights.iter().copied()))?;
        ensure!(sample.left_out() == 0, "a draw has no such number");
        for (end, (_, probability)) in ends.iter_mut().zip(PROBABILITIES) {
            end.push(sample.quantile(probability, 0.5)?.value);
        }
    }
    Ok(ends)
}

/// Numbers of the experiment that the text states.
fn stated(computed_amplitude: f64) -> [Stated; 3] {
    let at_32 = OFFSET.map(|share| share * COMPUTED_FREQUENCY);
    let (low, high) =
        (COMPUTED_FREQUENCY - at_32[0] - at_32[1], COMPUTED_FREQUENCY - at_32[0] + at_32[1]);
    let rise = |sign: f64| 1.0 / (1.0 - DROP[0] - sign * DROP[1]);
    [
        Stated { quantity: 0, force: 9.0, low: low * rise(-1.0), high: high * rise(1.0) },
        Stated { quantity: 0, force: 32.0, low, high },
        Stated {
            quantity: AMPLITUDE,
            force: 32.0,
            low: (1.0 - AMPLITUDE_RANGE) * computed_amplitude,
            high: (1.0 + AMPLITUDE_RANGE) * computed_amplitude,
        },
    ]
}

fn draw(table: &Table) -> Result<String> {
    let force = table.column("force_n")?;
    let stated = |name: &str| table.column(&format!("stated:{name}"));
    let (of, at, low, high) =
        (stated("quantity")?, stated("force_n")?, stated("low")?, stated("high")?);
    let panel = |quantity: usize, axis: Axis| -> Result<Panel> {
        let name = QUANTITIES[quantity].0;
        let end = |end: &str| table.column(&format!("{name}:{end}"));
        let band = |label: &str, of: &str, color: Color| -> Result<Series> {
            let (low, high) = (end(&format!("{of}:lower"))?, end(&format!("{of}:upper"))?);
            Ok(Series::band(label, force, low, high).color(color))
        };
        let before = table.column(&format!("reconstruction:{name}"))?;
        let mut panel = Panel::new(force_axis(), axis)
            .series(band("95 %", "95", Color::GREEN)?)
            .series(band("50 %", "50", Color::GREEN.mix(Color::BLACK, 0.8))?)
            .series(Series::line("best fit", force, end("fit")?).color(Color::GREEN).width(0.8))
            .series(
                Series::line("reconstruction", force, before).color(Color::BLUE).dash(Dash::Dashed),
            );
        let rows: Vec<usize> = (0..of.len()).filter(|&row| of[row] == quantity as f64).collect();
        let middle = |row: &usize| 0.5 * (low[*row] + high[*row]);
        let half = |row: &usize| 0.5 * (high[*row] - low[*row]);
        if !rows.is_empty() {
            let forces: Vec<f64> = rows.iter().map(|&row| at[row]).collect();
            let values: Vec<f64> = rows.iter().map(middle).collect();
            let bars: Vec<f64> = rows.iter().map(half).collect();
            let points = Series::points("stated, measured", forces, values).errors(bars);
            panel = panel.series(points.color(Color::RED).marker(Marker::Square).marker_size(4.5));
        }
        Ok(panel.legend(if quantity == 0 { Legend::Auto } else { Legend::None }))
    };
    let panels = [
        panel(0, Axis::linear("Fundamental f_{1}", "Hz").low(700.0))?,
        panel(AMPLITUDE, style::amplitude_axis().low(1.3))?,
        panel(RATIO, Axis::linear("Ratio A_{2}/A_{1}", "").low(0.1))?,
    ];
    let figure = style::figure("Prediction bands of the identified law", panels);
    style::checked(&figure.row_height_mm(58.0))
}
