//! Cases side by side in the lanes of two vectors.

mod build;
mod coefficient;
mod pair;
mod start;
mod work;

use pulp::Simd;

use super::table_lookup::TableRow;
pub(super) use crate::modal::damped_table::PAST;
use crate::modal::oscillator::NODES;
use crate::modal::prepared_case::PreparedCase;
pub(super) use coefficient::{Coefficient, Dissipative, PerLane, Uniform};
pub(super) use pair::{LanePair, LaneVector, lane_of, set_lane};
pub(super) use work::{Work, total_work};

/// Steps between two checks of the lanes.
pub(in crate::modal) const CHUNK: usize = 32;

/// One mode: its state `V` in every lane, then its constants.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Mode<V, C, const N: usize> {
    /// Displacement and increment at the end of the next step without its load and its new
    /// pressures.
    pub(super) predicted: V,
    pub(super) predicted_increment: V,
    /// Shares of the contact forces so far in the steps after next.
    pub(super) carry: [V; NODES - 1],
    /// Increment of the last step.
    pub(super) increment: V,
    pub(super) decay: C,
    /// `-k`
    pub(super) spring: C,
    /// Negative taps of the contact force.
    pub(super) contact: [C; NODES + 1],
    pub(super) sensor: C,
    /// Shape of each closure, in cells of its table.
    pub(super) closure: [C; N],
    /// Modal force per pressure.
    pub(super) force: [C; N],
    /// Factors of `increment^2` and of `increment` times the increment before in the viscous loss \[J/m2\].
    pub(super) loss: [C; 2],
    pub(super) load: [C; 4],
    /// Shape at the load port.
    pub(super) load_port: C,
    /// True if a contact force acts in more than three steps.
    pub(super) carries: bool,
}

/// Numbers of this size are spaced by one: added to a smaller number, it rounds that to a whole
/// one, which is then in the low bits.
pub(super) const WHOLE: f64 = 6_755_399_441_055_744.0;

/// One row: an interface, or a guide with friction; closures are in cells of the lane's table.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Contact<V, C, const N: usize> {
    /// Closure at the end of the next step without its load and its new pressures.
    pub(super) predicted: V,
    /// Sum of the tangent over the steps, per cell.
    pub(super) stiffness: V,
    /// Cells lost at once per pressure increment at every interface.
    pub(super) coupling: [C; N],
    /// Sensor per pressure, of the modes left out.
    pub(super) sensor: C,
    /// Place of rest in the lane's table, and closures of its start and of its end.
    pub(super) rest: C,
    pub(super) first: C,
    pub(super) last: C,
    /// Added to a place, leaves the number of its row in the low bits: [`WHOLE`] and the number
    /// of the table's first row. Places stay those in the table, so that their rounding does not
    /// depend on which tables are laid out before.
    pub(super) whole: C,
    /// Sum of `whole` and `rest`: a place plus `whole`, less this sum, is the closure at which its row
    /// begins.
    pub(super) whole_at_rest: C,
    /// Newton correction, in cells, below which the law is replaced by its tangent.
    pub(super) tolerance: C,
    /// Cells per load, and displacement of the load port per pressure, of the modes
    /// left out.
    pub(super) load: C,
    pub(super) load_port: C,
}

/// The viscous traction of one interface.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Damper<V, C> {
    /// Viscous impulse at the steps before, newest first \[Pa s\].
    pub(super) impulse: [V; PAST],
    /// Share of these in the rate at the end of the next step \[Pa\].
    pub(super) history: V,
    /// Work of the viscous traction: the loss.
    pub(super) work: Work<V>,
    /// Weights of the impulses in the rate \[1/s\], the next step first.
    pub(super) rate: [C; PAST + 1],
    /// Traction increment of faces that carry nothing \[Pa\]; -inf where they carry tension.
    pub(super) least: C,
    /// Number of rows from a row of Q to the same row of R.
    pub(super) rows: C,
}

/// The friction element of one row: a traction `max(-limit, min(limit, stuck + stiffness y))` at the
/// closure y, in cells.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Slider<V, C, const N: usize> {
    /// Traction of the stuck element at no closure \[Pa\].
    pub(super) stuck: V,
    /// Slip force over the area in the next step \[Pa\].
    pub(super) limit: V,
    /// Traction of the contact without friction at the last three steps, newest first \[Pa\].
    pub(super) normal: [V; 3],
    pub(super) work: Work<V>,
    /// Stiffness \[Pa\] per cell; zero without friction.
    pub(super) stiffness: C,
    /// Slip force of its own over the area \[Pa\].
    pub(super) slip: C,
    /// Share of the pressure of each contact in the limit.
    pub(super) share: [C; N],
    /// Static pressure of the contact \[Pa\].
    pub(super) rest: C,
}

/// Pressures, or closures, of all interfaces.
pub(super) type Contacts<S, const N: usize> = [LaneVector<S>; N];

/// Cases side by side, one in each lane.
pub(super) struct Block<'a, S: Simd, C, const N: usize> {
    pub(super) modes: Vec<Mode<LaneVector<S>, C, N>>,
    pub(super) contacts: [Contact<LaneVector<S>, C, N>; N],
    /// One for each of the N rows if a contact is damped or there is friction, else none.
    pub(super) dampers: Vec<Damper<LaneVector<S>, C>>,
    /// One for each of the N rows if there is friction, else none.
    pub(super) sliders: Vec<Slider<LaneVector<S>, C, N>>,
    /// The linear equations of a correction and their factors, a row each, of more than two rows.
    pub(super) factors: Vec<Contacts<S, N>>,
    /// Number of rows, contacts and guides; the rest of the N are unused.
    pub(super) coupled: usize,
    /// The tables of all lanes, one behind the other.
    pub(super) rows: Vec<TableRow>,
    /// Sensor and load port per load, of the modes left out.
    pub(super) sensor_per_load: C,
    pub(super) load_port: C,
    /// Mean and rise of the load in the step before.
    pub(super) load_before: [LaneVector<S>; 2],
    /// Newest displacement at the sensor \[m\].
    pub(super) reading: LaneVector<S>,
    /// Newest displacement of the load port \[m\], while there is a load.
    pub(super) load_displacement: LaneVector<S>,
    /// Work of the load, and viscous loss \[J\].
    pub(super) work: LaneVector<S>,
    pub(super) loss: LaneVector<S>,
    /// One for each lane of the two vectors.
    pub(super) lanes: Vec<Option<&'a PreparedCase>>,
}

/// Results of one step.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Step<V, const N: usize> {
    /// Pressure increments since rest, of damped contacts traction increments \[Pa\].
    pub(super) pressure: [V; N],
    /// Closure increments since rest, in cells.
    pub(super) closure: [V; N],
    /// Displacement at the sensor \[m\].
    pub(super) reading: V,
}

/// The load in one step: its mean, rise and end \[N\].
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Load<V>(pub(super) [V; 3]);
