//! The complex dynamic stiffness of a link at a point, force over stretch at an angular frequency, with its
//! derivatives by the parameters.

use super::dual::{Complex, Dual, solve};
use super::slopes::{OtherSlopes, Slopes};
use crate::expr::Expr;

/// `stiffness + iω damping - ω² inertance + Σ ∂f/∂z (iω - ∂ż/∂z)⁻¹ (∂ż/∂s + iω ∂ż/∂v)`
pub fn dynamic_stiffness(slopes: &Slopes, dual: &dyn Fn(Expr) -> Dual, frequency: f64) -> Dual {
    let rate = Complex::imaginary(frequency);
    let damping = dual(slopes.damping).scaled(rate);
    let inertance = dual(slopes.inertance).scaled(rate * rate);
    let direct = dual(slopes.stiffness).plus(&damping).plus(&inertance);
    let drive = slopes
        .inner
        .iter()
        .map(|inner| dual(inner.by_stretch).plus(&dual(inner.by_rate).scaled(rate)));
    with_states(slopes, dual, frequency, direct, drive.collect())
}

/// The force for a unit of each force input while nothing moves: `∂f/∂u + Σ ∂f/∂z (iω - ∂ż/∂z)⁻¹ ∂ż/∂u`.
pub fn driven(slopes: &Slopes, dual: &dyn Fn(Expr) -> Dual, frequency: f64) -> Vec<(u16, Dual)> {
    let response = |(place, &(input, direct)): (usize, &(u16, Expr))| {
        let drive = slopes.inner.iter().map(|inner| dual(inner.by_inputs[place]));
        let force = with_states(slopes, dual, frequency, dual(direct), drive.collect());
        (input, force)
    };
    slopes.inputs.iter().enumerate().map(response).collect()
}

/// The force for a unit stretch of each other link whose motion the law uses.
pub fn coupled(slopes: &Slopes, dual: &dyn Fn(Expr) -> Dual, frequency: f64) -> Vec<(usize, Dual)> {
    let rate = Complex::imaginary(frequency);
    let by = |stretch: Expr, rate_of: Expr| dual(stretch).plus(&dual(rate_of).scaled(rate));
    let response = |other: &OtherSlopes| {
        let drive = other.inner.iter().map(|&[stretch, rate]| by(stretch, rate)).collect();
        let force = with_states(slopes, dual, frequency, by(other.stiffness, other.damping), drive);
        (usize::from(other.link.0), force)
    };
    slopes.others.iter().map(response).collect()
}

/// A force with what the inner states add to it when something drives their rates.
fn with_states(slopes: &Slopes, dual: &dyn Fn(Expr) -> Dual, frequency: f64, force: Dual, drive: Vec<Dual>) -> Dual {
    let rate = Complex::imaginary(frequency);
    let row = |(own, inner): (usize, &super::slopes::InnerSlopes)| {
        let on_diagonal = |other: usize| if other == own { rate } else { Complex::default() };
        let entry = |(other, &slope): (usize, &Expr)| Dual::constant(on_diagonal(other)).minus(&dual(slope));
        inner.by_inner.iter().enumerate().map(entry).collect()
    };
    let matrix: Vec<Vec<Dual>> = slopes.inner.iter().enumerate().map(row).collect();
    let states = solve(matrix, vec![drive]);
    let answers = slopes.inner.iter().zip(&states[0]);
    answers.fold(force, |sum, (inner, state)| sum.plus(&dual(inner.force).times(state)))
}
