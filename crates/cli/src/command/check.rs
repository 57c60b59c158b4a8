//! `asperity check`.

use asperity_study::assemble::Assembly;
use asperity_study::mesh::Grid;
use asperity_study::run::rest_state;
use serde_json::json;

use crate::args::Input;
use crate::failure::Failure;

/// Validates and assembles a scenario, and says what a run would take.
pub(crate) fn run(input: &Input, as_json: bool) -> Result<(), Failure> {
    let document = super::read(input)?;
    let scenario = super::checked(&document)?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    let grid = Grid::new(&assembly.stack, assembly.method.cell)
        .map_err(asperity_study::dynamics::DynamicsError::from)?;
    let (step, stride) = grid
        .step_within(assembly.sampling.interval(), assembly.method.courant)
        .map_err(asperity_study::dynamics::DynamicsError::from)?;
    let steps = stride * assembly.sampling.samples();
    let natural = rest_state(&assembly).natural_frequency_hz;
    if as_json {
        let answer = json!({
            "schema": "asperity/check/1",
            "valid": true,
            "scenario_sha256": document.sha256(),
            "natural_frequency_hz": natural,
            "nodes": grid.nodes(),
            "step_s": step,
            "steps": steps,
            "samples": assembly.sampling.samples(),
        });
        print!("{}", super::pretty(&answer));
        return Ok(());
    }
    println!("{}: valid", document.path().display());
    if let Some(natural) = natural {
        println!("  natural frequency at rest  {natural:.2} Hz");
    }
    println!("  grid                       {} nodes", grid.nodes());
    println!("  run                        {steps} steps of {:.4} us", step * 1e6);
    println!("  record                     {} samples", assembly.sampling.samples());
    Ok(())
}
