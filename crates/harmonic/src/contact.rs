//! One contact: its law about the static state.

use std::sync::Arc;

use asperity_law::{CompiledLaw, ContactLaw};

use crate::HarmonicError;
use crate::error::{not_negative, positive};

/// How the law is evaluated at the samples of a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Evaluation {
    /// By the law itself.
    Exact,
    /// By a table of cubics with this error, relative to the static pressure, and by the law
    /// itself outside the table. Several times faster; amplitudes are off by about the tolerance.
    Tabulated(f64),
}

impl Default for Evaluation {
    /// A table to 1e-8 of the static pressure.
    fn default() -> Self {
        Self::Tabulated(1e-8)
    }
}

/// Static pressures that the table reaches up to.
const TABLE_TOP: f64 = 12.0;

/// A contact of a structure: area, law, and the static pressure it vibrates about.
#[derive(Debug, Clone)]
pub struct Contact {
    name: String,
    area: f64,
    pressure: f64,
    law: Arc<dyn ContactLaw>,
    table: Option<CompiledLaw>,
}

impl Contact {
    /// A contact of `area` S \[m2\] with `law` at static `pressure` p0 \[Pa\].
    ///
    /// # Errors
    /// [`HarmonicError::Setting`] for an area, pressure or tolerance out of range;
    /// [`HarmonicError::NoStiffness`] if the law has no positive finite stiffness at rest;
    /// [`HarmonicError::Law`] if it cannot be tabulated to the tolerance.
    pub fn new(
        name: &str,
        area: f64,
        pressure: f64,
        law: Arc<dyn ContactLaw>,
        evaluation: Evaluation,
    ) -> Result<Self, HarmonicError> {
        positive("contact area [m2]", area)?;
        not_negative("static pressure [Pa]", pressure)?;
        let stiffness = law.stiffness(pressure);
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(HarmonicError::NoStiffness {
                interface: name.to_owned(),
                pressure_pa: pressure,
                stiffness_pa_per_m: stiffness,
            });
        }
        let table = match evaluation {
            Evaluation::Tabulated(tolerance) if pressure > 0.0 => Some(
                CompiledLaw::new(&law, pressure, TABLE_TOP * pressure, tolerance)
                    .map_err(|source| HarmonicError::Law { interface: name.to_owned(), source })?,
            ),
            Evaluation::Exact | Evaluation::Tabulated(_) => None,
        };
        Ok(Self { name: name.to_owned(), area, pressure, law, table })
    }

    /// Name, for messages and outputs.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Nominal contact area S \[m2\].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Static pressure p0 \[Pa\].
    pub fn pressure(&self) -> f64 {
        self.pressure
    }

    /// The law.
    pub fn law(&self) -> &Arc<dyn ContactLaw> {
        &self.law
    }

    /// Contact stiffness at rest, `S K(p0)` \[N/m\].
    pub fn stiffness(&self) -> f64 {
        self.area * self.law.stiffness(self.pressure)
    }

    /// Force increments `S (p - p0)` \[N\] and tangents `S K` \[N/m\] at closure increments from rest
    /// \[m\]; all three slices have one length.
    pub(crate) fn forces(&self, closures: &[f64], forces: &mut [f64], tangents: &mut [f64]) {
        let places = closures.iter().zip(forces.iter_mut().zip(tangents.iter_mut()));
        if let Some(table) = &self.table {
            for (&x, (force, tangent)) in places {
                let (value, slope) = table.get_with_tangent(x);
                if value.is_nan() {
                    let exact = self.law.pressure_increment(self.pressure, x);
                    *force = self.area * exact.value;
                    *tangent = self.area * exact.tangent;
                } else {
                    *force = self.area * value;
                    *tangent = self.area * slope;
                }
            }
        } else {
            for (&x, (force, tangent)) in places {
                let exact = self.law.pressure_increment(self.pressure, x);
                *force = self.area * exact.value;
                *tangent = self.area * exact.tangent;
            }
        }
    }

    /// Pressure \[Pa\] at a closure increment from rest \[m\], by the law itself.
    pub fn pressure_at(&self, closure: f64) -> f64 {
        self.pressure + self.law.pressure_increment(self.pressure, closure).value
    }
}
