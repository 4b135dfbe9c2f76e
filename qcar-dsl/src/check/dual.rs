//! Complex numbers that carry their derivatives by the parameters, and linear systems of them.

use std::ops::{Add, Div, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// A real number.
    pub fn real(re: f64) -> Complex {
        Complex { re, im: 0.0 }
    }

    /// `i x`
    pub fn imaginary(im: f64) -> Complex {
        Complex { re: 0.0, im }
    }

    /// The modulus.
    pub fn abs(self) -> f64 {
        self.re.hypot(self.im)
    }

    /// `self x` for a real x.
    pub fn scaled(self, x: f64) -> Complex {
        Complex {
            re: self.re * x,
            im: self.im * x,
        }
    }
}

impl Add for Complex {
    type Output = Complex;

    fn add(self, b: Complex) -> Complex {
        Complex {
            re: self.re + b.re,
            im: self.im + b.im,
        }
    }
}

impl Sub for Complex {
    type Output = Complex;

    fn sub(self, b: Complex) -> Complex {
        Complex {
            re: self.re - b.re,
            im: self.im - b.im,
        }
    }
}

impl Mul for Complex {
    type Output = Complex;

    fn mul(self, b: Complex) -> Complex {
        Complex {
            re: self.re * b.re - self.im * b.im,
            im: self.re * b.im + self.im * b.re,
        }
    }
}

impl Div for Complex {
    type Output = Complex;

    fn div(self, b: Complex) -> Complex {
        let square = b.re * b.re + b.im * b.im;
        let product = self * Complex { re: b.re, im: -b.im };
        product.scaled(1.0 / square)
    }
}

/// A complex number with its derivative by each parameter.
#[derive(Clone, Debug)]
pub struct Dual {
    /// The number.
    pub value: Complex,
    /// ∂value/∂parameter; empty where it depends on none.
    pub gradient: Vec<Complex>,
}

impl Dual {
    /// A number that depends on no parameter.
    pub fn constant(value: Complex) -> Dual {
        Dual {
            value,
            gradient: Vec::new(),
        }
    }

    /// True for a zero that depends on no parameter.
    fn is_zero(&self) -> bool {
        self.value == Complex::default() && self.gradient.is_empty()
    }

    /// `self factor` for a constant factor.
    pub fn scaled(&self, factor: Complex) -> Dual {
        self.combine(&Dual::constant(Complex::default()), factor, Complex::default())
    }

    /// `self + other`
    pub fn plus(&self, other: &Dual) -> Dual {
        let one = Complex::real(1.0);
        Dual {
            value: self.value + other.value,
            ..self.combine(other, one, one)
        }
    }

    /// `self - other`
    pub fn minus(&self, other: &Dual) -> Dual {
        self.plus(&other.scaled(Complex::real(-1.0)))
    }

    /// `self other`
    pub fn times(&self, other: &Dual) -> Dual {
        Dual {
            value: self.value * other.value,
            ..self.combine(other, other.value, self.value)
        }
    }

    /// `self / other`
    pub fn over(&self, other: &Dual) -> Dual {
        let value = self.value / other.value;
        let inverse = Complex::real(1.0) / other.value;
        let gradient = self
            .combine(other, inverse, Complex::real(-1.0) * value * inverse)
            .gradient;
        Dual { value, gradient }
    }

    /// `a self + b other` of the derivatives, and `a self` of the value.
    fn combine(&self, other: &Dual, a: Complex, b: Complex) -> Dual {
        let scaled = |of: &Dual, by: Complex| of.gradient.iter().map(|&x| by * x).collect();
        let gradient = match (self.gradient.is_empty(), other.gradient.is_empty()) {
            (_, true) => scaled(self, a),
            (true, false) => scaled(other, b),
            (false, false) => {
                let pairs = self.gradient.iter().zip(&other.gradient);
                pairs.map(|(&x, &y)| a * x + b * y).collect()
            }
        };
        Dual {
            value: self.value * a,
            gradient,
        }
    }
}

/// Solves `matrix x = column` for several columns, by elimination with partial pivoting, past the zeros. A singular matrix
/// gives numbers that are not finite.
pub fn solve(mut matrix: Vec<Vec<Dual>>, mut columns: Vec<Vec<Dual>>) -> Vec<Vec<Dual>> {
    let size = matrix.len();
    for at in 0..size {
        let pivot = (at..size).max_by(|&a, &b| matrix[a][at].value.abs().total_cmp(&matrix[b][at].value.abs()));
        let pivot = pivot.unwrap_or(at);
        matrix.swap(at, pivot);
        columns.iter_mut().for_each(|column| column.swap(at, pivot));
        let pivot_row: Vec<(usize, Dual)> = nonzeros(&matrix[at], at);
        for row in at + 1..size {
            if matrix[row][at].is_zero() {
                continue;
            }
            let factor = matrix[row][at].over(&matrix[at][at]);
            for (place, own) in &pivot_row {
                matrix[row][*place] = matrix[row][*place].minus(&factor.times(own));
            }
            for column in columns.iter_mut().filter(|column| !column[at].is_zero()) {
                column[row] = column[row].minus(&factor.times(&column[at]));
            }
        }
    }
    let rows: Vec<Vec<(usize, Dual)>> = (0..size).map(|at| nonzeros(&matrix[at], at + 1)).collect();
    for column in &mut columns {
        for at in (0..size).rev() {
            for (place, entry) in &rows[at] {
                column[at] = column[at].minus(&entry.times(&column[*place]));
            }
            column[at] = column[at].over(&matrix[at][at]);
        }
    }
    columns
}

/// The entries of a row from a place on that are not zero.
fn nonzeros(row: &[Dual], from: usize) -> Vec<(usize, Dual)> {
    let entries = row.iter().enumerate().skip(from);
    let nonzero = entries.filter(|(_, entry)| !entry.is_zero());
    nonzero.map(|(place, entry)| (place, entry.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parameter `p`, and numbers that do not depend on it.
    fn number(re: f64, by_p: f64) -> Dual {
        Dual {
            value: Complex::real(re),
            gradient: vec![Complex::real(by_p)],
        }
    }

    #[test]
    fn a_solution_carries_its_derivative() {
        // (p 1; 1 2) x = (1; 0) has x = (2; -1)/(2 p - 1), and dx/dp = -2 x/(2 p - 1); p = 2.
        let matrix = vec![
            vec![number(2.0, 1.0), number(1.0, 0.0)],
            vec![number(1.0, 0.0), number(2.0, 0.0)],
        ];
        let x = &solve(matrix, vec![vec![number(1.0, 0.0), number(0.0, 0.0)]])[0];
        for (x, value) in x.iter().zip([2.0 / 3.0, -1.0 / 3.0]) {
            assert!((x.value.re - value).abs() < 1e-14);
            assert!((x.gradient[0].re + 2.0 * value / 3.0).abs() < 1e-14);
        }
    }
}
