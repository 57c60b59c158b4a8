//! Friction elements as rows of a step.
//!
//! An element across the closure of a contact adds to the traction there. A guide is a pair of
//! faces of its own, without pressure: its closure is the displacement in the guide, and its
//! traction, on an area of 1 m2, the force of the element.

use asperity_mesh::{ComponentModes, ResidualFlexibility};

/// The modes with a contact pair more for each guide, after the contacts.
pub(super) fn with_guides_as_pairs(modes: &ComponentModes) -> ComponentModes {
    let guides = modes.guides();
    if guides == 0 {
        return modes.clone();
    }
    let pairs = modes.interfaces() + guides;
    let extended = |row: &[f64]| {
        let mut row = row.to_vec();
        row.resize(pairs, 0.0);
        row
    };
    let mut rows = modes.modes().to_vec();
    for mode in &mut rows {
        let guide = std::mem::take(&mut mode.guide);
        mode.closure.extend(guide);
    }
    let residual = modes.residual();
    let mut closure: Vec<Vec<f64>> = residual.closure.iter().map(|row| extended(row)).collect();
    closure.resize(pairs, vec![0.0; pairs]);
    let residual = ResidualFlexibility {
        closure,
        drive: extended(&residual.drive),
        output: extended(&residual.output),
        ..residual.clone()
    };
    // Of the same sizes in every row.
    ComponentModes::new(rows, residual).unwrap_or_else(|_| modes.clone())
}
