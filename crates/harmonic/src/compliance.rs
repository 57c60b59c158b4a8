//! Compliance of a linear structure at its contact faces and its driving point.

use num_complex::Complex64;

/// A receptance \[m/N\] and its derivatives.
///
/// Time goes as `exp(i w t)`, so that a damped structure lags: imaginary parts of direct
/// receptances are negative.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Receptance {
    /// Complex displacement per complex force \[m/N\].
    pub value: Complex64,
    /// Derivative with respect to the angular frequency \[m s/(N rad)\].
    pub d_frequency: Complex64,
    /// Derivative with respect to the anti-damping rate \[m s/N\].
    pub d_anti_damping: Complex64,
}

impl Receptance {
    /// Adds `factor` times `other`, derivatives included.
    pub(crate) fn add(&mut self, other: &Self, factor: f64) {
        self.value += other.value * factor;
        self.d_frequency += other.d_frequency * factor;
        self.d_anti_damping += other.d_anti_damping * factor;
    }
}

/// Receptances at all contact faces and the driving point of a structure, at one frequency.
///
/// With contact forces P (pressing, one per interface), the drive F and the closures x,
///
/// ```text
/// x = drive F - contact P,    u = direct F - drive^T P,
/// ```
///
/// u being the displacement of the driving point; the second line holds by reciprocity.
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

    /// Mutable access to [`contact`](Self::contact).
    pub fn contact_mut(&mut self, row: usize, column: usize) -> &mut Receptance {
        &mut self.contact[row * self.interfaces + column]
    }

    /// Closure at `interface` per drive force \[m/N\].
    pub fn drive(&self, interface: usize) -> &Receptance {
        &self.drive[interface]
    }

    /// Mutable access to [`drive`](Self::drive).
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

/// Balance of the mean closures X0 and mean contact force increments P0 of a periodic motion.
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
