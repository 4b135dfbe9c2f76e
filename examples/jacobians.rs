//! Matrices and their derivatives by name: sensitivity of the natural frequencies of a quarter car to its parameters.
//!
//! ```text
//! cargo run --example jacobians
//! ```

use std::error::Error;

use models::quarter_car::{Parameters, STATES, jacobians, state_space};
use qcar_runtime::nalgebra::{Complex, SMatrix, SVector};

type Matrix = SMatrix<Complex<f64>, STATES, STATES>;
type Vector = SVector<Complex<f64>, STATES>;

/// The derivative of an eigenvalue is wᵀ ∂A/∂p v / wᵀv, with its right and left eigenvectors v and w.
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

/// An eigenvector, by a step of inverse iteration.
fn vector(matrix: Matrix, root: Complex<f64>) -> Vector {
    let near = matrix - Matrix::identity() * (root * (1.0 + 1e-9));
    let start = Vector::from_element(Complex::new(1.0, 0.5));
    near.lu()
        .solve(&start)
        .expect("beside an eigenvalue nothing is singular")
}
