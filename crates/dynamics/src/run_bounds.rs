//! The size of a run, and the largest runs: the time and memory that a run may take, checked before
//! it starts.

use crate::DynamicsError;

/// The size of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunOutline {
    /// Nodes of the grid, or modes.
    pub unknowns: usize,
    /// Step \[s\]; one that was chosen may still be halved for the sake of the energy balance.
    pub step: f64,
    /// Number of steps.
    pub steps: usize,
}

/// Most steps of a run by finite differences.
pub const MOST_STEPS: f64 = 2e10;

/// Most node updates, steps times nodes, of a run by finite differences: about ten minutes.
pub const MOST_NODE_UPDATES: f64 = 1e12;

/// Most steps between two samples: their forces take 0.8 GB.
const MOST_STEPS_A_SAMPLE: f64 = 1e8;

/// Most numbers of a time history: 0.8 GB, and some three times as much as text.
pub const MOST_HISTORY_NUMBERS: f64 = 1e8;

/// Most steps times contacts of a run with many contacts: some hours.
const MOST_CONTACT_STEPS: f64 = 1e10;

/// Most numbers that a modal run records at its steps: 1.6 GB.
const MOST_RECORDED_NUMBERS: f64 = 2e8;

/// Checks the size of a run by finite differences: `steps_a_sample` steps of `step` \[s\] for each of
/// `samples` samples, over `nodes` nodes.
pub(crate) fn check_finite_differences(
    nodes: usize,
    (step, steps_a_sample): (f64, usize),
    samples: usize,
) -> Result<(), DynamicsError> {
    let steps = steps_a_sample as f64 * samples as f64;
    let unit = "steps";
    at_most(steps, MOST_STEPS, unit, step)?;
    let unit = "node updates (steps times nodes)";
    at_most(steps * nodes as f64, MOST_NODE_UPDATES, unit, step)?;
    at_most(steps_a_sample as f64, MOST_STEPS_A_SAMPLE, "steps between two samples", step)
}

/// Checks the time history of a run: time, force, displacement and acceleration, and three
/// quantities of each interface.
pub(crate) fn check_history(
    samples: usize,
    interfaces: usize,
    step: f64,
) -> Result<(), DynamicsError> {
    let unit = "numbers in its time history";
    at_most(samples as f64 * (4 + 3 * interfaces) as f64, MOST_HISTORY_NUMBERS, unit, step)
}

/// Checks what a modal run may record at each step: the displacement, and pressure and closure of
/// each interface.
pub(crate) fn check_recorded_steps(
    steps: f64,
    interfaces: usize,
    step: f64,
) -> Result<(), DynamicsError> {
    let unit = "numbers recorded at its steps";
    at_most(steps * (1 + 2 * interfaces) as f64, MOST_RECORDED_NUMBERS, unit, step)
}

/// Checks the size of a run with many contacts.
pub(crate) fn check_many_contacts(
    steps: f64,
    contacts: usize,
    step: f64,
) -> Result<(), DynamicsError> {
    at_most(steps * contacts as f64, MOST_CONTACT_STEPS, "steps times contacts", step)
}

fn at_most(count: f64, limit: f64, unit: &'static str, step_s: f64) -> Result<(), DynamicsError> {
    if count <= limit {
        Ok(())
    } else {
        Err(DynamicsError::TooLarge { count, unit, limit, step_s })
    }
}
