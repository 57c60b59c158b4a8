//! `summary.json`: the answers of one run, under the names of the contract.

use serde::Serialize;

/// Identifier of the summary's format.
pub const SUMMARY_SCHEMA: &str = "asperity/summary/1";

/// The summary of one transient run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// [`SUMMARY_SCHEMA`].
    pub schema: &'static str,
    /// Title of the scenario.
    pub title: Option<String>,
    /// State at rest.
    #[serde(rename = "static")]
    pub at_rest: StaticSummary,
    /// Fundamental of the receptance; none without a peak.
    pub fundamental: Option<Fundamental>,
    /// Second harmonic of the receptance; none without a peak.
    pub second_harmonic: Option<SecondHarmonic>,
    /// Second-harmonic over fundamental receptance, A2/A1.
    pub harmonic_ratio: Option<f64>,
    /// What happened at each interface, from the top down.
    pub interfaces: Vec<InterfaceSummary>,
    /// Energy balance.
    pub energy: EnergySummary,
    /// How it was computed.
    pub numerics: Numerics,
    /// From what it was computed.
    pub provenance: Provenance,
}

/// State at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticSummary {
    /// Lowest natural frequency of the rig linearised at rest \[Hz\]; none if it has no stiffness.
    pub natural_frequency_hz: Option<f64>,
    /// Contacts at rest, from the top down.
    pub interfaces: Vec<StaticInterface>,
}

/// One contact at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticInterface {
    /// Name of the interface.
    pub name: String,
    /// Static pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contact stiffness per area \[Pa/m\].
    pub stiffness_pa_per_m: f64,
    /// Closure from the law's reference \[m\].
    pub closure_m: f64,
}

/// The fundamental.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fundamental {
    /// Frequency f1 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A1 \[m/N\].
    pub receptance_m_per_n: f64,
    /// Half-power damping ratio; none where the peak does not fall to half power.
    pub damping_ratio: Option<f64>,
    /// Damping ratio by the logarithmic decrement of the ring-down, if it has enough cycles.
    pub damping_ratio_decrement: Option<f64>,
}

/// The second harmonic.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SecondHarmonic {
    /// Frequency f2 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A2 \[m/N\].
    pub receptance_m_per_n: f64,
}

/// One contact during the run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterfaceSummary {
    /// Name of the interface.
    pub name: String,
    /// Lowest pressure over all steps \[Pa\].
    pub pressure_min_pa: f64,
    /// Highest pressure over all steps \[Pa\].
    pub pressure_max_pa: f64,
    /// `K_avr` of Eq. (8) over the output samples \[Pa/m\].
    pub stiffness_average_pa_per_m: f64,
    /// Stiffness of the law at the lowest pressure \[Pa/m\].
    pub stiffness_at_pressure_min_pa_per_m: f64,
    /// Time without contact \[s\].
    pub contact_lost_s: f64,
}

/// Energy balance of the run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EnergySummary {
    /// Work of the force \[J\].
    pub input_j: f64,
    /// Viscous loss \[J\].
    pub dissipated_j: f64,
    /// Stored at the end, counted from rest \[J\].
    pub stored_j: f64,
    /// Loss of the contact scheme itself \[J\].
    pub numerical_loss_j: f64,
    /// What the balance leaves over, over the input.
    pub residual_relative: f64,
}

/// How it was computed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Numerics {
    /// Integrator.
    pub method: &'static str,
    /// Integration step \[s\].
    pub step_s: f64,
    /// Number of steps.
    pub steps: usize,
    /// Vector instructions used.
    pub instructions: String,
    /// Time the integration and analysis took \[s\].
    pub wall_s: f64,
}

/// From what it was computed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// Version of asperity.
    pub version: &'static str,
    /// SHA-256 of the scenario, with its changes, in canonical form.
    pub scenario_sha256: String,
}

impl Provenance {
    /// The provenance of a scenario with this hash.
    pub fn new(scenario_sha256: String) -> Self {
        Self { version: env!("CARGO_PKG_VERSION"), scenario_sha256 }
    }
}

impl Summary {
    /// Every number of the summary under its dotted name, interfaces by their
    /// own: the columns of a sweep. Times of the machine are left out, so that
    /// equal studies give equal tables.
    pub fn scalars(&self) -> Vec<(String, Option<f64>)> {
        self.names().into_iter().zip(self.values()).collect()
    }

    /// The names of [`scalars`](Self::scalars).
    pub fn names(&self) -> Vec<String> {
        let interfaces = self.at_rest.interfaces.iter().map(|state| state.name.as_str());
        scalar_names(&interfaces.collect::<Vec<_>>())
    }

    /// The numbers of [`scalars`](Self::scalars), in the order of [`names`](Self::names).
    pub fn values(&self) -> Vec<Option<f64>> {
        let (fundamental, second) = (self.fundamental.as_ref(), self.second_harmonic.as_ref());
        let mut values = vec![self.at_rest.natural_frequency_hz];
        for state in &self.at_rest.interfaces {
            let numbers = [state.pressure_pa, state.stiffness_pa_per_m, state.closure_m];
            values.extend(numbers.map(Some));
        }
        values.extend([
            fundamental.map(|f| f.frequency_hz),
            fundamental.map(|f| f.receptance_m_per_n),
            fundamental.and_then(|f| f.damping_ratio),
            fundamental.and_then(|f| f.damping_ratio_decrement),
            second.map(|s| s.frequency_hz),
            second.map(|s| s.receptance_m_per_n),
            self.harmonic_ratio,
        ]);
        for contact in &self.interfaces {
            let numbers = [
                contact.pressure_min_pa,
                contact.pressure_max_pa,
                contact.stiffness_average_pa_per_m,
                contact.stiffness_at_pressure_min_pa_per_m,
                contact.contact_lost_s,
            ];
            values.extend(numbers.map(Some));
        }
        let numbers = [
            self.energy.input_j,
            self.energy.dissipated_j,
            self.energy.stored_j,
            self.energy.numerical_loss_j,
            self.energy.residual_relative,
            self.numerics.step_s,
            self.numerics.steps as f64,
        ];
        values.extend(numbers.map(Some));
        values
    }
}

/// The names of a summary's numbers, for a rig with `interfaces` of these names.
pub fn scalar_names(interfaces: &[&str]) -> Vec<String> {
    let mut names = vec!["static.natural_frequency_hz".to_owned()];
    for name in interfaces {
        for key in ["pressure_pa", "stiffness_pa_per_m", "closure_m"] {
            names.push(format!("static.interfaces.{name}.{key}"));
        }
    }
    let keys = [
        "fundamental.frequency_hz",
        "fundamental.receptance_m_per_n",
        "fundamental.damping_ratio",
        "fundamental.damping_ratio_decrement",
        "second_harmonic.frequency_hz",
        "second_harmonic.receptance_m_per_n",
        "harmonic_ratio",
    ];
    names.extend(keys.map(str::to_owned));
    for name in interfaces {
        for key in [
            "pressure_min_pa",
            "pressure_max_pa",
            "stiffness_average_pa_per_m",
            "stiffness_at_pressure_min_pa_per_m",
            "contact_lost_s",
        ] {
            names.push(format!("interfaces.{name}.{key}"));
        }
    }
    let keys = [
        "energy.input_j",
        "energy.dissipated_j",
        "energy.stored_j",
        "energy.numerical_loss_j",
        "energy.residual_relative",
        "numerics.step_s",
        "numerics.steps",
    ];
    names.extend(keys.map(str::to_owned));
    names
}
