//! A transient case, prepared for one step length.

use std::sync::Arc;

use super::assembly::{ModalModel, TabulatedModel};
use super::lane_start::LaneStart;
use super::linear_tail::LinearTail;
use super::load_steps::LoadSteps;

/// A case with its model tabulated for its step, and its load.
#[derive(Debug, Clone)]
pub(super) struct PreparedCase {
    pub(super) model: Arc<ModalModel>,
    pub(super) tabulated: Arc<TabulatedModel>,
    /// Load of unit amplitude step by step, shared by cases of one shape, and the amplitude.
    pub(super) load: Arc<LoadSteps>,
    pub(super) amplitude: f64,
    /// Sensor of the model that is read.
    pub(super) sensor: usize,
    /// Steps of the response.
    pub(super) steps: usize,
    /// The state after some steps; none for a case from rest.
    pub(super) start: Option<Arc<LaneStart>>,
    /// The last steps in closed form; none where all steps are integrated.
    pub(super) tail: Option<Arc<LinearTail>>,
}

impl PreparedCase {
    /// Steps that came before.
    pub(super) fn first_step(&self) -> usize {
        self.start.as_ref().map_or(0, |start| start.step)
    }

    /// Last step to integrate.
    pub(super) fn integrated(&self) -> usize {
        self.tail.as_ref().map_or(self.steps, |tail| tail.from)
    }

    /// Closure increment \[m\] at and below which contact `i` is lost; -inf if it never separates, and
    /// for a guide.
    pub(super) fn open_below(&self, i: usize) -> f64 {
        let Some(contact) = self.model.contacts().get(i) else { return f64::NEG_INFINITY };
        if !contact.law().domain().separates() {
            return f64::NEG_INFINITY;
        }
        contact.law().closure_increment(contact.pressure(), -contact.pressure())
    }
}
