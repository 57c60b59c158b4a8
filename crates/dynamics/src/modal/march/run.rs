//! One block of hits on its way, and what is kept of it.

use pulp::Simd;

use super::{ContactOutcome, End, Keep, LAST_STATES, Outcome};
use crate::modal::block::{
    Block, CHUNK, Coefficient, Drive, Measure, Numbers, PAST, Pair, Step, lane_of,
};
use crate::modal::lane::Lane;
use crate::modal::rows::Rows;
use crate::modal::tally::Tally;
use crate::modal::thin::Thin;

/// One block on its way.
pub(super) struct Run<'a, S: Simd, C, const N: usize> {
    block: Block<'a, S, C, N>,
    /// The last steps before the chunk, and its own.
    chunk: Vec<Step<Numbers<S>, N>>,
    drive: Vec<Drive<Numbers<S>>>,
    tally: Tally<S>,
    thin: Option<Thin<S>>,
    kept: Vec<Kept>,
    chunks: usize,
    ends: Vec<End>,
    states: Vec<[Numbers<S>; LAST_STATES]>,
    pub(super) steps: usize,
}

/// Everything of one lane, step by step.
#[derive(Debug, Clone, Default)]
struct Kept {
    displacement: Vec<f64>,
    pressure: Vec<Vec<f64>>,
    closure: Vec<Vec<f64>>,
}

impl<'a, S: Rows, C: Coefficient<S>, const N: usize> Run<'a, S, C, N> {
    #[inline(always)]
    pub(super) fn new(simd: S, lanes: &[&'a Lane], keep: Keep<'_>) -> Self {
        let block = Block::new(simd, lanes);
        let steps = lanes.first().map_or(0, |lane| lane.steps);
        let zero = Pair(simd).splat(0.0);
        let rest = Step { pressure: [zero; N], closure: [zero; N], output: zero };
        let mut thin = None;
        let mut kept = Vec::new();
        match keep {
            Keep::Thinned(thinning) => {
                // The state at the very end is beyond the samples.
                thin = Some(Thin::new(simd, thinning, steps));
            }
            Keep::Steps => {
                let column = || {
                    let mut column = Vec::with_capacity(steps + 1);
                    column.push(0.0);
                    column
                };
                let columns = |lane: &&Lane| {
                    let each = || lane.rig.contacts().iter().map(|_| column()).collect();
                    Kept { displacement: column(), pressure: each(), closure: each() }
                };
                kept = lanes.iter().map(columns).collect();
            }
        }
        Self {
            tally: Tally::new(simd, &block),
            chunk: vec![rest; PAST + CHUNK],
            drive: vec![Drive([zero; 3]); CHUNK],
            thin,
            kept,
            chunks: 0,
            ends: lanes.iter().map(|_| End::Done).collect(),
            states: vec![[zero; LAST_STATES]; block.modes.len()],
            steps,
            block,
        }
    }

    pub(super) fn goes_on(&self) -> bool {
        self.ends.contains(&End::Done)
    }

    /// Takes the `count` steps after step `reached`.
    #[inline(always)]
    pub(super) fn advance(&mut self, simd: S, reached: usize, count: usize) {
        let driven = self.block.take_drive(simd, &mut self.drive[..count], reached);
        for n in 0..count {
            let (past, next) = self.chunk.split_at_mut(PAST + n);
            let (Some(past), [step, ..]) = (past.last_chunk::<PAST>(), next) else { return };
            let mut measure = Measure::of(reached + n + 1, self.steps);
            let drive = &self.drive[n];
            let mut before = None;
            if driven {
                measure.remember = true;
                before = Some(self.block.swing(simd));
                self.block.push(simd, drive);
            }
            self.block.step(simd, past, step, measure);
            if let Some(before) = before {
                self.block.count_work(simd, drive, before, step);
            }
        }
    }

    /// Keeps step `n` of the chunk whole.
    #[cold]
    fn keep(&mut self, n: usize) {
        let step = &self.chunk[PAST + n];
        for (lane, kept) in self.kept.iter_mut().enumerate() {
            let of = |numbers: &Numbers<S>| lane_of::<S>(numbers, lane);
            kept.displacement.push(of(&step.output));
            for (i, column) in kept.pressure.iter_mut().enumerate() {
                column.push(of(&step.pressure[i]));
            }
            for (i, column) in kept.closure.iter_mut().enumerate() {
                column.push(of(&step.closure[i]));
            }
        }
    }

    #[inline(always)]
    pub(super) fn end(&mut self, simd: S, reached: usize, count: usize) {
        let chunk = &self.chunk[PAST..PAST + count];
        self.tally.take(simd, chunk);
        if let Some(thin) = &mut self.thin {
            let samples = count - usize::from(reached == self.steps);
            thin.take(simd, &chunk[..samples]);
        }
        if self.steps - reached < LAST_STATES {
            for (states, mode) in self.states.iter_mut().zip(&self.block.modes) {
                states.rotate_right(1);
                states[0] = Pair(simd).sub(mode.ahead, mode.gain_ahead);
            }
        }
        if self.chunks.is_multiple_of(8) || reached == self.steps {
            self.look_for_failures(reached);
        }
        self.chunks += 1;
        if !self.kept.is_empty() {
            for n in 0..count {
                self.keep(n);
            }
        }
        self.chunk.copy_within(count..count + PAST, 0);
    }

    fn look_for_failures(&mut self, reached: usize) {
        for (lane, end) in self.ends.iter_mut().enumerate() {
            let (End::Done, Some(hit)) = (*end, self.block.lanes[lane]) else { continue };
            let tables = hit.prepared.tables.iter().zip(&hit.prepared.tops);
            for (i, (table, top)) in tables.enumerate() {
                let seen = self.tally.extremes(i, lane);
                if seen.lost {
                    *end = End::NotFinite(reached, i);
                    break;
                }
                // The table's last value stands for everything beyond it.
                if seen.highest_step + table.pressure_state() >= top * (1.0 - 1e-6) {
                    *end = End::Beyond(i);
                    break;
                }
            }
        }
    }

    pub(super) fn outcomes(mut self) -> Vec<Outcome> {
        let mut thinned = self.thin.take().map(Thin::finish).unwrap_or_default();
        let mut kept = std::mem::take(&mut self.kept);
        // The newest step is the last of those before the next chunk.
        let newest = &self.chunk[PAST - 1];
        let lanes = self.ends.iter().enumerate();
        let outcome = |(lane, &end): (usize, &End)| {
            let of = |numbers: &Numbers<S>| lane_of::<S>(numbers, lane);
            let hit = self.block.lanes[lane]?;
            let contacts = hit.prepared.tables.iter().enumerate().map(|(i, table)| {
                let contact = &self.block.contacts[i];
                let per_metre = table.scales()[1].cells_per_metre;
                ContactOutcome {
                    extremes: self.tally.extremes(i, lane),
                    stiffness: of(&contact.stiffness) * per_metre / self.steps as f64,
                    pressure: self.tally.newest(i, lane),
                    closure: of(&newest.closure[i]) / per_metre,
                }
            });
            let contacts = contacts.collect();
            let mut columns = kept.get_mut(lane).map(std::mem::take).unwrap_or_default();
            for (column, table) in columns.closure.iter_mut().zip(&hit.prepared.tables) {
                let per_metre = table.scales()[1].cells_per_metre;
                for cells in column {
                    *cells /= per_metre;
                }
            }
            Some(Outcome {
                end,
                displacement: match thinned.get_mut(lane) {
                    Some(samples) => std::mem::take(samples),
                    None => columns.displacement,
                },
                pressure: columns.pressure,
                closure: columns.closure,
                contacts,
                work: of(&self.block.work),
                loss: of(&self.block.loss),
                states: self.states.iter().map(|states| states.map(|state| of(&state))).collect(),
            })
        };
        lanes.filter_map(outcome).collect()
    }
}
