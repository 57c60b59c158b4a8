//! Hits of a record, the pulse of their force, and their quality.

use asperity_signal::{
    HitChannel, HitLength, HitOptions, HitRecord, Pulse, QualityIssue, QualityOptions,
    TriggerLevel, find_hits as found_hits, quality_issues as issues_of,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use super::{Array, copied, not_accepted};
use crate::exception;

/// Hits as dicts, and trigger level, noise and largest force \[N\].
#[pyfunction]
#[pyo3(signature = (
    force, responses, sample_rate_hz, level, level_of, pre_trigger, length, until_next, hold_off
))]
#[expect(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub(crate) fn find_hits<'py>(
    py: Python<'py>,
    force: Array<'py>,
    responses: Vec<Array<'py>>,
    sample_rate_hz: f64,
    level: f64,
    level_of: &str,
    pre_trigger: usize,
    length: usize,
    until_next: bool,
    hold_off: usize,
) -> PyResult<(Bound<'py, PyList>, (f64, f64, f64))> {
    let trigger_level = match level_of {
        "automatic" => TriggerLevel::Automatic,
        "force" => TriggerLevel::Absolute(level),
        "largest" => TriggerLevel::Fraction(level),
        other => return Err(not_accepted("level_of", other, &["automatic", "force", "largest"])),
    };
    let length = if until_next {
        HitLength::UntilNext { limit: length }
    } else {
        HitLength::Samples(length)
    };
    let options = HitOptions { trigger_level, pre_trigger, length, hold_off };
    let force = copied(&force)?;
    let responses = responses.iter().map(copied).collect::<PyResult<Vec<_>>>()?;
    let found = py.detach(|| {
        let responses: Vec<&[f64]> = responses.iter().map(Vec::as_slice).collect();
        found_hits(&force, &responses, sample_rate_hz, &options)
    });
    let (hits, trigger) = found.map_err(|error| exception::of_signal(&error))?;
    let list = PyList::empty(py);
    for hit in hits {
        let dict = PyDict::new(py);
        dict.set_item("start", hit.start)?;
        dict.set_item("trigger", hit.trigger)?;
        dict.set_item("missing", hit.missing)?;
        dict.set_item("force", PyArray1::from_vec(py, hit.force))?;
        let responses = hit.responses.into_iter().map(|samples| PyArray1::from_vec(py, samples));
        dict.set_item("responses", responses.collect::<Vec<_>>())?;
        list.append(dict)?;
    }
    Ok((list, (trigger.level_n, trigger.noise_n, trigger.largest_n)))
}

/// Quality issues as dicts.
#[pyfunction]
#[pyo3(signature = (
    force, responses, sample_rate_hz, missing, second_fraction, full_scale_n, full_scale_response,
    undecayed_ratio
))]
#[expect(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub(crate) fn quality_issues<'py>(
    py: Python<'py>,
    force: Array<'py>,
    responses: Vec<Array<'py>>,
    sample_rate_hz: f64,
    missing: usize,
    second_fraction: f64,
    full_scale_n: Option<f64>,
    full_scale_response: Option<f64>,
    undecayed_ratio: f64,
) -> PyResult<Bound<'py, PyList>> {
    let hit = HitRecord {
        start: 0,
        trigger: 0,
        force: copied(&force)?,
        responses: responses.iter().map(copied).collect::<PyResult<_>>()?,
        sample_rate_hz,
        missing,
    };
    let options = QualityOptions {
        second_fraction,
        full_scale_n,
        full_scale_response,
        undecayed_ratio,
        ..QualityOptions::default()
    };
    let issues = py.detach(|| issues_of(&hit, &options));
    let list = PyList::empty(py);
    for issue in issues {
        let (kind, channel, time_s) = parts(&issue);
        let dict = PyDict::new(py);
        dict.set_item("kind", kind)?;
        dict.set_item("text", issue.to_string())?;
        dict.set_item("is_disqualifying", issue.is_disqualifying())?;
        let channel = match channel {
            Some(HitChannel::Response(number)) => Some(number),
            _ => None,
        };
        dict.set_item("response", channel)?;
        dict.set_item("time_s", time_s)?;
        list.append(dict)?;
    }
    Ok(list)
}

/// Kind, channel and time \[s\] of an issue.
fn parts(issue: &QualityIssue) -> (&'static str, Option<HitChannel>, Option<f64>) {
    match *issue {
        QualityIssue::DoubleHit(double) => ("double hit", None, Some(double.second_s)),
        QualityIssue::Overload { channel, time_s, .. } => ("overload", Some(channel), Some(time_s)),
        QualityIssue::Clipped { channel, time_s, .. } => ("clipped", Some(channel), Some(time_s)),
        QualityIssue::Dropout { channel, time_s, .. } => ("dropout", Some(channel), Some(time_s)),
        QualityIssue::NotFinite { channel, time_s, .. } => {
            ("not finite", Some(channel), Some(time_s))
        }
        QualityIssue::Truncated { .. } => ("truncated", None, None),
        QualityIssue::NotDecayed { channel, .. } => ("not decayed", Some(channel), None),
        _ => ("other", None, None),
    }
}

/// The pulse of a force as a dict; None without one.
#[pyfunction]
pub(crate) fn pulse<'py>(
    py: Python<'py>,
    force: Array<'py>,
    sample_rate_hz: f64,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let force = copied(&force)?;
    let Some(pulse) = py.detach(|| Pulse::of(&force, sample_rate_hz)) else { return Ok(None) };
    let dict = PyDict::new(py);
    dict.set_item("force_peak_n", pulse.refined_peak_n)?;
    dict.set_item("peak_time_s", pulse.peak_time_s)?;
    dict.set_item("impulse_ns", pulse.impulse_n_s)?;
    dict.set_item("pulse_width_s", pulse.width_s)?;
    dict.set_item("begin_s", pulse.base_s.0)?;
    dict.set_item("end_s", pulse.base_s.1)?;
    Ok(Some(dict))
}
