//! `asperity modes`.

use asperity_plot as plot;
use asperity_scenario::Document;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::modes::{ModesSummary, linearised_modes};
use asperity_simulation::patches::{assemble_patches, mesh_modes, patch_modes};
use asperity_simulation::provenance::Provenance;
use asperity_simulation::record::modes_csv;
use serde_json::json;

use super::ResultFolder;
use crate::args::{Input, Output};
use crate::failure::Failure;

/// Computes natural frequencies, damping ratios and mode shapes about static equilibrium.
pub(crate) fn run(input: &Input, output: &Output, count: usize) -> Result<(), Failure> {
    let document = super::read(input)?;
    if document.has_matrices() {
        return of_structure(&document, output, count);
    }
    let scenario = super::checked(&document)?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    let found = linearised_modes(&assembly, count)?;
    let folder = ResultFolder::claim("modes", document.path(), output)?;

    folder.write("modes.csv", modes_csv(&found))?;
    folder.draw("modes", &plot::modes(&found))?;
    let provenance = Provenance::of_scenario(&document, &scenario)?;
    let answer = ModesSummary::new(&scenario, &assembly, &found, provenance);
    let folder = folder.finish("modes.json", &json!(answer), output.json)?;
    if output.json {
        return Ok(());
    }
    show(&answer)?;
    answer_line!("written to {}", folder.display());
    Ok(())
}

/// Computes natural frequencies, damping ratios and participations about static equilibrium, and shapes on meshes.
fn of_structure(document: &Document, output: &Output, count: usize) -> Result<(), Failure> {
    let scenario = super::patches::checked(document)?;
    let assembly = assemble_patches(&scenario, document.folder())?;
    let found = patch_modes(&assembly, count)?;
    let folder = ResultFolder::claim("modes", document.path(), output)?;
    super::patches::write_maps(&folder, &scenario, &assembly.structure, document)?;
    for (number, mesh) in
        (1..).zip(mesh_modes(&scenario, &assembly.structure, &found, document.folder())?)
    {
        folder.write(&format!("modes-{number}.vtu"), mesh.grid())?;
        folder.write(&format!("modes-{number}.unv"), mesh.universal_file())?;
        if let Some(figure) = plot::mesh_shapes(&mesh) {
            folder.draw(&format!("modes-{number}"), &figure)?;
        }
    }
    let provenance = Provenance::of_structure(document, &scenario)?;
    let answer = found.summary(scenario.title.clone(), &assembly, provenance);
    let folder = folder.finish("modes.json", &json!(answer), output.json)?;
    if output.json {
        return Ok(());
    }
    show(&answer)?;
    let free = answer.modes.iter().filter(|mode| mode.frequency_hz == 0.0).count();
    if free > 0 {
        answer_line!("{free} motions are held by no stiffness");
    }
    answer_line!("written to {}", folder.display());
    Ok(())
}

/// Prints frequencies and damping.
fn show(answer: &ModesSummary) -> Result<(), Failure> {
    for (number, mode) in answer.modes.iter().enumerate() {
        let (hz, percent) = (mode.frequency_hz, 100.0 * mode.damping_ratio);
        answer_line!("mode {:<3} {hz:>12.3} Hz   damping {percent:.3} %", number + 1);
    }
    Ok(())
}
