//! Hits side by side from rest to the end.

mod run;

use std::sync::Arc;

use pulp::NullaryFnOnce;

use run::Run;

use super::block::{CHUNK, Coefficient, Each, MOST_INTERFACES, Same};
use super::lane::Lane;
use super::rows::Rows;
use super::tally::Extremes;
use super::thin::Thinning;
use crate::InstructionSet;

/// States at the end of a run that the velocities there are found from.
pub(super) const LAST_STATES: usize = 5;

/// What to keep of the motion.
#[derive(Debug, Clone, Copy)]
pub(super) enum Keep<'a> {
    /// Displacement, filtered and thinned.
    Thinned(&'a Thinning),
    /// Displacement, pressures and closures at every step.
    Steps,
}

/// How a hit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Done,
    /// The pressure left the table of this interface.
    Beyond(usize),
    /// The numbers were not finite any more at this step, at this interface.
    NotFinite(usize, usize),
}

/// What came of one hit.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) end: End,
    /// Output displacement: thinned samples, or steps 0 to the last \[m\].
    pub(super) displacement: Vec<f64>,
    /// Pressure gained \[Pa\] and closure gained \[m\] at steps 0 to the last, per interface.
    pub(super) pressure: Vec<Vec<f64>>,
    pub(super) closure: Vec<Vec<f64>>,
    pub(super) contacts: Vec<ContactOutcome>,
    /// Work of the drive and viscous loss \[J\].
    pub(super) work: f64,
    pub(super) loss: f64,
    /// Modal displacements at the last states, newest first.
    pub(super) states: Vec<[f64; LAST_STATES]>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct ContactOutcome {
    pub(super) extremes: Extremes,
    /// Mean stiffness over the steps \[Pa/m\].
    pub(super) stiffness: f64,
    /// Pressure \[Pa\] and closure \[m\] gained at the end.
    pub(super) pressure: f64,
    pub(super) closure: f64,
}

/// Hits to be marched side by side: all of as many steps, modes and interfaces.
#[derive(Debug, Clone, Copy)]
pub(super) struct March<'a> {
    pub(super) lanes: &'a [&'a Lane],
    pub(super) keep: Keep<'a>,
}

/// Lanes that one march has room for on `set`.
pub(super) fn room(set: InstructionSet) -> usize {
    2 * set.lanes()
}

impl March<'_> {
    /// The outcome of each hit; none if the machine does not have `set`.
    pub(super) fn run(self, set: InstructionSet) -> Option<Vec<Outcome>> {
        struct On<'a, S>(S, March<'a>);
        impl<S: Rows> NullaryFnOnce for On<'_, S> {
            type Output = Vec<Outcome>;

            #[inline(always)]
            fn call(self) -> Vec<Outcome> {
                self.1.on(self.0)
            }
        }
        match set {
            InstructionSet::Scalar => Some(self.on(pulp::Scalar::new())),
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

    #[inline(always)]
    fn on<S: Rows>(self, simd: S) -> Vec<Outcome> {
        let Some((first, others)) = self.lanes.split_first() else { return Vec::new() };
        let same = others.iter().all(|lane| Arc::ptr_eq(&lane.prepared, &first.prepared));
        match (first.rig.contacts().len(), same) {
            (0, _) => Vec::new(),
            (1, true) => self.with::<S, Same, 1>(simd),
            (1, false) => self.with::<S, Each<S::f64s>, 1>(simd),
            (2, true) => self.with::<S, Same, 2>(simd),
            (2, false) => self.with::<S, Each<S::f64s>, 2>(simd),
            _ => self.with::<S, Each<S::f64s>, MOST_INTERFACES>(simd),
        }
    }

    #[inline(always)]
    fn with<S: Rows, C: Coefficient<S>, const N: usize>(self, simd: S) -> Vec<Outcome> {
        let mut run: Run<'_, S, C, N> = Run::new(simd, self.lanes, self.keep);
        let mut reached = 0;
        while reached < run.steps && run.goes_on() {
            // The last states are looked at one by one.
            let left = run.steps - reached;
            let count = if left <= LAST_STATES { 1 } else { CHUNK.min(left - LAST_STATES) };
            run.advance(simd, reached, count);
            reached += count;
            run.end(simd, reached, count);
        }
        run.outcomes()
    }
}
