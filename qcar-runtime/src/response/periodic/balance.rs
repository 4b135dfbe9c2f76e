//! `ω dx/dθ = f(x, u)` in Fourier coefficients, and Newton's method for it.

use nalgebra::{Complex, DMatrix, DVector};

use super::basis::Basis;
use super::factors::{Factors, Integral};
use crate::model::{Matrix, Model, StateKind};

/// The balance of a model at one drive.
pub struct Balance<'a> {
    model: &'a dyn Model,
    p: Vec<f64>,
    constants: Vec<f64>,
    states: &'a [usize],
    /// For each state of the model its place in `states`.
    places: Vec<Option<usize>>,
    basis: &'a Basis,
    omega: f64,
    /// The inputs at each sample.
    inputs: Vec<Vec<f64>>,
    /// The states at each sample of the present point.
    samples: Vec<Vec<f64>>,
    /// The nonzeros of A, B, C and D at each sample of the present point.
    matrices: Vec<Vec<f64>>,
    /// The nonzeros of ∂f/∂p and ∂h/∂p there.
    by_parameter: Vec<Vec<f64>>,
    /// The factorised Jacobian of the present point.
    factors: Option<Factors>,
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
        inputs: Vec<Vec<f64>>,
    ) -> Self {
        let about = model.about();
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        let place = |state| states.iter().position(|&s| s == state);
        Self {
            model,
            p: p.to_vec(),
            constants,
            states,
            places: (0..about.states.len()).map(place).collect(),
            basis,
            omega,
            inputs,
            samples: Vec::new(),
            matrices: Vec::new(),
            by_parameter: Vec::new(),
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
            let factors = kept.take().unwrap_or_else(|| self.factorise());
            let Some(step) = factors.solve(&residual) else {
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
                self.residual(&x);
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
        self.factors = Some(self.factorise());
        let points = self.samples.iter().zip(&self.inputs);
        let by_parameter = points.map(|(x, u)| {
            let mut nonzeros = vec![0.0; self.model.about().parameter_jacobian.len()];
            self.model.parameter_jacobian(&self.p, x, u, &mut nonzeros);
            nonzeros
        });
        self.by_parameter = by_parameter.collect();
    }

    /// Harmonics of some outputs at the present point.
    pub fn outputs(&self, outputs: &[usize]) -> Vec<Vec<Complex<f64>>> {
        let mut y = vec![0.0; self.model.about().outputs.len()];
        let mut samples = DMatrix::zeros(self.inputs.len(), outputs.len());
        for (k, (x, u)) in self.samples.iter().zip(&self.inputs).enumerate() {
            self.model.outputs(&self.constants, x, u, &mut y);
            let row = outputs.iter().enumerate();
            row.for_each(|(column, &output)| samples[(k, column)] = y[output]);
        }
        self.harmonics(&samples)
    }

    /// How the harmonics of some outputs move along a group of parameters; a state that cannot be told of stays.
    pub fn slopes_along(&self, outputs: &[usize], group: &[usize]) -> Vec<Vec<Complex<f64>>> {
        let pushes = self.by_parameter(group, false, |row| self.places[row]);
        self.output_slopes(outputs, pushes, |output| {
            self.by_parameter(group, true, |row| (row == output).then_some(0))
        })
    }

    /// The same along the logarithm of the amplitude of the drive.
    pub fn slopes_louder(&self, outputs: &[usize]) -> Vec<Vec<Complex<f64>>> {
        let pushes = self.by_input(Matrix::B, |row| self.places[row]);
        self.output_slopes(outputs, pushes, |output| {
            self.by_input(Matrix::D, |row| (row == output).then_some(0))
        })
    }

    /// The same along whatever pushes the states so, and each output so `directly`: places with samples.
    fn output_slopes(
        &self,
        outputs: &[usize],
        pushes: Vec<(usize, DVector<f64>)>,
        directly: impl Fn(usize) -> Vec<(usize, DVector<f64>)>,
    ) -> Vec<Vec<Complex<f64>>> {
        let moves = self.synthesis(&self.slope(pushes));
        let mut samples = DMatrix::zeros(self.inputs.len(), outputs.len());
        for (column, &output) in outputs.iter().enumerate() {
            let mut samples = samples.column_mut(column);
            for (_, direct) in directly(output) {
                samples += direct;
            }
            let entries = self.model.about().matrices.iter().enumerate();
            for (entry, at) in entries.filter(|(_, e)| e.matrix == Matrix::C && usize::from(e.row) == output) {
                let Some(place) = self.places[usize::from(at.column)] else {
                    continue;
                };
                for k in 0..samples.len() {
                    samples[k] += self.matrices[k][entry] * moves[(k, place)];
                }
            }
        }
        self.harmonics(&samples)
    }

    /// How the coefficients of the present point move under pushes on the states; zero where they cannot be told.
    fn slope(&self, pushes: Vec<(usize, DVector<f64>)>) -> DVector<f64> {
        let (terms, unknowns) = (self.basis.terms(), self.states.len() * self.basis.terms());
        let mut push = DVector::zeros(unknowns);
        for (place, samples) in pushes {
            let mut block = push.rows_mut(place * terms, terms);
            block += &self.basis.analysis * samples;
        }
        let solved = self.factors.as_ref().and_then(|factors| factors.solve(&push));
        solved.unwrap_or_else(|| DVector::zeros(unknowns))
    }

    /// Harmonics of samples, a column for each series.
    fn harmonics(&self, samples: &DMatrix<f64>) -> Vec<Vec<Complex<f64>>> {
        let coefficients = &self.basis.analysis * samples;
        let of = coefficients.column_iter();
        of.map(|column| self.basis.harmonics(column.as_slice())).collect()
    }

    /// Samples of ∂f/∂p (or ∂h/∂p) along a group, by what `place` makes of a row.
    fn by_parameter(
        &self,
        group: &[usize],
        of_outputs: bool,
        place: impl Fn(usize) -> Option<usize>,
    ) -> Vec<(usize, DVector<f64>)> {
        let entries = self.model.about().parameter_jacobian.iter().enumerate();
        let along = entries.filter(|(_, (is_output, _, parameter))| {
            *is_output == of_outputs && group.contains(&usize::from(*parameter))
        });
        let samples =
            |entry: usize| DVector::from_iterator(self.inputs.len(), self.by_parameter.iter().map(|at| at[entry]));
        along
            .filter_map(|(entry, (_, row, _))| Some((place(usize::from(*row))?, samples(entry))))
            .collect()
    }

    /// Samples of what the inputs do through the nonzeros of a matrix, by what `place` makes of a row.
    fn by_input(&self, matrix: Matrix, place: impl Fn(usize) -> Option<usize>) -> Vec<(usize, DVector<f64>)> {
        let entries = self.model.about().matrices.iter().enumerate();
        let along = entries.filter(|(_, at)| at.matrix == matrix);
        let samples = |entry: usize, input: usize| {
            let products = self
                .matrices
                .iter()
                .zip(&self.inputs)
                .map(|(nonzeros, u)| nonzeros[entry] * u[input]);
            DVector::from_iterator(self.inputs.len(), products)
        };
        along
            .filter_map(|(entry, at)| Some((place(usize::from(at.row))?, samples(entry, usize::from(at.column)))))
            .collect()
    }

    /// Samples of all series, a column for each state.
    fn synthesis(&self, x: &DVector<f64>) -> DMatrix<f64> {
        &self.basis.synthesis * DMatrix::from_column_slice(self.basis.terms(), self.states.len(), x.as_slice())
    }

    /// `ω dx/dθ - f` in coefficients, and the samples of the point as the present ones.
    fn residual(&mut self, x: &DVector<f64>) -> DVector<f64> {
        let series = self.synthesis(x);
        let (terms, count) = (self.basis.terms(), self.model.about().states.len());
        let mut rates = DMatrix::zeros(self.inputs.len(), self.states.len());
        let mut dx = vec![0.0; count];
        self.samples.resize(self.inputs.len(), vec![0.0; count]);
        for k in 0..self.inputs.len() {
            for (place, &state) in self.states.iter().enumerate() {
                self.samples[k][state] = series[(k, place)];
            }
            self.model
                .derivative(&self.constants, &self.samples[k], &self.inputs[k], &mut dx);
            self.states
                .iter()
                .enumerate()
                .for_each(|(place, &state)| rates[(k, place)] = dx[state]);
        }
        let forced = &self.basis.analysis * rates;
        DVector::from_fn(x.len(), |row, _| {
            let (place, term) = (row / terms, row % terms);
            let turned = self
                .basis
                .derivative(term)
                .map(|(partner, factor)| -factor * x[place * terms + partner]);
            -self.omega * turned.unwrap_or(0.0) - forced[(term, place)]
        })
    }

    /// The factors of the Jacobian at the present point.
    fn factorise(&mut self) -> Factors {
        let jacobian = self.jacobian();
        let inverse = |term| match self.basis.derivative(term) {
            Some((partner, factor)) => (partner, 1.0 / (self.omega * factor)),
            None => (term, 1.0 / (self.omega * RETURN)),
        };
        let moves = (0..self.basis.terms()).map(inverse).collect();
        Factors::new(jacobian, self.integrals(), moves)
    }

    /// The positions whose rate is a velocity and nothing else.
    fn integrals(&self) -> Vec<Integral> {
        let about = self.model.about();
        let integral = |(place, &state): (usize, &usize)| {
            let is_of_it = |entry: &usize| {
                about.matrices[*entry].matrix == Matrix::A && usize::from(about.matrices[*entry].row) == state
            };
            let mut entries = (0..about.matrices.len()).filter(is_of_it);
            let entry = entries.next()?;
            let of = usize::from(about.matrices[entry].column);
            let is_rate = about.states[state].kind == StateKind::Position
                && about.states[of].kind == StateKind::Velocity
                && entries.next().is_none()
                && self.matrices.iter().all(|at| at[entry] == 1.0);
            let velocity = self.places[of].filter(|_| is_rate)?;
            Some(Integral {
                position: place,
                velocity,
            })
        };
        self.states.iter().enumerate().filter_map(integral).collect()
    }

    /// The Jacobian of [`Self::residual`] at the present point.
    fn jacobian(&mut self) -> DMatrix<f64> {
        let terms = self.basis.terms();
        let unknowns = self.states.len() * terms;
        let mut jacobian = DMatrix::zeros(unknowns, unknowns);
        for row in 0..unknowns {
            match self.basis.derivative(row % terms) {
                Some((partner, factor)) => jacobian[(row, row / terms * terms + partner)] = self.omega * factor,
                None => jacobian[(row, row)] = self.omega * RETURN,
            }
        }
        let count = self.model.about().matrices.len();
        self.matrices.resize(self.inputs.len(), vec![0.0; count]);
        for ((x, u), nonzeros) in self.samples.iter().zip(&self.inputs).zip(&mut self.matrices) {
            self.model.matrices(&self.p, x, u, nonzeros);
        }
        for (entry, at) in self
            .model
            .about()
            .matrices
            .iter()
            .enumerate()
            .filter(|(_, e)| e.matrix == Matrix::A)
        {
            let places = (self.places[usize::from(at.row)], self.places[usize::from(at.column)]);
            let (Some(row), Some(column)) = places else { continue };
            let mut block = jacobian.view_mut((row * terms, column * terms), (terms, terms));
            let first = self.matrices[0][entry];
            if self.matrices.iter().all(|at| at[entry] == first) {
                (0..terms).for_each(|term| block[(term, term)] -= first);
                continue;
            }
            let mut weighted = self.basis.synthesis.clone();
            weighted
                .row_iter_mut()
                .zip(&self.matrices)
                .for_each(|(mut row, at)| row *= at[entry]);
            block -= &self.basis.analysis * weighted;
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
