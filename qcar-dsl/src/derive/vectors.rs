//! The order of the vectors `x`, `u` and `y`: the symbol and unit of each entry.

use crate::expr::{CoordinateId, Symbol};
use crate::units::Unit;

/// An excitation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExcitationSource {
    /// A prescribed motion: the response is per m or rad.
    Motion(CoordinateId),
    /// A force input, by its place in `Model::forces`: the response is per N or N m.
    Force(u16),
}

/// The vectors of a model as symbols of its equations; the description has the names of their entries.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Vectors {
    /// `x`: positions of the masses, their velocities, positions of the nodes, inner states.
    pub states: Vec<Component>,
    /// `u`: of each direction its motions, its forces, its gravity.
    pub inputs: Vec<Component>,
    /// The units of `y`.
    pub outputs: Vec<Unit>,
}

/// An entry of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Its symbol in the equations.
    pub symbol: Symbol,
    /// Its unit.
    pub unit: Unit,
}

impl Vectors {
    /// Position of a symbol in `x`.
    pub fn state(&self, symbol: Symbol) -> Option<usize> {
        self.states.iter().position(|state| state.symbol == symbol)
    }

    /// Position of a symbol in `u`.
    pub fn input(&self, symbol: Symbol) -> Option<usize> {
        self.inputs.iter().position(|input| input.symbol == symbol)
    }
}
