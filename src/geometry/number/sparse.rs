//! Symmetric positive definite systems with few entries, solved exactly but for rounding.
//!
//! Promise: the factorization is the same to the bit on every machine and for any number of threads: plain
//! arithmetic in a fixed order, without fused operations or the machine's vector width. How many entries it takes
//! is known before memory is taken. Not promised: pivoting; a matrix that is not positive definite is refused.
//!
//! Sources: T. Davis, Algorithm 849: A concise sparse Cholesky factorization package, 2005 (the elimination tree and
//! the up-looking factorization into L D Lᵀ); A. George, Nested dissection of a regular finite element mesh, 1973.
//!
//! Cost: with [`dissection()`] on a surface of n points, about O(n log n) entries and O(n^1.5) time.

use glam::DVec3;

/// The lower half of a symmetric matrix, row by row; each place once.
#[derive(Clone, Debug, PartialEq)]
pub struct Symmetric {
    /// For each row where its entries start, and their number.
    starts: Vec<usize>,
    /// Columns, none greater than the row, increasing.
    columns: Vec<u32>,
    values: Vec<f64>,
}

/// The matrix is not positive definite: this row of it depends on others but for rounding, or is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositive {
    /// The row.
    pub row: u32,
}

impl Symmetric {
    /// A matrix of `count` rows from entries (row, column, value) of either half; those at one place are added up, in
    /// the order given. O(n log n).
    #[must_use]
    pub fn new(count: usize, mut entries: Vec<(u32, u32, f64)>) -> Self {
        for (row, column, _) in &mut entries {
            (*row, *column) = ((*row).max(*column), (*row).min(*column));
        }
        entries.sort_by_key(|(row, column, _)| (*row, *column));
        let mut matrix = Self { starts: vec![0; count + 1], columns: Vec::new(), values: Vec::new() };
        let mut last = None;
        for (row, column, value) in entries {
            if last == Some((row, column)) {
                *matrix.values.last_mut().expect("there is a last one") += value;
                continue;
            }
            last = Some((row, column));
            matrix.starts[row as usize + 1] += 1;
            matrix.columns.push(column);
            matrix.values.push(value);
        }
        for row in 0..count {
            matrix.starts[row + 1] += matrix.starts[row];
        }
        matrix
    }

    /// How many rows there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.starts[row]..self.starts[row + 1];
        self.columns[range.clone()]
            .iter()
            .map(|column| *column as usize)
            .zip(self.values[range].iter().copied())
    }

    /// The matrix with its rows and columns in another order: `order` names for each new row the old one.
    fn ordered(&self, order: &[u32]) -> Self {
        let mut place = vec![0_u32; order.len()];
        for (new, old) in order.iter().enumerate() {
            place[*old as usize] = index(new);
        }
        let entry = |row: usize| {
            let place = &place;
            self.row(row).map(move |(column, value)| (place[row], place[column], value))
        };
        Self::new(self.len(), (0..self.len()).flat_map(entry).collect())
    }
}

/// What a factorization will be, known before its numbers are.
#[derive(Clone, Debug)]
pub struct Plan {
    matrix: Symmetric,
    order: Vec<u32>,
    /// For each row the next that depends on it.
    parents: Vec<Option<u32>>,
    /// For each column where its entries start, and their number.
    starts: Vec<usize>,
}

impl Plan {
    /// Of a matrix whose rows are eliminated in an order, each row once. Linear in the entries of the factors.
    #[must_use]
    pub fn new(matrix: &Symmetric, order: Vec<u32>) -> Self {
        let matrix = matrix.ordered(&order);
        let count = matrix.len();
        let mut parents: Vec<Option<u32>> = vec![None; count];
        let mut lengths = vec![0_usize; count];
        let mut seen = vec![usize::MAX; count];
        for row in 0..count {
            seen[row] = row;
            for (mut column, _) in matrix.row(row) {
                while seen[column] != row {
                    seen[column] = row;
                    lengths[column] += 1;
                    column = parents[column].get_or_insert(index(row)).to_owned() as usize;
                }
            }
        }
        let mut starts = Vec::with_capacity(count + 1);
        let mut sum = 0;
        starts.push(0);
        for length in lengths {
            sum += length;
            starts.push(sum);
        }
        Self { matrix, order, parents, starts }
    }

    /// Bytes that the factors take.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let entries = self.starts.last().copied().unwrap_or(0) as u64;
        entries * 12 + self.order.len() as u64 * 40
    }

    /// The factors.
    ///
    /// # Errors
    /// See [`NotPositive`].
    pub fn factor(self) -> Result<Factors, NotPositive> {
        let Self { matrix, order, parents, starts } = self;
        let count = matrix.len();
        let entries = starts[count];
        let (mut rows, mut values) = (vec![0_u32; entries], vec![0.0_f64; entries]);
        let mut ends = starts.clone();
        let mut diagonal = vec![0.0; count];
        let mut sums = vec![0.0_f64; count];
        let mut seen = vec![usize::MAX; count];
        let mut pattern = vec![0_usize; count];
        let mut branch = Vec::new();
        for row in 0..count {
            seen[row] = row;
            let mut top = count;
            let mut own = 0.0;
            for (mut column, value) in matrix.row(row) {
                if column == row {
                    own = value;
                    continue;
                }
                sums[column] = value;
                while seen[column] != row {
                    seen[column] = row;
                    branch.push(column);
                    let Some(parent) = parents[column] else { break };
                    column = parent as usize;
                }
                while let Some(column) = branch.pop() {
                    top -= 1;
                    pattern[top] = column;
                }
            }
            let whole = own;
            for column in &pattern[top..] {
                let known = core::mem::take(&mut sums[*column]);
                let range = starts[*column]..ends[*column];
                for (below, value) in rows[range.clone()].iter().zip(&values[range]) {
                    sums[*below as usize] -= value * known;
                }
                let share = known / diagonal[*column];
                own -= share * known;
                let end = &mut ends[*column];
                (rows[*end], values[*end]) = (index(row), share);
                *end += 1;
            }
            // What rounding alone leaves of a row that depends on others is no pivot.
            if !(own > 1e-14 * whole && own.is_finite()) {
                return Err(NotPositive { row: order[row] });
            }
            diagonal[row] = own;
        }
        Ok(Factors { order, starts, rows, values, diagonal })
    }
}

/// A matrix as L D Lᵀ, L with ones on its diagonal, column by column.
#[derive(Clone, Debug)]
pub struct Factors {
    order: Vec<u32>,
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
    diagonal: Vec<f64>,
}

impl Factors {
    /// The solutions for several right sides at once, of which `right` gives the numbers of each row. Linear in the
    /// entries of the factors.
    #[must_use]
    pub fn solve<const N: usize>(&self, right: impl Fn(usize) -> [f64; N]) -> Vec<[f64; N]> {
        let count = self.order.len();
        let mut found: Vec<[f64; N]> = self.order.iter().map(|old| right(*old as usize)).collect();
        for column in 0..count {
            let known = found[column];
            for (row, value) in self.column(column) {
                (0..N).for_each(|k| found[row][k] -= value * known[k]);
            }
        }
        for column in (0..count).rev() {
            let mut sum = found[column].map(|number| number / self.diagonal[column]);
            for (row, value) in self.column(column) {
                (0..N).for_each(|k| sum[k] -= value * found[row][k]);
            }
            found[column] = sum;
        }
        let mut solution = vec![[0.0; N]; count];
        for (old, numbers) in self.order.iter().zip(found) {
            solution[*old as usize] = numbers;
        }
        solution
    }

    fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.starts[column]..self.starts[column + 1];
        self.rows[range.clone()].iter().map(|row| *row as usize).zip(self.values[range].iter().copied())
    }
}

/// An order in which a matrix whose rows are places, joined to those near them, is eliminated with few entries: the
/// places are halved across their longest side again and again, and those along the cut come after both halves. O(n log n).
#[must_use]
pub fn dissection(matrix: &Symmetric, places: &[DVec3]) -> Vec<u32> {
    let mut around = vec![Vec::new(); matrix.len()];
    for row in 0..matrix.len() {
        for (column, _) in matrix.row(row).filter(|(column, _)| *column != row) {
            around[row].push(index(column));
            around[column].push(index(row));
        }
    }
    let mut cutting = Cutting { places, around, side: vec![0; places.len()], number: 0 };
    let mut all: Vec<u32> = (0..index(places.len())).collect();
    let mut order = Vec::with_capacity(places.len());
    cutting.order(&mut all, &mut order);
    order
}

/// Places that are being cut apart.
struct Cutting<'a> {
    places: &'a [DVec3],
    around: Vec<Vec<u32>>,
    /// The number of the part in which each place was last.
    side: Vec<u32>,
    number: u32,
}

/// Parts of so few places are not cut.
const SMALL: usize = 24;

impl Cutting<'_> {
    fn order(&mut self, part: &mut [u32], order: &mut Vec<u32>) {
        if part.len() <= SMALL {
            order.extend_from_slice(part);
            return;
        }
        let place = |row: &u32| self.places[*row as usize];
        let least = part.iter().map(place).fold(DVec3::INFINITY, DVec3::min);
        let size = (part.iter().map(place).fold(DVec3::NEG_INFINITY, DVec3::max) - least).to_array();
        let axis = (1..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
        let key = |row: &u32| place(row)[axis];
        let middle = part.len() / 2;
        part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let (low, high) = part.split_at_mut(middle);
        // The thinner of the two layers along the cut parts the rest of both halves.
        self.number += 2;
        let number = self.number;
        low.iter().for_each(|row| self.side[*row as usize] = number);
        high.iter().for_each(|row| self.side[*row as usize] = number + 1);
        let side = &self.side;
        let touches = |row: &u32, other: u32| {
            self.around[*row as usize].iter().any(|near| side[*near as usize] == other)
        };
        let of_low = low.iter().filter(|row| touches(row, number + 1)).count();
        let of_high = high.iter().filter(|row| touches(row, number)).count();
        let mut cut: Vec<u32> = if of_low <= of_high {
            low.iter().copied().filter(|row| touches(row, number + 1)).collect()
        } else {
            high.iter().copied().filter(|row| touches(row, number)).collect()
        };
        cut.sort_unstable();
        let rest = |half: &[u32]| -> Vec<u32> {
            half.iter().copied().filter(|row| cut.binary_search(row).is_err()).collect()
        };
        let (mut low, mut high) = (rest(low), rest(high));
        self.order(&mut low, order);
        self.order(&mut high, order);
        order.extend(cut);
    }
}

fn index(subscript: usize) -> u32 {
    u32::try_from(subscript).expect("limits keep every count below 2^32")
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{NotPositive, Plan, Symmetric, dissection};

    /// The five-point Laplacian of a square grid with ones on its diagonal besides, and its places.
    fn grid(side: u32) -> (Symmetric, Vec<DVec3>) {
        let at = |i: u32, j: u32| i * side + j;
        let mut entries = Vec::new();
        let mut join = |a: u32, b: u32| entries.extend([(a, a, 1.0), (b, b, 1.0), (b, a, -1.0)]);
        for i in 0..side {
            for j in 0..side - 1 {
                join(at(i, j), at(i, j + 1));
                join(at(j, i), at(j + 1, i));
            }
        }
        entries.extend((0..side * side).map(|row| (row, row, 1.0)));
        let place = |row: u32| DVec3::new(f64::from(row / side), f64::from(row % side), 0.0);
        (Symmetric::new((side * side) as usize, entries), (0..side * side).map(place).collect())
    }

    #[test]
    fn solutions_satisfy_their_systems_in_any_order() {
        let (matrix, places) = grid(17);
        let right = |row: usize| [f64::from(u32::try_from(row % 7).expect("small")), 1.0, 0.0];
        let plain: Vec<u32> = (0..17 * 17).collect();
        for order in [dissection(&matrix, &places), plain] {
            let factors = Plan::new(&matrix, order).factor().expect("positive");
            let found = factors.solve(right);
            let mut sums = vec![[0.0; 3]; matrix.len()];
            for row in 0..matrix.len() {
                for (column, value) in matrix.row(row) {
                    for k in 0..3 {
                        sums[row][k] += value * found[column][k];
                        if column != row {
                            sums[column][k] += value * found[row][k];
                        }
                    }
                }
            }
            for (row, sums) in sums.iter().enumerate() {
                for (sum, wanted) in sums.iter().zip(right(row)) {
                    assert!((sum - wanted).abs() < 1e-12, "row {row}: {sum} for {wanted}");
                }
            }
            // Rows of the Laplacian sum to zero, so the constant is solved by itself.
            assert!(found.iter().all(|numbers| (numbers[1] - 1.0).abs() < 1e-12 && numbers[2] == 0.0));
        }
    }

    #[test]
    fn dissection_names_each_row_once_and_keeps_entries_few() {
        let entries = |side: u32| {
            let (matrix, places) = grid(side);
            let order = dissection(&matrix, &places);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.iter().copied().eq(0..side * side));
            Plan::new(&matrix, order).bytes() as f64 / f64::from(side * side)
        };
        let (small, large) = (entries(32), entries(128));
        // In the grid's own order each row would have as many entries as a side has places: four times as many.
        assert!(large < 1.9 * small, "{small} and {large} bytes a row");
    }

    #[test]
    fn what_is_not_positive_is_named() {
        let loose = Symmetric::new(3, vec![(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (2, 1, -1.0)]);
        assert_eq!(Plan::new(&loose, vec![0, 1, 2]).factor().err(), Some(NotPositive { row: 2 }));
        assert_eq!(Plan::new(&loose, vec![2, 1, 0]).factor().err(), Some(NotPositive { row: 1 }));
        let empty = Symmetric::new(0, Vec::new());
        assert!(Plan::new(&empty, Vec::new()).factor().expect("nothing").solve(|_| [1.0]).is_empty());
    }

    #[test]
    fn entries_at_one_place_are_added_up() {
        let matrix = Symmetric::new(2, vec![(0, 1, 1.0), (0, 0, 2.0), (1, 0, 0.5), (1, 1, 4.0)]);
        let found =
            Plan::new(&matrix, vec![1, 0]).factor().expect("positive").solve(|row| [[1.0], [0.0]][row]);
        // (2 1.5; 1.5 4) of determinant 5.75.
        assert!((found[0][0] - 4.0 / 5.75).abs() < 1e-15 && (found[1][0] + 1.5 / 5.75).abs() < 1e-15);
    }
}
