//! Matrices and their derivatives by name: which parameter moves the natural vibrations of a quarter car, and how far.
//!
//! ```text
//! cargo run --example jacobians
//! ```

use std::error::Error;

use models::quarter_car::{Parameters, STATES, jacobians, state_space};
use qcar_runtime::nalgebra::{Complex, SMatrix, SVector};

type Matrix = SMatrix<Complex<f64>, STATES, STATES>;
type Vector = SVector<Complex<f64>, STATES>;

/// An eigenvalue moves by wᵀ ∂A/∂p v / wᵀv, v and w being its right and left vectors.
pub fn main() -> Result<(), Box<dyn Error>> {
    let p = Parameters::default();
    let (a, slopes) = (state_space(&p).a, jacobians(&p).a);
    for root in a.complex_eigenvalues().iter().filter(|root| root.im > 0.0) {
        println!(
            "{:.3} Hz, in percent for one percent of",
            root.norm() / std::f64::consts::TAU
        );
        let a = a.map(Complex::from);
        let (v, w) = (vector(a, *root), vector(a.transpose(), *root));
        for ((name, slope), value) in slopes.iter().zip(p.to_array()) {
            let moved = (w.transpose() * slope.map(Complex::from) * v)[0] / w.dot(&v);
            let relative = (moved * root.conj()).re / root.norm_sqr() * value;
            println!("  {name:10} {relative:6.3}");
        }
    }
    Ok(())
}

/// A vector that the matrix stretches by the eigenvalue: a step of inverse iteration from nearby.
fn vector(matrix: Matrix, root: Complex<f64>) -> Vector {
    let near = matrix - Matrix::identity() * (root * (1.0 + 1e-9));
    let start = Vector::from_element(Complex::new(1.0, 0.5));
    near.lu()
        .solve(&start)
        .expect("beside an eigenvalue nothing is singular")
}
