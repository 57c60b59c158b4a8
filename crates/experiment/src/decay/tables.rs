//! Tables `decays.csv` and `backbone.csv`.

use asperity_signal::DecayPoint;
use asperity_table::CsvWriter;

use super::report::{DecayCurveReport, MeasuredDecay};
use super::{DecayAnalysis, DecayCurve};

impl DecayAnalysis {
    /// Table `decays.csv`: a row for each decay, band and response.
    pub fn decays_csv(&self) -> String {
        type Column = (&'static str, fn(&DecayCurveReport) -> Option<f64>);
        let columns: [Column; 23] = [
            ("start_s", |of| Some(of.start_s)),
            ("length_s", |of| Some(of.length_s)),
            ("reaches_noise", |of| Some(f64::from(u8::from(of.reaches_noise)))),
            ("frequency_hz", |of| Some(of.mean?.frequency_hz)),
            ("frequency_uncertainty_hz", |of| Some(of.mean?.frequency_uncertainty_hz)),
            ("damping_ratio", |of| Some(of.mean?.damping_ratio)),
            ("damping_ratio_uncertainty", |of| Some(of.mean?.damping_ratio_uncertainty)),
            ("largest_amplitude", |of| Some(of.largest?.amplitude)),
            ("largest_amplitude_m", |of| of.largest?.amplitude_m),
            ("largest_frequency_hz", |of| Some(of.largest?.frequency_hz)),
            ("largest_damping_ratio", |of| Some(of.largest?.damping_ratio)),
            ("smallest_amplitude", |of| Some(of.smallest?.amplitude)),
            ("smallest_amplitude_m", |of| of.smallest?.amplitude_m),
            ("smallest_frequency_hz", |of| Some(of.smallest?.frequency_hz)),
            ("smallest_damping_ratio", |of| Some(of.smallest?.damping_ratio)),
            ("second_harmonic_ratio", |of| Some(of.second_harmonic?.ratio)),
            ("second_harmonic_ratio_uncertainty", |of| Some(of.second_harmonic?.ratio_uncertainty)),
            ("second_harmonic_phase_drift_rad", |of| of.second_harmonic?.phase_drift_rad),
            ("second_harmonic_exponent", |of| of.second_harmonic?.amplitude_exponent),
            ("third_harmonic_ratio", |of| Some(of.third_harmonic?.ratio)),
            ("third_harmonic_ratio_uncertainty", |of| Some(of.third_harmonic?.ratio_uncertainty)),
            ("noise_density", |of| Some(of.noise_density)),
            ("floor", |of| Some(of.floor)),
        ];
        let begin = ["index", "decay", "file", "record", "origin", "response", "unit"];
        let names = columns.iter().map(|column| column.0);
        let mut csv = CsvWriter::with_header(begin.into_iter().chain(names).chain(["warnings"]));
        let rows = |decay: &'_ MeasuredDecay| decay.responses.len();
        for decay in self.report.decays.iter().filter(|decay| rows(decay) > 0) {
            for of in &decay.responses {
                csv.number(of.index as f64).number(decay.index as f64).text(&decay.file);
                csv.number(decay.record as f64).text(decay.origin).text(&of.response);
                csv.text(&of.unit).numbers(columns.iter().map(|column| (column.1)(of)));
                let all: Vec<&str> =
                    of.warnings.iter().chain(&decay.warnings).map(String::as_str).collect();
                csv.text(&all.join("; ")).end_row();
            }
        }
        csv.into_string()
    }

    /// Table `backbone.csv`: a row for each point. Times are on the time axis of the record.
    pub fn backbone_csv(&self) -> String {
        type Column = (&'static str, fn(&DecayCurve, &DecayPoint) -> Option<f64>);
        let columns: [Column; 13] = [
            ("time_s", |of, one| Some(of.start_s + one.point.time_s)),
            ("amplitude", |_, one| Some(one.point.amplitude)),
            ("amplitude_m", DecayCurve::amplitude_m),
            ("frequency_hz", |_, one| Some(one.point.frequency_hz)),
            ("decay_rate_per_s", |_, one| Some(one.point.decay_rate)),
            ("damping_ratio", |_, one| Some(one.point.damping_ratio)),
            ("relative_amplitude_uncertainty", |_, one| Some(one.uncertainty.relative_amplitude)),
            ("frequency_uncertainty_hz", |_, one| Some(one.uncertainty.frequency_hz)),
            ("damping_ratio_uncertainty", |_, one| Some(one.uncertainty.damping_ratio)),
            ("second_harmonic_ratio", |_, one| Some(one.harmonics[0]?.ratio)),
            ("second_harmonic_ratio_uncertainty", |_, one| Some(one.harmonics[0]?.uncertainty)),
            ("third_harmonic_ratio", |_, one| Some(one.harmonics[1]?.ratio)),
            ("third_harmonic_ratio_uncertainty", |_, one| Some(one.harmonics[1]?.uncertainty)),
        ];
        let names = columns.iter().map(|column| column.0);
        let mut csv =
            CsvWriter::with_header(["index", "decay", "response", "unit"].into_iter().chain(names));
        for of in &self.curves {
            for one in &of.points {
                csv.number(of.index as f64).number(of.decay as f64);
                csv.text(&of.response).text(&of.unit);
                csv.numbers(columns.iter().map(|column| (column.1)(of, one))).end_row();
            }
        }
        csv.into_string()
    }
}
