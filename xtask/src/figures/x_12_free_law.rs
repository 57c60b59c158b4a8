//! x12: the law that the text states without an assumed form, and what would narrow it.

use anyhow::{Context, Result, ensure};
use asperity_figure::{Axis, Color, Dash, Legend, Marker, Panel, Series};
use asperity_identify::{
    Identification, IdentificationProblem, MeasurementKind, PredictedObservation, RESOLVED,
    identify,
};
use asperity_table::Table;

use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::Rig;

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x12",
    title: "x12: the law that the text states, without an assumed form",
    caption: "The numbers of figure x8 with a law that is only smooth, and the power law above \
              0.2 MPa. (a) Best fit (green line), bands of 50 % and 95 %, the band of \
              figure x8 with its four knots (black, dashed) and the stated stiffnesses (red). In \
              1e12 Pa/m, with 95 % intervals: K(0.025 MPa) = 0.120 (0.114 to 0.125), \
              K(0.078 MPa) = 0.457 (0.439 to 0.473), K(0.14 MPa) = 0.979 (0.964 to 0.996). (b) Width \
              of the averaging kernel: below the line the numbers resolve the law within a decade of \
              pressure. (c, d) Standard deviation of ln K from 0.01 to 0.08 MPa that one more \
              measurement would leave: hits with the bar's mass and with less of it, a quasi-static \
              stiffness of 5 %. Hits on the rig as it is leave 98 %, with a quarter of the mass and \
              20 N 51 %, a quasi-static stiffness at 0.01 MPa 33 %.",
    compute,
    draw,
};

/// Stiffnesses as the caption states them: pressure in MPa, best fit, lower and upper end.
const CAPTION: [[f64; 4]; 3] =
    [[0.025, 0.120, 0.114, 0.125], [0.078, 0.457, 0.439, 0.473], [0.14, 0.979, 0.964, 0.996]];
/// Largest distance of these numbers from those computed, as for figure x8.
const CAPTION_TOLERANCE: [f64; 3] = [1.5e-3, 8e-3, 8e-3];

/// Standard deviations that further measurements leave, as the caption states them.
const LEFT: [(Measurement, f64); 3] = [
    (Measurement { force: 32.0, mass: MASS, pressure: f64::NAN }, 0.98),
    (Measurement { force: 20.0, mass: 0.4, pressure: f64::NAN }, 0.51),
    (Measurement { force: f64::NAN, mass: f64::NAN, pressure: 0.01e6 }, 0.33),
];
/// Half a unit of the last digit, and what another machine moves the optimum by.
const LEFT_TOLERANCE: f64 = 0.01;

/// Mass of the guide bar, in kg, and the pointer that changes it.
const MASS: f64 = 1.61;
const MASS_POINTER: &str = "/bodies/0/mass_kg";

/// A possible measurement; what it has not is not a number.
#[derive(Debug, Clone, Copy)]
struct Measurement {
    force: f64,
    mass: f64,
    pressure: f64,
}

impl Measurement {
    fn of(kind: &MeasurementKind) -> Self {
        match kind {
            MeasurementKind::Hits { force_peak_n, set } => {
                let mass = set.get(MASS_POINTER).and_then(serde_json::Value::as_f64);
                Self { force: *force_peak_n, mass: mass.unwrap_or(MASS), pressure: f64::NAN }
            }
            MeasurementKind::Stiffness { pressure_pa } => {
                Self { force: f64::NAN, mass: f64::NAN, pressure: *pressure_pa }
            }
        }
    }

    fn is(&self, other: &Self) -> bool {
        let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
        same(self.force, other.force)
            && same(self.mass, other.mass)
            && same(self.pressure, other.pressure)
    }
}

fn compute(rig: &Rig) -> Result<Computed> {
    let fixtures = crate::workspace::workspace_root().join("fixtures");
    let problem = IdentificationProblem::read(fixtures.join("paper/identify-free.json"))?;
    let found = identify(&problem)?;
    ensure!(found.has_converged() && found.explains(), "{}", found.conclusions().join(" "));
    check_caption(&found)?;
    let mut columns = Columns::default();
    law_columns(&mut columns, &found)?;
    let with_knots = &rig.identified()?.law;
    columns.push("knots:pressure_pa", with_knots.pressure.as_slice());
    columns.push("knots:stiffness_pa_per_m:lower", with_knots.lower.as_slice());
    columns.push("knots:stiffness_pa_per_m:upper", with_knots.upper.as_slice());
    let stiffnesses: Vec<PredictedObservation<'_>> =
        found.observations().filter(|datum| datum.feature.starts_with("stiffness")).collect();
    let of = |of: &dyn Fn(&PredictedObservation<'_>) -> f64| -> Vec<f64> {
        stiffnesses.iter().map(of).collect()
    };
    columns.push("stated:pressure_pa", of(&|datum| datum.at.unwrap_or(f64::NAN)));
    columns.push("stated:stiffness_pa_per_m", of(&|datum| datum.value));
    let factor = found.noise_factor;
    columns.push("stated:deviation:fit", of(&|datum| datum.standard_deviation / factor));
    let design = found.design.as_ref().context("the problem has a design")?;
    let measurements: Vec<Measurement> =
        design.candidates.iter().map(|one| Measurement::of(&one.kind)).collect();
    let of = |of: fn(&Measurement) -> f64| measurements.iter().map(of).collect::<Vec<_>>();
    columns.push("design:force_n", of(|one| one.force));
    columns.push("design:mass_kg", of(|one| one.mass));
    columns.push("design:pressure_pa", of(|one| one.pressure));
    let left: Vec<f64> = design.candidates.iter().map(|one| one.remaining).collect();
    columns.push("design:remaining:fit", left);
    columns.computed()
}

fn law_columns(columns: &mut Columns, found: &Identification) -> Result<()> {
    let law = &found.law;
    let free = found.free_law.as_ref().context("the law is free")?;
    columns.push("pressure_pa", law.pressure.as_slice());
    columns.push("stiffness_pa_per_m:fit", law.stiffness.as_slice());
    columns.push("stiffness_pa_per_m:95:lower", law.lower.as_slice());
    columns.push("stiffness_pa_per_m:50:lower", law.quartiles[0].as_slice());
    columns.push("stiffness_pa_per_m:median", law.median.as_slice());
    columns.push("stiffness_pa_per_m:50:upper", law.quartiles[1].as_slice());
    columns.push("stiffness_pa_per_m:95:upper", law.upper.as_slice());
    let width = |&pressure: &f64| free.resolution(pressure).unwrap_or(f64::NAN);
    let widths: Vec<f64> = law.pressure.iter().map(width).collect();
    columns.push("kernel_width_ln_p:fit", widths);
    Ok(())
}

/// The numbers of the caption must be those computed.
fn check_caption(found: &Identification) -> Result<()> {
    let law = &found.law;
    for [pressure, said @ ..] in CAPTION {
        let next = law.pressure.partition_point(|&known| known < 1e6 * pressure);
        let share = (1e6 * pressure - law.pressure[next - 1])
            / (law.pressure[next] - law.pressure[next - 1]);
        let at = |list: &[f64]| 1e-12 * (list[next - 1] + share * (list[next] - list[next - 1]));
        let computed = [at(&law.stiffness), at(&law.lower), at(&law.upper)];
        let [a, b, c] = said;
        let words = format!("K({pressure} MPa) = {a:.3} ({b:.3} to {c:.3})");
        let far = |i: usize| (computed[i] - said[i]).abs() > CAPTION_TOLERANCE[i];
        let is_stated = FIGURE.caption.contains(&words) && !(0..3).any(far);
        ensure!(is_stated, "{pressure} MPa: {computed:?} is computed, the caption has to say it");
    }
    let design = found.design.as_ref().context("the problem has a design")?;
    for (measurement, said) in LEFT {
        let mut all = design.candidates.iter();
        let one = all.find(|one| Measurement::of(&one.kind).is(&measurement));
        let left = one.context("the caption's measurement is one of the design")?.remaining;
        let words = format!("{:.0} %", 100.0 * said);
        let is_stated = FIGURE.caption.contains(&words) && (left - said).abs() <= LEFT_TOLERANCE;
        ensure!(is_stated, "{measurement:?} leaves {left}, the caption has to say it");
    }
    Ok(())
}

fn draw(table: &Table) -> Result<String> {
    let pressure = table.column("pressure_pa")?;
    let stiffness = |of: &str| table.column(&format!("stiffness_pa_per_m:{of}"));
    let band = |label: &str, of: &str, color: Color| -> Result<Series> {
        let (low, high) = (stiffness(&format!("{of}:lower"))?, stiffness(&format!("{of}:upper"))?);
        Ok(Series::band(label, pressure, low, high).color(color))
    };
    let knots = |name: &str, end: &str| -> Result<Series> {
        let values = table.column(&format!("knots:stiffness_pa_per_m:{end}"))?;
        let line = Series::line(name, table.column("knots:pressure_pa")?, values);
        Ok(line.color(Color::BLACK).dash(Dash::Dashed).width(0.6))
    };
    let stated = |of: &str| table.column(&format!("stated:{of}"));
    let errors: Vec<f64> = stated("deviation:fit")?.iter().map(|value| 2.0 * value).collect();
    let points = Series::points("stated", stated("pressure_pa")?, stated("stiffness_pa_per_m")?);
    let axis = || style::pressure_axis().range(0.0, 0.22);
    let law = Panel::new(axis(), Axis::log("Stiffness", "Pa/m").range(3e10, 2e12))
        .series(band("95 %", "95", Color::GREEN)?)
        .series(band("50 %", "50", Color::GREEN)?.lightness(0.5))
        .series(Series::line("best fit", pressure, stiffness("fit")?).color(Color::GREEN))
        .series(knots("with four knots", "lower")?)
        .series(knots("", "upper")?)
        .series(points.errors(errors).color(Color::RED).marker(Marker::Square).marker_size(4.0))
        .legend(Legend::Auto);
    let widths = table.column("kernel_width_ln_p:fit")?;
    let width = Axis::log("Kernel width in ln p", "").range(0.1, 20.0);
    let resolution = Panel::new(axis(), width)
        .series(Series::line("", pressure, widths).color(Color::GREEN))
        .horizontal(RESOLVED, "a decade")
        .legend(Legend::None);
    let left = || Axis::linear("Standard deviation of ln K left", "").range(0.0, 1.05);
    let design = |of: &str| table.column(&format!("design:{of}"));
    let (force, mass, remaining) =
        (design("force_n")?, design("mass_kg")?, design("remaining:fit")?);
    let mut hits = Panel::new(Axis::linear("Peak force", "N"), left()).legend(Legend::Auto);
    for (number, of) in [MASS, 0.8, 0.4].into_iter().enumerate() {
        let rows = || (0..mass.len()).filter(|&row| mass[row] == of);
        let (x, y): (Vec<f64>, Vec<f64>) = rows().map(|row| (force[row], remaining[row])).unzip();
        let line = Series::line_points(format!("{of} kg"), x, y).marker(Marker::Circle);
        hits = hits.series(line.color(Color::category(number)));
    }
    let at = design("pressure_pa")?;
    let rows = (0..at.len()).filter(|&row| at[row].is_finite());
    let (x, y): (Vec<f64>, Vec<f64>) = rows.map(|row| (at[row], remaining[row])).unzip();
    let of_static = Axis::linear("Pressure of a quasi-static stiffness", "MPa").scale(1e-6);
    let of_static = Panel::new(of_static.range(0.0, 0.15), left())
        .series(Series::line_points("", x, y).color(Color::RED).marker(Marker::Square))
        .legend(Legend::None);
    let figure = style::figure("The law without a form", [law, resolution, hits, of_static]);
    style::checked(&figure.columns(2).row_height_mm(58.0))
}
