//! Matrices of a linear axle for the inputs from its contact, and their derivatives by each parameter.

use nalgebra::DMatrix;

use crate::model::{Contact, Model};
use crate::simulate::rolling::{GIVEN, Rolling};

/// The matrices of an axle for the rates of its states and for some outputs.
pub struct Axle {
    pub a: DMatrix<f64>,
    pub b: DMatrix<f64>,
    pub c: DMatrix<f64>,
    pub d: DMatrix<f64>,
}

impl Axle {
    /// The matrices of a linear axle, evaluated column by column.
    pub fn of<M: Model + ?Sized>(rolling: &Rolling<'_, M>, outputs: &[usize]) -> Self {
        let (n, signals) = rolling.sizes();
        let mut axle = Self {
            a: DMatrix::zeros(n, n),
            b: DMatrix::zeros(n, GIVEN),
            c: DMatrix::zeros(outputs.len(), n),
            d: DMatrix::zeros(outputs.len(), GIVEN),
        };
        let (mut rate, mut shown) = (vec![0.0; n], vec![0.0; signals]);
        let mut ask = |x: &[f64], given: [f64; GIVEN], rates: &mut [f64], seen: &mut dyn Iterator<Item = &mut f64>| {
            let [vertical, longitudinal, s, v] = given;
            let contact = Contact {
                force: [vertical, longitudinal],
                s,
                v,
            };
            rolling.move_by(&contact, x, &mut rate, &mut shown);
            rates.copy_from_slice(&rate);
            seen.zip(outputs).for_each(|(seen, &output)| *seen = shown[output]);
        };
        let mut x = vec![0.0; n];
        for state in 0..n {
            x[state] = 1.0;
            let (rates, mut seen) = (axle.a.column_mut(state), axle.c.column_mut(state));
            ask(&x, [0.0; GIVEN], { rates }.as_mut_slice(), &mut seen.iter_mut());
            x[state] = 0.0;
        }
        for place in 0..GIVEN {
            let mut given = [0.0; GIVEN];
            given[place] = 1.0;
            let (rates, mut seen) = (axle.b.column_mut(place), axle.d.column_mut(place));
            ask(&x, given, { rates }.as_mut_slice(), &mut seen.iter_mut());
        }
        axle
    }
}

/// A changed entry of a matrix: row, column and derivative.
pub type Entry = (usize, usize, f64);

/// The nonzero derivatives of a matrix, from two values and the change of the parameter.
fn changes(from: &DMatrix<f64>, to: &DMatrix<f64>, by: f64) -> Vec<Entry> {
    let places = (0..from.ncols()).flat_map(|column| (0..from.nrows()).map(move |row| (row, column)));
    let entries = places.map(|(row, column)| (row, column, (to[(row, column)] - from[(row, column)]) / by));
    entries.filter(|(.., slope)| *slope != 0.0).collect()
}

/// Effect of one parameter.
pub struct Direction<'a, M: ?Sized> {
    /// Derivatives of the matrices. Rows of `a` and `b` become positions among the forced states once these are known.
    pub a: Vec<Entry>,
    pub b: Vec<Entry>,
    pub c: Vec<Entry>,
    pub d: Vec<Entry>,
    /// Derivative of the state at rest.
    pub state: Vec<f64>,
    /// The car with the changed parameter, and the change, if its contact gives other inputs at the same state.
    pub other: Option<(Rolling<'a, M>, f64)>,
}

impl<'a, M: Model + ?Sized> Direction<'a, M> {
    pub fn new(
        (other, x): (Rolling<'a, M>, Vec<f64>),
        by: f64,
        (rolling, rests): (&Rolling<'a, M>, &[f64]),
        (axle, outputs): (&Axle, &[usize]),
    ) -> Self {
        let own = Axle::of(&other, outputs);
        Self {
            a: changes(&axle.a, &own.a, by),
            b: changes(&axle.b, &own.b, by),
            c: changes(&axle.c, &own.c, by),
            d: changes(&axle.d, &own.d, by),
            state: x.iter().zip(rests).map(|(x, rests)| (x - rests) / by).collect(),
            other: (!other.is_touched_like(rolling)).then_some((other, by)),
        }
    }

    /// Replaces the rows of the derivatives of A and B by their positions among the forced states.
    pub fn renumber(&mut self, forced: &[usize]) {
        let rows = self.a.iter_mut().chain(&mut self.b).map(|entry| &mut entry.0);
        rows.for_each(|row| *row = forced.partition_point(|own| own < row));
    }
}

/// Derivatives of the states at rest: a row for each state, with the directions in its lanes.
pub fn slopes_at_rest<M: ?Sized>(directions: &[Direction<'_, M>], states: usize, lanes: usize) -> Vec<f64> {
    let mut slopes = vec![0.0; states * lanes];
    for (lane, direction) in directions.iter().enumerate() {
        for (state, slope) in direction.state.iter().enumerate() {
            slopes[state * lanes + lane] = *slope;
        }
    }
    slopes
}

/// The states on which the contact acts, or a parameter.
pub fn forced<M: ?Sized>(axle: &Axle, directions: &[Direction<'_, M>]) -> Vec<usize> {
    let of_directions = directions.iter().flat_map(|own| own.a.iter().chain(&own.b));
    let is_pushed = |state: &usize| axle.b.row(*state).iter().any(|by| *by != 0.0);
    let pushed = (0..axle.b.nrows()).filter(is_pushed);
    let mut forced: Vec<usize> = of_directions.map(|entry| entry.0).chain(pushed).collect();
    forced.sort_unstable();
    forced.dedup();
    forced
}
