//! The same scheme as Eq. (4) in one plain loop over the nodes in order, vectorised by the compiler
//! for each instruction set.
//!
//! Node 1 lies on a cache line, the inner nodes are padded to whole groups, and ends and contacts
//! come before the sweeps. The pressure is that of a table; there is no energy ledger.

use asperity_dynamics::{InstructionSet, Sampling};
use asperity_law::{CompiledLaw, InSeries};
use asperity_mesh::{BarGrid, Grid};
use asperity_structure::{LoadCase, PreloadedStructure};
use pulp::{Arch, Simd, WithSimd};

const LINE: usize = 8;
const GROUP: usize = 16;

/// Place of node 0.
const FIRST: usize = LINE - 1;

/// Displacements at the newest step and before, and the coefficients of Eq. (4).
struct Bar {
    states: [Vec<f64>; 2],
    starts: [usize; 2],
    swept: usize,
    last: usize,
    ends: [f64; 2],
    own: f64,
    neighbour: f64,
    past: f64,
    compliance: f64,
}

struct Contact {
    area: f64,
    table: CompiledLaw,
    now: f64,
    before: f64,
}

/// A run on one instruction set; its output is the top's displacement at the output samples.
pub(crate) struct Plain<'a> {
    pub(crate) structure: &'a PreloadedStructure,
    pub(crate) excitation: &'a LoadCase,
    pub(crate) sampling: &'a Sampling,
}

impl Plain<'_> {
    pub(crate) fn run(self, set: InstructionSet) -> Vec<f64> {
        let arch = match set {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => pulp::x86::V3::try_new().map(Arch::V3),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => pulp::x86::V4::try_new().map(Arch::V4),
            #[cfg(target_arch = "aarch64")]
            InstructionSet::Neon => pulp::aarch64::Neon::try_new().map(Arch::Neon),
            _ => Some(Arch::Scalar),
        };
        arch.unwrap().dispatch(self)
    }
}

impl WithSimd for Plain<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        let grid = Grid::new(self.structure.stack(), 1e-3).unwrap();
        let (step, stride) = grid.step_within(self.sampling.interval(), 0.95).unwrap();
        let rate = self.structure.damping_rate();
        let mut bars: Vec<Bar> = grid.bars().iter().map(|bar| Bar::new(bar, step, rate)).collect();
        let mut contacts = contacts(self.structure, &bars, self.excitation);
        let mut displacement = Vec::with_capacity(self.sampling.samples());
        let mut forces = vec![0.0; stride];
        let mut steps = 0;
        for sample in 0..self.sampling.samples() {
            let start = sample as f64 * self.sampling.interval();
            for (n, force) in forces.iter_mut().enumerate() {
                *force = self.excitation.value(start + n as f64 * step);
            }
            displacement.push(bars[0].ends[0]);
            for &force in &forces {
                if steps % 2 == 0 {
                    advance::<S, 0>(&mut bars, &mut contacts, force);
                } else {
                    advance::<S, 1>(&mut bars, &mut contacts, force);
                }
                steps += 1;
            }
        }
        displacement
    }
}

impl Bar {
    fn new(grid: &BarGrid, step: f64, rate: f64) -> Self {
        let (a1, a2) = ((step / grid.crossing_time()).powi(2), rate * step);
        let swept = (grid.nodes() - 2).next_multiple_of(GROUP);
        let states = [(); 2].map(|()| vec![0.0; swept + 3 * LINE]);
        let start = |state: &Vec<f64>| state.as_ptr().align_offset(LINE * size_of::<f64>());
        Self {
            starts: states.each_ref().map(start),
            states,
            swept,
            last: FIRST + grid.nodes() - 1,
            ends: [0.0; 2],
            own: (2.0 * (1.0 - a1) + a2) / (1.0 + a2),
            neighbour: a1 / (1.0 + a2),
            past: -1.0 / (1.0 + a2),
            compliance: step * step / (grid.end_mass() * (1.0 + a2)),
        }
    }

    /// Displacements that the ends would reach without forces on them.
    #[inline(always)]
    fn unloaded_ends<S: Simd, const PARITY: usize>(&self) -> [f64; 2] {
        let now = &self.states[PARITY][self.starts[PARITY]..];
        let before = &self.states[1 - PARITY][self.starts[1 - PARITY]..];
        let (last, twice) = (self.last, 2.0 * self.neighbour);
        let top = fused::<S>(self.past, before[FIRST], twice * now[FIRST + 1]);
        let bottom = fused::<S>(self.past, before[last], twice * now[last - 1]);
        [fused::<S>(self.own, now[FIRST], top), fused::<S>(self.own, now[last], bottom)]
    }

    #[inline(always)]
    fn sweep<S: Simd, const PARITY: usize>(&mut self) {
        let [even, odd] = &mut self.states;
        let (now, next) = if PARITY == 0 { (even, odd) } else { (odd, even) };
        let now = &now[self.starts[PARITY]..];
        let next = &mut next[self.starts[1 - PARITY]..];
        next[FIRST] = self.ends[0];
        let inner = &mut next[FIRST + 1..][..self.swept];
        eq4::<S>(inner, &now[FIRST..], self.own, self.neighbour, self.past);
        next[self.last] = self.ends[1];
    }
}

/// Eq. (4): `state` goes from the step before to the next, `now` starts one node to its left.
#[inline(always)]
fn eq4<S: Simd>(state: &mut [f64], now: &[f64], own: f64, neighbour: f64, past: f64) {
    let count = state.len();
    let (left, middle, right) = (&now[..count], &now[1..][..count], &now[2..][..count]);
    for (((state, left), middle), right) in state.iter_mut().zip(left).zip(middle).zip(right) {
        let inertia = fused::<S>(own, *middle, past * *state);
        *state = fused::<S>(neighbour, left + right, inertia);
    }
}

#[inline(always)]
fn fused<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::F64_LANES > 1 { a.mul_add(b, c) } else { a * b + c }
}

fn contacts(structure: &PreloadedStructure, bars: &[Bar], excitation: &LoadCase) -> Vec<Contact> {
    let contacts = structure.contacts().iter().enumerate();
    contacts
        .map(|(i, contact)| {
            let below = bars.get(i + 1).map_or(0.0, |bar| bar.compliance);
            let b = 0.5 * contact.area() * (bars[i].compliance + below);
            let series = InSeries::new(contact.law().clone(), 1.0 / b).unwrap();
            let top = contact.pressure() + 3.0 * excitation.peak() / contact.area();
            let table = CompiledLaw::new(&series, contact.pressure(), top, 1e-6).unwrap();
            Contact { area: contact.area(), table, now: 0.0, before: 0.0 }
        })
        .collect()
}

#[inline(always)]
fn advance<S: Simd, const PARITY: usize>(bars: &mut [Bar], contacts: &mut [Contact], force: f64) {
    for bar in bars.iter_mut() {
        bar.ends = bar.unloaded_ends::<S, PARITY>();
    }
    bars[0].ends[0] += force * bars[0].compliance;
    for (i, contact) in contacts.iter_mut().enumerate() {
        let above = bars[i].ends[1];
        let below = bars.get(i + 1).map_or(0.0, |bar| bar.ends[0]);
        let push = contact.area * contact.table.get(0.5 * (above - below + contact.before));
        let up = push * bars[i].compliance;
        bars[i].ends[1] -= up;
        let mut down = 0.0;
        if let Some(bar) = bars.get_mut(i + 1) {
            down = push * bar.compliance;
            bar.ends[0] += down;
        }
        contact.before = contact.now;
        contact.now = above - below - up - down;
    }
    for bar in bars {
        bar.sweep::<S, PARITY>();
    }
}
