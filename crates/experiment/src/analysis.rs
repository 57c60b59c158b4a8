//! Result of an analysis, and its tables: `hits.csv`, `frf.csv` and `backbone.csv`.

use asperity_signal::{BackbonePoint, ResponseKind};
use asperity_table::{CsvWriter, columns_to_csv};

use crate::average::AveragedFrf;
use crate::curve::HitCurve;
use crate::report::{AnalysisReport, HitReport};

/// Result of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Content of `analysis.json`.
    pub report: AnalysisReport,
    /// Averaged frequency response function.
    pub average: AveragedFrf,
    /// Backbones of the averaged hits.
    pub backbones: Vec<HitBackbone>,
    /// Curves of some hits, to be drawn.
    pub curves: Vec<HitCurve>,
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
}

impl Analysis {
    /// Table `hits.csv`: a row for each hit. Flags are 0 and 1.
    pub fn hits_csv(&self) -> String {
        type Column = (&'static str, fn(&HitReport) -> Option<f64>);
        let columns: [Column; 21] = [
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
        columns_to_csv([
            ("index", &rows().map(|(of, _)| of.index as f64).collect::<Vec<_>>()),
            ("force_peak_n", &rows().map(|(of, _)| of.force_peak_n).collect::<Vec<_>>()),
            ("time_s", &column(|point| point.time_s)),
            ("amplitude_m", &column(|point| point.amplitude)),
            ("frequency_hz", &column(|point| point.frequency_hz)),
            ("decay_rate_per_s", &column(|point| point.decay_rate)),
            ("damping_ratio", &column(|point| point.damping_ratio)),
        ])
    }
}

/// A flag in a table.
fn flag(flag: bool) -> f64 {
    f64::from(u8::from(flag))
}
