//! Contact laws: pressure, stiffness and closure of rough interfaces.
//!
//! Two rough faces pressed together approach each other by a closure `d` as the contact pressure
//! `p` rises. A law gives the contact stiffness per area as a function of pressure,
//!
//! ```text
//! K(p) = dp/dd,
//! ```
//!
//! from which the closure `d(p)`, its inverse `p(d)` with the tangent, and the stored energy
//! `integral of p dd` follow. The trait [`ContactLaw`] derives them from K by quadrature and a
//! bracketed root; the laws of this crate override that with closed forms.
//!
//! | law | K(p) | contact lost | rigid at a finite closure |
//! |---|---|---|---|
//! | [`Constant`] | K0 | never, or at zero closure | no |
//! | [`Power`] | C p^m | m < 1 | m > 1 |
//! | [`ModifiedPower`] | C p^m, softened at low pressure | at zero closure | m > 1 |
//! | [`Exponential`] | p / u0 | never | no |
//! | [`Hyperbolic`] | K0 (1 + p / (K0 dm))^2 | at zero closure | yes |
//! | [`GreenwoodWilliamson`] | Hertzian summits of random heights | never | no |
//! | [`Persson`] | p / g(p) of a self-affine surface | never | yes |
//! | [`Tabulated`] | through measured points | at zero closure | no |
//! | [`InSeries`] | 1 / (1/K + 1/`K_layer`) | as its law | no |
//! | [`LawsInSeries`] | 1 / (sum of 1/K at each law's own pressure + c) | as the law lost first | if all laws are and c = 0 |
//!
//! [`CompiledLaw`] tabulates a law about a state for time stepping, [`RelativeTable`] next to its loss of contact, [`fit_power`] fits a power
//! law to data, and [`stiffness_from_gaps`] derives points of a [`Tabulated`] law from pressures
//! against gaps. [`ContactDamping`] adds viscous traction to a law, and [`Friction`]
//! is a Jenkins element beside it. [`OverclosureTable`] is a law as straight segments for
//! finite-element codes.
//! [`quadrature`] holds the integrals that the trait's defaults use.
//!
//! # Conventions
//! SI units in plain `f64`. Pressure is positive in compression, closure when the faces approach.
//! At a kink every one-sided value is that of the higher pressure. Increments
//! ([`ContactLaw::closure_increment`], [`ContactLaw::pressure_increment`]) keep their relative
//! precision however small they are; differences of absolute values do not.
//!
//! # Example
//! The closure of a measured contact under 0.4 MPa:
//! ```
//! use asperity_law::{ContactLaw, LawError, Tabulated};
//!
//! let law = Tabulated::new(&[(0.14e6, 1.15e12), (0.35e6, 1.75e12), (0.57e6, 1.63e12)])?;
//! let closure = law.closure(0.4e6);
//! assert!((closure - 2.89e-7).abs() < 1e-9);
//! assert!((law.pressure(closure).value / 0.4e6 - 1.0).abs() < 1e-14);
//! assert_eq!(law.pressure(-1e-9).value, 0.0); // contact lost
//! # Ok::<(), LawError>(())
//! ```

mod compiled_law;
mod constant;
mod contact_damping;
mod contact_law;
mod domain;
mod draw;
mod error;
mod exponential;
mod friction;
mod gap_table;
mod greenwood_williamson;
mod hyperbolic;
mod in_series;
mod law_form;
mod law_spec;
mod laws;
mod laws_in_series;
mod modified_power;
mod overclosure;
mod pchip;
mod persson;
mod power;
mod power_fit;
mod relative_table;
mod spliced;
mod tabulated;

pub use compiled_law::{CellScale, CompiledLaw, CubicCell};
pub use constant::{Constant, ConstantSpec};
pub use contact_damping::{ContactDamping, ContactDampingSpec};
pub use contact_law::{ContactLaw, Pressure, quadrature};
pub use domain::Domain;
pub use draw::{Draw, rounded};
pub use error::{LawError, LawQuantity};
pub use exponential::{Exponential, ExponentialSpec};
pub use friction::{Friction, FrictionSpec, Slip};
pub use gap_table::stiffness_from_gaps;
pub use greenwood_williamson::{GreenwoodWilliamson, GreenwoodWilliamsonSpec};
pub use hyperbolic::{Hyperbolic, HyperbolicSpec};
pub use in_series::{InSeries, InSeriesSpec};
pub use law_form::{LawFault, LawForm};
pub use law_spec::{LawRef, LawSpec, Sampler};
pub use laws::{Laws, MAX_SERIES_DEPTH, MAX_SERIES_LAWS};
pub use laws_in_series::{LawsInSeries, SeriesContact};
pub use modified_power::{ModifiedPower, ModifiedPowerSpec};
pub use overclosure::{BeyondTable, OverclosureRow, OverclosureTable, TableAccuracy};
pub use persson::{Persson, PerssonSpec};
pub use power::{Power, PowerSpec};
pub use power_fit::{PowerFit, PowerFitErrors, fit_power};
pub use relative_table::RelativeTable;
pub use tabulated::{TableSpec, Tabulated};
