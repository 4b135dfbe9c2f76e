//! `ω dx/dθ = f(x, u)` in Fourier coefficients, and Newton's method for it.

use std::collections::BTreeSet;

use nalgebra::{Complex, DMatrix, DVector, DVectorView, Dyn, U1};

use super::basis::Basis;
use super::factors::Factors;
use super::period::Period;
use crate::model::{About, Matrix, Model};

/// The balance of a model at one drive.
pub struct Balance<'a> {
    model: &'a dyn Model,
    states: &'a [usize],
    /// For each state of the model its place in `states`.
    places: Vec<Option<usize>>,
    basis: &'a Basis,
    omega: f64,
    /// The present point.
    period: Period<'a>,
    /// The factorised Jacobian of the present point.
    factors: Option<Factors>,
}

/// What moves a model beside its states, sampled over a period.
struct Push {
    /// A column for the rate of each state.
    states: DMatrix<f64>,
    /// A column for each output.
    outputs: DMatrix<f64>,
}

impl Push {
    fn none(about: &About, samples: usize) -> Self {
        Push {
            states: DMatrix::zeros(samples, about.states.len()),
            outputs: DMatrix::zeros(samples, about.outputs.len()),
        }
    }
}

/// Newton steps before the search gives up.
const ITERATIONS: usize = 30;
/// A step this small relative to the largest coefficient of its state ends the search.
const SETTLED: f64 = 1e-7;
/// A constant that nothing returns, as the force of a friction that sticks, would make the matrix singular: this share
/// of ω returns it slowly. It bends the way of the search by as little, and not its end.
const RETURN: f64 = 1e-6;
/// Where a whole step leaves less than this share of itself to the next one by the same matrix, that matrix serves once
/// more: to factorise a new one costs as much as tens of residuals.
const STRAIGHT: f64 = 0.2;
/// The shortest share of a Newton step that is tried.
const SHORTEST: f64 = 1e-3;

impl<'a> Balance<'a> {
    pub fn new(
        model: &'a dyn Model,
        p: &[f64],
        states: &'a [usize],
        basis: &'a Basis,
        omega: f64,
        inputs: DMatrix<f64>,
    ) -> Self {
        let place = |state| states.iter().position(|&s| s == state);
        Self {
            model,
            states,
            places: (0..model.about().states.len()).map(place).collect(),
            basis,
            omega,
            period: Period::new(model, p, inputs),
            factors: None,
        }
    }

    /// Searches from `start`: the coefficients, and whether they settled.
    ///
    /// A step is shortened until the next one, with the same matrix, would be shorter (P. Deuflhard, "Newton Methods
    /// for Nonlinear Problems", section 3.3): it needs no scale of the residuals, whose units differ.
    pub fn solve(&mut self, start: &[f64]) -> (Vec<f64>, bool) {
        let mut x = DVector::from_column_slice(start);
        let mut residual = self.residual(&x);
        let mut kept = None;
        for _ in 0..ITERATIONS {
            let factors = kept.take().or_else(|| self.factorise());
            let step = factors.as_ref().and_then(|factors| factors.solve(&residual));
            let (Some(factors), Some(step)) = (factors, step) else {
                return (x.as_slice().to_vec(), false);
            };
            let (mut share, length) = (1.0_f64, self.length(&step, &(&x - &step)));
            // At a kink of a law no step may be monotonic: the best of those tried is better than none.
            let mut best: Option<(f64, f64, _)> = None;
            let mut is_monotonic = false;
            while !is_monotonic && share >= SHORTEST {
                let trial = &x - &step * share;
                let trial_residual = self.residual(&trial);
                let next = factors.solve(&trial_residual).map(|next| self.length(&next, &trial));
                if let Some(next) = next.filter(|next| next.is_finite()) {
                    is_monotonic = next <= (1.0 - 0.25 * share) * length;
                    if is_monotonic || best.as_ref().is_none_or(|(least, ..)| next < *least) {
                        best = Some((next, share, (trial, trial_residual)));
                    }
                }
                share *= 0.5;
            }
            let Some((next, share, point)) = best else {
                return (x.as_slice().to_vec(), length < SETTLED.sqrt());
            };
            (x, residual) = point;
            if next < SETTLED {
                return (x.as_slice().to_vec(), true);
            }
            let is_straight = is_monotonic && share == 1.0 && next < STRAIGHT * length;
            kept = is_straight.then_some(factors);
        }
        (x.as_slice().to_vec(), false)
    }

    /// Takes a point as the present one.
    pub fn sample(&mut self, x: &[f64]) {
        self.residual(&DVector::from_column_slice(x));
    }

    /// Makes the present point ready for derivatives.
    pub fn linearise(&mut self) {
        self.factors = self.factorise();
        self.period.differentiate();
    }

    /// Harmonics of some outputs at the present point.
    pub fn outputs(&self, outputs: &[usize]) -> Vec<Vec<Complex<f64>>> {
        self.harmonics(&self.period.outputs().select_columns(outputs))
    }

    /// How the harmonics of some outputs move along a group of parameters; a state that cannot be told of stays.
    pub fn slopes_along(&self, outputs: &[usize], group: &[usize]) -> Vec<Vec<Complex<f64>>> {
        let mut push = Push::none(self.model.about(), self.basis.samples());
        let entries = self.model.about().parameter_jacobian.iter().enumerate();
        for (entry, (is_output, row, _)) in entries.filter(|(_, e)| group.contains(&usize::from(e.2))) {
            let side = if *is_output {
                &mut push.outputs
            } else {
                &mut push.states
            };
            let mut samples = side.column_mut(usize::from(*row));
            samples += self.period.by_parameter.column(entry);
        }
        self.output_slopes(outputs, push)
    }

    /// The same along the logarithm of the amplitude of the drive.
    pub fn slopes_louder(&self, outputs: &[usize]) -> Vec<Vec<Complex<f64>>> {
        let mut push = Push::none(self.model.about(), self.basis.samples());
        for (entry, at) in self.model.about().matrices.iter().enumerate() {
            let side = match at.matrix {
                Matrix::A | Matrix::C => continue,
                Matrix::B => &mut push.states,
                Matrix::D => &mut push.outputs,
            };
            let mut samples = side.column_mut(usize::from(at.row));
            let (by, input) = (self.period.matrices.column(entry), usize::from(at.column));
            samples.cmpy(1.0, &by, &self.period.inputs.column(input), 1.0);
        }
        self.output_slopes(outputs, push)
    }

    /// The same along whatever pushes states and outputs so.
    fn output_slopes(&self, outputs: &[usize], push: Push) -> Vec<Vec<Complex<f64>>> {
        let moves = self.synthesis(&self.slope(&push.states));
        let mut samples = push.outputs;
        for (entry, at) in self.model.about().matrices.iter().enumerate() {
            if let (Matrix::C, Some(place)) = (at.matrix, self.places[usize::from(at.column)]) {
                let mut samples = samples.column_mut(usize::from(at.row));
                samples.cmpy(1.0, &self.period.matrices.column(entry), &moves.column(place), 1.0);
            }
        }
        self.harmonics(&samples.select_columns(outputs))
    }

    /// How the coefficients of the present point move under a push on the states; zero where they cannot be told.
    fn slope(&self, push: &DMatrix<f64>) -> DVector<f64> {
        let push = self.analysis(push);
        let solved = self.factors.as_ref().and_then(|factors| factors.solve(&push));
        solved.unwrap_or_else(|| DVector::zeros(push.len()))
    }

    /// Harmonics of samples, a column for each series.
    fn harmonics(&self, samples: &DMatrix<f64>) -> Vec<Vec<Complex<f64>>> {
        let coefficients = &self.basis.analysis * samples;
        let of = coefficients.column_iter();
        of.map(|column| self.basis.harmonics(column.as_slice())).collect()
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

    /// `ω dx/dθ - f` in coefficients, and the samples of the point as the present ones.
    fn residual(&mut self, x: &DVector<f64>) -> DVector<f64> {
        let series = self.synthesis(x);
        self.period.move_to(self.states, &series);
        let forced = self.analysis(&self.period.rates);
        let terms = self.basis.terms();
        DVector::from_fn(x.len(), |row, _| {
            let turned = self.basis.derivative(row % terms);
            let turned = turned.map(|(partner, factor)| factor * x[row / terms * terms + partner]);
            self.omega * turned.unwrap_or(0.0) - forced[row]
        })
    }

    /// The factors of the Jacobian of [`Self::residual`] at the present point; `None` where it has none.
    fn factorise(&mut self) -> Option<Factors> {
        self.period.linearise();
        let mut constant = DMatrix::zeros(self.states.len(), self.states.len());
        let mut bent = BTreeSet::new();
        for (row, column, weights) in self.entries() {
            if weights.iter().all(|&weight| weight == weights[0]) {
                constant[(row, column)] = weights[0];
            } else {
                bent.insert(row);
            }
        }
        let bent: Vec<usize> = bent.into_iter().collect();
        let turn = |harmonic| match harmonic {
            0 => Complex::from(self.omega * RETURN),
            _ => Complex::new(0.0, self.omega * harmonic as f64),
        };
        let turns: Vec<Complex<f64>> = (0..=self.basis.terms() / 2).map(turn).collect();
        Factors::new(&constant, &turns, &bent, &self.jacobian(&bent))
    }

    /// The entries of A between states that move: their places and samples.
    fn entries(&self) -> impl Iterator<Item = (usize, usize, DVectorView<'_, f64>)> {
        let entries = self.model.about().matrices.iter().enumerate();
        entries
            .filter(|(_, at)| at.matrix == Matrix::A)
            .filter_map(|(entry, at)| {
                let place = |state: u16| self.places[usize::from(state)];
                Some((place(at.row)?, place(at.column)?, self.period.matrices.column(entry)))
            })
    }

    /// The rows that some states have in the Jacobian.
    fn jacobian(&self, of: &[usize]) -> DMatrix<f64> {
        let terms = self.basis.terms();
        let mut jacobian = DMatrix::zeros(of.len() * terms, self.states.len() * terms);
        for (place, &state) in of.iter().enumerate() {
            let mut own = jacobian.view_mut((place * terms, state * terms), (terms, terms));
            for term in 0..terms {
                let (partner, factor) = self.basis.derivative(term).unwrap_or((term, RETURN));
                own[(term, partner)] = self.omega * factor;
            }
        }
        for (row, column, weights) in self.entries() {
            let Some(place) = of.iter().position(|&state| state == row) else {
                continue;
            };
            let mut block = jacobian.view_mut((place * terms, column * terms), (terms, terms));
            if weights.iter().all(|&weight| weight == weights[0]) {
                (0..terms).for_each(|term| block[(term, term)] -= weights[0]);
            } else {
                block -= self.basis.product(&weights);
            }
        }
        jacobian
    }

    /// The largest of the states' steps, each relative to the largest coefficient of its state.
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
