//! The loop over time.

use asperity_mesh::Grid;
use asperity_structure::PreloadedStructure;
use pulp::{Simd, WithSimd};

use super::ContactForm;
use super::bar::{Bar, BarStorage, fused};
use super::contact::ContactStep;
use super::guide::GuideStep;
use super::ledger::Ledger;
use super::support::SupportStep;
use crate::{DynamicsError, EnergyLedger, History, Transient};

/// Most steps between two measurements of the viscous power.
const LEDGER_STEPS: usize = 32;

/// Samples between two calls of the progress listener.
const PROGRESS_SAMPLES: usize = 1024;

/// A whole run, to be carried out with one set of vector instructions.
pub(super) struct TimeLoop<'a> {
    pub(super) structure: &'a PreloadedStructure,
    pub(super) grid: &'a Grid,
    pub(super) form: ContactForm,
    pub(super) load: &'a asperity_structure::LoadCase,
    pub(super) samples: usize,
    pub(super) stride: usize,
    pub(super) step: f64,
    pub(super) progress: &'a (dyn Fn(f64) + Sync),
}

impl WithSimd for TimeLoop<'_> {
    type Output = Result<Transient, DynamicsError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut storage: Vec<BarStorage> = self.grid.bars().iter().map(BarStorage::new).collect();
        let mut state = State::new(&self, simd, &mut storage)?;
        let mut history = History::with_capacity(self.samples, 1, state.contacts.len());
        let mut forces = vec![0.0; self.stride];
        let mut ledger = Ledger::default();
        for sample in 0..self.samples {
            let start = (sample * self.stride) as f64 * self.step;
            for (n, force) in forces.iter_mut().enumerate() {
                *force = self.load.value(start + n as f64 * self.step);
            }
            let force_at_sample = forces[0];
            if sample == 0 {
                // From rest, w+ = F dt^2 / (2 m): half of what the scheme gives with w- = 0.
                forces[0] *= 0.5;
            }
            for (part, forces) in forces.chunks(LEDGER_STEPS).enumerate() {
                let top = state.step(simd, forces[0], &mut ledger.input);
                let sample = (part == 0).then_some((start, force_at_sample, &top));
                state.record(&mut history, sample, forces.len());
                let half_step_on = start + ((part * LEDGER_STEPS) as f64 + 0.5) * self.step;
                ledger.measure(state.viscous_power(simd), half_step_on);
                for &force in &forces[1..] {
                    state.step(simd, force, &mut ledger.input);
                }
            }
            if let Some(interface) = state.overflow() {
                return Err(DynamicsError::Unstable { time_s: start, interface });
            }
            if sample % PROGRESS_SAMPLES == 0 {
                (self.progress)(sample as f64 / self.samples as f64);
            }
        }
        // The motion starts at rest: its image before t = 0 is w(-dt) = w(dt).
        history.sensors[0].acceleration[0] *= 2.0;
        (self.progress)(1.0);
        let steps = self.samples * self.stride;
        let end = steps as f64 * self.step;
        ledger.measure(state.viscous_power(simd), end - 0.5 * self.step);
        ledger.close(end);
        Ok(Transient {
            step: self.step,
            steps,
            contacts: state
                .contacts
                .iter()
                .map(|contact| contact.record(self.step, steps))
                .collect(),
            energy: state.balance(&ledger, self.form),
            history,
        })
    }
}

/// The top's displacement at three successive steps \[m\].
struct Top {
    before: f64,
    now: f64,
    after: f64,
}

struct State<'a, 'r, S: Simd> {
    bars: Vec<Bar<'r, S>>,
    contacts: Vec<ContactStep<'a>>,
    support: SupportStep,
    guides: Vec<GuideStep>,
    /// Additions of friction in guides to the closure that each contact would reach \[m\], and the
    /// traction found there \[Pa\]; kept with guides only.
    shifts: Vec<f64>,
    tractions: Vec<f64>,
    rate: f64,
    step: f64,
    steps: usize,
}

impl<'a, 'r, S: Simd> State<'a, 'r, S> {
    fn new(
        run: &TimeLoop<'a>,
        simd: S,
        storage: &'r mut [BarStorage],
    ) -> Result<Self, DynamicsError> {
        let grids = run.grid.bars().iter();
        let rate = run.structure.damping_rate();
        let bar = |(grid, storage)| Bar::new(simd, grid, storage, run.step, rate);
        let bars: Vec<_> = grids.zip(storage).map(bar).collect();
        let support = SupportStep::new(run.structure.stack().support(), run.step);
        let below = bars[1..].iter().map(|bar| bar.compliance).chain([support.compliance]);
        let contacts = run
            .structure
            .contacts()
            .iter()
            .zip(bars.iter().zip(below))
            .map(|(contact, (above, below))| {
                let scale = run.load.peak() / contact.area();
                let compliance = above.compliance + below;
                ContactStep::new(contact, run.form, compliance, run.step, scale)
            })
            .collect::<Result<_, _>>()?;
        let bodies = run.structure.stack().bodies().iter().enumerate();
        let guided = bodies.filter(|(_, body)| body.friction().is_some()).map(|(i, _)| i);
        let guides = run.structure.guides().iter().zip(guided);
        let guides = guides
            .map(|(guide, i)| GuideStep::new(guide, i, &run.grid.bars()[i], run.step, rate))
            .collect::<Result<_, _>>()?;
        let none = vec![0.0; run.structure.contacts().len()];
        let (shifts, tractions) = (none.clone(), none);
        let step = run.step;
        Ok(Self { bars, contacts, support, guides, shifts, tractions, rate, step, steps: 0 })
    }

    /// One step under `force` \[N\] on the top; adds the force's work \[J\] to `input`.
    #[inline(always)]
    fn step(&mut self, simd: S, force: f64, input: &mut f64) -> Top {
        self.steps += 1;
        if self.steps % 2 == 1 {
            self.step_from::<0>(simd, force, input)
        } else {
            self.step_from::<1>(simd, force, input)
        }
    }

    #[inline(always)]
    fn step_from<const PARITY: usize>(&mut self, simd: S, force: f64, input: &mut f64) -> Top {
        let guided = !self.guides.is_empty();
        if guided {
            self.begin_guides();
        }
        let (now, before) = self.bars[0].top();
        let lowest = self.bars.len() - 1;
        let (unloaded, mut bottom) = self.bars[0].unloaded_ends::<PARITY>();
        let after = fused::<S>(force, self.bars[0].compliance, unloaded);
        let mut top = after;
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            let (face_below, bottom_below, compliance_below) = if i == lowest {
                (self.support.unloaded(), 0.0, self.support.compliance)
            } else {
                let below = &self.bars[i + 1];
                let (top, bottom) = below.unloaded_ends::<PARITY>();
                (top, bottom, below.compliance)
            };
            let bar = &mut self.bars[i];
            let shift = if guided { self.shifts[i] } else { 0.0 };
            let unloaded = bottom - face_below;
            let increment = contact.solve::<S>(if guided { unloaded + shift } else { unloaded });
            if guided {
                self.tractions[i] = increment;
            }
            let area = contact.area();
            let reached_above = fused::<S>(-increment, area * bar.compliance, bottom);
            let reached_below = fused::<S>(increment, area * compliance_below, face_below);
            let reached = reached_above - reached_below;
            contact.advance(if guided { reached + shift } else { reached });
            bar.advance_ends(top, reached_above);
            (top, bottom) = (reached_below, bottom_below);
        }
        self.support.advance(top);
        // After all contacts, so that their chains of dependent instructions
        // run side by side instead of one behind the other's sweep.
        for bar in &mut self.bars {
            bar.sweep::<PARITY>(simd);
        }
        let mut reached = Top { before, now, after };
        if guided {
            self.complete_guides(force, &mut reached);
        }
        *input += 0.5 * force * (reached.after - reached.before);
        reached
    }

    /// Takes up the friction in the guides.
    #[inline(never)]
    fn begin_guides(&mut self) {
        self.shifts.fill(0.0);
        for guide in &mut self.guides {
            let contact = &self.contacts[guide.contact];
            guide.begin(contact.area() * contact.normal());
            let [next, ..] = guide.shift();
            self.shifts[guide.body] += next;
            if let Some(above) = guide.body.checked_sub(1) {
                self.shifts[above] -= next;
            }
        }
    }

    /// Moves the guided bodies on under `force` \[N\] on the top and the tractions found, and adds
    /// what friction causes to the displacement of the top.
    #[inline(never)]
    fn complete_guides(&mut self, force: f64, top: &mut Top) {
        let pushed = |i: usize| self.contacts[i].area() * self.tractions[i];
        for guide in &mut self.guides {
            let above = guide.body.checked_sub(1).map_or(force, pushed);
            guide.advance(above - pushed(guide.body));
            if guide.body == 0 {
                let [after, now, before] = guide.shift();
                top.after += after;
                top.now += now;
                top.before += before;
            }
        }
    }

    /// Viscous power of the bodies \[W\] half a step before the newest state.
    #[inline(always)]
    fn viscous_power(&self, simd: S) -> f64 {
        // A loop, not an iterator's sum: its closure would be compiled on its own,
        // for the machine's plainest instructions, and each vector operation be a call.
        let (mut twice_kinetic_energy, mut internal) = (0.0, 0.0);
        for bar in &self.bars {
            twice_kinetic_energy += bar.twice_kinetic_energy(simd, self.step);
            internal += bar.internal_loss(self.step);
        }
        for guide in &self.guides {
            twice_kinetic_energy += 2.0 * guide.kinetic(self.step);
        }
        self.rate * twice_kinetic_energy + internal
    }

    /// Counts the state one step before the newest for `steps` in the averages, and keeps it in
    /// the history if it is a `sample`: time, force and motion of the top.
    fn record(&mut self, history: &mut History, sample: Option<(f64, f64, &Top)>, steps: usize) {
        if let Some((time, force, top)) = sample {
            let acceleration = (top.after - 2.0 * top.now + top.before) / (self.step * self.step);
            history.time.push(time);
            history.load.push(force);
            history.sensors[0].push([
                top.now,
                0.5 * (top.after - top.before) / self.step,
                acceleration,
            ]);
        }
        for (contact, columns) in self.contacts.iter_mut().zip(&mut history.interfaces) {
            let observed = contact.observe();
            contact.average(observed.2, steps);
            if sample.is_some() {
                columns.push(observed);
            }
        }
    }

    /// The first interface whose numbers are not finite any more, if any.
    fn overflow(&self) -> Option<String> {
        let lost = self.contacts.iter().find(|contact| !contact.is_finite());
        let name = lost.or(self.contacts.first()).map(|contact| contact.name().to_owned());
        name.filter(|_| lost.is_some() || !self.bars[0].top().0.is_finite())
    }

    fn balance(&self, ledger: &Ledger, form: ContactForm) -> EnergyLedger {
        let (mut kinetic, mut elastic) = self.support.energy(self.step);
        for bar in &self.bars {
            let (bar_kinetic, bar_elastic) = bar.energy(self.step);
            kinetic += bar_kinetic;
            elastic += bar_elastic;
        }
        let mut friction = (0.0, 0.0);
        let mut count = |(stored, lost): (f64, f64)| {
            friction = (friction.0 + stored, friction.1 + lost);
        };
        for guide in &self.guides {
            kinetic += guide.kinetic(self.step);
            count(guide.energy());
        }
        self.contacts.iter().for_each(|step| count(step.friction_energy()));
        let (friction_stored, friction_dissipated) = friction;
        let (mut contact, mut work, mut contact_dissipated) = (0.0, 0.0, 0.0);
        for step in &self.contacts {
            let (stored, done) = step.energy();
            contact += stored;
            work += done;
            contact_dissipated += step.loss();
        }
        EnergyLedger {
            input: ledger.input,
            dissipated: ledger.dissipated
                + self.support.loss
                + contact_dissipated
                + friction_dissipated,
            contact_dissipated,
            friction_dissipated,
            kinetic,
            elastic: elastic + friction_stored,
            contact,
            numerical_loss: if form == ContactForm::NewLevel { work - contact } else { 0.0 },
        }
    }
}
