//! The extent of a run: samples, cells and steps that can be held and waited for.

use serde_json::Value;

use super::{FEWEST_SAMPLES, MOST_CELLS, MOST_SAMPLES, MOST_STEPS, Node};
use crate::diagnostic::{Diagnostic, Problem, number, rounded};
use crate::method::{DEFAULT_CELL_M, DEFAULT_COURANT};
use crate::{DEFAULT_OUTPUT_RATE_HZ, MOST_OUTPUT_RATE_HZ};

/// Checks the bodies' derived sections and the size of the run.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    samples(root, found);
    let before = found.len();
    sections(root, found);
    if found.len() == before {
        cells_and_steps(root, found);
    }
}

/// The section `m / (rho L)` and the mass `rho A L` must be storable.
fn sections(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    for body in root.items("bodies") {
        let (Some(length), Some(density)) =
            (body.number("length_m"), body.number("density_kg_per_m3"))
        else {
            continue;
        };
        let (quantity, value) = match (body.number("area_m2"), body.number("mass_kg")) {
            (Some(area), None) => ("the mass in kg, density area length,", density * area * length),
            (None, Some(mass)) => {
                ("the section in m², mass / (density length),", mass / (density * length))
            }
            _ => continue,
        };
        let positive = length > 0.0 && density > 0.0;
        if positive && (value == 0.0 || !value.is_finite()) {
            let problem = Problem::Degenerate { quantity, value };
            let accepted = "sizes that give a finite result above zero";
            found.push(Diagnostic::new(&body.at, problem, accepted));
        }
    }
}

/// The output must be long enough for a spectrum and short enough for memory.
fn samples(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let rate = match root.get("output_rate_hz") {
        Some(rate) => rate.value.as_f64(),
        None => Some(DEFAULT_OUTPUT_RATE_HZ),
    };
    let (Some(duration), Some(rate)) = (root.number("duration_s"), rate) else {
        return;
    };
    let samples = (duration * rate).round();
    if duration <= 0.0 || rate <= 0.0 || rate > MOST_OUTPUT_RATE_HZ {
        return;
    }
    if samples < FEWEST_SAMPLES {
        let accepted = format!(
            "at least {FEWEST_SAMPLES} samples: at {} Hz a duration_s of at least {}",
            number(rate),
            rounded(FEWEST_SAMPLES / rate)
        );
        let problem = Problem::TooFewSamples { samples };
        found.push(Diagnostic::new(&root.at.child("duration_s"), problem, accepted));
    } else if samples > MOST_SAMPLES {
        // The history: four columns, and three for each interface.
        let columns = 4 + 3 * root.items("interfaces").len();
        let gigabytes = (samples * 8.0 * columns as f64 / 1e9).round();
        let accepted = format!(
            "at most {} samples: at {} Hz a duration_s of at most {}",
            number(MOST_SAMPLES),
            number(rate),
            rounded(MOST_SAMPLES / rate)
        );
        let problem = Problem::TooManySamples { samples, gigabytes };
        found.push(Diagnostic::new(&root.at.child("duration_s"), problem, accepted));
    }
}

/// The finite-difference grid and its time steps must be within reach.
fn cells_and_steps(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let method = root.get("method");
    let setting = |key: &str, default: f64| match method.as_ref().and_then(|method| method.get(key))
    {
        Some(node) => node.value.as_f64(),
        None => Some(default),
    };
    let kind = method.as_ref().map(|method| method.text("kind").or(method.value.as_str()));
    if kind.flatten() != Some("finite_difference") {
        return;
    }
    let (Some(cell_m), Some(courant)) =
        (setting("cell_m", DEFAULT_CELL_M), setting("courant", DEFAULT_COURANT))
    else {
        return;
    };
    if cell_m <= 0.0 || courant <= 0.0 {
        return;
    }
    let at = match &method {
        Some(method @ Node { value: Value::Object(_), .. }) if method.get("cell_m").is_some() => {
            method.at.child("cell_m")
        }
        Some(method) => method.at.clone(),
        None => root.at.clone(),
    };
    let (mut longest, mut step_s) = (0.0_f64, f64::INFINITY);
    for body in root.items("bodies") {
        let quantities =
            ["length_m", "youngs_modulus_pa", "density_kg_per_m3"].map(|key| body.number(key));
        let [Some(length), Some(modulus), Some(density)] = quantities else {
            return;
        };
        // c dt / dx below the Courant number (Eq. 3), in the stiffest body.
        longest = longest.max(length);
        step_s = step_s.min(courant * cell_m.min(length) / (modulus / density).sqrt());
    }
    let cells = (longest / cell_m).ceil();
    if cells > MOST_CELLS {
        let accepted = format!(
            "at most {} cells in a body: a cell_m of at least {}",
            number(MOST_CELLS),
            rounded(longest / MOST_CELLS)
        );
        found.push(Diagnostic::new(&at, Problem::TooManyCells { cells }, accepted));
        return;
    }
    let Some(duration) = root.number("duration_s") else {
        return;
    };
    let steps = (duration / step_s).ceil();
    if steps > MOST_STEPS {
        let problem = Problem::TooManySteps { steps, step_s };
        let accepted = format!(
            "at most {} steps: a shorter duration_s or a larger cell_m",
            number(MOST_STEPS)
        );
        found.push(Diagnostic::new(&at, problem, accepted));
    }
}
