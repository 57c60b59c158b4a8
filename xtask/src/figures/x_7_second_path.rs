//! x7: Figs. 7, 8, 11 and 12 once more, by way of files and the analysis of measured hits.

use std::slice;

use anyhow::{Context, Result, ensure};
use asperity_experiment::{AnalysisOptions, FrequencyBand, HitCount, ResponseChoice, analyse};
use asperity_figure::{Axis, Legend, Marker, Series};
use asperity_measure::{Format, WriteOptions, write};
use asperity_simulation::record::measurement_record;
use asperity_simulation::run::Run;
use asperity_table::Table;

use super::levels::{both_laws, force_axis};
use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Case, Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x7",
    title: "x7: Figs. 7, 8, 11 and 12 by way of the analysis of measured hits",
    caption: "Fundamental, its receptance and the second-harmonic ratio of runs that were written \
              as universal files (58b), force and acceleration, and read and analysed as a \
              measurement is (hollow), over those of the runs themselves from displacement (lines, \
              filled). Power law black, modified power law blue. The table has both; they must \
              agree to 5e-4.",
    compute,
    draw,
};

/// Peak forces, in N.
const FORCES: [f64; 5] = [9.0, 15.0, 20.0, 26.0, 32.0];

/// Largest relative difference of the two paths; 2.4e-4 was found, in the ratio at 9 N. By way of
/// acceleration, divided by the squared frequency, what is left at the end of a record counts
/// differently, and most in what is small.
const TOLERANCE: f64 = 5e-4;

/// Fundamental, its receptance and the harmonic ratio.
type Observed = [f64; 3];

const QUANTITIES: [&str; 3] = ["frequency_hz", "receptance_m_per_n", "harmonic_ratio"];

fn compute(rig: &Rig) -> Result<Computed> {
    let mut table = Table::new().with_column("force_n", FORCES)?;
    for law in [Law::Power, Law::Modified] {
        let (name, cases) = (law.key(), rig.struck_with(law, &FORCES)?);
        let found = rig.observe(&cases, both_paths)?;
        for (i, quantity) in QUANTITIES.iter().enumerate() {
            for (direct, measured) in &found {
                let off = (measured[i] / direct[i] - 1.0).abs();
                ensure!(off <= TOLERANCE, "{name}, {quantity}: the two paths differ by {off:e}");
            }
            let column = |of: fn(&(Observed, Observed)) -> &Observed| -> Vec<f64> {
                found.iter().map(|pair| of(pair)[i]).collect()
            };
            table.push(format!("{name}:{quantity}"), column(|pair| &pair.0))?;
            table.push(format!("{name}:measured:{quantity}"), column(|pair| &pair.1))?;
        }
    }
    Ok(Computed { table, values: Vec::new() })
}

/// The observables of a run from its summary, and by way of a file.
fn both_paths(_: &Case, run: &Run) -> Result<(Observed, Observed)> {
    let summary = &run.summary;
    let first = summary.fundamental.context("the run has no fundamental")?;
    let ratio = summary.harmonic_ratio.context("the run has no second harmonic")?;
    let direct = [first.frequency_hz, first.amplitude.value(), ratio];

    let natural = summary.at_rest.natural_frequency_hz.context("the rig has no frequency")?;
    let folder = tempfile::tempdir().context("no temporary folder")?;
    let file = folder.path().join("hit.uff");
    let record = measurement_record(run, None);
    write(&file, slice::from_ref(&record), Format::UniversalBinary, &WriteOptions::default())?;
    let options = AnalysisOptions {
        responses: ResponseChoice::of(&["acceleration".into()]),
        hits: HitCount::Strongest(1),
        band_hz: Some(FrequencyBand { low_hz: 0.4 * natural, high_hz: 1.4 * natural }),
        ..AnalysisOptions::default()
    };
    let analysis = analyse(&[file], &options)?;
    let response = analysis.responses.first().context("no response in the file")?;
    let hit = response.report.hits.first().context("no hit was found in the file")?;
    let first = hit.fundamental.context("the file's hit has no fundamental")?;
    let second = hit.second_peak.as_ref().context("the file's hit has no second peak")?;
    let ratio = second.ratio;
    Ok((direct, [first.frequency_hz, first.magnitude, ratio]))
}

fn draw(table: &Table) -> Result<String> {
    let force = table.column("force_n")?;
    let mut panels = Vec::new();
    let axes = [
        Axis::linear("Fundamental f_{1}", "Hz"),
        Axis::linear("Amplitude A_{1}", "m/N"),
        Axis::linear("Ratio A_{2}/A_{1}", ""),
    ];
    for (quantity, axis) in QUANTITIES.into_iter().zip(axes) {
        let hollow = |law: &str| -> Result<Series> {
            let column = table.column(&format!("{law}:measured:{quantity}"))?;
            Ok(Series::points("", force, column).marker(Marker::Square).marker_size(7.0))
        };
        let legend = if quantity == QUANTITIES[2] { Legend::TopLeft } else { Legend::None };
        let panel = both_laws(table, quantity, force_axis(), axis)?
            .all_series([hollow("pl")?, hollow("modified")?]);
        panels.push(panel.legend(legend));
    }
    style::svg("The second path", panels)
}
