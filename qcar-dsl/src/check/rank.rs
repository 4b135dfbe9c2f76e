//! Ranks and null spaces of small matrices, by elimination with full pivoting.

/// Pivots below this fraction of the largest entry count as zero.
const NEGLIGIBLE: f64 = 1e-9;

/// A basis of the null space of a matrix, given by its rows. Each vector has the entry 1 in a column where the others
/// are zero.
pub fn null_space(rows: Vec<Vec<f64>>, columns: usize) -> Vec<Vec<f64>> {
    let largest = rows
        .iter()
        .flatten()
        .fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    null_space_of_scale(rows, columns, largest)
}

/// The same for a matrix with small entries, relative to a given scale.
pub fn null_space_of_scale(rows: Vec<Vec<f64>>, columns: usize, largest: f64) -> Vec<Vec<f64>> {
    let mut rows: Vec<Row> = rows.iter().map(|row| nonzeros(row)).collect();
    let mut is_free = vec![true; columns];
    let mut bound = Vec::new();
    let mut foremost: Vec<Option<Entry>> = rows.iter().map(largest_of).collect();
    while let Some((row, (column, size))) = pivot(&foremost, bound.len()) {
        if size <= NEGLIGIBLE * largest {
            break;
        }
        let at = bound.len();
        rows.swap(at, row);
        foremost.swap(at, row);
        is_free[column] = false;
        bound.push(column);
        let (above, below) = rows.split_at_mut(at + 1);
        for (row, foremost) in below.iter_mut().zip(&mut foremost[at + 1..]) {
            if eliminate(row, &above[at], column) {
                *foremost = largest_of(row);
            }
        }
    }
    let free = (0..columns).filter(|&column| is_free[column]);
    free.map(|column| null_vector(&rows, &bound, column, columns)).collect()
}

/// A column and what stands there.
type Entry = (usize, f64);

/// The nonzeros of a row, in the order of the columns.
type Row = Vec<Entry>;

fn nonzeros(row: &[f64]) -> Row {
    let entries = row.iter().copied().enumerate();
    entries.filter(|(_, value)| *value != 0.0).collect()
}

fn value(row: &Row, column: usize) -> f64 {
    let place = row.binary_search_by_key(&column, |entry| entry.0);
    place.map_or(0.0, |place| row[place].1)
}

/// The column in which a row is largest, and the size there.
fn largest_of(row: &Row) -> Option<Entry> {
    let sizes = row.iter().map(|&(column, value)| (column, value.abs()));
    sizes.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The row from a position on with the largest entry; that of each row is known.
fn pivot(foremost: &[Option<Entry>], from: usize) -> Option<(usize, Entry)> {
    let left = (from..foremost.len()).filter_map(|row| Some((row, foremost[row]?)));
    left.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1))
}

/// Eliminates a column of a row by a pivot row. Returns whether the row had it.
fn eliminate(row: &mut Row, pivot: &Row, column: usize) -> bool {
    let factor = value(row, column) / value(pivot, column);
    if factor == 0.0 {
        return false;
    }
    let mut sum = Vec::with_capacity(row.len() + pivot.len());
    let (mut own, mut other) = (row.iter().copied().peekable(), pivot.iter().copied().peekable());
    while let Some(next) = [own.peek(), other.peek()]
        .into_iter()
        .flatten()
        .map(|entry| entry.0)
        .min()
    {
        let [own, other] = [&mut own, &mut other].map(|side| side.next_if(|entry| entry.0 == next));
        let value = own.map_or(0.0, |own| own.1) - other.map_or(0.0, |other| factor * other.1);
        if next != column && value != 0.0 {
            sum.push((next, value));
        }
    }
    *row = sum;
    true
}

/// The null vector with the entry 1 at a free column, by back substitution.
fn null_vector(rows: &[Row], bound: &[usize], column: usize, columns: usize) -> Vec<f64> {
    let mut vector = vec![0.0; columns];
    vector[column] = 1.0;
    for (row, &own) in rows.iter().zip(bound).rev() {
        // Its own entry is still zero, and it has none in the columns that were bound before.
        let known: f64 = row.iter().map(|&(other, value)| value * vector[other]).sum();
        vector[own] = -known / value(row, own);
    }
    vector
}

/// The columns in which vectors have significant entries.
pub fn support(vectors: &[Vec<f64>]) -> Vec<usize> {
    let size = vectors.first().map_or(0, Vec::len);
    let speaks = |column: &usize| vectors.iter().any(|vector| vector[*column].abs() > 1e-6);
    (0..size).filter(speaks).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_chain_of_two_springs_moves_as_one() {
        let rows = vec![vec![2.0, -2.0, 0.0], vec![-2.0, 5.0, -3.0], vec![0.0, -3.0, 3.0]];
        let null = null_space(rows, 3);
        assert_eq!(null.len(), 1);
        assert!(null[0].iter().all(|entry| (entry - 1.0).abs() < 1e-12));
    }

    #[test]
    fn a_regular_matrix_has_no_null_space() {
        assert!(null_space(vec![vec![1.0, 2.0], vec![2.0, 1.0]], 2).is_empty());
        assert_eq!(null_space(vec![], 2).len(), 2);
    }
}
