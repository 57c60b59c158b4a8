//! Responses at given frequencies and forces, as a stepped-sine test measures them, with their
//! derivatives.
//!
//! Each response is found by Newton's method from the one before, so that a sweep stays on its branch
//! as a shaker does, and jumps at a fold. Its derivative with respect to any parameter of the system
//! follows from the balance `R(X, a) = 0` at the response,
//!
//! ```text
//! dX/da = -(dR/dX)^-1 dR/da,    du/da = du/dX dX/da + (du/da at fixed X),
//! ```
//!
//! where `dR/da` and `du/da` at fixed closures X come from differences over systems about it.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::balance::{Balance, Conditions};
use crate::factorization::Factorization;
use crate::linear_response::LinearSolver;
use crate::{ContactSystem, PortMotion};

/// Largest number of Newton iterations, and relative correction at which they end.
const MOST_ITERATIONS: usize = 40;
const TOLERANCE: f64 = 1e-11;

/// Samples of a period for each harmonic.
const SAMPLES_PER_HARMONIC: usize = 16;

/// Shortest part of the way from one condition to the next, and first force of a ramp over the force.
const SHORTEST: f64 = 1.0 / 64.0;
const FIRST_FORCE: f64 = 1e-3;

/// Frequency and amplitude of a harmonic force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Force amplitude \[N\].
    pub force: f64,
}

/// A response to a [`Drive`].
#[derive(Debug, Clone, PartialEq)]
pub struct SineResponse {
    /// Complex amplitude of the fundamental of the displacement of the load's port \[m\]; a response
    /// that lags has a negative phase.
    pub displacement: Complex64,
    /// Motions of the sensors.
    pub sensors: Vec<PortMotion>,
    /// Closure increments from rest, as in [`PeriodicResponse`](crate::PeriodicResponse) \[m\].
    pub closures: Vec<f64>,
    /// Lowest and highest closure increment of each interface at the samples of the period \[m\].
    pub closure_range: Vec<[f64; 2]>,
    /// Largest closure harmonic estimated to be missing, over the largest kept.
    pub truncation: f64,
}

/// Solves for responses with a fixed number of harmonics.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_harmonic::{ContactSystem, Drive, LawEvaluation, RigidMass, SteppedSineSolver};
/// use asperity_law::Power;
/// use asperity_structure::PreloadedContact;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let law = Arc::new(Power::new(0.9e10, 0.35, 0.0)?);
/// let contact = PreloadedContact::new("guide", 1.15e-4, law, 1.37e5)?;
/// let mass = Arc::new(RigidMass::new(1.61, 420.0)?);
/// let system = ContactSystem::new(mass, vec![contact], LawEvaluation::Exact)?;
/// let drives = [800.0, 820.0, 840.0].map(|frequency_hz| Drive { frequency_hz, force: 0.5 });
/// let found = SteppedSineSolver::new(&system, 7).sweep(&drives);
/// assert!(found.iter().all(Option::is_some));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct SteppedSineSolver<'a> {
    system: &'a ContactSystem,
    balance: Balance<'a>,
    matrix: Factorization,
}

impl<'a> SteppedSineSolver<'a> {
    /// A solver with so many harmonics, at least 1 and at most
    /// [`MOST_HARMONICS`](crate::FourierResolution::MOST_HARMONICS).
    pub fn new(system: &'a ContactSystem, harmonics: usize) -> Self {
        let harmonics = harmonics.clamp(1, crate::FourierResolution::MOST_HARMONICS);
        let samples = (SAMPLES_PER_HARMONIC * harmonics).max(64);
        let balance = Balance::new(system, harmonics, samples);
        let matrix = Factorization::new(balance.unknowns());
        Self { system, balance, matrix }
    }

    /// The responses to `drives`, each found from the one before; `None` where there is none.
    pub fn sweep(&mut self, drives: &[Drive]) -> Vec<Option<SineResponse>> {
        let mut last: Option<(Drive, Vec<f64>)> = None;
        let mut found = Vec::with_capacity(drives.len());
        for &drive in drives {
            let from = last.take().and_then(|(before, x)| self.follow(before, &x, drive));
            let x = from.or_else(|| self.ramp(drive));
            found.push(x.as_ref().map(|x| self.response(x, drive)));
            last = x.map(|x| (drive, x));
        }
        found
    }

    /// Derivatives of the displacement of a response to `drive` with respect to parameters, each given
    /// by systems and drives at four values of it with spacing `step`, two below and two above, and
    /// the formula's weights: `sum_k weights[k] f(values[k]) / step`. `None` at a fold.
    pub fn derivatives(
        &mut self,
        drive: Drive,
        response: &SineResponse,
        variations: &[SineVariation<'_>],
    ) -> Option<Vec<Complex64>> {
        let (n, harmonics) = (self.balance.unknowns(), self.balance.fourier().harmonics());
        let at = conditions(drive);
        self.balance.evaluate(&response.closures, &at).ok()?;
        self.balance.d_residual_d_closures(n, self.matrix.matrix());
        if !self.matrix.factorize() {
            return None;
        }
        let (mut real, mut imaginary) = (vec![0.0; n], vec![0.0; n]);
        self.balance.d_displacement_d_closures(&mut real, &mut imaginary);
        let mut residual = vec![0.0; n];
        let mut all = Vec::with_capacity(variations.len());
        for variation in variations {
            let mut d_residual = vec![0.0; n];
            let mut d_displacement = Complex64::ZERO;
            for ((system, drive), weight) in variation.points.iter().zip(variation.weights) {
                let mut other = SteppedSineSolver::new(system, harmonics);
                let at = conditions(*drive);
                other.balance.evaluate(&response.closures, &at).ok()?;
                other.balance.residual(&response.closures, &at, &mut residual);
                let factor = weight / variation.step;
                for (sum, r) in d_residual.iter_mut().zip(&residual) {
                    *sum += factor * r;
                }
                d_displacement += factor * other.balance.load_displacement(1, &at);
            }
            self.matrix.solve(&mut d_residual);
            let along = |row: &[f64]| row.iter().zip(&d_residual).map(|(a, x)| a * x).sum::<f64>();
            all.push(d_displacement - Complex64::new(along(&real), along(&imaginary)));
        }
        Some(all)
    }

    /// The response to `to` from that to `from`, by the whole way or parts of it.
    fn follow(&mut self, from: Drive, start: &[f64], to: Drive) -> Option<Vec<f64>> {
        let (mut reached, mut part) = (0.0, 1.0_f64);
        let mut x = start.to_vec();
        while reached < 1.0 {
            let next = (reached + part).min(1.0);
            let between = |a: f64, b: f64| a + next * (b - a);
            let drive = Drive {
                frequency_hz: between(from.frequency_hz, to.frequency_hz),
                force: between(from.force, to.force),
            };
            match self.newton(&x, drive) {
                Some(found) => (x, reached) = (found, next),
                None if part > SHORTEST => part *= 0.5,
                None => return None,
            }
        }
        Some(x)
    }

    /// The response to `drive` from that of the linearised system to a small force.
    fn ramp(&mut self, drive: Drive) -> Option<Vec<f64>> {
        let linear = LinearSolver::new(self.system).at(TAU * drive.frequency_hz)?;
        let force = FIRST_FORCE * drive.force;
        let terms = self.balance.fourier().terms();
        let mut x = vec![0.0; self.balance.unknowns()];
        for (series, three) in x.chunks_exact_mut(terms).zip(linear.closures.chunks_exact(3)) {
            for (to, value) in series.iter_mut().zip(three) {
                *to = force * value;
            }
        }
        let first = Drive { force, ..drive };
        let x = self.newton(&x, first)?;
        self.follow(first, &x, drive)
    }

    /// Newton's method at one drive.
    fn newton(&mut self, start: &[f64], drive: Drive) -> Option<Vec<f64>> {
        let n = self.balance.unknowns();
        let at = conditions(drive);
        let mut x = start.to_vec();
        let mut step = vec![0.0; n];
        for _ in 0..MOST_ITERATIONS {
            self.balance.evaluate(&x, &at).ok()?;
            self.balance.residual(&x, &at, &mut step);
            self.balance.d_residual_d_closures(n, self.matrix.matrix());
            if !self.matrix.factorize() {
                return None;
            }
            self.matrix.solve(&mut step);
            x.iter_mut().zip(&step).for_each(|(x, step)| *x -= step);
            let largest = |list: &[f64]| list.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            if !largest(&x).is_finite() {
                return None;
            }
            if largest(&step) <= TOLERANCE * largest(&x) {
                self.balance.evaluate(&x, &at).ok()?;
                return Some(x);
            }
        }
        None
    }

    /// The response whose balance was evaluated last.
    fn response(&self, x: &[f64], drive: Drive) -> SineResponse {
        let range = |i: usize| {
            let samples = self.balance.closures(i).iter().copied();
            let lowest = samples.clone().fold(f64::INFINITY, f64::min);
            [lowest, samples.fold(f64::NEG_INFINITY, f64::max)]
        };
        SineResponse {
            displacement: self.balance.load_displacement(1, &conditions(drive)),
            sensors: self.balance.motions(x, &conditions(drive)).split_off(1),
            closures: x.to_vec(),
            closure_range: (0..self.system.contacts().len()).map(range).collect(),
            truncation: self.balance.truncation(x),
        }
    }
}

/// Systems and drives at some values of a parameter, with the weights of a difference formula.
#[derive(Debug)]
pub struct SineVariation<'a> {
    /// At each value.
    pub points: Vec<(&'a ContactSystem, Drive)>,
    /// The weight of each in the formula.
    pub weights: &'a [f64],
    /// Spacing of the values.
    pub step: f64,
}

fn conditions(drive: Drive) -> Conditions {
    Conditions {
        angular_frequency: TAU * drive.frequency_hz,
        anti_damping: 0.0,
        force: drive.force,
    }
}
