//! Rates, outputs, matrices and their parameter Jacobians for many parameter sets: computed in parallel, set by set.
//! Nonzeros are put into dense arrays.

use ndarray::{Array2, Array3, Array4, ArrayView2};
use qcar::stopping;
use qcar_runtime::model::{About, Entry, Matrix, Model};
use rayon::prelude::*;

/// A, B, C and D, in that order.
pub const ALL: [Matrix; 4] = [Matrix::A, Matrix::B, Matrix::C, Matrix::D];

/// Below this number of sets, neither threads nor checks for signals are worthwhile.
pub const FEW: usize = 64;

/// Points at which matrices are evaluated: a row of parameters, states and inputs for each set.
pub struct At<'a> {
    /// Parameters.
    pub p: ArrayView2<'a, f64>,
    /// States.
    pub x: ArrayView2<'a, f64>,
    /// Inputs.
    pub u: ArrayView2<'a, f64>,
}

impl At<'_> {
    /// The nonzeros of each set in a row of `width`.
    fn rows(&self, width: usize, one: impl Fn(&[f64], &[f64], &[f64], &mut [f64]) + Sync) -> Vec<f64> {
        let mut rows = vec![0.0; self.p.nrows() * width];
        let stop = stopping::of_this_work();
        let work = |(set, into): (usize, &mut [f64])| {
            stopping::here(stop.as_ref());
            let row = |of: &ArrayView2<'_, f64>| of.row(set).to_vec();
            one(&row(&self.p), &row(&self.x), &row(&self.u), into);
        };
        match width {
            0 => {}
            _ if self.p.nrows() < FEW => rows.chunks_exact_mut(width).enumerate().for_each(work),
            _ => rows.par_chunks_exact_mut(width).panic_fuse().enumerate().for_each(work),
        }
        rows
    }
}

/// The rates of the states of each set: (sets, states).
pub fn derivatives(model: &dyn Model, at: &At<'_>) -> Array2<f64> {
    let about = model.about();
    let states = about.states.len();
    let rows = at.rows(states, |p, x, u, into| {
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        model.derivative(&constants, x, u, into);
    });
    Array2::from_shape_vec((at.p.nrows(), states), rows).expect("a row for each set")
}

/// The outputs of each set: (sets, outputs).
pub fn outputs(model: &dyn Model, at: &At<'_>) -> Array2<f64> {
    let about = model.about();
    let outputs = about.outputs.len();
    let rows = at.rows(outputs, |p, x, u, into| {
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        model.outputs(&constants, x, u, into);
    });
    Array2::from_shape_vec((at.p.nrows(), outputs), rows).expect("a row for each set")
}

/// Rows and columns of a matrix.
fn shape(about: &About, matrix: Matrix) -> (usize, usize) {
    let [states, inputs, outputs] = [about.states.len(), about.inputs.len(), about.outputs.len()];
    match matrix {
        Matrix::A => (states, states),
        Matrix::B => (states, inputs),
        Matrix::C => (outputs, states),
        Matrix::D => (outputs, inputs),
    }
}

/// The positions of the entries of one matrix: among the nonzeros, and in the matrix.
fn places<'a>(entries: impl Iterator<Item = &'a Entry>, matrix: Matrix) -> Vec<(usize, [usize; 2])> {
    let own = entries.enumerate().filter(|(_, entry)| entry.matrix == matrix);
    own.map(|(nth, entry)| (nth, [entry.row.into(), entry.column.into()]))
        .collect()
}

/// A, B, C and D, each (sets, rows, columns).
pub fn matrices(model: &dyn Model, at: &At<'_>) -> [Array3<f64>; 4] {
    let about = model.about();
    let width = about.matrices.len();
    let rows = at.rows(width, |p, x, u, into| model.matrices(p, x, u, into));
    ALL.map(|matrix| {
        let (height, breadth) = shape(about, matrix);
        let mut dense = Array3::zeros((at.p.nrows(), height, breadth));
        let own = places(about.matrices.iter(), matrix);
        for (mut set, values) in dense.outer_iter_mut().zip(rows.chunks_exact(width.max(1))) {
            own.iter().for_each(|&(nth, place)| set[place] = values[nth]);
        }
        dense
    })
}

/// Their derivatives by every parameter, each (sets, parameters, rows, columns). The derivative by a parameter includes
/// those by the parameters that are tied to it.
pub fn jacobians(model: &dyn Model, at: &At<'_>, leader: &[usize]) -> [Array4<f64>; 4] {
    let about = model.about();
    let width = about.sensitivities.len();
    let rows = at.rows(width, |p, x, u, into| model.sensitivities(p, x, u, into));
    ALL.map(|matrix| {
        let (height, breadth) = shape(about, matrix);
        let mut dense = Array4::zeros((at.p.nrows(), about.parameters.len(), height, breadth));
        let own = places(about.sensitivities.iter().map(|(entry, _)| entry), matrix);
        for (mut set, values) in dense.outer_iter_mut().zip(rows.chunks_exact(width.max(1))) {
            for &(nth, [row, column]) in &own {
                let parameter = leader[usize::from(about.sensitivities[nth].1)];
                set[[parameter, row, column]] += values[nth];
            }
        }
        dense
    })
}
