//! An operation as text: the syntax that all languages share, and that of each language.

use std::borrow::Cow;

use super::Locals;
use crate::expr::Function;
use crate::program::{Op, Program, Value};

/// The syntax of a language. The default functions are those of MATLAB and Modelica.
pub trait Language {
    /// A number with all its digits.
    fn number(&self, number: f64) -> String;
    /// A value with the other sign.
    fn negative(&self, a: &str) -> String {
        format!("-{a}")
    }
    /// Two values with an operator between them.
    fn operator(&self, a: &str, operator: Operator, b: &str) -> String {
        let sign = match operator {
            Operator::Add => '+',
            Operator::Sub => '-',
            Operator::Mul => '*',
            Operator::Div => '/',
        };
        format!("{a} {sign} {b}")
    }
    /// A function of a value.
    fn call(&self, function: Function, a: &str) -> String {
        format!("{}({a})", usual_name(function))
    }
    /// `a` to the power of `b`.
    fn power(&self, a: &str, b: &str) -> String {
        format!("{a} ^ {b}")
    }
    /// The smaller of two.
    fn smaller(&self, a: &str, b: &str) -> String {
        format!("min({a}, {b})")
    }
    /// The larger of two.
    fn larger(&self, a: &str, b: &str) -> String {
        format!("max({a}, {b})")
    }
    /// `a` if the test is above zero, else `b`.
    fn choice(&self, test: &str, a: &str, b: &str) -> String;
    /// The abscissa of a point of a curve.
    fn knot(&self, knot: f64) -> String {
        self.number(knot)
    }
    /// A derivative of a curve at `x`; the rows are abscissae, ordinates and slopes.
    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String;
}

/// An arithmetic operator.
#[derive(Clone, Copy)]
pub enum Operator {
    /// Plus.
    Add,
    /// Minus.
    Sub,
    /// Times.
    Mul,
    /// Divided by.
    Div,
}

/// The name of a function in most languages.
pub fn usual_name(function: Function) -> &'static str {
    match function {
        Function::Abs => "abs",
        Function::Sign => "sign",
        Function::Sqrt => "sqrt",
        Function::Exp => "exp",
        Function::Ln => "log",
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Tan => "tan",
        Function::Atan => "atan",
        Function::Tanh => "tanh",
    }
}

/// A program whose values have names, to be printed in a language.
pub struct ProgramText<'a> {
    /// The language.
    pub language: &'a dyn Language,
    /// The program.
    pub program: &'a Program,
    /// Names of the values.
    pub locals: &'a Locals,
}

impl ProgramText<'_> {
    /// A value as an operand: a number, or its variable.
    pub fn operand(&self, value: Value) -> Cow<'_, str> {
        match self.program.ops[value.0 as usize] {
            Op::Constant(number) => self.language.number(number).into(),
            _ => self.locals.name(value).into(),
        }
    }

    /// The expression that computes a value.
    pub fn operation(&self, value: Value) -> String {
        let at = |v: Value| self.operand(v);
        let operator = |a, operator, b| self.language.operator(&at(a), operator, &at(b));
        match self.program.ops[value.0 as usize] {
            Op::Constant(_) | Op::Input(_) | Op::Prepared(_) => at(value).into_owned(),
            Op::Neg(a) => self.language.negative(&at(a)),
            Op::Add(a, b) => operator(a, Operator::Add, b),
            Op::Sub(a, b) => operator(a, Operator::Sub, b),
            Op::Mul(a, b) => operator(a, Operator::Mul, b),
            Op::Div(a, b) => operator(a, Operator::Div, b),
            Op::Pow(a, b) => self.language.power(&at(a), &at(b)),
            Op::Min(a, b) => self.language.smaller(&at(a), &at(b)),
            Op::Max(a, b) => self.language.larger(&at(a), &at(b)),
            Op::Call(function, a) => self.language.call(function, &at(a)),
            Op::Select(test, a, b) => self.language.choice(&at(test), &at(a), &at(b)),
            Op::Table(order, x, curve) => {
                let curve = &self.program.curves[curve as usize];
                let entries = |values: &[Value]| values.iter().map(|&entry| at(entry).into()).collect();
                let knots = curve.knots().map(|knot| self.language.knot(knot)).collect();
                let rows = [knots, entries(&curve.values), entries(&curve.slopes)];
                self.language.table(order, &at(x), rows)
            }
        }
    }
}
