//! Complex numbers as pairs of real expressions; structural zeros cost nothing.

use crate::derive::elimination::Scalar;
use crate::expr::{Differential, Expr, Graph};

/// `re + j im`
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Complex {
    /// Real part.
    pub re: Expr,
    /// Imaginary part.
    pub im: Expr,
}

impl Complex {
    /// A real number.
    pub fn real(g: &mut Graph, re: Expr) -> Self {
        Complex {
            re,
            im: g.constant(0.0),
        }
    }

    /// `-self`
    pub fn neg(self, g: &mut Graph) -> Self {
        Complex {
            re: g.of(-self.re),
            im: g.of(-self.im),
        }
    }

    /// The derivative of both parts.
    pub fn derivative(self, g: &mut Graph, by: &mut Differential) -> Self {
        Complex {
            re: by.of(g, self.re),
            im: by.of(g, self.im),
        }
    }
}

impl Scalar for Complex {
    fn zero(g: &mut Graph) -> Self {
        let zero = g.constant(0.0);
        Complex { re: zero, im: zero }
    }

    fn one(g: &mut Graph) -> Self {
        let one = g.constant(1.0);
        Complex::real(g, one)
    }

    fn is_zero(self, g: &Graph) -> bool {
        self.re.is_zero(g) && self.im.is_zero(g)
    }

    fn add(self, g: &mut Graph, other: Self) -> Self {
        Complex {
            re: g.of(self.re + other.re),
            im: g.of(self.im + other.im),
        }
    }

    fn sub(self, g: &mut Graph, other: Self) -> Self {
        Complex {
            re: g.of(self.re - other.re),
            im: g.of(self.im - other.im),
        }
    }

    fn mul(self, g: &mut Graph, other: Self) -> Self {
        let (rr, ii) = (g.of(self.re * other.re), g.of(self.im * other.im));
        let (ri, ir) = (g.of(self.re * other.im), g.of(self.im * other.re));
        Complex {
            re: g.of(rr - ii),
            im: g.of(ri + ir),
        }
    }

    /// Multiplies by the reciprocal, which all quotients with this divisor share.
    fn div(self, g: &mut Graph, other: Self) -> Self {
        let square = g.of(other.re * other.re + other.im * other.im);
        let (re, im) = (g.of(other.re / square), g.of(other.im / square));
        let reciprocal = Complex { re, im: g.of(-im) };
        self.mul(g, reciprocal)
    }

    fn scale(self, g: &mut Graph, factor: Expr) -> Self {
        Complex {
            re: g.of(factor * self.re),
            im: g.of(factor * self.im),
        }
    }
}
