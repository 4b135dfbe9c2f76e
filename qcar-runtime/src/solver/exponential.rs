//! An exponential Adams method for linear systems under forces, with steps of one length and its doubles.
//!
//! In `dx/dt = A x + B f(t, x)` the linear part is integrated exactly, however fast it decays or vibrates. The forces
//! are extrapolated by the polynomial through their past values. One evaluation at the end of a step gives the error of
//! this prediction, which corrects the step and estimates its error. M. Hochbruck, A. Ostermann, "Exponential
//! integrators", Acta Numerica 19 (2010), section 2.5, with the correction of the predictor-corrector pairs in Hairer,
//! Nørsett, Wanner, III.1.

// The matrix of a step.
mod propagator;
// Several systems integrated together.
mod abreast;

use std::array;

pub use abreast::ExponentialAbreast;

use super::matrix::Matrix;
use super::polynomial::{EXTRAPOLATION, LAST_ORDER, PAST, PREDICTION_ERROR, Polynomial, THROUGH, derivatives};
use propagator::Propagator;

/// A linear system `dx/dt = A x + B f(t, x)`, and the forces `f` that drive it.
pub trait Driven<const F: usize> {
    /// Writes `dx = A x + B force`.
    fn rate(&self, x: &[f64], force: [f64; F], dx: &mut [f64]);

    /// The forces at time `t`; `None` if they are not smooth there.
    fn force(&mut self, t: f64, x: &[f64]) -> Option<[f64; F]>;
}

/// Number of past forces that are kept, so that the step can be doubled.
const KEPT: usize = 2 * PAST - 1;

/// The integrator, with the state and the past of the forces.
#[derive(Clone)]
pub struct ExponentialAdams<const F: usize> {
    parts: Vec<Part>,
    /// Corrections for the shortest step, for twice that, and so on.
    corrections: Vec<Corrections<F>>,
    /// Number of times that the shortest step is doubled now.
    doubling: usize,
    /// The state.
    state: Vec<f64>,
    /// The predicted next state.
    ahead: Vec<f64>,
    /// Excess of the error of each state over its tolerance.
    excess: Vec<f64>,
    /// Past values of each force, the last first.
    past: [[f64; KEPT]; F],
    /// Number of known past values.
    known: usize,
    /// The shortest step, s.
    step: f64,
}

/// Correction of each state for a unit error of the prediction of each force.
#[derive(Clone)]
struct Corrections<const F: usize> {
    whole: [Vec<f64>; F],
    /// The part of the correction that is due to the last past value, without which the polynomial would be one order
    /// lower: the estimated error.
    last_order: [Vec<f64>; F],
}

impl<const F: usize> Corrections<F> {
    fn none(states: usize) -> Self {
        let none = || array::from_fn(|_| vec![0.0; states]);
        Self {
            whole: none(),
            last_order: none(),
        }
    }
}

impl<const F: usize> ExponentialAdams<F> {
    /// A method for a system of `states` states with steps of `step` (s), which may be doubled `doublings` times.
    /// `None` if the system is not finite, or if its norm times the step exceeds a million.
    pub fn new(system: &impl Driven<F>, states: usize, step: f64, doublings: usize) -> Option<Self> {
        let linear = Linear::new(system, states, step);
        let mut parts = linear.parts();
        let mut corrections: Vec<Corrections<F>> = (0..=doublings).map(|_| Corrections::none(states)).collect();
        for part in &mut parts {
            let mut flow = linear.matrix(part).exponential()?;
            for (doubling, corrections) in corrections.iter_mut().enumerate() {
                if doubling > 0 {
                    flow = flow.times(&flow);
                }
                part.add_step_length(&flow, 0.5_f64.powi(doubling as i32), corrections);
            }
        }
        Some(Self {
            parts,
            corrections,
            doubling: 0,
            state: vec![0.0; states],
            ahead: vec![0.0; states],
            excess: vec![0.0; states],
            past: [[0.0; KEPT]; F],
            known: 0,
            step,
        })
    }

    /// True if it has these steps.
    pub fn steps_by(&self, step: f64, doublings: usize) -> bool {
        self.step == step && self.corrections.len() == doublings + 1
    }

    /// Begins at state `x` with the shortest step. `past` are forces at points with the distance of this step, the
    /// present ones last.
    pub fn begin(&mut self, x: &[f64], past: &[[f64; F]; PAST]) {
        (self.doubling, self.known) = (0, PAST);
        self.state.copy_from_slice(x);
        for (point, forces) in past.iter().rev().enumerate() {
            for (known, force) in self.past.iter_mut().zip(forces) {
                known[point] = *force;
            }
        }
        self.prepare();
    }

    /// True if the step may be doubled.
    pub fn may_double(&self) -> bool {
        self.doubling + 1 < self.corrections.len()
    }

    /// Doubles the step if that is allowed and enough past forces are known. Returns true if it did.
    pub fn lengthen(&mut self) -> bool {
        let longer = self.may_double() && self.known == KEPT;
        if longer {
            (self.doubling, self.known) = (self.doubling + 1, PAST);
            for known in &mut self.past {
                *known = array::from_fn(|point| known[(2 * point).min(KEPT - 1)]);
            }
            self.prepare();
        }
        longer
    }

    /// Prepares a step from the present state.
    fn prepare(&mut self) {
        for part in &mut self.parts {
            for (from, &place) in part.from.iter_mut().zip(&part.states) {
                *from = self.state[place];
            }
            part.take_forces(&self.past, &[0.0; F]);
        }
    }

    /// Steps to time `t` and returns true. If the forces are not smooth, or if the error exceeds `relative` times a
    /// state plus `absolute`, it changes nothing and returns false.
    #[inline(always)]
    pub fn advance(&mut self, system: &mut impl Driven<F>, t: f64, relative: f64, absolute: &[f64]) -> bool {
        for part in &mut self.parts {
            part.predict(self.doubling, &mut self.ahead);
        }
        let Some(force) = system.force(t, &self.ahead) else {
            return false;
        };
        let off = array::from_fn(|f| {
            let predicted = EXTRAPOLATION.iter().zip(&self.past[f]);
            force[f] - predicted.map(|(weight, force)| weight * force).sum::<f64>()
        });
        let good = self.is_within(off, relative, absolute);
        if good {
            self.go_on(force, off);
        }
        good
    }

    /// True if no state's error exceeds its tolerance; an error that is not a number does.
    #[inline(always)]
    fn is_within(&mut self, off: [f64; F], relative: f64, absolute: &[f64]) -> bool {
        let n = self.state.len();
        let (ahead, excess, absolute) = (&self.ahead[..n], &mut self.excess[..n], &absolute[..n]);
        let errors = self.corrections[self.doubling]
            .last_order
            .each_ref()
            .map(|error| &error[..n]);
        for i in 0..n {
            let error = (0..F).fold(0.0, |sum, f| sum + errors[f][i] * off[f]);
            excess[i] = error.abs() - (absolute[i] + relative * ahead[i].abs());
        }
        excess.iter().filter(|excess| **excess <= 0.0).count() == n
    }

    /// Accepts the predicted state, with the forces there and their errors of prediction.
    #[inline(always)]
    fn go_on(&mut self, force: [f64; F], off: [f64; F]) {
        let n = self.state.len();
        let (ahead, state) = (&self.ahead[..n], &mut self.state[..n]);
        let corrections = self.corrections[self.doubling]
            .whole
            .each_ref()
            .map(|correction| &correction[..n]);
        for i in 0..n {
            state[i] = (0..F).fold(ahead[i], |sum, f| sum + corrections[f][i] * off[f]);
        }
        for (past, force) in self.past.iter_mut().zip(force) {
            past.copy_within(..KEPT - 1, 1);
            past[0] = force;
        }
        self.known = KEPT.min(self.known + 1);
        for part in &mut self.parts {
            part.go_on();
            part.take_forces(&self.past, &off);
        }
    }

    /// The state.
    pub fn state(&self) -> &[f64] {
        &self.state
    }
}

/// States that depend on no others, with the forces that drive them.
///
/// The next state is predicted from the predicted last one; its correction is added with the forces. So a step can
/// begin before the forces of the last one are known.
#[derive(Clone)]
struct Part {
    states: Vec<usize>,
    forces: Vec<usize>,
    /// For each step length the matrix from `from` to the next state.
    propagators: Vec<Propagator>,
    /// The predicted last state, then for each force its past values, the last first, and the error of its last
    /// prediction.
    from: Vec<f64>,
    /// The predicted next state.
    ahead: Vec<f64>,
}

impl Part {
    fn new(states: Vec<usize>, forces: Vec<usize>) -> Self {
        let entries = states.len() + (PAST + 1) * forces.len();
        Self {
            from: vec![0.0; entries.next_multiple_of(4)],
            ahead: vec![0.0; states.len().next_multiple_of(4)],
            propagators: Vec::new(),
            states,
            forces,
        }
    }

    /// Adds a step length, from the flow of states and derivatives of forces over it. `unit` is the unit of their time,
    /// as a fraction of the step.
    fn add_step_length<const F: usize>(&mut self, flow: &Matrix, unit: f64, corrections: &mut Corrections<F>) {
        let n = self.states.len();
        let mut made_of = Matrix::zero(flow.size());
        for state in 0..n {
            *made_of.entry_mut(state, state) = 1.0;
        }
        for (place, &force) in (n..).step_by(PAST + 1).zip(&self.forces) {
            for (point, polynomial) in THROUGH.iter().enumerate() {
                for (power, derivative) in derivatives(polynomial, unit).into_iter().enumerate() {
                    *made_of.entry_mut(place + power, place + point) = derivative;
                }
            }
            let answer = |polynomial: &Polynomial, row: usize| -> f64 {
                let derivatives = derivatives(polynomial, unit).into_iter().enumerate();
                derivatives
                    .map(|(power, derivative)| flow.entry(row, place + power) * derivative)
                    .sum()
            };
            for (row, &state) in self.states.iter().enumerate() {
                let whole = answer(&PREDICTION_ERROR, row);
                *made_of.entry_mut(row, place + PAST) = whole;
                corrections.whole[force][state] = whole;
                corrections.last_order[force][state] = answer(&LAST_ORDER, row);
            }
        }
        self.propagators.push(Propagator::new(&flow.times(&made_of), n));
    }

    /// Predicts the next state.
    #[inline(always)]
    fn predict(&mut self, doubling: usize, ahead: &mut [f64]) {
        self.propagators[doubling].apply(&self.from, &mut self.ahead);
        for (&place, value) in self.states.iter().zip(&self.ahead) {
            ahead[place] = *value;
        }
    }

    /// Accepts the predicted state.
    #[inline(always)]
    fn go_on(&mut self) {
        let n = self.states.len();
        self.from[..n].copy_from_slice(&self.ahead[..n]);
    }

    /// Takes the past forces, and the errors of their last prediction.
    #[inline(always)]
    fn take_forces<const F: usize>(&mut self, past: &[[f64; KEPT]; F], off: &[f64; F]) {
        let places = self.from[self.states.len()..].as_chunks_mut::<{ PAST + 1 }>().0;
        for (places, &force) in places.iter_mut().zip(&self.forces) {
            places[..PAST].copy_from_slice(&past[force][..PAST]);
            places[PAST] = off[force];
        }
    }
}

/// `dx/dt = A x + B f`, times a step.
struct Linear<const F: usize> {
    /// Columns of A.
    states: Vec<Vec<f64>>,
    /// Columns of B.
    forces: [Vec<f64>; F],
}

impl<const F: usize> Linear<F> {
    fn new(system: &impl Driven<F>, states: usize, step: f64) -> Self {
        let rate = |x: &[f64], force: [f64; F]| {
            let mut rate = vec![0.0; states];
            system.rate(x, force, &mut rate);
            rate
        };
        let rest = vec![0.0; states];
        let unit = |state: usize| {
            let mut x = rest.clone();
            x[state] = step;
            rate(&x, [0.0; F])
        };
        Self {
            states: (0..states).map(unit).collect(),
            forces: array::from_fn(|force| rate(&rest, array::from_fn(|f| if f == force { step } else { 0.0 }))),
        }
    }

    /// The independent parts of the system.
    fn parts(&self) -> Vec<Part> {
        let n = self.states.len();
        let mut group: Vec<usize> = (0..n).collect();
        for (column, rates) in self.states.iter().enumerate() {
            for row in (0..n).filter(|&row| rates[row] != 0.0) {
                let (one, other) = (group[row], group[column]);
                if one != other {
                    group
                        .iter_mut()
                        .filter(|group| **group == other)
                        .for_each(|group| *group = one);
                }
            }
        }
        let part = |name: usize| {
            let states: Vec<usize> = (0..n).filter(|&state| group[state] == name).collect();
            let drives = |force: &usize| states.iter().any(|&state| self.forces[*force][state] != 0.0);
            let forces = (0..F).filter(drives).collect();
            (!states.is_empty()).then(|| Part::new(states, forces))
        };
        (0..n).filter_map(part).collect()
    }

    /// The matrix of the rates of a part and of the derivatives of its forces, each of which is the rate of the one
    /// before. Its exponential gives the effect of a step under forces that are polynomials in time (C. F. Van Loan,
    /// "Computing integrals involving the matrix exponential", IEEE Trans. Autom. Control 23, 1978).
    fn matrix(&self, part: &Part) -> Matrix {
        let mut matrix = Matrix::zero(part.from.len());
        for (row, &to) in part.states.iter().enumerate() {
            for (column, &from) in part.states.iter().enumerate() {
                *matrix.entry_mut(row, column) = self.states[from][to];
            }
            for (place, &force) in (part.states.len()..).step_by(PAST + 1).zip(&part.forces) {
                *matrix.entry_mut(row, place) = self.forces[force][to];
            }
        }
        for place in (part.states.len()..).step_by(PAST + 1).take(part.forces.len()) {
            for power in place..place + PAST {
                *matrix.entry_mut(power, power + 1) = 1.0;
            }
        }
        matrix
    }
}
