//! The printer writes what the parser reads, also for trees that a program made or changed.

use proptest::prelude::*;
use qcar_dsl::check::check_text;
use qcar_dsl::model::{Model, Term};
use qcar_dsl::parse::parse_text;
use qcar_dsl::source::{Source, Span};
use qcar_dsl::syntax::{
    Axle, Comparison, Coordinate, CoordinateKind, Dotted, Expression, ExpressionKind, File, Item, LawStatement, Let,
    Link, Logic, Name, Number, Operator, Order, Statement, UnitFactor, UnitText,
};

fn source(text: String) -> Source {
    Source {
        name: "printed.axle".to_string(),
        text,
    }
}

fn expression(kind: ExpressionKind) -> Expression {
    Expression {
        kind,
        span: Span::default(),
    }
}

fn name(text: &str) -> Expression {
    expression(ExpressionKind::Name(Dotted {
        names: vec![Name::new(text)],
    }))
}

fn binary(operator: Operator, left: Expression, right: Expression) -> Expression {
    expression(ExpressionKind::Binary(operator, Box::new(left), Box::new(right)))
}

/// Numbers with and without units, and names that are also symbols of units.
fn leaf() -> impl Strategy<Value = Expression> {
    let unit = |symbols: Vec<(&str, i32)>| {
        let factor = |(symbol, numerator): (&str, i32)| UnitFactor {
            symbol: Name::new(symbol),
            numerator,
            denominator: 1,
        };
        UnitText {
            factors: symbols.into_iter().map(factor).collect(),
            span: Span::default(),
        }
    };
    let units = vec![
        unit(vec![]),
        unit(vec![("mm", 1)]),
        unit(vec![("N", 1), ("m", -1)]),
        unit(vec![("s", -1)]),
    ];
    let number = (0..1000u32, proptest::sample::select(units)).prop_map(|(value, unit)| {
        let number = Number {
            unit,
            ..Number::new(f64::from(value) / 8.0)
        };
        expression(ExpressionKind::Number(number))
    });
    prop_oneof![
        number,
        proptest::sample::select(vec!["k", "s", "m", "v", "c_tire"]).prop_map(name)
    ]
}

fn tree() -> impl Strategy<Value = Expression> {
    use Operator::*;
    leaf().prop_recursive(5, 40, 3, |inner| {
        let operator = proptest::sample::select(vec![Add, Subtract, Multiply, Divide, Power]);
        let order = proptest::sample::select(vec![Order::Less, Order::LessEqual, Order::Greater, Order::GreaterEqual]);
        let test = (inner.clone(), order, inner.clone())
            .prop_map(|(left, order, right)| Logic::Test(Comparison { left, order, right }));
        let condition = prop_oneof![
            test.clone(),
            test.clone().prop_map(|a| Logic::Not(Box::new(a))),
            (test.clone(), test.clone(), test.clone())
                .prop_map(|(a, b, c)| Logic::And(Box::new(a), Box::new(Logic::Or(Box::new(b), Box::new(c))))),
        ];
        prop_oneof![
            (operator, inner.clone(), inner.clone()).prop_map(|(operator, a, b)| binary(operator, a, b)),
            inner
                .clone()
                .prop_map(|a| expression(ExpressionKind::Negative(Box::new(a)))),
            inner
                .clone()
                .prop_map(|a| expression(ExpressionKind::Call(Name::new("abs"), vec![a]))),
            (condition, inner.clone(), inner).prop_map(|(condition, a, b)| {
                expression(ExpressionKind::If(Box::new(condition), Box::new(a), Box::new(b)))
            }),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_expression_reads_back_as_itself(value in tree()) {
        let printed = value.to_string();
        let back = read(&printed);
        prop_assert!(back == value, "{printed} reads as {back}");
    }
}

/// The tree of an expression without mistakes.
fn read(text: &str) -> Expression {
    let parsed = parse_text(&source(format!("axle a {{ let x = {text}; }}")), 0);
    assert!(parsed.mistakes.is_empty(), "{text}: {:?}", parsed.mistakes);
    let Some(Item::Axle(Axle { body, .. })) = parsed.file.items.first() else {
        panic!("no axle")
    };
    let Some(Statement::Let(Let { value, .. })) = body.first() else {
        panic!("no let")
    };
    value.clone()
}

/// `m` and `s` are parameters here, not metre and second.
#[test]
fn a_divisor_is_not_printed_as_a_unit() {
    let newtons = || read("2 N");
    let quotient = |divisor: Expression| binary(Operator::Divide, newtons(), divisor).to_string();
    let product = || binary(Operator::Multiply, name("m"), name("s"));
    assert_eq!(quotient(name("m")), "2 N/(m)");
    assert_eq!(quotient(product()), "(2 N)/(m*s)");
    assert_eq!(quotient(binary(Operator::Multiply, name("m"), name("k"))), "2 N/(m*k)");
    for divisor in [name("m"), product(), binary(Operator::Divide, name("m"), name("s"))] {
        let printed = quotient(divisor.clone());
        assert!(
            read(&printed) == binary(Operator::Divide, newtons(), divisor),
            "{printed}"
        );
    }
}

const STRUT: &str = "axle strut {
    known param m: kg = 400;
    param k: N/m = 25e3;
    param c: N s/m = 1500;
    direction z {
        road pad;
        mass body = m;
        link strut: body - pad { spring k; damper c; }
    }
}
";

/// The statements of the direction of a file's only axle.
fn direction(file: &mut File) -> &mut Vec<Statement> {
    let Some(Item::Axle(axle)) = file.items.first_mut() else {
        panic!("no axle")
    };
    let inside = axle.body.iter_mut().find_map(|statement| match statement {
        Statement::Direction(direction) => Some(&mut direction.body),
        _ => None,
    });
    inside.expect("a direction")
}

fn strut(file: &mut File) -> &mut Link {
    let links = direction(file).iter_mut().filter_map(|statement| match statement {
        Statement::Link(link) => Some(link),
        _ => None,
    });
    links.last().expect("a link")
}

fn model(file: &File) -> Model {
    let checked = check_text(source(file.to_string()), &|_, _| Err("no files".to_string()));
    (*checked.unwrap_or_else(|report| panic!("{report}"))).clone()
}

#[test]
fn a_law_takes_one_more_term() {
    let mut file = parse_text(&source(STRUT.to_string()), 0).file;
    let friction = expression(ExpressionKind::Call(Name::new("sign"), vec![name("v")]));
    let force = binary(
        Operator::Multiply,
        expression(ExpressionKind::Number(newton(80.0))),
        friction,
    );
    strut(&mut file).body.push(LawStatement::Force(force));
    let link = &model(&file).links[0];
    assert!(matches!(
        link.law.terms[..],
        [Term::Spring(_), Term::Damper(_), Term::Force(_)]
    ));
    assert!(file.to_string().contains("            force = 80.0 N*sign(v);\n"));
}

fn newton(value: f64) -> Number {
    let factors = vec![UnitFactor {
        symbol: Name::new("N"),
        numerator: 1,
        denominator: 1,
    }];
    Number {
        unit: UnitText {
            factors,
            span: Span::default(),
        },
        ..Number::new(value)
    }
}

#[test]
fn a_link_is_split_by_a_node() {
    let mut file = parse_text(&source(STRUT.to_string()), 0).file;
    let lower = strut(&mut file).clone();
    strut(&mut file).stretch = binary(Operator::Subtract, name("body"), name("bushing"));
    strut(&mut file).body = vec![LawStatement::Spring(binary(
        Operator::Multiply,
        expression(ExpressionKind::Number(Number::new(20.0))),
        name("k"),
    ))];
    let node = Coordinate {
        kind: CoordinateKind::Node,
        name: Name::new("bushing"),
        angle: false,
        doc: String::new(),
    };
    let stretch = binary(Operator::Subtract, name("bushing"), name("pad"));
    let lower = Link {
        name: Name::new("strut_lower"),
        stretch,
        ..lower
    };
    direction(&mut file).insert(2, Statement::Coordinate(node));
    direction(&mut file).push(Statement::Link(lower));
    let model = model(&file);
    assert_eq!(model.coordinates.len(), 3);
    assert_eq!(
        model.links[1].declared.line,
        "link strut_lower: bushing - pad { spring k; damper c; }"
    );
}
