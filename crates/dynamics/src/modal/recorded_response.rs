//! The response to one case with its history.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::batch::{Batch, Preparation, contact_extremes};
use super::decimation::Decimation;
use super::dense_output::{complete, history};
use super::energy::ledger;
use super::load_steps::LoadShapes;
use super::prepared_case::PreparedCase;
use super::simd::integrate::{BlockRun, Recording};
use super::simd::outcome::{Outcome, RunEnd};
use super::transient_case::{CaseResponse, TransientCase};
use super::variable_steps::{self, Ended, Midway, SampledCase};
use crate::{DynamicsError, History, Sampling, Transient};

impl Batch {
    /// The whole response to one case.
    ///
    /// # Errors
    /// As [`Modal::integrate`](super::Modal::integrate).
    pub fn transient(
        &self,
        case: &TransientCase,
        sampling: &Sampling,
    ) -> Result<Transient, DynamicsError> {
        self.transient_unless(case, sampling, &AtomicBool::new(false))
    }

    /// As [`transient`](Self::transient), until `stop` is set.
    ///
    /// # Errors
    /// Those of [`transient`](Self::transient), and [`DynamicsError::Stopped`].
    pub fn transient_unless(
        &self,
        case: &TransientCase,
        sampling: &Sampling,
        stop: &AtomicBool,
    ) -> Result<Transient, DynamicsError> {
        if case.tolerance.is_some() {
            let sampled = SampledCase::new(case, sampling)?;
            return self.own_steps_sampled(&sampled, sampling, true, stop);
        }
        let (lane, outcome) = self.whole(case, stop)?;
        Ok(Transient {
            step: lane.tabulated.step_model.step,
            steps: lane.steps,
            history: history(&lane, &outcome, &case.load, sampling),
            contacts: contact_extremes(&lane, &outcome),
            energy: ledger(&lane, &outcome),
        })
    }

    /// The whole response to one case with a tolerance, at steps of its own to the end: the second method for
    /// [`transient`](Self::transient), which goes on at equal steps once contacts hold.
    ///
    /// # Errors
    /// Those of [`transient`](Self::transient), and [`DynamicsError::Setting`] for a case without a tolerance.
    pub fn transient_at_own_steps(
        &self,
        case: &TransientCase,
        sampling: &Sampling,
    ) -> Result<Transient, DynamicsError> {
        let sampled = SampledCase::new(case, sampling)?;
        self.own_steps_sampled(&sampled, sampling, false, &AtomicBool::new(false))
    }

    /// The steps of one case, at the step and with the tables that it needs.
    pub(super) fn whole(
        self,
        case: &TransientCase,
        stop: &AtomicBool,
    ) -> Result<(PreparedCase, Outcome), DynamicsError> {
        let decimation = |_: usize, _: f64| Decimation::none();
        let mut preparation =
            Preparation { shapes: LoadShapes::default(), decimation: &decimation };
        let mut attempt = preparation.first(0, case)?;
        loop {
            let outcome = self.every_step(&attempt.lane, stop)?;
            match attempt.next(case, &outcome, &mut preparation)? {
                Some(next) => attempt = next,
                None => return Ok((attempt.lane, outcome)),
            }
        }
    }

    /// A case at steps of its own, to its end or to where equal steps take it on.
    fn own_steps_sampled(
        self,
        sampled: &SampledCase,
        sampling: &Sampling,
        may_end_midway: bool,
        stop: &AtomicBool,
    ) -> Result<Transient, DynamicsError> {
        match variable_steps::transient(sampled, self.instructions, may_end_midway, stop)? {
            Ended::Whole(response, history) => Ok(with_history(*response, history)),
            Ended::Midway(midway, history) => {
                match self.taken_on(&sampled.case, *midway, history, sampling, stop)? {
                    Some(transient) => Ok(transient),
                    None => self.own_steps_sampled(sampled, sampling, false, stop),
                }
            }
        }
    }

    /// The response to a case with the `history` of its own steps, taken on at equal steps; none if these do not
    /// serve the case.
    fn taken_on(
        self,
        case: &TransientCase,
        midway: Midway,
        mut history: History,
        sampling: &Sampling,
        stop: &AtomicBool,
    ) -> Result<Option<Transient>, DynamicsError> {
        let decimation = |_: usize, _: f64| Decimation::none();
        let mut preparation =
            Preparation { shapes: LoadShapes::default(), decimation: &decimation };
        let Ok(attempt) = preparation.first(0, case) else { return Ok(None) };
        let midway = Arc::new(midway);
        let attempt = attempt.after(Arc::clone(&midway));
        let outcome = self.every_step(&attempt.lane, stop)?;
        if let RunEnd::Stopped(steps) = outcome.end {
            return Err(DynamicsError::Stopped { steps });
        }
        if !attempt.is_whole(&outcome) {
            return Ok(None);
        }
        complete(&mut history, &attempt.lane, &outcome, &case.load, sampling);
        let joined = attempt.joined(&midway, outcome);
        Ok(joined.map(|response| with_history(response, history)))
    }

    /// The outcome of one case, recorded at every step.
    fn every_step(self, lane: &PreparedCase, stop: &AtomicBool) -> Result<Outcome, DynamicsError> {
        let run = BlockRun { lanes: &[lane], recording: Recording::EveryStep, stop };
        let outcomes = run.run(self.instructions);
        let outcome = outcomes.and_then(|outcomes| outcomes.into_iter().next());
        outcome.ok_or(DynamicsError::InstructionSet { set: self.instructions })
    }
}

/// A response at steps of its own with its history.
fn with_history(response: CaseResponse, history: History) -> Transient {
    let CaseResponse { step, integrated_steps: steps, contacts, energy, .. } = response;
    Transient { step, steps, history, contacts, energy }
}
