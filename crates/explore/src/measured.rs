//! Measured hits beside computed ones: points and bars in the figures, their forces as excitations, and chi-square
//! by feature.

use std::path::{Path, PathBuf};

use asperity_figure::Figure;
use asperity_identify::problem::HitSpec;
use asperity_identify::{IdentificationError, MeasuredHits, measured_hits};
use asperity_plot::{HitSeries, MagnitudeAxis, hit_levels, measured_frf};
use asperity_scenario::{Document, four_digits};
use asperity_simulation::quantity::Quantity;
use asperity_simulation::sweep::{Sweep, Variation};
use serde_json::{Value, json};

/// Features of hits, in the order of the figure.
const FEATURES: [Quantity; 3] =
    [Quantity::FundamentalFrequency, Quantity::FundamentalReceptance, Quantity::HarmonicRatio];

/// Most hits whose responses are computed at every change; of more, every so many.
const MOST_HITS: usize = 60;

/// The hits of an analysis.
#[derive(Debug)]
pub(crate) struct Measured {
    pub(crate) path: PathBuf,
    /// True if the file ends with the page.
    pub(crate) is_temporary: bool,
    hits: Vec<HitSpec>,
    /// Points of the measured force of each hit, from its beginning; none without its record.
    points: Vec<Option<Vec<[f64; 2]>>>,
    /// The first reason why a hit has no force.
    reason: Option<String>,
    /// Frequency and magnitude of the averaged receptance, where its table is beside the analysis.
    frf: Option<(Vec<f64>, Vec<f64>)>,
}

impl Measured {
    /// Reads an `analysis.json`, and the `frf.csv` beside it.
    pub(crate) fn read(path: &Path, is_temporary: bool) -> Result<Self, IdentificationError> {
        let MeasuredHits { hits, forces, reasons } = measured_hits(path)?;
        let points = forces.into_iter().map(|force| points_of(&force?)).collect();
        let reason = reasons.into_iter().next();
        let (path, frf) = (path.to_owned(), receptance(path));
        Ok(Self { path, is_temporary, hits, points, reason, frf })
    }

    /// Peak force of each hit \[N\], and true where the hit has its measured force.
    pub(crate) fn described(&self) -> Vec<Value> {
        let pairs = self.hits.iter().zip(&self.points);
        let described = |(hit, points): (&HitSpec, &Option<_>)| {
            let force_n = hit.force_peak_n.map(four_digits);
            json!({ "force_n": force_n, "pulse": points.is_some() })
        };
        pairs.map(described).collect()
    }

    /// The measured force of a hit as an excitation, at the place of the present one; none without its record.
    pub(crate) fn excitation(&self, hit: usize, present: &Value) -> Option<Value> {
        let points = self.points.get(hit)?.as_ref()?;
        let mut excitation = json!({ "kind": "samples", "points": points });
        if let Some(at) = present.get("at") {
            excitation["at"] = at.clone();
        }
        Some(excitation)
    }

    /// The hit whose measured force an excitation is.
    pub(crate) fn hit_of(&self, excitation: &Value) -> Option<usize> {
        let points = excitation.get("points")?;
        let found = serde_json::from_value::<Vec<[f64; 2]>>(points.clone()).ok()?;
        self.points.iter().position(|own| own.as_ref() == Some(&found))
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
        hit_levels(pointer, &columns, HitSeries::Measured)
    }

    /// Computed features of the hits under their own measured forces, in the same figure.
    pub(crate) fn computed_levels(&self, pointer: &str, computed: &Computed) -> Figure {
        let columns = FEATURES.map(|quantity| {
            let point = |(hit, is_own): (usize, &bool)| {
                let value = is_own.then(|| computed.number(hit, quantity))??;
                Some([self.hits[computed.hits[hit]].force_peak_n?, value, f64::NAN])
            };
            (quantity, computed.own.iter().enumerate().filter_map(point).collect())
        });
        hit_levels(pointer, &columns, HitSeries::Computed)
    }

    /// The averaged receptance up to a frequency \[Hz\].
    pub(crate) fn frf(&self, highest: f64, axis: MagnitudeAxis) -> Option<Figure> {
        let (frequency, magnitude) = self.frf.as_ref()?;
        let kept = frequency.partition_point(|hz| *hz <= highest);
        Some(measured_frf(&frequency[..kept], &magnitude[..kept], axis))
    }

    /// The hits that are computed, each under its own force if it has one, and the runs of which they are the rows:
    /// over the points of measured forces, and over the amplitude of the scenario's pulse.
    pub(crate) fn runs(&self, document: &Document, pointer: Option<&str>) -> Runs {
        let every = self.hits.len().div_ceil(MOST_HITS).max(1);
        let chosen = (0..self.hits.len()).step_by(every);
        let (own, others): (Vec<usize>, Vec<usize>) =
            chosen.partition(|&hit| self.points[hit].is_some());
        let mut runs = Runs { measured: None, scaled: None, own, others };
        let present = document.value().get("excitation").unwrap_or(&Value::Null);
        let mut with_points = document.clone();
        let first = runs.own.first().and_then(|&hit| self.excitation(hit, present));
        let is_set = |first: Value| with_points.set("/excitation", &first.to_string()).is_ok();
        if first.is_some_and(is_set) {
            let points = runs.own.iter().filter_map(|&hit| self.points[hit].as_ref());
            let values = points.map(|points| json!(points).to_string()).collect();
            let variation = Variation { pointer: "/excitation/points".to_owned(), values };
            runs.measured = Some((with_points, variation));
        }
        runs.others.retain(|&hit| self.hits[hit].force_peak_n.is_some());
        if let (Some(pointer), false) = (pointer, runs.others.is_empty()) {
            let forces = runs.others.iter().filter_map(|&hit| self.hits[hit].force_peak_n);
            let values = forces.map(|force| force.to_string()).collect();
            let variation = Variation { pointer: pointer.to_owned(), values };
            runs.scaled = Some((document.clone(), variation));
        }
        runs
    }

    /// Chi-square of each feature, the sum of ((computed - measured) / deviation)^2, with the number of its hits.
    pub(crate) fn chi_square(&self, computed: &Computed) -> Vec<(Quantity, f64, usize)> {
        let of = |quantity: Quantity| {
            let (mut sum, mut count) = (0.0, 0);
            for (row, &hit) in computed.hits.iter().enumerate() {
                let features = &self.hits[hit].features;
                let measured = features.get(quantity.key()).map(|measured| measured.parts());
                let value = computed.number(row, quantity).filter(|value| !value.is_nan());
                if let (Some((measured, Some(deviation))), Some(value)) = (measured, value) {
                    sum += ((value - measured) / deviation).powi(2);
                    count += 1;
                }
            }
            (quantity, sum, count)
        };
        FEATURES.map(of).into_iter().filter(|(.., count)| *count > 0).collect()
    }

    /// The same in words, with the forces that the hits were computed under.
    pub(crate) fn words(&self, computed: &Computed) -> String {
        let own = computed.own.iter().filter(|is_own| **is_own).count();
        let others = computed.own.len() - own;
        let reason = self.reason.as_ref().map_or(String::new(), |reason| format!(" ({reason})"));
        let forces = match (own, others) {
            (_, 0) => "each under its own measured force".to_owned(),
            (0, _) => {
                format!("with the pulse of the scenario at the measured peaks{reason}")
            }
            _ => format!(
                "{own} under their own measured forces, {others} with the pulse of the scenario at the \
                 measured peaks{reason}"
            ),
        };
        let mut text = format!("chi-square of the hits, {forces}\n");
        for (quantity, sum, count) in self.chi_square(computed) {
            let (key, sum) = (quantity.key(), four_digits(sum));
            text.push_str(&[key, ": ", &sum, " of ", &count.to_string(), " hits\n"].concat());
        }
        text
    }
}

/// Runs for the hits.
#[derive(Debug)]
pub(crate) struct Runs {
    /// A document under the first measured force, and the points of all of them.
    pub(crate) measured: Option<(Document, Variation)>,
    /// The document, and the amplitudes of its pulse.
    pub(crate) scaled: Option<(Document, Variation)>,
    own: Vec<usize>,
    others: Vec<usize>,
}

impl Runs {
    /// The computed hits, of the results of both.
    pub(crate) fn computed(self, measured: Option<Sweep>, scaled: Option<Sweep>) -> Computed {
        let own = measured.as_ref().map_or(&[][..], |_| &self.own);
        let others = scaled.as_ref().map_or(&[][..], |_| &self.others);
        let hits = own.iter().chain(others).copied().collect();
        let is_own = (0..own.len() + others.len()).map(|row| row < own.len()).collect();
        let first = own.len();
        Computed { hits, own: is_own, first, measured, scaled }
    }
}

/// Hits as computed.
#[derive(Debug)]
pub(crate) struct Computed {
    hits: Vec<usize>,
    /// True for a hit under its own force.
    own: Vec<bool>,
    /// Number of those, which come first.
    first: usize,
    measured: Option<Sweep>,
    scaled: Option<Sweep>,
}

impl Computed {
    fn number(&self, row: usize, quantity: Quantity) -> Option<f64> {
        match row.checked_sub(self.first) {
            None => self.measured.as_ref()?.number(row, quantity.key()),
            Some(row) => self.scaled.as_ref()?.number(row, quantity.key()),
        }
    }
}

/// Points of a force from its first sample that is not zero, the time to a nanosecond and the force to six digits; none
/// for a force that a document does not take.
fn points_of((times, forces): &(Vec<f64>, Vec<f64>)) -> Option<Vec<[f64; 2]>> {
    const MOST: usize = 10_000;
    let begin = forces.iter().position(|force| *force != 0.0)?.saturating_sub(1);
    let end = (forces.iter().rposition(|force| *force != 0.0)? + 2).min(forces.len());
    let point = |n: usize| {
        let digits = [format!("{:.9}", times[n] - times[begin]), format!("{:.5e}", forces[n])];
        digits.map(|text| text.parse().unwrap_or(0.0))
    };
    let points: Vec<[f64; 2]> = (begin..end).map(point).collect();
    let increases = points.windows(2).all(|pair| pair[1][0] > pair[0][0]);
    (increases && (2..=MOST).contains(&points.len())).then_some(points)
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
