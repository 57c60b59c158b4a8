//! Linearised natural frequencies and shapes, exact for elastic bars.

use std::f64::consts::{PI, TAU};

use asperity_mesh::{BarStiffness, Body, Port, Stack, Support};
use faer::{Mat, Side};

use crate::contact::check_springs;
use crate::{PreloadedContact, StructureError};

/// One undamped mode of the rig linearised about static equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearisedMode {
    /// Natural frequency \[Hz\].
    pub frequency_hz: f64,
    /// Damping ratio under mass-proportional damping, the internal damping of bodies, the contacts'
    /// dampers `c(p0) S` and that of the support, `phi^T C phi / (2 w phi^T M phi)`. Kelvin-Voigt
    /// contacts and bodies add `beta w / 2` times their share of the strain energy, bodies with a loss
    /// factor `eta / 2` times it. Of first order in the damping: damping that couples the modes
    /// changes their ratios by its square.
    pub damping_ratio: f64,
    /// Modal mass `phi^T M phi` of the shape given \[kg\].
    pub modal_mass_kg: f64,
    /// Displacement of the upper and lower face of each body, the largest of
    /// all faces and the support being 1.
    pub faces: Vec<(f64, f64)>,
    /// Displacement of the support; zero if it is rigid.
    pub support: f64,
}

impl LinearisedMode {
    /// Displacement of body `index` at `fraction` of its length from the top.
    pub fn displacement(&self, body: &Body, index: usize, fraction: f64) -> f64 {
        let w = TAU * self.frequency_hz;
        BarStiffness::displacement(body, w, self.faces[index], fraction)
    }

    /// Mass-normalised participation of a port of `stack`, whose mode it is \[kg^-1/2\].
    pub fn participation(&self, stack: &Stack, port: Port) -> f64 {
        let (bodies, w) = (stack.bodies(), TAU * self.frequency_hz);
        let mean =
            |body: usize| BarStiffness::mean_displacement(&bodies[body], w, self.faces[body]);
        let displacement = match port {
            Port::Point { body, position } => {
                self.displacement(&bodies[body], body, position / bodies[body].length())
            }
            Port::Mean { body } => mean(body),
            Port::Base => {
                let moment = |(i, body): (usize, &Body)| body.mass() * mean(i);
                let carried = match *stack.support() {
                    Support::SpringMass { mass, .. } => mass * self.support,
                    Support::Rigid => 0.0,
                };
                -bodies.iter().enumerate().map(moment).sum::<f64>() - carried
            }
            _ => self.support,
        };
        displacement / self.modal_mass_kg.sqrt()
    }
}

/// Bars joined by contact springs. The unknowns are the displacements of all
/// faces from the top down, then the support's if it moves.
pub(crate) struct Chain<'a> {
    stack: &'a Stack,
    contacts: &'a [PreloadedContact],
}

impl<'a> Chain<'a> {
    pub(crate) fn new(
        stack: &'a Stack,
        contacts: &'a [PreloadedContact],
    ) -> Result<Self, StructureError> {
        check_springs(contacts)?;
        Ok(Self { stack, contacts })
    }

    /// Diagonal and off-diagonal of the dynamic stiffness at `w`, and the
    /// number of clamped-bar frequencies below `w`.
    fn dynamic_stiffness(&self, w: f64) -> (Vec<f64>, Vec<f64>, usize) {
        let bodies = self.stack.bodies();
        let mut diagonal = vec![0.0; 2 * bodies.len() + 1];
        let mut off_diagonal = vec![0.0; 2 * bodies.len()];
        let mut clamped = 0;
        for (i, (body, contact)) in bodies.iter().zip(self.contacts).enumerate() {
            let contact = contact.spring();
            let bar = BarStiffness::at(body, w);
            clamped += bar.clamped_modes_below;
            diagonal[2 * i] += bar.direct;
            diagonal[2 * i + 1] += bar.direct + contact;
            diagonal[2 * i + 2] += contact;
            off_diagonal[2 * i] = bar.cross;
            off_diagonal[2 * i + 1] = -contact;
        }
        match *self.stack.support() {
            Support::Rigid => {
                diagonal.pop();
                off_diagonal.pop();
            }
            Support::SpringMass { stiffness, mass, .. } => {
                diagonal[2 * bodies.len()] += stiffness - w * w * mass;
            }
        }
        (diagonal, off_diagonal, clamped)
    }

    /// Number of natural frequencies below `w` (Wittrick-Williams): clamped
    /// modes plus negative pivots of the dynamic stiffness.
    fn modes_below(&self, w: f64) -> usize {
        let (diagonal, off_diagonal, clamped) = self.dynamic_stiffness(w);
        let mut pivot = diagonal[0];
        let mut negative = usize::from(pivot < 0.0);
        for (d, e) in diagonal[1..].iter().zip(&off_diagonal) {
            pivot = d - e * e / pivot;
            negative += usize::from(pivot < 0.0);
        }
        clamped + negative
    }

    /// Angular frequency of mode `number`, counted from 1, by bisection to round-off.
    pub(crate) fn frequency(&self, number: usize) -> Result<f64, StructureError> {
        let slowest = |body: &Body| PI * body.wave_speed() / body.length();
        // Off the clamped frequencies themselves, where the dynamic stiffness is infinite.
        let start = std::f64::consts::LN_2;
        let mut high =
            start * self.stack.bodies().iter().map(slowest).fold(f64::INFINITY, f64::min);
        while self.modes_below(high) < number {
            high *= 2.0;
            if !(high > 0.0 && high.is_finite()) {
                let quantity = "natural frequency [rad/s]";
                let accepted = "positive and finite";
                return Err(StructureError::Setting { quantity, value: high, accepted });
            }
        }
        let mut low = 0.0;
        // 1100 halvings reach the smallest double from any start.
        for _ in 0..1100 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.modes_below(middle) >= number { high = middle } else { low = middle }
        }
        Ok(high)
    }

    /// Face displacements at a natural frequency: the eigenvector of the
    /// dynamic stiffness whose eigenvalue is nearest to zero.
    fn shape(&self, w: f64) -> Result<Vec<f64>, StructureError> {
        let (diagonal, off_diagonal, _) = self.dynamic_stiffness(w);
        let size = diagonal.len();
        let matrix = Mat::from_fn(size, size, |row, column| match row.abs_diff(column) {
            0 => diagonal[row],
            1 => off_diagonal[row.min(column)],
            _ => 0.0,
        });
        let eigen = matrix
            .self_adjoint_eigen(Side::Lower)
            .map_err(|_| StructureError::Eigenvalues { size })?;
        let values = eigen.S().column_vector();
        let nearest = (0..size)
            .min_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()))
            .unwrap_or_default();
        let vector: Vec<f64> = (0..size).map(|row| eigen.U()[(row, nearest)]).collect();
        let largest =
            vector.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(1.0);
        Ok(vector.iter().map(|value| value / largest).collect())
    }

    /// The mode at the angular frequency `w`, with the mass-proportional damping `rate` \[1/s\].
    pub(crate) fn mode(&self, w: f64, rate: f64) -> Result<LinearisedMode, StructureError> {
        let shape = self.shape(w)?;
        let bodies = self.stack.bodies();
        let faces: Vec<_> = (0..bodies.len()).map(|i| (shape[2 * i], shape[2 * i + 1])).collect();
        let body_mass: f64 =
            bodies.iter().zip(&faces).map(|(body, &ends)| modal_mass(body, w, ends)).sum();
        let (support, support_mass) = match *self.stack.support() {
            Support::Rigid => (0.0, 0.0),
            Support::SpringMass { mass, .. } => (shape[2 * bodies.len()], mass),
        };
        let dampers = self.contacts.iter().enumerate().map(|(i, contact)| {
            let below = shape.get(2 * i + 2).copied().unwrap_or(0.0);
            contact.damper() * (shape[2 * i + 1] - below).powi(2)
        });
        let internal: f64 = bodies
            .iter()
            .zip(&faces)
            .map(|(body, &ends)| body.damping().loss(w) / w * strain_stiffness(body, w, ends))
            .sum();
        let viscous = rate * body_mass
            + internal
            + self.stack.support().damping() * support * support
            + dampers.sum::<f64>();
        let total_mass = body_mass + support_mass * support * support;
        let (frequency_hz, damping_ratio) = (w / TAU, viscous / (2.0 * w * total_mass));
        if !(damping_ratio.is_finite() && shape.iter().all(|value| value.is_finite())) {
            return Err(StructureError::Shape { frequency_hz });
        }
        Ok(LinearisedMode {
            frequency_hz,
            damping_ratio,
            modal_mass_kg: total_mass,
            faces,
            support,
        })
    }
}

/// `integral of rho A u^2 dx` over a bar that vibrates at `w` with the end
/// displacements `(a, b)`, in closed form.
fn modal_mass(body: &Body, w: f64, (a, b): (f64, f64)) -> f64 {
    let th = w * body.length() / body.wave_speed();
    if th < 1e-2 {
        // The bar moves as a straight line, to th^2 / 10.
        return body.mass() * (a * a + a * b + b * b) / 3.0;
    }
    let sin = th.sin();
    let own = 0.5 - (2.0 * th).sin() / (4.0 * th);
    let mixed = sin / th - th.cos();
    body.mass() * ((a * a + b * b) * own + a * b * mixed) / (sin * sin)
}

/// `integral of E A u'^2 dx` over a bar that vibrates at `w` with the end displacements `(a, b)`, in
/// closed form: the sum of those of the motion symmetric about its middle and of the antisymmetric
/// one, neither of which cancels.
fn strain_stiffness(body: &Body, w: f64, (a, b): (f64, f64)) -> f64 {
    let th = w * body.length() / body.wave_speed();
    // 1 - sin(th) / th.
    let flat = if th < 1e-2 {
        th * th / 6.0 * (1.0 - th * th / 20.0 * (1.0 - th * th / 42.0))
    } else {
        1.0 - th.sin() / th
    };
    let (sin, cos) = (0.5 * th).sin_cos();
    let (mean, half) = (0.5 * (a + b), 0.5 * (b - a));
    let symmetric = flat * (mean * th / cos).powi(2);
    let antisymmetric = (2.0 - flat) * (half * th / sin).powi(2);
    0.5 * body.axial_rigidity() / body.length() * (symmetric + antisymmetric)
}
