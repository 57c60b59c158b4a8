//! Cases side by side from rest to the end.

mod run;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pulp::{Arch, NullaryFnOnce};

use super::block::{CHUNK, Coefficient, Dissipative, PerLane, Uniform};
use super::outcome::{LAST_STATES, Outcome};
use super::table_lookup::TableLookup;
use crate::InstructionSet;
use crate::modal::assembly::MOST_INTERFACES;
use crate::modal::prepared_case::PreparedCase;
pub(in crate::modal) use run::Recording;
use run::Run;

/// Cases integrated side by side: all from as many steps on to as many, of as many modes and interfaces.
#[derive(Debug, Clone, Copy)]
pub(in crate::modal) struct BlockRun<'a> {
    pub(in crate::modal) lanes: &'a [&'a PreparedCase],
    pub(in crate::modal) recording: Recording<'a>,
    /// Ends the run once it is set.
    pub(in crate::modal) stop: &'a AtomicBool,
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
        match set.arch()? {
            Arch::Scalar => Some(self.on_any(pulp::Scalar::new())),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(simd) => Some(simd.vectorize(On(simd, self))),
            #[cfg(target_arch = "x86_64")]
            Arch::V4(simd) => Some(simd.vectorize(On(simd, self))),
            #[cfg(target_arch = "aarch64")]
            Arch::Neon(simd) => Some(simd.vectorize(On(simd, self))),
            _ => None,
        }
    }

    /// The run in one of the compiled forms of the kernel: two rows, with constants that all lanes
    /// share or that each lane has of its own; more rows; and both with dissipation, which has a form for
    /// four rows too: two contacts and the guides of their bodies. One row takes the form of two, which
    /// takes a fifth to a quarter more time.
    #[inline(always)]
    fn on<S: TableLookup>(self, simd: S) -> Vec<Outcome> {
        let Some((first, others)) = self.lanes.split_first() else { return Vec::new() };
        // Constants of all lanes are those of the first: the model with its tables, and the sensor that is read.
        let uniform = others.iter().all(|lane| {
            Arc::ptr_eq(&lane.tabulated, &first.tabulated) && lane.sensor == first.sensor
        });
        match (first.model.rows(), first.model.is_dissipative()) {
            (1 | 2, true) => self.with::<S, Dissipative<S::f64s>, 2>(simd),
            (3 | 4, true) => self.with::<S, Dissipative<S::f64s>, 4>(simd),
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
        let mut reached = run.first;
        while reached < run.steps && run.goes_on() {
            if self.stop.load(Ordering::Relaxed) {
                run.stop(reached);
                break;
            }
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
