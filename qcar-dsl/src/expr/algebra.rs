//! Arithmetic on expressions as it is written on paper: `g.of(a - l * b)`.
//!
//! An operator only stores its operands; [`Graph::of`] creates the nodes, left operand first.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Expr, Function, Graph};

/// A formula that a graph can turn into an expression.
pub trait Formula {
    /// Its expression.
    fn of(self, g: &mut Graph) -> Expr;
}

impl Graph {
    /// The expression of a formula.
    pub fn of(&mut self, formula: impl Formula) -> Expr {
        formula.of(self)
    }
}

impl Formula for Expr {
    fn of(self, _: &mut Graph) -> Expr {
        self
    }
}

impl Formula for f64 {
    fn of(self, g: &mut Graph) -> Expr {
        g.constant(self)
    }
}

/// An operation on two formulas.
pub struct Binary<A, B>(fn(&mut Graph, Expr, Expr) -> Expr, A, B);

impl<A: Formula, B: Formula> Formula for Binary<A, B> {
    fn of(self, g: &mut Graph) -> Expr {
        let Binary(operation, a, b) = self;
        let (a, b) = (a.of(g), b.of(g));
        operation(g, a, b)
    }
}

/// A function of an expression.
pub struct Call(Function, Expr);

impl Formula for Call {
    fn of(self, g: &mut Graph) -> Expr {
        g.call(self.0, self.1)
    }
}

/// The negative of a formula.
pub struct Opposite<A>(A);

impl<A: Formula> Formula for Opposite<A> {
    fn of(self, g: &mut Graph) -> Expr {
        let a = self.0.of(g);
        g.neg(a)
    }
}

impl Neg for Expr {
    type Output = Opposite<Expr>;

    fn neg(self) -> Self::Output {
        Opposite(self)
    }
}

impl Neg for Call {
    type Output = Opposite<Call>;

    fn neg(self) -> Self::Output {
        Opposite(self)
    }
}

/// A whole power of an expression.
pub struct Power(Expr, i32);

impl Formula for Power {
    fn of(self, g: &mut Graph) -> Expr {
        g.powi(self.0, self.1)
    }
}

impl Function {
    /// The value at an expression.
    pub fn at(self, x: Expr) -> Call {
        Call(self, x)
    }
}

impl Expr {
    /// A whole power.
    pub fn power(self, n: i32) -> Power {
        Power(self, n)
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident $operation:ident)*) => { $(
        impl<B: Formula> $operator<B> for Expr {
            type Output = Binary<Expr, B>;

            fn $method(self, b: B) -> Self::Output {
                Binary(Graph::$operation, self, b)
            }
        }

        impl<B: Formula> $operator<B> for Power {
            type Output = Binary<Power, B>;

            fn $method(self, b: B) -> Self::Output {
                Binary(Graph::$operation, self, b)
            }
        }

        impl<A: Formula, B: Formula, C: Formula> $operator<C> for Binary<A, B> {
            type Output = Binary<Self, C>;

            fn $method(self, c: C) -> Self::Output {
                Binary(Graph::$operation, self, c)
            }
        }

        impl $operator<Expr> for f64 {
            type Output = Binary<f64, Expr>;

            fn $method(self, b: Expr) -> Self::Output {
                Binary(Graph::$operation, self, b)
            }
        }

        impl<A: Formula, B: Formula> $operator<Binary<A, B>> for f64 {
            type Output = Binary<f64, Binary<A, B>>;

            fn $method(self, b: Binary<A, B>) -> Self::Output {
                Binary(Graph::$operation, self, b)
            }
        }

        impl $operator<Power> for f64 {
            type Output = Binary<f64, Power>;

            fn $method(self, b: Power) -> Self::Output {
                Binary(Graph::$operation, self, b)
            }
        }
    )* };
}

operators! { Add add add  Sub sub sub  Mul mul mul  Div div div }

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn operators_make_the_nodes_that_calls_make() {
        let mut g = Graph::default();
        let [a, b, l] = [0, 1, 2].map(|place| g.symbol(Symbol::Parameter(place)));
        let (product, square) = (g.mul(l, b), g.powi(b, 2));
        let (difference, one) = (g.sub(a, product), g.constant(1.0));
        let sum = g.add(one, square);
        let quotient = g.div(difference, sum);
        assert_eq!(g.of((a - l * b) / (1.0 + b.power(2))), quotient);
    }
}
