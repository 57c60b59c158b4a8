//! Commands for structures given by matrices.

use asperity_scenario::{Document, StructureScenario};
use asperity_simulation::patches::{
    CellSummary, PatchRun, PatchStructure, PatchSummary, assemble_patches, patch_grid, patch_maps,
    simulate_patches, time_series,
};
use serde_json::json;

use super::ResultFolder;
use super::shown::{with_percents, write_run};
use crate::args::Output;
use crate::args::analyse::RecordFormat;
use crate::args::figures::MagnitudeAxis;
use crate::failure::Failure;

/// Number of cells with the highest pressures that are named.
const NAMED_CELLS: usize = 3;

/// The scenario of a structure, checked.
pub(super) fn checked(document: &Document) -> Result<StructureScenario, Failure> {
    document.structure_scenario().map_err(|source| Failure::Invalid {
        kind: "scenario",
        text: document.text().to_owned(),
        path: document.path().to_owned(),
        source,
    })
}

/// Simulates one hit; writes summary, history, FRF, cells and figures.
pub(super) fn simulate(
    document: &Document,
    output: &Output,
    record: Option<RecordFormat>,
    magnitude: MagnitudeAxis,
    quiet: bool,
) -> Result<(), Failure> {
    let scenario = checked(document)?;
    let folder = ResultFolder::claim("simulate", document.path(), output)?;
    let found = with_percents(quiet, |progress| simulate_patches(document, &scenario, progress))?;
    write_run(&folder, &found.run, record, magnitude)?;
    folder.write("cells.csv", found.cells_table().to_csv())?;
    write_maps(&folder, &scenario, &found.run.assembly.structure, document)?;
    write_cell_histories(&folder, &found)?;
    write_motion(&folder, &scenario, &found, document)?;
    let summary = found.summary();
    let folder = folder.finish("summary.json", &json!(summary), output.json)?;
    if !output.json && !quiet {
        answer!("{}", asperity_plot::run_words(&summary.summary));
        answer!("{}", cells_in_words(&summary, &found.cells));
        answer_line!("written to {}", folder.display());
    }
    Ok(())
}

/// Pressure, closure and stiffness of recorded cells over time, with a figure.
fn write_cell_histories(folder: &ResultFolder, found: &PatchRun) -> Result<(), Failure> {
    if let Some(table) = found.cell_history_csv() {
        folder.write("cells-history.csv", table)?;
    }
    if let Some(figure) = asperity_plot::cell_histories(found) {
        folder.draw("cells-history", &figure)?;
    }
    Ok(())
}

/// Motion of each mesh at the instants of a run, as a figure, a universal file and grids of `ParaView`, with the pressures of
/// cells and a time series of all.
fn write_motion(
    folder: &ResultFolder,
    scenario: &StructureScenario,
    found: &PatchRun,
    document: &Document,
) -> Result<(), Failure> {
    let mut instants: Vec<(f64, Vec<String>)> =
        found.states.iter().map(|state| (state.time, Vec::new())).collect();
    let motions = found.mesh_motions(scenario, document.folder())?;
    for (body, motion) in (1..).zip(&motions) {
        if let Some(figure) = asperity_plot::mesh_motion(motion) {
            folder.draw(&format!("motion-{body}"), &figure)?;
        }
        folder.write(&format!("motion-{body}.unv"), motion.universal_file())?;
        for (number, (grid, (_, files))) in (1..).zip(motion.grids().zip(&mut instants)) {
            let name = format!("motion-{body}-{number}.vtu");
            folder.write(&name, grid)?;
            files.push(name);
        }
    }
    let cells = found.cell_grids(scenario, document.folder())?;
    for (number, (grid, (_, files))) in (1..).zip(cells.iter().zip(&mut instants)) {
        let name = format!("cells-{number}.vtu");
        folder.write(&name, grid)?;
        files.push(name);
    }
    if instants.iter().any(|(_, files)| !files.is_empty()) {
        folder.write("motion.pvd", time_series(&instants))?;
    }
    Ok(())
}

/// Pressures at rest where the cells are, as a figure and a grid of `ParaView`.
pub(super) fn write_maps(
    folder: &ResultFolder,
    scenario: &StructureScenario,
    structure: &PatchStructure,
    document: &Document,
) -> Result<(), Failure> {
    let maps = patch_maps(scenario, structure, document.folder())?;
    if let Some(figure) = asperity_plot::pressure_maps(&maps) {
        folder.draw("pressure", &figure)?;
    }
    if let Some(grid) = patch_grid(&maps) {
        folder.write("cells.vtu", grid)?;
    }
    Ok(())
}

fn cells_in_words(summary: &PatchSummary, cells: &[Vec<CellSummary>]) -> String {
    let mut lines = Vec::new();
    for (counts, cells) in summary.cells.iter().zip(cells) {
        let mut worst: Vec<&CellSummary> = cells.iter().collect();
        worst.sort_by(|a, b| b.pressure_max_pa.total_cmp(&a.pressure_max_pa));
        let named: Vec<String> = worst
            .iter()
            .take(NAMED_CELLS)
            .map(|one| format!("{} {:.4} MPa", one.cell, 1e-6 * one.pressure_max_pa))
            .collect();
        lines.push(format!(
            "{:<26}{} cells, {} open at rest, {} lose contact for a time; highest: {}\n",
            counts.interface,
            counts.cells,
            counts.open_at_rest,
            counts.lose_contact,
            named.join(", ")
        ));
    }
    lines.concat()
}

/// Validates and assembles a structure, and prints its rest.
pub(super) fn check(document: &Document, as_json: bool) -> Result<(), Failure> {
    let scenario = checked(document)?;
    let assembly = assemble_patches(&scenario, document.folder())?;
    let structure = &assembly.structure;
    let at_rest = structure.at_rest();
    let open: Vec<usize> = structure
        .patches
        .iter()
        .map(|patch| {
            let cells = &structure.structure.contacts()[patch.cells.clone()];
            cells.iter().filter(|cell| cell.gap() > 0.0).count()
        })
        .collect();
    if as_json {
        let answer = json!({
            "schema": "asperity/check/1",
            "valid": true,
            "scenario_sha256": document.sha256(),
            "natural_frequency_hz": at_rest.natural_frequency_hz,
            "method": "many_contacts",
            "modes_per_body": structure.modes_per_body,
            "motions_without_stiffness": structure.rigid_motions,
            "static": at_rest,
            "open_cells": open,
            "samples": assembly.sampling.samples(),
            "notes": Vec::<String>::new(),
        });
        answer!("{}", super::pretty(&answer));
        return Ok(());
    }
    answer_line!("{}: valid", document.path().display());
    if let Some(natural) = at_rest.natural_frequency_hz {
        answer_line!("  natural frequency at rest  {natural:.2} Hz");
    }
    let bodies = scenario.bodies.iter().zip(&structure.modes_per_body);
    for ((body, modes), rigid) in bodies.zip(&structure.rigid_motions) {
        answer_line!(
            "  {:<26} {modes} modes, {rigid} motions without stiffness before contact",
            body.name
        );
    }
    for ((patch, one), open) in structure.patches.iter().zip(&at_rest.interfaces).zip(open) {
        answer_line!(
            "  {:<26} {} cells, {open} open at rest, mean pressure {:.4} MPa",
            patch.name,
            patch.cells.len(),
            1e-6 * one.pressure_pa
        );
    }
    answer_line!("  record                     {} samples", assembly.sampling.samples());
    Ok(())
}
