//! A problem with some of its variables fixed.

use nalgebra::{DMatrix, DVector};

use super::{Bounds, Outcome, Problem};

/// A problem in the variables that are not held.
pub(super) struct Held<'a, P: ?Sized> {
    problem: &'a mut P,
    /// Positions of the variables that are not held.
    varied: Vec<usize>,
    /// All variables.
    x: Vec<f64>,
    /// Jacobian by all variables.
    jacobian: Vec<f64>,
}

impl<'a, P: Problem + ?Sized> Held<'a, P> {
    /// Holds variables at their values in `x`.
    pub fn new(problem: &'a mut P, x: Vec<f64>, is_held: &[bool]) -> Self {
        Self {
            varied: (0..x.len()).filter(|&k| !is_held[k]).collect(),
            jacobian: vec![0.0; x.len() * problem.residuals()],
            problem,
            x,
        }
    }

    /// The variables that are not held, of numbers for all variables.
    pub fn varied_of(&self, all: &[f64]) -> Vec<f64> {
        self.varied.iter().map(|&k| all[k]).collect()
    }

    /// Their bounds.
    pub fn bounds(&self, of_all: &Bounds) -> Bounds {
        Bounds {
            lower: self.varied_of(&of_all.lower),
            upper: self.varied_of(&of_all.upper),
        }
    }

    /// The result of a search for all variables; held ones are at no bound.
    pub fn outcome(mut self, found: Outcome) -> Outcome {
        self.place(&found.x);
        let (rows, columns) = (self.problem.residuals(), self.x.len());
        let (mut residual, mut jacobian) = (DVector::zeros(rows), DMatrix::zeros(rows, columns));
        self.problem
            .evaluate(&self.x, residual.as_mut_slice(), jacobian.as_mut_slice());
        let mut at_bound = vec![0; columns];
        for (&k, side) in self.varied.iter().zip(&found.at_bound) {
            at_bound[k] = *side;
        }
        Outcome {
            x: self.x,
            residual,
            jacobian,
            at_bound,
            ..found
        }
    }

    fn place(&mut self, varied: &[f64]) {
        for (&k, value) in self.varied.iter().zip(varied) {
            self.x[k] = *value;
        }
    }
}

impl<P: Problem + ?Sized> Problem for Held<'_, P> {
    fn variables(&self) -> usize {
        self.varied.len()
    }

    fn residuals(&self) -> usize {
        self.problem.residuals()
    }

    fn evaluate(&mut self, varied: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        self.place(varied);
        self.problem.evaluate(&self.x, residual, &mut self.jacobian);
        let rows = residual.len();
        for (&k, column) in self.varied.iter().zip(jacobian.chunks_mut(rows)) {
            column.copy_from_slice(&self.jacobian[k * rows..][..rows]);
        }
    }

    fn evaluate_residual(&mut self, varied: &[f64], residual: &mut [f64]) -> bool {
        self.place(varied);
        self.problem.evaluate_residual(&self.x, residual)
    }
}
