//! A scenario with one number varied.

use std::sync::Arc;

use asperity_dynamics::{DynamicsError, Hit, Modal, ModalRig, RELATIVE_STEP, STENCIL, Variation};
use asperity_structure::{Damping, PreloadedContact, PreloadedStructure};

use super::{Parameter, SensitivityError};
use crate::assemble::Assembly;
use crate::run::rest_state;
use crate::summary::StaticSummary;
use asperity_scenario::Document;

/// The hit that is varied, and how many modes of each body it keeps.
pub(super) struct Base {
    pub(super) hit: Hit,
    counts: Vec<usize>,
}

/// The hit of `assembly`, whose natural frequency at rest is `natural` \[Hz\].
pub(super) fn base(
    assembly: &Assembly,
    method: &Modal,
    natural: Option<f64>,
) -> Result<Base, DynamicsError> {
    let modes = method.mode_count(natural, &assembly.excitation);
    let counts = modes.counts(assembly.structure.stack())?;
    let duration = assembly.sampling.samples() as f64 * assembly.sampling.interval();
    let excitation = assembly.excitation.clone();
    let rig = Arc::new(rig_with(assembly, &counts)?);
    Ok(Base { hit: Hit { rig, excitation, duration, step: method.step }, counts })
}

/// The rig of `assembly` with this many modes of each body.
pub fn rig_with(assembly: &Assembly, counts: &[usize]) -> Result<ModalRig, DynamicsError> {
    ModalRig::new(assembly.structure.reduced_to(counts)?)
}

/// The scenario at the four places of the stencil.
pub(super) struct Varied {
    pub(super) parameter: Parameter,
    pub(super) variation: Variation,
    pub(super) rests: [StaticSummary; 4],
}

impl Varied {
    pub(super) fn new(
        document: &Document,
        pointer: &str,
        base: &Base,
    ) -> Result<Self, SensitivityError> {
        let named = || pointer.to_owned();
        let number = document.value().pointer(pointer).and_then(serde_json::Value::as_f64);
        let value = number.ok_or_else(|| SensitivityError::NotANumber { pointer: named() })?;
        let first = pointer.split('/').nth(1).unwrap_or_default();
        if ["method", "duration_s", "output_rate_hz"].contains(&first) {
            return Err(SensitivityError::Setting { pointer: named() });
        }
        if value == 0.0 {
            return Err(SensitivityError::Zero { pointer: named() });
        }
        // All else leaves the laws as they are, but for the pressure that they count from, and
        // increments do not see that.
        let of_law = first == "laws" || pointer.split('/').nth(3) == Some("law");
        let step = RELATIVE_STEP * value.abs();
        let at = |place: f64| {
            let neighbour = value + place * step;
            let mut document = document.clone();
            document.set(pointer, &neighbour.to_string())?;
            let scenario = document.scenario().map_err(|source| SensitivityError::AtLimit {
                pointer: named(),
                value: neighbour,
                source: Box::new(source),
            })?;
            let assembly = Assembly::new(&scenario, document.folder())?;
            let mut rig = rig_with(&assembly, &base.counts)?;
            if !of_law {
                rig = with_laws_of(&base.hit.rig, &rig)?;
            }
            let rest = rest_state(&assembly);
            let excitation = assembly.excitation;
            Ok::<_, SensitivityError>((
                Hit { rig: Arc::new(rig), excitation, ..base.hit.clone() },
                rest,
            ))
        };
        let [a, b, c, d] = STENCIL;
        let ((a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)) = (at(a)?, at(b)?, at(c)?, at(d)?);
        Ok(Self {
            parameter: Parameter { pointer: named(), value },
            variation: Variation { hits: [a, b, c, d], step },
            rests: [a_rest, b_rest, c_rest, d_rest],
        })
    }
}

/// The `rig` with the very laws of `base`, which says that they are not varied.
pub fn with_laws_of(base: &ModalRig, rig: &ModalRig) -> Result<ModalRig, DynamicsError> {
    let contacts = rig.contacts().iter().zip(base.contacts()).map(|(contact, base)| {
        let law = Arc::clone(base.law());
        PreloadedContact::new(contact.name(), contact.area(), law, contact.pressure())
    });
    let contacts = contacts.collect::<Result<_, _>>()?;
    let damping = Damping::Rate(rig.rate());
    let structure = PreloadedStructure::of_components(rig.structure().clone(), contacts, damping)?;
    ModalRig::new(structure)
}
