//! Equations to matrices and their parameter Jacobians.

use crate::about::Entry;
use crate::expr::Expr;

/// The Jacobians of the equations of motion, nonzeros only, in states, inputs and parameters.
#[derive(Clone, Debug)]
pub struct Linear {
    /// True where A, B, C and D depend on the parameters alone.
    pub linear: bool,
    /// A = ∂f/∂x, B = ∂f/∂u, C = ∂h/∂x and D = ∂h/∂u.
    pub matrices: Vec<(Entry, Expr)>,
    /// Their derivative by a parameter.
    pub sensitivities: Vec<(Entry, u16, Expr)>,
    /// ∂f/∂p and ∂h/∂p: is it an output, row, parameter.
    pub parameter_jacobian: Vec<(bool, u16, u16, Expr)>,
}
