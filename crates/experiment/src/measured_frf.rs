//! Frequency response functions from files of other programs.
//!
//! A function of dataset 58 (type 4), or complex samples over frequency in a MAT or NPZ file, with the
//! coherence beside it:
//!
//! ```text
//! std(|H|) / |H| = std(arg H) = sqrt((1 - c) / (2 n c)),    c coherence, n averages
//! ```
//!
//! (Bendat and Piersol, *Random Data*, 4th ed., Wiley 2010, section 9.2), which is also the standard deviation
//! of the real and of the imaginary part over `|H|`.

use std::path::Path;

use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, FrfUnits, Measurement, ReadOptions, Record, Samples, read,
};
use asperity_signal::{Complex64, Frf, FrfForm};

use crate::channel::ChannelSelector;
use crate::error::AnalysisError;
use crate::input_size::{MAX_CONVERTED_BYTES, check_size};
use crate::near_name::nearest;
use crate::stream::measure_error;

/// Role of a channel with a frequency response function, in errors.
pub const FUNCTION_ROLE: &str = "frequency response function";

/// Most names of functions in an error.
const MOST_NAMED: usize = 20;

/// Largest coherence that counts: one less the rounding of single precision.
const MOST_COHERENT: f64 = 1.0 - 1e-7;

/// Options of [`read_frf`].
#[derive(Debug, Clone, Default)]
pub struct FrfOptions {
    /// The function, by its name or `#NUMBER` among the functions of the file, from 1; the only one when
    /// left out.
    pub function: Option<ChannelSelector>,
    /// Unit of the function where the file gives none, such as `m/s^2/N`.
    pub unit: Option<String>,
    /// Number of averages behind the function, for the deviations that follow from the coherence.
    pub averages: Option<usize>,
}

/// A receptance from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredFrf {
    /// Name of the function in the file.
    pub name: String,
    /// Receptance \[m/N\], without zero frequency, over rising frequency.
    pub receptance: Frf,
    /// Coherence at each frequency, if the file has it.
    pub coherence: Option<Vec<f64>>,
    /// Standard deviation of each part \[m/N\], from the coherence and the number of averages; none without
    /// both.
    pub deviation: Option<Vec<f64>>,
}

/// The receptance in the file `file`: its function, in any form and unit of motion over force or force over
/// motion.
///
/// Opposite directions of response and force, as a universal file gives them, change its sign.
///
/// # Errors
/// [`AnalysisError`] for a file that cannot be read or is too large, without a function or with several of which
/// none is chosen, for a unit that is not known and for a unit or a number of averages that is not valid.
///
/// ```
/// use asperity_experiment::{FrfOptions, read_frf};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("frf.unv");
/// # use asperity_measure::*;
/// # let channel = Channel {
/// #     name: "FRF".into(), quantity: ChannelQuantity::Unknown, unit: ChannelUnit::of_text("m/s^2/N"),
/// #     abscissa: Abscissa::Even { start: 100.0, step: 1.0, quantity: ChannelQuantity::Frequency },
/// #     samples: Samples::Complex(vec![Complex64::new(-39.478, 0.0); 3]),
/// #     origin: Origin { frf: FrfUnits::si(ChannelQuantity::Acceleration, ChannelQuantity::Force),
/// #         ..Origin::default() },
/// # };
/// # let record = Record { channels: vec![channel], ..Record::default() };
/// # write(&path, &[record], Format::UniversalBinary, &WriteOptions::default())?;
/// // An accelerance of -39.478 1/kg at 100 Hz.
/// let found = read_frf(&path, &FrfOptions::default())?;
/// assert!((found.receptance.values[0].re - 1e-4).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_frf(file: &Path, options: &FrfOptions) -> Result<MeasuredFrf, AnalysisError> {
    let measured = read_file(file, options)?;
    let functions = functions(&measured);
    let (record, channel) = chosen(file, &functions, options.function.as_ref())?;
    of_channel(file, record, channel, options)
}

/// The receptances of all functions in the file `file`; [`FrfOptions::function`] does not count.
///
/// # Errors
/// As [`read_frf`], and [`AnalysisError`] for a file without a function.
pub fn read_frfs(file: &Path, options: &FrfOptions) -> Result<Vec<MeasuredFrf>, AnalysisError> {
    let measured = read_file(file, options)?;
    let functions = functions(&measured);
    if functions.is_empty() {
        return Err(no_function(file, &functions, None));
    }
    functions.iter().map(|(record, channel)| of_channel(file, record, channel, options)).collect()
}

fn read_file(file: &Path, options: &FrfOptions) -> Result<Measurement, AnalysisError> {
    if options.averages == Some(0) {
        let (name, expected) = ("the number of averages", "1 or more");
        return Err(AnalysisError::Setting { name, found: "0".to_owned(), expected });
    }
    check_size(&[file.to_owned().into()], MAX_CONVERTED_BYTES)?;
    read(file, &ReadOptions::default()).map_err(|error| measure_error(error, file))
}

/// The functions of a file with their records.
fn functions(measured: &Measurement) -> Vec<(&Record, &Channel)> {
    let records = measured.records.iter();
    let channels =
        records.flat_map(|record| record.channels.iter().map(move |channel| (record, channel)));
    channels.filter(|(_, channel)| is_function(channel)).collect()
}

fn of_channel(
    file: &Path,
    record: &Record,
    channel: &Channel,
    options: &FrfOptions,
) -> Result<MeasuredFrf, AnalysisError> {
    let (form, factor) = form_of(file, channel, options.unit.as_deref())?;
    let values = match &channel.samples {
        Samples::Complex(values) => values.as_slice(),
        Samples::Real(_) => &[],
    };
    let sign = opposite(channel);
    let coherence = coherence_of(record, channel);
    let frequency: Vec<f64> =
        (0..values.len()).map(|at| channel.abscissa.at(at).unwrap_or(f64::NAN)).collect();
    let values = values.iter().map(|value| value * (sign * factor)).collect();
    let receptance = Frf { frequency_hz: frequency, values, form }.to(FrfForm::Receptance);
    let mut order: Vec<usize> = (0..receptance.len())
        .filter(|&at| receptance.frequency_hz[at] > 0.0 && receptance.frequency_hz[at].is_finite())
        .collect();
    order.sort_by(|a, b| receptance.frequency_hz[*a].total_cmp(&receptance.frequency_hz[*b]));
    let pick = |all: &[f64]| order.iter().map(|&at| all[at]).collect::<Vec<f64>>();
    let values: Vec<Complex64> = order.iter().map(|&at| receptance.values[at]).collect();
    let coherence = coherence.map(pick);
    let deviation = coherence.as_ref().zip(options.averages).map(|(coherence, averages)| {
        let part = |(value, c): (&Complex64, &f64)| {
            let c = c.clamp(0.0, MOST_COHERENT);
            value.norm() * ((1.0 - c) / (2.0 * averages as f64 * c)).sqrt()
        };
        values.iter().zip(coherence).map(part).collect()
    });
    Ok(MeasuredFrf {
        name: channel.name.clone(),
        receptance: Frf {
            frequency_hz: pick(&receptance.frequency_hz),
            values,
            form: FrfForm::Receptance,
        },
        coherence,
        deviation,
    })
}

/// True for complex samples over frequency.
fn is_function(channel: &Channel) -> bool {
    matches!(channel.samples, Samples::Complex(_))
        && channel.abscissa.quantity() == ChannelQuantity::Frequency
}

fn names(functions: &[(&Record, &Channel)]) -> String {
    let mut names: Vec<String> = functions
        .iter()
        .take(MOST_NAMED)
        .enumerate()
        .map(|(at, (_, channel))| format!("#{} `{}`", at + 1, channel.name.trim()))
        .collect();
    if functions.len() > MOST_NAMED {
        names.push(format!("{} more", functions.len() - MOST_NAMED));
    }
    if names.is_empty() { "no complex samples over frequency".to_owned() } else { names.join(", ") }
}

fn no_function(
    file: &Path,
    functions: &[(&Record, &Channel)],
    wanted: Option<&ChannelSelector>,
) -> AnalysisError {
    let wanted = wanted.map(ToString::to_string).unwrap_or_default();
    let near = nearest(&wanted, functions.iter().map(|(_, channel)| channel.name.as_str()));
    let near = near.map(str::to_owned);
    let (file, channels) = (file.to_owned(), names(functions));
    AnalysisError::NoChannel { file, role: FUNCTION_ROLE, wanted, near, channels }
}

/// The function that is chosen, or the only one.
fn chosen<'a>(
    file: &Path,
    functions: &[(&'a Record, &'a Channel)],
    wanted: Option<&ChannelSelector>,
) -> Result<(&'a Record, &'a Channel), AnalysisError> {
    let fits: Vec<_> = match wanted {
        None => functions.iter().collect(),
        Some(ChannelSelector::Number(number)) => {
            number.checked_sub(1).and_then(|at| functions.get(at)).into_iter().collect()
        }
        Some(ChannelSelector::Name(name)) => {
            functions.iter().filter(|(_, one)| one.name.trim() == name.trim()).collect()
        }
    };
    match fits.as_slice() {
        [only] => Ok(**only),
        [] => Err(no_function(file, functions, wanted)),
        _ => Err(AnalysisError::Ambiguous {
            file: file.to_owned(),
            role: FUNCTION_ROLE,
            wanted: wanted.map(ToString::to_string).unwrap_or_default(),
            channels: names(functions),
        }),
    }
}

/// Form of a function, and the factor of its unit to SI.
fn form_of(
    file: &Path,
    channel: &Channel,
    given: Option<&str>,
) -> Result<(FrfForm, f64), AnalysisError> {
    let units = match given {
        Some(text) => {
            let known = FrfUnits::parse(text).filter(|units| form(units).is_some());
            Some(known.ok_or_else(|| AnalysisError::Setting {
                name: "the unit of the function",
                found: text.to_owned(),
                expected: "a quotient of a motion and a force, such as m/N, m/s^2/N or g/N",
            })?)
        }
        None => channel.origin.frf.or_else(|| FrfUnits::parse(channel.unit.text())),
    };
    let known = units.and_then(|units| {
        Some((form(&units)?, units.response.factor() / units.excitation.factor()))
    });
    known.ok_or_else(|| AnalysisError::unit(file, channel))
}

fn form(units: &FrfUnits) -> Option<FrfForm> {
    use ChannelQuantity::{Acceleration, Displacement, Force, Velocity};
    Some(match (units.response.quantity(), units.excitation.quantity()) {
        (Displacement, Force) => FrfForm::Receptance,
        (Velocity, Force) => FrfForm::Mobility,
        (Acceleration, Force) => FrfForm::Accelerance,
        (Force, Displacement) => FrfForm::DynamicStiffness,
        (Force, Velocity) => FrfForm::MechanicalImpedance,
        (Force, Acceleration) => FrfForm::ApparentMass,
        _ => return None,
    })
}

/// -1 where response and force have opposite directions, else 1.
fn opposite(channel: &Channel) -> f64 {
    let direction = |of: &Option<asperity_measure::DegreeOfFreedom>| {
        of.as_ref().map_or(0, |freedom| freedom.direction.signum())
    };
    let product = direction(&channel.origin.response) * direction(&channel.origin.reference);
    if product < 0 { -1.0 } else { 1.0 }
}

/// The coherence in the record of a function: of the same frequencies, and of the same nodes where several
/// are there.
fn coherence_of<'a>(record: &'a Record, function: &Channel) -> Option<&'a [f64]> {
    let start = |channel: &Channel| channel.abscissa.at(0);
    let fits = |channel: &&Channel| {
        is_coherence(channel)
            && channel.samples.len() == function.samples.len()
            && start(channel) == start(function)
            && same_kind(&channel.abscissa, &function.abscissa)
    };
    let all: Vec<&Channel> = record.channels.iter().filter(fits).collect();
    let nodes =
        |channel: &Channel| (channel.origin.response.clone(), channel.origin.reference.clone());
    let own = all.iter().find(|channel| nodes(channel) == nodes(function));
    let only = if all.len() == 1 { all.first() } else { None };
    own.filter(|_| all.len() > 1).or(only).and_then(|channel| channel.samples.real())
}

fn same_kind(one: &Abscissa, other: &Abscissa) -> bool {
    one.quantity() == other.quantity()
}

/// True for real samples from 0 to 1 that the file or their name calls coherence.
fn is_coherence(channel: &Channel) -> bool {
    let lower = channel.name.to_lowercase();
    let mut words = lower.split(|character: char| !character.is_alphanumeric());
    let is_named = words.any(|word| {
        matches!(word, "coh" | "coherence" | "gamma2" | "kohaerenz" | "kohärenz")
            || word.starts_with("coherence")
    });
    let within = |value: &f64| (-1e-6..=1.0 + 1e-6).contains(value) || value.is_nan();
    (channel.origin.is_coherence || is_named)
        && channel.samples.real().is_some_and(|values| values.iter().all(within))
}

#[cfg(test)]
mod tests {
    use asperity_measure::{ChannelUnit, DegreeOfFreedom, Format, Origin, WriteOptions, write};

    use super::*;

    /// An accelerance in g/N with its coherence, response along -z and force along +z, and another function.
    fn file(folder: &Path) -> std::path::PathBuf {
        let freedom =
            |direction| Some(DegreeOfFreedom { entity: String::new(), node: 1, direction });
        let abscissa =
            Abscissa::Even { start: 0.0, step: 50.0, quantity: ChannelQuantity::Frequency };
        let channel = |name: &str, samples, frf: Option<&str>, response| Channel {
            name: name.to_owned(),
            quantity: ChannelQuantity::Unknown,
            unit: frf.map_or(ChannelUnit::Missing, ChannelUnit::of_text),
            abscissa: abscissa.clone(),
            samples,
            origin: Origin {
                response: freedom(response),
                reference: freedom(3),
                frf: frf.and_then(FrfUnits::parse),
                is_coherence: frf.is_none(),
                ..Origin::default()
            },
        };
        // A receptance of 1e-7 m/N, along +z.
        let value = |k: i32| {
            let omega = std::f64::consts::TAU * 50.0 * f64::from(k);
            Complex64::new(1e-7 * omega * omega / 9.806_65, 0.0)
        };
        let channels = vec![
            channel("point", Samples::Complex((0..5).map(value).collect()), Some("g/N"), -3),
            channel("Kohärenz", Samples::Real(vec![1.0, 0.5, 0.8, 1.0, 0.9]), None, -3),
            channel("transfer", Samples::Complex(vec![Complex64::ONE; 5]), Some("m/s/N"), 1),
        ];
        let path = folder.join("frf.unv");
        let record = Record { channels, ..Record::default() };
        write(&path, &[record], Format::UniversalText, &WriteOptions::default()).unwrap();
        path
    }

    #[test]
    fn a_function_is_a_receptance_with_deviations_from_its_coherence() {
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path());
        let options = |function: &str, averages| FrfOptions {
            function: Some(function.into()),
            averages,
            ..FrfOptions::default()
        };
        let found = read_frf(&path, &options("point", Some(4))).unwrap();
        assert_eq!(found.receptance.frequency_hz, [50.0, 100.0, 150.0, 200.0]);
        for value in &found.receptance.values {
            assert!((value - 1e-7).norm() < 1e-15, "{value}");
        }
        let deviation = found.deviation.unwrap();
        for (deviation, c) in deviation.iter().zip([0.5_f64, 0.8, 1.0 - 1e-7, 0.9]) {
            let expected = 1e-7 * ((1.0 - c) / (8.0 * c)).sqrt();
            assert!((deviation / expected - 1.0).abs() < 1e-6, "{deviation} {expected}");
        }
        assert_eq!(read_frf(&path, &options("point", None)).unwrap().deviation, None);
        assert!(read_frf(&path, &options("#2", Some(0))).is_err());
        let all = read_frfs(&path, &FrfOptions::default()).unwrap();
        assert_eq!(
            all.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(),
            ["point", "transfer"]
        );
        assert_eq!(read_frf(&path, &options("#2", None)).unwrap().name, "transfer");

        let error = read_frf(&path, &FrfOptions::default()).unwrap_err().to_string();
        assert!(error.contains("#1 `point`") && error.contains("#2 `transfer`"), "{error}");
        let error = read_frf(&path, &options("pont", None)).unwrap_err().to_string();
        assert!(error.contains("did you mean") && error.contains("point"), "{error}");
        let wrong = FrfOptions { unit: Some("N".to_owned()), ..options("point", None) };
        let error = read_frf(&path, &wrong).unwrap_err().to_string();
        assert!(error.contains("m/s^2/N"), "{error}");
    }
}
