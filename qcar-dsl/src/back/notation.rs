//! Notations of expressions: for a terminal and for LaTeX.

use std::collections::BTreeMap;

use crate::expr::{CoordinateId, Curve, Expr, Function, Graph, LinkId, Node, Symbol};
use crate::model::{Direction, Model, Quantity};

/// A way of writing mathematics.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Notation {
    /// Unicode for a terminal: `k/mr² s`.
    Text,
    /// LaTeX mathematics with amsmath: `\frac{k}{mr^{2}} s`.
    Latex,
}

/// Writes expressions of one model in one notation.
pub struct Writer<'a> {
    model: &'a Model,
    graph: &'a Graph,
    notation: Notation,
    names: BTreeMap<Expr, String>,
}

/// A term of a sum: a product and its sign.
#[derive(Clone)]
pub struct Summand {
    /// True if the product is subtracted.
    pub negative: bool,
    /// The factors of the product.
    pub factors: Vec<Expr>,
    /// A link whose named force is a further factor.
    pub link: Option<LinkId>,
}

impl Summand {
    /// `± first · rest`. The sign of `first` becomes that of the term, and `mr - 1` becomes `-(1 - mr)`.
    pub fn signed(graph: &mut Graph, negative: bool, first: Expr, rest: &[Expr]) -> Summand {
        let (opposite, magnitude) = match graph.node(first) {
            Node::Neg(a) => (true, a),
            Node::Constant(bits) if f64::from_bits(bits) < 0.0 => (true, graph.constant(-f64::from_bits(bits))),
            Node::Add(a, b) if graph.as_constant(a).is_some_and(|value| value < 0.0) => {
                let less = graph.neg(a);
                (true, graph.sub(less, b))
            }
            Node::Sub(a, b) if graph.as_constant(b).is_some() => (true, graph.sub(b, a)),
            _ => (false, first),
        };
        Summand {
            negative: negative != opposite,
            factors: [&[magnitude], rest].concat(),
            link: None,
        }
    }
}

/// Precedence of an expression. A weaker one gets parentheses inside a stronger one.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Quotient,
    Power,
    Atom,
}

impl<'a> Writer<'a> {
    /// A writer for expressions of `graph`, which extends that of the model.
    pub fn new(model: &'a Model, graph: &'a Graph, notation: Notation) -> Writer<'a> {
        Writer {
            model,
            graph,
            notation,
            names: BTreeMap::new(),
        }
    }

    /// Gives `e` a name, which is written from now on. Leaves and numbers keep theirs.
    pub fn name(&mut self, e: Expr, name: &str) {
        if !matches!(self.graph.node(e), Node::Constant(_) | Node::Symbol(_)) {
            let written = self.identifier(name);
            self.names.entry(e).or_insert(written);
        }
    }

    /// An expression.
    pub fn write(&self, e: Expr) -> String {
        match self.names.get(&e) {
            Some(name) => name.clone(),
            None => self.expand(e),
        }
    }

    /// An expression whose outermost operation is written out even if it has a name: the right-hand side of its
    /// definition.
    pub fn expand(&self, e: Expr) -> String {
        match self.graph.node(e) {
            Node::Constant(bits) => number(f64::from_bits(bits), self.notation),
            Node::Symbol(symbol) => self.symbol(symbol),
            Node::Neg(a) => format!("-{}", self.inside(a, Binding::Product)),
            Node::Add(a, b) if self.is_negative(a) => {
                format!(
                    "{} - {}",
                    self.inside(b, Binding::Sum),
                    number(-self.graph.as_constant(a).unwrap_or(0.0), self.notation)
                )
            }
            Node::Add(a, b) => format!("{} + {}", self.inside(a, Binding::Sum), self.addend(b)),
            Node::Sub(a, b) => format!(
                "{} - {}",
                self.inside(a, Binding::Sum),
                self.inside(b, Binding::Product)
            ),
            Node::Mul(a, b) => {
                let mut factors = Vec::new();
                self.factors(a, &mut factors);
                self.factors(b, &mut factors);
                self.product(&factors, None)
            }
            Node::Div(a, b) => self.quotient(a, b),
            Node::Powi(a, n) => self.power(a, n),
            Node::Pow(a, b) => self.function("pow", &[a, b]),
            Node::Min(a, b) => self.function("min", &[a, b]),
            Node::Max(a, b) => self.function("max", &[a, b]),
            Node::Call(Function::Abs, a) => self.magnitude(a),
            Node::Call(f, a) => self.function(function_name(f), &[a]),
            Node::Select(test, positive, otherwise) => self.select(test, positive, otherwise),
            Node::Table(order, x, curve) => self.table(order, x, self.graph.curve(curve)),
        }
    }

    /// A derivative of a curve, with a prime for each order, and with its slopes if they do not follow from the
    /// ordinates.
    fn table(&self, order: u8, x: Expr, curve: &Curve<Expr>) -> String {
        let list = |entries: Vec<String>| format!("[{}]", entries.join(", "));
        let knots = list(curve.knots().map(|knot| number(knot, self.notation)).collect());
        let entries = |entries: &[Expr]| list(entries.iter().map(|&entry| self.write(entry)).collect());
        let mut arguments = vec![self.write(x), knots, entries(&curve.values)];
        if !curve.monotone {
            arguments.push(entries(&curve.slopes));
        }
        let (arguments, primes) = (arguments.join(", "), "'".repeat(order.into()));
        match self.notation {
            Notation::Latex => format!(r"\operatorname{{table}}{primes}{}", self.parentheses(&arguments)),
            Notation::Text => format!("table{primes}({arguments})"),
        }
    }

    /// The terms of a sum, each with its sign in front: `-a`, `+ b`, `- c`; `0` for an empty sum.
    pub fn sum(&self, summands: &[Summand]) -> Vec<String> {
        if summands.is_empty() {
            return vec!["0".into()];
        }
        let signed = |(place, summand): (usize, &Summand)| {
            let sign = match (place, summand.negative) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => "+ ",
                (_, true) => "- ",
            };
            format!("{sign}{}", self.product(&summand.factors, summand.link))
        };
        summands.iter().enumerate().map(signed).collect()
    }

    /// A product of factors and of the named force of a link: numbers first, equal factors as powers.
    pub fn product(&self, factors: &[Expr], link: Option<LinkId>) -> String {
        let mut powers: Vec<(Expr, i32)> = Vec::new();
        for &factor in factors.iter().filter(|&&f| self.graph.as_constant(f) != Some(1.0)) {
            match powers.iter_mut().find(|(known, _)| *known == factor) {
                Some((_, power)) => *power += 1,
                None => powers.push((factor, 1)),
            }
        }
        powers.sort_by_key(|&(factor, _)| self.graph.as_constant(factor).is_none());
        let tight = if self.notation == Notation::Latex {
            Binding::Product
        } else {
            Binding::Power
        };
        let force = link.map(|link| self.of_link("F", link));
        let written = powers.iter().map(|&(factor, power)| match power {
            1 if powers.len() == 1 && force.is_none() => self.inside(factor, Binding::Product),
            1 => self.inside(factor, tight),
            _ => self.power(factor, power),
        });
        let written: Vec<String> = written.chain(force.clone()).collect();
        let joint = match self.notation {
            Notation::Text => " ",
            Notation::Latex => r"\,",
        };
        if written.is_empty() {
            "1".into()
        } else {
            written.join(joint)
        }
    }

    /// An expression after a `+`: a sum needs parentheses only if it starts with a sign.
    fn addend(&self, e: Expr) -> String {
        let written = self.write(e);
        let is_open = written.starts_with('-') || matches!(self.graph.node(e), Node::Select(..));
        if is_open { self.parentheses(&written) } else { written }
    }

    /// A leaf.
    pub fn symbol(&self, symbol: Symbol) -> String {
        let model = self.model;
        match symbol {
            Symbol::Parameter(i) => self.identifier(&model.parameters[i as usize].name),
            Symbol::Position(c) => self.motion(c, 0),
            Symbol::Offset(c) if self.notation == Notation::Latex => format!(r"\Delta {}", self.motion(c, 0)),
            Symbol::Offset(c) => format!("Δ{}", self.motion(c, 0)),
            Symbol::Velocity(c) => self.motion(c, 1),
            Symbol::Acceleration(c) => self.motion(c, 2),
            Symbol::Stretch(l) => self.of_link("s", l),
            Symbol::Rate(l) => self.of_link("v", l),
            Symbol::LinkForce(l) => self.of_link("F", l),
            Symbol::Inner(l, i) => self.inner(l, i),
            Symbol::Force(i) => self.identifier(&model.forces[i as usize].name),
            Symbol::Gravity(i) => self.identifier(&model.gravities[i as usize].name),
            Symbol::ContactForce(i) => self.identifier(&format!("F_contact_{i}")),
            Symbol::Frequency => if self.notation == Notation::Latex {
                r"\omega"
            } else {
                "ω"
            }
            .into(),
        }
    }

    /// A quantity of a link: `F_tire`, with its direction if two links have the same name.
    pub fn of_link(&self, letter: &str, link: LinkId) -> String {
        let link = &self.model.links[link.0 as usize];
        let shared = self.model.links.iter().filter(|other| other.name == link.name).count() > 1;
        match shared {
            true => self.identifier(&format!("{letter}_{}_{}", link.name, link.direction.0)),
            false => self.identifier(&format!("{letter}_{}", link.name)),
        }
    }

    /// An inner state: `maxwell_f_mount`.
    fn inner(&self, link: LinkId, place: u16) -> String {
        let inner = &self.model.links[link.0 as usize].law.inner[place as usize];
        self.of_link(&inner.name.replace('.', "_"), link)
    }

    /// A coordinate or its derivative: `z_body`, `ż_body`, `z̈_body`; an angle has the letter φ.
    fn motion(&self, c: CoordinateId, order: usize) -> String {
        let coordinate = &self.model.coordinates[c.0 as usize];
        self.moving(coordinate.angle, &coordinate.direction, &coordinate.name, order)
    }

    /// A motion of a point, given by its position in `Model::points`.
    pub fn of_point(&self, place: u16, quantity: Quantity) -> String {
        let point = &self.model.points[usize::from(place)];
        self.moving(point.angle, &point.direction, &point.name, quantity as usize)
    }

    fn moving(&self, angle: bool, direction: &Direction, name: &str, order: usize) -> String {
        let latex = self.notation == Notation::Latex;
        let letter = match (angle, latex) {
            (true, true) => r"\varphi",
            (true, false) => "φ",
            _ => &direction.0,
        };
        match latex {
            true => {
                let dotted = [
                    letter.into(),
                    format!(r"\dot{{{letter}}}"),
                    format!(r"\ddot{{{letter}}}"),
                ];
                format!("{}_{{{}}}", dotted[order], upright(name))
            }
            false => format!("{letter}{}_{}", ["", "\u{307}", "\u{308}"][order], name),
        }
    }

    /// A name: in LaTeX the first part is the letter and the rest its index, `k_{\mathrm{wheel},z}`.
    pub fn identifier(&self, name: &str) -> String {
        if self.notation != Notation::Latex {
            return name.into();
        }
        match name.split_once('_') {
            Some((letter, index)) => format!("{}_{{{}}}", letter_or_word(letter), upright(index)),
            None => letter_or_word(name),
        }
    }

    /// The sign for a whole row or column.
    pub fn any(&self) -> &'static str {
        if self.notation == Notation::Latex {
            r"\cdot"
        } else {
            "·"
        }
    }

    /// The time derivative of a written expression.
    pub fn derivative(&self, written: &str) -> String {
        match self.notation {
            Notation::Latex => format!(r"\frac{{\mathrm{{d}}}}{{\mathrm{{d}}t}} {written}"),
            _ => format!("d/dt {written}"),
        }
    }

    /// The ratio of two written expressions.
    pub fn ratio(&self, above: &str, below: &str) -> String {
        match self.notation {
            Notation::Latex => format!(r"\frac{{{above}}}{{{below}}}"),
            _ => format!("{above} / {below}"),
        }
    }

    fn is_negative(&self, e: Expr) -> bool {
        self.graph.as_constant(e).is_some_and(|value| value < 0.0)
    }

    fn binding(&self, e: Expr) -> Binding {
        if self.names.contains_key(&e) {
            return Binding::Atom;
        }
        match self.graph.node(e) {
            Node::Neg(_) | Node::Add(..) | Node::Sub(..) => Binding::Sum,
            Node::Select(..) if self.notation == Notation::Text => Binding::Sum,
            Node::Mul(..) => Binding::Product,
            Node::Div(..) if self.notation == Notation::Latex => Binding::Product,
            Node::Div(..) => Binding::Quotient,
            Node::Powi(..) => Binding::Power,
            Node::Constant(bits) if f64::from_bits(bits) < 0.0 => Binding::Sum,
            _ => Binding::Atom,
        }
    }

    fn inside(&self, e: Expr, at_least: Binding) -> String {
        match self.binding(e) >= at_least {
            true => self.write(e),
            false => self.parentheses(&self.write(e)),
        }
    }

    fn parentheses(&self, inner: &str) -> String {
        match self.notation {
            Notation::Latex => format!(r"\left({inner}\right)"),
            _ => format!("({inner})"),
        }
    }

    fn factors(&self, e: Expr, into: &mut Vec<Expr>) {
        match self.graph.node(e) {
            Node::Mul(a, b) if !self.names.contains_key(&e) => {
                self.factors(a, into);
                self.factors(b, into);
            }
            _ => into.push(e),
        }
    }

    fn quotient(&self, a: Expr, b: Expr) -> String {
        match self.notation {
            Notation::Latex => format!(r"\frac{{{}}}{{{}}}", self.write(a), self.write(b)),
            _ => format!(
                "{}/{}",
                self.inside(a, Binding::Product),
                self.inside(b, Binding::Power)
            ),
        }
    }

    fn power(&self, a: Expr, n: i32) -> String {
        let base = self.inside(a, Binding::Atom);
        match self.notation {
            Notation::Latex => format!("{base}^{{{n}}}"),
            Notation::Text => format!("{base}{}", superscript(n)),
        }
    }

    fn magnitude(&self, a: Expr) -> String {
        match self.notation {
            Notation::Text => format!("|{}|", self.write(a)),
            Notation::Latex => format!(r"\left|{}\right|", self.write(a)),
        }
    }

    fn function(&self, name: &str, arguments: &[Expr]) -> String {
        let arguments = arguments.iter().map(|&a| self.write(a)).collect::<Vec<_>>().join(", ");
        match self.notation {
            Notation::Latex => format!(r"\operatorname{{{name}}}{}", self.parentheses(&arguments)),
            _ => format!("{name}({arguments})"),
        }
    }

    fn select(&self, test: Expr, positive: Expr, otherwise: Expr) -> String {
        let [test, positive, otherwise] = [test, positive, otherwise].map(|e| self.write(e));
        match self.notation {
            Notation::Latex => {
                format!(r"\begin{{cases}} {positive} & {test} > 0 \\ {otherwise} & \text{{otherwise}} \end{{cases}}")
            }
            _ => format!("if {test} > 0 {{ {positive} }} else {{ {otherwise} }}"),
        }
    }
}

/// The name of a function in all notations.
fn function_name(f: Function) -> &'static str {
    match f {
        Function::Abs => "abs",
        Function::Sign => "sign",
        Function::Sqrt => "sqrt",
        Function::Exp => "exp",
        Function::Ln => "ln",
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Tan => "tan",
        Function::Atan => "atan",
        Function::Tanh => "tanh",
    }
}

/// The shortest decimal that reads back as the same number.
pub fn number(value: f64, notation: Notation) -> String {
    let shortest = format!("{value:?}");
    let shortest = shortest.strip_suffix(".0").unwrap_or(&shortest);
    match (shortest.split_once('e'), notation) {
        (Some((mantissa, exponent)), Notation::Latex) => format!(r"{mantissa} \cdot 10^{{{exponent}}}"),
        _ => shortest.into(),
    }
}

fn superscript(n: i32) -> String {
    n.to_string()
        .chars()
        .map(|digit| match digit {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            _ => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).expect("superscript digits are consecutive"),
        })
        .collect()
}

fn letter_or_word(name: &str) -> String {
    match name.len() {
        1 => name.into(),
        _ => upright(name),
    }
}

/// Words of an index in upright type, single letters in italics: `wheel_z` gives `\mathrm{wheel},z`.
fn upright(index: &str) -> String {
    let part = |part: &str| {
        if part.len() == 1 {
            part.to_string()
        } else {
            format!(r"\mathrm{{{part}}}")
        }
    };
    index
        .split('_')
        .filter(|part| !part.is_empty())
        .map(part)
        .collect::<Vec<_>>()
        .join(",")
}
