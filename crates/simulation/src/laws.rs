//! Tables of the laws of a scenario, and the fit of the power law to measurements.

use std::path::Path;
use std::sync::Arc;

use asperity_law::{ContactLaw, PowerFit, fit_power};
use asperity_mesh::Body;
use asperity_scenario::{AnyScenario, LawRef, Laws, Scenario, StructureScenario, read_text};

use crate::assemble::body;
use crate::error::{FitTableError, FitTableFault, SimulationError};
use crate::patches::assemble_patches;
use crate::static_state::StaticSummary;

/// Rows of a tabulated law.
const ROWS: usize = 501;

/// Highest pressure of a table \[Pa\], unless the law or the static pressures are higher.
const USUAL_TOP: f64 = 1e6;

/// Most bytes of a table to fit.
const MOST_FIT_BYTES: u64 = 16 << 20;

/// A tabulated law.
#[derive(Debug, Clone, PartialEq)]
pub struct LawTable {
    /// Name of the law in the scenario.
    pub name: String,
    /// Pressure in Pa, increasing.
    pub pressure: Vec<f64>,
    /// Contact stiffness per area in Pa/m.
    pub stiffness: Vec<f64>,
    /// Closure in m, from the law's reference pressure.
    pub closure: Vec<f64>,
    /// Stored energy per area in J/m2.
    pub energy: Vec<f64>,
}

/// The laws of a scenario, and its contacts at rest.
#[derive(Debug, Clone)]
pub struct ScenarioLaws {
    /// The named laws.
    pub laws: Laws,
    /// The contacts, in the order of the results.
    pub contacts: Vec<ContactLawAtRest>,
}

/// The law of a contact, and its pressure at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLawAtRest {
    /// Name of the interface.
    pub interface: String,
    /// Its law.
    pub law: LawRef,
    /// Static pressure \[Pa\]; of a patch the mean over its area.
    pub static_pressure_pa: f64,
}

/// A named law of a scenario.
#[derive(Debug, Clone)]
pub struct ScenarioLaw {
    /// Name of the law.
    pub name: String,
    /// Static pressure \[Pa\] of the first interface that uses the law, or else of the first one.
    pub static_pressure_pa: f64,
    /// The law; one that never separates counts its closure from that pressure.
    pub law: Arc<dyn ContactLaw>,
}

impl ScenarioLaws {
    /// The laws of a stack of bars, and its contacts under the weight of the bodies above.
    ///
    /// # Errors
    /// [`SimulationError`] when a body cannot be built.
    pub fn of_bars(scenario: &Scenario) -> Result<Self, SimulationError> {
        let bodies = scenario.bodies.iter().map(body).collect::<Result<Vec<Body>, _>>()?;
        let areas = scenario.interfaces.iter().map(|interface| interface.area_m2);
        let pressures = asperity_mesh::static_pressures(&bodies, areas, scenario.gravity_m_per_s2);
        let interfaces = scenario.interfaces.iter().map(|one| (&one.name, &one.law));
        Ok(Self::new(&scenario.laws, interfaces, pressures))
    }

    /// The laws of a scenario whose files are in `folder`.
    ///
    /// # Errors
    /// [`SimulationError`] when a body or a structure cannot be built.
    pub fn of(scenario: &AnyScenario, folder: &Path) -> Result<Self, SimulationError> {
        match scenario {
            AnyScenario::Bars(bars) => Self::of_bars(bars),
            AnyScenario::Structure(structure) => {
                let assembly = assemble_patches(structure, folder)?;
                Ok(Self::of_structure(structure, &assembly.structure.at_rest()))
            }
        }
    }

    /// The laws of a structure given by matrices, and its patches at rest.
    pub fn of_structure(scenario: &StructureScenario, at_rest: &StaticSummary) -> Self {
        let interfaces = scenario.interfaces.iter().map(|one| (&one.name, &one.law));
        let pressures = at_rest.interfaces.iter().map(|patch| patch.pressure_pa);
        Self::new(&scenario.laws, interfaces, pressures)
    }

    fn new<'a>(
        laws: &Laws,
        interfaces: impl Iterator<Item = (&'a String, &'a LawRef)>,
        pressures: impl IntoIterator<Item = f64>,
    ) -> Self {
        let contact = |((interface, law), static_pressure_pa): ((&String, &LawRef), f64)| {
            let (interface, law) = (interface.clone(), law.clone());
            ContactLawAtRest { interface, law, static_pressure_pa }
        };
        Self { laws: laws.clone(), contacts: interfaces.zip(pressures).map(contact).collect() }
    }

    /// Builds every named law, in the order of the scenario.
    ///
    /// # Errors
    /// [`SimulationError`] when a law cannot be built.
    pub fn built(&self) -> Result<Vec<ScenarioLaw>, SimulationError> {
        let built = self.laws.names().map(|name| {
            let reference = LawRef::Named(name.to_owned());
            let used = self.contacts.iter().find(|contact| contact.law == reference);
            let pressure_pa = used
                .or_else(|| self.contacts.first())
                .map_or(0.0, |contact| contact.static_pressure_pa);
            let law = self.laws.build(&reference, pressure_pa).map_err(|source| {
                let interface = used.map(|contact| contact.interface.clone());
                SimulationError::Law { law: name.to_owned(), interface, pressure_pa, source }
            })?;
            Ok(ScenarioLaw { name: name.to_owned(), static_pressure_pa: pressure_pa, law })
        });
        built.collect()
    }

    /// Tabulates every named law, from zero pressure to at least 1 MPa.
    ///
    /// The rows crowd towards zero pressure, where the laws differ most: row `i`
    /// of `n` lies at `(i / n)^2` of the top. A law that never separates counts its
    /// closure from the static pressure of the first interface that uses it, and
    /// its table starts above zero pressure, where its closure is finite.
    ///
    /// # Errors
    /// [`SimulationError`] when a law cannot be built.
    ///
    /// ```
    /// # use asperity_scenario::Document;
    /// # use asperity_simulation::laws::ScenarioLaws;
    /// let document = Document::read("examples/block.json")?;
    /// let tables = ScenarioLaws::of_bars(&document.scenario()?)?.tables()?;
    /// let last = tables[0].pressure.len() - 1;
    /// assert_eq!(tables[0].pressure[last], 1e6);
    /// assert!((tables[0].stiffness[last] / (1.8e10 * 1e6_f64.powf(0.35)) - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn tables(&self) -> Result<Vec<LawTable>, SimulationError> {
        let _stage = tracing::info_span!("tabulate").entered();
        let tables = self.built()?.into_iter().map(|one| {
            let reference = LawRef::Named(one.name.clone());
            let top = usual_top(&self.laws, &reference, one.static_pressure_pa);
            table(&one.name, &one.law, top)
        });
        Ok(tables.collect())
    }
}

/// Highest pressure \[Pa\] of the table of a law.
pub(crate) fn usual_top(laws: &Laws, law: &LawRef, at_rest: f64) -> f64 {
    let highest = laws.highest_pressure(law).unwrap_or_default();
    USUAL_TOP.max(2.0 * at_rest).max(highest)
}

fn table(name: &str, law: &Arc<dyn ContactLaw>, top: f64) -> LawTable {
    let pressures = (0..ROWS).map(|row| top * (row as f64 / (ROWS - 1) as f64).powi(2));
    let pairs = pressures.map(|pressure| (pressure, law.closure(pressure)));
    let (pressure, closure): (Vec<f64>, Vec<f64>) = pairs.filter(|pair| pair.1.is_finite()).unzip();
    let stiffness = pressure.iter().map(|&pressure| law.stiffness(pressure)).collect();
    let energy = closure.iter().map(|&closure| law.energy(closure)).collect();
    LawTable { name: name.to_owned(), pressure, stiffness, closure, energy }
}

/// Fits `ln K = ln C + m ln p` to a CSV of `pressure_pa,stiffness_pa_per_m` rows.
///
/// The paper's Table 3 gives C = 1.810e10 and m = 0.351.
///
/// # Errors
/// [`FitTableError`] for a file that cannot be read or points that cannot be fitted.
///
/// ```
/// # use asperity_simulation::laws::fit;
/// let folder = tempfile::tempdir()?;
/// let table = folder.path().join("table.csv");
/// let rows = "0.14e6,1.15e12\n0.35e6,1.75e12\n0.57e6,1.63e12\n1e6,2.46e12\n";
/// std::fs::write(&table, format!("pressure_pa,stiffness_pa_per_m\n{rows}"))?;
/// let power = fit(&table)?;
/// assert!((power.exponent - 0.3509).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(path: &Path) -> Result<PowerFit, FitTableError> {
    let fitted = read_points(path).and_then(|points| Ok(fit_power(&points)?));
    fitted.map_err(|fault| FitTableError { path: path.to_owned(), fault })
}

fn read_points(path: &Path) -> Result<Vec<(f64, f64)>, FitTableFault> {
    let text = read_text(path, MOST_FIT_BYTES)?;
    let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let header = lines.next().map(|(_, line)| line.trim()).unwrap_or_default();
    if header.replace(' ', "") != "pressure_pa,stiffness_pa_per_m" {
        return Err(FitTableFault::Header(header.to_owned()));
    }
    let rows = lines.filter(|(_, line)| !line.trim().is_empty());
    rows.map(|(number, line)| {
        let parse = |field: &str| field.trim().parse::<f64>().ok();
        let pair = line.split_once(',').and_then(|(p, k)| Some((parse(p)?, parse(k)?)));
        pair.ok_or_else(|| FitTableFault::Row { line: number + 1, found: line.to_owned() })
    })
    .collect()
}
