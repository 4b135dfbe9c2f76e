//! The motion at the stages of the parts of some steps, and the Jacobians there.

use crate::model::{Model, Points};

/// Stages of a Runge-Kutta step.
pub const STAGES: usize = 4;

/// States and inputs at the stages of the parts of some steps: a row of all points for each.
#[derive(Default)]
pub struct Stages {
    /// Number of points.
    count: usize,
    x: Vec<f64>,
    u: Vec<f64>,
    /// The parts that are known so far.
    pub parts: Vec<Part>,
}

/// A part of a step.
pub struct Part {
    /// Length, s.
    pub length: f64,
    /// Where the weights of the states begin, if one of them decays within the part.
    pub weights: Option<usize>,
    /// True if the readings are taken at its start.
    pub is_read: bool,
}

impl Stages {
    /// Makes room for some parts of a model with as many states and inputs.
    pub fn prepare(&mut self, parts: usize, (states, inputs): (usize, usize)) {
        self.count = STAGES * parts;
        self.x.resize(states * self.count, 0.0);
        self.u.resize(inputs * self.count, 0.0);
        self.parts.clear();
    }

    /// Stores the states and inputs of a point.
    pub fn put(&mut self, point: usize, x: &[f64], u: &[f64]) {
        for (rows, values) in [(&mut self.x, x), (&mut self.u, u)] {
            for (row, value) in rows.chunks_exact_mut(self.count).zip(values) {
                row[point] = *value;
            }
        }
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.count
    }

    /// An input at all points.
    pub fn u(&self, input: usize) -> &[f64] {
        &self.u[input * self.count..][..self.count]
    }

    fn points(&self) -> Points<'_> {
        Points {
            count: self.count,
            x: &self.x,
            u: &self.u,
        }
    }
}

/// The Jacobians at the stages of some steps: a row of all points for each nonzero.
#[derive(Default)]
pub struct Jacobians {
    /// The points.
    pub stages: Stages,
    /// Number of points for which the matrices are stored: one for a linear model, whose matrices are the same at all.
    width: usize,
    matrices: Vec<f64>,
    parameters: Vec<f64>,
}

impl Jacobians {
    /// Evaluates A, B, C and D.
    pub fn evaluate_matrices(&mut self, model: &dyn Model, p: &[f64]) {
        let about = model.about();
        if about.linear && self.width == 1 {
            return;
        }
        let points = self.stages.points();
        self.width = if about.linear { 1 } else { points.count };
        self.matrices.resize(about.matrices.len() * self.width, 0.0);
        if about.linear {
            let rest = [vec![0.0; about.states.len()], vec![0.0; about.inputs.len()]];
            model.matrices(p, &rest[0], &rest[1], &mut self.matrices);
        } else {
            model.matrices_at(p, &points, &mut self.matrices);
        }
    }

    /// Evaluates the derivatives by the parameters.
    pub fn evaluate_parameters(&mut self, model: &dyn Model, p: &[f64]) {
        let points = self.stages.points();
        let nonzeros = model.about().parameter_jacobian.len();
        self.parameters.resize(nonzeros * points.count, 0.0);
        model.parameter_jacobian_at(p, &points, &mut self.parameters);
    }

    /// A nonzero of the matrices at a point.
    #[inline(always)]
    pub fn matrix(&self, nonzero: usize, point: usize) -> f64 {
        self.matrices[nonzero * self.width + if self.width == 1 { 0 } else { point }]
    }

    /// A nonzero of the derivatives by the parameters at all points.
    pub fn parameter(&self, nonzero: usize) -> &[f64] {
        &self.parameters[nonzero * self.stages.count..][..self.stages.count]
    }
}
