//! Many hits at once.

use asperity_structure::PreloadedContact;
use std::cmp::Ordering;
use std::sync::Arc;

use super::block::CHUNK;
use super::dense::history;
use super::drive::DriveCourse;
use super::energy::ledger;
use super::lane::Lane;
use super::march::{End, Keep, March, Outcome, room};
use super::rig::ModalRig;
use super::step_size::{MOST_HALVINGS, Resolution};
use super::thin::Thinning;
use crate::{
    ContactRecord, DynamicsError, EnergyLedger, Excitation, InstructionSet, Sampling, Transient,
};

/// One hit on a rig.
#[derive(Debug, Clone)]
pub struct Hit {
    /// What is struck.
    pub rig: Arc<ModalRig>,
    /// With what.
    pub excitation: Excitation,
    /// How long it is watched \[s\].
    pub duration: f64,
    /// Step \[s\]; none to have it chosen.
    pub step: Option<f64>,
}

impl Hit {
    /// Step \[s\] that the hit is first tried with, and their number.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for a step or duration that is not positive and finite, or more
    /// than 4e8 steps.
    pub fn first_step(&self) -> Result<(f64, usize), DynamicsError> {
        Resolution::first(self).map(|resolution| (resolution.step, resolution.steps))
    }
}

/// What came of a hit.
#[derive(Debug, Clone, PartialEq)]
pub struct HitRecord {
    /// Step \[s\] and number of steps.
    pub step: f64,
    /// Number of steps.
    pub steps: usize,
    /// Displacement of the output \[m\], through the filter of `thinning`: sample j is the
    /// filter's output at step `j factor`, until the filter has run out.
    pub displacement: Vec<f64>,
    /// The filter.
    pub thinning: Arc<Thinning>,
    /// Extremes and averages at each contact, from the top down.
    pub contacts: Vec<ContactRecord>,
    /// The energy balance.
    pub energy: EnergyLedger,
}

/// Integrates hits in the lanes of vectors, on the calling thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Batch {
    /// Vector instructions to run on.
    pub instructions: InstructionSet,
}

impl Default for Batch {
    fn default() -> Self {
        Self { instructions: InstructionSet::detected() }
    }
}

/// A hit that is not finished: how it is tried next.
#[derive(Debug, Clone)]
pub(super) struct Attempt {
    index: usize,
    pub(super) lane: Lane,
    halvings: u32,
    reach: i32,
    thinning: Arc<Thinning>,
}

/// Doublings of the tabulated pressures before a hit is given up.
const MOST_DOUBLINGS: i32 = 24;

/// Doublings of the tables' reach after a pressure beyond it.
const REACH_FURTHER: i32 = 2;

impl Batch {
    /// Hits that are stepped side by side: batches of a multiple of this many waste no lane.
    pub fn room(&self) -> usize {
        room(self.instructions)
    }

    /// The records of `hits`, in their order; a hit that fails has its own error and disturbs no
    /// other, and none depends on which others there are.
    ///
    /// `thinning` gives the filter for the output of hit `index` at a step \[s\].
    pub fn run(
        &self,
        hits: &[Hit],
        thinning: &dyn Fn(usize, f64) -> Arc<Thinning>,
    ) -> Vec<Result<HitRecord, DynamicsError>> {
        let mut results: Vec<Option<Result<HitRecord, DynamicsError>>> = vec![None; hits.len()];
        let mut shapes = Shapes::default();
        let mut attempts = Vec::with_capacity(hits.len());
        for (index, hit) in hits.iter().enumerate() {
            match Attempt::first(index, hit, &mut shapes, thinning) {
                Ok(attempt) => attempts.push(attempt),
                Err(error) => results[index] = Some(Err(error)),
            }
        }
        while !attempts.is_empty() {
            // Lanes of one rig and reach share their constants.
            attempts.sort_by(|a, b| a.kin(b).then(a.reach.cmp(&b.reach)));
            let mut again = Vec::new();
            for kindred in attempts.chunk_by(|a, b| a.kin(b) == Ordering::Equal) {
                for abreast in kindred.chunks(self.room()) {
                    let lanes: Vec<&Lane> = abreast.iter().map(|attempt| &attempt.lane).collect();
                    let keep = Keep::Thinned(&abreast[0].thinning);
                    let Some(outcomes) = (March { lanes: &lanes, keep }).run(self.instructions)
                    else {
                        for attempt in abreast {
                            results[attempt.index] = Some(Err(missing(self.instructions)));
                        }
                        continue;
                    };
                    for (attempt, outcome) in abreast.iter().zip(outcomes) {
                        let hit = &hits[attempt.index];
                        match attempt.next(hit, &outcome, &mut shapes, thinning) {
                            Ok(None) => {
                                results[attempt.index] = Some(Ok(attempt.record(outcome)));
                            }
                            Ok(Some(next)) => again.push(next),
                            Err(error) => results[attempt.index] = Some(Err(error)),
                        }
                    }
                }
            }
            attempts = again;
        }
        let lost = || Err(missing(self.instructions));
        results.into_iter().map(|result| result.unwrap_or_else(lost)).collect()
    }

    /// The whole response to one hit.
    ///
    /// # Errors
    /// As [`Modal::integrate`](super::Modal::integrate).
    pub fn transient(&self, hit: &Hit, sampling: &Sampling) -> Result<Transient, DynamicsError> {
        let (lane, outcome) = self.whole(hit)?;
        Ok(Transient {
            step: lane.prepared.model.step,
            steps: lane.steps,
            history: history(&lane, &outcome, &hit.excitation, sampling),
            contacts: contact_records(&lane, &outcome),
            energy: ledger(&lane, &outcome),
        })
    }

    /// The steps of one hit, at the step and with the tables that it needs.
    pub(super) fn whole(self, hit: &Hit) -> Result<(Lane, Outcome), DynamicsError> {
        let none = Arc::new(Thinning { factor: 1, taps: Arc::new([]) });
        let thinning = |_: usize, _: f64| Arc::clone(&none);
        let mut shapes = Shapes::default();
        let mut attempt = Attempt::first(0, hit, &mut shapes, &thinning)?;
        loop {
            let march = March { lanes: &[&attempt.lane], keep: Keep::Steps };
            let outcome = march
                .run(self.instructions)
                .and_then(|outcomes| outcomes.into_iter().next())
                .ok_or_else(|| missing(self.instructions))?;
            match attempt.next(hit, &outcome, &mut shapes, &thinning)? {
                Some(next) => attempt = next,
                None => return Ok((attempt.lane, outcome)),
            }
        }
    }
}

/// Power of two of the pressures \[Pa\] above rest that tables reach at first: three times the peak
/// over the area, or a quarter of the weight, whichever is more.
fn first_reach(hit: &Hit) -> i32 {
    let areas = hit.rig.contacts().iter().map(PreloadedContact::area);
    let smallest = areas.fold(f64::INFINITY, f64::min);
    let weight = hit.rig.contacts().iter().map(PreloadedContact::pressure);
    let scale = weight.fold(3.0 * hit.excitation.peak() / smallest, |m, p| m.max(0.25 * p));
    if scale > 0.0 { scale.log2().ceil().clamp(-30.0, 60.0) as i32 } else { 0 }
}

/// The error of a machine without an instruction set.
pub(super) fn missing(_: InstructionSet) -> DynamicsError {
    DynamicsError::Setting {
        quantity: "instruction set",
        value: f64::NAN,
        accepted: "one that this machine has",
    }
}

impl Attempt {
    fn first(
        index: usize,
        hit: &Hit,
        shapes: &mut Shapes,
        thinning: &dyn Fn(usize, f64) -> Arc<Thinning>,
    ) -> Result<Self, DynamicsError> {
        hit.excitation.check()?;
        let resolution = Resolution::first(hit)?;
        Self::at(index, hit, resolution, (0, first_reach(hit)), shapes, thinning)
    }

    fn at(
        index: usize,
        hit: &Hit,
        resolution: Resolution,
        (halvings, reach): (u32, i32),
        shapes: &mut Shapes,
        thinning: &dyn Fn(usize, f64) -> Arc<Thinning>,
    ) -> Result<Self, DynamicsError> {
        let Resolution { step, steps } = resolution;
        let (drive, amplitude) = shapes.course(&hit.excitation, step, steps);
        let prepared = hit.rig.prepare(step, reach)?;
        let lane = Lane { rig: Arc::clone(&hit.rig), prepared, drive, amplitude, steps };
        Ok(Self { index, lane, halvings, reach, thinning: thinning(index, step) })
    }

    /// Orders attempts so that those that can be marched together are neighbours; among them,
    /// those whose forces end together.
    fn kin(&self, other: &Self) -> Ordering {
        let key = |attempt: &Self| {
            let model = &attempt.lane.prepared.model;
            let size = (attempt.lane.steps, model.modes.len(), attempt.lane.rig.contacts().len());
            (size, attempt.thinning.factor, attempt.thinning.taps.len())
        };
        // Lanes share one filter, which must be that of each.
        let taps = || {
            if Arc::ptr_eq(&self.thinning.taps, &other.thinning.taps) {
                return Ordering::Equal;
            }
            let mut pairs = self.thinning.taps.iter().zip(&*other.thinning.taps);
            let unequal = pairs.find(|(a, b)| a.to_bits() != b.to_bits());
            unequal.map_or(Ordering::Equal, |(a, b)| a.total_cmp(b))
        };
        key(self).cmp(&key(other)).then_with(taps)
    }

    /// What to try next after an outcome; nothing if it will do.
    fn next(
        &self,
        hit: &Hit,
        outcome: &Outcome,
        shapes: &mut Shapes,
        thinning: &dyn Fn(usize, f64) -> Arc<Thinning>,
    ) -> Result<Option<Self>, DynamicsError> {
        let unstable = |steps: usize, i: usize| DynamicsError::Unstable {
            time_s: steps as f64 * self.lane.prepared.model.step,
            interface: self.lane.rig.contacts()[i].name().to_owned(),
        };
        let may_halve = hit.step.is_none() && self.halvings < MOST_HALVINGS;
        let (halvings, reach) = match outcome.end {
            End::Beyond(i) if self.doublings(hit) >= MOST_DOUBLINGS => {
                return Err(unstable(self.lane.steps, i));
            }
            End::Beyond(_) => (self.halvings, self.reach + REACH_FURTHER),
            // Below the table of a law that carries tension there are no numbers.
            End::NotFinite(..) if self.may_pull_further(hit) => {
                (self.halvings, self.reach + REACH_FURTHER)
            }
            End::NotFinite(..) if may_halve => (self.halvings + 1, self.reach),
            End::NotFinite(reached, i) => {
                return Err(unstable(reached.saturating_sub(8 * CHUNK), i));
            }
            End::Done => {
                let residual = ledger(&self.lane, outcome).residual_relative();
                if !(may_halve && Resolution::too_coarse(residual)) {
                    Resolution::accept(residual, self.lane.prepared.model.step)?;
                    return Ok(None);
                }
                (self.halvings + 1, self.reach)
            }
        };
        let finer = Resolution::halved(hit, halvings)?;
        Self::at(self.index, hit, finer, (halvings, reach), shapes, thinning).map(Some)
    }

    /// Doublings of the reach since the first attempt.
    fn doublings(&self, hit: &Hit) -> i32 {
        self.reach - first_reach(hit)
    }

    fn may_pull_further(&self, hit: &Hit) -> bool {
        let mut laws = hit.rig.contacts().iter().map(|contact| contact.law().domain());
        laws.any(|domain| domain.is_bilateral()) && self.doublings(hit) < MOST_DOUBLINGS
    }

    fn record(&self, outcome: Outcome) -> HitRecord {
        HitRecord {
            step: self.lane.prepared.model.step,
            steps: self.lane.steps,
            thinning: Arc::clone(&self.thinning),
            contacts: contact_records(&self.lane, &outcome),
            energy: ledger(&self.lane, &outcome),
            displacement: outcome.displacement,
        }
    }
}

/// Extremes as pressures, none below loss of contact, and the average stiffness.
pub(super) fn contact_records(lane: &Lane, outcome: &Outcome) -> Vec<ContactRecord> {
    let named = lane.rig.contacts().iter().zip(&outcome.contacts).enumerate();
    named
        .map(|(i, (contact, outcome))| {
            let (state, seen) = (contact.pressure(), &outcome.extremes);
            let open = seen.lowest <= lane.open_below(i);
            // A parabola through three steps can dip below what the law knows.
            let lowest = (state + seen.lowest).max(contact.law().domain().pressure_min);
            let stiffness = |gained: f64| {
                let closed = gained > lane.open_below(i);
                if closed { contact.law().stiffness(state + gained) } else { 0.0 }
            };
            // From steps 1 to N to steps 0 to N - 1.
            let shifted = (stiffness(0.0) - stiffness(outcome.pressure)) / lane.steps as f64;
            ContactRecord {
                pressure_min: if open { 0.0 } else { lowest },
                pressure_max: state + seen.highest,
                lost: seen.open_steps as f64 * lane.prepared.model.step,
                stiffness_average: outcome.stiffness + shifted,
            }
        })
        .collect()
}

/// Courses of force already computed: hits of one shape differ by a factor.
#[derive(Debug, Default)]
pub(super) struct Shapes {
    known: Vec<(Excitation, f64, usize, Arc<DriveCourse>)>,
}

/// Courses kept at a time.
const MOST_SHAPES: usize = 32;

impl Shapes {
    pub(super) fn course(
        &mut self,
        excitation: &Excitation,
        step: f64,
        steps: usize,
    ) -> (Arc<DriveCourse>, f64) {
        let (unit, factor) = excitation.unit();
        let same = |known: &&(Excitation, f64, usize, Arc<DriveCourse>)| {
            known.1 == step && known.2 == steps && known.0 == unit
        };
        if let Some(found) = self.known.iter().find(same) {
            return (Arc::clone(&found.3), factor);
        }
        let course = Arc::new(DriveCourse::new(&unit, step, steps));
        if self.known.len() >= MOST_SHAPES {
            self.known.clear();
        }
        self.known.push((unit, step, steps, Arc::clone(&course)));
        (course, factor)
    }
}
