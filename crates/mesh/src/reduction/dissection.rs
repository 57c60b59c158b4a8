//! Nested dissection of a sparse matrix by the positions of its rows.
//!
//! The rows are parted near their middle by the plane across an axis that has the fewest of them next to
//! the other side; these come last, behind both sides, which are ordered in the same way. Source: A. George,
//! SIAM J. Numer. Anal. 1973, 10, 345, doi 10.1137/0710032.

use std::collections::HashMap;

use faer::sparse::SymbolicSparseColMatRef;

/// Most points of a part that is not halved any more.
const LEAF: usize = 16;

/// Shares of the points of a part that may be below a cut.
const WINDOW: [f64; 2] = [0.4, 0.6];

/// Distance of points along an axis, over the extent of their part, from which on they are in different planes.
const PLANE: f64 = 1e-6;

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
    let mut dissection = Dissection::new(&points);
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
    /// Side of each point while a part is cut.
    side: Vec<Side>,
    /// Neighbours of a point in the lower and the upper side of a cut.
    counts: Vec<[u32; 2]>,
    order: Vec<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Lower = 0,
    Upper = 1,
    Outside,
}

/// A place where a part is cut.
struct Cut {
    /// Points of the part in the order along an axis, the first `lower` of them below the cut.
    along: Vec<usize>,
    lower: usize,
    /// Rows of the separator times rows of the larger side.
    price: usize,
}

impl<'a> Dissection<'a> {
    fn new(points: &'a Points) -> Self {
        let count = points.places.len();
        Self {
            points,
            side: vec![Side::Outside; count],
            counts: vec![[0; 2]; count],
            order: Vec::with_capacity(count),
        }
    }

    fn split(&mut self, part: Vec<usize>) {
        let cuts =
            [0, 1, 2].map(|axis| (part.len() > LEAF).then(|| self.cut(&part, axis)).flatten());
        let Some(Cut { along, lower, .. }) = cuts.into_iter().flatten().min_by_key(|cut| cut.price)
        else {
            self.order.extend(part);
            return;
        };
        drop(part);
        self.place(&along, lower);
        let (below, above) = along.split_at(lower);
        let divide = |points: &[usize], other: Side| -> (Vec<usize>, Vec<usize>) {
            points.iter().partition(|&&point| self.counts[point][other as usize] > 0)
        };
        let (of_lower, inner_lower) = divide(below, Side::Upper);
        let (of_upper, inner_upper) = divide(above, Side::Lower);
        let (separator, halves) = if self.rows(&of_lower) <= self.rows(&of_upper) {
            (of_lower, [inner_lower, above.to_vec()])
        } else {
            (of_upper, [below.to_vec(), inner_upper])
        };
        self.leave(&along);
        for half in halves {
            self.split(half);
        }
        self.order.extend(separator);
    }

    fn rows(&self, points: &[usize]) -> usize {
        points.iter().map(|&point| self.points.rows[point].len()).sum()
    }

    /// Puts the first `lower` points of a part into the lower side, the others into the upper one.
    fn place(&mut self, along: &[usize], lower: usize) {
        for (number, &point) in along.iter().enumerate() {
            self.side[point] = if number < lower { Side::Lower } else { Side::Upper };
        }
        for &point in along {
            let mut counts = [0; 2];
            for &other in &self.points.neighbours[point] {
                match self.side[other] {
                    Side::Outside => {}
                    side => counts[side as usize] += 1,
                }
            }
            self.counts[point] = counts;
        }
    }

    /// Takes a part out of both sides.
    fn leave(&mut self, along: &[usize]) {
        for &point in along {
            self.side[point] = Side::Outside;
        }
    }

    /// Rows that a point adds to those of its side that are next to the other side.
    fn boundary(&self, point: usize) -> [usize; 2] {
        let rows = self.points.rows[point].len();
        let [below, above] = self.counts[point];
        match self.side[point] {
            Side::Lower if above > 0 => [rows, 0],
            Side::Upper if below > 0 => [0, rows],
            _ => [0, 0],
        }
    }

    /// The cheapest cut across an axis near the middle of a part; none if it has no extent there.
    fn cut(&mut self, part: &[usize], axis: usize) -> Option<Cut> {
        let places = &self.points.places;
        let mut along = part.to_vec();
        let by_place = |a: &usize, b: &usize| places[*a][axis].total_cmp(&places[*b][axis]);
        along.sort_unstable_by(|a, b| by_place(a, b).then(a.cmp(b)));
        let at = |number: usize| places[along[number]][axis];
        let extent = at(along.len() - 1) - at(0);
        if extent <= 0.0 {
            return None;
        }
        let [from, to] = WINDOW.map(|share| (share * along.len() as f64) as usize);
        self.place(&along, from);
        let total = self.rows(part);
        let mut below = self.rows(&along[..from]);
        let mut boundary = [0; 2];
        for &point in &along {
            boundary = add(boundary, self.boundary(point));
        }
        let mut best: Option<(usize, usize)> = None;
        for lower in from..to {
            let is_between_planes = lower > 0 && at(lower) - at(lower - 1) > PLANE * extent;
            if is_between_planes || (lower == along.len() / 2 && best.is_none()) {
                let price = boundary[0].min(boundary[1]) * below.max(total - below);
                if best.is_none_or(|(_, least)| price < least) {
                    best = Some((lower, price));
                }
            }
            let point = along[lower];
            boundary = self.lower(point, boundary);
            below += self.points.rows[point].len();
        }
        self.leave(&along);
        best.map(|(lower, price)| Cut { along, lower, price })
    }

    /// Moves a point from the upper side to the lower one; the rows of both sides that are next to the other one
    /// then.
    fn lower(&mut self, point: usize, mut boundary: [usize; 2]) -> [usize; 2] {
        let points = self.points;
        boundary = take(boundary, self.boundary(point));
        self.side[point] = Side::Lower;
        boundary = add(boundary, self.boundary(point));
        for &other in &points.neighbours[point] {
            boundary = take(boundary, self.boundary(other));
            if self.side[other] != Side::Outside {
                self.counts[other][0] += 1;
                self.counts[other][1] -= 1;
            }
            boundary = add(boundary, self.boundary(other));
        }
        boundary
    }
}

fn add(a: [usize; 2], b: [usize; 2]) -> [usize; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

fn take(a: [usize; 2], b: [usize; 2]) -> [usize; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

#[cfg(test)]
mod tests {
    use faer::sparse::linalg::cholesky::{
        CholeskySymbolicParams, SymmetricOrdering, factorize_symbolic_cholesky,
    };
    use faer::sparse::{SparseColMat, Triplet};

    use super::*;

    /// A block of `counts` elements of eight nodes with three rows each: couplings, and places off by 1e-9 of an
    /// element.
    fn block(counts: [usize; 3]) -> (SparseColMat<usize, f64>, Vec<Option<[f64; 3]>>) {
        let nodes = counts.map(|count| count + 1);
        let number = |[i, j, k]: [usize; 3]| (k * nodes[1] + j) * nodes[0] + i;
        let mut places = Vec::new();
        let mut entries = Vec::new();
        for k in 0..nodes[2] {
            for j in 0..nodes[1] {
                for i in 0..nodes[0] {
                    let from = number([i, j, k]);
                    let off = 1e-9 * ((from * 7919) % 13) as f64;
                    places.extend([Some([i, j, k].map(|index| index as f64 + off)); 3]);
                    for corner in 0..8 {
                        let to = [i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)];
                        for back in 0..8 {
                            let [a, b, c] = to;
                            let (x, y, z) = (back & 1, back >> 1 & 1, back >> 2);
                            let near = a >= x && b >= y && c >= z;
                            if !near || to.iter().zip(nodes).any(|(at, count)| *at >= count) {
                                continue;
                            }
                            let to = number([a - x, b - y, c - z]);
                            for (row, column) in (0..9).map(|n| (3 * to + n / 3, 3 * from + n % 3))
                            {
                                if row >= column {
                                    entries.push(Triplet::new(row, column, 1.0));
                                }
                            }
                        }
                    }
                }
            }
        }
        let size = places.len();
        (SparseColMat::try_new_from_triplets(size, size, &entries).unwrap(), places)
    }

    fn filled(matrix: &SparseColMat<usize, f64>, order: Option<&[usize]>) -> usize {
        let permutation = order.map(|order| {
            let mut inverse = vec![0; order.len()];
            for (new, &old) in order.iter().enumerate() {
                inverse[old] = new;
            }
            faer::perm::Perm::new_checked(order.into(), inverse.into(), order.len())
        });
        let ordering = match &permutation {
            Some(permutation) => SymmetricOrdering::Custom(permutation.as_ref()),
            None => SymmetricOrdering::Amd,
        };
        let parameters = CholeskySymbolicParams::default();
        let side = faer::Side::Lower;
        factorize_symbolic_cholesky(matrix.symbolic(), side, ordering, parameters)
            .unwrap()
            .len_val()
    }

    /// Every row once, whatever the places, and fewer entries of the factor than by minimum degree.
    #[test]
    fn planes_separate_blocks_with_little_fill() {
        for counts in [[12, 12, 12], [6, 8, 40]] {
            let (matrix, places) = block(counts);
            let order = order(matrix.symbolic(), &places).unwrap();
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..places.len()));
            let [ours, minimum_degree] = [filled(&matrix, Some(&order)), filled(&matrix, None)];
            assert!(10 * ours < 9 * minimum_degree, "{counts:?}: {ours} of {minimum_degree}");
        }
    }

    /// Points in one place, and in a plane or a line, are ordered too.
    #[test]
    fn places_without_extent_are_ordered() {
        let (matrix, places) = block([5, 4, 3]);
        for directions in 0..3 {
            let flat = |place: [f64; 3]| {
                let mut flat = [0.0; 3];
                flat[..directions].copy_from_slice(&place[..directions]);
                Some(flat)
            };
            let places: Vec<_> = places.iter().map(|place| place.and_then(flat)).collect();
            let mut order = order(matrix.symbolic(), &places).unwrap();
            order.sort_unstable();
            assert!(order.into_iter().eq(0..places.len()));
        }
    }
}
