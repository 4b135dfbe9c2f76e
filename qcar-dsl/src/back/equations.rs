//! The equations of motion as an engineer writes them: one for each mass and node, then the definitions that they use.

use std::collections::BTreeSet;

use crate::expr::{CoordinateId, Expr, Graph, LinkId, Node, Symbol};
use crate::model::{
    Channel, Coordinate, CoordinateKind, Direction, Law, Link, Model, Output, Point, Quantity, Reference, Signal, Term,
};

use crate::back::notation::{Notation, Summand, Writer};

/// An equation: its left-hand side and the terms of the right-hand side, each with its sign.
pub struct Equation {
    /// `m_wheel z̈_wheel`
    pub left: String,
    /// `-k_tire (z_wheel - z_pad)`, `+ f_wheel_z`
    pub right: Vec<String>,
}

/// The equations of a model, written in one notation.
pub struct Sheet {
    /// Newton's law of each mass and the force balance of each node, direction by direction.
    pub motion: Vec<(String, Vec<Equation>)>,
    /// Rates of the inner states of the laws.
    pub inner: Vec<Equation>,
    /// Definitions that other equations use: forces and stretches of links, derived quantities.
    pub names: Vec<Equation>,
    /// Forces of a rolling tyre.
    pub rolling: Vec<Equation>,
    /// Positions of points that several coordinates move.
    pub points: Vec<Equation>,
    /// The outputs.
    pub outputs: Vec<Equation>,
    /// The channels, which are ratios of signals.
    pub channels: Vec<Equation>,
}

impl Sheet {
    /// Sets up the equations of a model.
    pub fn new(model: &Model, notation: Notation) -> Sheet {
        let mut graph = model.graph.clone();
        let elsewhere = used_elsewhere(model);
        let laws: Vec<LawTerms> = links(model)
            .map(|link| LawTerms::new(model, &mut graph, &elsewhere, link))
            .collect();
        let balances: Vec<Balance> = moving(model)
            .map(|coordinate| Balance::new(model, &mut graph, &laws, coordinate))
            .collect();
        let points: Vec<Vec<Summand>> = model.points.iter().map(|point| place(&mut graph, point)).collect();
        let mut writer = Writer::new(model, &graph, notation);
        let named = named_quantities(model);
        named.iter().for_each(|(name, value)| writer.name(*value, name));
        let in_direction = |direction: &Direction| {
            let of = balances
                .iter()
                .filter(|b| coordinate(model, b.coordinate).direction == *direction);
            of.map(|balance| balance.write(&writer)).collect()
        };
        Sheet {
            motion: directions(model)
                .into_iter()
                .map(|d| (d.0.clone(), in_direction(d)))
                .collect(),
            inner: inner_states(model, &writer),
            names: names(&writer, &laws, &named),
            rolling: rolling(&writer, &laws),
            points: self::points(&writer, &points),
            outputs: outputs(model, &writer),
            channels: channels(model, &writer),
        }
    }

    /// All equations under headings, without empty sections.
    pub fn sections(self) -> Vec<(String, Vec<Equation>)> {
        let motion = self
            .motion
            .into_iter()
            .map(|(direction, equations)| (format!("Direction {direction}"), equations));
        let others = [
            ("Inner states", self.inner),
            ("where", self.names),
            ("While the tyre rolls", self.rolling),
            ("Points", self.points),
            ("Outputs", self.outputs),
            ("Channels", self.channels),
        ];
        let all = motion.chain(others.map(|(heading, equations)| (heading.to_string(), equations)));
        all.filter(|(_, equations)| !equations.is_empty()).collect()
    }
}

/// Quantities that the text defines by `let`, and inertias that it gives as expressions: `m_body_z`.
pub fn named_quantities(model: &Model) -> Vec<(String, Expr)> {
    let compound =
        |&(_, value): &(String, Expr)| !matches!(model.graph.node(value), Node::Constant(_) | Node::Symbol(_));
    let definitions = model
        .definitions
        .iter()
        .map(|definition| (definition.name.clone(), definition.value));
    let inertias = model.coordinates.iter().filter_map(|c| match c.kind {
        CoordinateKind::Mass(inertia) => {
            let letter = if c.angle { "j" } else { "m" };
            Some((format!("{letter}_{}_{}", c.name, c.direction.0), inertia))
        }
        _ => None,
    });
    let mut seen = BTreeSet::new();
    definitions
        .chain(inertias)
        .filter(compound)
        .filter(|&(_, value)| seen.insert(value))
        .collect()
}

/// The directions of a model, in the order of the text.
pub fn directions(model: &Model) -> Vec<&Direction> {
    let mut seen = Vec::new();
    for direction in model.coordinates.iter().map(|c| &c.direction) {
        if !seen.contains(&direction) {
            seen.push(direction);
        }
    }
    seen
}

fn coordinate(model: &Model, id: CoordinateId) -> &Coordinate {
    &model.coordinates[id.0 as usize]
}

fn link(model: &Model, id: LinkId) -> &Link {
    &model.links[id.0 as usize]
}

fn links(model: &Model) -> impl Iterator<Item = LinkId> {
    (0..model.links.len()).map(|place| LinkId(place as u16))
}

fn moving(model: &Model) -> impl Iterator<Item = CoordinateId> {
    let moves = |c: &(usize, &Coordinate)| matches!(c.1.kind, CoordinateKind::Mass(_) | CoordinateKind::Node);
    model
        .coordinates
        .iter()
        .enumerate()
        .filter(moves)
        .map(|(place, _)| CoordinateId(place as u16))
}

/// The resisting force of a link as terms.
struct LawTerms {
    link: LinkId,
    /// True if the law is written out in the balances: a linear law between two points. Any other law gets a name,
    /// `F_spring`.
    short: bool,
    terms: Vec<Summand>,
    /// The stretch `s`, if the terms use it.
    stretch: Option<Vec<Summand>>,
    /// The rate `v`, if the terms use it.
    rate: Option<Vec<Summand>>,
    /// The terms that replace the others while a tyre rolls.
    rolling: Option<Vec<Summand>>,
}

impl LawTerms {
    fn new(model: &Model, graph: &mut Graph, elsewhere: &BTreeSet<Symbol>, id: LinkId) -> LawTerms {
        let link = link(model, id);
        let short = is_short(graph, link) && !is_seen(model, id);
        let [s, v, a] = match short {
            true => [Symbol::Position, Symbol::Velocity, Symbol::Acceleration].map(|kind| combine(graph, link, kind)),
            false => {
                let acceleration = combine(graph, link, Symbol::Acceleration);
                [
                    graph.symbol(Symbol::Stretch(id)),
                    graph.symbol(Symbol::Rate(id)),
                    acceleration,
                ]
            }
        };
        let terms = summands(graph, &link.law.terms, [s, v, a]);
        let rolling = link.rolling.as_ref().map(|terms| {
            let [s, v] = [Symbol::Stretch(id), Symbol::Rate(id)].map(|symbol| graph.symbol(symbol));
            summands(graph, terms, [s, v, a])
        });
        let [own_stretch, own_rate] = uses(graph, id, &link.law).map(|used| used && !short);
        let by_stretch = own_stretch || elsewhere.contains(&Symbol::Stretch(id));
        let by_rate = own_rate || elsewhere.contains(&Symbol::Rate(id));
        let stretch = by_stretch.then(|| combination(graph, link, Symbol::Position));
        let rate = by_rate.then(|| combination(graph, link, Symbol::Velocity));
        LawTerms {
            link: id,
            short,
            terms,
            stretch,
            rate,
            rolling,
        }
    }

    /// The force on a coordinate that has this coefficient in the stretch: `-coefficient · F`.
    fn acting(&self, graph: &mut Graph, coefficient: Expr) -> Vec<Summand> {
        let acting = Summand::signed(graph, true, coefficient, &[]);
        if !self.short {
            return vec![Summand {
                link: Some(self.link),
                ..acting
            }];
        }
        let reverse = |term: &Summand| Summand {
            negative: term.negative != acting.negative,
            ..term.clone()
        };
        self.terms.iter().map(reverse).collect()
    }
}

/// True if the law of a link depends on its stretch, and true if it depends on its rate.
fn uses(graph: &Graph, id: LinkId, law: &Law) -> [bool; 2] {
    let forces = law.terms.iter().filter_map(|term| {
        if let Term::Force(force) = term {
            Some(*force)
        } else {
            None
        }
    });
    let symbols = graph.symbols(forces.chain(law.inner.iter().map(|inner| inner.rate)));
    let springs = law.terms.iter().any(|term| matches!(term, Term::Spring(_)));
    let dampers = law.terms.iter().any(|term| matches!(term, Term::Damper(_)));
    [
        springs || symbols.contains(&Symbol::Stretch(id)),
        dampers || symbols.contains(&Symbol::Rate(id)),
    ]
}

/// The stretches and rates that laws of other links use.
fn used_elsewhere(model: &Model) -> BTreeSet<Symbol> {
    let of_others = |id: LinkId| {
        let leaves = link(model, id).law.leaves(&model.graph).into_iter();
        leaves.filter(move |leaf| matches!(*leaf, Symbol::Stretch(other) | Symbol::Rate(other) if other != id))
    };
    links(model).flat_map(of_others).collect()
}

/// The stretch or one of its derivatives, term by term.
fn combination(graph: &mut Graph, link: &Link, kind: fn(CoordinateId) -> Symbol) -> Vec<Summand> {
    along(graph, &link.stretch, kind)
}

/// The position of a point, term by term.
fn place(graph: &mut Graph, point: &Point) -> Vec<Summand> {
    along(graph, &point.combination, Symbol::Position)
}

fn along(graph: &mut Graph, held: &[(CoordinateId, Expr)], kind: fn(CoordinateId) -> Symbol) -> Vec<Summand> {
    let term = |&(coordinate, coefficient): &(CoordinateId, Expr)| {
        let motion = graph.symbol(kind(coordinate));
        Summand::signed(graph, false, coefficient, &[motion])
    };
    let mut terms: Vec<Summand> = held.iter().map(term).collect();
    terms.sort_by_key(|term| term.negative);
    terms
}

/// The terms of a law over a stretch, its rate and its acceleration.
fn summands(graph: &mut Graph, terms: &[Term], [s, v, a]: [Expr; 3]) -> Vec<Summand> {
    let mut summands = Vec::new();
    for term in terms {
        match *term {
            Term::Spring(k) => summands.push(Summand::signed(graph, false, k, &[s])),
            Term::Damper(c) => summands.push(Summand::signed(graph, false, c, &[v])),
            Term::Inerter(b) => summands.push(Summand::signed(graph, false, b, &[a])),
            Term::Force(force) => spread(graph, false, force, &mut summands),
        }
    }
    summands
}

/// The terms of a sum, however its additions are nested.
fn spread(graph: &mut Graph, negative: bool, e: Expr, into: &mut Vec<Summand>) {
    match graph.node(e) {
        Node::Neg(a) => spread(graph, !negative, a, into),
        Node::Add(a, b) | Node::Sub(a, b) => {
            let minus = matches!(graph.node(e), Node::Sub(..));
            spread(graph, negative, a, into);
            spread(graph, negative != minus, b, into);
        }
        Node::Mul(a, b) => into.push(Summand::signed(graph, negative, a, &[b])),
        _ => into.push(Summand::signed(graph, negative, e, &[])),
    }
}

/// True for springs, dampers and inerters between at most two points without levers.
fn is_short(graph: &Graph, link: &Link) -> bool {
    let direct = |c: Expr| graph.as_constant(c).is_some_and(|c| c.abs() == 1.0);
    link.stretch.len() <= 2
        && link.stretch.iter().all(|&(_, coefficient)| direct(coefficient))
        && link.law.terms.iter().all(|term| !matches!(term, Term::Force(_)))
}

fn is_seen(model: &Model, link: LinkId) -> bool {
    let shows = |signal: &Signal| matches!(*signal, Signal::LinkForce(l) | Signal::LinkStretch(l) if l == link);
    model.outputs.iter().any(|output| shows(&output.signal))
        || model.channels.iter().any(|channel| {
            let below = matches!(&channel.denominator, Reference::Signal(signal) if shows(signal));
            below || shows(&channel.numerator)
        })
}

/// The stretch or one of its derivatives as one expression.
fn combine(graph: &mut Graph, link: &Link, kind: impl Fn(CoordinateId) -> Symbol) -> Expr {
    let zero = graph.constant(0.0);
    link.stretch.iter().fold(zero, |sum, &(coordinate, coefficient)| {
        let motion = graph.symbol(kind(coordinate));
        let moved = graph.mul(coefficient, motion);
        graph.add(sum, moved)
    })
}

/// Newton's law of a mass, or the force balance of a node.
struct Balance {
    coordinate: CoordinateId,
    left: Vec<Expr>,
    right: Vec<Summand>,
}

impl Balance {
    fn new(model: &Model, graph: &mut Graph, laws: &[LawTerms], id: CoordinateId) -> Balance {
        let mut right = Vec::new();
        for law in laws {
            let mut stretch = link(model, law.link).stretch.iter();
            if let Some(&(_, coefficient)) = stretch.find(|&&(c, _)| c == id) {
                right.extend(law.acting(graph, coefficient));
            }
        }
        let mut left = Vec::new();
        if let CoordinateKind::Mass(inertia) = coordinate(model, id).kind {
            left = vec![inertia, graph.symbol(Symbol::Acceleration(id))];
            right.extend(weight(model, graph, id, inertia));
        }
        for (place, force) in model.forces.iter().enumerate() {
            let own = graph.symbol(Symbol::Force(place as u16));
            let shares = force.on.iter().filter(|(pushed, _)| *pushed == id);
            right.extend(shares.map(|&(_, coefficient)| Summand::signed(graph, false, coefficient, &[own])));
        }
        Balance {
            coordinate: id,
            left,
            right,
        }
    }

    fn write(&self, writer: &Writer) -> Equation {
        let left = if self.left.is_empty() {
            "0".into()
        } else {
            writer.product(&self.left, None)
        };
        Equation {
            left,
            right: writer.sum(&self.right),
        }
    }
}

/// `-m g` for a mass in a direction with gravity; an angle has no weight.
fn weight(model: &Model, graph: &mut Graph, id: CoordinateId, inertia: Expr) -> Option<Summand> {
    let coordinate = coordinate(model, id);
    let place = model
        .gravities
        .iter()
        .position(|gravity| gravity.direction == coordinate.direction)?;
    let g = graph.symbol(Symbol::Gravity(place as u16));
    (!coordinate.angle).then(|| Summand::signed(graph, true, inertia, &[g]))
}

fn inner_states(model: &Model, writer: &Writer) -> Vec<Equation> {
    let of_link = |id: LinkId| {
        let inner = link(model, id).law.inner.iter().enumerate();
        inner.map(move |(place, inner)| Equation {
            left: writer.derivative(&writer.symbol(Symbol::Inner(id, place as u16))),
            right: vec![writer.write(inner.rate)],
        })
    };
    links(model).flat_map(of_link).collect()
}

fn names(writer: &Writer, laws: &[LawTerms], named: &[(String, Expr)]) -> Vec<Equation> {
    let of_law = |law: &LawTerms| {
        let written = |letter: &str, terms: &Vec<Summand>| Equation {
            left: writer.of_link(letter, law.link),
            right: writer.sum(terms),
        };
        let force = (!law.short).then(|| written("F", &law.terms));
        let stretch = law.stretch.as_ref().map(|terms| written("s", terms));
        let rate = law.rate.as_ref().map(|terms| written("v", terms));
        force.into_iter().chain(stretch).chain(rate)
    };
    let of_laws = laws.iter().flat_map(of_law);
    let derived = named.iter().map(|(name, value)| Equation {
        left: writer.identifier(name),
        right: vec![writer.expand(*value)],
    });
    of_laws.chain(derived).collect()
}

/// The laws of rolling tyres; their stretch comes from the contact instead of the coordinates.
fn rolling(writer: &Writer, laws: &[LawTerms]) -> Vec<Equation> {
    let force = |law: &LawTerms| {
        let right = writer.sum(law.rolling.as_ref()?);
        Some(Equation {
            left: writer.of_link("F", law.link),
            right,
        })
    };
    laws.iter().filter_map(force).collect()
}

fn points(writer: &Writer, points: &[Vec<Summand>]) -> Vec<Equation> {
    let written = |(place, terms): (u16, &Vec<Summand>)| Equation {
        left: writer.of_point(place, Quantity::Position),
        right: writer.sum(terms),
    };
    (0..).zip(points).map(written).collect()
}

fn outputs(model: &Model, writer: &Writer) -> Vec<Equation> {
    let written = |output: &Output| Equation {
        left: writer.identifier(&output.name),
        right: vec![signal(writer, &output.signal)],
    };
    model.outputs.iter().map(written).collect()
}

fn channels(model: &Model, writer: &Writer) -> Vec<Equation> {
    let written = |channel: &Channel| Equation {
        left: writer.identifier(&channel.name),
        right: vec![writer.ratio(
            &signal(writer, &channel.numerator),
            &reference(writer, &channel.denominator),
        )],
    };
    model.channels.iter().map(written).collect()
}

fn reference(writer: &Writer, reference: &Reference) -> String {
    match reference {
        Reference::Signal(of) => signal(writer, of),
        Reference::Force(place) => writer.symbol(Symbol::Force(*place)),
    }
}

fn signal(writer: &Writer, signal: &Signal) -> String {
    match *signal {
        Signal::Motion(c, quantity) => writer.symbol(Symbol::of_motion(c, quantity)),
        Signal::Point(place, quantity) => writer.of_point(place, quantity),
        Signal::LinkForce(l) => writer.of_link("F", l),
        Signal::LinkStretch(l) => writer.of_link("s", l),
    }
}
