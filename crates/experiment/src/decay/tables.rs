//! Tables `decays.csv` and `backbone.csv`.

use asperity_signal::DecayPoint;
use asperity_table::DataTable;

use super::report::{DecayCurveReport, MeasuredDecay};
use super::{DecayAnalysis, DecayCurve};

impl DecayAnalysis {
    /// Table `decays.csv`: a row for each decay, band and response.
    pub fn decays_table(&self) -> DataTable {
        type Column = (&'static str, fn(&DecayCurveReport) -> Option<f64>);
        let columns: [Column; 20] = [
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
        let decays = &self.report.decays;
        let rows =
            || decays.iter().flat_map(|decay| decay.responses.iter().map(move |of| (decay, of)));
        let warnings = |(decay, of): (&MeasuredDecay, &DecayCurveReport)| {
            let all = of.warnings.iter().chain(&decay.warnings);
            all.map(String::as_str).collect::<Vec<_>>().join("; ")
        };
        let table = DataTable::new()
            .counts("index", rows().map(|(_, of)| of.index))
            .counts("decay", rows().map(|(decay, _)| decay.index))
            .texts("file", rows().map(|(decay, _)| &decay.file))
            .counts("record", rows().map(|(decay, _)| decay.record))
            .texts("origin", rows().map(|(decay, _)| decay.origin))
            .texts("response", rows().map(|(_, of)| &of.response))
            .texts("unit", rows().map(|(_, of)| &of.unit))
            .numbers("start_s", rows().map(|(_, of)| of.start_s))
            .numbers("length_s", rows().map(|(_, of)| of.length_s))
            .flags("reaches_noise", rows().map(|(_, of)| of.reaches_noise));
        columns
            .into_iter()
            .fold(table, |table, (name, value)| {
                table.numbers(name, rows().map(|(_, of)| value(of)))
            })
            .texts("warnings", rows().map(warnings))
    }

    /// Table `backbone.csv`: a row for each point. Times are on the time axis of the record.
    pub fn backbone_table(&self) -> DataTable {
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
        let rows = || self.curves.iter().flat_map(|of| of.points.iter().map(move |one| (of, one)));
        let table = DataTable::new()
            .counts("index", rows().map(|(of, _)| of.index))
            .counts("decay", rows().map(|(of, _)| of.decay))
            .texts("response", rows().map(|(of, _)| &of.response))
            .texts("unit", rows().map(|(of, _)| &of.unit));
        columns.into_iter().fold(table, |table, (name, value)| {
            table.numbers(name, rows().map(|(of, one)| value(of, one)))
        })
    }
}
