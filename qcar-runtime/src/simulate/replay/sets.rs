//! A model with one set of parameters, or with several that are computed at once.

use crate::model::{LANES, Lanes, Model};

/// A model with its parameters. States and outputs are rows of a value for each set.
pub trait Sets {
    /// How many sets there are.
    const LANES: usize;

    /// The rates of the states, where all sets have the same inputs.
    fn derivative(&mut self, x: &[f64], u: &[f64], dx: &mut [f64]);

    /// The outputs.
    fn outputs(&mut self, x: &[f64], u: &[f64], y: &mut [f64]);
}

/// One set.
pub struct Alone<'a> {
    model: &'a dyn Model,
    constants: Vec<f64>,
}

impl<'a> Alone<'a> {
    /// Of these values of the parameters.
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

/// As many sets as a model takes at once. Where there are fewer, the last one fills the other lanes.
pub struct Several<'a> {
    model: &'a dyn Model,
    constants: Vec<Lanes>,
    /// The inputs, for each set the same.
    u: Vec<Lanes>,
}

impl<'a> Several<'a> {
    /// Of these sets, at least one.
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

impl Sets for Several<'_> {
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

/// The rows of a number of sets, set by set.
pub fn apart(rows: Vec<Vec<f64>>, sets: usize) -> Vec<Vec<Vec<f64>>> {
    let mut apart = vec![Vec::new(); sets];
    for (place, row) in rows.into_iter().enumerate() {
        if let Some(own) = apart.get_mut(place % LANES) {
            own.push(row);
        }
    }
    apart
}
