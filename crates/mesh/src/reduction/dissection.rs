//! Nested dissection of a sparse matrix by the positions of its rows.
//!
//! The rows are halved across their longest extent; those next to the other half come last, behind both
//! halves, which are ordered in the same way. Source: A. George, SIAM J. Numer. Anal. 1973, 10, 345,
//! doi 10.1137/0710032.

use std::collections::HashMap;

use faer::sparse::SymbolicSparseColMatRef;

/// Most points of a part that is not halved any more.
const LEAF: usize = 16;

/// Rows in the order of elimination; none if fewer than half of the rows have a place.
pub(super) fn order(
    pattern: SymbolicSparseColMatRef<'_, usize>,
    places: &[Option<[f64; 3]>],
) -> Option<Vec<usize>> {
    let known = places.iter().flatten().count();
    if known == 0 || 2 * known < pattern.ncols() {
        return None;
    }
    let points = Points::new(pattern, places);
    let mut dissection = Dissection {
        side: vec![0; points.places.len()],
        stamp: 0,
        order: Vec::with_capacity(points.places.len()),
        points: &points,
    };
    dissection.split((0..points.places.len()).collect());
    Some(dissection.order.iter().flat_map(|&point| points.rows[point].iter().copied()).collect())
}

/// Rows gathered by their position, with the positions that a matrix couples.
struct Points {
    places: Vec<[f64; 3]>,
    rows: Vec<Vec<usize>>,
    neighbours: Vec<Vec<usize>>,
}

impl Points {
    /// A row without a place has the place of a row that the matrix couples it with.
    fn new(pattern: SymbolicSparseColMatRef<'_, usize>, given: &[Option<[f64; 3]>]) -> Self {
        let size = pattern.ncols();
        let mut filled = given.to_vec();
        for column in 0..size {
            for &row in pattern.row_idx_of_col_raw(column) {
                let (a, b) = (filled[row], filled[column]);
                filled[row] = a.or(given[column]);
                filled[column] = b.or(given[row]);
            }
        }
        let (mut places, mut rows) = (Vec::new(), Vec::<Vec<usize>>::new());
        let mut numbers = HashMap::new();
        let mut point_of = Vec::with_capacity(size);
        for (row, place) in filled.iter().enumerate() {
            let place = place.unwrap_or_default();
            let point = *numbers.entry(place.map(f64::to_bits)).or_insert_with(|| {
                places.push(place);
                rows.push(Vec::new());
                places.len() - 1
            });
            rows[point].push(row);
            point_of.push(point);
        }
        let mut neighbours = vec![Vec::new(); places.len()];
        for column in 0..size {
            for &row in pattern.row_idx_of_col_raw(column) {
                let (a, b) = (point_of[row], point_of[column]);
                if a != b {
                    neighbours[a].push(b);
                    neighbours[b].push(a);
                }
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        Self { places, rows, neighbours }
    }
}

struct Dissection<'a> {
    points: &'a Points,
    /// Stamp of the half that a point was last in.
    side: Vec<u32>,
    stamp: u32,
    order: Vec<usize>,
}

impl Dissection<'_> {
    fn split(&mut self, mut part: Vec<usize>) {
        if part.len() <= LEAF {
            self.order.extend(part);
            return;
        }
        let places = &self.points.places;
        let extent = |axis: usize| {
            let along = part.iter().map(|&point| places[point][axis]);
            let range = |(low, high): (f64, f64), at: f64| (low.min(at), high.max(at));
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), range);
            high - low
        };
        let extents = [0, 1, 2].map(extent);
        let longest = (0..3).max_by(|&a, &b| extents[a].total_cmp(&extents[b])).unwrap_or_default();
        if extents[longest] == 0.0 {
            self.order.extend(part);
            return;
        }
        let along = |point: &usize| places[*point][longest];
        let middle = part.len() / 2;
        part.select_nth_unstable_by(middle, |a, b| along(a).total_cmp(&along(b)));
        let upper = part.split_off(middle);
        self.stamp += 2;
        let (below, above) = (self.stamp, self.stamp + 1);
        for (half, side) in [(&part, below), (&upper, above)] {
            for &point in half {
                self.side[point] = side;
            }
        }
        let next_to = |point: usize, side: u32| {
            self.points.neighbours[point].iter().any(|&other| self.side[other] == side)
        };
        let (of_lower, inner_lower): (Vec<usize>, Vec<usize>) =
            part.iter().partition(|&&point| next_to(point, above));
        let (of_upper, inner_upper): (Vec<usize>, Vec<usize>) =
            upper.iter().partition(|&&point| next_to(point, below));
        let (separator, halves) = if of_lower.len() <= of_upper.len() {
            (of_lower, [inner_lower, upper])
        } else {
            (of_upper, [part, inner_upper])
        };
        for half in halves {
            self.split(half);
        }
        self.order.extend(separator);
    }
}
