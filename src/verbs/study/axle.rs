//! The masses and links of a model, for a drawing.

use qcar_dsl::expr::{Expr, Symbol};
use qcar_dsl::model::{CoordinateKind, Link, Model, Term};
use qcar_dsl::notation::{Notation, Writer};
use qcar_dsl::schedule::Compiled;
use qcar_dsl::show::{Stage, show};
use serde::Serialize;

/// A model for a drawing.
#[derive(Serialize)]
pub struct Axle {
    name: String,
    doc: String,
    linear: bool,
    points: Vec<Point>,
    links: Vec<Connection>,
    equations: String,
}

/// A moving part.
#[derive(Serialize)]
struct Point {
    name: String,
    axis: String,
    /// Kind: `mass`, `node`, `road` or `motion`.
    kind: &'static str,
    angle: bool,
    /// Mass, kg, or inertia, kg m² of an angle.
    inertia: Option<f64>,
    doc: String,
}

/// A link between points, the upper end first.
#[derive(Serialize)]
struct Connection {
    name: String,
    axis: String,
    ends: Vec<End>,
    elements: Vec<Element>,
    doc: String,
}

#[derive(Serialize)]
struct End {
    point: String,
    /// Factor of the point in the stretch.
    share: Option<f64>,
}

#[derive(Serialize)]
struct Element {
    /// Kind: `spring`, `damper`, `inerter` or `law`.
    kind: &'static str,
    /// Text of the law in the model file.
    law: String,
    /// Coefficient, N/m, N s/m or kg at the parameter values; `None` for a law.
    value: Option<f64>,
}

impl Axle {
    /// A model with the parameter values `p`.
    pub fn of(compiled: &Compiled, p: &[f64]) -> Self {
        let model: &Model = &compiled.model;
        let mut writer = Writer::new(model, &model.graph, Notation::Text);
        model
            .definitions
            .iter()
            .for_each(|definition| writer.name(definition.value, &definition.name));
        let drawing = Drawing { model, p, writer };
        Axle {
            name: model.name.clone(),
            doc: model.doc.clone(),
            linear: compiled.about.linear,
            points: model.coordinates.iter().map(|own| drawing.point(own)).collect(),
            links: model.links.iter().map(|link| drawing.connection(link)).collect(),
            equations: show(compiled, Stage::Equations),
        }
    }
}

struct Drawing<'a> {
    model: &'a Model,
    p: &'a [f64],
    writer: Writer<'a>,
}

impl Drawing<'_> {
    fn point(&self, own: &qcar_dsl::model::Coordinate) -> Point {
        let (kind, inertia) = match own.kind {
            CoordinateKind::Mass(inertia) => ("mass", self.value(inertia)),
            CoordinateKind::Node => ("node", None),
            CoordinateKind::Road => ("road", None),
            CoordinateKind::Motion => ("motion", None),
        };
        Point {
            name: own.name.clone(),
            axis: own.direction.0.clone(),
            angle: own.angle,
            doc: own.doc.clone(),
            kind,
            inertia,
        }
    }

    fn connection(&self, link: &Link) -> Connection {
        let end = |&(coordinate, share): &(qcar_dsl::expr::CoordinateId, Expr)| End {
            point: self.model.coordinates[usize::from(coordinate.0)].name.clone(),
            share: self.value(share),
        };
        Connection {
            name: link.name.clone(),
            axis: link.direction.0.clone(),
            ends: link.stretch.iter().map(end).collect(),
            elements: link.law.terms.iter().map(|term| self.element(term)).collect(),
            doc: link.doc.clone(),
        }
    }

    fn element(&self, term: &Term) -> Element {
        let (kind, law, value) = match *term {
            Term::Spring(k) => ("spring", k, self.value(k)),
            Term::Damper(c) => ("damper", c, self.value(c)),
            Term::Inerter(b) => ("inerter", b, self.value(b)),
            Term::Force(force) => ("law", force, None),
        };
        Element {
            kind,
            law: self.writer.write(law),
            value,
        }
    }

    /// A number that depends on parameters.
    fn value(&self, of: Expr) -> Option<f64> {
        let leaf = |symbol| match symbol {
            Symbol::Parameter(place) => self.p[usize::from(place)],
            _ => f64::NAN,
        };
        let value = self.model.graph.evaluate(of, &leaf);
        value.is_finite().then_some(value)
    }
}
