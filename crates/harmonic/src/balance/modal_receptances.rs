//! Receptances between many contacts, in modes and residual flexibility.

use asperity_mesh::{ComponentModes, PortPair};
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side, c64};
use num_complex::Complex64;

use crate::ContactSystem;
use crate::component_modes::{RigidMotions, places};
use crate::dual::{Dual, Part};

/// Change of a spring, over the stiffest, from which on the structure is put on other springs.
const CHANGED: f64 = 0.1;

/// A structure in component modes on springs k in its contacts.
///
/// With the shapes `Phi` and the residual flexibility R of the contacts and ports, `s = k^1/2` and the Cholesky
/// factor `L L^T = 1 + s R s`, the receptances on springs are, exactly,
///
/// ```text
/// G(w) = R' + Phi' Z(w)^-1 Phi'^T,    Y = L^-1 s [R, Phi],
/// R' = R - Y_R^T Y_R,    Phi' = Phi - Y_R^T Y_Phi,    Z(w) = diag(w_r^2 - w^2 + i w c_r) + Y_Phi^T Y_Phi.
/// ```
///
/// Only Z depends on the frequency, and its size is the number of modes. No matrix of the contacts is formed at a
/// harmonic. The mean is harmonic 0 of the same equations, without the rigid motions that close no contact, which
/// stay at rest.
#[derive(Debug)]
pub(super) struct ModalReceptances {
    terms: usize,
    pairs: usize,
    /// Square of the angular frequency, modal mass (one, or zero) and damping rate of each mode.
    oscillators: Vec<(f64, f64, f64)>,
    /// Modes that take part in the means.
    held: Vec<usize>,
    /// Of all places, the pairs first, then the ports.
    shapes: Mat<f64>,
    flexibility: Mat<f64>,
    springs: Vec<f64>,
    /// Springs over the mean tangents that they follow.
    factor: f64,
    on_springs: OnSprings,
    at: (f64, f64),
    /// Factors of Z at each harmonic.
    dynamic: Vec<PartialPivLu<c64>>,
}

/// Flexibility, shapes and modal stiffness on springs, and the factors of Z for the means.
#[derive(Debug)]
struct OnSprings {
    flexibility: Mat<f64>,
    shapes: Mat<f64>,
    stiffness: Mat<f64>,
    mean: PartialPivLu<f64>,
}

impl OnSprings {
    fn new(of: &ModalReceptances, springs: &[f64]) -> Option<Self> {
        let (n, modes, places) = (of.pairs, of.shapes.ncols(), of.shapes.nrows());
        let roots: Vec<f64> = springs.iter().map(|k| k.sqrt()).collect();
        let (r, phi) = (&of.flexibility, &of.shapes);
        let coupled = Mat::from_fn(n, n, |i, j| {
            roots[i] * r[(i, j)] * roots[j] + f64::from(u8::from(i == j))
        });
        let mut y = Mat::from_fn(n, places + modes, |i, j| {
            roots[i] * if j < places { r[(i, j)] } else { phi[(i, j - places)] }
        });
        let factor = coupled.llt(Side::Lower).ok()?;
        solve_lower_triangular_in_place(factor.L(), y.as_mut(), Par::Seq);
        let (y_r, y_phi) = y.as_ref().split_at_col(places);
        let mut flexibility = of.flexibility.clone();
        let mut shapes = of.shapes.clone();
        let less = |from: &mut Mat<f64>, y: MatRef<'_, f64>| {
            matmul(from, Accum::Add, y_r.transpose(), y, -1.0, Par::Seq);
        };
        less(&mut flexibility, y_r);
        less(&mut shapes, y_phi);
        let stiffness = y_phi.transpose() * y_phi;
        let held = &of.held;
        let mean = Mat::from_fn(held.len(), held.len(), |i, j| {
            let own = if i == j { of.oscillators[held[i]].0 } else { 0.0 };
            own + stiffness[(held[i], held[j])]
        });
        Some(Self { flexibility, shapes, stiffness, mean: mean.partial_piv_lu() })
    }
}

impl ModalReceptances {
    /// Receptances at so many harmonics of a system in component modes on the springs of its contacts at rest; none
    /// for another system.
    pub(super) fn new(
        system: &ContactSystem,
        harmonics: usize,
        (springs, factor): (&[f64], f64),
    ) -> Option<Self> {
        let modes: &ComponentModes = system.linear().as_component_modes()?;
        let places = places(modes, system.ports());
        let RigidMotions { modes: rigid, held } = RigidMotions::of(modes);
        let elastic = modes.modes().iter().filter(|mode| mode.angular_frequency > 0.0);
        let count = rigid.len();
        let all: Vec<_> = rigid.iter().chain(elastic).collect();
        let rate = system.linear().mass_damping();
        let mut found = Self {
            terms: 2 * harmonics + 1,
            pairs: system.pairs(),
            oscillators: all
                .iter()
                .map(|mode| {
                    let mass = if mode.massless { 0.0 } else { 1.0 };
                    (mode.angular_frequency.powi(2), mass, mode.total_damping(rate))
                })
                .collect(),
            held: (0..all.len()).filter(|&r| r < held || r >= count).collect(),
            shapes: Mat::from_fn(places.len(), all.len(), |a, r| all[r].closure(places[a])),
            flexibility: flexibility(modes, &places),
            springs: springs.to_vec(),
            factor,
            on_springs: OnSprings {
                flexibility: Mat::new(),
                shapes: Mat::new(),
                stiffness: Mat::new(),
                mean: Mat::<f64>::new().partial_piv_lu(),
            },
            at: (f64::NAN, f64::NAN),
            dynamic: Vec::new(),
        };
        found.on_springs = OnSprings::new(&found, springs)?;
        Some(found)
    }

    /// The springs \[N/m\].
    pub(super) fn springs(&self) -> &[f64] {
        &self.springs
    }

    /// Puts the structure on springs for the mean `tangents` \[N/m\], if they differ much from those that it is on.
    pub(super) fn follow(&mut self, tangents: impl Iterator<Item = f64>) {
        let wanted: Vec<f64> = tangents.map(|k| self.factor * k.max(0.0)).collect();
        let pairs = || wanted.iter().zip(&self.springs);
        let stiffest = pairs().map(|(a, b)| a.max(*b)).fold(0.0, f64::max);
        let change = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Springs that are not finite belong to an overflow, which is reported elsewhere.
        if change > CHANGED * stiffest
            && let Some(on_springs) = OnSprings::new(self, &wanted)
        {
            (self.springs, self.on_springs) = (wanted, on_springs);
            self.at = (f64::NAN, f64::NAN);
        }
    }

    /// Moves to a frequency and an anti-damping rate.
    pub(super) fn update(&mut self, at: (f64, f64)) {
        if self.at != at {
            self.at = at;
            let harmonics = 1..=self.terms / 2;
            self.dynamic = harmonics.map(|k| self.dynamic_stiffness(k).partial_piv_lu()).collect();
        }
    }

    /// Z at harmonic k >= 1.
    fn dynamic_stiffness(&self, k: usize) -> Mat<c64> {
        let stiffness = &self.on_springs.stiffness;
        Mat::from_fn(stiffness.nrows(), stiffness.ncols(), |a, b| {
            let own = if a == b { self.oscillator(a, k).value } else { Complex64::ZERO };
            own + stiffness[(a, b)]
        })
    }

    fn oscillator(&self, r: usize, k: usize) -> Dual {
        Dual::oscillator(self.oscillators[r], (k as f64 * self.at.0, self.at.1))
    }

    /// Coordinates of the modes, `Z^-1 Phi'^T f` less the load's, a column for each term; of a derivative,
    /// `-Z^-1 Z' Z^-1 Phi'^T f`.
    fn coordinates(&self, part: Part, (forces, load): (&[f64], f64)) -> Mat<f64> {
        let shapes = &self.on_springs.shapes;
        let forces = MatRef::from_row_major_slice(forces, self.pairs, self.terms);
        let mut along = shapes.as_ref().subrows(0, self.pairs).transpose() * forces;
        let modes = along.nrows();
        (0..modes).for_each(|r| along[(r, 1)] -= load * shapes[(self.pairs, r)]);
        for (k, factors) in (1..).zip(&self.dynamic) {
            let mut y = Mat::from_fn(modes, 1, |r, _| {
                Complex64::new(along[(r, 2 * k - 1)], -along[(r, 2 * k)])
            });
            factors.solve_in_place(y.as_mut());
            if part != Part::Value {
                for r in 0..modes {
                    y[(r, 0)] *= -self.oscillator(r, k).part(part);
                }
                factors.solve_in_place(y.as_mut());
            }
            for r in 0..modes {
                (along[(r, 2 * k - 1)], along[(r, 2 * k)]) = (y[(r, 0)].re, -y[(r, 0)].im);
            }
        }
        let held = &self.held;
        let mut mean = Mat::from_fn(held.len(), 1, |i, _| along[(held[i], 0)]);
        (0..modes).for_each(|r| along[(r, 0)] = 0.0);
        if part == Part::Value {
            self.on_springs.mean.solve_in_place(mean.as_mut());
            held.iter().enumerate().for_each(|(i, &r)| along[(r, 0)] = mean[(i, 0)]);
        }
        along
    }

    /// Writes `x + G f - g F` of all pairs, of the means too.
    pub(super) fn residual(&self, x: &[f64], forces: (&[f64], f64), out: &mut [f64]) {
        self.respond(0..self.pairs, Part::Value, forces, out);
        out.iter_mut().zip(x).for_each(|(r, x)| *r += x);
    }

    /// Writes the series of `G f - g F`, or of a derivative of the receptances, of some places.
    pub(super) fn respond(
        &self,
        places: std::ops::Range<usize>,
        part: Part,
        (forces, load): (&[f64], f64),
        out: &mut [f64],
    ) {
        let OnSprings { flexibility, shapes, .. } = &self.on_springs;
        let (first, count) = (places.start, places.len());
        let coordinates = self.coordinates(part, (forces, load));
        let mut to = MatMut::from_row_major_slice_mut(out, count, self.terms);
        matmul(
            to.as_mut(),
            Accum::Replace,
            shapes.as_ref().subrows(first, count),
            &coordinates,
            1.0,
            Par::Seq,
        );
        if part == Part::Value {
            let own = flexibility.as_ref().subrows(first, count);
            let forces = MatRef::from_row_major_slice(forces, self.pairs, self.terms);
            matmul(to.as_mut(), Accum::Add, own.subcols(0, self.pairs), forces, 1.0, Par::Seq);
            (0..count).for_each(|a| to[(a, 1)] -= load * own[(a, self.pairs)]);
        }
    }

    /// `G_1` between the load and each pair, and after them the load itself.
    pub(super) fn load_row(&self) -> Vec<Complex64> {
        let OnSprings { flexibility, shapes, .. } = &self.on_springs;
        let (load, modes) = (self.pairs, shapes.ncols());
        let mut y = Mat::from_fn(modes, 1, |r, _| Complex64::from(shapes[(load, r)]));
        self.dynamic[0].solve_in_place(y.as_mut());
        let modal = |a: usize| (0..modes).map(|r| y[(r, 0)] * shapes[(a, r)]).sum::<Complex64>();
        (0..=load).map(|a| modal(a) + flexibility[(load, a)]).collect()
    }

    /// `sum f f^T dG/dxi` of the fundamental over the pairs and the load.
    pub(super) fn inertia(&self, forces: (&[f64], f64)) -> Complex64 {
        let y = self.coordinates(Part::Value, forces);
        let own = |r: usize| {
            let y = Complex64::new(y[(r, 1)], -y[(r, 2)]);
            -y * y * self.oscillator(r, 1).d_anti_damping
        };
        (0..y.nrows()).map(own).sum()
    }

    /// Largest square of a closure beyond the harmonics kept, up to twice as many, under series of forces up to
    /// there.
    pub(super) fn omitted(&self, series: &[f64]) -> f64 {
        let OnSprings { flexibility, shapes, .. } = &self.on_springs;
        let (n, wide, modes) = (self.pairs, 2 * self.terms - 1, shapes.ncols());
        let forces =
            MatRef::from_row_major_slice(series, n, wide).subcols(self.terms, self.terms - 1);
        let along = shapes.as_ref().subrows(0, n).transpose() * forces;
        let mut coordinates = Mat::zeros(modes, self.terms - 1);
        for k in 0..self.terms / 2 {
            let amplitude = |r: usize| Complex64::new(along[(r, 2 * k)], -along[(r, 2 * k + 1)]);
            let mut y = Mat::from_fn(modes, 1, |r, _| amplitude(r));
            let factors = self.dynamic_stiffness(self.terms / 2 + 1 + k).partial_piv_lu();
            factors.solve_in_place(y.as_mut());
            for r in 0..modes {
                (coordinates[(r, 2 * k)], coordinates[(r, 2 * k + 1)]) =
                    (y[(r, 0)].re, -y[(r, 0)].im);
            }
        }
        let closures = shapes.as_ref().subrows(0, n) * coordinates
            + flexibility.as_ref().submatrix(0, 0, n, n) * forces;
        let square = |at: usize| {
            let (i, k) = (at % n, at / n);
            closures[(i, 2 * k)].powi(2) + closures[(i, 2 * k + 1)].powi(2)
        };
        (0..n * (self.terms / 2)).map(square).fold(0.0, f64::max)
    }
}

/// Residual flexibility between all places.
fn flexibility(modes: &ComponentModes, places: &[PortPair]) -> Mat<f64> {
    Mat::from_fn(places.len(), places.len(), |a, b| modes.residual().closure(places[a], places[b]))
}
