//! The syntax of Rust for operations on numbers, and on vectors of numbers.

use crate::back::straight::{Language, Operator, usual_name};
use crate::expr::Function;

/// On plain numbers.
pub struct Numbers;

impl Language for Numbers {
    fn number(&self, number: f64) -> String {
        match number {
            _ if number.is_nan() => "f64::NAN".into(),
            _ if number == f64::INFINITY => "f64::INFINITY".into(),
            _ if number == f64::NEG_INFINITY => "f64::NEG_INFINITY".into(),
            _ => format!("{number:?}"),
        }
    }

    fn call(&self, function: Function, a: &str) -> String {
        match function {
            Function::Sign => format!("sign({a})"),
            other => format!("f64::{}({a})", name(other)),
        }
    }

    fn power(&self, a: &str, b: &str) -> String {
        format!("f64::powf({a}, {b})")
    }

    fn smaller(&self, a: &str, b: &str) -> String {
        format!("f64::min({a}, {b})")
    }

    fn larger(&self, a: &str, b: &str) -> String {
        format!("f64::max({a}, {b})")
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("if {test} > 0.0 {{ {a} }} else {{ {b} }}")
    }

    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
        format!("table({})", points(order, x, rows))
    }
}

/// Operations on vectors. Each is a function, since rustc inlines only functions that enable the same instructions, and
/// operators enable none.
pub struct Vectors;

impl Language for Vectors {
    fn number(&self, number: f64) -> String {
        format!("V::of({})", self.knot(number))
    }

    fn negative(&self, a: &str) -> String {
        format!("V::neg({a})")
    }

    fn operator(&self, a: &str, operator: Operator, b: &str) -> String {
        let name = match operator {
            Operator::Add => "add",
            Operator::Sub => "sub",
            Operator::Mul => "mul",
            Operator::Div => "div",
        };
        format!("V::{name}({a}, {b})")
    }

    fn call(&self, function: Function, a: &str) -> String {
        format!("V::{}({a})", name(function))
    }

    fn power(&self, a: &str, b: &str) -> String {
        format!("V::powf({a}, {b})")
    }

    fn smaller(&self, a: &str, b: &str) -> String {
        format!("V::min({a}, {b})")
    }

    fn larger(&self, a: &str, b: &str) -> String {
        format!("V::max({a}, {b})")
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("V::choose({test}, {a}, {b})")
    }

    /// The same in every lane.
    fn knot(&self, knot: f64) -> String {
        Numbers.number(knot)
    }

    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
        format!("V::table({})", points(order, x, rows))
    }
}

/// The name of a function in Rust.
fn name(function: Function) -> &'static str {
    match function {
        Function::Ln => "ln",
        other => usual_name(other),
    }
}

/// Number of points of a table in one line.
const ENTRIES: usize = 8;

/// The arguments of a table; each row begins on a new line.
fn points(order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
    let row = |entries: Vec<String>| {
        let lines: Vec<String> = entries.chunks(ENTRIES).map(|line| line.join(", ")).collect();
        format!("    &[{}]", lines.join(",\n      "))
    };
    format!("{order}, {x},\n{}", rows.map(row).join(",\n"))
}
