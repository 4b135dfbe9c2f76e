//! The complex dynamic stiffness of a link at a point, force over stretch at an angular frequency, with its
//! derivatives by the parameters.

use super::dual::{Complex, Dual, solve};
use super::slopes::Slopes;
use crate::expr::Expr;

/// `stiffness + iω damping - ω² inertance + Σ ∂f/∂z (iω - ∂ż/∂z)⁻¹ (∂ż/∂s + iω ∂ż/∂v)`
pub fn dynamic_stiffness(slopes: &Slopes, dual: &dyn Fn(Expr) -> Dual, frequency: f64) -> Dual {
    let rate = Complex::imaginary(frequency);
    let damping = dual(slopes.damping).scaled(rate);
    let inertance = dual(slopes.inertance).scaled(rate * rate);
    let mut sum = dual(slopes.stiffness).plus(&damping).plus(&inertance);
    let parameters = sum.gradient.len();
    let row = |(own, inner): (usize, &super::slopes::InnerSlopes)| {
        let on_diagonal = |other: usize| if other == own { rate } else { Complex::default() };
        let entry =
            |(other, &slope): (usize, &Expr)| Dual::constant(on_diagonal(other), parameters).minus(&dual(slope));
        inner.by_inner.iter().enumerate().map(entry).collect()
    };
    let matrix: Vec<Vec<Dual>> = slopes.inner.iter().enumerate().map(row).collect();
    let drive = slopes
        .inner
        .iter()
        .map(|inner| dual(inner.by_stretch).plus(&dual(inner.by_rate).scaled(rate)));
    let states = solve(matrix, vec![drive.collect()]);
    for (inner, state) in slopes.inner.iter().zip(&states[0]) {
        sum = sum.plus(&dual(inner.force).times(state));
    }
    sum
}
