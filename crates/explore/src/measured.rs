//! Measured hits beside computed ones: points and bars in the figures, and chi-square by feature.

use std::path::{Path, PathBuf};

use asperity_figure::Figure;
use asperity_identify::problem::HitSpec;
use asperity_identify::{IdentificationError, measured_hits};
use asperity_plot::{MagnitudeAxis, measured_frf, measured_levels};
use asperity_scenario::four_digits;
use asperity_simulation::quantity::Quantity;
use asperity_simulation::sweep::{Sweep, Variation};

/// Features of hits, in the order of the figure.
const FEATURES: [Quantity; 3] =
    [Quantity::FundamentalFrequency, Quantity::FundamentalReceptance, Quantity::HarmonicRatio];

/// Most hits whose responses are computed at every change; of more, every so many.
const MOST_HITS: usize = 60;

/// The hits of an analysis.
#[derive(Debug)]
pub(crate) struct Measured {
    pub(crate) path: PathBuf,
    hits: Vec<HitSpec>,
    /// Frequency and magnitude of the averaged receptance, where its table is beside the analysis.
    frf: Option<(Vec<f64>, Vec<f64>)>,
}

impl Measured {
    /// Reads an `analysis.json`, and the `frf.csv` beside it.
    pub(crate) fn read(path: &Path) -> Result<Self, IdentificationError> {
        let hits = measured_hits(path)?;
        Ok(Self { path: path.to_owned(), hits, frf: receptance(path) })
    }

    pub(crate) fn count(&self) -> usize {
        self.hits.len()
    }

    /// Least and greatest force of the hits \[N\].
    pub(crate) fn forces(&self) -> (f64, f64) {
        let forces = self.hits.iter().filter_map(|hit| hit.force_peak_n);
        forces.fold((f64::INFINITY, 0.0), |(low, high), f| (f64::min(low, f), f64::max(high, f)))
    }

    /// The hits in a figure of a sweep over `pointer`.
    pub(crate) fn levels(&self, pointer: &str) -> Figure {
        let columns = FEATURES.map(|quantity| {
            let point = |hit: &HitSpec| {
                let (value, deviation) = hit.features.get(quantity.key())?.parts();
                Some([hit.force_peak_n?, value, deviation.unwrap_or(f64::NAN)])
            };
            (quantity, self.hits.iter().filter_map(point).collect())
        });
        measured_levels(pointer, &columns)
    }

    /// The averaged receptance up to a frequency \[Hz\].
    pub(crate) fn frf(&self, highest: f64, axis: MagnitudeAxis) -> Option<Figure> {
        let (frequency, magnitude) = self.frf.as_ref()?;
        let kept = frequency.partition_point(|hz| *hz <= highest);
        Some(measured_frf(&frequency[..kept], &magnitude[..kept], axis))
    }

    /// The variation of the force over the hits.
    pub(crate) fn variation(&self, pointer: &str) -> Variation {
        let values = self.some().filter_map(|hit| Some(hit.force_peak_n?.to_string())).collect();
        Variation { pointer: pointer.to_owned(), values }
    }

    fn some(&self) -> impl Iterator<Item = &HitSpec> {
        self.hits.iter().step_by(self.hits.len().div_ceil(MOST_HITS).max(1))
    }

    /// Chi-square of each feature, the sum of ((computed - measured) / deviation)^2, with the number of its hits;
    /// `sweep` has a run for each hit of [`variation`](Self::variation).
    pub(crate) fn chi_square(&self, sweep: &Sweep) -> Vec<(Quantity, f64, usize)> {
        let of = |quantity: Quantity| {
            let (mut sum, mut count) = (0.0, 0);
            for (run, hit) in self.some().filter(|hit| hit.force_peak_n.is_some()).enumerate() {
                let measured = hit.features.get(quantity.key()).map(|measured| measured.parts());
                let computed = sweep.number(run, quantity.key()).filter(|value| !value.is_nan());
                if let (Some((value, Some(deviation))), Some(computed)) = (measured, computed) {
                    sum += ((computed - value) / deviation).powi(2);
                    count += 1;
                }
            }
            (quantity, sum, count)
        };
        FEATURES.map(of).into_iter().filter(|(.., count)| *count > 0).collect()
    }

    /// The same in words.
    pub(crate) fn words(&self, sweep: &Sweep) -> String {
        let mut text = String::from("chi-square of the hits, with the pulse of the scenario\n");
        for (quantity, sum, count) in self.chi_square(sweep) {
            let (key, sum) = (quantity.key(), four_digits(sum));
            text.push_str(&[key, ": ", &sum, " of ", &count.to_string(), " hits\n"].concat());
        }
        text
    }
}

/// Frequency and magnitude of the `frf.csv` beside an analysis; none where it is no receptance.
fn receptance(analysis: &Path) -> Option<(Vec<f64>, Vec<f64>)> {
    /// Most bytes of both files.
    const MOST: u64 = 64 << 20;
    let text = asperity_scenario::read_text(analysis, MOST).ok()?;
    let report: serde_json::Value = serde_json::from_str(&text).ok()?;
    if report.pointer("/settings/frf_form")? != "receptance" {
        return None;
    }
    let table = asperity_scenario::read_text(&analysis.with_file_name("frf.csv"), MOST).ok()?;
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next()?.split(',').map(str::trim).collect();
    let place = |name: &str| header.iter().position(|column| *column == name);
    let (x, y) = (place("frequency_hz")?, place("magnitude")?);
    let number = |line: &str, at: usize| line.split(',').nth(at)?.trim().parse::<f64>().ok();
    let pairs = lines.filter_map(|line| Some((number(line, x)?, number(line, y)?)));
    Some(pairs.filter(|(hz, _)| *hz > 0.0).unzip())
}
