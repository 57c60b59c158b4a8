//! A law tabulated to a relative error from its loss of contact on.

use crate::contact_law::{ContactLaw, Pressure};

/// Octaves of the closure below the octave of the top.
const OCTAVES: u64 = 18;

/// Binary digits of the numbers of cells of an octave that are tried.
const DIGITS: [u32; 5] = [4, 5, 6, 7, 8];

/// The fewest of an octave with kinks of the law.
const DIGITS_WITH_KINKS: u32 = 7;

/// Binary digits of the fraction of a number.
const FRACTION: u32 = f64::MANTISSA_DIGITS - 1;

/// Places in a cell at which it is compared with the law, and the largest relative errors of pressure and tangent.
const CHECKS: [f64; 2] = [0.25, 0.5];
const PRESSURE_ERROR: f64 = 1e-11;
const TANGENT_ERROR: f64 = 1e-9;

/// The pressure of a law that separates, over the closure d from first contact, to a relative error of some 1e-11, and
/// its tangent to 1e-9.
///
/// A power law starts as `d^(1/(1-m))`: no polynomial has small relative errors down to d = 0. Cells are
/// therefore in proportion to the closure, 16 to 256 in each octave of it, and in each the pressure is the quintic Hermite
/// interpolant of pressures, tangents and their slopes `K dK/dp`, so that two derivatives are continuous. Integrals of the
/// force next to an opening, and the Newton iterations that rest on them, then do not see the table.
///
/// A cell with kinks of the law has a quintic between each two of them. Quintics that miss the errors above where they are
/// compared with the law are left out, as is the closure below some 2^-18 of the top: there [`get`](Self::get) gives none, and
/// the caller takes the law itself.
///
/// ```
/// use asperity_law::{ContactLaw, Power, RelativeTable};
///
/// let law = Power::new(1.81e10, 0.35, 0.0)?;
/// let table = RelativeTable::new(&law, 1e6).unwrap();
/// let (exact, found) = (law.pressure(1e-9), table.get(1e-9).unwrap());
/// assert!((found.value / exact.value - 1.0).abs() < 1e-11);
/// assert!((found.tangent / exact.tangent - 1.0).abs() < 1e-9);
/// # Ok::<(), asperity_law::LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeTable {
    /// From below.
    octaves: Vec<Octave>,
    /// Exponent of the lowest octave, as in the bits of a number.
    first: u64,
}

/// The closures of one binary exponent.
#[derive(Debug, Clone, PartialEq)]
struct Octave {
    cells: Vec<Cell>,
    /// Binary digits of the fraction that are below a cell.
    shift: u32,
    /// Cells with kinks: the quintics between them, from below, each with the closure \[m\] where it begins.
    kinked: Vec<Vec<(f64, Cell)>>,
}

/// A cell: the quintic over 0 <= t < 1, and cells per closure \[1/m\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    cubic: [f64; 3],
    rest: [f64; 3],
    per_metre: f64,
}

impl Cell {
    /// A cell that is left to the law.
    const LEFT_OUT: Self = Self { cubic: [f64::NAN; 3], rest: [f64::NAN; 3], per_metre: 0.0 };

    /// A cell with kinks, by its number among those.
    fn kinked(number: usize) -> Self {
        Self { rest: [number as f64, 0.0, 0.0], ..Self::LEFT_OUT }
    }

    /// Its number among the cells with kinks.
    fn kinks(&self) -> Option<usize> {
        (self.rest[0] >= 0.0 && self.cubic[0].is_nan()).then_some(self.rest[0] as usize)
    }

    fn is_left_out(&self) -> bool {
        self.cubic[0].is_nan() && self.rest[0].is_nan()
    }

    /// The quintic with these pressures, tangents and slopes of the tangent, over a width \[m\].
    fn hermite([a, b]: [&Node; 2], width: f64) -> Self {
        let (m0, m1) = (a.tangent * width, b.tangent * width);
        let (s0, s1) = (a.slope * width * width, b.slope * width * width);
        let rise = b.pressure - a.pressure - m0 - 0.5 * s0;
        let (turn, bend) = (m1 - m0 - s0, s1 - s0);
        let c3 = 10.0 * rise - 4.0 * turn + 0.5 * bend;
        let c4 = -15.0 * rise + 7.0 * turn - bend;
        let c5 = 6.0 * rise - 3.0 * turn + 0.5 * bend;
        Self { cubic: [a.pressure, m0, 0.5 * s0], rest: [c3, c4, c5], per_metre: width.recip() }
    }

    fn at(&self, t: f64) -> Pressure {
        let [c0, c1, c2] = self.cubic;
        let [c3, c4, c5] = self.rest;
        let value = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))));
        let slope = c1 + t * (2.0 * c2 + t * (3.0 * c3 + t * (4.0 * c4 + t * (5.0 * c5))));
        Pressure { value, tangent: slope * self.per_metre }
    }
}

/// The law at the edge of two cells.
struct Node {
    closure: f64,
    pressure: f64,
    tangent: f64,
    /// dK/dd, `K dK/dp` \[Pa/m2\].
    slope: f64,
}

impl Node {
    /// The law at a closure from first contact \[m\].
    fn at(law: &dyn ContactLaw, lost: f64, closure: f64) -> Self {
        let Pressure { value: pressure, tangent } = law.pressure(lost + closure);
        Self { closure, pressure, tangent, slope: tangent * law.stiffness_slope(pressure) }
    }

    /// The law at a closure not far from here \[m\].
    fn further(&self, law: &dyn ContactLaw, lost: f64, closure: f64) -> Self {
        match law.pressure_step(self.pressure, closure - self.closure) {
            Some(Pressure { value, tangent }) => {
                let pressure = self.pressure + value;
                Self { closure, pressure, tangent, slope: tangent * law.stiffness_slope(pressure) }
            }
            None => Self::at(law, lost, closure),
        }
    }

    /// The law below and above a kink at a pressure \[Pa\].
    fn at_kink(law: &dyn ContactLaw, lost: f64, pressure: f64) -> [Self; 2] {
        let closure = law.closure(pressure) - lost;
        [pressure.next_down().next_down(), pressure].map(|side| {
            let tangent = law.stiffness(side);
            Self { closure, pressure, tangent, slope: tangent * law.stiffness_slope(side) }
        })
    }
}

impl RelativeTable {
    /// The table of `law` up to the pressure `top` \[Pa\]; none for a law that does not separate, or whose closure there is
    /// not finite and positive.
    pub fn new(law: &dyn ContactLaw, top: f64) -> Option<Self> {
        let lost = law.domain().closure_lost?;
        let height = law.closure(top) - lost;
        if !(height > 0.0 && height.is_finite()) {
            return None;
        }
        let last = height.to_bits() >> FRACTION;
        let first = last.saturating_sub(OCTAVES).max(1);
        let kinks: Vec<[Node; 2]> =
            law.kinks().into_iter().map(|pressure| Node::at_kink(law, lost, pressure)).collect();
        let octave = |exponent: u64| Octave::new(law, (lost, exponent), &kinks, height);
        Some(Self { octaves: (first..=last).map(octave).collect(), first })
    }

    /// Pressure \[Pa\] and tangent \[Pa/m\] at the closure d \[m\] from first contact; none where the law itself is to be
    /// taken.
    #[inline]
    pub fn get(&self, closure: f64) -> Option<Pressure> {
        let bits = closure.to_bits();
        // Negative numbers have higher exponents than all others.
        let octave = (bits >> FRACTION).checked_sub(self.first)?;
        let octave = self.octaves.get(usize::try_from(octave).ok()?)?;
        let fraction = bits & ((1 << FRACTION) - 1);
        let cell = octave.cells.get((fraction >> octave.shift) as usize)?;
        if cell.cubic[0].is_nan() {
            return octave.between_kinks(cell, closure);
        }
        let within = fraction & ((1 << octave.shift) - 1);
        Some(cell.at(within as f64 / (1_u64 << octave.shift) as f64))
    }

    /// Part of the cells that are left to the law, in whole or in part.
    pub fn left_out(&self) -> f64 {
        let left_out: usize = self.octaves.iter().map(Octave::left_out).sum();
        let all: usize = self.octaves.iter().map(|octave| octave.cells.len()).sum();
        left_out as f64 / all as f64
    }
}

impl Octave {
    /// The octave with as few cells as have small errors up to the closure `height` \[m\]; with the fewest where none do.
    fn new(
        law: &dyn ContactLaw,
        (lost, exponent): (f64, u64),
        kinks: &[[Node; 2]],
        height: f64,
    ) -> Self {
        let low = f64::from_bits(exponent << FRACTION);
        let mut fewest = None;
        // A cell with kinks takes longer: where there are some, it is small.
        let has_kinks = kinks.iter().any(|kink| (low..2.0 * low).contains(&kink[0].closure));
        let least = if has_kinks { DIGITS_WITH_KINKS } else { 0 };
        for digits in DIGITS.into_iter().filter(|digits| *digits >= least) {
            let mut found = Self::with_digits(law, (lost, low), kinks, digits);
            let below = (height / low - 1.0) * found.cells.len() as f64;
            found.cells.truncate(1 + below as usize);
            if found.left_out() == 0 {
                return found;
            }
            fewest.get_or_insert(found);
        }
        fewest.unwrap_or_else(|| Self { cells: Vec::new(), shift: FRACTION, kinked: Vec::new() })
    }

    fn with_digits(
        law: &dyn ContactLaw,
        (lost, low): (f64, f64),
        kinks: &[[Node; 2]],
        digits: u32,
    ) -> Self {
        let count = 1_u64 << digits;
        let mut nodes: Vec<Node> = vec![Node::at(law, lost, low)];
        for place in 1..=count {
            let closure = low * (1.0 + place as f64 / count as f64);
            let node = nodes.last().map(|before| before.further(law, lost, closure));
            nodes.extend(node);
        }
        let quintic = |[a, b]: [&Node; 2]| {
            let width = b.closure - a.closure;
            let cell = Cell::hermite([a, b], width);
            let is_close = |t: &f64| {
                let (exact, found) = (a.further(law, lost, a.closure + t * width), cell.at(*t));
                (found.value - exact.pressure).abs() <= PRESSURE_ERROR * exact.pressure
                    && (found.tangent - exact.tangent).abs() <= TANGENT_ERROR * exact.tangent
            };
            if CHECKS.iter().all(is_close) { cell } else { Cell::LEFT_OUT }
        };
        let (mut cells, mut kinked) = (Vec::with_capacity(nodes.len()), Vec::new());
        for pair in nodes.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let inside =
                |kink: &&[Node; 2]| a.closure < kink[0].closure && kink[0].closure < b.closure;
            let own: Vec<&[Node; 2]> = kinks.iter().filter(inside).collect();
            if own.is_empty() {
                cells.push(quintic([a, b]));
                continue;
            }
            let starts = std::iter::once(a).chain(own.iter().map(|kink| &kink[1]));
            let ends = own.iter().map(|kink| &kink[0]).chain([b]);
            let pieces = starts.zip(ends).map(|(from, to)| (from.closure, quintic([from, to])));
            cells.push(Cell::kinked(kinked.len()));
            kinked.push(pieces.collect());
        }
        Self { cells, shift: FRACTION - digits, kinked }
    }

    fn between_kinks(&self, cell: &Cell, closure: f64) -> Option<Pressure> {
        let pieces = self.kinked.get(cell.kinks()?)?;
        let &(from, piece) = pieces.iter().rev().find(|(from, _)| *from <= closure)?;
        (!piece.is_left_out()).then(|| piece.at((closure - from) * piece.per_metre))
    }

    /// Number of cells that are left to the law, in whole or in part.
    fn left_out(&self) -> usize {
        let is_left_out = |cell: &&Cell| match cell.kinks() {
            Some(number) => self.kinked[number].iter().any(|(_, piece)| piece.is_left_out()),
            None => cell.is_left_out(),
        };
        self.cells.iter().filter(is_left_out).count()
    }
}
