//! Forward models of a problem, of the laws compared with its own, and of planned hits.

use std::sync::Arc;

use asperity_dynamics::Batch;
use serde_json::{Value, json};

use crate::built_model::{BuiltModel, Loader};
use crate::error::IdentificationError;
use crate::hit::apply;
use crate::identification_problem::IdentificationProblem;
use crate::law_band::Reached;
use crate::observed_quantity::SummaryColumns;
use crate::problem::{CandidateSpec, DataSpec, ParameterSpec};
use crate::problem_parameters::{ProblemParameters, is_within};
use crate::scenario_laws::{no_law, unnamed_law};
use crate::scenario_model::ScenarioModel;
use asperity_scenario::{JsonPointer, has_matrices, with_absolute_files};
use asperity_simulation::observable_extractor::ObservableExtractor;

impl IdentificationProblem {
    /// The model of the problem.
    pub(super) fn model(&self) -> Result<BuiltModel, IdentificationError> {
        self.check_gains(&self.spec.unknowns)?;
        let mut built = self.build(&self.scenario, &self.spec.unknowns, &self.spec.data)?;
        built.notices.splice(0..0, self.notices.iter().cloned());
        Ok(built)
    }

    /// The model of a candidate: with its changes, and without the parameters inside them.
    pub(super) fn candidate(
        &self,
        candidate: &CandidateSpec,
    ) -> Result<BuiltModel, IdentificationError> {
        let mut scenario = self.scenario.clone();
        apply(&mut scenario, &candidate.set, &format!("candidate \"{}\"", candidate.name))?;
        let changed = |pointer: &str| candidate.set.keys().any(|set| is_within(pointer, set));
        let stays = |parameter: &&ParameterSpec| match parameter {
            ParameterSpec::Scalar { pointer, also, .. } => {
                !changed(pointer) && !also.iter().any(|other| changed(other))
            }
            ParameterSpec::MonotoneLaw { law, .. } | ParameterSpec::FreeLaw { law, .. } => {
                !changed(&JsonPointer::root().child("laws").child(law).to_string())
            }
            ParameterSpec::Gain { .. } => true,
        };
        let kept = self.spec.unknowns.iter().filter(stays);
        let parameters: Vec<ParameterSpec> = kept.chain(&candidate.unknowns).cloned().collect();
        self.check_gains(&parameters)?;
        self.build(&scenario, &parameters, &self.spec.data)
    }

    /// The scenario with these parameters of the problem at `point`.
    pub(super) fn scenario_at(
        &self,
        unknowns: &[ParameterSpec],
        point: &[f64],
    ) -> Result<Value, IdentificationError> {
        let parameters = ProblemParameters::new(unknowns, &self.scenario)?;
        let mut scenario = self.scenario.clone();
        parameters.write(&mut scenario, point)?;
        Ok(scenario)
    }

    /// [`scenario_at`](Self::scenario_at) with absolute names of files.
    pub(super) fn scenario_for_any_folder(
        &self,
        unknowns: &[ParameterSpec],
        point: &[f64],
    ) -> Result<Value, IdentificationError> {
        let scenario = self.scenario_at(unknowns, point)?;
        Ok(with_absolute_files(scenario, self.scenario_folder()))
    }

    /// Pointers to the values of the scenario that these parameters change, and those values at each
    /// of `points`.
    pub(super) fn changes_at(
        &self,
        unknowns: &[ParameterSpec],
        points: &[Vec<f64>],
    ) -> Result<(Vec<String>, Vec<Vec<Value>>), IdentificationError> {
        let parameters = ProblemParameters::new(unknowns, &self.scenario)?;
        let changes = points.iter().map(|point| parameters.written(&self.scenario, point));
        let changes = changes.collect::<Result<_, _>>()?;
        Ok((parameters.pointers().map(str::to_owned).collect(), changes))
    }

    /// The model of other data with the same parameters, without the gains of named data.
    pub(super) fn planned(&self, data: &[DataSpec]) -> Result<ScenarioModel, IdentificationError> {
        Ok(self.build(&self.scenario, &self.spec.unknowns, data)?.forward)
    }

    /// Name of the law to report.
    pub(super) fn law(&self) -> Result<String, IdentificationError> {
        let of_interface = || self.scenario.pointer("/interfaces/0/law")?.as_str();
        let name = self.spec.law.as_deref().or_else(of_interface);
        let Some(name) = name else { return Err(unnamed_law(&self.scenario)) };
        match self.scenario.pointer("/laws").and_then(|laws| laws.get(name)) {
            Some(_) => Ok(name.to_owned()),
            None => Err(no_law(&self.scenario, name)),
        }
    }

    /// The candidate without dependence on pressure: `law` replaced by a constant `stiffness` \[Pa/m\].
    pub(super) fn constant(law: &str, stiffness: f64) -> CandidateSpec {
        let pointer = JsonPointer::root().child("laws").child(law).to_string();
        let spec = json!({"kind": "constant", "stiffness_pa_per_m": stiffness});
        CandidateSpec {
            name: CONSTANT.to_owned(),
            set: [(pointer.clone(), spec)].into_iter().collect(),
            unknowns: vec![ParameterSpec::Scalar {
                pointer: format!("{pointer}/stiffness_pa_per_m"),
                also: Vec::new(),
                name: Some("constant stiffness [Pa/m]".to_owned()),
                bounds: [stiffness / CONSTANT_RANGE, stiffness * CONSTANT_RANGE],
                start: None,
                scale: None,
                prior: None,
            }],
        }
    }

    /// The problem with the pressures of its free laws, from the runs with the scenario's law.
    pub(super) fn with_pressures(&self) -> Result<Self, IdentificationError> {
        let mut known = self.clone();
        let is_free = |spec: &ParameterSpec| matches!(spec, ParameterSpec::FreeLaw { .. });
        if !self.spec.unknowns.iter().any(is_free) {
            return Ok(known);
        }
        let others: Vec<ParameterSpec> =
            self.spec.unknowns.iter().filter(|spec| !is_free(spec)).cloned().collect();
        let forward = self.build(&self.scenario, &others, &self.spec.data)?.forward;
        for spec in &mut known.spec.unknowns {
            let ParameterSpec::FreeLaw { law, pressures_pa, at_pa, .. } = spec else { continue };
            if pressures_pa.is_some() && at_pa.is_some() {
                continue;
            }
            if self.scenario["laws"].get(&*law).is_none() {
                return Err(no_law(&self.scenario, law));
            }
            let Reached { range: [low, high], at_rest } =
                Reached::of(&forward, law, &forward.start())?;
            // The data do not inform the law where contact is nearly lost.
            let low = low.max(LEAST_SHARE * at_rest);
            pressures_pa.get_or_insert([low / BEYOND, high * BEYOND]);
            at_pa.get_or_insert(at_rest);
        }
        Ok(known)
    }

    /// Checks the names of the data of gains.
    fn check_gains(&self, parameters: &[ParameterSpec]) -> Result<(), IdentificationError> {
        let data = self.spec.data.iter().enumerate();
        let known: Vec<String> = data.map(|(index, data)| data.name_or_kind(index)).collect();
        let named = parameters.iter().filter_map(|parameter| match parameter {
            ParameterSpec::Gain { data, .. } => data.as_ref(),
            _ => None,
        });
        match named.flatten().find(|name| !known.contains(name)) {
            None => Ok(()),
            Some(name) => {
                Err(IdentificationError::NoData { name: name.clone(), known: known.join(", ") })
            }
        }
    }

    fn build(
        &self,
        scenario: &Value,
        specs: &[ParameterSpec],
        data: &[DataSpec],
    ) -> Result<BuiltModel, IdentificationError> {
        self.check_scenario(scenario)?;
        let parameters = ProblemParameters::new(specs, scenario)?;
        check_overlap(&parameters)?;
        let named = |section: &str| -> Vec<&str> {
            let items = scenario.get(section).and_then(Value::as_array).into_iter().flatten();
            items.filter_map(|item| item.get("name")?.as_str()).collect()
        };
        let sensors = if has_matrices(scenario) { named("sensors") } else { Vec::new() };
        let further = sensors.get(1..).unwrap_or_default();
        let forward = ScenarioModel {
            scenario: scenario.clone(),
            folder: self.scenario_folder().to_owned(),
            reductions: Arc::clone(&self.reductions),
            rigs: Vec::new(),
            hits: Vec::new(),
            quantities: Vec::new(),
            observations: Vec::new(),
            stiffness: Vec::new(),
            sweeps: Vec::new(),
            columns: SummaryColumns::new(&named("interfaces"), further),
            batch: Batch::default(),
            extractor: ObservableExtractor::default(),
            work: Arc::clone(&self.work),
            parameters,
        };
        let built = BuiltModel { forward, about: Vec::new(), notices: Vec::new() };
        let mut loader = Loader { problem: self, built, blocks: 0 };
        for (index, data) in data.iter().enumerate() {
            loader.load(index, data)?;
        }
        let mut built = loader.built;
        built.forward.hold_first();
        Ok(built)
    }
}

/// Factor from the pressures that the data reach to the pressures of a free law.
const BEYOND: f64 = 2.0;

/// Least pressure of a free law over the static one, times [`BEYOND`].
const LEAST_SHARE: f64 = 0.01;

/// Name of the candidate without dependence on pressure.
pub(super) const CONSTANT: &str = "constant stiffness";

/// Ratio of the bounds of its stiffness to its start.
const CONSTANT_RANGE: f64 = 30.0;

/// Checks that no number has two parameters. Numbers of a law that a free law deviates from have one.
fn check_overlap(parameters: &ProblemParameters) -> Result<(), IdentificationError> {
    let pointers: Vec<&str> = parameters.pointers_of_numbers().collect();
    for (index, pointer) in pointers.iter().enumerate() {
        let mut others = pointers.iter().enumerate().filter(|(other, _)| *other != index);
        if let Some((_, other)) = others.find(|(_, other)| is_within(pointer, other)) {
            let by = format!("so is {other}, which contains it");
            return Err(IdentificationError::Contradiction { pointer: (*pointer).to_owned(), by });
        }
    }
    Ok(())
}
