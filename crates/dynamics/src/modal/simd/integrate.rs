//! Cases side by side from rest to the end.

mod run;

use std::sync::Arc;

use pulp::NullaryFnOnce;

use run::Run;

use super::block::{CHUNK, Coefficient, Dissipative, PerLane, Uniform};
use super::contact_extremes::LaneExtremes;
use super::decimation::Decimation;
use super::table_lookup::TableLookup;
use crate::InstructionSet;
use crate::modal::assembly::MOST_INTERFACES;
use crate::modal::assembly::PreparedCase;

/// States at the end of a run that the velocities there are found from.
pub(in crate::modal) const LAST_STATES: usize = 5;

/// Recording of the motion.
#[derive(Debug, Clone, Copy)]
pub(in crate::modal) enum Recording<'a> {
    /// Displacement, filtered and decimated.
    Decimated(&'a Decimation),
    /// Displacement, pressures and closures at every step.
    EveryStep,
}

/// End of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::modal) enum RunEnd {
    Done,
    /// The pressure left the table of this interface.
    Beyond(usize),
    /// The numbers were not finite any more at this step, at this interface.
    NotFinite(usize, usize),
}

/// Result of one case.
#[derive(Debug)]
pub(in crate::modal) struct Outcome {
    pub(in crate::modal) end: RunEnd,
    /// Output displacement: decimated samples, or steps 0 to the last \[m\].
    pub(in crate::modal) displacement: Vec<f64>,
    /// Traction increment \[Pa\], the pressure increment without damping and friction, and closure
    /// increment \[m\] at steps 0 to the last, per row: contacts, then guides.
    pub(in crate::modal) traction: Vec<Vec<f64>>,
    pub(in crate::modal) closure: Vec<Vec<f64>>,
    pub(in crate::modal) contacts: Vec<ContactOutcome>,
    /// Traction increments at the end of all rows, those of guides last \[Pa\].
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

/// Cases integrated side by side: all of as many steps, modes and interfaces.
#[derive(Debug, Clone, Copy)]
pub(in crate::modal) struct BlockRun<'a> {
    pub(in crate::modal) lanes: &'a [&'a PreparedCase],
    pub(in crate::modal) recording: Recording<'a>,
}

/// Lanes of one run on `set`.
pub(in crate::modal) fn room(set: InstructionSet) -> usize {
    2 * set.lanes()
}

impl BlockRun<'_> {
    /// The outcome of each case; none if the machine does not have `set`.
    pub(in crate::modal) fn run(self, set: InstructionSet) -> Option<Vec<Outcome>> {
        struct On<'a, S>(S, BlockRun<'a>);
        impl<S: TableLookup> NullaryFnOnce for On<'_, S> {
            type Output = Vec<Outcome>;

            #[inline(always)]
            fn call(self) -> Vec<Outcome> {
                self.1.on(self.0)
            }
        }
        match set {
            InstructionSet::Scalar => Some(self.on_any(pulp::Scalar::new())),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => {
                pulp::x86::V3::try_new().map(|simd| simd.vectorize(On(simd, self)))
            }
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => {
                pulp::x86::V4::try_new().map(|simd| simd.vectorize(On(simd, self)))
            }
            #[cfg(target_arch = "aarch64")]
            InstructionSet::Neon => {
                pulp::aarch64::Neon::try_new().map(|simd| simd.vectorize(On(simd, self)))
            }
            #[allow(unreachable_patterns, reason = "which sets are left depends on the target")]
            _ => None,
        }
    }

    /// The run in one of the compiled forms of the kernel: two rows, with constants that all lanes
    /// share or that each lane has of its own; more rows; and both with dissipation. One row takes
    /// the form of two, which takes a fifth to a quarter more time.
    #[inline(always)]
    fn on<S: TableLookup>(self, simd: S) -> Vec<Outcome> {
        let Some((first, others)) = self.lanes.split_first() else { return Vec::new() };
        let uniform = others.iter().all(|lane| Arc::ptr_eq(&lane.tabulated, &first.tabulated));
        match (first.model.rows(), first.model.is_dissipative()) {
            (1 | 2, true) => self.with::<S, Dissipative<S::f64s>, 2>(simd),
            (1 | 2, false) if uniform => self.with::<S, Uniform, 2>(simd),
            (1 | 2, false) => self.with::<S, PerLane<S::f64s>, 2>(simd),
            _ => self.on_any(simd),
        }
    }

    /// The run in the forms for any number of rows, the only ones without vectors.
    #[inline(always)]
    fn on_any<S: TableLookup>(self, simd: S) -> Vec<Outcome> {
        match self.lanes.first() {
            // Cases with and without damping or friction are not integrated together.
            Some(first) if first.model.is_dissipative() => {
                self.with::<S, Dissipative<S::f64s>, MOST_INTERFACES>(simd)
            }
            Some(first) if first.model.rows() > 0 => {
                self.with::<S, PerLane<S::f64s>, MOST_INTERFACES>(simd)
            }
            _ => Vec::new(),
        }
    }

    #[inline(always)]
    fn with<S: TableLookup, C: Coefficient<S>, const N: usize>(self, simd: S) -> Vec<Outcome> {
        let mut run: Run<'_, S, C, N> = Run::new(simd, self.lanes, self.recording);
        let mut reached = 0;
        while reached < run.steps && run.goes_on() {
            // The last states are recorded one by one.
            let left = run.steps - reached;
            let count = if left <= LAST_STATES { 1 } else { CHUNK.min(left - LAST_STATES) };
            run.advance(simd, reached, count);
            reached += count;
            run.end(simd, reached, count);
        }
        run.finish_samples();
        run.outcomes()
    }
}
