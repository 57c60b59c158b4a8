//! Channels in arrays as records, and records as channels in arrays.

use std::path::PathBuf;

use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, Format, MeasurementSource, Origin,
    ReadOptions, Record, SampleAxis, Samples, WriteOptions,
};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::signal::not_accepted;
use crate::{background, exception};

/// Name of records in memory, where results and messages name files.
const IN_MEMORY: &str = "arrays";

/// One channel, as `asperity._measurement` prepares it: keys of SEP005, all present.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ArrayChannel<'py> {
    name: String,
    unit_str: String,
    quantity: Option<String>,
    data: PyReadonlyArray1<'py, f64>,
    /// Sample rate \[Hz\].
    fs: Option<f64>,
    /// Times \[s\].
    time: Option<PyReadonlyArray1<'py, f64>>,
    /// Relative rounding of the times.
    rounding: f64,
}

/// Paths, or records in arrays.
#[derive(FromPyObject)]
pub(crate) enum Sources<'py> {
    Files(Vec<PathBuf>),
    Records(Vec<Vec<ArrayChannel<'py>>>),
}

impl Sources<'_> {
    /// Sources of an analysis: the files that the paths name, or the records in memory.
    pub(crate) fn into_sources(self) -> PyResult<Vec<MeasurementSource>> {
        match self {
            Self::Files(paths) => {
                let files = asperity_experiment::input_files(&paths);
                let files = files.map_err(|error| exception::of_analysis(&error))?;
                Ok(files.into_iter().map(Into::into).collect())
            }
            Self::Records(records) => {
                let records = into_records(records)?;
                Ok(vec![MeasurementSource::Records { name: IN_MEMORY.into(), records }])
            }
        }
    }
}

fn into_records(records: Vec<Vec<ArrayChannel<'_>>>) -> PyResult<Vec<Record>> {
    let record = |channels: Vec<ArrayChannel<'_>>| {
        let channels = channels.into_iter().map(ArrayChannel::into_channel);
        Ok(Record { channels: channels.collect::<PyResult<_>>()?, ..Record::default() })
    };
    records.into_iter().map(record).collect()
}

impl ArrayChannel<'_> {
    fn into_channel(self) -> PyResult<Channel> {
        let times = self.time.map(|times| times.as_slice().map(<[f64]>::to_vec)).transpose()?;
        let abscissa = match (self.fs, times) {
            (Some(rate), times) => {
                let start = times.and_then(|times| times.first().copied()).unwrap_or(0.0);
                Abscissa::even_time(start, rate)
            }
            (None, Some(times)) => Abscissa::of_times(times, self.rounding),
            (None, None) => {
                let name = self.name;
                let text = format!("channel {name:?} has no sample rate and no times");
                return Err(PyValueError::new_err(text));
            }
        };
        Ok(Channel {
            quantity: self.quantity.as_deref().map_or(ChannelQuantity::Unknown, of_letter),
            unit: ChannelUnit::of_text(&self.unit_str),
            name: self.name,
            abscissa,
            samples: Samples::Real(self.data.as_slice()?.to_vec()),
            origin: Origin::default(),
        })
    }
}

/// Letters of the quantities of SEP005.
const LETTERS: [(&str, ChannelQuantity); 6] = [
    ("f", ChannelQuantity::Force),
    ("a", ChannelQuantity::Acceleration),
    ("v", ChannelQuantity::Velocity),
    ("d", ChannelQuantity::Displacement),
    ("e", ChannelQuantity::Strain),
    ("s", ChannelQuantity::Pressure),
];

fn of_letter(letter: &str) -> ChannelQuantity {
    let found = LETTERS.iter().find(|(known, _)| *known == letter);
    found.map_or(ChannelQuantity::Unknown, |(_, quantity)| *quantity)
}

/// Properties that files do not give.
///
/// # Errors
/// ValueError for a sample axis that is neither `first` nor `last`.
pub(crate) fn read_options(
    sample_rate_hz: Option<f64>,
    names: Vec<String>,
    units: Vec<String>,
    sample_axis: Option<&str>,
    default: &ReadOptions,
) -> PyResult<ReadOptions> {
    let sample_axis = match sample_axis {
        None => default.sample_axis,
        Some("first") => Some(SampleAxis::First),
        Some("last") => Some(SampleAxis::Last),
        Some(other) => {
            let text = format!("sample_axis is {other:?}; accepted: \"first\", \"last\"");
            return Err(PyValueError::new_err(text));
        }
    };
    let or = |given: Vec<String>, known: &[String]| {
        if given.is_empty() { known.to_vec() } else { given }
    };
    Ok(ReadOptions {
        sample_rate_hz: sample_rate_hz.or(default.sample_rate_hz),
        sample_axis,
        names: or(names, &default.names),
        units: or(units, &default.units),
        ..default.clone()
    })
}

/// Records over time of some files, and the notices of their readers: each record a list of channels
/// with the keys of SEP005.
#[pyfunction]
#[pyo3(signature = (paths, sample_rate_hz, names, units, sample_axis, si, progress))]
#[expect(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub(crate) fn read<'py>(
    py: Python<'py>,
    paths: Vec<PathBuf>,
    sample_rate_hz: Option<f64>,
    names: Vec<String>,
    units: Vec<String>,
    sample_axis: Option<&str>,
    si: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyList>, Vec<String>)> {
    let sources = Sources::Files(paths).into_sources()?;
    let options = read_options(sample_rate_hz, names, units, sample_axis, &ReadOptions::default())?;
    let read = background::run(py, progress, move |progress| {
        let (mut records, mut notices) = (Vec::new(), Vec::new());
        for (number, source) in sources.iter().enumerate() {
            let mut measured = source.read(&options)?;
            let channels = measured.records.iter_mut().flat_map(|record| &mut record.channels);
            for channel in channels.filter(|channel| si && channel.unit.known().is_some()) {
                channel.to_si()?;
            }
            let name = source.name().display();
            notices.extend(measured.notices.iter().map(|notice| format!("{name}: {notice}")));
            records.append(&mut measured.records);
            progress.report((number + 1) as f64 / sources.len() as f64);
        }
        Ok((records, notices))
    })?;
    let (records, notices) = read.map_err(|error| exception::of_measure(&error))?;
    let list = PyList::empty(py);
    for record in records {
        let channels = PyList::empty(py);
        for channel in record.channels {
            if let Some(dict) = to_dict(py, channel)? {
                channels.append(dict)?;
            }
        }
        if !channels.is_empty() {
            list.append(channels)?;
        }
    }
    Ok((list, notices))
}

/// Writes records to a file, in the format of its name or in `format`.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    path: PathBuf,
    records: Vec<Vec<ArrayChannel<'_>>>,
    format: Option<&str>,
    title: String,
    overwrite: bool,
) -> PyResult<()> {
    const ACCEPTED: [(&str, Format); 4] = [
        ("uff", Format::UniversalBinary),
        ("uff-ascii", Format::UniversalText),
        ("csv", Format::Text),
        ("npz", Format::Npz),
    ];
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let found = match format {
        Some(name) => ACCEPTED.iter().find(|(known, _)| *known == name).map(|(_, format)| *format),
        None => extension.as_deref().and_then(Format::of_extension),
    };
    let Some(format) = found else {
        let name = format.map_or_else(|| path.display().to_string(), str::to_owned);
        let accepted = ACCEPTED.map(|(name, _)| name);
        return Err(not_accepted("format", &name, &accepted));
    };
    let records = into_records(records)?;
    let options = WriteOptions { title, replace: overwrite, ..WriteOptions::default() };
    let written = py.detach(|| asperity_measure::write(&path, &records, format, &options));
    written.map_err(|error| exception::of_measure(&error))
}

/// A channel with the keys of SEP005; `None` for one that is not real or not over time.
fn to_dict(py: Python<'_>, channel: Channel) -> PyResult<Option<Bound<'_, PyDict>>> {
    let Samples::Real(samples) = channel.samples else { return Ok(None) };
    let letter = LETTERS.iter().find(|(_, known)| *known == channel.quantity);
    let dict = PyDict::new(py);
    dict.set_item("name", channel.name)?;
    dict.set_item("unit_str", channel.unit.text())?;
    if let Some((letter, _)) = letter {
        dict.set_item("quantity", letter)?;
    }
    match channel.abscissa {
        Abscissa::Even { start, quantity: ChannelQuantity::Time, .. } => {
            let rate = channel.abscissa.sample_rate_hz();
            dict.set_item("fs", rate)?;
            if start != 0.0 {
                let times = (0..samples.len()).map(|n| start + n as f64 / rate.unwrap_or(f64::NAN));
                dict.set_item("time", times.collect::<Vec<f64>>())?;
            }
        }
        Abscissa::Uneven { values, quantity: ChannelQuantity::Time } => {
            dict.set_item("time", values)?;
        }
        _ => return Ok(None),
    }
    dict.set_item("data", PyArray1::from_vec(py, samples))?;
    Ok(Some(dict))
}

/// Sample rate \[Hz\] of times \[s\]; None for uneven ones.
#[pyfunction]
pub(crate) fn even_rate(time_s: PyReadonlyArray1<'_, f64>) -> PyResult<Option<f64>> {
    let times = time_s.as_slice()?.to_vec();
    Ok(Abscissa::of_times(times, f64::EPSILON).sample_rate_hz())
}
