//! `asperity modes`.

use asperity_structure::LinearisedMode;
use asperity_study::assemble::Assembly;
use asperity_study::provenance::Provenance;
use asperity_study::record::modes_csv;
use asperity_study::static_state::StaticSummary;
use serde_json::json;

use super::ResultFolder;
use crate::args::{Input, Output};
use crate::failure::Failure;
use crate::plot;

/// Positions along each body at which a mode shape is written.
const PLACES: usize = 51;

/// Computes natural frequencies, damping ratios and mode shapes about static equilibrium.
pub(crate) fn run(input: &Input, output: &Output, count: usize) -> Result<(), Failure> {
    let document = super::read(input)?;
    let scenario = super::checked(&document)?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    let found = assembly.structure.modes(count)?;
    let folder = ResultFolder::claim("modes", document.path(), output)?;

    let (places, shapes) = shapes(&assembly, &found);
    folder.write("modes.csv", modes_csv(&places, &found, &shapes))?;
    folder.draw("modes", &plot::modes(&places, &found, &shapes))?;
    let provenance = Provenance::of_scenario(&document, &scenario)?;
    let answer = json!({
        "schema": "asperity/modes/1",
        "title": scenario.title,
        "static": StaticSummary::of(&assembly),
        "modes": found.iter().map(|mode| json!({
            "frequency_hz": mode.frequency_hz,
            "damping_ratio": mode.damping_ratio,
        })).collect::<Vec<_>>(),
        "provenance": provenance,
    });
    let folder = folder.finish("modes.json", &answer, output.json)?;
    if output.json {
        return Ok(());
    }
    for (number, mode) in found.iter().enumerate() {
        let (hz, percent) = (mode.frequency_hz, 100.0 * mode.damping_ratio);
        answer_line!("mode {:<3} {hz:>12.3} Hz   damping {percent:.3} %", number + 1);
    }
    answer_line!("written to {}", folder.display());
    Ok(())
}

/// Positions from the top of the stack down, and each mode's displacement there.
fn shapes(assembly: &Assembly, found: &[LinearisedMode]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut places = Vec::new();
    let mut shapes = vec![Vec::new(); found.len()];
    let mut top = 0.0;
    for (index, body) in assembly.structure.stack().bodies().iter().enumerate() {
        for place in 0..PLACES {
            let fraction = place as f64 / (PLACES - 1) as f64;
            places.push(top + fraction * body.length());
            for (mode, shape) in found.iter().zip(&mut shapes) {
                shape.push(mode.displacement(body, index, fraction));
            }
        }
        top += body.length();
    }
    (places, shapes)
}
