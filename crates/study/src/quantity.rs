//! Quantities that are observed in a response: key, unit, label, derivative.
//!
//! This is the one list of them: summaries, columns of `sweep.csv`, derivatives, features of an
//! identification and axes of figures take names and units from here.

/// A quantity of a whole structure, or of each of its interfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// Lowest natural frequency of the structure linearised at rest.
    NaturalFrequency,
    /// Static pressure of an interface.
    StaticPressure,
    /// Contact stiffness per area of an interface at rest.
    StaticStiffness,
    /// Closure of an interface at rest, from the law's reference.
    StaticClosure,
    /// Frequency f1 of the fundamental peak of the receptance.
    FundamentalFrequency,
    /// Receptance A1 at the fundamental peak.
    FundamentalReceptance,
    /// Half-power damping ratio of the fundamental.
    DampingRatio,
    /// Damping ratio by the logarithmic decrement of the decay.
    DampingRatioDecrement,
    /// Frequency f2 of the second-harmonic peak of the receptance.
    SecondHarmonicFrequency,
    /// Receptance A2 at the second-harmonic peak.
    SecondHarmonicReceptance,
    /// Ratio A2/A1 of the receptances at both peaks.
    HarmonicRatio,
    /// Lowest pressure of an interface.
    PressureMin,
    /// Highest pressure of an interface.
    PressureMax,
    /// Time average `K_avr` of an interface's stiffness, Eq. (8).
    StiffnessAverage,
    /// Stiffness of an interface's law at the lowest pressure.
    StiffnessAtPressureMin,
    /// Time without contact at an interface.
    ContactLost,
    /// Work of the exciting force.
    EnergyInput,
    /// Viscous loss.
    EnergyDissipated,
    /// Energy stored at the end, counted from rest.
    EnergyStored,
    /// Loss of the contact scheme itself.
    EnergyNumericalLoss,
    /// Remainder of the energy balance over the input.
    EnergyResidual,
    /// Integration step.
    Step,
    /// Number of integration steps.
    Steps,
}

/// Key (with `*` for the name of an interface), unit, label, and whether there is a derivative.
type Definition = (&'static str, &'static str, &'static str, bool);

impl Quantity {
    /// All quantities, in the order of the columns of `sweep.csv`.
    pub const ALL: [Self; 23] = [
        Self::NaturalFrequency,
        Self::StaticPressure,
        Self::StaticStiffness,
        Self::StaticClosure,
        Self::FundamentalFrequency,
        Self::FundamentalReceptance,
        Self::DampingRatio,
        Self::DampingRatioDecrement,
        Self::SecondHarmonicFrequency,
        Self::SecondHarmonicReceptance,
        Self::HarmonicRatio,
        Self::PressureMin,
        Self::PressureMax,
        Self::StiffnessAverage,
        Self::StiffnessAtPressureMin,
        Self::ContactLost,
        Self::EnergyInput,
        Self::EnergyDissipated,
        Self::EnergyStored,
        Self::EnergyNumericalLoss,
        Self::EnergyResidual,
        Self::Step,
        Self::Steps,
    ];

    fn definition(self) -> Definition {
        match self {
            Self::NaturalFrequency => {
                ("static.natural_frequency_hz", "Hz", "Natural frequency at rest", true)
            }
            Self::StaticPressure => {
                ("static.interfaces.*.pressure_pa", "Pa", "Static pressure", true)
            }
            Self::StaticStiffness => {
                ("static.interfaces.*.stiffness_pa_per_m", "Pa/m", "Static stiffness", true)
            }
            Self::StaticClosure => ("static.interfaces.*.closure_m", "m", "Static closure", true),
            Self::FundamentalFrequency => {
                ("fundamental.frequency_hz", "Hz", "Fundamental f_{1}", true)
            }
            Self::FundamentalReceptance => {
                ("fundamental.receptance_m_per_n", "m/N", "Amplitude A_{1}", true)
            }
            Self::DampingRatio => ("fundamental.damping_ratio", "", "Damping ratio", true),
            Self::DampingRatioDecrement => {
                ("fundamental.damping_ratio_decrement", "", "Damping ratio by decrement", false)
            }
            Self::SecondHarmonicFrequency => {
                ("second_harmonic.frequency_hz", "Hz", "Harmonic f_{2}", true)
            }
            Self::SecondHarmonicReceptance => {
                ("second_harmonic.receptance_m_per_n", "m/N", "Amplitude A_{2}", true)
            }
            Self::HarmonicRatio => ("harmonic_ratio", "", "Ratio A_{2}/A_{1}", true),
            Self::PressureMin => ("interfaces.*.pressure_min_pa", "Pa", "Lowest pressure", true),
            Self::PressureMax => ("interfaces.*.pressure_max_pa", "Pa", "Highest pressure", true),
            Self::StiffnessAverage => {
                ("interfaces.*.stiffness_average_pa_per_m", "Pa/m", "Average stiffness", true)
            }
            Self::StiffnessAtPressureMin => (
                "interfaces.*.stiffness_at_pressure_min_pa_per_m",
                "Pa/m",
                "Stiffness at the lowest pressure",
                true,
            ),
            Self::ContactLost => {
                ("interfaces.*.contact_lost_s", "s", "Time without contact", false)
            }
            Self::EnergyInput => ("energy.input_j", "J", "Work of the force", false),
            Self::EnergyDissipated => ("energy.dissipated_j", "J", "Viscous loss", false),
            Self::EnergyStored => ("energy.stored_j", "J", "Stored energy", false),
            Self::EnergyNumericalLoss => ("energy.numerical_loss_j", "J", "Numerical loss", false),
            Self::EnergyResidual => {
                ("energy.residual_relative", "", "Residual of the energy balance", false)
            }
            Self::Step => ("numerics.step_s", "s", "Integration step", false),
            Self::Steps => ("numerics.steps", "", "Integration steps", false),
        }
    }

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

    /// Whether [`sensitivities`](crate::sensitivity::sensitivities) gives its derivatives.
    pub fn has_derivative(self) -> bool {
        self.definition().3
    }

    /// Whether each interface has one.
    pub fn is_of_interface(self) -> bool {
        self.key().contains('*')
    }

    /// Quantity of the dotted name `name`, and the name of its interface where it has one.
    ///
    /// ```
    /// use asperity_study::quantity::Quantity;
    ///
    /// let (quantity, interface) = Quantity::of_name("interfaces.top.pressure_min_pa").unwrap();
    /// assert_eq!((quantity, interface), (Quantity::PressureMin, Some("top")));
    /// assert_eq!((quantity.unit(), quantity.label()), ("Pa", "Lowest pressure"));
    /// ```
    pub fn of_name(name: &str) -> Option<(Self, Option<&str>)> {
        Self::ALL.into_iter().find_map(|quantity| match quantity.key().split_once('*') {
            None => (quantity.key() == name).then_some((quantity, None)),
            Some((start, end)) => {
                let interface = name.strip_prefix(start)?.strip_suffix(end)?;
                Some((quantity, Some(interface)))
            }
        })
    }
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
}
