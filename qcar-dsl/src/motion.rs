//! Graph to equations of motion.

use crate::expr::{Expr, Symbol};

/// The equations of motion: definitions, then the rates of the states and the outputs in their terms.
#[derive(Clone, Debug)]
pub struct Motion {
    /// How each coordinate gets its motion, in the order of the model.
    pub roles: Vec<Role>,
    /// Symbols that stand for expressions in the states, the inputs, the parameters and earlier definitions: stretch,
    /// rate and force of each link, positions and velocities of massless nodes, accelerations.
    pub definitions: Vec<(Symbol, Expr)>,
    /// What stands at each place of `x`.
    pub states: Vec<Symbol>,
    /// What stands at each place of `u`.
    pub inputs: Vec<Symbol>,
    /// The time derivative of each state.
    pub rates: Vec<Expr>,
    /// The outputs of the model.
    pub outputs: Vec<Expr>,
}

/// How a coordinate gets its motion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// A road or another motion: an input.
    Prescribed,
    /// Newton: position and velocity are states. A mass, or a node that an inerter makes heavy.
    Inertial,
    /// A massless node that a damper holds: its position is a state, its balance gives its velocity.
    Damped,
    /// A massless node that only springs hold: its balance gives its position.
    Static,
}
