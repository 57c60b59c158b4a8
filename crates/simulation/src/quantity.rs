//! The table of quantities: key, unit, label, accessor, error scale, derivative.
//!
//! Summaries, columns of `sweep.csv` and of studies, error estimates, derivatives, features of an
//! identification and axes of figures all read this table.

use asperity_dynamics::{ContactMeasures, EnergyLedger};

use crate::response_parts::{PeakValues, ResponseParts};
use crate::static_state::{StaticInterface, StaticSummary};

/// The error of the fundamental frequency is compared with this share of the frequency.
const FREQUENCY_SHARE: f64 = 0.1;

/// Second-harmonic over fundamental receptance below which the second harmonic is not resolved for
/// its own sake.
const SMALL_HARMONIC: f64 = 1e-2;

/// Damping ratio below which the damping is not resolved for its own sake.
const SMALL_DAMPING: f64 = 1e-2;

/// Departure of one extreme pressure from rest, over the range of pressures, below which it is not
/// resolved for its own sake; and stiffness over the stiffness at rest.
const SMALL_DEPARTURE: f64 = 0.1;

/// The part of a response that a quantity is read from, with the accessor. The part also says how the
/// quantity is differentiated.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Accessor {
    /// The state at rest, differentiated by central differences.
    AtRest(fn(&StaticSummary, Option<usize>) -> Option<f64>),
    /// The receptance peaks. The accessor of their derivatives is the same.
    Peaks(fn(&PeakValues) -> Option<f64>),
    /// The measures of a contact. The accessor of their derivatives is the same.
    Contact(fn(&ContactMeasures) -> f64),
    /// Any part, without a derivative.
    Parts(fn(&ResponseParts<'_>, Option<usize>) -> Option<f64>),
}

/// The number that the error of a quantity is compared with, in its unit, from its absolute value
/// and the other values of the response; none for a quantity that is exact, that is a setting, or
/// that measures errors itself.
type ErrorScale = fn(Option<f64>, &Values<'_>, Option<usize>) -> Option<f64>;

/// A line of the table.
struct Definition {
    key: &'static str,
    unit: &'static str,
    label: &'static str,
    accessor: Accessor,
    error_scale: ErrorScale,
}

/// Defines [`Quantity`] and the table, in the order of the columns of `sweep.csv`. In a key `*` stands
/// for the name of an interface.
macro_rules! quantities {
    ($(
        $(#[$doc:meta])*
        $name:ident: $key:expr, $unit:expr, $label:expr, $accessor:expr, $error_scale:expr;
    )*) => {
        /// A quantity of a whole structure, or of each of its interfaces.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Quantity {
            $($(#[$doc])* $name,)*
        }

        impl Quantity {
            /// All quantities, in the order of the columns of `sweep.csv`.
            pub const ALL: &[Self] = &[$(Self::$name,)*];
        }

        /// In the order of [`Quantity::ALL`].
        const TABLE: [Definition; Quantity::ALL.len()] = [$(Definition {
            key: $key,
            unit: $unit,
            label: $label,
            accessor: $accessor,
            error_scale: $error_scale,
        },)*];
    };
}

/// The accessor of a number of the energy balance.
macro_rules! energy {
    ($read:expr) => {
        Accessor::Parts(|parts, _| {
            let read: fn(&EnergyLedger) -> f64 = $read;
            parts.energy.as_ref().map(read)
        })
    };
}

quantities! {
    /// Lowest natural frequency of the structure linearised at rest.
    NaturalFrequency:
        "static.natural_frequency_hz", "Hz", "Natural frequency at rest",
        Accessor::AtRest(|at_rest, _| at_rest.natural_frequency_hz), exact;
    /// Static pressure of an interface.
    StaticPressure:
        "static.interfaces.*.pressure_pa", "Pa", "Static pressure",
        Accessor::AtRest(|at_rest, of| Some(contact_at_rest(at_rest, of)?.pressure_pa)), exact;
    /// Contact stiffness per area of an interface at rest.
    StaticStiffness:
        "static.interfaces.*.stiffness_pa_per_m", "Pa/m", "Static stiffness",
        Accessor::AtRest(|at_rest, of| Some(contact_at_rest(at_rest, of)?.stiffness_pa_per_m)), exact;
    /// Closure of an interface at rest, from the law's reference.
    StaticClosure:
        "static.interfaces.*.closure_m", "m", "Static closure",
        Accessor::AtRest(|at_rest, of| Some(contact_at_rest(at_rest, of)?.closure_m)), exact;
    /// Frequency f1 of the fundamental peak of the receptance.
    FundamentalFrequency:
        "fundamental.frequency_hz", "Hz", "Fundamental f_{1}",
        Accessor::Peaks(|peaks| Some(peaks.fundamental?.0)),
        |own, _, _| Some(FREQUENCY_SHARE * own.unwrap_or(1.0));
    /// Receptance A1 at the fundamental peak.
    FundamentalReceptance:
        "fundamental.receptance_m_per_n", "m/N", "Amplitude A_{1}",
        Accessor::Peaks(|peaks| Some(peaks.fundamental?.1)), |own, _, _| own;
    /// Half-power damping ratio of the fundamental.
    DampingRatio:
        "fundamental.damping_ratio", "", "Damping ratio",
        Accessor::Peaks(|peaks| peaks.damping_ratio), |own, _, _| Some(own?.max(SMALL_DAMPING));
    /// Damping ratio by the logarithmic decrement of the decay.
    DampingRatioDecrement:
        "fundamental.damping_ratio_decrement", "", "Damping ratio by decrement",
        Accessor::Parts(|parts, _| parts.peaks.damping_ratio_decrement),
        |own, _, _| Some(own?.max(SMALL_DAMPING));
    /// Frequency f2 of the second-harmonic peak of the receptance.
    SecondHarmonicFrequency:
        "second_harmonic.frequency_hz", "Hz", "Harmonic f_{2}",
        Accessor::Peaks(|peaks| Some(peaks.second?.0)),
        |own, all, _| own.filter(|_| all.size(Quantity::HarmonicRatio, None) >= Some(SMALL_HARMONIC));
    /// Receptance A2 at the second-harmonic peak.
    SecondHarmonicReceptance:
        "second_harmonic.receptance_m_per_n", "m/N", "Amplitude A_{2}",
        Accessor::Peaks(|peaks| Some(peaks.second?.1)),
        |own, all, _| {
            Some(own?.max(SMALL_HARMONIC * all.size(Quantity::FundamentalReceptance, None)?))
        };
    /// Ratio A2/A1 of the receptances at both peaks.
    HarmonicRatio:
        "harmonic_ratio", "", "Ratio A_{2}/A_{1}",
        Accessor::Peaks(|peaks| peaks.ratio), |own, _, _| Some(own?.max(SMALL_HARMONIC));
    /// Lowest pressure of an interface.
    PressureMin:
        "interfaces.*.pressure_min_pa", "Pa", "Lowest pressure",
        Accessor::Contact(|contact| contact.pressure_min),
        |_, all, of| departure(Quantity::PressureMin, all, of);
    /// Highest pressure of an interface.
    PressureMax:
        "interfaces.*.pressure_max_pa", "Pa", "Highest pressure",
        Accessor::Contact(|contact| contact.pressure_max),
        |_, all, of| departure(Quantity::PressureMax, all, of);
    /// Time average `K_avr` of an interface's stiffness, Eq. (8).
    StiffnessAverage:
        "interfaces.*.stiffness_average_pa_per_m", "Pa/m", "Average stiffness",
        Accessor::Contact(|contact| contact.stiffness_average), |own, _, _| own;
    /// Stiffness of an interface's law at the lowest pressure.
    StiffnessAtPressureMin:
        "interfaces.*.stiffness_at_pressure_min_pa_per_m", "Pa/m", "Stiffness at the lowest pressure",
        Accessor::Contact(|contact| contact.stiffness_at_pressure_min),
        |own, all, of| Some(own?.max(SMALL_DEPARTURE * all.size(Quantity::StaticStiffness, of)?));
    /// Time without contact at an interface.
    ContactLost:
        "interfaces.*.contact_lost_s", "s", "Time without contact",
        Accessor::Parts(|parts, of| parts.contact_lost.get(of?).copied()),
        |own, all, _| {
            Some(own?.max(all.size(Quantity::NaturalFrequency, None).map_or(0.0, f64::recip)))
        };
    /// Work of the exciting force.
    EnergyInput:
        "energy.input_j", "J", "Work of the force",
        energy!(|energy| energy.input), input_energy;
    /// Loss.
    EnergyDissipated:
        "energy.dissipated_j", "J", "Loss",
        energy!(|energy| energy.dissipated), input_energy;
    /// The viscous part of it in the contacts.
    EnergyContactDissipated:
        "energy.contact_dissipated_j", "J", "Viscous loss of contacts",
        energy!(|energy| energy.contact_dissipated), exact;
    /// The part of it by friction.
    EnergyFrictionDissipated:
        "energy.friction_dissipated_j", "J", "Loss by friction",
        energy!(|energy| energy.friction_dissipated), exact;
    /// Energy stored at the end, counted from rest.
    EnergyStored:
        "energy.stored_j", "J", "Stored energy",
        energy!(EnergyLedger::stored), input_energy;
    /// Loss of the contact scheme itself.
    EnergyNumericalLoss:
        "energy.numerical_loss_j", "J", "Numerical loss",
        energy!(|energy| energy.numerical_loss), exact;
    /// Remainder of the energy balance over the input.
    EnergyResidual:
        "energy.residual_relative", "", "Residual of the energy balance",
        energy!(EnergyLedger::residual_relative), exact;
    /// Integration step.
    Step:
        "numerics.step_s", "s", "Integration step",
        Accessor::Parts(|parts, _| Some(parts.step)), exact;
    /// Number of integration steps.
    Steps:
        "numerics.steps", "", "Integration steps",
        Accessor::Parts(|parts, _| Some(parts.steps as f64)), exact;
    /// Largest estimated error of the observables over their scales. It is set once it is known.
    EstimatedError:
        "accuracy.estimated_error", "", "Estimated relative error",
        Accessor::Parts(|_, _| None), exact;
    /// Time from which on the response depends on rounding; none if it does not. It is set once it is
    /// known.
    SensitiveFrom:
        "sensitive_from_s", "s", "Time from which rounding counts",
        Accessor::Parts(|_, _| None), exact;
}

fn contact_at_rest(at_rest: &StaticSummary, interface: Option<usize>) -> Option<&StaticInterface> {
    at_rest.interfaces.get(interface?)
}

/// The error scale of quantities without an estimated error.
fn exact(_: Option<f64>, _: &Values<'_>, _: Option<usize>) -> Option<f64> {
    None
}

/// The error scale of energies: the work of the force.
fn input_energy(_: Option<f64>, all: &Values<'_>, _: Option<usize>) -> Option<f64> {
    all.size(Quantity::EnergyInput, None)
}

/// The error scale of an extreme pressure: its departure from the pressure at rest.
fn departure(extreme: Quantity, all: &Values<'_>, interface: Option<usize>) -> Option<f64> {
    let size = |quantity| all.size(quantity, interface);
    let range = size(Quantity::PressureMax)? - size(Quantity::PressureMin)?;
    let departure = all.get(extreme, interface)? - size(Quantity::StaticPressure)?;
    Some(departure.abs().max(SMALL_DEPARTURE * range))
}

/// Values of all observables of a structure of so many interfaces, in the order of
/// [`Observable::all`]; NaN for a quantity that the response does not have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Values<'a> {
    pub(crate) all: &'a [f64],
    pub(crate) interfaces: usize,
}

impl Values<'_> {
    /// Value of a quantity of the whole structure, or of the interface of this number.
    pub(crate) fn get(&self, quantity: Quantity, interface: Option<usize>) -> Option<f64> {
        let place = Observable { quantity, interface }.place(self.interfaces)?;
        self.all.get(place).copied().filter(|value| !value.is_nan())
    }

    fn size(&self, quantity: Quantity, interface: Option<usize>) -> Option<f64> {
        self.get(quantity, interface).map(f64::abs)
    }

    /// The number that the error of an observable is compared with, in its unit; none for observables
    /// without an estimated error.
    pub(crate) fn error_scale(
        &self,
        Observable { quantity, interface }: Observable,
    ) -> Option<f64> {
        (quantity.definition().error_scale)(self.size(quantity, interface), self, interface)
    }
}

impl Quantity {
    fn definition(self) -> &'static Definition {
        &TABLE[self as usize]
    }

    /// Dotted name in summaries and tables; `*` stands for the name of an interface.
    pub fn key(self) -> &'static str {
        self.definition().key
    }

    /// Unit; empty for a number without one.
    pub fn unit(self) -> &'static str {
        self.definition().unit
    }

    /// Label of an axis or a table.
    pub fn label(self) -> &'static str {
        self.definition().label
    }

    /// The part of a response that it is read from, with the accessor.
    pub(crate) fn accessor(self) -> Accessor {
        self.definition().accessor
    }

    /// The features of a response at one sensor: its harmonics and damping ratios.
    pub fn features() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|one| one.is_feature())
    }

    /// True for a harmonic or a damping ratio, which each sensor has.
    pub fn is_feature(self) -> bool {
        matches!(self.accessor(), Accessor::Peaks(_)) || self == Self::DampingRatioDecrement
    }

    /// True if [`sensitivities`](crate::sensitivity::sensitivities) gives its derivatives.
    pub fn has_derivative(self) -> bool {
        !matches!(self.accessor(), Accessor::Parts(_))
    }

    /// True if each interface has one.
    pub fn is_of_interface(self) -> bool {
        self.column().is_of_interface
    }

    fn column(self) -> Column {
        COLUMNS[self as usize]
    }

    /// Quantity of the dotted name `name`, and the name of its interface where it has one.
    ///
    /// ```
    /// use asperity_simulation::quantity::Quantity;
    ///
    /// let (quantity, interface) = Quantity::of_name("interfaces.top.pressure_min_pa").unwrap();
    /// assert_eq!((quantity, interface), (Quantity::PressureMin, Some("top")));
    /// assert_eq!((quantity.unit(), quantity.label()), ("Pa", "Lowest pressure"));
    /// ```
    pub fn of_name(name: &str) -> Option<(Self, Option<&str>)> {
        if let Some((_, key)) = name.split_once(':') {
            let found = Self::of_name(key)?;
            return found.0.is_feature().then_some(found);
        }
        if let Some(start) = name.strip_suffix(PER_BASE) {
            return Self::features()
                .find(|one| one.key().strip_suffix(PER_FORCE) == Some(start))
                .map(|one| (one, None));
        }
        Self::ALL.iter().find_map(|&quantity| match quantity.key().split_once('*') {
            None => (quantity.key() == name).then_some((quantity, None)),
            Some((start, end)) => {
                let interface = name.strip_prefix(start)?.strip_suffix(end)?;
                Some((quantity, Some(interface)))
            }
        })
    }
}

/// Place of the columns of a quantity. Neighbouring quantities of interfaces form a group, whose columns
/// are those of the first interface, then those of the second.
#[derive(Debug, Clone, Copy)]
struct Column {
    is_of_interface: bool,
    /// Quantities of the whole structure before it.
    whole_before: usize,
    /// Quantities of interfaces before its group.
    grouped_before: usize,
    /// Place in its group.
    place: usize,
    /// Quantities of its group.
    group: usize,
}

/// In the order of [`Quantity::ALL`].
const COLUMNS: [Column; Quantity::ALL.len()] = columns();

const fn columns() -> [Column; Quantity::ALL.len()] {
    let whole =
        Column { is_of_interface: false, whole_before: 0, grouped_before: 0, place: 0, group: 0 };
    let mut columns = [whole; Quantity::ALL.len()];
    let (mut whole_before, mut grouped_before, mut i) = (0, 0, 0);
    while i < columns.len() {
        let mut group = 0;
        while i + group < columns.len() && names_interface(TABLE[i + group].key) {
            group += 1;
        }
        if group == 0 {
            columns[i] = Column { whole_before, grouped_before, ..whole };
            whole_before += 1;
            i += 1;
        }
        let mut place = 0;
        while place < group {
            columns[i] =
                Column { is_of_interface: true, whole_before, grouped_before, place, group };
            (place, i) = (place + 1, i + 1);
        }
        grouped_before += group;
    }
    columns
}

const fn names_interface(key: &str) -> bool {
    let (bytes, mut i) = (key.as_bytes(), 0);
    while i < bytes.len() {
        if bytes[i] == b'*' {
            return true;
        }
        i += 1;
    }
    false
}

/// A quantity of the whole structure, or of one of its interfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Observable {
    /// The quantity.
    pub quantity: Quantity,
    /// Number of the interface from the top down; none for a quantity of the whole structure.
    pub interface: Option<usize>,
}

impl Observable {
    /// Observables of a structure of so many `interfaces`, in the order of the columns of
    /// `sweep.csv`.
    pub fn all(interfaces: usize) -> Vec<Self> {
        let groups = Quantity::ALL.chunk_by(|a, b| a.is_of_interface() == b.is_of_interface());
        let mut all = Vec::new();
        for group in groups {
            if group[0].is_of_interface() {
                for interface in 0..interfaces {
                    let of = |&quantity| Self { quantity, interface: Some(interface) };
                    all.extend(group.iter().map(of));
                }
            } else {
                all.extend(group.iter().map(|&quantity| Self { quantity, interface: None }));
            }
        }
        all
    }

    /// Place among [`Observable::all`] of a structure of so many `interfaces`.
    pub(crate) fn place(self, interfaces: usize) -> Option<usize> {
        let column = self.quantity.column();
        let group = column.whole_before + column.grouped_before * interfaces;
        match self.interface {
            Some(at) if column.is_of_interface && at < interfaces => {
                Some(group + at * column.group + column.place)
            }
            None if !column.is_of_interface => Some(group),
            _ => None,
        }
    }

    /// Value in a response, if the response has it.
    pub(crate) fn value(self, parts: &ResponseParts<'_>) -> Option<f64> {
        match self.quantity.accessor() {
            Accessor::AtRest(read) => read(parts.at_rest, self.interface),
            Accessor::Peaks(read) => read(&parts.peaks),
            Accessor::Contact(read) => Some(read(parts.contacts.get(self.interface?)?)),
            Accessor::Parts(read) => read(parts, self.interface),
        }
    }

    /// Dotted name, with the name of the interface from `interfaces`.
    ///
    /// # Panics
    /// For an interface beyond those named.
    pub fn name(self, interfaces: &[&str]) -> String {
        let key = self.quantity.key();
        self.interface.map_or_else(|| key.to_owned(), |at| key.replace('*', interfaces[at]))
    }
}

/// Names of the observables of a structure with `interfaces` of these names: in the order of
/// [`Observable::all`], then the features at each sensor after the first, `SENSOR:fundamental.frequency_hz`
/// and the like. With a motion of the base, amplitudes are relative displacements per base acceleration:
/// `receptance_s2` in place of `receptance_m_per_n`.
pub fn observable_names(interfaces: &[&str], further: &[&str], base: bool) -> Vec<String> {
    let all = Observable::all(interfaces.len());
    let own = all.iter().map(|one| one.name(interfaces));
    let at = |sensor: &&str| {
        let sensor = (*sensor).to_owned();
        Quantity::features().map(move |one| format!("{sensor}:{}", one.key()))
    };
    let names = own.chain(further.iter().flat_map(at));
    if base {
        names.map(|name| name.replace(PER_FORCE, PER_BASE)).collect()
    } else {
        names.collect()
    }
}

/// Ends of the names of amplitudes: per force, and per base acceleration.
pub(crate) const PER_FORCE: &str = "receptance_m_per_n";
pub(crate) const PER_BASE: &str = "receptance_s2";

/// Name of the magnitude of the receptance at a frequency \[Hz\], as a column of a table.
///
/// ```
/// use asperity_simulation::quantity::{frf_frequency, frf_name, unit_of};
///
/// let name = frf_name(812.5);
/// assert_eq!(name, "frf.812.5_hz.receptance_m_per_n");
/// assert_eq!((frf_frequency(&name), unit_of(&name)), (Some(812.5), "m/N"));
/// assert_eq!((frf_frequency("harmonic_ratio"), unit_of("fundamental.frequency_hz")), (None, "Hz"));
/// ```
pub fn frf_name(frequency_hz: f64) -> String {
    format!("frf.{frequency_hz}_hz.{PER_FORCE}")
}

/// The frequency \[Hz\] of a receptance of this name.
pub fn frf_frequency(name: &str) -> Option<f64> {
    let name = name.strip_prefix("frf.")?;
    let amplitude = name.strip_suffix(PER_FORCE).or_else(|| name.strip_suffix(PER_BASE))?;
    amplitude.strip_suffix("_hz.")?.parse().ok()
}

/// Unit of a column of this name; empty for a number without one.
pub fn unit_of(name: &str) -> &'static str {
    if name.ends_with(PER_BASE) {
        return "s²";
    }
    if frf_frequency(name).is_some() {
        return Quantity::FundamentalReceptance.unit();
    }
    Quantity::of_name(name).map_or("", |(quantity, _)| quantity.unit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_lead_back_to_their_quantity() {
        let interfaces = ["a.b", "c"];
        let names = observable_names(&interfaces, &[], false);
        let mut sorted = names.clone();
        sorted.sort();
        sorted.dedup();
        assert_eq!(sorted.len(), names.len());
        for (observable, name) in Observable::all(2).iter().zip(&names) {
            let interface = observable.interface.map(|at| interfaces[at]);
            assert_eq!(Quantity::of_name(name), Some((observable.quantity, interface)));
        }
        assert_eq!(Quantity::of_name("interfaces.a.pressure"), None);
    }

    #[test]
    fn observables_are_in_their_places() {
        for interfaces in 0..4 {
            let all = Observable::all(interfaces);
            for (place, one) in all.iter().enumerate() {
                assert_eq!(one.place(interfaces), Some(place), "{one:?}");
            }
            let quantity = Quantity::PressureMin;
            assert_eq!(
                Observable { quantity, interface: Some(interfaces) }.place(interfaces),
                None
            );
            assert_eq!(Observable { quantity, interface: None }.place(interfaces), None);
        }
    }
}
