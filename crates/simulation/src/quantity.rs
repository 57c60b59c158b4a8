//! Quantities that are observed in a response: key, unit, label, derivative.
//!
//! This is the one list of them: summaries, columns of `sweep.csv`, derivatives, features of an
//! identification and axes of figures take names and units from here.

/// Defines [`Quantity`]: each with key (`*` for the name of an interface), unit, label, and true
/// for one with a derivative, in the order of the columns of `sweep.csv`.
macro_rules! quantities {
    ($($(#[$doc:meta])* $name:ident: $key:expr, $unit:expr, $label:expr, $derivative:expr;)*) => {
        /// A quantity of a whole structure, or of each of its interfaces.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Quantity {
            $($(#[$doc])* $name,)*
        }

        impl Quantity {
            /// All quantities, in the order of the columns of `sweep.csv`.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            const fn definition(self) -> (&'static str, &'static str, &'static str, bool) {
                match self {
                    $(Self::$name => ($key, $unit, $label, $derivative),)*
                }
            }
        }
    };
}

quantities! {
    /// Lowest natural frequency of the structure linearised at rest.
    NaturalFrequency: "static.natural_frequency_hz", "Hz", "Natural frequency at rest", true;
    /// Static pressure of an interface.
    StaticPressure: "static.interfaces.*.pressure_pa", "Pa", "Static pressure", true;
    /// Contact stiffness per area of an interface at rest.
    StaticStiffness: "static.interfaces.*.stiffness_pa_per_m", "Pa/m", "Static stiffness", true;
    /// Closure of an interface at rest, from the law's reference.
    StaticClosure: "static.interfaces.*.closure_m", "m", "Static closure", true;
    /// Frequency f1 of the fundamental peak of the receptance.
    FundamentalFrequency: "fundamental.frequency_hz", "Hz", "Fundamental f_{1}", true;
    /// Receptance A1 at the fundamental peak.
    FundamentalReceptance: "fundamental.receptance_m_per_n", "m/N", "Amplitude A_{1}", true;
    /// Half-power damping ratio of the fundamental.
    DampingRatio: "fundamental.damping_ratio", "", "Damping ratio", true;
    /// Damping ratio by the logarithmic decrement of the decay.
    DampingRatioDecrement:
        "fundamental.damping_ratio_decrement", "", "Damping ratio by decrement", false;
    /// Frequency f2 of the second-harmonic peak of the receptance.
    SecondHarmonicFrequency: "second_harmonic.frequency_hz", "Hz", "Harmonic f_{2}", true;
    /// Receptance A2 at the second-harmonic peak.
    SecondHarmonicReceptance: "second_harmonic.receptance_m_per_n", "m/N", "Amplitude A_{2}", true;
    /// Ratio A2/A1 of the receptances at both peaks.
    HarmonicRatio: "harmonic_ratio", "", "Ratio A_{2}/A_{1}", true;
    /// Lowest pressure of an interface.
    PressureMin: "interfaces.*.pressure_min_pa", "Pa", "Lowest pressure", true;
    /// Highest pressure of an interface.
    PressureMax: "interfaces.*.pressure_max_pa", "Pa", "Highest pressure", true;
    /// Time average `K_avr` of an interface's stiffness, Eq. (8).
    StiffnessAverage: "interfaces.*.stiffness_average_pa_per_m", "Pa/m", "Average stiffness", true;
    /// Stiffness of an interface's law at the lowest pressure.
    StiffnessAtPressureMin:
        "interfaces.*.stiffness_at_pressure_min_pa_per_m", "Pa/m", "Stiffness at the lowest pressure", true;
    /// Time without contact at an interface.
    ContactLost: "interfaces.*.contact_lost_s", "s", "Time without contact", false;
    /// Work of the exciting force.
    EnergyInput: "energy.input_j", "J", "Work of the force", false;
    /// Loss.
    EnergyDissipated: "energy.dissipated_j", "J", "Loss", false;
    /// The viscous part of it in the contacts.
    EnergyContactDissipated:
        "energy.contact_dissipated_j", "J", "Viscous loss of contacts", false;
    /// The part of it by friction.
    EnergyFrictionDissipated:
        "energy.friction_dissipated_j", "J", "Loss by friction", false;
    /// Energy stored at the end, counted from rest.
    EnergyStored: "energy.stored_j", "J", "Stored energy", false;
    /// Loss of the contact scheme itself.
    EnergyNumericalLoss: "energy.numerical_loss_j", "J", "Numerical loss", false;
    /// Remainder of the energy balance over the input.
    EnergyResidual: "energy.residual_relative", "", "Residual of the energy balance", false;
    /// Integration step.
    Step: "numerics.step_s", "s", "Integration step", false;
    /// Number of integration steps.
    Steps: "numerics.steps", "", "Integration steps", false;
    /// Largest estimated error of the observables over their scales.
    EstimatedError: "accuracy.estimated_error", "", "Estimated relative error", false;
    /// Time from which on the response depends on rounding; none if it does not.
    SensitiveFrom: "sensitive_from_s", "s", "Time from which rounding counts", false;
}

impl Quantity {
    /// Dotted name in summaries and tables; `*` stands for the name of an interface.
    pub fn key(self) -> &'static str {
        self.definition().0
    }

    /// Unit; empty for a number without one.
    pub fn unit(self) -> &'static str {
        self.definition().1
    }

    /// Label of an axis or a table.
    pub fn label(self) -> &'static str {
        self.definition().2
    }

    /// True if [`sensitivities`](crate::sensitivity::sensitivities) gives its derivatives.
    pub fn has_derivative(self) -> bool {
        self.definition().3
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
        while i + group < columns.len() && names_interface(Quantity::ALL[i + group].definition().0)
        {
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

    /// Dotted name, with the name of the interface from `interfaces`.
    ///
    /// # Panics
    /// For an interface beyond those named.
    pub fn name(self, interfaces: &[&str]) -> String {
        let key = self.quantity.key();
        self.interface.map_or_else(|| key.to_owned(), |at| key.replace('*', interfaces[at]))
    }
}

/// Names of the observables of a structure with `interfaces` of these names, in the order of
/// [`Observable::all`].
pub fn observable_names(interfaces: &[&str]) -> Vec<String> {
    Observable::all(interfaces.len()).iter().map(|one| one.name(interfaces)).collect()
}

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
    format!("{}{frequency_hz}{}", FRF[0], FRF[1])
}

/// Start and end of the name of a receptance.
const FRF: [&str; 2] = ["frf.", "_hz.receptance_m_per_n"];

/// The frequency \[Hz\] of a receptance of this name.
pub fn frf_frequency(name: &str) -> Option<f64> {
    name.strip_prefix(FRF[0])?.strip_suffix(FRF[1])?.parse().ok()
}

/// Unit of a column of this name; empty for a number without one.
pub fn unit_of(name: &str) -> &'static str {
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
        let names = observable_names(&interfaces);
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
