//! In which shapes there is code of a program.

use qcar_dsl::evaluate::given::Part;

/// How often a program is computed in a call.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// At one point.
    Once,
    /// For [`qcar_model::LANES`] sets, of which each entry has a row.
    Sets,
    /// At many points, of which each entry of the varying parts has a row.
    Points(&'static [Part]),
}
