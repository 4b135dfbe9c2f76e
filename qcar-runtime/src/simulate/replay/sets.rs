//! A model with one parameter set, or with several that are computed together.

use crate::model::{LANES, Lanes, Model};

/// A model with its parameters. Each state and output has one value for each set.
pub trait Sets {
    /// Number of sets.
    const LANES: usize;

    /// Derivatives of the states. All sets have the same inputs.
    fn derivative(&mut self, x: &[f64], u: &[f64], dx: &mut [f64]);

    /// Outputs of all sets.
    fn outputs(&mut self, x: &[f64], u: &[f64], y: &mut [f64]);
}

/// A model with one parameter set.
pub struct Alone<'a> {
    model: &'a dyn Model,
    constants: Vec<f64>,
}

impl<'a> Alone<'a> {
    /// The model with these parameter values.
    pub fn new(model: &'a dyn Model, p: &[f64]) -> Self {
        let mut constants = vec![0.0; model.about().constants];
        model.prepare(p, &mut constants);
        Self { model, constants }
    }
}

impl Sets for Alone<'_> {
    const LANES: usize = 1;

    fn derivative(&mut self, x: &[f64], u: &[f64], dx: &mut [f64]) {
        self.model.derivative(&self.constants, x, u, dx);
    }

    fn outputs(&mut self, x: &[f64], u: &[f64], y: &mut [f64]) {
        self.model.outputs(&self.constants, x, u, y);
    }
}

/// A model with as many parameter sets as it computes together. The last set fills unused lanes.
pub struct ModelSets<'a> {
    model: &'a dyn Model,
    constants: Vec<Lanes>,
    /// Inputs, equal in all lanes.
    u: Vec<Lanes>,
}

impl<'a> ModelSets<'a> {
    /// The model with at least one parameter set.
    pub fn new(model: &'a dyn Model, sets: &[Vec<f64>]) -> Self {
        let of_lane = |lane: usize| &sets[lane.min(sets.len() - 1)];
        let p: Vec<Lanes> = (0..model.about().parameters.len())
            .map(|parameter| std::array::from_fn(|lane| of_lane(lane)[parameter]))
            .collect();
        let mut constants = vec![[0.0; LANES]; model.about().constants];
        model.prepare_sets(&p, &mut constants);
        Self {
            model,
            constants,
            u: vec![[0.0; LANES]; model.about().inputs.len()],
        }
    }

    fn set_inputs(&mut self, u: &[f64]) {
        self.u.iter_mut().zip(u).for_each(|(row, &u)| *row = [u; LANES]);
    }
}

impl Sets for ModelSets<'_> {
    const LANES: usize = LANES;

    fn derivative(&mut self, x: &[f64], u: &[f64], dx: &mut [f64]) {
        self.set_inputs(u);
        let (x, dx) = (x.as_chunks().0, dx.as_chunks_mut().0);
        self.model.derivative_sets(&self.constants, x, &self.u, dx);
    }

    fn outputs(&mut self, x: &[f64], u: &[f64], y: &mut [f64]) {
        self.set_inputs(u);
        let (x, y) = (x.as_chunks().0, y.as_chunks_mut().0);
        self.model.outputs_sets(&self.constants, x, &self.u, y);
    }
}

/// Splits rows of interleaved lanes into the rows of each set.
pub fn apart(rows: Vec<Vec<f64>>, sets: usize) -> Vec<Vec<Vec<f64>>> {
    let mut apart = vec![Vec::new(); sets];
    for (place, row) in rows.into_iter().enumerate() {
        if let Some(own) = apart.get_mut(place % LANES) {
            own.push(row);
        }
    }
    apart
}
