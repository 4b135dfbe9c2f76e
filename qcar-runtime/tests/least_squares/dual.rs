//! Residuals written with a number type that carries derivatives, so that no Jacobian is typed by hand.

use std::ops::{Add, Div, Mul, Neg, Sub};

use qcar_runtime::least_squares::Problem;

/// A number of residuals, each a function of the variables and of its place.
pub struct Functions<F> {
    pub variables: usize,
    pub residuals: usize,
    pub residual: F,
}

impl<F: Fn(&[Dual], usize) -> Dual> Problem for Functions<F> {
    fn variables(&self) -> usize {
        self.variables
    }

    fn residuals(&self) -> usize {
        self.residuals
    }

    fn evaluate(&mut self, x: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        for column in 0..self.variables {
            let seeded = x.iter().enumerate();
            let seeded: Vec<Dual> = seeded
                .map(|(k, &value)| Dual(value, f64::from(u8::from(k == column))))
                .collect();
            for row in 0..self.residuals {
                let value = (self.residual)(&seeded, row);
                residual[row] = value.0;
                jacobian[column * self.residuals + row] = value.1;
            }
        }
    }
}

/// A value and its derivative along one variable.
#[derive(Clone, Copy)]
pub struct Dual(pub f64, pub f64);

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Dual(value, 0.0)
    }
}

impl Dual {
    pub fn exp(self) -> Self {
        Dual(self.0.exp(), self.0.exp() * self.1)
    }

    pub fn ln(self) -> Self {
        Dual(self.0.ln(), self.1 / self.0)
    }

    pub fn sin(self) -> Self {
        Dual(self.0.sin(), self.0.cos() * self.1)
    }

    pub fn cos(self) -> Self {
        Dual(self.0.cos(), -self.0.sin() * self.1)
    }

    pub fn atan(self) -> Self {
        Dual(self.0.atan(), self.1 / (1.0 + self.0 * self.0))
    }

    pub fn powf(self, power: impl Into<Dual>) -> Self {
        (self.ln() * power.into()).exp()
    }
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        Dual(-self.0, -self.1)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, |$a:ident, $b:ident| $result:expr) => {
        impl<T: Into<Dual>> $trait<T> for Dual {
            type Output = Dual;
            fn $method(self, other: T) -> Dual {
                let ($a, $b) = (self, other.into());
                $result
            }
        }

        impl $trait<Dual> for f64 {
            type Output = Dual;
            fn $method(self, other: Dual) -> Dual {
                $trait::$method(Dual::from(self), other)
            }
        }
    };
}

operator!(Add, add, |a, b| Dual(a.0 + b.0, a.1 + b.1));
operator!(Sub, sub, |a, b| Dual(a.0 - b.0, a.1 - b.1));
operator!(Mul, mul, |a, b| Dual(a.0 * b.0, a.1 * b.0 + a.0 * b.1));
operator!(Div, div, |a, b| Dual(a.0 / b.0, (a.1 - a.0 / b.0 * b.1) / b.0));
