//! The syntax tree: what a model file says, statement by statement.
//!
//! Every part is public, so that a program can build or change it: a patch adds statements to a body or terms to a
//! link. A part that comes from no file has the default [`Span`]. Two trees are equal if their content is equal;
//! positions do not count.

use crate::source::Span;

// Effects, which change a model.
mod effect;

pub use effect::{Change, Effect, EffectParameter, Form, Pattern, PlaceKind, Role, VanishesAt};

/// A name, or a word that selects a value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Name {
    /// As written.
    pub text: String,
    /// Its position.
    pub span: Span,
}

impl Name {
    /// A name that comes from no file.
    pub fn new(text: impl Into<String>) -> Name {
        Name {
            text: text.into(),
            span: Span::default(),
        }
    }
}

/// A model file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// In the order of the text.
    pub items: Vec<Item>,
}

/// An item at the outermost level of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A model, or a family of models.
    Axle(Axle),
    /// A reusable law.
    Element(Element),
    /// A patch of a model.
    Effect(Box<Effect>),
}

/// A model, or a family of models.
#[derive(Clone, Debug, PartialEq)]
pub struct Axle {
    /// `axle`, `family`, or an axle chosen from a family.
    pub kind: AxleKind,
    /// The name.
    pub name: Name,
    /// The sentence; may be empty.
    pub doc: String,
    /// In the order of the text.
    pub body: Vec<Statement>,
}

/// How a model is declared.
#[derive(Clone, Debug, PartialEq)]
pub enum AxleKind {
    /// `axle NAME { … }`
    Plain,
    /// `family NAME { … }`
    Family,
    /// `axle NAME from "path" { … }`: the family's statements with options chosen, then its own.
    From(Path),
}

/// The path of a file, as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Relative to the file that contains it.
    pub text: String,
    /// Its position.
    pub span: Span,
}

/// `element NAME(argument: unit, …) { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// The name.
    pub name: Name,
    /// The arguments with their units.
    pub arguments: Vec<(Name, UnitText)>,
    /// The sentence; may be empty.
    pub doc: String,
    /// The law.
    pub body: Vec<LawStatement>,
}

/// A statement of a family, an axle or a direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// `option NAME: value | value = default "sentence";`
    Option(Choice),
    /// `require condition "sentence";`
    Require(Requirement),
    /// `option = value;` of an axle that is chosen from a family.
    Choose(Name, Name),
    /// `param NAME: unit = default in low..high "sentence";`
    Parameter(Parameter),
    /// `let NAME = expression "sentence";`
    Let(Let),
    /// `if condition { … } else { … }`
    If(If<Statement>),
    /// `direction NAME { … }`
    Direction(Direction),
    /// A mass, inertia, node, road or motion.
    Coordinate(Coordinate),
    /// `gravity NAME;`
    Gravity(Name),
    /// `force NAME on point;` or `force NAME on upper - lower;`; `force NAME;` acts through laws alone.
    Force(Name, Option<Expression>),
    /// `point NAME = point;` or `point NAME = body + arm*pitch;`
    Point(Name, Expression),
    /// `link NAME: stretch { … }`
    Link(Link),
    /// `output point.acceleration;` or `output NAME = point.acceleration;`
    Output(Option<Name>, Dotted),
    /// `channel NAME = signal / signal;`
    Channel(Name, Dotted, Dotted),
}

impl Statement {
    /// The name that a statement declares, if any.
    pub fn name(&self) -> Option<&Name> {
        match self {
            Statement::Option(choice) => Some(&choice.name),
            Statement::Parameter(parameter) => Some(&parameter.name),
            Statement::Let(definition) => Some(&definition.name),
            Statement::Direction(direction) => Some(&direction.name),
            Statement::Coordinate(coordinate) => Some(&coordinate.name),
            Statement::Link(link) => Some(&link.name),
            Statement::Gravity(name) | Statement::Force(name, _) | Statement::Point(name, _) => Some(name),
            Statement::Output(name, _) => name.as_ref(),
            Statement::Channel(name, ..) => Some(name),
            Statement::Require(_) | Statement::Choose(..) | Statement::If(_) => None,
        }
    }
}

/// An option of a family.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The name.
    pub name: Name,
    /// Its possible values.
    pub values: Vec<Name>,
    /// The value if an axle does not choose one. Without a default, every axle must choose.
    pub default: Option<Name>,
    /// The sentence; may be empty.
    pub doc: String,
}

/// A condition that the chosen options must fulfil.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// Position of the word `require`.
    pub span: Span,
    /// The condition.
    pub condition: Logic<OptionTest>,
    /// The reason.
    pub message: String,
}

/// A condition over tests of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Logic<Test> {
    /// One test.
    Test(Test),
    /// `!a`
    Not(Box<Logic<Test>>),
    /// `a && b`
    And(Box<Logic<Test>>, Box<Logic<Test>>),
    /// `a || b`
    Or(Box<Logic<Test>>, Box<Logic<Test>>),
}

impl<Test> Logic<Test> {
    /// The leftmost test.
    pub fn first_test(&self) -> &Test {
        match self {
            Logic::Test(test) => test,
            Logic::Not(part) | Logic::And(part, _) | Logic::Or(part, _) => part.first_test(),
        }
    }
}

/// `option == value` or `option != value`
#[derive(Clone, Debug, PartialEq)]
pub struct OptionTest {
    /// On the left.
    pub option: Name,
    /// `==`, not `!=`.
    pub equal: bool,
    /// On the right.
    pub value: Name,
}

/// `if … { … } else if … { … } else { … }` around statements.
#[derive(Clone, Debug, PartialEq)]
pub struct If<Part> {
    /// Conditions with their parts; the first one that is true is chosen.
    pub branches: Vec<(Logic<OptionTest>, Vec<Part>)>,
    /// Chosen if no condition is true.
    pub otherwise: Vec<Part>,
}

/// A parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `known param`
    pub known: bool,
    /// `clock param`, which is known too.
    pub clock: bool,
    /// The name.
    pub name: Name,
    /// The declared unit.
    pub unit: UnitText,
    /// The value if none is given.
    pub default: Option<ParameterDefault>,
    /// Lower and upper bound.
    pub range: Option<(Number, Number)>,
    /// The sentence; may be empty.
    pub doc: String,
}

/// The default of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterDefault {
    /// A value.
    Number(Number),
    /// The value of another parameter.
    Same(Name),
}

/// A number as written, with its unit where it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The digits, with a leading `-` for a negative bound of a range. In an expression, the sign is an operator.
    pub digits: String,
    /// Their value.
    pub value: f64,
    /// Empty for a plain number.
    pub unit: UnitText,
    /// Its position.
    pub span: Span,
}

impl Number {
    /// A number that comes from no file.
    pub fn new(value: f64) -> Number {
        Number {
            digits: format!("{value:?}"),
            value,
            unit: UnitText::default(),
            span: Span::default(),
        }
    }
}

/// A unit as written: a product of symbols with exponents.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitText {
    /// Positive exponents first. Empty for the unit `1`, and for a number without a unit.
    pub factors: Vec<UnitFactor>,
    /// Its position.
    pub span: Span,
}

/// A symbol of a unit with its exponent.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitFactor {
    /// For example `kN`.
    pub symbol: Name,
    /// Numerator of the exponent; negative if the symbol is in the denominator of the unit.
    pub numerator: i32,
    /// Denominator of the exponent, positive.
    pub denominator: i32,
}

/// A derived quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// The name.
    pub name: Name,
    /// Its value.
    pub value: Expression,
    /// The sentence; may be empty.
    pub doc: String,
}

/// The statements of one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// For example `z`.
    pub name: Name,
    /// In the order of the text.
    pub body: Vec<Statement>,
}

/// A mass, inertia, node, road or motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// What moves it.
    pub kind: CoordinateKind,
    /// The name.
    pub name: Name,
    /// `NAME: angle`; an inertia is always an angle.
    pub angle: bool,
    /// The sentence; may be empty.
    pub doc: String,
}

/// What moves a coordinate.
#[derive(Clone, Debug, PartialEq)]
pub enum CoordinateKind {
    /// `mass NAME = m;`
    Mass(Expression),
    /// `inertia NAME = j;`
    Inertia(Expression),
    /// `node NAME;`
    Node,
    /// `road NAME;`
    Road,
    /// `motion NAME;`
    Motion,
}

/// A link.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The name.
    pub name: Name,
    /// A linear combination of coordinates.
    pub stretch: Expression,
    /// The sentence; may be empty.
    pub doc: String,
    /// The law.
    pub body: Vec<LawStatement>,
}

/// A statement of a law.
#[derive(Clone, Debug, PartialEq)]
pub enum LawStatement {
    /// `spring k;`
    Spring(Expression),
    /// `damper c;`
    Damper(Expression),
    /// `inerter b;`
    Inerter(Expression),
    /// `force = expression;`
    Force(Expression),
    /// `state NAME: unit;`
    State(Name, UnitText),
    /// `rate NAME = expression;`
    Rate(Name, Expression),
    /// `let NAME = expression;`
    Let(Let),
    /// `element(argument, …);` or `label: element(argument, …);`
    Use(ElementUse),
    /// `active;`
    Active,
    /// `rolling { … }`
    Rolling(Span, Vec<LawStatement>),
    /// `if option == value { … } else { … }`
    If(If<LawStatement>),
}

/// The use of an element in a law.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementUse {
    /// The label of this use, which prefixes the names of its states; without one, the name of the element.
    pub label: Option<Name>,
    /// Which element.
    pub element: Name,
    /// One for each argument.
    pub arguments: Vec<Expression>,
}

impl ElementUse {
    /// The prefix of the states of this use.
    pub fn label(&self) -> &Name {
        self.label.as_ref().unwrap_or(&self.element)
    }
}

/// Names joined by dots, such as `z.body.acceleration`.
#[derive(Clone, Debug, PartialEq)]
pub struct Dotted {
    /// At least one.
    pub names: Vec<Name>,
}

impl Dotted {
    /// From the first name to the last.
    pub fn span(&self) -> Span {
        self.names
            .iter()
            .map(|name| name.span)
            .reduce(Span::join)
            .unwrap_or_default()
    }
}

impl std::fmt::Display for Dotted {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let texts: Vec<&str> = self.names.iter().map(|name| name.text.as_str()).collect();
        f.write_str(&texts.join("."))
    }
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// Its kind.
    pub kind: ExpressionKind,
    /// Its position.
    pub span: Span,
}

/// The kind of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpressionKind {
    /// `40 mm`
    Number(Number),
    /// `k_tire`, `z.body`
    Name(Dotted),
    /// `-a`
    Negative(Box<Expression>),
    /// `a + b` and the other operators
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// `f(a, …)`
    Call(Name, Vec<Expression>),
    /// `table(x, [x0, …], [y0, …])`
    Table(Box<Table>),
    /// `if a < b { c } else { d }`
    If(Box<Logic<Comparison>>, Box<Expression>, Box<Expression>),
}

/// A curve through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The abscissa at which the curve is evaluated.
    pub x: Expression,
    /// The abscissae of the points.
    pub knots: List,
    /// Their ordinates.
    pub values: List,
}

/// `[a, b, …]`
#[derive(Clone, Debug, PartialEq)]
pub struct List {
    /// In the order of the text.
    pub entries: Vec<Expression>,
    /// With its brackets.
    pub span: Span,
}

/// An operator between two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each is the operator of its name")]
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

/// `a < b` and the other comparisons
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// On the left.
    pub left: Expression,
    /// How they compare.
    pub order: Order,
    /// On the right.
    pub right: Expression,
}

/// How two values compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each is the comparison of its name")]
pub enum Order {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}
