//! The matrix of a linear system over a step: its exponential, and what forces that change during the step give.

use std::array;

/// Four numbers that are computed together.
pub(super) type Lanes = [f64; 4];

/// Four columns, row by row.
pub(super) type Panel = Vec<Lanes>;

/// A square matrix: of each row the entries that are not zero, with their columns.
pub(super) struct Matrix(Vec<Vec<(usize, f64)>>);

impl Matrix {
    /// A matrix of so many rows and columns by its entries.
    #[inline(always)]
    pub fn new(size: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let row = |row: usize| {
            let mut entries = Vec::with_capacity(size);
            entries.extend(
                (0..size)
                    .map(|column| (column, entry(row, column)))
                    .filter(|(_, entry)| *entry != 0.0),
            );
            entries
        };
        Self((0..size).map(row).collect())
    }

    /// `e^Z`, `Z` being this matrix, in panels: the square of the square of that of a quarter, whose series is short.
    /// None where even that does not converge.
    #[inline(always)]
    pub fn exponential(&self) -> Option<Vec<Panel>> {
        const TERMS: usize = 16;
        let size = self.0.len();
        let unit =
            |first: usize| (0..size).map(move |row| array::from_fn(|lane| f64::from(u8::from(first + lane == row))));
        let mut panels: Vec<Panel> = Vec::with_capacity(size.div_ceil(4));
        for first in (0..size).step_by(4) {
            let [quarter] = self.series(0.25, unit(first).collect(), TERMS)?;
            panels.push(quarter);
        }
        let mut next = vec![[0.0; 4]; size];
        for _ in 0..2 {
            let factor = Self::new(size, |row, column| panels[column / 4][row][column % 4]);
            for panel in &mut panels {
                factor.multiply(1.0, panel, &mut next);
                std::mem::swap(panel, &mut next);
            }
        }
        Some(panels)
    }

    /// With `Z` the matrix, for each column of `v`: `∫ e^(Z (1 - s)) s^j ds v` over s from 0 to 1, for j = 0, 1, … (of
    /// which the first is what is not asked for, `e^Z v`). None where the series do not converge.
    #[inline(always)]
    pub fn means<const N: usize>(&self, v: Panel) -> Option<[Panel; N]> {
        const TERMS: usize = 28;
        self.series(1.0, v, TERMS)
    }

    /// The first terms of `e^Z v`, with `Z` the matrix times `scale`, and behind it of [`Matrix::means`]. None where the
    /// last is not negligible.
    #[inline(always)]
    fn series<const N: usize>(&self, scale: f64, v: Panel, terms: usize) -> Option<[Panel; N]> {
        let mut sums: [Panel; N] = array::from_fn(|_| vec![[0.0; 4]; v.len()]);
        // Those of the term Zⁱ v: 1/i!, and (j - 1)!/(i + j)!.
        let mut weights: [f64; N] = array::from_fn(|j| 1.0 / j.max(1) as f64);
        let (mut term, mut next) = (v.clone(), v);
        for i in 0..terms {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                for (sum, term) in sum.iter_mut().zip(&term) {
                    for lane in 0..4 {
                        sum[lane] += weight * term[lane];
                    }
                }
            }
            self.multiply(scale, &term, &mut next);
            std::mem::swap(&mut term, &mut next);
            weights = array::from_fn(|j| weights[j] / (i + j + 1) as f64);
        }
        let converged = weights[0] * largest(&term) <= NEGLIGIBLE * largest(&sums[0]);
        converged.then_some(sums)
    }

    /// `product` = `scale` times the matrix times `panel`.
    #[inline(always)]
    fn multiply(&self, scale: f64, panel: &[Lanes], product: &mut [Lanes]) {
        for (row, product) in self.0.iter().zip(product) {
            let mut sum = [0.0; 4];
            for &(i, factor) in row {
                let (factor, entries) = (scale * factor, &panel[i]);
                for lane in 0..4 {
                    sum[lane] += factor * entries[lane];
                }
            }
            *product = sum;
        }
    }
}

/// What the last term of a series may be of its sum.
const NEGLIGIBLE: f64 = 1e-12;

fn largest(panel: &[Lanes]) -> f64 {
    panel.iter().flatten().fold(0.0, |largest, v| v.abs().max(largest))
}
