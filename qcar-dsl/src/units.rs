//! Units: rational powers of kg, m and s (rad is 1).

/// Exponents of kg, m, s as fractions of 6, so that square and cube roots stay exact.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Unit {
    /// Sixths of the exponents of kg, m and s.
    pub sixths: [i16; 3],
}
