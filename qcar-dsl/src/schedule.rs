//! Expressions to straight-line programs.

use crate::about::About;
use crate::check::Checked;
use crate::expr::Graph;
use crate::linear::Linear;
use crate::motion::Motion;
use crate::program::Programs;

/// A model compiled: every stage of it, for its printers and its interpreter.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The model as it was written.
    pub model: Checked,
    /// Where the expressions of `motion` and `linear` live: the graph of the model, grown.
    pub graph: Graph,
    /// Its equations.
    pub motion: Motion,
    /// Its matrices.
    pub linear: Linear,
    /// Names, places and sparsity.
    pub about: About,
    /// What computes it.
    pub programs: Programs,
}
