//! The residual of thesis section 3.5.2.1, on logarithms: with `ln T = ln|T| + i∠T`, the magnitude error in dB is
//! `20/ln 10` of the real part, and the phase error is the imaginary part.
//!
//! The phase error is the smallest difference of the angles instead of that of unwrapped phases: if unwrapping fails at
//! one noisy line, all lines above it are wrong by a full turn.

use super::observation::Observation;
use super::plan::{ChannelWeight, Weighting};
use crate::least_squares::Problem;
use crate::model::Model;
use crate::response::Response;
use crate::response::logarithm::Logarithms;
use crate::response::parameters::Values;
use crate::response::signal::Term;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{LN_10, PI, TAU};

/// Magnitude error with a residual of 1, dB.
const MAGNITUDE_SCALE: f64 = 3.0;

/// Weight outside the band relative to the weight inside.
const OUTSIDE: f64 = 0.05;

/// The relative random error at which a line starts to fade out.
const FADING: f64 = 0.01;

/// One measured ratio in the cost. Its residuals are the magnitudes of all lines, then the phases.
#[derive(Clone)]
pub(super) struct Target {
    /// Position of its grid.
    pub grid: usize,
    /// Terms of numerator and denominator, by their positions in the grid.
    pub terms: (usize, usize),
    /// Row of its first residual.
    pub first: usize,
    /// Weights of a neper and of a radian, line by line.
    pub weight: (Vec<f64>, Vec<f64>),
    measured: (Vec<f64>, Vec<f64>),
}

impl Target {
    pub fn new(
        observation: &Observation,
        weight: ChannelWeight,
        weighting: Weighting,
        grid: usize,
        terms: (usize, usize),
        first: usize,
    ) -> Self {
        let line = line_weights(observation, weight, weighting);
        let nepers = weight.lambda * 20.0 / LN_10 / MAGNITUDE_SCALE;
        let radians = (1.0 - weight.lambda) / PI;
        Self {
            grid,
            terms,
            first,
            weight: (
                line.iter().map(|w| w * nepers).collect(),
                line.iter().map(|w| w * radians).collect(),
            ),
            measured: observation
                .value
                .iter()
                .map(|value| (value.norm().ln(), value.arg()))
                .unzip(),
        }
    }

    pub fn lines(&self) -> usize {
        self.measured.0.len()
    }

    /// Rows of the magnitudes and of the phases.
    pub fn rows(&self) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        let middle = self.first + self.lines();
        (self.first..middle, middle..middle + self.lines())
    }
}

fn line_weights(observation: &Observation, weight: ChannelWeight, weighting: Weighting) -> Vec<f64> {
    let (from, to) = weight.band.unwrap_or(observation.band);
    let lines = observation.frequency.iter().zip(&observation.relative_variance);
    lines
        .map(|(frequency, variance)| {
            let band = if (from..=to).contains(frequency) { 1.0 } else { OUTSIDE };
            let trust = match weighting {
                Weighting::Thesis => 1.0,
                Weighting::Noise => 1.0 / (1.0 + 0.5 * variance / (FADING * FADING)).sqrt(),
            };
            weight.importance * band * trust
        })
        .collect()
}

/// Targets on the same lines under the same excitation share one evaluation of the model.
pub(super) struct Grid<'m, M: ?Sized> {
    pub response: Response<'m, M>,
    pub logarithms: Logarithms,
}

/// The lines and terms of a grid.
#[derive(Clone)]
pub(super) struct GridPlan {
    pub excitation: usize,
    pub frequency: Vec<f64>,
    pub terms: Vec<Term>,
}

/// The residual of all targets as a function of the free parameters.
pub(super) struct Cost<'m, 's, M: ?Sized> {
    values: Values,
    free: &'s [usize],
    grids: Vec<Grid<'m, M>>,
    targets: &'s [Target],
}

impl<'m, 's, M: Model + ?Sized> Cost<'m, 's, M> {
    pub fn new(model: &'m M, grids: &[GridPlan], targets: &'s [Target], values: &Values, free: &'s [usize]) -> Self {
        let grid = |plan: &GridPlan| {
            let response = Response::new(model, plan.excitation, &plan.frequency);
            let logarithms = Logarithms::new(&response, plan.terms.clone(), values, free);
            Grid { response, logarithms }
        };
        Self {
            values: values.clone(),
            free,
            grids: grids.iter().map(grid).collect(),
            targets,
        }
    }

    /// Residual and Jacobian at given values of the free parameters.
    pub fn at(&mut self, x: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
        let mut residual = DVector::zeros(self.residuals());
        let mut jacobian = DMatrix::zeros(self.residuals(), self.variables());
        self.evaluate(x, residual.as_mut_slice(), jacobian.as_mut_slice());
        (residual, jacobian)
    }
}

impl<M: Model + ?Sized> Problem for Cost<'_, '_, M> {
    fn variables(&self) -> usize {
        self.free.len()
    }

    fn residuals(&self) -> usize {
        self.targets.iter().map(|target| 2 * target.lines()).sum()
    }

    fn evaluate(&mut self, x: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        for (&parameter, &value) in self.free.iter().zip(x) {
            self.values.set(parameter, value);
        }
        for grid in &mut self.grids {
            grid.response.evaluate(self.values.as_slice());
            grid.logarithms.evaluate(&grid.response);
        }
        let rows = residual.len();
        for target in self.targets {
            let logarithms = &self.grids[target.grid].logarithms;
            write_residual(target, logarithms, &mut residual[target.first..]);
            for column in 0..self.free.len() {
                write_slope(
                    target,
                    logarithms,
                    column,
                    &mut jacobian[column * rows + target.first..],
                );
            }
        }
    }
}

fn write_residual(target: &Target, logarithms: &Logarithms, rows: &mut [f64]) {
    let (above, below) = (logarithms.signal(target.terms.0), logarithms.signal(target.terms.1));
    let (magnitude, phase) = rows.split_at_mut(target.lines());
    for (line, to) in magnitude.iter_mut().enumerate() {
        *to = target.weight.0[line] * (above.0[line] - below.0[line] - target.measured.0[line]);
    }
    for (line, to) in phase[..target.lines()].iter_mut().enumerate() {
        *to = target.weight.1[line] * smallest(above.1[line] - below.1[line] - target.measured.1[line]);
    }
}

fn write_slope(target: &Target, logarithms: &Logarithms, column: usize, rows: &mut [f64]) {
    let (above, below) = (
        logarithms.slope(target.terms.0, column),
        logarithms.slope(target.terms.1, column),
    );
    let (magnitude, phase) = rows.split_at_mut(target.lines());
    subtract(magnitude, &target.weight.0, above.0, below.0);
    subtract(&mut phase[..target.lines()], &target.weight.1, above.1, below.1);
}

/// `into = weight (a − b)`, line by line.
fn subtract(into: &mut [f64], weight: &[f64], a: &[f64], b: &[f64]) {
    for (((into, weight), a), b) in into.iter_mut().zip(weight).zip(a).zip(b) {
        *into = weight * (a - b);
    }
}

/// The angle within ±π.
pub(super) fn smallest(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}
