//! Symmetric sparse matrices.

/// A symmetric sparse matrix: its lower triangle with the diagonal, column by column.
///
/// Column `j` has the entries `column_starts[j]..column_starts[j + 1]` of `rows` and `values`; the first
/// is the diagonal, which is always stored, and rows ascend. Other entries are not zero.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseSymmetric {
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

/// An entry: row, column, value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    pub(crate) row: u32,
    pub(crate) column: u32,
    pub(crate) value: f64,
}

/// Number of entries by which an entry off the diagonal may be given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Triangles {
    /// Once, in either triangle.
    One,
    /// Once throughout, or twice throughout with the same value: told by the content.
    OneOrBoth,
}

/// A fault of entries.
#[derive(Debug, PartialEq)]
pub(crate) enum EntryFault {
    Twice { row: usize, column: usize },
    Asymmetric { row: usize, column: usize, value: f64, partner: Option<f64> },
}

/// A matrix of entries, and the first row without a given diagonal.
#[derive(Debug)]
pub(crate) struct Assembled {
    pub(crate) matrix: SparseSymmetric,
    pub(crate) without_diagonal: Option<usize>,
}

/// Most rows of a matrix.
pub(crate) const MOST_ROWS: usize = 1 << 30;

/// Bit of a column that marks an entry of the upper triangle.
const UPPER: u32 = 1 << 31;

impl SparseSymmetric {
    /// The matrix of `size` rows with the entries `(row, column, value)` of one triangle: an entry off the
    /// diagonal stands for itself and for its partner, whichever triangle it is in. Entries of one place
    /// are added, as in the assembly of elements.
    ///
    /// # Panics
    /// If a row or a column is not below `size`.
    ///
    /// ```
    /// use asperity_matrices::SparseSymmetric;
    ///
    /// let springs = [(0, 0, 2.0), (0, 1, -1.0), (1, 1, 1.0)];
    /// let stiffness = SparseSymmetric::from_triplets(2, springs);
    /// assert_eq!(stiffness.multiply(&[0.0, 1.0]), [-1.0, 1.0]);
    /// ```
    pub fn from_triplets(
        size: usize,
        triplets: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Self {
        assert!(size < MOST_ROWS, "a matrix has less than {MOST_ROWS} rows");
        let mut entries: Vec<Entry> = triplets
            .into_iter()
            .map(|(row, column, value)| {
                assert!(row < size && column < size, "({row}, {column}) in {size} rows");
                Entry { row: row.max(column) as u32, column: row.min(column) as u32, value }
            })
            .collect();
        sort(size, &mut entries);
        entries.dedup_by(|next, kept| {
            let same = (next.row, next.column) == (kept.row, kept.column);
            if same {
                kept.value += next.value;
            }
            same
        });
        Self::of_sorted(size, &entries).matrix
    }

    /// The matrix of entries in any order.
    pub(crate) fn assemble(
        size: usize,
        mut entries: Vec<Entry>,
        triangles: Triangles,
    ) -> Result<Assembled, EntryFault> {
        for entry in &mut entries {
            if entry.row < entry.column {
                (entry.row, entry.column) = (entry.column, entry.row | UPPER);
            }
        }
        sort(size, &mut entries);
        join_partners(size, &mut entries, triangles)?;
        Ok(Self::of_sorted(size, &entries))
    }

    /// The matrix of entries of the lower triangle by columns and rows, each given once.
    fn of_sorted(size: usize, entries: &[Entry]) -> Assembled {
        let kept = |entry: &&Entry| entry.value != 0.0 || entry.row == entry.column;
        let count = entries.iter().filter(kept).count();
        let mut matrix = Self {
            column_starts: Vec::with_capacity(size + 1),
            rows: Vec::with_capacity(count),
            values: Vec::with_capacity(count),
        };
        let mut without_diagonal = None;
        let mut rest = entries.iter().filter(kept).peekable();
        for column in 0..size {
            matrix.column_starts.push(matrix.rows.len());
            let in_column = |entry: &&Entry| entry.column as usize == column;
            if rest.peek().is_none_or(|entry| !in_column(entry) || entry.row as usize != column) {
                without_diagonal = without_diagonal.or(Some(column));
                matrix.rows.push(column);
                matrix.values.push(0.0);
            }
            while let Some(entry) = rest.next_if(in_column) {
                matrix.rows.push(entry.row as usize);
                matrix.values.push(entry.value);
            }
        }
        matrix.column_starts.push(matrix.rows.len());
        Assembled { matrix, without_diagonal }
    }

    /// Number of rows, and of columns.
    pub fn size(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Number of entries stored: the lower triangle with the diagonal.
    pub fn stored(&self) -> usize {
        self.values.len()
    }

    /// Start of each column in [`Self::rows`] and [`Self::values`], and their length: `size + 1` numbers.
    pub fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Row of each entry.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Value of each entry.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The entries of column `column` from the diagonal down, as row and value.
    ///
    /// # Panics
    /// If `column` is not below the size.
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.column_starts[column]..self.column_starts[column + 1];
        self.rows[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// The entries of the lower triangle as row, column, value, column by column.
    pub fn triplets(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        (0..self.size())
            .flat_map(|column| self.column(column).map(move |(row, value)| (row, column, value)))
    }

    /// The entry of `row` and `column`, of either triangle.
    ///
    /// # Panics
    /// If `row` or `column` is not below the size.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let (row, column) = (row.max(column), row.min(column));
        assert!(row < self.size(), "row {row} of {}", self.size());
        let range = self.column_starts[column]..self.column_starts[column + 1];
        let found = self.rows[range.clone()].binary_search(&row);
        found.map_or(0.0, |index| self.values[range.start + index])
    }

    /// The diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        self.column_starts[..self.size()].iter().map(|start| self.values[*start]).collect()
    }

    /// The product with the vector `x`.
    ///
    /// # Panics
    /// If the length of `x` is not the size.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        assert_eq!(x.len(), self.size(), "length of the vector");
        let mut product = vec![0.0; x.len()];
        for (column, &at_column) in x.iter().enumerate() {
            let mut sum = 0.0;
            for (row, value) in self.column(column).skip(1) {
                product[row] += value * at_column;
                sum += value * x[row];
            }
            product[column] += sum + self.values[self.column_starts[column]] * at_column;
        }
        product
    }

    /// The rows and columns that are kept, in the same order.
    pub(crate) fn restricted(&self, kept: &[bool]) -> Self {
        let mut next = 0;
        let to: Vec<usize> = kept
            .iter()
            .map(|kept| {
                next += usize::from(*kept);
                next.wrapping_sub(1)
            })
            .collect();
        let mut matrix = Self { column_starts: vec![0], rows: Vec::new(), values: Vec::new() };
        for column in (0..self.size()).filter(|column| kept[*column]) {
            for (row, value) in self.column(column).filter(|(row, _)| kept[*row]) {
                matrix.rows.push(to[row]);
                matrix.values.push(value);
            }
            matrix.column_starts.push(matrix.rows.len());
        }
        matrix
    }

    /// Multiplies every entry by `factor(row, column)`.
    pub(crate) fn scale(&mut self, factor: impl Fn(usize, usize) -> f64) {
        for column in 0..self.size() {
            for index in self.column_starts[column]..self.column_starts[column + 1] {
                self.values[index] *= factor(self.rows[index], column);
            }
        }
    }
}

/// Sorts entries by column, then by row, in linear time.
fn sort(size: usize, entries: &mut Vec<Entry>) {
    let mut sort_by = |key: fn(&Entry) -> usize| {
        if entries.is_sorted_by_key(key) {
            return;
        }
        let mut starts = vec![0_usize; size + 1];
        for entry in &*entries {
            starts[key(entry) + 1] += 1;
        }
        for index in 0..size {
            starts[index + 1] += starts[index];
        }
        let mut sorted = entries.clone();
        for entry in &*entries {
            let place = &mut starts[key(entry)];
            sorted[*place] = *entry;
            *place += 1;
        }
        *entries = sorted;
    };
    sort_by(|entry| entry.row as usize);
    sort_by(|entry| (entry.column & !UPPER) as usize);
}

/// Joins entries of both triangles, if there are two of a place, and removes the marks of the upper one.
fn join_partners(
    size: usize,
    entries: &mut Vec<Entry>,
    triangles: Triangles,
) -> Result<(), EntryFault> {
    let place = |entry: &Entry| (entry.row, entry.column & !UPPER);
    let mut diagonal = vec![0.0_f64; size];
    let mut largest = 0.0_f64;
    for entry in &*entries {
        if entry.row == entry.column {
            diagonal[entry.row as usize] = entry.value.abs();
        } else {
            // Diagonals may be large without a meaning, where they mark held rows.
            largest = largest.max(entry.value.abs());
        }
    }
    let (mut kept, mut next) = (0, 0);
    let (mut pairs, mut single) = (false, None);
    while next < entries.len() {
        let entry = entries[next];
        let here = place(&entry);
        let same = entries[next..].iter().take_while(|other| place(other) == here).count();
        let (row, column) = (here.0 as usize, here.1 as usize);
        let mut value = entry.value;
        let is_pair = same == 2 && (entry.column ^ entries[next + 1].column) == UPPER;
        match same {
            1 => {
                if row != column && value != 0.0 {
                    single = single.or(Some(entry));
                }
            }
            2 if is_pair && triangles == Triangles::OneOrBoth => {
                let partner = entries[next + 1].value;
                let scale = (diagonal[row] * diagonal[column]).sqrt();
                let scale = scale.max(value.abs()).max(partner.abs());
                if (value - partner).abs() > 1e-9 * scale + 1e-12 * largest {
                    return Err(asymmetric(entry, Some(partner)));
                }
                pairs = true;
                value = 0.5 * (value + partner);
            }
            _ => return Err(EntryFault::Twice { row, column }),
        }
        entries[kept] = Entry { row: here.0, column: here.1, value };
        kept += 1;
        next += same;
    }
    match single {
        Some(entry) if pairs => return Err(asymmetric(entry, None)),
        _ => entries.truncate(kept),
    }
    Ok(())
}

fn asymmetric(entry: Entry, partner: Option<f64>) -> EntryFault {
    let (high, low) = (entry.row as usize, (entry.column & !UPPER) as usize);
    let (row, column) = if entry.column & UPPER == 0 { (high, low) } else { (low, high) };
    EntryFault::Asymmetric { row, column, value: entry.value, partner }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(list: &[(u32, u32, f64)]) -> Vec<Entry> {
        list.iter().map(|&(row, column, value)| Entry { row, column, value }).collect()
    }

    fn assemble(list: &[(u32, u32, f64)]) -> Result<Assembled, EntryFault> {
        SparseSymmetric::assemble(3, entries(list), Triangles::OneOrBoth)
    }

    const LOWER: [(u32, u32, f64); 6] =
        [(0, 0, 4.0), (1, 0, -1.0), (1, 1, 5.0), (2, 0, 0.0), (2, 1, -2.0), (2, 2, 6.0)];

    #[test]
    fn one_triangle_or_both_in_any_order_are_the_same_matrix() {
        let lower = assemble(&LOWER).unwrap().matrix;
        let upper: Vec<_> = LOWER.iter().map(|&(i, j, v)| (j, i, v)).collect();
        let mut both = LOWER.to_vec();
        both.extend(upper.iter().filter(|(i, j, _)| i != j));
        both.reverse();
        // An ordering of rows other than the numbering mixes the triangles.
        let mixed = [(0, 1, -1.0), (2, 1, -2.0), (0, 0, 4.0), (2, 2, 6.0), (1, 1, 5.0)];
        for list in [upper.as_slice(), &both, &mixed] {
            assert_eq!(assemble(list).unwrap().matrix, lower);
        }
        assert_eq!(lower.column_starts(), [0, 2, 4, 5]);
        assert_eq!(lower.rows(), [0, 1, 1, 2, 2]);
        assert_eq!(lower.values(), [4.0, -1.0, 5.0, -2.0, 6.0]);
        assert_eq!(lower.multiply(&[1.0, 10.0, 100.0]), [-6.0, -151.0, 580.0]);
        assert_eq!((lower.get(0, 1), lower.get(2, 0)), (-1.0, 0.0));
        assert_eq!(lower.diagonal(), [4.0, 5.0, 6.0]);
    }

    #[test]
    fn a_missing_diagonal_is_zero_and_reported() {
        let found = assemble(&[(0, 0, 1.0), (2, 1, 2.0), (2, 2, 1.0)]).unwrap();
        assert_eq!(found.without_diagonal, Some(1));
        assert_eq!(found.matrix.diagonal(), [1.0, 0.0, 1.0]);
        assert_eq!(found.matrix.get(1, 2), 2.0);
    }

    #[test]
    fn asymmetric_entries_are_named() {
        let mut list = LOWER.to_vec();
        list.extend([(0, 1, -1.0), (1, 2, -2.5)]);
        let expected =
            EntryFault::Asymmetric { row: 2, column: 1, value: -2.0, partner: Some(-2.5) };
        assert_eq!(assemble(&list).unwrap_err(), expected);
        list.pop();
        let expected = EntryFault::Asymmetric { row: 2, column: 1, value: -2.0, partner: None };
        assert_eq!(assemble(&list).unwrap_err(), expected);
    }

    #[test]
    fn an_entry_given_twice_is_refused() {
        let mut list = LOWER.to_vec();
        list.push((2, 1, -2.0));
        assert_eq!(assemble(&list).unwrap_err(), EntryFault::Twice { row: 2, column: 1 });
        let both = [(0, 1, 1.0), (1, 0, 1.0)];
        let one = SparseSymmetric::assemble(2, entries(&both), Triangles::One);
        assert_eq!(one.unwrap_err(), EntryFault::Twice { row: 1, column: 0 });
    }

    #[test]
    fn triplets_of_one_place_are_added() {
        let matrix = SparseSymmetric::from_triplets(2, [(0, 1, 1.0), (1, 0, 2.0), (1, 1, 3.0)]);
        assert_eq!(matrix.triplets().collect::<Vec<_>>(), [(0, 0, 0.0), (1, 0, 3.0), (1, 1, 3.0)]);
    }
}
