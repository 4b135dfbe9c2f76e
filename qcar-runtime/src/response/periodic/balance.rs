//! `ω dx/dθ = f(x, u)` in Fourier coefficients, and Newton's method for it.

use std::collections::BTreeSet;
use std::rc::Rc;

use nalgebra::{Complex, DMatrix, DVector, DVectorView, Dyn, U1};

use super::basis::Basis;
use super::factors::{Factors, LinearStates};
use super::period::Period;
use super::product::{add, product};
use crate::model::{Entry, Matrix, Model};

/// The balance of a model, at one drive after another.
pub struct Balance<'a> {
    model: &'a dyn Model,
    states: &'a [usize],
    /// For each state of the model, its position in `states`.
    places: Vec<Option<usize>>,
    basis: &'a Basis,
    omega: f64,
    /// Coefficients of the present point; empty before the first drive.
    at: Vec<f64>,
    /// Samples of the present point.
    period: Period<'a>,
    /// The linear states at the last point whose Jacobian was factorised.
    linear_states: Option<Rc<LinearStates>>,
}

/// What a search has found.
pub struct Found {
    pub coefficients: Vec<f64>,
    pub converged: bool,
    /// True if every Newton step was a full one that shortened the next.
    pub is_direct: bool,
}

/// Largest number of Newton steps.
const ITERATIONS: usize = 30;
/// A step this small relative to the largest coefficient of its state ends the search.
const SETTLED: f64 = 1e-7;
/// A constant part without a restoring term, such as the force of sticking friction, would make the matrix singular. A
/// restoring rate of this fraction of ω is added. It changes the path of the search slightly, but not its result.
const RESTORING: f64 = 1e-6;
/// A matrix is used again if the next step with it is shorter than this fraction of the last full step: a new
/// factorisation costs as much as tens of residuals.
const REUSE: f64 = 0.2;
/// Smallest fraction of a Newton step that is tried.
const SHORTEST: f64 = 1e-3;

impl<'a> Balance<'a> {
    /// A balance without a drive.
    pub fn new(model: &'a dyn Model, p: &[f64], states: &'a [usize], basis: &'a Basis) -> Self {
        let place = |state| states.iter().position(|&s| s == state);
        Self {
            model,
            states,
            places: (0..model.about().states.len()).map(place).collect(),
            basis,
            omega: 0.0,
            at: Vec::new(),
            period: Period::new(model, p, basis.samples()),
            linear_states: None,
        }
    }

    /// Sets the drive: its angular frequency (rad/s) and a row of inputs for each sample.
    pub fn drive(&mut self, omega: f64, inputs: DMatrix<f64>) {
        self.omega = omega;
        self.period.inputs = inputs;
        self.at.clear();
        self.linear_states = None;
    }

    /// Searches from `start`.
    ///
    /// A step is shortened until the next one, with the same matrix, would be shorter (P. Deuflhard, "Newton Methods
    /// for Nonlinear Problems", section 3.3): it needs no scale of the residuals, whose units differ.
    pub fn solve(&mut self, start: &[f64]) -> Found {
        let mut x = DVector::from_column_slice(start);
        let mut is_direct = true;
        let found = |x: &DVector<f64>, converged: bool, is_direct: bool| Found {
            coefficients: x.as_slice().to_vec(),
            converged,
            is_direct,
        };
        let mut residual = self.residual(&x);
        let mut kept = None;
        for _ in 0..ITERATIONS {
            let Some((factors, step)) = kept.take().or_else(|| self.newton(&residual)) else {
                return found(&x, false, is_direct);
            };
            let (mut share, length) = (1.0_f64, self.length(&step, &(&x - &step)));
            // At a kink of a law, no step may be monotonic; the best of the tried steps is used.
            let mut best: Option<(f64, f64, _)> = None;
            let mut is_monotonic = false;
            while !is_monotonic && share >= SHORTEST {
                let trial = &x - &step * share;
                let trial_residual = self.residual(&trial);
                let next = factors
                    .solve(&trial_residual)
                    .map(|step| (self.length(&step, &trial), step));
                if let Some((next, step)) = next.filter(|(next, _)| next.is_finite()) {
                    is_monotonic = next <= (1.0 - 0.25 * share) * length;
                    if is_monotonic || best.as_ref().is_none_or(|(least, ..)| next < *least) {
                        best = Some((next, share, (trial, trial_residual, step)));
                    }
                }
                share *= 0.5;
            }
            let Some((next, share, (trial, trial_residual, step))) = best else {
                return found(&x, length < SETTLED.sqrt(), is_direct);
            };
            (x, residual) = (trial, trial_residual);
            is_direct &= is_monotonic && share == 1.0;
            if next < SETTLED {
                return found(&x, true, is_direct);
            }
            let can_reuse = is_monotonic && share == 1.0 && next < REUSE * length;
            kept = can_reuse.then_some((factors, step));
        }
        found(&x, false, is_direct)
    }

    /// The factors at the present point, and the step by them.
    fn newton(&mut self, residual: &DVector<f64>) -> Option<(Factors, DVector<f64>)> {
        let factors = self.factorise()?;
        let step = factors.solve(residual)?;
        Some((factors, step))
    }

    /// Makes a point the present one.
    pub fn sample(&mut self, x: &[f64]) {
        if self.at != x {
            self.residual(&DVector::from_column_slice(x));
        }
    }

    /// Coefficients of some outputs at the present point, output by output.
    pub fn outputs(&self, outputs: &[usize]) -> DMatrix<f64> {
        product(&self.basis.analysis, &self.period.outputs().select_columns(outputs))
    }

    /// Derivatives of the coefficients of some outputs: a column for each group of parameters, and a last one for the
    /// logarithm of the amplitude of the drive. Undetermined states have zero derivatives.
    pub fn slopes(&mut self, outputs: &[usize], groups: &[Vec<usize>]) -> DMatrix<f64> {
        let factors = self.factorise();
        self.period.differentiate();
        let (pushes, mut moves) = self.pushes(outputs, groups);
        if let Some(moved) = factors.and_then(|factors| factors.solve_all(&pushes)) {
            self.show(&moved, outputs, &mut moves);
        }
        moves
    }

    /// Direct effect of each direction of [`Self::slopes`] on the moving states and on the outputs: a column for each
    /// direction.
    fn pushes(&self, outputs: &[usize], groups: &[Vec<usize>]) -> (DMatrix<f64>, DMatrix<f64>) {
        let terms = self.basis.terms();
        let none = |rows: usize| DMatrix::zeros(rows * terms, groups.len() + 1);
        let (mut on_states, mut on_outputs) = (none(self.states.len()), none(outputs.len()));
        let (pushes, samples) = self.sampled_pushes(outputs, groups);
        let coefficients = product(&self.basis.analysis, &samples);
        for (push, by) in pushes.iter().zip(coefficients.column_iter()) {
            let side = if push.on_output {
                &mut on_outputs
            } else {
                &mut on_states
            };
            let mut pushed = side.view_mut((push.place * terms, push.along), (terms, 1));
            pushed += by;
        }
        (on_states, on_outputs)
    }

    /// The same, term by term, with the samples of each term.
    fn sampled_pushes(&self, outputs: &[usize], groups: &[Vec<usize>]) -> (Vec<Push>, DMatrix<f64>) {
        let (mut pushes, mut samples) = (Vec::new(), Vec::new());
        let place = |on_output: bool, row: u16| match on_output {
            true => outputs.iter().position(|&output| output == usize::from(row)),
            false => self.places[usize::from(row)],
        };
        let by_parameter = self.period.by_parameter.column_iter();
        for (&(on_output, row, parameter), by) in self.model.about().parameter_jacobian.iter().zip(by_parameter) {
            let Some(place) = place(on_output, row) else { continue };
            for along in (0..groups.len()).filter(|&along| groups[along].contains(&usize::from(parameter))) {
                samples.extend_from_slice(by.as_slice());
                pushes.push(Push {
                    on_output,
                    place,
                    along,
                });
            }
        }
        for (at, by) in self.entries(Matrix::B).chain(self.entries(Matrix::D)) {
            let (on_output, along) = (at.matrix == Matrix::D, groups.len());
            let Some(place) = place(on_output, at.row) else {
                continue;
            };
            let input = self.period.inputs.column(usize::from(at.column));
            samples.extend(by.as_slice().iter().zip(input.as_slice()).map(|(by, input)| by * input));
            pushes.push(Push {
                on_output,
                place,
                along,
            });
        }
        let samples = DMatrix::from_vec(self.basis.samples(), pushes.len(), samples);
        (pushes, samples)
    }

    /// Adds the effect of motions of the states on some outputs.
    fn show(&self, moved: &DMatrix<f64>, outputs: &[usize], shown: &mut DMatrix<f64>) {
        let terms = self.basis.terms();
        for (at, weights) in self.entries(Matrix::C) {
            let output = outputs.iter().position(|&output| output == usize::from(at.row));
            let (Some(row), Some(column)) = (output, self.places[usize::from(at.column)]) else {
                continue;
            };
            let weight = held(&weights).ok_or_else(|| self.basis.weighted(&weights));
            for (mut shown, moved) in shown.column_iter_mut().zip(moved.column_iter()) {
                let shown = &mut shown.as_mut_slice()[row * terms..][..terms];
                let moved = &moved.as_slice()[column * terms..][..terms];
                match &weight {
                    Ok(weight) => add(moved, &[*weight], shown),
                    Err(weights) => add(weights.as_slice(), moved, shown),
                }
            }
        }
    }

    /// Samples of all series, a column for each state.
    fn synthesis(&self, x: &DVector<f64>) -> DMatrix<f64> {
        &self.basis.synthesis * DMatrix::from_column_slice(self.basis.terms(), self.states.len(), x.as_slice())
    }

    /// Coefficients of the states that move, from samples of all.
    fn analysis(&self, samples: &DMatrix<f64>) -> DVector<f64> {
        let coefficients = &self.basis.analysis * samples.select_columns(self.states);
        coefficients.reshape_generic(Dyn(self.states.len() * self.basis.terms()), U1)
    }

    /// `ω dx/dθ - f` in coefficients. The point becomes the present one.
    fn residual(&mut self, x: &DVector<f64>) -> DVector<f64> {
        let series = self.synthesis(x);
        self.period.move_to(self.states, &series);
        x.as_slice().clone_into(&mut self.at);
        let forced = self.analysis(&self.period.rates);
        let terms = self.basis.terms();
        DVector::from_fn(x.len(), |row, _| {
            let turned = self.basis.derivative(row % terms);
            let turned = turned.map(|(partner, factor)| factor * x[row / terms * terms + partner]);
            self.omega * turned.unwrap_or(0.0) - forced[row]
        })
    }

    /// The factorised Jacobian of [`Self::residual`] at the present point; `None` if it is singular.
    fn factorise(&mut self) -> Option<Factors> {
        self.period.linearise();
        let mut constant = DMatrix::zeros(self.states.len(), self.states.len());
        let mut nonlinear = BTreeSet::new();
        for (at, weights) in self.entries(Matrix::A) {
            let place = |state: u16| self.places[usize::from(state)];
            if let (Some(row), Some(column)) = (place(at.row), place(at.column)) {
                match held(&weights) {
                    Some(weight) => constant[(row, column)] = weight,
                    None => _ = nonlinear.insert(row),
                }
            }
        }
        let others: Vec<usize> = (0..self.states.len())
            .filter(|place| !nonlinear.contains(place))
            .collect();
        let nonlinear: Vec<usize> = nonlinear.into_iter().collect();
        let linear_states = self.linear_states(constant.select_rows(&others), &nonlinear)?;
        Some(Factors::new(linear_states, &self.jacobian(&nonlinear)))
    }

    /// The linear states, whose rows of A are `constant`; those in `nonlinear` are nonlinear. The factors of the last
    /// point are reused if they are the same.
    fn linear_states(&mut self, constant: DMatrix<f64>, nonlinear: &[usize]) -> Option<Rc<LinearStates>> {
        if !self
            .linear_states
            .as_ref()
            .is_some_and(|last| last.is_of(&constant, nonlinear))
        {
            let turn = |harmonic| match harmonic {
                0 => Complex::from(self.omega * RESTORING),
                _ => Complex::new(0.0, self.omega * harmonic as f64),
            };
            let turns: Vec<Complex<f64>> = (0..=self.basis.terms() / 2).map(turn).collect();
            self.linear_states = LinearStates::new(constant, &turns, nonlinear.to_vec()).map(Rc::new);
        }
        self.linear_states.clone()
    }

    /// The rows of some moving states in the Jacobian.
    fn jacobian(&self, of: &[usize]) -> DMatrix<f64> {
        let terms = self.basis.terms();
        let states: Vec<usize> = of.iter().map(|&place| self.states[place]).collect();
        let mut jacobian = -self.rows(&states);
        for (row, &state) in of.iter().enumerate() {
            let mut own = jacobian.view_mut((row * terms, state * terms), (terms, terms));
            for term in 0..terms {
                let (partner, factor) = self.basis.derivative(term).unwrap_or((term, RESTORING));
                own[(term, partner)] += self.omega * factor;
            }
        }
        jacobian
    }

    /// The nonzeros of a matrix, each with its samples.
    fn entries(&self, of: Matrix) -> impl Iterator<Item = (&Entry, DVectorView<'_, f64>)> {
        let entries = self.model.about().matrices.iter();
        entries
            .zip(self.period.matrices.column_iter())
            .filter(move |(at, _)| at.matrix == of)
    }

    /// Effect of the moving states on some rows of A, term by term.
    fn rows(&self, rows: &[usize]) -> DMatrix<f64> {
        let terms = self.basis.terms();
        let mut found = DMatrix::zeros(rows.len() * terms, self.states.len() * terms);
        for (at, weights) in self.entries(Matrix::A) {
            let row = rows.iter().position(|&row| row == usize::from(at.row));
            let (Some(row), Some(column)) = (row, self.places[usize::from(at.column)]) else {
                continue;
            };
            let mut block = found.view_mut((row * terms, column * terms), (terms, terms));
            match held(&weights) {
                Some(weight) => block.fill_diagonal(weight),
                None => block.copy_from(&self.basis.weighted(&weights)),
            }
        }
        found
    }

    /// The largest step of a state, relative to the largest coefficient of that state.
    fn length(&self, step: &DVector<f64>, x: &DVector<f64>) -> f64 {
        let terms = self.basis.terms();
        let lengths = (0..self.states.len()).map(|place| {
            let (step, x) = (step.rows(place * terms, terms), x.rows(place * terms, terms));
            step.amax() / x.amax().max(f64::MIN_POSITIVE)
        });
        lengths.fold(0.0, |longest, length| {
            if length > longest || length.is_nan() {
                length
            } else {
                longest
            }
        })
    }
}

/// A term of the direct effect on a state or an output.
struct Push {
    on_output: bool,
    /// Position among the moving states, or among the requested outputs.
    place: usize,
    /// The direction to which it belongs.
    along: usize,
}

/// The common value of all samples; `None` if they differ.
fn held(samples: &DVectorView<f64>) -> Option<f64> {
    let first = samples[0];
    // Without an early exit, several samples are compared at once.
    let is_held = samples
        .as_slice()
        .iter()
        .fold(true, |held, &sample| held & (sample == first));
    is_held.then_some(first)
}
