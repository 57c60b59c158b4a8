//! A case on its way: its steps and their lengths.

use std::array;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_structure::LoadCase;
use pulp::Simd;

use super::StepControl;
use super::bend::{Bends, StepBefore};
use super::contact_solve::{Contact, FreeEnd, RowState, RowStep, solve};
use super::measures::{ContactMeasure, Measures};
use super::modal_motion::{ModalMotion, StepLoad, lanes};
use crate::contact_energy::excess;
use crate::modal::assembly::ModalModel;
use crate::modal::law_point::LawPoint;
use crate::modal::row_modes::RowMode;
use crate::modal::step_coefficients::{LANES, Lanes, StepCoefficients};
use crate::modal::transient_case::pressure_at;
use crate::{ContactExtremes, DynamicsError, EnergyLedger, History};

/// Halvings of the base step at most.
const MOST_HALVINGS: usize = 14;

/// Halvings of the base step at rest.
const FIRST_HALVINGS: usize = 4;

/// Error over its bound below which the next step is doubled: the error is of fourth order, and of sixth in bent steps.
const SMALL: f64 = 1.0 / 40.0;
const SMALL_IF_BENT: f64 = 1.0 / 160.0;

/// Traction over the static pressure that counts as the largest so far at rest.
const LEAST_TRACTION: f64 = 1e-3;

/// Energy of modes that ring, over the work of the load, that equal steps may leave out: their displacements are smaller than
/// the amplitude of the response by its root times the ratio of the frequencies.
const LEFT_ENERGY: f64 = 1e-5;

/// Pressure of a contact by modes that ring, over its range so far and over the root of the tolerance, that equal steps may
/// leave out: of a stiff contact it is a larger share than that of the energy.
const LEFT_PRESSURE: f64 = 0.5;

/// Acceleration at a sensor of modes that ring, over the largest there so far, that equal steps may leave out of a history.
const LEFT_ACCELERATION: f64 = 1e-2;

/// Steps of one case at most.
const MOST_STEPS: usize = 8_000_000;

/// A step length with its coefficients.
#[derive(Debug, Clone)]
struct Level<const N: usize> {
    coefficients: Arc<StepCoefficients>,
    rows: RowStep<N>,
}

/// End of a step that was tried.
#[derive(Debug, Clone, Copy)]
struct Attempt<const N: usize> {
    rows: RowState<N>,
    /// Bends of the tractions, if it is bent, and what they exceed those by which the modes have moved, if they do.
    bends: Option<Bends<N>>,
    changes: Option<Bends<N>>,
    /// Error of the tractions over the tolerance.
    error: f64,
    /// True if no contact opened or closed.
    is_smooth: bool,
}

/// A case on its way.
pub(super) struct Integration<'a, const N: usize> {
    model: &'a ModalModel,
    load: &'a LoadCase,
    contacts: Vec<Contact<'a>>,
    control: StepControl,
    exponents: &'a [i32],
    levels: Vec<Option<Arc<Level<N>>>>,
    /// Closure per load of the modes left out.
    closure_per_load: [f64; N],
    /// Participations of each sensor.
    sensors: Vec<Vec<Lanes>>,
    modes: ModalMotion<N>,
    rows: RowState<N>,
    /// Load and its rate.
    loaded: [f64; 2],
    /// Displacement \[m\] and velocity \[m/s\] of the load port.
    pub(super) load_port: [f64; 2],
    before: Option<StepBefore<N>>,
    /// Largest traction of each row so far.
    largest: [f64; N],
    measures: Measures,
    /// The law of each contact when it was last recorded.
    recorded: Vec<LawPoint>,
    /// Largest acceleration of each sensor that was recorded \[m/s2\].
    accelerations: Vec<f64>,
    /// Steps taken, and the shortest \[s\].
    pub(super) taken: usize,
    pub(super) shortest: f64,
    /// Base steps since a contact was near opening.
    pub(super) pressed: usize,
}

impl<'a, const N: usize> Integration<'a, N> {
    /// `load` on `model` from rest, with tables of laws up to `2^exponent` \[Pa\] above rest.
    pub(super) fn new(
        model: &'a ModalModel,
        load: &'a LoadCase,
        exponents: &'a [i32],
        control: StepControl,
    ) -> Result<Self, DynamicsError> {
        let tables = model.tables(exponents, control.table_tolerance())?;
        let pairs = model.contacts().iter().zip(tables);
        let contacts: Vec<Contact<'_>> =
            pairs.map(|(contact, table)| Contact::new(contact, table)).collect();
        let structure = model.row_modes();
        let (modes, rate) = (&structure.modes, model.preloaded().damping_rate());
        let areas: Vec<f64> = contacts.iter().map(Contact::area).collect();
        let sensor = |s: usize| {
            modes.chunks(LANES).map(|modes| lanes(modes, |mode| mode.sensors[s])).collect()
        };
        let of_contact =
            |i: usize| contacts.get(i).map_or(0.0, |contact| LEAST_TRACTION * contact.pressure());
        Ok(Self {
            model,
            load,
            control,
            exponents,
            levels: vec![None; MOST_HALVINGS + 1],
            closure_per_load: array::from_fn(|i| {
                structure.residual.load.get(i).copied().unwrap_or(0.0)
            }),
            sensors: (0..model.sensors()).map(sensor).collect(),
            modes: ModalMotion::at_rest(modes, &areas, rate),
            rows: RowState::at_rest(&contacts),
            loaded: [load.value(0.0), 0.0],
            load_port: [structure.residual.load_port * load.value(0.0), 0.0],
            before: None,
            largest: array::from_fn(of_contact),
            measures: Measures::new(&contacts),
            contacts,
            recorded: model.contacts().iter().map(LawPoint::at_rest).collect(),
            accelerations: vec![0.0; model.sensors()],
            taken: 0,
            shortest: control.base,
            pressed: 0,
        })
    }

    /// Integrates to the end, or until `stop` is set; `record` sees the state at the end of each base step, and
    /// their number, and may end the run there.
    #[inline(always)]
    pub(super) fn run<S: Simd>(
        &mut self,
        simd: S,
        mut record: impl FnMut(&mut Self, usize) -> ControlFlow<()>,
        stop: &AtomicBool,
    ) -> Result<(), DynamicsError> {
        let whole = 1_usize << MOST_HALVINGS;
        let mut level = FIRST_HALVINGS;
        let mut coefficients = self.level(level);
        for step in 0..self.control.steps {
            if stop.load(Ordering::Relaxed) {
                return Err(DynamicsError::Stopped { steps: self.taken });
            }
            // Parts of the base step that have passed, in steps of the shortest length.
            let mut passed = 0;
            self.pressed += 1;
            while passed < whole {
                let start = step as f64 + passed as f64 / whole as f64;
                let is_small = loop {
                    let load = self.load_within(&coefficients, start);
                    let is_shortest = level == MOST_HALVINGS;
                    if let Some(end) = self.attempt(simd, &coefficients, load, is_shortest)
                        && (end.error <= 1.0 || is_shortest)
                    {
                        let small = if end.bends.is_some() { SMALL_IF_BENT } else { SMALL };
                        self.complete(simd, &coefficients, load, &end);
                        break end.error < small;
                    }
                    if is_shortest || self.taken > MOST_STEPS {
                        return Err(self.unstable(start));
                    }
                    level += 1;
                    coefficients = self.level(level);
                };
                passed += whole >> level;
                if is_small
                    && level > 0
                    && passed.is_multiple_of(whole >> (level - 1))
                    && self.may_lengthen(level)
                {
                    level -= 1;
                    coefficients = self.level(level);
                }
            }
            if record(self, step + 1).is_break() {
                break;
            }
        }
        Ok(())
    }

    /// True if the modes that a step of twice the length does not show ring with so little energy that it
    /// may be lost.
    fn may_lengthen(&mut self, level: usize) -> bool {
        let (short, long) = (self.level(level), self.level(level - 1));
        self.ringing(Some(&short.coefficients), &long.coefficients)
            <= self.control.tolerance * self.measures.work.abs()
    }

    /// Pressures \[Pa\] that equal steps of `step` \[s\] would leave out of the contacts; none if they would lose too much
    /// energy of modes that ring, too much of the accelerations that were recorded or, while the load acts, of the pressures:
    /// later extremes may be as large as those so far.
    pub(super) fn left_by_steps(&self, step: f64, time: f64) -> Option<Vec<f64>> {
        let long = self.model.step_coefficients(step, self.exponents);
        let is_weak = self.ringing(None, &long) <= LEFT_ENERGY * self.measures.work.abs();
        let is_silent = || {
            self.accelerations.iter().enumerate().all(|(sensor, largest)| {
                *largest == 0.0 || self.ringing_at(sensor, &long) <= LEFT_ACCELERATION * largest
            })
        };
        if !(is_weak && is_silent()) {
            return None;
        }
        let most = LEFT_PRESSURE * self.control.tolerance.sqrt();
        let left = |(i, seen): (usize, ContactExtremes)| {
            let pressure = self.ringing_pressure(i, &long);
            if pressure <= most * (seen.pressure_max - seen.pressure_min) { 0.0 } else { pressure }
        };
        let left: Vec<f64> = self.contact_extremes().into_iter().enumerate().map(left).collect();
        (time > self.load.ends_at() || left.iter().all(|pressure| *pressure == 0.0)).then_some(left)
    }

    /// Largest pressure of a contact \[Pa\] by modes that ring, and follow their forces at once at `long` steps. A stiff contact
    /// is pressed through their flexibility, and less than without it.
    fn ringing_pressure(&self, contact: usize, long: &StepCoefficients) -> f64 {
        let share = |mode: &RowMode| mode.closure[contact].abs() / mode.angular_frequency;
        let stiffness = self.rows.stiffness[contact];
        self.sum_of_ringing(long, share) * stiffness
            / (1.0 + stiffness * long.follows[contact][contact])
    }

    /// Largest acceleration at a sensor \[m/s2\] by modes that ring, and follow their forces at once at `long` steps.
    fn ringing_at(&self, sensor: usize, long: &StepCoefficients) -> f64 {
        self.sum_of_ringing(long, |mode| mode.sensors[sensor].abs() * mode.angular_frequency)
    }

    /// Sum of `share` times the largest velocity of each mode that rings, and follows its forces at once at `long` steps.
    fn sum_of_ringing(&self, long: &StepCoefficients, share: impl Fn(&RowMode) -> f64) -> f64 {
        let modes = self.model.row_modes().modes.iter().enumerate();
        let following = modes.filter(|(n, _)| long.modes[*n].follows());
        let largest = |(n, mode): (usize, &RowMode)| {
            let [apart, velocity] = self.ringing_of(n, mode);
            share(mode) * apart.hypot(velocity)
        };
        following.map(largest).sum()
    }

    /// Displacement of mode n from where its forces hold it, times its angular frequency, and its velocity.
    fn ringing_of(&self, n: usize, mode: &RowMode) -> [f64; 2] {
        let w = mode.angular_frequency;
        let [displacement, velocity, force] = self.modes.of_mode(n);
        [w * displacement - (force + mode.load * self.loaded[0]) / w, velocity]
    }

    /// Energy of the modes that ring \[J\] and are in motion at `short` steps, if given, and follow their forces at
    /// once at `long` ones.
    fn ringing(&self, short: Option<&StepCoefficients>, long: &StepCoefficients) -> f64 {
        let mut ringing = 0.0;
        for (n, mode) in self.model.row_modes().modes.iter().enumerate() {
            let follows = |steps: &StepCoefficients| steps.modes[n].follows();
            if follows(long) && !short.is_some_and(follows) {
                let [apart, velocity] = self.ringing_of(n, mode);
                ringing += 0.5 * (velocity * velocity + apart * apart);
            }
        }
        ringing
    }

    #[cold]
    fn unstable(&self, start: f64) -> DynamicsError {
        DynamicsError::Unstable {
            time_s: start * self.control.base,
            interface: self.model.contacts()[0].name().to_owned(),
        }
    }

    fn level(&mut self, level: usize) -> Arc<Level<N>> {
        let (model, exponents, contacts) = (self.model, self.exponents, &self.contacts);
        let step = self.control.base / (1_usize << level) as f64;
        let known = self.levels[level].get_or_insert_with(|| {
            let coefficients = model.step_coefficients(step, exponents);
            let rows = RowStep::new(&coefficients, contacts);
            Arc::new(Level { coefficients, rows })
        });
        Arc::clone(known)
    }

    /// The load within the step from `start` base steps; none without a load.
    #[inline(always)]
    fn load_within(&self, level: &Level<N>, start: f64) -> Option<StepLoad> {
        let (begin, step) = (start * self.control.base, level.coefficients.step);
        if begin > self.load.ends_at() && self.loaded == [0.0; 2] {
            return None;
        }
        let (middle, last) = (self.load.value(begin + 0.5 * step), self.load.value(begin + step));
        let first = self.loaded[0];
        let (slope, bend) =
            (4.0 * middle - 3.0 * first - last, 2.0 * (first - 2.0 * middle + last));
        let end = [first + slope + bend, (slope + 2.0 * bend) / step];
        Some(StepLoad { coefficients: [first, slope, bend], end })
    }

    /// The end of a step; none where the contacts are not solved. In the shortest step a traction may jump, as
    /// damped faces meet.
    #[inline(always)]
    fn attempt<S: Simd>(
        &mut self,
        simd: S,
        level: &Level<N>,
        load: Option<StepLoad>,
        may_jump: bool,
    ) -> Option<Attempt<N>> {
        let step = level.coefficients.step;
        let guess = self.before.as_ref().map(|before| before.continued(&self.rows, step));
        let is_damped = level.rows.is_damped();
        // Not with dampers, whose tractions change faster than a step: bends by what was before would grow.
        let bends = match (&self.before, &guess) {
            (Some(before), Some(guess)) if before.is_smooth && !is_damped => {
                Some(before.bends([&self.rows, guess], step))
            }
            _ => None,
        };
        let guess = guess.unwrap_or(self.rows);
        let moved = bends;
        let [closure, rate, acceleration] =
            self.modes.move_freely(simd, &level.coefficients, (load, moved.as_ref()), is_damped);
        let mut free = FreeEnd { closure, rate, acceleration };
        if let Some(StepLoad { end: [value, slope], .. }) = load {
            for i in 0..N {
                free.closure[i] += self.closure_per_load[i] * value;
                free.rate[i] += self.closure_per_load[i] * slope;
            }
        }
        let end = solve(&self.contacts, &level.rows, &free, [&self.rows, &guess], &self.largest);
        let rows = end
            .or_else(|last| if may_jump && last.is_finite() { Ok(last) } else { Err(()) })
            .ok()?;
        let is_smooth = self.contacts.iter().enumerate().all(|(i, contact)| {
            let [before, after] = [&self.rows, &rows].map(|rows| rows.traction[i] <= contact.least);
            before == after
        });
        let bends = match &self.before {
            Some(before) if bends.is_some() && is_smooth => {
                Some(before.bends([&self.rows, &rows], step))
            }
            _ => None,
        };
        let share = self.before.as_ref().map_or(1.0, |one| one.error_share(step, bends.is_some()));
        let mut largest = 0.0_f64;
        for i in 0..self.contacts.len().min(N) {
            let scale = self.largest[i].max(rows.traction[i].abs());
            largest = largest.max((rows.traction[i] - guess.traction[i]).abs() / scale);
        }
        // Not bent if it had not moved by bends.
        let changes = moved.map(|moved| {
            let kept = bends.unwrap_or([[0.0; N]; 2]);
            array::from_fn(|k| array::from_fn(|i| kept[k][i] - moved[k][i]))
        });
        let error = share * largest / self.control.tolerance;
        Some(Attempt { rows, bends, changes, error, is_smooth })
    }

    /// Completes a step whose rows at its end are known.
    #[inline(always)]
    fn complete<S: Simd>(
        &mut self,
        simd: S,
        level: &Level<N>,
        load: Option<StepLoad>,
        end: &Attempt<N>,
    ) {
        let step = level.coefficients.step;
        let tractions = [end.rows.traction, end.rows.traction_rate];
        let forces = (&tractions, end.changes.as_ref());
        let done = self.modes.complete(simd, &level.coefficients, load, forces);
        self.measures.loss += done.loss;
        let begin = std::mem::replace(&mut self.rows, end.rows);
        self.loaded = load.map_or([0.0; 2], |load| load.end);
        let residual = &self.model.row_modes().residual;
        let by_load = self.loaded.map(|load| residual.load_port * load);
        let moved = array::from_fn(|k| by_load[k] + done.load_port[k]);
        let port = self.less_tractions(&residual.load, moved);
        let before = std::mem::replace(&mut self.load_port, port);
        if let Some(load) = load {
            self.measures.count_work(load.coefficients, [before, port], step);
        }
        self.measures.take(&self.contacts, [&begin, &self.rows], step);
        for i in 0..N {
            self.largest[i] = self.largest[i].max(self.rows.traction[i].abs());
        }
        for (contact, pressure) in self.contacts.iter().zip(&self.rows.pressure) {
            if contact.is_near_opening(*pressure) {
                self.pressed = 0;
            }
        }
        let earlier = self.before.as_ref().map_or(0.0, |before| before.step);
        let bent = end.bends.map(|bends| (bends, earlier));
        self.before = Some(StepBefore { step, rows: begin, bent, is_smooth: end.is_smooth });
        self.taken += 1;
        self.shortest = self.shortest.min(step);
    }

    /// `moved` less the displacement and the velocity by the tractions through a flexibility of each row.
    fn less_tractions(&self, flexibility: &[f64], moved: [f64; 2]) -> [f64; 2] {
        let mut moved = moved;
        for (i, (contact, share)) in self.contacts.iter().zip(flexibility).enumerate() {
            moved[0] -= share * contact.area() * self.rows.traction[i];
            moved[1] -= share * contact.area() * self.rows.traction_rate[i];
        }
        moved
    }

    /// Closures \[m\], tractions and their viscous parts \[Pa\] of the contacts.
    pub(super) fn rows_now(&self) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (rows, count) = (&self.rows, self.contacts.len());
        let viscous = (0..count).map(|i| rows.traction[i] - rows.pressure[i]).collect();
        (rows.closure[..count].to_vec(), rows.traction[..count].to_vec(), viscous)
    }

    /// Stiffness of each contact \[Pa/m\].
    pub(super) fn stiffness_now(&self) -> Vec<f64> {
        self.rows.stiffness[..self.contacts.len()].to_vec()
    }

    /// Displacement of every mode \[m kg^(1/2)\].
    pub(super) fn modes(&self) -> impl Iterator<Item = f64> {
        self.modes.displacements().take(self.model.row_modes().modes.len())
    }

    /// Velocity of every mode \[m kg^(1/2)/s\].
    pub(super) fn mode_velocities(&self) -> impl Iterator<Item = f64> {
        self.modes.velocities().take(self.model.row_modes().modes.len())
    }

    /// Displacement of sensor `sensor` \[m\].
    pub(super) fn displacement(&self, sensor: usize) -> f64 {
        self.reading(sensor)[0]
    }

    /// Displacement \[m\], velocity \[m/s\] and acceleration \[m/s2\] of sensor `sensor`; to the
    /// acceleration the modes left out, and those that follow their forces at once, add nothing.
    fn reading(&self, sensor: usize) -> [f64; 3] {
        let residual = &self.model.row_modes().residual;
        let per_load = residual.sensors_per_load[sensor];
        let [displacement, velocity, accelerated] = self.modes.port(&self.sensors[sensor]);
        let [value, slope] = self.loaded;
        let moved = [displacement + per_load * value, velocity + per_load * slope];
        let [displacement, velocity] = self.less_tractions(&residual.sensors[sensor], moved);
        [displacement, velocity, accelerated]
    }

    /// Adds the state at `time` \[s\] to a history.
    pub(super) fn record(&mut self, history: &mut History, time: f64) {
        history.time.push(time);
        history.load.push(self.loaded[0]);
        for (sensor, columns) in history.sensors.iter_mut().enumerate() {
            let reading = self.reading(sensor);
            self.accelerations[sensor] = self.accelerations[sensor].max(reading[2].abs());
            columns.push(reading);
        }
        for (i, columns) in history.interfaces.iter_mut().enumerate() {
            let (contact, increment) = (&self.contacts[i], self.rows.closure[i]);
            let closure = contact.preloaded.closure() + increment;
            columns.push(if increment <= contact.open_below {
                (0.0, closure, 0.0)
            } else {
                let found = self.recorded[i].moved(contact.preloaded, increment);
                self.recorded[i] = found;
                (found.pressure, closure, found.increment.tangent)
            });
        }
    }

    /// Extremes of the contacts, with averages over the whole duration.
    pub(super) fn contact_extremes(&self) -> Vec<ContactExtremes> {
        let duration = self.control.base * self.control.steps as f64;
        let extremes = |(contact, measure): (&Contact<'_>, &ContactMeasure)| {
            let at = |closure: f64| pressure_at(contact.preloaded, contact.open_below, closure)[0];
            ContactExtremes {
                pressure_min: at(measure.lowest),
                pressure_max: at(measure.highest),
                lost: measure.open,
                stiffness_average: measure.stiffness / duration,
            }
        };
        self.contacts.iter().zip(&self.measures.contacts).map(extremes).collect()
    }

    /// The energy balance so far.
    pub(super) fn ledger(&self) -> EnergyLedger {
        let structure = self.model.row_modes();
        let mut ledger = EnergyLedger {
            input: self.measures.work,
            dissipated: self.measures.loss,
            ..EnergyLedger::default()
        };
        for (n, mode) in structure.modes.iter().enumerate() {
            let [displacement, velocity, _] = self.modes.of_mode(n);
            if !mode.massless {
                ledger.kinetic += 0.5 * velocity.powi(2);
            }
            ledger.elastic += 0.5 * (mode.angular_frequency * displacement).powi(2);
        }
        let (residual, load) = (&structure.residual, self.loaded[0]);
        let force = |i: usize| self.contacts[i].area() * self.rows.traction[i];
        ledger.elastic += 0.5 * residual.load_port * load * load;
        let pairs = self.contacts.iter().zip(&self.measures.contacts);
        for (i, (contact, measure)) in pairs.enumerate() {
            ledger.contact_dissipated += contact.area() * measure.loss;
            ledger.contact += contact.area() * excess(contact.preloaded, self.rows.closure[i]);
            ledger.elastic -= residual.load[i] * load * force(i);
            for j in 0..self.contacts.len() {
                ledger.elastic += 0.5 * force(i) * residual.closure[i][j] * force(j);
            }
        }
        ledger.dissipated += ledger.contact_dissipated;
        ledger
    }
}
