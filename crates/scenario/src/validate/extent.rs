//! Size of a run: limits on samples, cells and steps.

use serde_json::Value;

use super::node::Node;
use crate::diagnostic::{Diagnostic, MAX_FAULTS};
use crate::fault::Fault;
use crate::method::{DEFAULT_CELL_M, DEFAULT_COURANT};
use crate::scenario::{DEFAULT_OUTPUT_RATE_HZ, MAX_OUTPUT_RATE_HZ};
use crate::wording::{four_digits, number};

/// Fewest output samples of a run.
pub const MIN_SAMPLES: f64 = 16.0;

/// Most numbers of the time history of a run, samples times columns: 0.8 GB, and some three times
/// as much as text.
pub const MAX_HISTORY_NUMBERS: f64 = 1e8;

/// Most finite-difference cells of one body.
pub const MAX_CELLS: f64 = 1e6;

/// Most time steps of a run by finite differences.
pub const MAX_STEPS: f64 = 2e10;

/// Checks the sections of the bodies and the size of the run.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    samples(root, found);
    let before = found.len();
    sections(root, found);
    if found.len() == before {
        cells_and_steps(root, found);
    }
}

/// Checks that the section `m / (rho L)` or the mass `rho A L`, the wave speed `sqrt(E / rho)` over
/// the length and the stiffness `E A / L` of each body are finite and not zero, and the frequency
/// `sqrt(k / m)` of the support.
fn sections(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    if let Some((support, frequency)) = support(root) {
        let quantity = "the natural frequency in rad/s, sqrt(stiffness / mass),";
        degenerate(&support, quantity, frequency, found);
    }
    for body in root.items("bodies") {
        if found.len() >= MAX_FAULTS {
            return;
        }
        let (Some(length), Some(density)) =
            (body.number("length_m"), body.number("density_kg_per_m3"))
        else {
            continue;
        };
        let (quantity, value, area) = match (body.number("area_m2"), body.number("mass_kg")) {
            (Some(area), None) => {
                ("the mass in kg, density area length,", density * area * length, area)
            }
            (None, Some(mass)) => {
                let area = mass / (density * length);
                ("the section in m², mass / (density length),", area, area)
            }
            _ => continue,
        };
        if length <= 0.0 || density <= 0.0 || degenerate(&body, quantity, value, found) {
            continue;
        }
        let Some(modulus) = body.number("youngs_modulus_pa").filter(|modulus| *modulus > 0.0)
        else {
            continue;
        };
        let quantity = "the wave speed over the length in 1/s, sqrt(modulus / density) / length,";
        if !degenerate(&body, quantity, (modulus / density).sqrt() / length, found) {
            let quantity = "the stiffness in N/m, modulus area / length,";
            degenerate(&body, quantity, modulus * area / length, found);
        }
    }
}

/// Reports a quantity that is zero or not finite; true if it is.
fn degenerate(
    node: &Node<'_>,
    quantity: &'static str,
    value: f64,
    found: &mut Vec<Diagnostic>,
) -> bool {
    let degenerate = value == 0.0 || !value.is_finite();
    if degenerate {
        let fault = Fault::Degenerate { quantity, value };
        let accepted = "sizes that give a finite result above zero";
        found.push(Diagnostic::new(&node.at, fault, accepted));
    }
    degenerate
}

/// Checks that the output is long enough for a spectrum and fits into memory.
pub(super) fn samples(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
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
        return;
    }
    // Time history: four columns, and three for each interface.
    let columns = (4 + 3 * root.items("interfaces").len()) as f64;
    let most = (MAX_HISTORY_NUMBERS / columns).floor();
    if samples > most {
        let gigabytes = samples * 8.0 * columns / 1e9;
        let accepted = format!(
            "at most {} samples: at {} Hz a duration_s of at most {}",
            four_digits(most),
            number(rate),
            four_digits(most / rate)
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
    let support = support(root).map(|(node, frequency)| (node, courant * 2.0 / frequency));
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
    let (at, remedy) = match support {
        Some((support, step)) if step < step_s => {
            step_s = step;
            (support.at, "a support that is softer or heavier")
        }
        _ => (at, "a larger cell_m"),
    };
    let Some(duration) = root.number("duration_s") else { return };
    let steps = (duration / step_s).ceil();
    if steps > MAX_STEPS {
        let fault = Fault::TooManySteps { steps, step_s };
        let most = number(MAX_STEPS);
        let accepted = format!("at most {most} steps: a shorter duration_s or {remedy}");
        found.push(Diagnostic::new(&at, fault, accepted));
    }
}

/// The support and its natural frequency `sqrt(k / m)` \[rad/s\], of a mass on a spring.
fn support<'a>(root: &Node<'a>) -> Option<(Node<'a>, f64)> {
    let support = root.get("support")?;
    let (stiffness, mass) = (support.number("stiffness_n_per_m")?, support.number("mass_kg")?);
    (stiffness > 0.0 && mass > 0.0).then(|| (support, (stiffness / mass).sqrt()))
}
