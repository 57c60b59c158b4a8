//! Derivatives of a law over pressure, tabulated for a run of many steps.

use crate::modal::variable_steps::hermite;

/// A function with its slope, at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sloped {
    pub(super) value: f64,
    pub(super) slope: f64,
}

/// The tabulated functions at one place.
pub(super) type Both = [Sloped; 2];

/// Largest error of a cubic in the middle of its cell, over the largest value at the ends of all first cells: the cubics of
/// both halves, which are kept, are closer by a factor of 16, or of 4 at a corner of the slope.
const ERROR: f64 = 1e-9;

/// Cells that a table begins with, halvings of each at most, and cells in all.
const FIRST_CELLS: usize = 16;
const HALVINGS: u32 = 16;
const MOST_CELLS: usize = 1024;

/// Two functions of the pressure between two pressures as cubics in cells, which are halved until the cubics hold.
#[derive(Debug, Clone)]
pub(super) struct DerivativeTable {
    /// Ends of the cells, lowest first.
    places: Vec<f64>,
    nodes: Vec<Both>,
    /// The cell found last: the next one is near it.
    near: usize,
}

impl DerivativeTable {
    /// The functions `of` pressure \[Pa\] from `low` to `high`; none where they are not finite or need too many
    /// cells.
    pub(super) fn new(of: &dyn Fn(f64) -> Both, [low, high]: [f64; 2]) -> Option<Self> {
        let width = (high - low) / FIRST_CELLS as f64;
        if !(width.is_finite() && low + width > low) {
            return None;
        }
        let place = |i: usize| if i == FIRST_CELLS { high } else { low + width * i as f64 };
        let first: Vec<(f64, Both)> = (0..=FIRST_CELLS).map(|i| (place(i), of(place(i)))).collect();
        let largest = [0, 1]
            .map(|k| first.iter().fold(0.0_f64, |most, (_, both)| most.max(both[k].value.abs())));
        let mut table = Self { places: vec![first[0].0], nodes: vec![first[0].1], near: 0 };
        for pair in first.windows(2) {
            let mut stack = vec![(pair[1], 0)];
            while let Some(((to, end), halvings)) = stack.pop() {
                let (from, start) = (*table.places.last()?, *table.nodes.last()?);
                let middle = 0.5 * (from + to);
                let exact = of(middle);
                let cubic = between((from, &start), (to, &end), middle);
                let agrees = |k: usize| (cubic[k] - exact[k].value).abs() <= ERROR * largest[k];
                let is_finite = |one: &Sloped| one.value.is_finite() && one.slope.is_finite();
                if !(exact.iter().all(is_finite) && end.iter().all(is_finite)) {
                    return None;
                }
                if halvings < HALVINGS && !(agrees(0) && agrees(1)) {
                    stack.push(((to, end), halvings + 1));
                    stack.push(((middle, exact), halvings + 1));
                    continue;
                }
                table.places.extend([middle, to]);
                table.nodes.extend([exact, end]);
                if table.places.len() > MOST_CELLS {
                    return None;
                }
            }
        }
        Some(table)
    }

    /// The functions at a pressure \[Pa\]; none beyond the table.
    pub(super) fn at(&mut self, pressure: f64) -> Option<[f64; 2]> {
        let last = self.places.len() - 1;
        if !(self.places[0]..=self.places[last]).contains(&pressure) {
            return None;
        }
        while pressure < self.places[self.near] {
            self.near -= 1;
        }
        while self.near + 1 < last && pressure > self.places[self.near + 1] {
            self.near += 1;
        }
        let of = |cell: usize| (self.places[cell], &self.nodes[cell]);
        Some(between(of(self.near), of(self.near + 1), pressure))
    }
}

/// The cubics through values and slopes at two places, between them.
fn between((from, start): (f64, &Both), (to, end): (f64, &Both), place: f64) -> [f64; 2] {
    let width = to - from;
    [0, 1].map(|k| {
        let (a, b) = (start[k], end[k]);
        hermite([a.value, width * a.slope, b.value, width * b.slope], (place - from) / width)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A power and a function with a corner in its slope, everywhere and in any order.
    #[test]
    fn functions_are_found_to_the_error_of_the_table() {
        let corner = |p: f64| if p < 3.7 { 0.0 } else { (p - 3.7).powi(2) };
        let of = |p: f64| {
            let power = Sloped { value: p.powf(0.35), slope: 0.35 * p.powf(-0.65) };
            let slope = 2.0 * (p - 3.7).max(0.0);
            [power, Sloped { value: corner(p), slope }]
        };
        let mut table = DerivativeTable::new(&of, [0.1, 9.0]).unwrap();
        assert!(table.places.len() < 500, "{}", table.places.len());
        for i in 0..10_000 {
            let p = 0.1 + 8.9 * f64::from((i * 7919) % 10_000) / 9999.0;
            let [power, bent] = table.at(p).unwrap();
            let largest = [9.0_f64.powf(0.35), corner(9.0)];
            assert!((power - p.powf(0.35)).abs() < 0.1 * ERROR * largest[0], "{p}");
            assert!((bent - corner(p)).abs() < 0.5 * ERROR * largest[1], "{p}");
        }
        assert_eq!(table.at(9.0 + 1e-12), None);
        assert_eq!(table.at(0.1 - 1e-12), None);
        assert_eq!(table.at(f64::NAN), None);
    }

    #[test]
    fn a_function_that_is_not_finite_has_no_table() {
        let pole = |p: f64| [Sloped { value: 1.0 / p, slope: -1.0 / (p * p) }; 2];
        assert!(DerivativeTable::new(&pole, [-1.0, 1.0]).is_none());
        assert!(DerivativeTable::new(&pole, [1.0, 1.0]).is_none());
        assert!(DerivativeTable::new(&pole, [1.0, f64::INFINITY]).is_none());
        assert!(DerivativeTable::new(&pole, [1.0, 2.0]).is_some());
    }
}
