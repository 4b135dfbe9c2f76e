//! Ranks and null spaces of small dense matrices, by elimination with full pivoting.

/// Pivots below this fraction of the largest entry count as zero.
pub const NEGLIGIBLE: f64 = 1e-9;
/// Entries of null vectors up to this size are roundoff.
pub const INSIGNIFICANT: f64 = 1e-6;

/// A basis of the null space of a matrix, given by its rows. Each vector has the entry 1 in a column where the others
/// are zero.
pub fn null_space(rows: Vec<Vec<f64>>, columns: usize) -> Vec<Vec<f64>> {
    let largest = largest_entry(&rows);
    eliminate(rows, columns, NEGLIGIBLE * largest).null_space
}

/// The largest absolute value of a matrix.
pub fn largest_entry(rows: &[Vec<f64>]) -> f64 {
    let entries = rows.iter().flatten();
    entries.fold(0.0_f64, |largest, entry| largest.max(entry.abs()))
}

/// What an elimination finds.
pub struct Eliminated {
    /// Positions of the rows with the pivots, whose number is the rank.
    pub pivots: Vec<usize>,
    /// A basis of the null space, as [`null_space`] gives it.
    pub null_space: Vec<Vec<f64>>,
}

/// Eliminates a matrix until all that is left is negligible.
pub fn eliminate(mut rows: Vec<Vec<f64>>, columns: usize, negligible: f64) -> Eliminated {
    let mut free: Vec<usize> = (0..columns).collect();
    let mut bound = Vec::new();
    let mut pivots: Vec<usize> = (0..rows.len()).collect();
    let mut sizes: Vec<u64> = rows.iter().map(|row| largest_size(row)).collect();
    while let Some((row, place)) = pivot(&rows, &sizes, bound.len()) {
        if rows[row][place].abs() <= negligible {
            break;
        }
        let at = bound.len();
        rows.swap(at, row);
        sizes.swap(at, row);
        pivots.swap(at, row);
        let (above, below) = rows.split_at_mut(at + 1);
        for (row, own) in below.iter_mut().zip(&mut sizes[at + 1..]) {
            if subtract(row, &above[at], place) {
                *own = largest_size(row);
            }
        }
        above[at] = spread(&above[at], &free, columns);
        bound.push(free.remove(place));
    }
    pivots.truncate(bound.len());
    let null_vectors = free.iter().map(|&column| null_vector(&rows, &bound, column, columns));
    Eliminated {
        null_space: null_vectors.collect(),
        pivots,
    }
}

/// The largest entry of the rows from a position on, given the size of the largest of each row.
fn pivot(rows: &[Vec<f64>], sizes: &[u64], from: usize) -> Option<(usize, usize)> {
    let row = (from..rows.len()).max_by_key(|&row| sizes[row])?;
    let place = rows[row].iter().rposition(|&entry| size(entry) == sizes[row])?;
    Some((row, place))
}

fn largest_size(row: &[f64]) -> u64 {
    row.iter().map(|&entry| size(entry)).max().unwrap_or_default()
}

/// In the order of magnitudes; NaN is larger than all numbers.
fn size(entry: f64) -> u64 {
    entry.abs().to_bits()
}

/// Subtracts a multiple of a pivot row so that a place of a row vanishes, and removes that place. Returns whether it had
/// an entry.
fn subtract(row: &mut Vec<f64>, pivot: &[f64], place: usize) -> bool {
    let had_entry = row[place] != 0.0;
    if had_entry {
        let factor = row[place] / pivot[place];
        let entries = row.iter_mut().zip(pivot);
        entries.for_each(|(entry, own)| *entry -= factor * own);
    }
    row.remove(place);
    had_entry
}

/// A row of all columns, given that of those that are free.
fn spread(row: &[f64], free: &[usize], columns: usize) -> Vec<f64> {
    let mut whole = vec![0.0; columns];
    free.iter().zip(row).for_each(|(&column, entry)| whole[column] = *entry);
    whole
}

/// The null vector with the entry 1 at a free column, by back substitution.
fn null_vector(rows: &[Vec<f64>], bound: &[usize], column: usize, columns: usize) -> Vec<f64> {
    let mut vector = vec![0.0; columns];
    vector[column] = 1.0;
    for (at, &own) in bound.iter().enumerate().rev() {
        let others = bound[at + 1..].iter().chain([&column]);
        let known: f64 = others.map(|&other| rows[at][other] * vector[other]).sum();
        vector[own] = -known / rows[at][own];
    }
    vector
}

/// The columns in which vectors have significant entries.
pub fn support(vectors: &[Vec<f64>]) -> Vec<usize> {
    let size = vectors.first().map_or(0, Vec::len);
    let speaks = |column: &usize| vectors.iter().any(|vector| vector[*column].abs() > INSIGNIFICANT);
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
