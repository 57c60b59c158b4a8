//! From a problem to forward models: its own, and those of the laws compared with it.

use asperity_dynamics::Batch;
use serde_json::{Value, json};

use crate::error::ProblemError;
use crate::forward::Forward;
use crate::load::{About, Loaded, Loader, check_scenario, name_of, no_law};
use crate::problem::{CandidateSpec, DataSpec, UnknownSpec};
use crate::read::Problem;
use crate::row::Columns;
use crate::unknowns::Unknowns;
use asperity_scenario::{JsonPointer, set_value};
use asperity_study::observable_extractor::ObservableExtractor;

/// A forward model with what its observations are about.
#[derive(Debug)]
pub(super) struct Built {
    pub(super) forward: Forward,
    pub(super) about: Vec<About>,
    pub(super) notices: Vec<String>,
}

impl Problem {
    /// The model of the problem.
    pub(super) fn model(&self) -> Result<Built, ProblemError> {
        self.check_gains(&self.spec.unknowns)?;
        self.build(&self.scenario, &self.spec.unknowns, &self.spec.data)
    }

    /// The model of a candidate: its changes, and those unknowns that are not inside them.
    pub(super) fn candidate(&self, candidate: &CandidateSpec) -> Result<Built, ProblemError> {
        let mut scenario = self.scenario.clone();
        for (pointer, value) in &candidate.set {
            let place = || format!("candidate \"{}\"", candidate.name);
            set_value(&mut scenario, pointer, &value.to_string())
                .map_err(|source| ProblemError::Set { place: place(), source })?;
        }
        let changed = |pointer: &str| {
            let inside = |set: &String| {
                pointer
                    .strip_prefix(set.as_str())
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
            };
            candidate.set.keys().any(inside)
        };
        let stays = |unknown: &&UnknownSpec| match unknown {
            UnknownSpec::Scalar { pointer, .. } => !changed(pointer),
            UnknownSpec::MonotoneLaw { law, .. } => {
                !changed(&JsonPointer::root().child("laws").child(law).to_string())
            }
            UnknownSpec::Gain { .. } => true,
        };
        let kept = self.spec.unknowns.iter().filter(stays);
        let unknowns: Vec<UnknownSpec> = kept.chain(&candidate.unknowns).cloned().collect();
        self.check_gains(&unknowns)?;
        self.build(&scenario, &unknowns, &self.spec.data)
    }

    /// The scenario with the unknowns at `point`.
    pub(super) fn scenario_at(&self, point: &[f64]) -> Result<Value, ProblemError> {
        let unknowns = Unknowns::new(&self.spec.unknowns, &self.scenario)?;
        let mut scenario = self.scenario.clone();
        unknowns.write(&mut scenario, point)?;
        Ok(scenario)
    }

    /// The model of other data, that could be measured with the same unknowns. Gains of the
    /// problem's data by name are not theirs.
    pub(super) fn planned(&self, data: &[DataSpec]) -> Result<Forward, ProblemError> {
        Ok(self.build(&self.scenario, &self.spec.unknowns, data)?.forward)
    }

    /// The law that is asked for.
    pub(super) fn law(&self) -> Result<String, ProblemError> {
        let of_interface = || self.scenario.pointer("/interfaces/0/law")?.as_str();
        let name = self.spec.law.as_deref().or_else(of_interface);
        let Some(name) = name else { return Err(no_law(&self.scenario, "(in place)")) };
        match self.scenario.pointer("/laws").and_then(|laws| laws.get(name)) {
            Some(_) => Ok(name.to_owned()),
            None => Err(no_law(&self.scenario, name)),
        }
    }

    /// The candidate of no dependence on pressure: a constant stiffness, as `law` has it at the
    /// static `pressure` \[Pa\] now.
    pub(super) fn constant(law: &str, stiffness: f64) -> CandidateSpec {
        let pointer = JsonPointer::root().child("laws").child(law).to_string();
        let spec = json!({"kind": "constant", "stiffness_pa_per_m": stiffness});
        CandidateSpec {
            name: CONSTANT.to_owned(),
            set: [(pointer.clone(), spec)].into_iter().collect(),
            unknowns: vec![UnknownSpec::Scalar {
                pointer: format!("{pointer}/stiffness_pa_per_m"),
                name: Some("constant stiffness [Pa/m]".to_owned()),
                bounds: [stiffness / CONSTANT_RANGE, stiffness * CONSTANT_RANGE],
                start: None,
                scale: None,
                prior: None,
            }],
        }
    }

    /// Refuses gains of data that are not there.
    fn check_gains(&self, unknowns: &[UnknownSpec]) -> Result<(), ProblemError> {
        let data = self.spec.data.iter().enumerate();
        let known: Vec<String> = data.map(|(index, data)| name_of(index, data)).collect();
        let named = unknowns.iter().filter_map(|unknown| match unknown {
            UnknownSpec::Gain { data, .. } => data.as_ref(),
            _ => None,
        });
        match named.flatten().find(|name| !known.contains(name)) {
            None => Ok(()),
            Some(name) => Err(ProblemError::NoData { name: name.clone(), known: known.join(", ") }),
        }
    }

    fn build(
        &self,
        scenario: &Value,
        specs: &[UnknownSpec],
        data: &[DataSpec],
    ) -> Result<Built, ProblemError> {
        check_scenario(scenario, &self.scenario_path)?;
        let unknowns = Unknowns::new(specs, scenario)?;
        check_overlap(&unknowns)?;
        let items = scenario.get("interfaces").and_then(Value::as_array);
        let interfaces: Vec<&str> = items
            .into_iter()
            .flatten()
            .filter_map(|interface| interface.get("name")?.as_str())
            .collect();
        let columns = Columns::new(&interfaces);
        let problem = self.document.folder();
        let mut loader = Loader::new(scenario, &self.scenario_path, problem, &unknowns, &columns);
        for (index, data) in data.iter().enumerate() {
            loader.load(index, data)?;
        }
        let Loaded { rigs, strikes, rows, observations, stiffness, about, notices, .. } =
            loader.found;
        let folder = self.scenario_path.parent().unwrap_or_else(|| std::path::Path::new("."));
        let forward = Forward {
            scenario: scenario.clone(),
            folder: folder.to_owned(),
            rigs,
            strikes,
            rows,
            observations,
            stiffness,
            columns,
            batch: Batch::default(),
            extractor: ObservableExtractor::default(),
            unknowns,
        };
        Ok(Built { forward, about, notices })
    }
}

/// Name of the candidate of no dependence on pressure.
pub(super) const CONSTANT: &str = "constant stiffness";

/// Range of its stiffness, up and down.
const CONSTANT_RANGE: f64 = 30.0;

/// Refuses two unknowns for one number.
fn check_overlap(unknowns: &Unknowns) -> Result<(), ProblemError> {
    let pointers: Vec<&str> = unknowns.pointers().collect();
    for (index, pointer) in pointers.iter().enumerate() {
        let inside = |other: &&&str| {
            pointer
                .strip_prefix(**other)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let others = pointers.iter().enumerate().filter(|(other, _)| *other != index);
        if let Some(other) = others.map(|(_, other)| other).find(inside) {
            let (pointer, by) = ((*pointer).to_owned(), format!("{other} is another unknown"));
            return Err(ProblemError::Contradiction { pointer, by });
        }
    }
    Ok(())
}
