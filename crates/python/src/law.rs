//! The class `Law`, tables of the laws of a scenario, and the fit of the power law.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, LazyLock};

use asperity_law::{
    ContactLaw, InSeriesSpec, LawError, LawRef, LawSpec, Laws, MAX_SERIES_DEPTH, fit_power as fit,
};
use asperity_scenario::{Document, schema_of};
use asperity_simulation::error::SimulationError;
use asperity_simulation::laws::ScenarioLaws;
use asperity_simulation::record::law_columns;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use serde_json::{Value, json};

use crate::figure::PyFigure;
use crate::scenario::PyScenario;
use crate::{background, columns, exception, json as documents};

/// Values between two checks of signals.
const VALUES_A_CHECK: usize = 1 << 14;

/// Contact law: stiffness, closure, pressure and energy of an interface.
///
/// Each method takes a number or an array of any shape and strides, and returns a number or an array
/// of that shape. Other Python threads run meanwhile. Closures count from zero pressure, or from
/// `reference_pa` for a law that never separates.
///
/// A law stands wherever a scenario has one:
/// ``scenario.with_({"/laws/mine": law, "/interfaces/0/law": "mine"})``.
///
/// Parameters
/// ----------
/// source : dict, str or Law
///     The law as in a scenario, such as
///     ``{"kind": "power", "coefficient": 1.81e10, "exponent": 0.35}``, or as JSON text.
/// reference_pa : float, optional
///     Pressure in Pa at which the closure of a law that never separates is zero.
///
/// Raises
/// ------
/// TypeError
///     If `source` is none of these.
/// ScenarioError
///     With all faults of the document.
/// ValueError
///     If the parameters do not make a law, or a law whose stiffness grows in proportion to the pressure or
///     faster, which never separates, has no `reference_pa`.
///
/// Examples
/// --------
/// >>> law = Law({"kind": "power", "coefficient": 1.81e10, "exponent": 0.35})
/// >>> law.stiffness([0.14e6, 1e6]).shape
/// (2,)
#[pyclass(name = "Law", module = "asperity", frozen)]
#[derive(Debug, Clone)]
pub(crate) struct PyLaw {
    spec: LawSpec,
    reference_pa: Option<f64>,
    law: Arc<dyn ContactLaw>,
}

impl PyLaw {
    fn build(spec: LawSpec, reference_pa: Option<f64>) -> PyResult<Self> {
        if let Some(pressure) = reference_pa
            && !(pressure.is_finite() && pressure > 0.0)
        {
            let text = format!("reference_pa is {pressure}; it must be positive and finite");
            return Err(PyValueError::new_err(text));
        }
        let reference = LawRef::from(spec.clone());
        let built = |pressure: f64| {
            Laws::default().build(&reference, pressure).map_err(|error| in_words(&error))
        };
        let law = built(reference_pa.unwrap_or(0.0)).map_err(|error| {
            if reference_pa.is_none() && built(1e5).is_ok() {
                PyValueError::new_err(
                    "the law never separates, so that its closure counts from a pressure; \
                     give it as reference_pa",
                )
            } else {
                error
            }
        })?;
        Ok(Self { spec, reference_pa, law })
    }

    /// Text and bits that equal laws have in common.
    fn key(&self) -> (String, Option<u64>) {
        (json!(self.spec).to_string(), self.reference_pa.map(f64::to_bits))
    }

    /// Applies a function to every number of an array; a Series becomes one with the name `column`.
    fn map<'py>(
        values: &Bound<'py, PyAny>,
        name: &str,
        column: &str,
        function: impl Fn(f64) -> f64 + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = values.py();
        let numbers = py.import("asperity._numbers")?.call_method1("numbers", (values, name))?;
        let numbers = numbers.cast::<PyArrayDyn<f64>>()?.try_readonly()?;
        let input = numbers.as_slice()?;
        let mut found = Vec::with_capacity(input.len());
        for part in input.chunks(VALUES_A_CHECK) {
            py.detach(|| found.extend(part.iter().map(|&value| function(value))));
            py.check_signals()?;
        }
        let shape: Vec<usize> = numbers.shape().to_vec();
        let found = PyArray1::from_vec(py, found).reshape(shape)?;
        // An array of no dimension becomes a number.
        let found = found.get_item(pyo3::types::PyTuple::empty(py))?;
        py.import("asperity._numbers")?.call_method1("like", (values, found, column))
    }
}

#[pymethods]
impl PyLaw {
    #[new]
    #[pyo3(signature = (source, *, reference_pa = None))]
    fn new(source: &Bound<'_, PyAny>, reference_pa: Option<f64>) -> PyResult<Self> {
        static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<LawSpec>);
        let py = source.py();
        if let Ok(law) = source.cast::<Self>() {
            let law = law.get();
            return Self::build(law.spec.clone(), reference_pa.or(law.reference_pa));
        }
        let text = if source.is_instance_of::<PyDict>() {
            documents::text_of(source)?
        } else if let Ok(text) = source.cast::<PyString>() {
            text.to_cow()?.into_owned()
        } else {
            return Err(PyTypeError::new_err(format!(
                "a law cannot be of the type {}; accepted: a dict, JSON text or a Law",
                source.get_type().name()?
            )));
        };
        let document =
            Document::parse(&text, "law").map_err(|error| exception::of_document(py, &error))?;
        let spec = document
            .checked(&SCHEMA, Vec::new())
            .map_err(|invalid| exception::of_invalid(py, &invalid))?;
        Self::build(spec, reference_pa)
    }

    /// Stiffness ``K = dp/dd`` at pressures.
    ///
    /// Parameters
    /// ----------
    /// pressure : float or array_like
    ///     Pressures in Pa.
    ///
    /// Returns
    /// -------
    /// float, or ndarray or Series like `pressure`
    ///     In Pa/m; zero below the domain, NaN for NaN.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the pressures are not real numbers.
    fn stiffness<'py>(&self, pressure: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        Self::map(pressure, "pressure", "stiffness_pa_per_m", |p| self.law.stiffness(p))
    }

    /// Slope ``dK/dp`` of the stiffness at pressures.
    ///
    /// Parameters
    /// ----------
    /// pressure : float or array_like
    ///     Pressures in Pa.
    ///
    /// Returns
    /// -------
    /// float, or ndarray or Series like `pressure`
    ///     In 1/m; infinite where the stiffness leaves zero with a vertical tangent, NaN for NaN.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the pressures are not real numbers.
    fn stiffness_slope<'py>(&self, pressure: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        Self::map(pressure, "pressure", "stiffness_slope_per_m", |p| self.law.stiffness_slope(p))
    }

    /// Closure at pressures.
    ///
    /// Parameters
    /// ----------
    /// pressure : float or array_like
    ///     Pressures in Pa.
    ///
    /// Returns
    /// -------
    /// float, or ndarray or Series like `pressure`
    ///     In m, from `reference_pa`; NaN for NaN.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the pressures are not real numbers.
    fn closure<'py>(&self, pressure: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        Self::map(pressure, "pressure", "closure_m", |p| self.law.closure(p))
    }

    /// Pressure at closures.
    ///
    /// Parameters
    /// ----------
    /// closure : float or array_like
    ///     Closures in m.
    ///
    /// Returns
    /// -------
    /// float, or ndarray or Series like `closure`
    ///     In Pa; zero where contact is lost, infinite beyond `closure_limit_m`, NaN for NaN.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the closures are not real numbers.
    fn pressure<'py>(&self, closure: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        Self::map(closure, "closure", "pressure_pa", |d| self.law.pressure(d).value)
    }

    /// Stored energy per area at closures.
    ///
    /// Parameters
    /// ----------
    /// closure : float or array_like
    ///     Closures in m.
    ///
    /// Returns
    /// -------
    /// float, or ndarray or Series like `closure`
    ///     In J/m2; NaN for NaN.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the closures are not real numbers.
    fn energy<'py>(&self, closure: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        Self::map(closure, "closure", "energy_j_per_m2", |d| self.law.energy(d))
    }

    /// The law as in a scenario.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        documents::to_python(py, &self.spec)
    }

    /// Kind of the law, as in a scenario.
    #[getter]
    fn kind(&self) -> String {
        let value = json!(self.spec);
        value.get("kind").and_then(Value::as_str).unwrap_or_default().to_owned()
    }

    /// Pressure in Pa at which the closure is zero.
    #[getter]
    fn reference_pa(&self) -> f64 {
        self.law.reference_pressure()
    }

    /// Closure in m below which contact is lost; None if it never is.
    #[getter]
    fn closure_lost_m(&self) -> Option<f64> {
        self.law.domain().closure_lost
    }

    /// Closure in m that the law approaches at infinite pressure; infinite for most laws.
    #[getter]
    fn closure_limit_m(&self) -> f64 {
        self.law.domain().closure_limit
    }

    /// Range of the measured pressures in Pa, outside which a table is extrapolated; None for a
    /// formula.
    #[getter]
    fn measured_range_pa(&self) -> Option<(f64, f64)> {
        self.law.measured_range()
    }

    fn __repr__(&self) -> String {
        format!("<asperity.Law of the kind {}>", self.kind())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().key() == self.key())
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.key().hash(&mut hasher);
        hasher.finish()
    }

    /// Pickles and copies are made from the document and the reference pressure.
    #[expect(clippy::type_complexity, reason = "the protocol of pickle")]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (String, Option<f64>))> {
        let restore = slf.py().import("asperity._asperity")?.getattr("restore_law")?;
        Ok((restore, (json!(slf.get().spec).to_string(), slf.get().reference_pa)))
    }
}

/// The law of a JSON text.
#[pyfunction]
#[pyo3(signature = (text, reference_pa))]
pub(crate) fn restore_law(
    text: &Bound<'_, PyString>,
    reference_pa: Option<f64>,
) -> PyResult<PyLaw> {
    PyLaw::new(text.as_any(), reference_pa)
}

/// Every named law of a scenario, closures counted from the static pressure where it is needed.
#[pyfunction]
pub(crate) fn laws<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let PyScenario { document, scenario } = PyScenario::of(scenario, None)?;
    let of_scenario = move |_: &_| {
        let all = ScenarioLaws::of(&scenario, document.folder())?;
        Ok::<_, SimulationError>((all.built()?, all.laws))
    };
    let (found, laws) =
        background::run(py, None, of_scenario)?.map_err(|error| exception::of_study(py, &error))?;
    let dict = PyDict::new(py);
    for one in found {
        let Some(spec) = laws.get(&one.name) else { continue };
        let spec = resolved(spec, &laws, MAX_SERIES_DEPTH);
        let reference_pa = (one.static_pressure_pa > 0.0).then_some(one.static_pressure_pa);
        dict.set_item(one.name, PyLaw { spec, reference_pa, law: one.law })?;
    }
    Ok(dict)
}

/// A law whose inner laws are written in place.
fn resolved(spec: &LawSpec, laws: &Laws, depth: usize) -> LawSpec {
    let in_place = |inner: &LawRef| match laws.resolve(inner) {
        Some(spec) => resolved(spec, laws, depth - 1).into(),
        None => inner.clone(),
    };
    match spec {
        LawSpec::InSeries(series) if depth > 0 => LawSpec::InSeries(InSeriesSpec {
            law: series.law.as_ref().map(in_place),
            laws: series.laws.iter().map(in_place).collect(),
            stiffness_pa_per_m: series.stiffness_pa_per_m,
        }),
        other => other.clone(),
    }
}

/// Columns of the table of every named law of a scenario, and the figure of all.
#[pyfunction]
pub(crate) fn tabulate<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyDict>, Option<PyFigure>)> {
    let PyScenario { document, scenario } = PyScenario::of(scenario, None)?;
    let of_scenario = move |_: &_| ScenarioLaws::of(&scenario, document.folder())?.tables();
    let tables =
        background::run(py, None, of_scenario)?.map_err(|error| exception::of_study(py, &error))?;
    let figure = (!tables.is_empty()).then(|| PyFigure::from(asperity_plot::laws(&tables)));
    let dict = PyDict::new(py);
    for table in &tables {
        let columns = law_columns(table).map(|(name, values)| (name, values.to_vec()));
        dict.set_item(&table.name, columns::to_dict(py, columns)?)?;
    }
    Ok((dict, figure))
}

/// Coefficient, exponent, scatter and standard errors of the power law through points.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "a tuple of numbers")]
pub(crate) fn fit_power(
    pressure: Vec<f64>,
    stiffness: Vec<f64>,
) -> PyResult<(f64, f64, f64, Option<(f64, f64)>)> {
    let points: Vec<(f64, f64)> = pressure.into_iter().zip(stiffness).collect();
    let found = fit(&points).map_err(|error| in_words(&error))?;
    let errors = found.errors.map(|errors| (errors.log_coefficient, errors.exponent));
    Ok((found.coefficient, found.exponent, found.residual_log_rms, errors))
}

fn in_words(error: &LawError) -> PyErr {
    match error {
        LawError::UnknownLaw { name, .. } => PyValueError::new_err(format!(
            "the inner law {name:?} is a name of a scenario; write the law in place"
        )),
        other => PyValueError::new_err(other.to_string()),
    }
}
