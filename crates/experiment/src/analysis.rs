//! Result of an analysis, and its tables: `hits.csv`, `frf.csv` and `backbone.csv`.

use asperity_signal::{BackbonePoint, BackboneUncertainty, Frf, ResponseKind};
use asperity_table::DataTable;

use crate::average::AveragedFrf;
use crate::curve::HitCurve;
use crate::hit_report::HitReport;
use crate::modes::{Mode, ModeAtResponse};
use crate::report::AnalysisReport;

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

/// Frequency response function of one hit.
#[derive(Debug, Clone, PartialEq)]
pub struct HitFrf {
    /// Number of the hit, from 1.
    pub index: usize,
    /// Peak force \[N\].
    pub force_peak_n: f64,
    /// Function in the requested form, corrected for an exponential window.
    pub frf: Frf,
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
    pub fn modes_table(&self) -> DataTable {
        type Column = (&'static str, fn(&ModeAtResponse) -> Option<f64>);
        let columns: [Column; 10] = [
            ("peak_frequency_hz", |at| Some(at.peak_frequency_hz)),
            ("natural_frequency_hz", |at| Some(at.natural_frequency_hz)),
            ("natural_frequency_uncertainty_hz", |at| at.natural_frequency_uncertainty_hz),
            ("damping_ratio", |at| Some(at.damping_ratio)),
            ("damping_ratio_uncertainty", |at| at.damping_ratio_uncertainty),
            ("modal_constant_real_per_kg", |at| Some(at.modal_constant_per_kg[0])),
            ("modal_constant_imag_per_kg", |at| Some(at.modal_constant_per_kg[1])),
            ("modal_constant_uncertainty_per_kg", |at| at.modal_constant_uncertainty_per_kg),
            ("phase_deg", |at| Some(at.phase_deg)),
            ("frequency_change_hz", |at| at.frequency_change_hz),
        ];
        let rows =
            || self.modes.iter().flat_map(|mode| mode.responses.iter().map(move |at| (mode, at)));
        let table = DataTable::new()
            .counts("mode", rows().map(|(mode, _)| mode.number))
            .texts("response", rows().map(|(_, at)| &at.response))
            .counts("hits", rows().map(|(_, at)| at.hits));
        columns.into_iter().fold(table, |table, (name, value)| {
            table.numbers(name, rows().map(|(_, at)| value(at)))
        })
    }
}

impl ResponseAnalysis {
    /// Name of the channel of the response.
    pub fn name(&self) -> &str {
        self.report.channels.last().map_or("", |channel| channel.name.as_str())
    }

    /// Table `hits.csv`: a row for each hit.
    pub fn hits_table(&self) -> DataTable {
        type Column = (&'static str, fn(&HitReport) -> Option<f64>);
        let of_pulse: [Column; 4] = [
            ("time_s", |hit| Some(hit.time_s)),
            ("force_peak_n", |hit| hit.force_peak_n),
            ("impulse_ns", |hit| hit.impulse_ns),
            ("pulse_width_s", |hit| hit.pulse_width_s),
        ];
        let of_response: [Column; 15] = [
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
        let hits = &self.report.hits;
        let with =
            |table: DataTable, (name, value): Column| table.numbers(name, hits.iter().map(value));
        let table = DataTable::new()
            .texts("file", hits.iter().map(|hit| &hit.file))
            .counts("index", hits.iter().map(|hit| hit.index))
            .counts("record", hits.iter().map(|hit| hit.record));
        let table = of_pulse
            .into_iter()
            .fold(table, with)
            .flags("double_hit", hits.iter().map(|hit| hit.double_hit))
            .flags("overload", hits.iter().map(|hit| hit.overload))
            .flags("dropout", hits.iter().map(|hit| hit.dropout))
            .flags("averaged", hits.iter().map(|hit| hit.averaged));
        of_response
            .into_iter()
            .fold(table, with)
            .texts("verdicts", hits.iter().map(|hit| hit.issues.join("; ")))
    }

    /// Table `frf.csv`: a row for each frequency. The coherence is NaN for one hit.
    pub fn frf_table(&self) -> DataTable {
        let average = &self.average;
        let values = &average.frf.values;
        let none = || vec![f64::NAN; values.len()];
        DataTable::new()
            .numbers("frequency_hz", average.frf.frequency_hz.iter().copied())
            .numbers("real", values.iter().map(|value| value.re))
            .numbers("imag", values.iter().map(|value| value.im))
            .numbers("magnitude", average.frf.magnitude())
            .numbers("phase_rad", average.frf.phase())
            .numbers("coherence", average.coherence.clone().unwrap_or_else(none))
            .flags("valid", average.valid.iter().copied())
    }

    /// Table `backbone.csv`: a row for each point of each backbone.
    pub fn backbone_table(&self) -> DataTable {
        let rows = || self.backbones.iter().flat_map(|of| of.points.iter().map(move |p| (of, p)));
        let column = |value: fn(&BackbonePoint) -> f64| rows().map(move |(_, point)| value(point));
        let noise = |value: fn(&BackboneUncertainty) -> f64| {
            self.backbones.iter().flat_map(move |of| of.uncertainties.iter().map(value))
        };
        DataTable::new()
            .counts("index", rows().map(|(of, _)| of.index))
            .numbers("force_peak_n", rows().map(|(of, _)| of.force_peak_n))
            .numbers("time_s", column(|point| point.time_s))
            .numbers("amplitude_m", column(|point| point.amplitude))
            .numbers("frequency_hz", column(|point| point.frequency_hz))
            .numbers("decay_rate_per_s", column(|point| point.decay_rate))
            .numbers("damping_ratio", column(|point| point.damping_ratio))
            .numbers("relative_amplitude_uncertainty", noise(|sigma| sigma.relative_amplitude))
            .numbers("frequency_uncertainty_hz", noise(|sigma| sigma.frequency_hz))
            .numbers("damping_ratio_uncertainty", noise(|sigma| sigma.damping_ratio))
    }
}
