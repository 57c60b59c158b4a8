//! Result of an analysis, and its tables: `hits.csv`, `frf.csv` and `backbone.csv`.

use asperity_signal::{BackbonePoint, BackboneUncertainty, ResponseKind};
use asperity_table::{CsvWriter, columns_to_csv};

use crate::average::AveragedFrf;
use crate::curve::HitCurve;
use crate::frf_record::HitFrf;
use crate::modes::{Mode, ModeAtResponse};
use crate::report::{AnalysisReport, HitReport};

/// Result of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Each response, in the order asked for; one at least.
    pub responses: Vec<ResponseAnalysis>,
    /// Modes in the band, by frequency.
    pub modes: Vec<Mode>,
}

/// Result of an analysis for one response.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseAnalysis {
    /// Content of `analysis.json`.
    pub report: AnalysisReport,
    /// Averaged frequency response function.
    pub average: AveragedFrf,
    /// Backbones of the averaged hits.
    pub backbones: Vec<HitBackbone>,
    /// Curves of some hits, to be drawn.
    pub curves: Vec<HitCurve>,
    /// Functions of the averaged hits, where they were to be kept.
    pub frfs: Vec<HitFrf>,
    /// Measured quantity of the response.
    pub response: ResponseKind,
}

/// Backbone of one hit: frequency and damping along its decay.
#[derive(Debug, Clone, PartialEq)]
pub struct HitBackbone {
    /// Number of the hit, from 1.
    pub index: usize,
    /// Largest force \[N\].
    pub force_peak_n: f64,
    /// Points in the order of time; amplitudes are displacements \[m\].
    pub points: Vec<BackbonePoint>,
    /// Their standard deviations due to noise.
    pub uncertainties: Vec<BackboneUncertainty>,
}

impl Analysis {
    /// Joins the results of the responses. The first report names the others and has the modes.
    pub(crate) fn new(mut responses: Vec<ResponseAnalysis>, modes: Vec<Mode>) -> Self {
        let others: Vec<String> =
            responses.iter().skip(1).map(|other| other.name().to_owned()).collect();
        if let Some(first) = responses.first_mut() {
            first.report.other_responses = others;
            first.report.modes.clone_from(&modes);
        }
        Self { responses, modes }
    }

    /// Table `modes.csv`: a row for each mode and response.
    pub fn modes_csv(&self) -> String {
        type Column = (&'static str, fn(&ModeAtResponse) -> Option<f64>);
        let columns: [Column; 10] = [
            ("hits", |at| Some(at.hits as f64)),
            ("peak_frequency_hz", |at| Some(at.peak_frequency_hz)),
            ("natural_frequency_hz", |at| Some(at.natural_frequency_hz)),
            ("natural_frequency_uncertainty_hz", |at| at.natural_frequency_uncertainty_hz),
            ("damping_ratio", |at| Some(at.damping_ratio)),
            ("damping_ratio_uncertainty", |at| at.damping_ratio_uncertainty),
            ("modal_constant_real_per_kg", |at| Some(at.modal_constant_per_kg[0])),
            ("modal_constant_imag_per_kg", |at| Some(at.modal_constant_per_kg[1])),
            ("modal_constant_uncertainty_per_kg", |at| at.modal_constant_uncertainty_per_kg),
            ("phase_deg", |at| Some(at.phase_deg)),
        ];
        let names = columns.iter().map(|column| column.0);
        let mut csv = CsvWriter::with_header(["mode", "response"].into_iter().chain(names));
        for mode in &self.modes {
            for at in &mode.responses {
                let numbers = columns.iter().map(|column| (column.1)(at));
                csv.text(&mode.number.to_string()).text(&at.response).numbers(numbers).end_row();
            }
        }
        csv.into_string()
    }
}

impl ResponseAnalysis {
    /// Name of the channel of the response.
    pub fn name(&self) -> &str {
        self.report.channels.last().map_or("", |channel| channel.name.as_str())
    }

    /// Table `hits.csv`: a row for each hit. Flags are 0 and 1.
    pub fn hits_csv(&self) -> String {
        type Column = (&'static str, fn(&HitReport) -> Option<f64>);
        let columns: [Column; 25] = [
            ("index", |hit| Some(hit.index as f64)),
            ("record", |hit| Some(hit.record as f64)),
            ("time_s", |hit| Some(hit.time_s)),
            ("force_peak_n", |hit| hit.force_peak_n),
            ("impulse_ns", |hit| hit.impulse_ns),
            ("pulse_width_s", |hit| hit.pulse_width_s),
            ("double_hit", |hit| Some(flag(hit.double_hit))),
            ("overload", |hit| Some(flag(hit.overload))),
            ("dropout", |hit| Some(flag(hit.dropout))),
            ("averaged", |hit| Some(flag(hit.averaged))),
            ("frequency_hz", |hit| Some(hit.fundamental?.frequency_hz)),
            ("magnitude_m_per_n", |hit| Some(hit.fundamental?.magnitude)),
            ("damping_ratio", |hit| hit.fundamental?.damping_ratio),
            ("damping_ratio_circle", |hit| hit.fundamental?.damping_ratio_circle),
            ("damping_ratio_decrement", |hit| hit.fundamental?.damping_ratio_decrement),
            ("frequency_uncertainty_hz", |hit| hit.fundamental?.frequency_uncertainty_hz),
            ("magnitude_uncertainty_m_per_n", |hit| hit.fundamental?.magnitude_uncertainty),
            ("damping_ratio_uncertainty", |hit| hit.fundamental?.damping_ratio_uncertainty),
            ("damping_ratio_circle_uncertainty", |hit| {
                hit.fundamental?.damping_ratio_circle_uncertainty
            }),
            ("damping_ratio_decrement_uncertainty", |hit| {
                hit.fundamental?.damping_ratio_decrement_uncertainty
            }),
            ("response_end_s", |hit| hit.response_end_s),
            ("second_frequency_hz", |hit| Some(hit.second_harmonic?.frequency_hz)),
            ("second_magnitude_m_per_n", |hit| Some(hit.second_harmonic?.magnitude)),
            ("harmonic_ratio", |hit| hit.harmonic_ratio),
            ("harmonic_ratio_uncertainty", |hit| hit.harmonic_ratio_uncertainty),
        ];
        let names = columns.iter().map(|column| column.0);
        let mut csv =
            CsvWriter::with_header(std::iter::once("file").chain(names).chain(["verdicts"]));
        for hit in &self.report.hits {
            let numbers = columns.iter().map(|column| (column.1)(hit));
            csv.text(&hit.file).numbers(numbers).text(&hit.issues.join("; ")).end_row();
        }
        csv.into_string()
    }

    /// Table `frf.csv`: a row for each frequency. The coherence is empty for one hit; `valid` is 0
    /// or 1.
    pub fn frf_csv(&self) -> String {
        let average = &self.average;
        let values = &average.frf.values;
        let real: Vec<f64> = values.iter().map(|value| value.re).collect();
        let imag: Vec<f64> = values.iter().map(|value| value.im).collect();
        let none = || vec![f64::NAN; values.len()];
        let coherence = average.coherence.clone().unwrap_or_else(none);
        let valid: Vec<f64> = average.valid.iter().copied().map(flag).collect();
        columns_to_csv([
            ("frequency_hz", &average.frf.frequency_hz),
            ("real", &real),
            ("imag", &imag),
            ("magnitude", &average.frf.magnitude()),
            ("phase_rad", &average.frf.phase()),
            ("coherence", &coherence),
            ("valid", &valid),
        ])
    }

    /// Table `backbone.csv`: a row for each point of each backbone.
    pub fn backbone_csv(&self) -> String {
        let rows = || self.backbones.iter().flat_map(|of| of.points.iter().map(move |p| (of, p)));
        let column = |value: fn(&BackbonePoint) -> f64| -> Vec<f64> {
            rows().map(|(_, point)| value(point)).collect()
        };
        let noise = |value: fn(&BackboneUncertainty) -> f64| -> Vec<f64> {
            self.backbones.iter().flat_map(|of| of.uncertainties.iter().map(value)).collect()
        };
        columns_to_csv([
            ("index", &rows().map(|(of, _)| of.index as f64).collect::<Vec<_>>()),
            ("force_peak_n", &rows().map(|(of, _)| of.force_peak_n).collect::<Vec<_>>()),
            ("time_s", &column(|point| point.time_s)),
            ("amplitude_m", &column(|point| point.amplitude)),
            ("frequency_hz", &column(|point| point.frequency_hz)),
            ("decay_rate_per_s", &column(|point| point.decay_rate)),
            ("damping_ratio", &column(|point| point.damping_ratio)),
            ("relative_amplitude_uncertainty", &noise(|sigma| sigma.relative_amplitude)),
            ("frequency_uncertainty_hz", &noise(|sigma| sigma.frequency_hz)),
            ("damping_ratio_uncertainty", &noise(|sigma| sigma.damping_ratio)),
        ])
    }
}

/// A flag in a table.
fn flag(flag: bool) -> f64 {
    f64::from(u8::from(flag))
}
