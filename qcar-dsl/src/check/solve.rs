//! Small linear systems of complex numbers.

use num_complex::Complex64;

/// Solves `matrix x = column` for several columns, by elimination with partial pivoting that skips zeros. A singular
/// matrix gives values that are not finite.
pub fn solve(mut matrix: Vec<Vec<Complex64>>, mut columns: Vec<Vec<Complex64>>) -> Vec<Vec<Complex64>> {
    let size = matrix.len();
    for at in 0..size {
        let pivot = (at..size).max_by(|&a, &b| magnitude(matrix[a][at]).total_cmp(&magnitude(matrix[b][at])));
        let pivot = pivot.unwrap_or(at);
        matrix.swap(at, pivot);
        columns.iter_mut().for_each(|column| column.swap(at, pivot));
        let pivot_row = nonzeros(&matrix[at], at);
        for row in at + 1..size {
            if is_zero(matrix[row][at]) {
                continue;
            }
            let factor = matrix[row][at] / matrix[at][at];
            for &(place, own) in &pivot_row {
                matrix[row][place] -= factor * own;
            }
            for column in columns.iter_mut().filter(|column| !is_zero(column[at])) {
                let change = factor * column[at];
                column[row] -= change;
            }
        }
    }
    let rows: Vec<Vec<(usize, Complex64)>> = (0..size).map(|at| nonzeros(&matrix[at], at + 1)).collect();
    for column in &mut columns {
        for at in (0..size).rev() {
            let known: Complex64 = rows[at].iter().map(|&(place, entry)| entry * column[place]).sum();
            column[at] = (column[at] - known) / matrix[at][at];
        }
    }
    columns
}

/// Size of a pivot without a square root, as in LAPACK.
fn magnitude(x: Complex64) -> f64 {
    x.re.abs() + x.im.abs()
}

fn is_zero(x: Complex64) -> bool {
    x.re == 0.0 && x.im == 0.0
}

/// The nonzero entries of a row from a position on.
fn nonzeros(row: &[Complex64], from: usize) -> Vec<(usize, Complex64)> {
    let entries = row.iter().copied().enumerate().skip(from);
    entries.filter(|&(_, entry)| !is_zero(entry)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_whose_first_pivot_is_zero_is_solved() {
        // (0 i; 2 1) x = (1; 4) has x2 = 1/i = -i and x1 = (4 + i)/2.
        let number = Complex64::new;
        let matrix = vec![
            vec![number(0.0, 0.0), number(0.0, 1.0)],
            vec![number(2.0, 0.0), number(1.0, 0.0)],
        ];
        let x = &solve(matrix, vec![vec![number(1.0, 0.0), number(4.0, 0.0)]])[0];
        assert!((x[0] - number(2.0, 0.5)).norm() < 1e-15);
        assert!((x[1] - number(0.0, -1.0)).norm() < 1e-15);
    }
}
