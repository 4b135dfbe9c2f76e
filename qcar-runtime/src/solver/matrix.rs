//! The exponential of a small matrix.

use std::array;

use crate::vectors::{Loops, widest};

/// Four numbers that are computed together.
pub(super) type Lanes = [f64; 4];

/// A square matrix of a size that is a multiple of four.
#[derive(Clone)]
pub(super) struct Matrix {
    size: usize,
    /// Four columns, row by row, then the next four.
    panels: Vec<Lanes>,
}

impl Matrix {
    /// A zero matrix of this size, or of the next multiple of four.
    pub fn zero(size: usize) -> Self {
        let size = size.next_multiple_of(4);
        Self {
            size,
            panels: vec![[0.0; 4]; size * size / 4],
        }
    }

    /// Number of rows and of columns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// An entry.
    #[inline]
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        self.panels[column / 4 * self.size + row][column % 4]
    }

    /// A mutable entry.
    #[inline]
    pub fn entry_mut(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.panels[column / 4 * self.size + row][column % 4]
    }

    /// Its exponential by scaling and squaring: a power series of a fraction of the matrix, squared repeatedly (N. J.
    /// Higham, A. H. Al-Mohy, "Computing matrix functions", Acta Numerica 19, 2010, section 4). `None` if it is not
    /// finite, or if the norm of the matrix exceeds a million.
    pub fn exponential(&self) -> Option<Self> {
        let powers = [self.clone(), self.times(self)];
        let fourth = powers[1].times(&powers[1]);
        // Uses the norm of a power: states have units, so large entries between states of different units do not mean a
        // fast system.
        let size = fourth.norm().powf(0.25);
        let squarings = (size / SMALL).log2().ceil().max(0.0) as i32;
        (size <= LARGE).then(|| {
            let part = self.series(powers, fourth, 0.5_f64.powi(squarings));
            (0..squarings).fold(part, |part, _| part.times(&part))
        })
    }

    /// The series of the exponential of `scale` times the matrix, by its first, second and fourth powers.
    fn series(&self, [first, second]: [Self; 2], fourth: Self, scale: f64) -> Self {
        let third = first.times(&second);
        let four_terms = |from: usize| {
            let [zeroth, factors @ ..]: [f64; 4] = array::from_fn(|power| over_factorial(scale, from + power));
            let mut sum = self.clone();
            let powers = first.panels.iter().zip(&second.panels).zip(&third.panels);
            for (sum, ((first, second), third)) in sum.panels.iter_mut().zip(powers) {
                *sum = array::from_fn(|lane| {
                    factors[0] * first[lane] + factors[1] * second[lane] + factors[2] * third[lane]
                });
            }
            (0..self.size).for_each(|row| *sum.entry_mut(row, row) += zeroth);
            sum
        };
        (0..TERMS - 4)
            .step_by(4)
            .rev()
            .fold(four_terms(TERMS - 4), |later, from| {
                let mut sum = four_terms(from);
                sum.add_product(&fourth, &later);
                sum
            })
    }

    /// The product with another matrix of the same size.
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::zero(self.size);
        product.add_product(self, other);
        product
    }

    /// Adds the product of two matrices of this size.
    fn add_product(&mut self, left: &Self, right: &Self) {
        widest(Product {
            size: self.size,
            left: &left.panels,
            right: &right.panels,
            sum: &mut self.panels,
        });
    }

    /// The largest sum of a row.
    fn norm(&self) -> f64 {
        let row = |row: usize| (0..self.size).map(|column| self.entry(row, column).abs()).sum();
        // Keeps a NaN.
        (0..self.size)
            .map(row)
            .fold(0.0, |most, sum: f64| if sum <= most { most } else { sum })
    }
}

/// The panels of two matrices, and of what their product is added to.
struct Product<'a> {
    size: usize,
    left: &'a [Lanes],
    right: &'a [Lanes],
    sum: &'a mut [Lanes],
}

impl Loops for Product<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let right = self.right.chunks_exact(self.size);
        for (sum, panel) in self.sum.chunks_exact_mut(self.size).zip(right) {
            for (tile, sum) in sum.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                // Four rows of four, which stay in registers.
                let mut sums = *sum;
                for (left, right) in self.left.chunks_exact(self.size).zip(panel.as_chunks::<4>().0) {
                    let left = &left.as_chunks::<4>().0[tile];
                    for k in 0..4 {
                        for row in 0..4 {
                            for lane in 0..4 {
                                sums[row][lane] += left[row][k] * right[k][lane];
                            }
                        }
                    }
                }
                *sum = sums;
            }
        }
    }
}

/// Number of terms of the series.
const TERMS: usize = 16;
/// Largest norm for which the first omitted term is below 1e-13.
const SMALL: f64 = 1.0;
/// Largest norm: a faster mode has decayed completely, or has turned so often that no digit would be right.
const LARGE: f64 = 1e6;

/// `xⁿ / n!`.
fn over_factorial(x: f64, n: usize) -> f64 {
    (1..=n).fold(1.0, |value, i| value * x / i as f64)
}
