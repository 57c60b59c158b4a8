//! Judgement of both engines on one scenario: by their agreement, or else by refined runs.
//!
//! Where the answers with default settings agree within the tolerances, both are right. Elsewhere
//! both engines run again, refined, unless both say that they may be wrong: modal steps of a quarter
//! of the first (or half the one chosen), 20 modes a body (or one and a half times the most chosen),
//! cells of a third. Refined runs of both that agree within half the tolerances are the truth.
//! Otherwise both are refined once more, to a sixteenth of the step, 40 modes (or twice the most
//! chosen) and a sixth of the cell, and an observable in which those agree within the tolerance, and
//! with the less refined run of either engine, has that truth. An observable without such an
//! agreement has none: the response is chaotic, or beyond both engines.

use asperity_dynamics::Integrator;
use asperity_scenario::{Document, FiniteDifferenceSpec, MethodSpec, ModalSpec, Scenario};
use asperity_simulation::assemble::Assembly;
use serde::{Deserialize, Serialize};

use super::answer::{Answer, Kind, Observable, Outcome, run};

/// Refinement of both engines, as divisors of their default step and cell.
struct Refinement {
    step: f64,
    cell: f64,
    modes_per_body: usize,
    /// Least modes over those that the default answer has chosen.
    more_modes: f64,
}

/// Refinements, one after the other.
const REFINEMENTS: [Refinement; 3] = [
    Refinement { step: 4.0, cell: 3.0, modes_per_body: 20, more_modes: 1.5 },
    Refinement { step: 16.0, cell: 6.0, modes_per_body: 40, more_modes: 2.0 },
    Refinement { step: 64.0, cell: 12.0, modes_per_body: 80, more_modes: 3.0 },
];

/// Most modes of a body that a scenario may ask for.
const MOST_MODES: usize = 2000;

/// True value of an observable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct TrueValue {
    /// The observable: the mean of two answers.
    #[serde(flatten)]
    pub(super) observable: Observable,
    /// Half the difference of these answers, in tolerances.
    pub(super) uncertainty: f64,
    /// False where no two answers agree.
    pub(super) known: bool,
}

impl TrueValue {
    /// The mean of two values, known where they are within `tolerances` of each other.
    fn new(one: &Observable, other: &Observable, tolerances: f64) -> Self {
        let distance = one.distance(other.value).max(other.distance(one.value));
        let value = match (one.value, other.value) {
            (Some(a), Some(b)) => Some(0.5 * (a + b)),
            (a, b) => a.or(b),
        };
        let scale = 0.5 * (one.scale + other.scale);
        let observable = Observable { value, scale, ..one.clone() };
        let uncertainty = one.value.map_or(0.0, |_| observable.distance(one.value));
        Self { observable, uncertainty, known: distance <= tolerances }
    }

    /// Error of `value` beyond the uncertainty, in tolerances.
    fn error(&self, value: Option<f64>) -> f64 {
        (self.observable.distance(value) - self.uncertainty).max(0.0)
    }
}

/// Class of an engine's default answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Class {
    /// Right within the tolerances.
    Right,
    /// Ended in an error.
    Refused,
    /// Wrong, and the answer says that it may be.
    NamedWrong,
    /// Wrong without a word, or a panic.
    SilentlyWrong,
    /// Without a truth to judge by, and the answer says that it may be wrong.
    NamedUndecided,
    /// Without a truth to judge by, without a word.
    SilentlyUndecided,
}

impl Class {
    /// All classes.
    pub(super) const ALL: [Self; 6] = [
        Self::Right,
        Self::Refused,
        Self::NamedWrong,
        Self::SilentlyWrong,
        Self::NamedUndecided,
        Self::SilentlyUndecided,
    ];

    /// Description in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Refused => "refused",
            Self::NamedWrong => "wrong, named",
            Self::SilentlyWrong => "SILENTLY WRONG",
            Self::NamedUndecided => "no truth, named",
            Self::SilentlyUndecided => "no truth, silent",
        }
    }
}

/// An observable in which an answer is wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct WrongValue {
    pub(super) name: String,
    pub(super) value: Option<f64>,
    pub(super) truth: Option<f64>,
    /// Error in tolerances; none where one has no value.
    pub(super) tolerances: Option<f64>,
}

/// Judgement of one engine's default answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct EngineJudgement {
    pub(super) class: Class,
    /// Words of the error or panic.
    pub(super) error: Option<String>,
    /// Statements of the answer that it may be wrong.
    pub(super) reservations: Vec<String>,
    /// Step \[s\].
    pub(super) step_s: Option<f64>,
    /// Residual of the energy balance.
    pub(super) residual: Option<f64>,
    /// The worst first.
    pub(super) wrong: Vec<WrongValue>,
}

impl EngineJudgement {
    /// The judgement of `outcome` by the true values.
    pub(super) fn new(outcome: &Outcome, truth: &[TrueValue]) -> Self {
        let answer = match outcome {
            Outcome::Answered(answer) => answer,
            Outcome::Refused(error) => return Self::without(Class::Refused, error),
            Outcome::Panicked(panic) => return Self::without(Class::SilentlyWrong, panic),
        };
        let mut wrong: Vec<(f64, WrongValue)> = Vec::new();
        for truth in truth.iter().filter(|truth| truth.known) {
            let Observable { name, value: true_value, .. } = &truth.observable;
            let value = answer.value(name);
            let error = truth.error(value);
            if error > 1.0 {
                let (name, truth) = (name.clone(), *true_value);
                let tolerances = error.is_finite().then_some(error);
                wrong.push((error, WrongValue { name, value, truth, tolerances }));
            }
        }
        wrong.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        let unknown = truth.iter().filter(|truth| !truth.known);
        let unknown: Vec<&str> = unknown.map(|truth| truth.observable.name.as_str()).collect();
        let named = if wrong.is_empty() {
            answer.is_reserved_about(unknown.iter().copied())
        } else {
            answer.is_reserved_about(wrong.iter().map(|(_, wrong)| wrong.name.as_str()))
        };
        let class = match (wrong.is_empty(), unknown.is_empty(), named) {
            (false, _, true) => Class::NamedWrong,
            (false, _, false) => Class::SilentlyWrong,
            (true, true, _) => Class::Right,
            (true, false, true) => Class::NamedUndecided,
            (true, false, false) => Class::SilentlyUndecided,
        };
        Self {
            class,
            error: None,
            reservations: answer.reservations.clone(),
            step_s: Some(answer.step_s),
            residual: Some(answer.residual),
            wrong: wrong.into_iter().map(|(_, wrong)| wrong).collect(),
        }
    }

    fn without(class: Class, error: &str) -> Self {
        let error = Some(error.to_owned());
        let (reservations, wrong) = (Vec::new(), Vec::new());
        Self { class, error, reservations, step_s: None, residual: None, wrong }
    }
}

/// Default answers of both engines, and the truth.
pub(super) struct Judgement {
    pub(super) modal: EngineJudgement,
    pub(super) finite_difference: EngineJudgement,
    pub(super) truth: Vec<TrueValue>,
    /// The default answer of modes, if there is one.
    pub(super) answer: Option<Answer>,
    /// True if a default answer opens a contact for a time.
    pub(super) contact_lost: bool,
    /// Refinements that the truth took.
    pub(super) refinements: usize,
}

/// A scenario to be run by both engines.
pub(super) struct Case<'a> {
    pub(super) document: &'a Document,
    pub(super) scenario: &'a Scenario,
}

impl Case<'_> {
    /// Judges the default answers of both engines by each other, or by refined runs.
    pub(super) fn judge(&self) -> Judgement {
        let [modal, finite_difference] = self.defaults();
        if let (Some(one), Some(other)) = (modal.answer(), finite_difference.answer())
            && one.distance(other).max(other.distance(one)) <= 1.0
        {
            return Self::judgement(&modal, &finite_difference, mean(one, other, 1.0), 0);
        }
        if modal.is_reserved() && finite_difference.is_reserved() {
            return Self::judgement(&modal, &finite_difference, Self::unknown(), 0);
        }
        let (truth, refinements) = self.refined_truth(&modal, &REFINEMENTS[..2]);
        Self::judgement(&modal, &finite_difference, truth, refinements)
    }

    /// Judges the default answers of both engines by a known truth.
    pub(super) fn judge_by(&self, truth: &[TrueValue]) -> Judgement {
        let [modal, finite_difference] = self.defaults();
        Self::judgement(&modal, &finite_difference, truth.to_vec(), 0)
    }

    fn judgement(
        modal: &Outcome,
        finite_difference: &Outcome,
        truth: Vec<TrueValue>,
        refinements: usize,
    ) -> Judgement {
        Judgement {
            modal: EngineJudgement::new(modal, &truth),
            finite_difference: EngineJudgement::new(finite_difference, &truth),
            truth,
            answer: modal.answer().cloned(),
            contact_lost: [modal, finite_difference]
                .iter()
                .any(|outcome| outcome.answer().is_some_and(|answer| answer.contact_lost)),
            refinements,
        }
    }

    /// The answers with default settings.
    fn defaults(&self) -> [Outcome; 2] {
        let cells = MethodSpec::FiniteDifference(FiniteDifferenceSpec::default());
        [MethodSpec::default(), cells].map(|method| run(self.document, self.scenario, method))
    }

    /// The true values by refined runs, to one refinement more than [`judge`](Self::judge) takes.
    pub(super) fn truth(&self) -> Vec<TrueValue> {
        let [modal, _] = self.defaults();
        self.refined_truth(&modal, &REFINEMENTS).0
    }

    /// The true values by refined runs, and the number of refinements; `modal` is the default
    /// answer.
    fn refined_truth(
        &self,
        modal: &Outcome,
        refinements: &[Refinement],
    ) -> (Vec<TrueValue>, usize) {
        let steps = [self.default_step(), modal.answer().map(|answer| 2.0 * answer.step_s)];
        let step = steps.into_iter().flatten().reduce(f64::min);
        let modes = modal.answer().map_or(0, |answer| answer.modes_per_body);
        let mut truth = Vec::new();
        let mut coarse: Option<[Outcome; 2]> = None;
        for (number, refinement) in refinements.iter().enumerate() {
            let fine = self.refined(step, modes, refinement);
            let answers = [fine[0].answer(), fine[1].answer()];
            truth = match (answers, &coarse) {
                ([Some(one), Some(other)], None) => {
                    let all = mean(one, other, 0.5);
                    if all.iter().all(|truth| truth.known) { all } else { Vec::new() }
                }
                ([Some(one), Some(other)], Some(coarse)) => {
                    confirmed(mean(one, other, 1.0), coarse)
                }
                // An engine that refuses leaves the convergence of the other.
                ([Some(fine), None], Some([Outcome::Answered(coarse), _]))
                | ([None, Some(fine)], Some([_, Outcome::Answered(coarse)])) => {
                    mean(fine, coarse, 0.5)
                }
                _ => Vec::new(),
            };
            if !truth.is_empty() && truth.iter().all(|truth| truth.known) {
                return (truth, number + 1);
            }
            coarse = Some(fine);
        }
        (if truth.is_empty() { Self::unknown() } else { truth }, refinements.len())
    }

    /// Refined runs of both engines, the modal one with a part of `step`: that which it tries first,
    /// or twice the one it has chosen; and with more `modes` of a body than it has chosen.
    fn refined(&self, step: Option<f64>, modes: usize, refinement: &Refinement) -> [Outcome; 2] {
        let step_s = step.map(|step| step / refinement.step);
        let more = (modes as f64 * refinement.more_modes).ceil() as usize;
        let modal = ModalSpec {
            step_s,
            modes_per_body: Some(refinement.modes_per_body.max(more).min(MOST_MODES)),
            ..ModalSpec::default()
        };
        let default = FiniteDifferenceSpec::default();
        let cell_m = default.cell_m / refinement.cell;
        let cells = FiniteDifferenceSpec { cell_m, ..default };
        let methods = [MethodSpec::Modal(modal), MethodSpec::FiniteDifference(cells)];
        methods.map(|method| run(self.document, self.scenario, method))
    }

    /// The step that the modal engine tries first.
    fn default_step(&self) -> Option<f64> {
        let assembly = Assembly::new(self.scenario, self.document.folder()).ok()?;
        let Assembly { structure, load, sampling, .. } = &assembly;
        let outline = Integrator::default().outline(structure, load, sampling).ok()?;
        Some(outline.step)
    }

    /// A truth in which nothing is known.
    fn unknown() -> Vec<TrueValue> {
        let observable = Observable::new("fundamental.frequency_hz", Kind::Frequency, None);
        vec![TrueValue { observable, uncertainty: 0.0, known: false }]
    }
}

/// The means of two answers, known where they are within `tolerances` of each other.
fn mean(one: &Answer, other: &Answer, tolerances: f64) -> Vec<TrueValue> {
    let pairs = one.observables.iter().zip(&other.observables);
    pairs.map(|(one, other)| TrueValue::new(one, other, tolerances)).collect()
}

/// These true values, known where one of the less refined answers is within a tolerance of each.
fn confirmed(mut truth: Vec<TrueValue>, coarse: &[Outcome; 2]) -> Vec<TrueValue> {
    for one in &mut truth {
        let name = &one.observable.name;
        let mut answers = coarse.iter().filter_map(Outcome::answer);
        one.known &= answers.any(|answer| one.error(answer.value(name)) <= 1.0);
    }
    truth
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn answer(frequency: f64, ratio: Option<f64>, reservations: &[&str]) -> Answer {
        Answer {
            observables: vec![
                Observable::new("f", Kind::Frequency, Some(frequency)),
                Observable::new("r", Kind::Ratio, ratio),
            ],
            stated: BTreeMap::new(),
            reservations: reservations.iter().map(|&text| text.to_owned()).collect(),
            is_undecayed: false,
            step_s: 1e-5,
            modes_per_body: 3,
            residual: 1e-6,
            contact_lost: false,
        }
    }

    fn class(answer: Answer, truth: &[TrueValue]) -> Class {
        EngineJudgement::new(&Outcome::Answered(answer), truth).class
    }

    #[test]
    fn an_answer_is_classed_by_its_error_and_its_words() {
        let truth = mean(&answer(100.0, Some(0.1), &[]), &answer(100.02, Some(0.1), &[]), 0.5);
        assert!(truth.iter().all(|one| one.known));
        assert_eq!(class(answer(100.05, Some(0.1), &[]), &truth), Class::Right);
        assert_eq!(class(answer(100.08, Some(0.1), &[]), &truth), Class::SilentlyWrong);
        assert_eq!(class(answer(100.08, Some(0.1), &["sensitive"]), &truth), Class::NamedWrong);
        assert_eq!(class(answer(100.0, None, &[]), &truth), Class::SilentlyWrong);
        let refused = EngineJudgement::new(&Outcome::Refused("coarse".to_owned()), &truth);
        assert_eq!(refused.class, Class::Refused);
        let panicked = EngineJudgement::new(&Outcome::Panicked("index".to_owned()), &truth);
        assert_eq!(panicked.class, Class::SilentlyWrong);
    }

    #[test]
    fn an_observable_in_which_refined_answers_differ_has_no_truth() {
        let truth = mean(&answer(100.0, Some(0.1), &[]), &answer(100.0, Some(0.2), &[]), 1.0);
        assert_eq!(truth.iter().map(|one| one.known).collect::<Vec<_>>(), [true, false]);
        assert_eq!(class(answer(100.0, Some(0.1), &[]), &truth), Class::SilentlyUndecided);
        assert_eq!(class(answer(100.0, Some(0.1), &["sensitive"]), &truth), Class::NamedUndecided);
        assert_eq!(class(answer(101.0, Some(0.1), &[]), &truth), Class::SilentlyWrong);
    }

    #[test]
    fn a_truth_needs_a_less_refined_answer_beside_it() {
        let truth = mean(&answer(100.0, Some(0.1), &[]), &answer(100.0, Some(0.1), &[]), 1.0);
        let refused = || Outcome::Refused("coarse".to_owned());
        let coarse = [refused(), Outcome::Answered(answer(100.04, Some(0.3), &[]))];
        let known: Vec<bool> = confirmed(truth, &coarse).iter().map(|one| one.known).collect();
        assert_eq!(known, [true, false]);
    }
}
