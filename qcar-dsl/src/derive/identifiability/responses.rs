//! The responses of a derived model at points of its motion, with their derivatives by the parameters.
//!
//! `y = (C R B + D) u` with `R = (jω - A)⁻¹`, and its derivative by a parameter is
//! `C R (A' R B + B') u + (C' R B + D') u`, in which `C R` is the adjoint of the outputs.

use std::collections::BTreeMap;

use num_complex::Complex64;
use qcar_model::{Entry, Matrix};

use super::forces::Forces;
use super::observable::Observable;
use crate::check::Checked;
use crate::check::sample::{Kind, Point, Values};
use crate::check::solve::solve;
use crate::derive::linear::Linear;
use crate::derive::motion::Motion;
use crate::derive::response::sources;
use crate::derive::vectors::ExcitationSource;
use crate::expr::{Graph, Symbol};
use crate::hash::HashMap;
use crate::model::{CoordinateKind, Quantity, Reference, Signal};

/// Angular frequencies for numbers near 1.
const PLAIN: [f64; 6] = [0.3, 0.7, 1.1, 1.9, 3.1, 5.3];
/// Angular frequencies for declared values, rad/s.
const DECLARED: [f64; 6] = [5.0, 11.0, 23.0, 47.0, 80.0, 160.0];

/// Responses below this fraction of the largest are roundoff.
const ROUNDOFF: f64 = 1e-12;

/// A model with its equations, and the parameters of interest.
pub struct Derived<'a> {
    /// The model.
    pub model: &'a Checked,
    /// The graph of all expressions.
    pub graph: &'a Graph,
    /// Its equations.
    pub motion: &'a Motion,
    /// Its matrices.
    pub linear: &'a Linear,
    /// The observed forces of nonlinear laws.
    pub forces: Forces,
    /// Positions of the estimated parameters in the model, in increasing order.
    pub estimated: &'a [u16],
}

impl Derived<'_> {
    /// Everything that can be observed at one parameter set, in parts: the responses of outputs and channels to each
    /// input and, for nonlinear laws, the change of the force itself. Evaluates up to this number of motions, until
    /// there is `enough`.
    pub fn see(&self, point: Point, motions: u64, mut enough: impl FnMut(Vec<Observable>) -> bool) {
        let has_clock = self.model.parameters.iter().any(|parameter| parameter.clock);
        let motions = if self.forces.bends || has_clock { motions } else { 1 };
        let frequencies = if point.kind == Kind::Plain { PLAIN } else { DECLARED };
        let mut in_motion = |motion| {
            let point = point.moved(motion);
            let in_responses = |values: &Values| {
                let matrices = Matrices::of(self, values);
                frequencies
                    .into_iter()
                    .any(|frequency| enough(matrices.look(frequency)))
            };
            self.evaluated(point, in_responses) || enough(self.forces.seen(self.graph, &point, self.estimated.len()))
        };
        (0..motions).any(&mut in_motion);
    }

    /// The derivatives of the rates and the outputs by these parameters at a point, each relative to the largest one and
    /// to the parameters.
    pub fn changes_by(&self, parameters: &[u16], point: Point) -> Vec<Vec<f64>> {
        let mut rows = BTreeMap::new();
        self.evaluated(point, |values| {
            for &(is_output, row, parameter, change) in &self.linear.parameter_jacobian {
                if let Ok(place) = parameters.binary_search(&parameter) {
                    let row = rows
                        .entry((is_output, row))
                        .or_insert_with(|| vec![0.0; parameters.len()]);
                    row[place] = values.of(change) * point.leaf(Symbol::Parameter(parameter));
                }
            }
        });
        let relative = |row: Vec<f64>| {
            let largest = row.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
            row.into_iter().map(|entry| entry / largest).collect()
        };
        let rows = rows.into_values().map(relative);
        rows.filter(|row: &Vec<f64>| row.iter().all(|entry| entry.is_finite()))
            .collect()
    }

    /// Evaluates expressions of the equations at a point.
    fn evaluated<T>(&self, point: Point, evaluate: impl FnOnce(&Values) -> T) -> T {
        let known = HashMap::default().into();
        let leaf = |symbol: Symbol| defined(&known, symbol).unwrap_or_else(|| point.leaf(symbol));
        let values = Values::new(self.graph, &leaf);
        for &(symbol, value) in &self.motion.definitions {
            let value = values.of(value);
            known.borrow_mut().insert(symbol, value);
        }
        evaluate(&values)
    }
}

fn defined(known: &std::cell::RefCell<HashMap<Symbol, f64>>, symbol: Symbol) -> Option<f64> {
    known.borrow().get(&symbol).copied()
}

/// The matrices at a point, nonzeros only.
struct Matrices<'a> {
    derived: &'a Derived<'a>,
    entries: Vec<(Entry, f64)>,
    /// Their derivatives, each with the position of its parameter among the estimated ones.
    changes: Vec<(Entry, usize, f64)>,
}

/// Inputs, states and outputs under one excitation of unit amplitude.
struct Excited {
    inputs: Vec<Complex64>,
    states: Vec<Complex64>,
    outputs: Vec<Observable>,
}

impl<'a> Matrices<'a> {
    fn of(derived: &'a Derived<'a>, values: &Values) -> Self {
        let entries = derived.linear.matrices.iter();
        let changes = derived
            .linear
            .sensitivities
            .iter()
            .filter_map(|&(entry, parameter, e)| {
                let place = derived.estimated.binary_search(&parameter).ok()?;
                Some((entry, place, values.of(e)))
            });
        Matrices {
            derived,
            entries: entries.map(|&(entry, e)| (entry, values.of(e))).collect(),
            changes: changes.collect(),
        }
    }

    /// The responses at an angular frequency, rad/s.
    fn look(&self, frequency: f64) -> Vec<Observable> {
        let model = self.derived.model;
        let mut seen = Vec::new();
        for (source, excited) in self.excite(frequency) {
            add_relative(excited.outputs.clone(), &mut seen);
            let signal = |signal| self.signal(signal, source, &excited, frequency);
            let ratios = model.channels.iter().filter_map(|channel| {
                let above = signal(&channel.numerator)?;
                match &channel.denominator {
                    Reference::Signal(below) => Some(above.over(&signal(below)?)),
                    Reference::Force(place) => (source == ExcitationSource::Force(*place)).then_some(above),
                }
            });
            add_relative(ratios.collect(), &mut seen);
        }
        seen
    }

    /// The response to each excitation of unit amplitude.
    fn excite(&self, frequency: f64) -> Vec<(ExcitationSource, Excited)> {
        let motion = self.derived.motion;
        let inputs = |source| motion.inputs.iter().map(move |&input| share(source, input, frequency));
        let sources: Vec<(ExcitationSource, Vec<Complex64>)> = sources(self.derived.model)
            .into_iter()
            .map(|source| (source, inputs(source).collect()))
            .collect();
        let zeros = vec![Complex64::default(); motion.states.len()];
        let mut resists = vec![zeros.clone(); motion.states.len()];
        (0..motion.states.len()).for_each(|own| resists[own][own].im = frequency);
        let mut adjoints = vec![zeros.clone(); motion.outputs.len()];
        let mut pushed = vec![zeros; sources.len()];
        for &(Entry { matrix, row, column }, value) in &self.entries {
            let (row, column) = (usize::from(row), usize::from(column));
            match matrix {
                Matrix::A => resists[row][column] -= value,
                Matrix::B => (pushed.iter_mut().zip(&sources))
                    .for_each(|(pushed, (_, inputs))| pushed[row] += value * inputs[column]),
                Matrix::C => adjoints[row][column] += value,
                Matrix::D => {}
            }
        }
        let adjoints = solve(transposed(&resists), adjoints);
        let states = solve(resists, pushed);
        let excited = |((source, inputs), states): ((ExcitationSource, Vec<Complex64>), Vec<Complex64>)| {
            let excited = Excited {
                inputs,
                states,
                outputs: vec![],
            };
            let outputs = self.outputs(&excited, &adjoints);
            (source, Excited { outputs, ..excited })
        };
        sources.into_iter().zip(states).map(excited).collect()
    }

    /// The outputs under one excitation, with their derivatives.
    fn outputs(&self, excited: &Excited, adjoints: &[Vec<Complex64>]) -> Vec<Observable> {
        let still = Observable {
            value: Complex64::default(),
            gradient: vec![Complex64::default(); self.derived.estimated.len()],
        };
        let moves = |entry: &Entry| match entry.matrix {
            Matrix::A | Matrix::C => excited.states[usize::from(entry.column)],
            Matrix::B | Matrix::D => excited.inputs[usize::from(entry.column)],
        };
        let mut outputs = vec![still; adjoints.len()];
        for (entry, value) in &self.entries {
            if let Matrix::C | Matrix::D = entry.matrix {
                outputs[usize::from(entry.row)].value += value * moves(entry);
            }
        }
        for (entry, place, change) in &self.changes {
            let (row, change) = (usize::from(entry.row), change * moves(entry));
            match entry.matrix {
                Matrix::C | Matrix::D => outputs[row].gradient[*place] += change,
                Matrix::A | Matrix::B => (outputs.iter_mut().zip(adjoints))
                    .for_each(|(output, adjoint)| output.gradient[*place] += adjoint[row] * change),
            }
        }
        outputs
    }

    /// A signal of a channel: a prescribed motion, or a signal that follows from an output.
    fn signal(
        &self,
        signal: &Signal,
        source: ExcitationSource,
        excited: &Excited,
        frequency: f64,
    ) -> Option<Observable> {
        let model = self.derived.model;
        if let Signal::Motion(c, quantity) = *signal
            && let CoordinateKind::Road | CoordinateKind::Motion = model.coordinates[usize::from(c.0)].kind
        {
            return Some(Observable {
                value: share(source, Symbol::of_motion(c, quantity), frequency),
                gradient: vec![Complex64::default(); self.derived.estimated.len()],
            });
        }
        let mut outputs = model.outputs.iter().zip(&excited.outputs);
        outputs.find_map(|(output, seen)| {
            let orders = orders(&output.signal, signal)?;
            Some(seen.scaled(Complex64::new(0.0, frequency).powi(orders)))
        })
    }
}

/// The amplitude of an input under an excitation of unit amplitude.
fn share(source: ExcitationSource, input: Symbol, frequency: f64) -> Complex64 {
    match (source, input) {
        (ExcitationSource::Motion(own), Symbol::Position(c)) if own == c => 1.0.into(),
        (ExcitationSource::Motion(own), Symbol::Velocity(c)) if own == c => Complex64::new(0.0, frequency),
        (ExcitationSource::Motion(own), Symbol::Acceleration(c)) if own == c => (-frequency * frequency).into(),
        (ExcitationSource::Force(own), Symbol::Force(place)) if own == place => 1.0.into(),
        _ => Complex64::default(),
    }
}

/// Number of time derivatives from one signal to another of the same point; `None` for signals of different points.
fn orders(from: &Signal, to: &Signal) -> Option<i32> {
    let order = |quantity: &Quantity| *quantity as i32;
    match (from, to) {
        (Signal::Motion(a, from), Signal::Motion(b, to)) if a == b => Some(order(to) - order(from)),
        (Signal::Point(a, from), Signal::Point(b, to)) if a == b => Some(order(to) - order(from)),
        _ => (from == to).then_some(0),
    }
}

fn transposed(matrix: &[Vec<Complex64>]) -> Vec<Vec<Complex64>> {
    let column = |place: usize| matrix.iter().map(|row| row[place]).collect();
    (0..matrix.len()).map(column).collect()
}

/// Adds the responses that are large enough to be more than roundoff.
fn add_relative(responses: Vec<Observable>, seen: &mut Vec<Observable>) {
    let finite = |response: &Observable| response.value.norm().is_finite();
    let responses: Vec<Observable> = responses.into_iter().filter(finite).collect();
    let largest = responses.iter().map(|response| response.value.norm());
    let largest = largest.fold(0.0_f64, f64::max);
    let heard = |response: &Observable| response.value.norm() > ROUNDOFF * largest;
    seen.extend(responses.into_iter().filter(heard));
}
