//! A scenario with one parameter varied.

use std::sync::Arc;

use asperity_dynamics::{
    DynamicsError, ModalModel, ParameterVariation, RELATIVE_STEP, STENCIL, TransientCase,
};
use asperity_scenario::Document;
use asperity_structure::{Damping, PreloadedContact, PreloadedStructure, StructureError};

use super::SensitivityError;
use crate::parameter::ScenarioParameter;
use crate::prepared_scenario::PreparedScenario;
use crate::static_state::StaticSummary;

/// The scenario at the four places of the stencil.
pub(super) struct Varied {
    pub(super) parameter: ScenarioParameter,
    pub(super) variation: ParameterVariation,
    pub(super) at_rest: [StaticSummary; 4],
}

impl Varied {
    /// The scenario of `document` with the parameter at `pointer` varied, about the hit `base` with
    /// `counts` modes of each body.
    pub(super) fn new(
        document: &Document,
        pointer: &str,
        base: &TransientCase,
        counts: &[usize],
    ) -> Result<Self, SensitivityError> {
        let parameter = ScenarioParameter::of_scenario(document.value(), pointer)?;
        let value = parameter.value;
        if value == 0.0 {
            return Err(SensitivityError::Zero(pointer.to_owned()));
        }
        let step = RELATIVE_STEP * value.abs();
        let at = |place: f64| {
            let neighbour = value + place * step;
            let mut document = document.clone();
            document.set(pointer, &neighbour.to_string())?;
            let scenario = document.scenario().map_err(|source| SensitivityError::AtLimit {
                pointer: pointer.to_owned(),
                value: neighbour,
                source: Box::new(source),
            })?;
            let prepared = PreparedScenario::new(&scenario, document.folder())?;
            let mut rig = prepared.modal_model(counts, base.load.port())?;
            if !parameter.is_of_law() {
                rig = Arc::new(with_laws_of(&base.model, &rig)?);
            }
            let load = prepared.assembly.load;
            Ok::<_, SensitivityError>((
                TransientCase { model: rig, load, ..base.clone() },
                prepared.at_rest,
            ))
        };
        let [a, b, c, d] = STENCIL;
        let ((a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)) = (at(a)?, at(b)?, at(c)?, at(d)?);
        Ok(Self {
            variation: ParameterVariation { cases: [a, b, c, d], step },
            at_rest: [a_rest, b_rest, c_rest, d_rest],
            parameter,
        })
    }
}

/// The modal model `rig` with the laws of `base`, shared to mark them as not varied.
///
/// # Errors
/// As [`ModalModel::new`].
pub fn with_laws_of(base: &ModalModel, rig: &ModalModel) -> Result<ModalModel, DynamicsError> {
    let contacts = rig.contacts().iter().zip(base.contacts()).map(|(contact, base)| {
        let law = Arc::clone(base.law());
        let shared = PreloadedContact::new(contact.name(), contact.area(), law, contact.pressure());
        let shared = shared?.with_damping(contact.damping());
        Ok::<_, StructureError>(shared.with_friction(contact.friction()))
    });
    let contacts = contacts.collect::<Result<_, _>>()?;
    let damping = Damping::Rate(rig.preloaded().damping_rate());
    let structure = PreloadedStructure::of_components(rig.structure().clone(), contacts, damping)?;
    rig.with_structure(structure.with_guides(rig.preloaded().guides().to_vec())?)
}
