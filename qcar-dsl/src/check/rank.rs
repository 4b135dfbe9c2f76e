//! Ranks and null spaces of small dense matrices, by elimination with full pivoting.

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
pub fn null_space_of_scale(mut rows: Vec<Vec<f64>>, columns: usize, largest: f64) -> Vec<Vec<f64>> {
    let mut free: Vec<usize> = (0..columns).collect();
    let mut bound = Vec::new();
    let mut foremost: Vec<Option<usize>> = rows.iter().map(|row| largest_of(row)).collect();
    while let Some((row, place)) = pivot(&rows, &foremost, bound.len()) {
        if rows[row][place].abs() <= NEGLIGIBLE * largest {
            break;
        }
        let at = bound.len();
        rows.swap(at, row);
        foremost.swap(at, row);
        let (above, below) = rows.split_at_mut(at + 1);
        for (row, foremost) in below.iter_mut().zip(&mut foremost[at + 1..]) {
            let changed = eliminate(row, &above[at], place);
            match foremost {
                Some(own) if !changed && *own > place => *own -= 1,
                Some(own) if !changed && *own < place => {}
                _ => *foremost = largest_of(row),
            }
        }
        above[at] = spread(&above[at], &free, columns);
        bound.push(free.remove(place));
    }
    free.iter()
        .map(|&column| null_vector(&rows, &bound, column, columns))
        .collect()
}

/// The place at which a row is largest.
fn largest_of(row: &[f64]) -> Option<usize> {
    let sizes = row.iter().map(|entry| size(*entry)).enumerate();
    sizes.max_by_key(|(_, size)| *size).map(|(place, _)| place)
}

/// The largest entry of the rows from a position on; the place of the largest entry of each row is known.
fn pivot(rows: &[Vec<f64>], foremost: &[Option<usize>], from: usize) -> Option<(usize, usize)> {
    let left = (from..rows.len()).filter_map(|row| Some((row, foremost[row]?)));
    left.max_by_key(|&(row, place)| size(rows[row][place]))
}

/// In the order of magnitudes; NaN is larger than all numbers.
fn size(entry: f64) -> u64 {
    entry.abs().to_bits()
}

/// Eliminates a place of a row by a pivot row, and removes it. Returns whether that changed the others.
fn eliminate(row: &mut Vec<f64>, pivot: &[f64], place: usize) -> bool {
    let factor = row[place] / pivot[place];
    if factor != 0.0 {
        let entries = row.iter_mut().zip(pivot);
        entries.for_each(|(entry, own)| *entry -= factor * own);
    }
    row.remove(place);
    factor != 0.0
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
