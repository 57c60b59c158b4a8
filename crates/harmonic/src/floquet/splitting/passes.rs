//! The kernel of the splitting: kicks and rotations of many states side by side.
#![allow(
    clippy::inline_always,
    reason = "kernels must be compiled with their caller, for the vector instructions chosen"
)]

use faer::Mat;
use pulp::{Simd, WithSimd};

/// Vectors of states that one pass advances: on four lanes the columns of six modes.
const VECTORS: usize = 3;

/// All kicks and rotations of a period. Each pass over the modes is a kick,
/// `v -= weight Phi^T dK Phi q`, the rotation that follows, and the closures there.
pub(super) struct Passes<'a> {
    pub(super) interfaces: usize,
    /// Share of the step of each kick, of which there is one more than changes.
    pub(super) weights: &'a [f64],
    /// Rotations of the modes, stage after stage.
    pub(super) rotations: &'a [[f64; 4]],
    /// Closures of the modes, mode by mode, and the same with the factors of a kick.
    pub(super) shapes: &'a [f64],
    pub(super) kicks: &'a [f64],
    /// Change of stiffness, a square matrix for each kick.
    pub(super) changes: &'a [f64],
}

impl Passes<'_> {
    /// Writes the states after the period, a column for each state at its start.
    pub(super) fn columns(&self, matrix: &mut Mat<f64>) {
        let columns = Columns { passes: self, matrix };
        // Vectors of 512 bits would be filled by two thirds with the columns of six modes.
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            return Simd::vectorize(simd, columns);
        }
        pulp::Arch::new().dispatch(columns);
    }

    /// Advances displacements and velocities of the modes over the period, with `n` interfaces:
    /// `closures` and `forces` are memory.
    #[inline(always)]
    fn advance<S: Simd>(
        &self,
        simd: S,
        n: usize,
        states: &mut [Pair<S>],
        (closures, forces): (&mut [Vectors<S>], &mut [Vectors<S>]),
    ) {
        let zero = [simd.splat_f64s(0.0); VECTORS];
        closures.fill(zero);
        for ((q, _), shape) in states.iter().zip(self.shapes.chunks_exact(n)) {
            for (closure, phi) in closures.iter_mut().zip(shape) {
                add(simd, closure, *phi, q);
            }
        }
        let stages = self.rotations.len() / states.len();
        let mut rotations = self.rotations.chunks_exact(states.len());
        let last = self.weights.len() - 1;
        debug_assert_eq!(last % stages, 0);
        let mut changes = self.changes.chunks_exact(n * n);
        for weight in &self.weights[..last] {
            let Some(changes) = changes.next() else { return };
            loads(simd, *weight, changes, closures, forces);
            let stage = rotations.next().or_else(|| {
                rotations = self.rotations.chunks_exact(states.len());
                rotations.next()
            });
            closures.fill(zero);
            let modes = self.kicks.chunks_exact(n).zip(self.shapes.chunks_exact(n));
            let modes = modes.zip(stage.unwrap_or(&[]));
            for ((q, v), ((kick, shape), [a, b, c, d])) in states.iter_mut().zip(modes) {
                for (force, phi) in forces.iter().zip(kick) {
                    add(simd, v, *phi, force);
                }
                let [a, b, c, d] = [a, b, c, d].map(|factor| simd.splat_f64s(*factor));
                for lane in 0..VECTORS {
                    let (x, y) = (q[lane], v[lane]);
                    q[lane] = simd.mul_add_e_f64s(a, x, simd.mul_f64s(b, y));
                    v[lane] = simd.mul_add_e_f64s(c, x, simd.mul_f64s(d, y));
                }
                for (closure, phi) in closures.iter_mut().zip(shape) {
                    add(simd, closure, *phi, q);
                }
            }
        }
        // The last kick acts where the first does.
        loads(simd, self.weights[last], &self.changes[..n * n], closures, forces);
        for ((_, v), kick) in states.iter_mut().zip(self.kicks.chunks_exact(n)) {
            for (force, phi) in forces.iter().zip(kick) {
                add(simd, v, *phi, force);
            }
        }
    }
}

type Vectors<S> = [<S as Simd>::f64s; VECTORS];

/// Displacements and velocities of a mode.
type Pair<S> = (Vectors<S>, Vectors<S>);

struct Columns<'a, 'm> {
    passes: &'a Passes<'a>,
    matrix: &'m mut Mat<f64>,
}

impl WithSimd for Columns<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { passes, matrix } = self;
        let size = matrix.ncols();
        let count = size / 2;
        let width = VECTORS * S::F64_LANES;
        let zero = [simd.splat_f64s(0.0); VECTORS];
        let mut states = vec![(zero, zero); count];
        let (mut closures, mut forces) =
            (vec![zero; passes.interfaces], vec![zero; passes.interfaces]);
        for first in (0..size).step_by(width) {
            states.fill((zero, zero));
            let columns = first..size.min(first + width);
            for (lane, column) in columns.clone().enumerate() {
                let (q, v) = &mut states[column % count];
                numbers_mut::<S>(if column < count { q } else { v })[lane] = 1.0;
            }
            match passes.interfaces {
                1 => passes.advance(simd, 1, &mut states, (&mut [zero; 1], &mut [zero; 1])),
                2 => passes.advance(simd, 2, &mut states, (&mut [zero; 2], &mut [zero; 2])),
                n => passes.advance(simd, n, &mut states, (&mut closures, &mut forces)),
            }
            for (lane, column) in columns.enumerate() {
                for (row, (q, v)) in states.iter().enumerate() {
                    matrix[(row, column)] = numbers::<S>(q)[lane];
                    matrix[(count + row, column)] = numbers::<S>(v)[lane];
                }
            }
        }
    }
}

/// `-weight dK` times the closures.
#[inline(always)]
fn loads<S: Simd>(
    simd: S,
    weight: f64,
    changes: &[f64],
    closures: &[Vectors<S>],
    forces: &mut [Vectors<S>],
) {
    let rows = changes.chunks_exact(closures.len());
    for (force, row) in forces.iter_mut().zip(rows) {
        *force = [simd.splat_f64s(0.0); VECTORS];
        for (closure, change) in closures.iter().zip(row) {
            add(simd, force, -weight * change, closure);
        }
    }
}

#[inline(always)]
fn add<S: Simd>(simd: S, to: &mut Vectors<S>, factor: f64, what: &Vectors<S>) {
    let factor = simd.splat_f64s(factor);
    for lane in 0..VECTORS {
        to[lane] = simd.mul_add_e_f64s(factor, what[lane], to[lane]);
    }
}

fn numbers<S: Simd>(vectors: &Vectors<S>) -> &[f64] {
    pulp::bytemuck::cast_slice(vectors)
}

fn numbers_mut<S: Simd>(vectors: &mut Vectors<S>) -> &mut [f64] {
    pulp::bytemuck::cast_slice_mut(vectors)
}
