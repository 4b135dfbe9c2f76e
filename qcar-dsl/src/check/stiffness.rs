//! The complex dynamic stiffness of a link at a point, force over stretch at an angular frequency.

use num_complex::Complex64;

use super::slopes::{InnerSlopes, Slopes};
use super::solve::solve;
use crate::expr::Expr;

/// `stiffness + iω damping - ω² inertance + Σ ∂f/∂z (iω - ∂ż/∂z)⁻¹ (∂ż/∂s + iω ∂ż/∂v)`
pub fn dynamic_stiffness(slopes: &Slopes, value: &dyn Fn(Expr) -> f64, frequency: f64) -> Complex64 {
    let inertia = frequency * frequency * value(slopes.inertance);
    let direct = Complex64::new(value(slopes.stiffness) - inertia, frequency * value(slopes.damping));
    let drive = slopes
        .inner
        .iter()
        .map(|inner| Complex64::new(value(inner.by_stretch), frequency * value(inner.by_rate)));
    let row = |(own, inner): (usize, &InnerSlopes)| {
        let on_diagonal = |other| if other == own { frequency } else { 0.0 };
        let entry = |(other, &slope): (usize, &Expr)| Complex64::new(-value(slope), on_diagonal(other));
        inner.by_inner.iter().enumerate().map(entry).collect()
    };
    let matrix: Vec<Vec<Complex64>> = slopes.inner.iter().enumerate().map(row).collect();
    let states = solve(matrix, vec![drive.collect()]);
    let answers = slopes.inner.iter().zip(&states[0]);
    answers.fold(direct, |sum, (inner, state)| sum + value(inner.force) * state)
}
