//! Steps and modes of the levels of a refinement.

use asperity_dynamics::Modal;

/// Most modes of a body that a scenario does not give. Modes too fast for the step count as flexibility in
/// any case.
const MOST_MODES: usize = 512;

/// Halvings of the first step, and doublings of the first modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct Level {
    pub(super) step: i32,
    pub(super) modes: i32,
}

/// First level at steps of its own: what opens and closes excites more modes.
const FIRST_VARIED: Level = Level { step: 1, modes: 3 };

/// Level at steps of its own of a draft.
const DRAFT_VARIED: Level = Level { step: 0, modes: 2 };

/// Step and modes that a refinement begins with.
#[derive(Debug, Clone)]
pub(super) struct FirstLevel {
    /// Modes of each body.
    counts: Vec<usize>,
    /// Step \[s\].
    step: f64,
    /// True if the scenario gives the step, or the modes.
    pub(super) step_is_given: bool,
    pub(super) modes_are_given: bool,
}

impl FirstLevel {
    /// `counts` and `step` \[s\] as `modal` gives them, or as they follow from the structure: at least one
    /// elastic mode of each body then, whose share can be seen.
    pub(super) fn new(mut counts: Vec<usize>, step: f64, modal: &Modal) -> Self {
        let modes_are_given = modal.modes_per_body.is_some();
        if !modes_are_given {
            for count in &mut counts {
                *count = (*count).max(2);
            }
        }
        Self { counts, step, step_is_given: modal.step.is_some(), modes_are_given }
    }

    /// Modes of each body at a level: the rigid one always, of the elastic ones 0, 1, 3, 7, ...
    pub(super) fn counts_at(&self, level: Level) -> Vec<usize> {
        let factor = f64::from(level.modes).exp2();
        let modes =
            |&count: &usize| ((count as f64 * factor) as usize).clamp(1, MOST_MODES.max(count));
        self.counts.iter().map(modes).collect()
    }

    /// Step at a level \[s\].
    pub(super) fn step_at(&self, level: Level) -> f64 {
        self.step / f64::from(level.step).exp2()
    }

    /// First level at steps of its own.
    pub(super) fn varied(&self) -> Level {
        self.with_given_modes(FIRST_VARIED)
    }

    /// Level at steps of its own of a draft.
    pub(super) fn draft_varied(&self) -> Level {
        self.with_given_modes(DRAFT_VARIED)
    }

    fn with_given_modes(&self, level: Level) -> Level {
        if self.modes_are_given { Level { modes: 0, ..level } } else { level }
    }

    /// The level whose response shows the errors by the number of modes at `level`: half of them; twice
    /// where a scenario gives rigid modes alone.
    pub(super) fn of_other_modes(&self, level: Level) -> Level {
        let is_rigid = self.counts_at(level).iter().all(|&count| count == 1);
        Level { modes: level.modes + if is_rigid { 1 } else { -1 }, ..level }
    }
}
