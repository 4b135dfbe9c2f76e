//! The laws of expressions: identities leave values alone, and derivatives are slopes.

use proptest::prelude::*;
use qcar_dsl::expr::{CoordinateId, Differential, Expr, Function, Graph, Leaves, Substitution, Symbol};

use super::common;
use super::common::programs::FUNCTIONS;

/// An expression as it is written, before any identity.
#[derive(Clone, Debug)]
enum Written {
    Number(f64),
    Leaf(u16),
    Neg(Box<Written>),
    Powi(Box<Written>, i32),
    Call(Function, Box<Written>),
    Two(u8, Box<Written>, Box<Written>),
    Select(Box<Written>, Box<Written>, Box<Written>),
}

fn written() -> impl Strategy<Value = Written> {
    let numbers = prop_oneof![Just(0.0), Just(1.0), Just(-1.0), Just(2.0), -3.0..3.0f64];
    let leaf = prop_oneof![numbers.prop_map(Written::Number), (0..3u16).prop_map(Written::Leaf)];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let boxed = inner.prop_map(Box::new).boxed();
        prop_oneof![
            boxed.clone().prop_map(Written::Neg),
            (boxed.clone(), -2..4i32).prop_map(|(a, n)| Written::Powi(a, n)),
            (prop::sample::select(&FUNCTIONS[..]), boxed.clone()).prop_map(|(f, a)| Written::Call(f, a)),
            (0..7u8, boxed.clone(), boxed.clone()).prop_map(|(op, a, b)| Written::Two(op, a, b)),
            (boxed.clone(), boxed.clone(), boxed).prop_map(|(t, a, b)| Written::Select(t, a, b)),
        ]
    })
}

fn leaf(i: u16) -> Symbol {
    Symbol::Position(CoordinateId(i))
}

impl Written {
    fn intern(&self, g: &mut Graph) -> Expr {
        match self {
            Written::Number(x) => g.constant(*x),
            Written::Leaf(i) => g.symbol(leaf(*i)),
            Written::Neg(a) => {
                let a = a.intern(g);
                g.neg(a)
            }
            Written::Powi(a, n) => {
                let a = a.intern(g);
                g.powi(a, *n)
            }
            Written::Call(f, a) => {
                let a = a.intern(g);
                g.call(*f, a)
            }
            Written::Two(op, a, b) => {
                let (a, b) = (a.intern(g), b.intern(g));
                let build = [
                    Graph::add,
                    Graph::sub,
                    Graph::mul,
                    Graph::div,
                    Graph::pow,
                    Graph::min,
                    Graph::max,
                ];
                build[usize::from(*op)](g, a, b)
            }
            Written::Select(test, a, b) => {
                let (test, a, b) = (test.intern(g), a.intern(g), b.intern(g));
                g.select(test, a, b)
            }
        }
    }

    /// The value and its derivative along a direction of the leaves, by dual numbers.
    fn dual(&self, at: &[f64; 3], along: &[f64; 3]) -> (f64, f64) {
        let of = |a: &Written| a.dual(at, along);
        match self {
            Written::Number(x) => (*x, 0.0),
            Written::Leaf(i) => (at[usize::from(*i)], along[usize::from(*i)]),
            Written::Neg(a) => (-of(a).0, -of(a).1),
            Written::Powi(a, n) => {
                let (a, da) = of(a);
                (
                    a.powi(*n),
                    if *n == 0 {
                        0.0
                    } else {
                        f64::from(*n) * a.powi(n - 1) * da
                    },
                )
            }
            Written::Call(f, a) => {
                let (a, da) = of(a);
                let (value, slope) = match f {
                    Function::Abs => (a.abs(), if a == 0.0 { 0.0 } else { a.signum() }),
                    Function::Sign => (if a == 0.0 { 0.0 } else { a.signum() }, 0.0),
                    Function::Sqrt => (a.sqrt(), 0.5 / a.sqrt()),
                    Function::Exp => (a.exp(), a.exp()),
                    Function::Ln => (a.ln(), 1.0 / a),
                    Function::Sin => (a.sin(), a.cos()),
                    Function::Cos => (a.cos(), -a.sin()),
                    Function::Tan => (a.tan(), 1.0 / a.cos().powi(2)),
                    Function::Atan => (a.atan(), 1.0 / (1.0 + a * a)),
                    Function::Tanh => (a.tanh(), 1.0 / a.cosh().powi(2)),
                };
                (value, slope * da)
            }
            Written::Two(op, a, b) => {
                let ((a, da), (b, db)) = (of(a), of(b));
                match op {
                    0 => (a + b, da + db),
                    1 => (a - b, da - db),
                    2 => (a * b, da * b + a * db),
                    3 => (a / b, da / b - a * db / (b * b)),
                    4 => (
                        a.powf(b),
                        a.powf(b - 1.0) * b * da + if db == 0.0 { 0.0 } else { a.powf(b) * a.ln() * db },
                    ),
                    5 => {
                        if a < b {
                            (a, da)
                        } else {
                            (b, db)
                        }
                    }
                    _ => {
                        if a > b {
                            (a, da)
                        } else {
                            (b, db)
                        }
                    }
                }
            }
            Written::Select(test, a, b) => {
                if of(test).0 > 0.0 {
                    of(a)
                } else {
                    of(b)
                }
            }
        }
    }
}

/// True where neither overflow nor a pole nor the edge of a branch makes a comparison meaningless.
fn regular(x: f64) -> bool {
    x.is_finite() && x.abs() < 1e6
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
}

proptest! {
    #![proptest_config(common::cases(2000))]

    #[test]
    fn identities_leave_the_value_alone(e in written(), at in prop::array::uniform3(0.3..2.0f64)) {
        let mut g = Graph::default();
        let interned = e.intern(&mut g);
        let (want, _) = e.dual(&at, &[0.0; 3]);
        let got = g.evaluate(interned, &|s| at[(0..3).position(|i| leaf(i) == s).unwrap()]);
        prop_assume!(!kink(&e, &at));
        prop_assert!(close(got, want), "{got} {want}");
    }

    #[test]
    fn derivatives_are_those_of_dual_numbers(
        e in written(),
        at in prop::array::uniform3(0.3..2.0f64),
        along in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let mut g = Graph::default();
        let interned = e.intern(&mut g);
        let leaves: Leaves = (0..3).map(|i| (leaf(i), g.constant(along[usize::from(i)]))).collect();
        let derivative = Differential::new(leaves).of(&mut g, interned);
        let (_, want) = e.dual(&at, &along);
        let got = g.evaluate(derivative, &|s| at[(0..3).position(|i| leaf(i) == s).unwrap()]);
        prop_assume!(regular(want) && !kink(&e, &at));
        prop_assert!(close(got, want), "{got} {want}");
    }

    #[test]
    fn to_substitute_is_to_evaluate_elsewhere(e in written(), at in prop::array::uniform3(0.3..2.0f64)) {
        let mut g = Graph::default();
        let interned = e.intern(&mut g);
        let doubled: Leaves = (0..3)
            .map(|i| {
                let (two, x) = (g.constant(2.0), g.symbol(leaf(i)));
                (leaf(i), g.mul(two, x))
            })
            .collect();
        let substituted = Substitution::new(doubled).apply(&mut g, interned);
        let value = |e, scale: f64| g.evaluate(e, &|s| scale * at[(0..3).position(|i| leaf(i) == s).unwrap()]);
        let (got, want) = (value(substituted, 1.0), value(interned, 2.0));
        prop_assume!(!kink(&e, &at.map(|x| 2.0 * x)));
        prop_assert!(close(got, want), "{got} {want}");
    }
}

/// True where a branch or an operand is at or near its edge, or out of its domain: there a slope is a matter of taste.
fn kink(e: &Written, at: &[f64; 3]) -> bool {
    let near = |x: f64| !regular(x) || x.abs() < 1e-6;
    let value = |a: &Written| a.dual(at, &[0.0; 3]).0;
    match e {
        _ if !regular(value(e)) => true,
        Written::Number(_) | Written::Leaf(_) => false,
        Written::Neg(a) => kink(a, at),
        Written::Powi(a, _) | Written::Call(_, a) => near(value(a)) || kink(a, at),
        Written::Two(op, a, b) => {
            let edge = match op {
                3 => near(value(b)),
                4 => value(a) < 1e-6,
                5 | 6 => near(value(a) - value(b)),
                _ => false,
            };
            edge || kink(a, at) || kink(b, at)
        }
        Written::Select(test, a, b) => near(value(test)) || kink(test, at) || kink(a, at) || kink(b, at),
    }
}

/// What is the same by an identity is the same expression.
#[test]
fn identities_hold_at_birth() {
    let mut g = Graph::default();
    let [a, b, m] = [0, 1, 2].map(|i| g.symbol(leaf(i)));
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let (minus_a, minus_b) = (g.neg(a), g.neg(b));
    let (quotient, reciprocal, product, square) = (g.div(a, m), g.div(one, m), g.mul(a, b), g.powi(a, 2));
    let difference = g.sub(a, b);
    let minus_product = g.neg(product);
    #[rustfmt::skip]
    let laws = [
        ("a + 0 = a",         g.add(a, zero),             a),
        ("a + b = b + a",     g.add(a, b),                g.add(b, a)),
        ("a - a = 0",         g.sub(a, a),                zero),
        ("a + -b = a - b",    g.add(a, minus_b),          difference),
        ("-(a - b) = b - a",  g.neg(difference),          g.sub(b, a)),
        ("-(-a) = a",         g.neg(minus_a),             a),
        ("0 a = 0",           g.mul(zero, a),             zero),
        ("1 a = a",           g.mul(one, a),              a),
        ("-a b = -(a b)",     g.mul(minus_a, b),          minus_product),
        ("a a = a^2",         g.mul(a, a),                square),
        ("a / a = 1",         g.div(a, a),                one),
        ("a (1/m) = a / m",   g.mul(a, reciprocal),       quotient),
        ("a / (1/m) = a m",   g.div(a, reciprocal),       g.mul(a, m)),
        ("a b / b = a",       g.div(product, b),          a),
        ("(a^2)^3 = a^6",     g.powi(square, 3),          g.powi(a, 6)),
        ("(-a)^2 = a^2",      g.powi(minus_a, 2),         square),
        ("a^0 = 1",           g.powi(a, 0),               one),
    ];
    for (law, left, right) in laws {
        assert_eq!(left, right, "{law}");
    }
}
