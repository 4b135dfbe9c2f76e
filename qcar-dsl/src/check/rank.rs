//! Ranks and null spaces of small dense matrices, by elimination with full pivoting.

/// Pivots below this part of the largest entry count as zero.
const NEGLIGIBLE: f64 = 1e-9;

/// A basis of the null space of a matrix, given by its rows. Each vector has the entry 1 at a column of its own.
pub fn null_space(rows: Vec<Vec<f64>>, columns: usize) -> Vec<Vec<f64>> {
    let largest = rows
        .iter()
        .flatten()
        .fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    null_space_of_scale(rows, columns, largest)
}

/// The same for a matrix whose entries are small against a scale that the caller knows.
pub fn null_space_of_scale(mut rows: Vec<Vec<f64>>, columns: usize, largest: f64) -> Vec<Vec<f64>> {
    let mut order: Vec<usize> = (0..columns).collect();
    let mut rank = 0;
    while let Some((row, place)) = pivot(&rows, &order, rank) {
        if rows[row][order[place]].abs() <= NEGLIGIBLE * largest {
            break;
        }
        rows.swap(rank, row);
        order.swap(rank, place);
        eliminate(&mut rows, rank, order[rank]);
        rank += 1;
    }
    let (bound, free) = order.split_at(rank);
    free.iter()
        .map(|&column| null_vector(&rows, bound, column, columns))
        .collect()
}

/// The largest entry of what is left.
fn pivot(rows: &[Vec<f64>], order: &[usize], rank: usize) -> Option<(usize, usize)> {
    let left = (rank..rows.len()).flat_map(|row| (rank..order.len()).map(move |place| (row, place)));
    left.max_by(|a, b| rows[a.0][order[a.1]].abs().total_cmp(&rows[b.0][order[b.1]].abs()))
}

/// Makes a column zero in every row but that of its pivot, and the pivot one.
fn eliminate(rows: &mut [Vec<f64>], at: usize, column: usize) {
    let pivot = rows[at][column];
    rows[at].iter_mut().for_each(|entry| *entry /= pivot);
    let pivot_row = rows[at].clone();
    for (index, row) in rows.iter_mut().enumerate() {
        let factor = row[column];
        if index != at && factor != 0.0 {
            row.iter_mut()
                .zip(&pivot_row)
                .for_each(|(entry, own)| *entry -= factor * own);
        }
    }
}

fn null_vector(rows: &[Vec<f64>], bound: &[usize], column: usize, columns: usize) -> Vec<f64> {
    let mut vector = vec![0.0; columns];
    vector[column] = 1.0;
    for (row, &own) in rows.iter().zip(bound) {
        vector[own] = -row[column];
    }
    vector
}

/// The columns in which vectors have an entry worth speaking of.
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
