//! One hit as a lane of vectors sees it.

use std::sync::Arc;

use super::drive::DriveCourse;
use super::rig::{ModalRig, Prepared};

/// A hit: the rig it strikes, stepped and tabulated, and its drive.
#[derive(Debug, Clone)]
pub(super) struct Lane {
    pub(super) rig: Arc<ModalRig>,
    pub(super) prepared: Arc<Prepared>,
    /// Course of the force of unit peak, shared by hits of one shape, and the factor on it.
    pub(super) drive: Arc<DriveCourse>,
    pub(super) amplitude: f64,
    /// Steps to take.
    pub(super) steps: usize,
}

/// Pressure over static pressure below which contact counts as lost: tables and tangents err by
/// as much.
const OPEN: f64 = 2e-5;

impl Lane {
    /// Pressure gain \[Pa\] at and below which contact `i` counts as lost; -inf if it never
    /// separates.
    pub(super) fn open_below(&self, i: usize) -> f64 {
        let contact = &self.rig.contacts()[i];
        if !contact.law().domain().separates() {
            return f64::NEG_INFINITY;
        }
        let state = contact.pressure();
        OPEN * state.max(1e-3 * self.prepared.tops[i]) - state
    }
}
