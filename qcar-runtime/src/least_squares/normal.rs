//! `JᵀJ`, `Jᵀr` and the scale of each variable.

use nalgebra::{DMatrix, DVector};

use crate::vectors::{Loops, dot, dots, widest};

/// Rows of the Jacobian in one block: twenty columns of them fit in a first-level cache.
const BLOCK: usize = 192;

/// Columns of a block that stay in that cache while all others are multiplied by them.
const GROUP: usize = 16;

/// The normal equations of a linearised problem.
pub(super) struct NormalEquations {
    /// `JᵀJ`.
    pub matrix: DMatrix<f64>,
    /// `Jᵀr`.
    pub gradient: DVector<f64>,
    /// Largest norm of each column so far.
    pub largest: DVector<f64>,
    /// Its reciprocal; 1 for a column that was always zero.
    pub scale: DVector<f64>,
}

impl NormalEquations {
    pub fn new(variables: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(variables, variables),
            gradient: DVector::zeros(variables),
            largest: DVector::zeros(variables),
            scale: DVector::repeat(variables, 1.0),
        }
    }

    /// Takes a new linearisation; false if it is not finite.
    pub fn assemble(&mut self, jacobian: &DMatrix<f64>, residual: &DVector<f64>) -> bool {
        let variables = self.gradient.len();
        let columns = (0..variables).map(|k| jacobian.column(k).data.into_slice());
        let columns: Vec<&[f64]> = columns.chain([residual.as_slice()]).collect();
        let products = products(&columns);
        self.matrix.copy_from(&products.view((0, 0), (variables, variables)));
        let gradient = products.view((variables, 0), (1, variables));
        self.gradient
            .iter_mut()
            .zip(gradient.iter())
            .for_each(|(own, product)| *own = *product);
        self.rescale();
        products.iter().all(|value| value.is_finite())
    }

    /// The Gauss-Newton step; `None` if the matrix is singular.
    pub fn newton(&self) -> Option<DVector<f64>> {
        let scale = &self.scale;
        let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
            scale[i] * self.matrix[(i, j)] * scale[j]
        });
        let step = scaled.cholesky()?.solve(&self.gradient.component_mul(scale));
        Some(-step.component_mul(scale))
    }

    fn rescale(&mut self) {
        for k in 0..self.scale.len() {
            self.largest[k] = self.largest[k].max(self.matrix[(k, k)].sqrt());
            if self.largest[k] > 0.0 {
                self.scale[k] = 1.0 / self.largest[k];
            }
        }
    }
}

/// `JᵀJ`.
pub(crate) fn gram(jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let columns: Vec<&[f64]> = jacobian.column_iter().map(|column| column.data.into_slice()).collect();
    products(&columns)
}

/// The scalar products of all pairs of columns.
pub(super) fn products(columns: &[&[f64]]) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(columns.len(), columns.len());
    let rows = columns.first().map_or(0, |column| column.len());
    for from in (0..rows).step_by(BLOCK) {
        let range = from..rows.min(from + BLOCK);
        let blocks = columns.iter().map(|column| &column[range.clone()]).enumerate();
        // Most nuisance parameters of a sensor or a run influence few rows.
        let seen = blocks.filter(|(_, block)| block.iter().any(|value| *value != 0.0));
        widest(Products {
            blocks: &seen.collect::<Vec<_>>(),
            sums: &mut sums,
        });
    }
    sums.fill_upper_triangle_with_lower_triangle();
    sums
}

/// Adds the products of a block of rows to the lower triangle; each column has its place.
struct Products<'a> {
    blocks: &'a [(usize, &'a [f64])],
    sums: &'a mut DMatrix<f64>,
}

impl Loops for Products<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        for (first, group) in self
            .blocks
            .chunks(GROUP)
            .enumerate()
            .map(|(at, group)| (at * GROUP, group))
        {
            for (count, (i, left)) in self.blocks.iter().enumerate().skip(first) {
                let (fours, rest) = group[..group.len().min(count + 1 - first)].as_chunks::<4>();
                for four in fours {
                    let products = dots(left, four.map(|(_, right)| right));
                    for ((j, _), product) in four.iter().zip(products) {
                        self.sums[(*i, *j)] += product;
                    }
                }
                for (j, right) in rest {
                    self.sums[(*i, *j)] += dot(left, right);
                }
            }
        }
    }
}
