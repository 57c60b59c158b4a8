//! The run of one block of cases, and its recording.

use pulp::Simd;

use crate::modal::decimation::Decimation;
use crate::modal::linear_tail::carried;
use crate::modal::oscillator::NODES;
use crate::modal::prepared_case::PreparedCase;
use crate::modal::simd::block::{
    Block, CHUNK, Coefficient, LanePair, LaneVector, Load, PAST, Step, lane_of, set_lane,
    total_work,
};
use crate::modal::simd::contact_extremes::BlockExtremes;
use crate::modal::simd::decimator::{Decimator, LaneSamples};
use crate::modal::simd::outcome::{ContactOutcome, LAST_STATES, Outcome, RunEnd};
use crate::modal::simd::table_lookup::TableLookup;

/// Recording of the motion.
#[derive(Debug, Clone, Copy)]
pub(in crate::modal) enum Recording<'a> {
    /// Displacement, filtered and decimated, and its end as it is.
    Decimated(&'a Decimation),
    /// Displacement, pressures and closures at every step.
    EveryStep,
}

/// One block on its way.
pub(super) struct Run<'a, S: Simd, C, const N: usize> {
    block: Block<'a, S, C, N>,
    /// The last steps before the chunk, and its own.
    chunk: Vec<Step<LaneVector<S>, N>>,
    load: Vec<Load<LaneVector<S>>>,
    extremes: BlockExtremes<S>,
    decimator: Option<Decimator<S>>,
    recorded: Vec<RecordedSteps>,
    chunks: usize,
    ends: Vec<RunEnd>,
    states: Vec<[LaneVector<S>; LAST_STATES]>,
    /// The finished samples of each lane.
    samples: Vec<LaneSamples>,
    /// Steps that came before, the last step to integrate, and steps of the whole response.
    pub(super) first: usize,
    pub(super) steps: usize,
    all_steps: usize,
}

/// Everything of one lane, step by step.
#[derive(Debug, Clone, Default)]
struct RecordedSteps {
    displacement: Vec<f64>,
    pressure: Vec<Vec<f64>>,
    closure: Vec<Vec<f64>>,
}

impl RecordedSteps {
    /// Rest, or the last steps before the start of a case, in columns with room for all `steps`.
    fn begin(case: &PreparedCase, steps: usize) -> Self {
        let column = |past: &[f64], scale: f64| {
            let mut column = Vec::with_capacity(steps + 1);
            column.extend(past.iter().rev().map(|number| scale * number));
            column
        };
        let rows = 0..case.model.rows();
        match &case.start {
            None => {
                let rest = || rows.clone().map(|_| column(&[0.0], 1.0)).collect();
                Self { displacement: column(&[0.0], 1.0), pressure: rest(), closure: rest() }
            }
            Some(start) => {
                let cells = |i: usize| case.tabulated.cells_per_metre(i);
                let closure = |i: usize| column(&start.closure[i], cells(i));
                Self {
                    displacement: start.readings[start.first_known()..].to_vec(),
                    pressure: rows.clone().map(|i| column(&start.traction[i], 1.0)).collect(),
                    closure: rows.map(closure).collect(),
                }
            }
        }
    }
}

/// The steps before the first, oldest first, and room for those of a chunk.
fn past_steps<S: TableLookup, const N: usize>(
    simd: S,
    lanes: &[&PreparedCase],
) -> Vec<Step<LaneVector<S>, N>> {
    let zero = LanePair(simd).splat(0.0);
    let rest = Step { pressure: [zero; N], closure: [zero; N], reading: zero };
    let mut steps = vec![rest; PAST + CHUNK];
    for (lane, case) in lanes.iter().enumerate() {
        let Some(start) = &case.start else { continue };
        for (age, step) in steps[..PAST].iter_mut().rev().enumerate() {
            for (i, (closure, traction)) in start.closure.iter().zip(&start.traction).enumerate() {
                let cells = closure[age] * case.tabulated.cells_per_metre(i);
                set_lane::<S>(&mut step.closure[i], lane, cells);
                set_lane::<S>(&mut step.pressure[i], lane, traction[age]);
            }
        }
    }
    steps
}

impl<'a, S: TableLookup, C: Coefficient<S>, const N: usize> Run<'a, S, C, N> {
    #[inline(always)]
    pub(super) fn new(simd: S, lanes: &[&'a PreparedCase], recording: Recording<'_>) -> Self {
        let mut block = Block::new(simd, lanes);
        block.start();
        let steps = lanes.first().map_or(0, |lane| lane.integrated());
        let all_steps = lanes.first().map_or(0, |lane| lane.steps);
        let zero = LanePair(simd).splat(0.0);
        let first = lanes.first().map_or(0, |lane| lane.first_step());
        let mut decimator = None;
        let mut recorded = Vec::new();
        match recording {
            Recording::Decimated(decimation) => {
                // A run that ends in closed form takes in the output at its last step too.
                let mut new =
                    Decimator::new(simd, decimation, [all_steps.min(steps + 1), all_steps]);
                for (lane, case) in lanes.iter().enumerate() {
                    if let Some(start) = &case.start {
                        new.take_before(lane, &start.readings);
                    }
                }
                decimator = Some(new);
            }
            Recording::EveryStep => {
                recorded = lanes.iter().map(|lane| RecordedSteps::begin(lane, steps)).collect();
            }
        }
        Self {
            extremes: BlockExtremes::new(simd, &block),
            chunk: past_steps(simd, lanes),
            load: vec![Load([zero; 3]); CHUNK],
            decimator,
            recorded,
            chunks: 0,
            ends: lanes.iter().map(|_| RunEnd::Done).collect(),
            states: vec![[zero; LAST_STATES]; block.modes.len()],
            samples: Vec::new(),
            first,
            steps,
            all_steps,
            block,
        }
    }

    pub(super) fn goes_on(&self) -> bool {
        self.ends.contains(&RunEnd::Done)
    }

    /// Ends the lanes that are not done at step `reached`.
    pub(super) fn stop(&mut self, reached: usize) {
        for end in self.ends.iter_mut().filter(|end| **end == RunEnd::Done) {
            *end = RunEnd::Stopped(reached);
        }
    }

    /// Takes the `count` steps after step `reached`.
    #[inline(always)]
    pub(super) fn advance(&mut self, simd: S, reached: usize, count: usize) {
        let loaded = self.block.take_load(simd, &mut self.load[..count], reached);
        for n in 0..count {
            let (past, next) = self.chunk.split_at_mut(PAST + n);
            let (Some(past), [step, ..]) = (past.last_chunk::<PAST>(), next) else { return };
            let load = &self.load[n];
            let mut before = None;
            if loaded {
                before = Some(self.block.load_port_increment(simd));
                self.block.push(simd, load);
            }
            self.block.step(simd, past, step);
            if let Some(before) = before {
                self.block.count_work(simd, load, before, step);
            }
        }
    }

    /// Keeps step `n` of the chunk whole.
    #[cold]
    fn keep(&mut self, n: usize) {
        let step = &self.chunk[PAST + n];
        for (lane, recorded) in self.recorded.iter_mut().enumerate() {
            let of = |numbers: &LaneVector<S>| lane_of::<S>(numbers, lane);
            recorded.displacement.push(of(&step.reading));
            for (i, column) in recorded.pressure.iter_mut().enumerate() {
                column.push(of(&step.pressure[i]));
            }
            for (i, column) in recorded.closure.iter_mut().enumerate() {
                column.push(of(&step.closure[i]));
            }
        }
    }

    #[inline(always)]
    pub(super) fn end(&mut self, simd: S, reached: usize, count: usize) {
        let chunk = &self.chunk[PAST..PAST + count];
        self.extremes.take(simd, chunk);
        if let Some(decimator) = &mut self.decimator {
            // The state at the very end is beyond the samples.
            let samples = count - usize::from(reached == self.all_steps);
            decimator.take(simd, &chunk[..samples]);
        }
        if self.steps - reached < LAST_STATES {
            for (states, mode) in self.states.iter_mut().zip(&self.block.modes) {
                states.rotate_right(1);
                states[0] = LanePair(simd).sub(mode.predicted, mode.predicted_increment);
            }
        }
        if self.chunks.is_multiple_of(8) || reached == self.steps {
            self.check_failures(reached);
        }
        self.chunks += 1;
        if !self.recorded.is_empty() {
            for n in 0..count {
                self.keep(n);
            }
        }
        self.chunk.copy_within(count..count + PAST, 0);
    }

    fn check_failures(&mut self, reached: usize) {
        for (lane, end) in self.ends.iter_mut().enumerate() {
            let (RunEnd::Done, Some(case)) = (*end, self.block.lanes[lane]) else { continue };
            for (i, table) in case.tabulated.tables.iter().enumerate() {
                let seen = self.extremes.extremes(i, lane);
                if seen.lost {
                    *end = RunEnd::NotFinite(reached, i);
                    break;
                }
                // Beyond the table its last value was used.
                let cells = table.cells().len() as f64 - table.scales()[1].offset;
                if seen.highest_step >= cells {
                    *end = RunEnd::Beyond(i);
                    break;
                }
            }
        }
    }

    /// Finishes the samples of each lane, with the rest of a response in closed form.
    #[inline(always)]
    pub(super) fn finish_samples(&mut self) {
        self.samples = self.decimator.take().map(Decimator::finish).unwrap_or_default();
        for (lane, samples) in self.samples.iter_mut().enumerate() {
            let Some(case) = self.block.lanes[lane] else { continue };
            let Some(tail) = &case.tail else { continue };
            let of = |numbers: &LaneVector<S>| lane_of::<S>(numbers, lane);
            let mut state = Vec::with_capacity(self.block.modes.len() * (NODES + 1));
            for (mode, model) in self.block.modes.iter().zip(&case.tabulated.step_model.modes) {
                state.extend([of(&mode.predicted), of(&mode.predicted_increment)]);
                state.extend(mode.carry[..carried(model)].iter().map(of));
            }
            tail.add_to(&mut samples.filtered, &mut samples.ending, &state);
        }
    }

    pub(super) fn outcomes(mut self) -> Vec<Outcome> {
        let mut recorded = std::mem::take(&mut self.recorded);
        // The newest step is the last of those before the next chunk.
        let newest = &self.chunk[PAST - 1];
        let lanes = self.ends.iter().enumerate();
        let outcome = |(lane, &end): (usize, &RunEnd)| {
            let of = |numbers: &LaneVector<S>| lane_of::<S>(numbers, lane);
            let case = self.block.lanes[lane]?;
            let contacts = case.tabulated.tables.iter().enumerate().map(|(i, table)| {
                let (contact, damper) = (&self.block.contacts[i], self.block.dampers.get(i));
                let per_metre = table.scales()[1].cells_per_metre;
                // Where the law counts as straight, its stiffness is that at rest.
                let rest = (self.all_steps - self.steps) as f64 * table.tangent(0.0);
                ContactOutcome {
                    extremes: self.extremes.extremes(i, lane).scaled(1.0 / per_metre),
                    stiffness: (of(&contact.stiffness) * per_metre + rest) / self.all_steps as f64,
                    loss: damper.map_or(0.0, |one| total_work::<S>(&one.work, lane) / per_metre),
                    closure: of(&newest.closure[i]) / per_metre,
                }
            });
            let contacts = contacts.collect();
            let mut columns = recorded.get_mut(lane).map(std::mem::take).unwrap_or_default();
            for (i, column) in columns.closure.iter_mut().enumerate() {
                let per_metre = case.tabulated.cells_per_metre(i);
                for cells in column {
                    *cells /= per_metre;
                }
            }
            let kept = self.samples.get_mut(lane).map(std::mem::take);
            let (displacement, ending) = match kept {
                Some(LaneSamples { filtered, ending }) => (filtered, ending),
                None => (columns.displacement, Vec::new()),
            };
            let rows = 0..case.model.rows();
            let (mut friction_stored, mut friction_loss) = (0.0, 0.0);
            for (i, slider) in rows.clone().zip(&self.block.sliders) {
                let Some((friction, _)) = case.model.friction(i) else { continue };
                let force = case.model.area(i) * of(&slider.work.traction);
                let stored = 0.5 * force * force / friction.stiffness();
                let per_metre = case.tabulated.cells_per_metre(i);
                let work = case.model.area(i) * total_work::<S>(&slider.work, lane) / per_metre;
                friction_stored += stored;
                friction_loss += work - stored;
            }
            Some(Outcome {
                end,
                row_tractions: rows.map(|i| of(&newest.pressure[i])).collect(),
                friction_stored,
                friction_loss,
                displacement,
                ending,
                traction: columns.pressure,
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
