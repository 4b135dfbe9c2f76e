//! A model at the samples of a period: every matrix has a row for each sample, and a column for each entry.

use nalgebra::DMatrix;

use crate::model::{Model, Points};

/// The samples of a drive.
pub struct Period<'a> {
    model: &'a dyn Model,
    p: Vec<f64>,
    constants: Vec<f64>,
    /// The inputs.
    pub inputs: DMatrix<f64>,
    states: DMatrix<f64>,
    /// The rates of all states.
    pub rates: DMatrix<f64>,
    /// The nonzeros of A, B, C and D.
    pub matrices: DMatrix<f64>,
    /// The nonzeros of ∂f/∂p and ∂h/∂p.
    pub by_parameter: DMatrix<f64>,
}

impl<'a> Period<'a> {
    /// A model at rest without a drive; rates, matrices and derivatives by parameters are zero until they are computed.
    pub fn new(model: &'a dyn Model, p: &[f64], samples: usize) -> Self {
        let about = model.about();
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        let samples = |columns| DMatrix::zeros(samples, columns);
        Self {
            model,
            p: p.to_vec(),
            constants,
            states: samples(about.states.len()),
            rates: samples(about.states.len()),
            matrices: samples(about.matrices.len()),
            by_parameter: samples(about.parameter_jacobian.len()),
            inputs: samples(about.inputs.len()),
        }
    }

    /// Sets the samples of the listed states to the columns of `series`, and computes the rates.
    pub fn move_to(&mut self, listed: &[usize], series: &DMatrix<f64>) {
        for (&state, samples) in listed.iter().zip(series.column_iter()) {
            self.states.set_column(state, &samples);
        }
        let points = points(&self.states, &self.inputs);
        self.model
            .derivative_at(&self.constants, &points, self.rates.as_mut_slice());
    }

    /// Computes the matrices at the present states.
    pub fn linearise(&mut self) {
        let points = points(&self.states, &self.inputs);
        self.model.matrices_at(&self.p, &points, self.matrices.as_mut_slice());
    }

    /// Computes the derivatives by parameters at the present states.
    pub fn differentiate(&mut self) {
        let points = points(&self.states, &self.inputs);
        self.model
            .parameter_jacobian_at(&self.p, &points, self.by_parameter.as_mut_slice());
    }

    /// All outputs at the present states.
    pub fn outputs(&self) -> DMatrix<f64> {
        let mut outputs = DMatrix::zeros(self.inputs.nrows(), self.model.about().outputs.len());
        let points = points(&self.states, &self.inputs);
        self.model.outputs_at(&self.constants, &points, outputs.as_mut_slice());
        outputs
    }
}

fn points<'a>(states: &'a DMatrix<f64>, inputs: &'a DMatrix<f64>) -> Points<'a> {
    Points {
        count: inputs.nrows(),
        x: states.as_slice(),
        u: inputs.as_slice(),
    }
}
