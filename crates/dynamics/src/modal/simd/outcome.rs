//! The outcome of one case in a block.

use super::contact_extremes::LaneExtremes;

/// States at the end of a run that the velocities there are found from.
pub(in crate::modal) const LAST_STATES: usize = 5;

/// End of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::modal) enum RunEnd {
    Done,
    /// The pressure left the table of this interface.
    Beyond(usize),
    /// The numbers were not finite any more at this step, at this interface.
    NotFinite(usize, usize),
    /// The run was stopped at this step.
    Stopped(usize),
}

/// Result of one case.
#[derive(Debug)]
pub(in crate::modal) struct Outcome {
    pub(in crate::modal) end: RunEnd,
    /// Output displacement: decimated samples, or steps 0 to the last \[m\].
    pub(in crate::modal) displacement: Vec<f64>,
    /// The last outputs before the filter \[m\]; none of a run that records every step.
    pub(in crate::modal) ending: Vec<f64>,
    /// Traction increment \[Pa\], the pressure increment without damping and friction, and closure
    /// increment \[m\] at steps 0 to the last, per row: contacts, then guides.
    pub(in crate::modal) traction: Vec<Vec<f64>>,
    pub(in crate::modal) closure: Vec<Vec<f64>>,
    pub(in crate::modal) contacts: Vec<ContactOutcome>,
    /// Traction increments at the end, per row: contacts, then guides \[Pa\].
    pub(in crate::modal) row_tractions: Vec<f64>,
    /// Energy of the friction elements at the end, and their loss \[J\].
    pub(in crate::modal) friction_stored: f64,
    pub(in crate::modal) friction_loss: f64,
    /// Work of the load and viscous loss \[J\].
    pub(in crate::modal) work: f64,
    pub(in crate::modal) loss: f64,
    /// Modal displacements at the last states, newest first.
    pub(in crate::modal) states: Vec<[f64; LAST_STATES]>,
}

#[derive(Debug, Clone, Copy)]
pub(in crate::modal) struct ContactOutcome {
    pub(in crate::modal) extremes: LaneExtremes,
    /// Mean stiffness over the steps \[Pa/m\].
    pub(in crate::modal) stiffness: f64,
    /// Increment of the closure at the end \[m\].
    pub(in crate::modal) closure: f64,
    /// Viscous loss per area \[J/m2\].
    pub(in crate::modal) loss: f64,
}

impl Outcome {
    /// True for a run that was stopped.
    pub(in crate::modal) fn is_stopped(&self) -> bool {
        matches!(self.end, RunEnd::Stopped(_))
    }
}
