//! Contact laws: pressure, stiffness and closure of rough interfaces.
//!
//! Two rough faces pressed together approach each other by a closure `d` as the contact pressure
//! `p` rises. A law gives the contact stiffness per area as a function of pressure,
//!
//! ```text
//! K(p) = dp/dd,
//! ```
//!
//! and the rest follows: the closure `d(p)`, its inverse `p(d)` with tangent, and the stored energy
//! `integral of p dd`. The trait [`ContactLaw`] derives all of it from K by quadrature and a
//! bracketed root; the laws here override that with closed forms.
//!
//! | law | K(p) | contact lost | rigid at a finite closure |
//! |---|---|---|---|
//! | [`Constant`] | K0 | never, or at zero closure | no |
//! | [`Power`] | C p^m | m < 1 | m > 1 |
//! | [`ModifiedPower`] | C p^m, softened at low pressure | at zero closure | m > 1 |
//! | [`Exponential`] | p / u0 | never | no |
//! | [`Hyperbolic`] | K0 (1 + p / (K0 dm))^2 | at zero closure | yes |
//! | [`Table`] | through measured points | at zero closure | no |
//! | [`InSeries`] | 1 / (1/K + 1/`K_layer`) | as its law | no |
//!
//! [`Compiled`] turns any of them into a table about a state for time stepping, with an error
//! bound, and [`fit_power`] finds a power law in data. [`quadrature`] serves authors of new laws.
//!
//! # Conventions
//! SI units in plain `f64`. Pressure is positive in compression, closure when the faces approach.
//! At a kink every one-sided value is that of the higher pressure. Increments
//! ([`ContactLaw::closure_increment`], [`ContactLaw::pressure_increment`]) keep their relative
//! precision however small they are; differences of absolute values do not.
//!
//! # Example
//! ```
//! use asperity_law::{ContactLaw, LawError, Power};
//!
//! let law = Power::new(1.81e10, 0.35, 0.0)?;
//! let p = law.pressure(law.closure(1.4e5));
//! assert!((p.value / 1.4e5 - 1.0).abs() < 1e-14);
//! assert!((p.tangent / law.stiffness(1.4e5) - 1.0).abs() < 1e-14);
//! assert_eq!(law.pressure(-1e-9).value, 0.0); // contact lost
//! # Ok::<(), LawError>(())
//! ```

mod cell;
mod compiled;
mod constant;
mod domain;
mod error;
mod exponential;
mod fit;
mod hyperbolic;
mod in_series;
mod inverse;
mod law;
mod modified_power;
mod pchip;
mod power;
pub mod quadrature;
mod spliced;
mod table;

pub use cell::Cell;
pub use compiled::{CellScale, Compiled};
pub use constant::Constant;
pub use domain::Domain;
pub use error::{LawError, Quantity};
pub use exponential::Exponential;
pub use fit::{PowerFit, PowerFitErrors, fit_power};
pub use hyperbolic::Hyperbolic;
pub use in_series::InSeries;
pub use law::{ContactLaw, Pressure};
pub use modified_power::ModifiedPower;
pub use power::Power;
pub use table::Table;
