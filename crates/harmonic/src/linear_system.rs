//! What harmonic balance needs to know of the linear structure.

use std::fmt::Debug;

use faer::c64;

use crate::{HarmonicError, ModalSystem};

/// A receptance \[m/N\] and its derivatives.
///
/// Time goes as `exp(i w t)`, so that a damped structure lags: imaginary parts of direct
/// receptances are negative.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Receptance {
    /// Complex displacement per complex force \[m/N\].
    pub value: c64,
    /// Derivative by angular frequency \[m s/(N rad)\].
    pub by_frequency: c64,
    /// Derivative by the anti-damping rate \[m s/N\].
    pub by_rate: c64,
}

/// The compliance of a structure at its contact faces and its driving point, at one frequency.
///
/// With contact forces P (pressing, one per interface), the drive F and the closures x,
///
/// ```text
/// x = drive F - contact P,    u = direct F - drive^T P,
/// ```
///
/// u being the displacement of the driving point. The second line holds by reciprocity: what the
/// drive does to a closure, that contact's force does, reversed, to the driving point.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    interfaces: usize,
    contact: Vec<Receptance>,
    drive: Vec<Receptance>,
    /// Displacement of the driving point per drive force \[m/N\].
    pub direct: Receptance,
}

impl Compliance {
    /// A compliance of zero, for a structure with `interfaces` interfaces.
    pub fn zero(interfaces: usize) -> Self {
        Self {
            interfaces,
            contact: vec![Receptance::default(); interfaces * interfaces],
            drive: vec![Receptance::default(); interfaces],
            direct: Receptance::default(),
        }
    }

    /// Number of interfaces.
    pub fn interfaces(&self) -> usize {
        self.interfaces
    }

    /// Loss of closure at interface `row` per contact force at interface `column` \[m/N\].
    pub fn contact(&self, row: usize, column: usize) -> &Receptance {
        &self.contact[row * self.interfaces + column]
    }

    /// The same, to be written.
    pub fn contact_mut(&mut self, row: usize, column: usize) -> &mut Receptance {
        &mut self.contact[row * self.interfaces + column]
    }

    /// Closure at `interface` per drive force \[m/N\].
    pub fn drive(&self, interface: usize) -> &Receptance {
        &self.drive[interface]
    }

    /// The same, to be written.
    pub fn drive_mut(&mut self, interface: usize) -> &mut Receptance {
        &mut self.drive[interface]
    }

    /// Sets every receptance to zero.
    pub fn clear(&mut self) {
        self.contact.fill(Receptance::default());
        self.drive.fill(Receptance::default());
        self.direct = Receptance::default();
    }
}

/// What the mean closures X0 and mean contact force increments P0 of a periodic motion obey.
///
/// At zero frequency the compliance of bodies that only contacts hold is infinite, so the balance
/// is written `closure X0 + force P0 = 0`, square matrices stored by rows. For a stack, which is
/// statically determinate, it is `P0 = 0`: the mean pressures are the static ones, however far
/// the mean closures shift. The mean displacement of the driving point is
/// `output_closure . X0 + output_force . P0`.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanBalance {
    /// Factors of the mean closures \[-\], by rows.
    pub closure: Vec<f64>,
    /// Factors of the mean force increments \[m/N\], by rows, or without unit in rows that have no
    /// closure.
    pub force: Vec<f64>,
    /// Mean displacement of the driving point per mean closure \[-\].
    pub output_closure: Vec<f64>,
    /// Mean displacement of the driving point per mean force increment \[m/N\].
    pub output_force: Vec<f64>,
}

impl MeanBalance {
    /// The balance of a chain of bodies that rest one on another: `P0 = 0`, and the top moves by
    /// the sum of the closures.
    pub fn determinate(interfaces: usize) -> Self {
        let mut force = vec![0.0; interfaces * interfaces];
        for i in 0..interfaces {
            force[i * interfaces + i] = 1.0;
        }
        Self {
            closure: vec![0.0; interfaces * interfaces],
            force,
            output_closure: vec![1.0; interfaces],
            output_force: vec![0.0; interfaces],
        }
    }
}

/// A linear structure between a driving point and contact faces.
///
/// The anti-damping rate `xi` \[1/s\] adds the force `+ xi M u'` to all masses of the structure: it
/// is what keeps a damped nonlinear mode in periodic motion (extended periodic motion concept),
/// and zero elsewhere.
pub trait LinearSystem: Debug + Send + Sync {
    /// Number of interfaces.
    fn interfaces(&self) -> usize;

    /// Writes the compliance at a positive `angular_frequency` \[rad/s\] and an anti-damping rate
    /// \[1/s\].
    fn compliance(&self, angular_frequency: f64, anti_damping: f64, into: &mut Compliance);

    /// Whether the structure can be balanced at all; what needs no check passes.
    ///
    /// # Errors
    /// [`HarmonicError`] for numbers out of range or rigid motions that no contact holds.
    fn check(&self) -> Result<(), HarmonicError> {
        Ok(())
    }

    /// The balance of means.
    fn mean_balance(&self) -> MeanBalance;

    /// The structure in modes, the `count` lowest and the static flexibility of the others: what
    /// stability is judged on.
    fn modal(&self, count: usize) -> ModalSystem;
}
