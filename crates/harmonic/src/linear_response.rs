//! The response of the linearised structure: start and scale of branches.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::ContactSystem;
use crate::balance::{Balance, Conditions};
use crate::factorization::dot;
use crate::linearisation::{Border, Linearisation};

/// The response with every contact at its static stiffness: closures' series (mean, cosine, sine
/// per interface) and complex displacement of the load's port, per unit load.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LinearResponse {
    pub(crate) closures: Vec<f64>,
    pub(crate) displacement: Complex64,
}

/// Contacts from which on matrices of them are not formed, where there is another way.
const MOST_DIRECT: usize = 12;

/// Samples of a period: the tangents at rest do not vary.
const SAMPLES: usize = 8;

/// Relative accuracy of a solution by iteration.
const ACCURACY: f64 = 1e-12;

/// Solves for linear responses; keeps its memory from frequency to frequency.
#[derive(Debug)]
pub(crate) struct LinearSolver<'a> {
    balance: Balance<'a>,
    linearisation: Linearisation,
    gradient: [Vec<f64>; 2],
}

impl<'a> LinearSolver<'a> {
    pub(crate) fn new(system: &'a ContactSystem) -> Self {
        let many = system.pairs() > MOST_DIRECT;
        let many = many.then(|| Balance::of_many(system, (1, SAMPLES), 1.0)).flatten();
        let balance = many.unwrap_or_else(|| Balance::new(system, 1, SAMPLES));
        let linearisation = Linearisation::new(&balance, balance.unknowns());
        let n = balance.unknowns();
        Self { balance, linearisation, gradient: [vec![0.0; n], vec![0.0; n]] }
    }

    /// The response at an angular frequency [rad/s]; `None` where it is not finite.
    pub(crate) fn at(&mut self, angular_frequency: f64) -> Option<LinearResponse> {
        let n = self.balance.unknowns();
        let at = Conditions { angular_frequency, anti_damping: 0.0, force: 1.0 };
        let mut closures = vec![0.0; n];
        self.balance.evaluate(&closures, &at).ok()?;
        self.balance.d_residual_d_force(&mut closures);
        for x in &mut closures {
            *x = -*x;
        }
        let Self { balance, linearisation, gradient } = self;
        let solved = linearisation.take(balance, Border::default(), &[])
            && linearisation.solve(balance, &mut closures, ACCURACY);
        if !solved {
            return None;
        }
        let [real, imaginary] = gradient;
        balance.d_displacement_d_closures(real, imaginary);
        let [_, _, direct] = balance.d_displacement_d_conditions(&at);
        let displacement = direct + Complex64::new(dot(real, &closures), dot(imaginary, &closures));
        let response = LinearResponse { closures, displacement };
        response.size().is_finite().then_some(response)
    }
}

impl LinearResponse {
    /// Euclidean size of the closures [m/N].
    pub(crate) fn size(&self) -> f64 {
        self.closures.iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// The receptance u/f \[m/N\] of the load's port, linearised about rest, at `frequency` \[Hz\]: the
/// limit of the harmonic balance for small forces. NaN where it is infinite.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_harmonic::{ContactSystem, LawEvaluation, RigidMass, linear_receptance};
/// use asperity_law::Constant;
/// use asperity_structure::PreloadedContact;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let spring = PreloadedContact::new("spring", 1e-4, Arc::new(Constant::new(8e11)?), 1e5)?;
/// let mass = Arc::new(RigidMass::new(1.6, 0.0)?);
/// let system = ContactSystem::new(mass, vec![spring], LawEvaluation::Exact)?;
/// let slow = linear_receptance(&system, 1.0);
/// assert!((slow.re * 8e7 - 1.0).abs() < 1e-5);
/// # Ok(())
/// # }
/// ```
pub fn linear_receptance(system: &ContactSystem, frequency: f64) -> Complex64 {
    LinearSolver::new(system)
        .at(TAU * frequency)
        .map_or(Complex64::new(f64::NAN, f64::NAN), |response| response.displacement)
}

/// Angular frequency \[rad/s\] of the linearised resonance nearest to `near` \[rad/s\], within a
/// factor of two: the largest response of the load's port, by a scan and golden sections.
pub(crate) fn resonance_near(system: &ContactSystem, near: f64) -> f64 {
    const SCAN: i32 = 400;
    let mut solver = LinearSolver::new(system);
    let mut size = |w: f64| solver.at(w).map_or(f64::INFINITY, |found| found.displacement.norm());
    let place = |i: i32| near * 2.0_f64.powf(f64::from(i) / f64::from(SCAN));
    let sizes: Vec<f64> = (-SCAN..=SCAN).map(|i| size(place(i))).collect();
    // The local maximum next to `near`, if there is any.
    let peak = (1 - SCAN..SCAN)
        .zip(sizes.windows(3))
        .filter(|(_, s)| s[1] >= s[0] && s[1] >= s[2])
        .map(|(i, _)| i)
        .min_by_key(|i| i.abs())
        .unwrap_or(0);
    let (mut low, mut high) = (place(peak - 1), place(peak + 1));
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if size(a) < size(b) { low = a } else { high = b }
    }
    0.5 * (low + high)
}
