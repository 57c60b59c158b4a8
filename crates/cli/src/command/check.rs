//! `asperity check`.

use asperity_dynamics::Integrator;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::plausibility::plausibility_notes;
use asperity_simulation::static_state::StaticSummary;
use serde_json::json;

use crate::args::Input;
use crate::failure::Failure;

/// Validates and assembles a scenario, and prints the size of its run and unusual values.
pub(crate) fn run(input: &Input, as_json: bool) -> Result<(), Failure> {
    let document = super::read(input)?;
    if document.has_matrices() {
        return super::patches::check(&document, as_json);
    }
    let scenario = super::checked(&document)?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    let Assembly { structure, load, sampling, method, .. } = &assembly;
    let outline = method
        .outline(structure, load, sampling)
        .map_err(asperity_simulation::error::SimulationError::from)?;
    let natural = StaticSummary::of(&assembly).natural_frequency_hz;
    let notes = plausibility_notes(&assembly);
    if as_json {
        let answer = json!({
            "schema": "asperity/check/1",
            "valid": true,
            "scenario_sha256": document.sha256(),
            "natural_frequency_hz": natural,
            "method": method.name(),
            "unknowns": outline.unknowns,
            "step_s": outline.step,
            "steps": outline.steps,
            "samples": sampling.samples(),
            "notes": notes,
        });
        answer!("{}", super::pretty(&answer));
        return Ok(());
    }
    answer_line!("{}: valid", document.path().display());
    if let Some(natural) = natural {
        answer_line!("  natural frequency at rest  {natural:.2} Hz");
    }
    let unknowns = match method {
        Integrator::FiniteDifference(_) => "nodes",
        Integrator::Modal(_) => "modes",
    };
    answer_line!("  {:<26} {} {unknowns}", method.name().replace('_', " "), outline.unknowns);
    let (steps, step_us) = (outline.steps, outline.step * 1e6);
    answer_line!("  run                        {steps} steps of {step_us:.4} us");
    answer_line!("  record                     {} samples", sampling.samples());
    for note in notes {
        answer_line!("  unusual                    {note}");
    }
    Ok(())
}
