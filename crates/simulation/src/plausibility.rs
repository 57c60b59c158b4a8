//! Values of a scenario that are possible and unusual: most are units that were mistaken.

use std::fmt;

use asperity_mesh::Support;
use serde::Serialize;

use crate::assemble::Assembly;

/// Usual Young's moduli \[Pa\], from soft rubber to diamond; densities \[kg/m3\], from foam to osmium;
/// lengths \[m\]; and sections and areas of contact \[m2\].
const MODULUS: [f64; 2] = [1e6, 1.3e12];
const DENSITY: [f64; 2] = [10.0, 2.3e4];
const LENGTH: [f64; 2] = [1e-5, 100.0];
const AREA: [f64; 2] = [1e-9, 10.0];
/// Largest usual damping ratio, closure of rough faces \[m\], and force of a hand hammer \[N\].
const DAMPING_RATIO: f64 = 0.5;
const CLOSURE: f64 = 50e-6;
const HAND_HAMMER: f64 = 5e3;
/// Samples of the output in a period of the lowest mode: two in a period of its second harmonic.
const SAMPLES: f64 = 4.0;

/// A value outside the range that is usual, with its place in the scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlausibilityNote {
    /// JSON pointer into the scenario.
    pub pointer: String,
    /// Name of the quantity.
    pub quantity: &'static str,
    /// The value.
    pub value: f64,
    /// Unit of the value; empty for a ratio.
    pub unit: &'static str,
    /// Usual range; `None` for no limit.
    pub usual: [Option<f64>; 2],
}

impl fmt::Display for PlausibilityNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pointer, quantity, value, unit, usual } = self;
        let show = |value: f64| {
            let is_short = value == 0.0 || (1e-3..1e5).contains(&value.abs());
            let number = if is_short { format!("{value:.4}") } else { format!("{value:.3e}") };
            let number = match number.split_once('.') {
                Some((whole, digits)) if is_short => {
                    let digits = digits.trim_end_matches('0');
                    if digits.is_empty() { whole.to_owned() } else { format!("{whole}.{digits}") }
                }
                _ => number,
            };
            if unit.is_empty() { number } else { format!("{number} {unit}") }
        };
        write!(f, "{pointer}: {quantity} of {}; usual: ", show(*value))?;
        match *usual {
            [Some(low), Some(high)] => write!(f, "{} to {}", show(low), show(high)),
            [Some(low), None] => write!(f, "at least {}", show(low)),
            [None, Some(high)] => write!(f, "at most {}", show(high)),
            [None, None] => write!(f, "any"),
        }
    }
}

/// The unusual values of an assembled scenario: moduli, densities, lengths, sections, areas of contact, damping
/// ratios, closures at rest, the peak of a pulse, and the output rate. None of them is an error.
///
/// ```
/// # use asperity_scenario::Document;
/// # use asperity_simulation::assemble::Assembly;
/// # use asperity_simulation::plausibility::plausibility_notes;
/// let mut document = Document::read("examples/block.json")?;
/// document.set("/bodies/0/youngs_modulus_pa", "210e3")?;
/// let assembly = Assembly::new(&document.scenario()?, document.folder())?;
/// let notes = plausibility_notes(&assembly);
/// assert!(notes[0].to_string().starts_with("/bodies/0/youngs_modulus_pa: Young's modulus of 2.100e5 Pa"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plausibility_notes(assembly: &Assembly) -> Vec<PlausibilityNote> {
    let mut found = Vec::new();
    let mut within = |pointer: String, quantity, (value, unit), [low, high]: [f64; 2]| {
        let usual = [low, high].map(|limit| (limit.is_finite() && limit != 0.0).then_some(limit));
        if !(low..=high).contains(&value) {
            found.push(PlausibilityNote { pointer, quantity, value, unit, usual });
        }
    };
    let structure = &assembly.structure;
    for (i, body) in structure.stack().bodies().iter().enumerate() {
        let place = |key: &str| format!("/bodies/{i}/{key}");
        let (modulus, density) = (body.youngs_modulus(), body.density());
        within(place("youngs_modulus_pa"), "Young's modulus", (modulus, "Pa"), MODULUS);
        within(place("density_kg_per_m3"), "density", (density, "kg/m3"), DENSITY);
        within(place("length_m"), "length", (body.length(), "m"), LENGTH);
        within(format!("/bodies/{i}"), "cross-section", (body.section(), "m2"), AREA);
    }
    for (i, contact) in structure.contacts().iter().enumerate() {
        let area = format!("/interfaces/{i}/area_m2");
        within(area, "area of contact", (contact.area(), "m2"), AREA);
        let (law, most) = (format!("/interfaces/{i}/law"), [f64::NEG_INFINITY, CLOSURE]);
        within(law, "closure of rough faces at rest", (contact.closure(), "m"), most);
    }
    let most = [f64::NEG_INFINITY, DAMPING_RATIO];
    if let Support::SpringMass { damping_ratio, .. } = *structure.stack().support() {
        let place = "/support/damping_ratio".to_owned();
        within(place, "damping ratio", (damping_ratio, ""), most);
    }
    let modal = structure.modal_ratios().map_or(&[][..], |(ratios, _)| ratios);
    for (i, ratio) in modal.iter().enumerate() {
        within(format!("/damping/ratios/{i}"), "damping ratio", (*ratio, ""), most);
    }
    let lowest = structure.modes(1).ok().and_then(|modes| modes.into_iter().next());
    if let Some(mode) = &lowest {
        if modal.is_empty() {
            let quantity = "damping ratio of the lowest mode";
            within("/damping".to_owned(), quantity, (mode.damping_ratio, ""), most);
        }
        let rate = assembly.sampling.rate();
        let least = [SAMPLES * mode.frequency_hz, f64::INFINITY];
        let quantity = "output rate, below twice the second harmonic of the lowest mode,";
        within("/output_rate_hz".to_owned(), quantity, (rate, "Hz"), least);
    }
    // A shaker or a base has other limits, and no force none.
    let is_pulse = assembly.load.base().is_none() && assembly.load.ends_at().is_finite();
    if is_pulse {
        let most = [f64::NEG_INFINITY, HAND_HAMMER];
        let peak = assembly.load.peak().abs();
        within("/excitation".to_owned(), "peak force of a hand hammer", (peak, "N"), most);
    }
    found
}
