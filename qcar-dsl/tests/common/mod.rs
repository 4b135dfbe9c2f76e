//! Models built by hand, so that the stages after `check` are judged without a text.

pub mod programs;
pub mod random;
pub mod reference;

use proptest::test_runner::RngSeed;
use qcar_dsl::check::Checked;
use qcar_dsl::expr::{CoordinateId, Expr, Graph, LinkId, Symbol};
use qcar_dsl::model::{
    Coordinate, CoordinateKind, Declaration, Default, Direction, ForceInput, Gravity, Inner, Law, Link, Model, Output,
    Parameter, Point, Quantity, Signal, Term,
};
use qcar_dsl::source::{Source, Span};
use qcar_dsl::units::Unit;

const UNIT: Unit = Unit { sixths: [0; 3] };

/// So many random cases, the same in each run, so that a failure can be repeated. `PROPTEST_RNG_SEED` draws others.
pub fn cases(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases,
        failure_persistence: None,
        rng_seed: match std::env::var("PROPTEST_RNG_SEED").map(|seed| seed.parse()) {
            Ok(Ok(seed)) => RngSeed::Fixed(seed),
            _ => RngSeed::Fixed(1),
        },
        ..std::default::Default::default()
    }
}

/// A model file of this text.
pub fn text(model: &str) -> Source {
    Source {
        name: "test.axle".to_string(),
        text: model.to_string(),
    }
}

/// Holds values against what they should be: relative to each, to a thousandth of the largest, or to `floor`, the size
/// of a value that is nothing but rounding errors.
pub fn assert_close(what: &str, got: &[f64], want: &[f64], tolerance: f64, floor: f64) {
    assert_eq!(got.len(), want.len(), "{what}");
    let largest = want.iter().fold(0.0f64, |m, w| m.max(w.abs()));
    for (i, (g, w)) in got.iter().zip(want).enumerate() {
        let scale = w.abs().max(1e-3 * largest).max(floor);
        assert!((g - w).abs() <= tolerance * scale, "{what}[{i}]: got {g}, want {w}");
    }
}

/// A model under construction.
pub struct Builder {
    pub model: Model,
}

fn declared() -> Declaration {
    Declaration {
        span: Span::default(),
        line: String::new(),
    }
}

impl Builder {
    pub fn new(name: &str) -> Self {
        Builder {
            model: Model {
                name: name.into(),
                doc: String::new(),
                choices: vec![],
                graph: Graph::default(),
                parameters: vec![],
                definitions: vec![],
                coordinates: vec![],
                points: vec![],
                forces: vec![],
                gravities: vec![],
                links: vec![],
                outputs: vec![],
                channels: vec![],
            },
        }
    }

    pub fn number(&mut self, value: f64) -> Expr {
        self.model.graph.constant(value)
    }

    pub fn parameter(&mut self, name: &str) -> Expr {
        let place = self.model.parameters.len() as u16;
        self.model.parameters.push(Parameter {
            name: name.into(),
            unit: UNIT,
            unit_name: UNIT.to_string(),
            doc: String::new(),
            default: Default::None,
            range: None,
            known: false,
            clock: false,
            declared: declared(),
        });
        self.model.graph.symbol(Symbol::Parameter(place))
    }

    pub fn coordinate(&mut self, direction: &str, name: &str, kind: CoordinateKind) -> CoordinateId {
        self.model.coordinates.push(Coordinate {
            also: Vec::new(),
            name: name.into(),
            direction: Direction(direction.into()),
            kind,
            angle: false,
            doc: String::new(),
            declared: declared(),
        });
        CoordinateId(self.model.coordinates.len() as u16 - 1)
    }

    pub fn mass(&mut self, direction: &str, name: &str, inertia: Expr) -> CoordinateId {
        self.coordinate(direction, name, CoordinateKind::Mass(inertia))
    }

    pub fn force(&mut self, name: &str, on: CoordinateId) {
        let one = self.number(1.0);
        self.force_along(name, vec![(on, one)]);
    }

    /// A force that makes a combination of coordinates grow; of none, one that acts through laws alone.
    pub fn force_along(&mut self, name: &str, on: Vec<(CoordinateId, Expr)>) {
        self.model.forces.push(ForceInput {
            name: name.into(),
            direction: Direction("z".into()),
            on,
            unit: UNIT,
            declared: declared(),
        });
    }

    /// A point that a combination of coordinates moves.
    pub fn point(&mut self, name: &str, combination: Vec<(CoordinateId, Expr)>) -> u16 {
        self.model.points.push(Point {
            name: name.into(),
            direction: Direction("z".into()),
            combination,
            angle: false,
            declared: declared(),
        });
        self.model.points.len() as u16 - 1
    }

    pub fn gravity(&mut self, direction: &str) {
        let direction = Direction(direction.into());
        self.model.gravities.push(Gravity {
            name: "g".into(),
            direction,
            declared: declared(),
        });
    }

    /// The place that the next link will have, for laws that speak of its stretch.
    pub fn next_link(&self) -> LinkId {
        LinkId(self.model.links.len() as u16)
    }

    pub fn link(&mut self, direction: &str, name: &str, stretch: &[(CoordinateId, Expr)], terms: Vec<Term>) -> LinkId {
        self.link_with_states(direction, name, stretch, terms, &[])
    }

    pub fn link_with_states(
        &mut self,
        direction: &str,
        name: &str,
        stretch: &[(CoordinateId, Expr)],
        terms: Vec<Term>,
        inner: &[Expr],
    ) -> LinkId {
        let id = self.next_link();
        let state = |(i, &rate): (usize, &Expr)| Inner {
            name: format!("state{i}"),
            unit: UNIT,
            rate,
        };
        self.model.links.push(Link {
            name: name.into(),
            direction: Direction(direction.into()),
            stretch: stretch.to_vec(),
            unit: UNIT,
            law: Law {
                terms,
                inner: inner.iter().enumerate().map(state).collect(),
                active: false,
            },
            rolling: None,
            doc: String::new(),
            declared: declared(),
        });
        id
    }

    /// `upper - lower`
    pub fn between(&mut self, upper: CoordinateId, lower: CoordinateId) -> Vec<(CoordinateId, Expr)> {
        vec![(upper, self.number(1.0)), (lower, self.number(-1.0))]
    }

    pub fn output(&mut self, signal: Signal) {
        let name = format!("y{}", self.model.outputs.len());
        self.model.outputs.push(Output {
            name,
            signal,
            unit: UNIT,
            declared: declared(),
        });
    }

    pub fn accelerations(&mut self, of: &[CoordinateId]) {
        for &c in of {
            self.output(Signal::Motion(c, Quantity::Acceleration));
        }
    }

    pub fn build(self) -> Checked {
        Checked::trust(self.model)
    }
}

/// The z chain of an axle with every option taken (thesis table 4.5): spring and damper on arms that turn about a
/// suspended sub-frame, which carries the powertrain.
pub fn axle_d() -> Checked {
    let mut b = Builder::new("axle_d");
    let names = [
        "m_corner",
        "m_wheel",
        "m_tm",
        "m_sf",
        "m_pwt",
        "k_wheel_z",
        "c_wheel_z",
        "mr_spring",
        "mr_damper",
        "k_tm",
        "c_tm",
        "k_sf_z",
        "c_sf_z",
        "k_pwt_z",
        "c_pwt_z",
        "k_tire",
        "c_tire",
    ];
    let [
        m_corner,
        m_wheel,
        m_tm,
        m_sf,
        m_pwt,
        k,
        c,
        mr_spring,
        mr_damper,
        k_tm,
        c_tm,
        k_sf,
        c_sf,
        k_pwt,
        c_pwt,
        k_tire,
        c_tire,
    ] = names.map(|name| b.parameter(name));
    let g = &mut b.model.graph;
    let m_body = [m_wheel, m_tm, m_sf, m_pwt]
        .into_iter()
        .fold(m_corner, |sum, m| g.sub(sum, m));
    let (one, minus) = (g.constant(1.0), g.constant(-1.0));
    let pad = b.coordinate("z", "pad", CoordinateKind::Road);
    b.gravity("z");
    let [body, wheel, tm, sf, pwt] = [
        ("body", m_body),
        ("wheel", m_wheel),
        ("tm", m_tm),
        ("sf", m_sf),
        ("pwt", m_pwt),
    ]
    .map(|(n, m)| b.mass("z", n, m));
    b.force("f_wheel_z", wheel);
    let arm = |b: &mut Builder, upper, ratio| {
        let g = &mut b.model.graph;
        vec![(upper, one), (sf, g.add(minus, ratio)), (wheel, g.neg(ratio))]
    };
    let (spring, damper) = (arm(&mut b, body, mr_spring), arm(&mut b, tm, mr_damper));
    let (squared_spring, squared_damper) = (b.model.graph.powi(mr_spring, 2), b.model.graph.powi(mr_damper, 2));
    let (k, c) = (
        b.model.graph.div(k, squared_spring),
        b.model.graph.div(c, squared_damper),
    );
    let tire = b.between(wheel, pad);
    b.link("z", "tire", &tire, vec![Term::Spring(k_tire), Term::Damper(c_tire)]);
    b.link("z", "spring", &spring, vec![Term::Spring(k)]);
    b.link("z", "damper", &damper, vec![Term::Damper(c)]);
    for (name, upper, lower, k, c) in [
        ("top_mount", body, tm, k_tm, c_tm),
        ("subframe_mount", body, sf, k_sf, c_sf),
        ("powertrain_mount", pwt, sf, k_pwt, c_pwt),
    ] {
        let stretch = b.between(upper, lower);
        b.link("z", name, &stretch, vec![Term::Spring(k), Term::Damper(c)]);
    }
    b.accelerations(&[body, wheel, tm, sf, pwt]);
    b.build()
}
