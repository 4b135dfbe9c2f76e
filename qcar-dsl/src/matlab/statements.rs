//! A straight-line program as statements of MATLAB, and what they stand on.

use std::borrow::Cow;

use crate::expr::{self, Curve};
use crate::program::{Op, Program, Value};
use crate::straight::{Leaf, Locals, Pieces, op};

/// A program in one piece, with the names of its values.
pub struct Statements<'a> {
    pub cut: &'a Pieces<'a>,
    pub locals: &'a Locals,
}

impl Statements<'_> {
    /// All statements; `read` says where a leaf is read, and `target` where a result goes and what it is.
    pub fn all(&self, read: &dyn Fn(Leaf) -> String, target: &dyn Fn(usize) -> (String, String)) -> String {
        let leaves = self.cut.read(0).into_iter();
        let leaves = leaves.map(|(leaf, value)| format!("{} = {};", self.locals.name(value), read(leaf)));
        let store = |place: usize, value: Value| {
            let (to, what) = target(place);
            format!("{to} = {}; % {what}", self.operand(value))
        };
        let stored = self.cut.stored(0).into_iter().map(|(place, value)| store(place, value));
        let computed = self.cut.pieces[0].iter().flat_map(|&value| {
            let computed = format!("{} = {};", self.locals.name(value), self.operation(value));
            let stored = self.locals.results(value).map(move |place| store(place, value));
            [computed].into_iter().chain(stored)
        });
        let lines = leaves.chain(stored).chain(computed);
        lines.map(|statement| format!("    {statement}\n")).collect()
    }

    fn operand(&self, value: Value) -> Cow<'_, str> {
        match op(self.cut.program, value) {
            Op::Constant(constant) => number(constant).into(),
            _ => self.locals.name(value).into(),
        }
    }

    fn operation(&self, value: Value) -> String {
        let at = |v: Value| self.operand(v);
        match op(self.cut.program, value) {
            Op::Constant(_) | Op::Input(_) | Op::Prepared(_) => at(value).into_owned(),
            Op::Neg(a) => format!("-{}", at(a)),
            Op::Add(a, b) => format!("{} + {}", at(a), at(b)),
            Op::Sub(a, b) => format!("{} - {}", at(a), at(b)),
            Op::Mul(a, b) => format!("{} * {}", at(a), at(b)),
            Op::Div(a, b) => format!("{} / {}", at(a), at(b)),
            Op::Pow(a, b) => format!("{} ^ {}", at(a), at(b)),
            Op::Min(a, b) => format!("min({}, {})", at(a), at(b)),
            Op::Max(a, b) => format!("max({}, {})", at(a), at(b)),
            Op::Call(f, a) => format!("{}({})", called(f), at(a)),
            Op::Select(test, a, b) => format!("choose({}, {}, {})", at(test), at(a), at(b)),
            Op::Table(order, x, curve) => self.table(order, x, &self.cut.program.curves[curve as usize]),
        }
    }

    fn table(&self, order: u8, x: Value, curve: &Curve<Value>) -> String {
        let entries = |values: &[Value]| values.iter().map(|&entry| self.operand(entry).into()).collect();
        let rows: [Vec<String>; 3] = [
            curve.knots().map(number).collect(),
            entries(&curve.values),
            entries(&curve.slopes),
        ];
        let rows = rows.map(|entries| format!("[{}]", entries.join(", "))).join(", ");
        format!("curve_at({order}, {}, {rows})", self.operand(x))
    }
}

fn called(function: expr::Function) -> &'static str {
    match function {
        expr::Function::Abs => "abs",
        expr::Function::Sign => "sign",
        expr::Function::Sqrt => "sqrt",
        expr::Function::Exp => "exp",
        expr::Function::Ln => "log",
        expr::Function::Sin => "sin",
        expr::Function::Cos => "cos",
        expr::Function::Tan => "tan",
        expr::Function::Atan => "atan",
        expr::Function::Tanh => "tanh",
    }
}

/// A number, to every digit; a negative one in parentheses, since `^` binds more tightly than `-`.
fn number(number: f64) -> String {
    match number {
        _ if number.is_nan() => "NaN".into(),
        _ if number.is_infinite() => if number > 0.0 { "Inf" } else { "(-Inf)" }.into(),
        _ if number.is_sign_negative() => format!("({number:?})"),
        _ => format!("{number:?}"),
    }
}

/// A text between quotes.
pub fn text(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}

/// The functions that a program uses.
pub fn support(program: &Program) -> String {
    let any = |is: fn(&Op) -> bool| program.ops.iter().any(is);
    let parts = [
        (any(|op| matches!(op, Op::Select(..))), CHOOSE),
        (any(|op| matches!(op, Op::Table(..))), CURVE),
    ];
    parts.iter().filter(|(used, _)| *used).map(|(_, text)| *text).collect()
}

const CHOOSE: &str = "
function r = choose(test, a, b)
    if test > 0, r = a; else, r = b; end
end
";

const CURVE: &str = "
% A derivative of the piecewise cubic curve through points; beyond its ends it is a straight line.
function r = curve_at(order, x, knots, values, slopes)
    behind = sum(knots <= x);
    left = max(behind, 1);
    t = x - knots(left);
    square = 0;
    cube = 0;
    if behind > 0 && behind < numel(knots)
        width = knots(left + 1) - knots(left);
        secant = (values(left + 1) - values(left)) / width;
        square = (3 * secant - 2 * slopes(left) - slopes(left + 1)) / width;
        cube = (slopes(left) + slopes(left + 1) - 2 * secant) / (width * width);
    end
    switch order
        case 0
            r = values(left) + t * (slopes(left) + t * (square + t * cube));
        case 1
            r = slopes(left) + t * (2 * square + t * (3 * cube));
        case 2
            r = 2 * square + t * (6 * cube);
        otherwise
            r = 6 * cube;
    end
end
";
