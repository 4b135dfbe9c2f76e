//! What acts on the derivatives of the states or of the readings: the states' derivatives, and the directions
//! themselves.

use super::super::Reading;
use super::Direction;
use super::stages::Jacobians;
use crate::model::{Entry, InputKind, LANES, Lanes, Matrix, Model};

/// A direct effect of a direction on a row.
struct Source {
    row: usize,
    /// The direction.
    lane: usize,
    factor: Factor,
}

/// The nonzero that is a direct effect, by its position in the model's list.
#[derive(Clone, Copy)]
enum Factor {
    /// Of a matrix, with the input whose amplitude changes.
    Input(usize, usize),
    /// Of a matrix, for an input whose zero changes.
    Unit(usize),
    /// Of the derivatives by the parameters.
    Parameter(usize),
}

/// Effects on some rows.
pub struct Effects {
    /// Factors of the derivatives of states, by their positions in the model's list, with their columns, row by row.
    nonzeros: Vec<(usize, usize)>,
    /// Where each row ends.
    ends: Vec<usize>,
    sources: Vec<Source>,
}

impl Effects {
    /// Effects on the derivatives of all states.
    pub fn on_states(model: &dyn Model, directions: &[Direction]) -> Self {
        let rows: Vec<_> = (0..model.about().states.len()).map(Some).collect();
        Self::of(model, directions, &rows, false)
    }

    /// Effects on the outputs that are read. The row of a state that is read stays empty.
    pub fn on_readings(model: &dyn Model, directions: &[Direction], readings: &[Reading]) -> Self {
        let output = |reading: &Reading| match *reading {
            Reading::Output(output) => Some(output),
            Reading::State(_) => None,
        };
        let rows: Vec<_> = readings.iter().map(output).collect();
        Self::of(model, directions, &rows, true)
    }

    fn of(model: &dyn Model, directions: &[Direction], rows: &[Option<usize>], of_outputs: bool) -> Self {
        let by_states = if of_outputs { Matrix::C } else { Matrix::A };
        let mut effects = Self {
            nonzeros: Vec::new(),
            ends: Vec::new(),
            sources: Vec::new(),
        };
        let matrices = &model.about().matrices;
        for row in rows {
            let entries = matrices.iter().enumerate();
            let own = entries.filter(|(_, entry)| entry.matrix == by_states && Some(usize::from(entry.row)) == *row);
            let own = own.map(|(nonzero, entry)| (nonzero, usize::from(entry.column)));
            effects.nonzeros.extend(own);
            effects.ends.push(effects.nonzeros.len());
        }
        for (lane, direction) in directions.iter().enumerate() {
            for (of, factor) in factors(model, direction, of_outputs) {
                let places = rows.iter().enumerate().filter(|(_, row)| **row == Some(of));
                effects
                    .sources
                    .extend(places.map(|(row, _)| Source { row, lane, factor }));
            }
        }
        effects
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.ends.len()
    }

    /// The direct effects on all rows at some points, for each block of directions and each of the points. They are
    /// gathered for all points at once: a vector that is read right after single numbers of it were stored would wait
    /// for them.
    pub fn direct(
        &self,
        jacobians: &Jacobians,
        points: impl ExactSizeIterator<Item = usize> + Clone,
        blocks: usize,
        into: &mut Vec<Lanes>,
    ) {
        let (count, rows) = (points.len(), self.rows());
        into.clear();
        into.resize(blocks * count * rows, [0.0; LANES]);
        for source in &self.sources {
            let (block, lane) = (source.lane / LANES, source.lane % LANES);
            let of_block = into[block * count * rows..][..count * rows].chunks_exact_mut(rows);
            let places = of_block.map(|rows| &mut rows[source.row][lane]).zip(points.clone());
            match source.factor {
                Factor::Parameter(nonzero) => {
                    let values = jacobians.parameter(nonzero);
                    places.for_each(|(place, point)| *place += values[point]);
                }
                Factor::Unit(nonzero) => places.for_each(|(place, point)| *place += jacobians.matrix(nonzero, point)),
                Factor::Input(nonzero, input) => {
                    let u = jacobians.stages.u(input);
                    places.for_each(|(place, point)| *place += jacobians.matrix(nonzero, point) * u[point]);
                }
            }
        }
    }

    /// The derivatives of a row at a point, from those of the states and the direct effects.
    #[inline(always)]
    pub fn row(&self, row: usize, (jacobians, point): (&Jacobians, usize), states: &[Lanes], direct: &Lanes) -> Lanes {
        let first = if row == 0 { 0 } else { self.ends[row - 1] };
        let mut sum = *direct;
        for &(nonzero, column) in &self.nonzeros[first..self.ends[row]] {
            let (factor, of_column) = (jacobians.matrix(nonzero, point), &states[column]);
            for lane in 0..LANES {
                sum[lane] += factor * of_column[lane];
            }
        }
        sum
    }
}

/// Direct effects of a direction on the derivatives of the states or on the outputs, each with its row.
fn factors(model: &dyn Model, direction: &Direction, of_outputs: bool) -> Vec<(usize, Factor)> {
    let about = model.about();
    match direction {
        Direction::Initial(_) => Vec::new(),
        Direction::Amplitude(excitation) => {
            let scales = |input: usize| match about.inputs[input].kind {
                InputKind::Motion(place, _) | InputKind::Force(place) => usize::from(place) == *excitation,
                InputKind::Gravity => false,
            };
            let own = by_inputs(model, of_outputs).filter(|(_, entry)| scales(entry.column.into()));
            own.map(|(nonzero, entry)| (entry.row.into(), Factor::Input(nonzero, entry.column.into())))
                .collect()
        }
        Direction::Zero(excitation) => {
            let is_it = |input: usize| about.inputs[input].kind == InputKind::Force(*excitation as u16);
            let own = by_inputs(model, of_outputs).filter(|(_, entry)| is_it(entry.column.into()));
            own.map(|(nonzero, entry)| (entry.row.into(), Factor::Unit(nonzero)))
                .collect()
        }
        Direction::Parameters(parameters) => {
            let entries = about.parameter_jacobian.iter().enumerate();
            let own =
                entries.filter(|(_, (output, _, by))| *output == of_outputs && parameters.contains(&usize::from(*by)));
            own.map(|(nonzero, (_, row, _))| (usize::from(*row), Factor::Parameter(nonzero)))
                .collect()
        }
    }
}

/// The entries of the matrix by the inputs, of the states or of the outputs, each with its position.
fn by_inputs(model: &dyn Model, of_outputs: bool) -> impl Iterator<Item = (usize, &Entry)> {
    let matrix = if of_outputs { Matrix::D } else { Matrix::B };
    let entries = model.about().matrices.iter().enumerate();
    entries.filter(move |(_, entry)| entry.matrix == matrix)
}
