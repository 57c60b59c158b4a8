//! Size of a run: limits on samples, cells and steps.

use serde_json::Value;

use super::{MAX_CELLS, MAX_SAMPLES, MAX_STEPS, MIN_SAMPLES, Node};
use crate::diagnostic::Diagnostic;
use crate::fault::Fault;
use crate::method::{DEFAULT_CELL_M, DEFAULT_COURANT};
use crate::scenario::{DEFAULT_OUTPUT_RATE_HZ, MAX_OUTPUT_RATE_HZ};
use crate::wording::{four_digits, number};

/// Checks the sections of the bodies and the size of the run.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    samples(root, found);
    let before = found.len();
    sections(root, found);
    if found.len() == before {
        cells_and_steps(root, found);
    }
}

/// Checks that the section `m / (rho L)` or the mass `rho A L` is finite and not zero.
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
            let fault = Fault::Degenerate { quantity, value };
            let accepted = "sizes that give a finite result above zero";
            found.push(Diagnostic::new(&body.at, fault, accepted));
        }
    }
}

/// Checks that the output is long enough for a spectrum and fits into memory.
fn samples(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let rate = match root.get("output_rate_hz") {
        Some(rate) => rate.value.as_f64(),
        None => Some(DEFAULT_OUTPUT_RATE_HZ),
    };
    let (Some(duration), Some(rate)) = (root.number("duration_s"), rate) else { return };
    let samples = (duration * rate).round();
    if duration <= 0.0 || rate <= 0.0 || rate > MAX_OUTPUT_RATE_HZ {
        return;
    }
    if samples < MIN_SAMPLES {
        let accepted = format!(
            "at least {MIN_SAMPLES} samples: at {} Hz a duration_s of at least {}",
            number(rate),
            four_digits(MIN_SAMPLES / rate)
        );
        let fault = Fault::TooFewSamples(samples);
        found.push(Diagnostic::new(&root.at.child("duration_s"), fault, accepted));
    } else if samples > MAX_SAMPLES {
        // Time history: four columns, and three for each interface.
        let columns = 4 + 3 * root.items("interfaces").len();
        let gigabytes = (samples * 8.0 * columns as f64 / 1e9).round();
        let accepted = format!(
            "at most {} samples: at {} Hz a duration_s of at most {}",
            number(MAX_SAMPLES),
            number(rate),
            four_digits(MAX_SAMPLES / rate)
        );
        let fault = Fault::TooManySamples { samples, gigabytes };
        found.push(Diagnostic::new(&root.at.child("duration_s"), fault, accepted));
    }
}

/// Checks the numbers of finite-difference cells and time steps.
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
        let [Some(length), Some(modulus), Some(density)] = quantities else { return };
        // c dt / dx below the Courant number (Eq. 3), in the stiffest body.
        longest = longest.max(length);
        step_s = step_s.min(courant * cell_m.min(length) / (modulus / density).sqrt());
    }
    let cells = (longest / cell_m).ceil();
    if cells > MAX_CELLS {
        let accepted = format!(
            "at most {} cells in a body: a cell_m of at least {}",
            number(MAX_CELLS),
            four_digits(longest / MAX_CELLS)
        );
        found.push(Diagnostic::new(&at, Fault::TooManyCells(cells), accepted));
        return;
    }
    let Some(duration) = root.number("duration_s") else { return };
    let steps = (duration / step_s).ceil();
    if steps > MAX_STEPS {
        let fault = Fault::TooManySteps { steps, step_s };
        let accepted =
            format!("at most {} steps: a shorter duration_s or a larger cell_m", number(MAX_STEPS));
        found.push(Diagnostic::new(&at, fault, accepted));
    }
}
