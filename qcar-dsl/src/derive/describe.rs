//! Description of a model for [`About`] and [`Vectors`]: the meaning and name of each entry.

use std::borrow::Cow;

use qcar_model::{
    About, Channel, Clock, ContactAbout, ContactAxis, Excitation, Input, InputKind, Link, Mass, Output, Parameter,
    ResponseLayout, Signal, SignalKind, State, StateKind,
};

use crate::check::Checked;
use crate::derive::linear::Linear;
use crate::derive::motion::{Motion, RollingTyre};
use crate::derive::response::{Response, sources};
use crate::derive::vectors::{Component, ExcitationSource, Vectors};
use crate::expr::{CoordinateId, Expr, LinkId, Symbol};
use crate::model::{self, Coordinate, CoordinateKind, Direction, Quantity, Term};
use crate::units::Unit;

/// The meaning of each entry of the vectors.
pub fn vectors(model: &Checked, motion: &Motion) -> Vectors {
    let component = |&symbol: &Symbol| {
        let unit = unit_of(model, symbol)?;
        Some(Component { symbol, unit })
    };
    Vectors {
        states: motion.states.iter().filter_map(component).collect(),
        inputs: motion.inputs.iter().filter_map(component).collect(),
        outputs: model.outputs.iter().map(|output| output.unit).collect(),
    }
}

/// Describes a compiled model.
pub fn describe(
    model: &Checked,
    vectors: &Vectors,
    tyre: Option<&RollingTyre>,
    linear: &Linear,
    responses: &[Response],
    constants: usize,
) -> About {
    let sources = sources(model);
    About {
        name: model.name.clone().into(),
        doc: model.doc.clone().into(),
        parameters: model.parameters.iter().map(parameter).collect(),
        states: vectors.states.iter().filter_map(|own| state(model, own)).collect(),
        inputs: vectors
            .inputs
            .iter()
            .filter_map(|own| input(model, &sources, own))
            .collect(),
        outputs: model.outputs.iter().map(|output| self::output(model, output)).collect(),
        excitations: sources.iter().map(|&source| excitation(model, source)).collect(),
        channels: model
            .channels
            .iter()
            .map(|channel| self::channel(model, channel))
            .collect(),
        links: model.links.iter().map(|link| self::link(model, link)).collect(),
        masses: model.coordinates.iter().filter_map(|c| mass(model, c)).collect(),
        contact: tyre.map(|tyre| contact(model, vectors, tyre)),
        constants,
        linear: linear.linear,
        matrices: linear.matrices.iter().map(|&(entry, _)| entry).collect(),
        sensitivities: linear.sensitivities.iter().map(|&(entry, p, _)| (entry, p)).collect(),
        parameter_jacobian: linear
            .parameter_jacobian
            .iter()
            .map(|&(y, row, p, _)| (y, row, p))
            .collect(),
        responses: responses.iter().map(layout).collect(),
    }
}

fn coordinate(model: &Checked, c: CoordinateId) -> &Coordinate {
    &model.coordinates[c.0 as usize]
}

/// Unit of a coordinate's position (m, or rad, which is 1), divided by s `rates` times.
fn unit(coordinate: &Coordinate, rates: i16) -> Unit {
    Unit {
        sixths: [0, if coordinate.angle { 0 } else { 6 }, -6 * rates],
    }
}

/// The unit of a motion as people write it: an angle is in rad, although its unit is 1.
fn of_motion(unit: Unit) -> String {
    let written = unit.to_string();
    match written.strip_prefix('1') {
        Some(rates) => format!("rad{rates}"),
        None => written,
    }
}

fn parameter(p: &model::Parameter) -> Parameter {
    Parameter {
        name: p.name.clone().into(),
        unit: p.unit_name.clone().into(),
        doc: p.doc.clone().into(),
        default: p.default,
        range: p.range,
        known: p.known,
        clock: p.clock.then_some(if p.unit == Unit::ONE {
            Clock::PartOfRun
        } else {
            Clock::Seconds
        }),
    }
}

/// `z_wheel`, `vz_wheel`, `az_wheel`.
fn motion_name(c: &Coordinate, quantity: Quantity) -> String {
    let rate = ["", "v", "a"][quantity as usize];
    format!("{rate}{}_{}", c.direction.0, c.name)
}

/// The motion of a coordinate that a symbol represents.
fn moving(symbol: Symbol) -> Option<(CoordinateId, Quantity)> {
    match symbol {
        Symbol::Position(c) => Some((c, Quantity::Position)),
        Symbol::Velocity(c) => Some((c, Quantity::Velocity)),
        Symbol::Acceleration(c) => Some((c, Quantity::Acceleration)),
        _ => None,
    }
}

/// Unit of an entry of a vector.
fn unit_of(model: &Checked, symbol: Symbol) -> Option<Unit> {
    Some(match symbol {
        Symbol::Inner(LinkId(l), i) => model.links[l as usize].law.inner[i as usize].unit,
        Symbol::Offset(c) => unit(coordinate(model, c), 0),
        Symbol::Force(i) => model.forces[i as usize].unit,
        Symbol::Gravity(_) => Unit { sixths: [0, 6, -12] },
        _ => {
            let (c, quantity) = moving(symbol)?;
            unit(coordinate(model, c), quantity as i16)
        }
    })
}

fn state(model: &Checked, &Component { symbol, unit }: &Component) -> Option<State> {
    if let Symbol::Inner(LinkId(l), i) = symbol {
        let link = &model.links[l as usize];
        let inner = &link.law.inner[i as usize];
        return Some(State {
            name: format!("{}_{}_{}", link.direction.0, link.name, inner.name).into(),
            unit: unit.to_string().into(),
            location: link.name.clone().into(),
            axis: link.direction.0.clone().into(),
            kind: StateKind::Inner,
        });
    }
    let (c, name, kind) = match symbol {
        Symbol::Offset(c) => {
            let c = coordinate(model, c);
            let name = format!("{}_{}_offset", c.direction.0, c.name);
            (c, name, StateKind::Position)
        }
        _ => {
            let (c, quantity) = moving(symbol)?;
            let c = coordinate(model, c);
            let kind = match quantity {
                Quantity::Position => StateKind::Position,
                _ => StateKind::Velocity,
            };
            (c, motion_name(c, quantity), kind)
        }
    };
    Some(State {
        name: name.into(),
        unit: of_motion(unit).into(),
        location: c.name.clone().into(),
        axis: c.direction.0.clone().into(),
        kind,
    })
}

fn input(model: &Checked, sources: &[ExcitationSource], &Component { symbol, unit }: &Component) -> Option<Input> {
    let place = |source| Some(sources.iter().position(|&other| other == source)? as u16);
    let (name, direction, kind) = match symbol {
        Symbol::Force(i) => {
            let force = &model.forces[i as usize];
            let kind = InputKind::Force(place(ExcitationSource::Force(i))?);
            (force.name.clone(), &force.direction, kind)
        }
        Symbol::Gravity(i) => {
            let gravity = &model.gravities[i as usize];
            (gravity.name.clone(), &gravity.direction, InputKind::Gravity)
        }
        _ => {
            let (c, quantity) = moving(symbol)?;
            let kind = InputKind::Motion(place(ExcitationSource::Motion(c))?, quantity);
            let c = coordinate(model, c);
            (motion_name(c, quantity), &c.direction, kind)
        }
    };
    Some(Input {
        name: name.into(),
        unit: of_motion(unit).into(),
        axis: direction.0.clone().into(),
        kind,
    })
}

fn output(model: &Checked, output: &model::Output) -> Output {
    Output {
        name: output.name.clone().into(),
        unit: of_motion(output.unit).into(),
        signal: signal(model, &output.signal),
    }
}

fn signal(model: &Checked, signal: &model::Signal) -> Signal {
    let at = |location: &str, direction: &Direction, kind| Signal {
        location: location.to_string().into(),
        axis: direction.0.clone().into(),
        kind,
    };
    let of_link = |LinkId(l), kind| {
        let link = &model.links[l as usize];
        at(&link.name, &link.direction, kind)
    };
    match *signal {
        model::Signal::LinkForce(l) => of_link(l, SignalKind::Force),
        model::Signal::LinkStretch(l) => of_link(l, SignalKind::Stretch),
        model::Signal::Point(place, quantity) => {
            let point = &model.points[usize::from(place)];
            at(&point.name, &point.direction, SignalKind::Motion(quantity))
        }
        model::Signal::Motion(c, quantity) => {
            let c = coordinate(model, c);
            at(&c.name, &c.direction, SignalKind::Motion(quantity))
        }
    }
}

fn reference(model: &Checked, reference: &model::Reference) -> Signal {
    match reference {
        model::Reference::Signal(of) => signal(model, of),
        model::Reference::Force(place) => {
            let force = excitation(model, ExcitationSource::Force(*place));
            Signal {
                location: force.name,
                axis: force.axis,
                kind: SignalKind::Force,
            }
        }
    }
}

fn excitation(model: &Checked, source: ExcitationSource) -> Excitation {
    let (name, direction, force, road) = match source {
        ExcitationSource::Motion(c) => {
            let c = coordinate(model, c);
            (&c.name, &c.direction, false, c.kind == CoordinateKind::Road)
        }
        ExcitationSource::Force(i) => {
            let force = &model.forces[i as usize];
            (&force.name, &force.direction, true, false)
        }
    };
    Excitation {
        name: name.clone().into(),
        axis: direction.0.clone().into(),
        force,
        road,
    }
}

fn channel(model: &Checked, channel: &model::Channel) -> Channel {
    Channel {
        name: channel.name.clone().into(),
        numerator: signal(model, &channel.numerator),
        denominator: reference(model, &channel.denominator),
    }
}

fn link(model: &Checked, link: &model::Link) -> Link {
    let ends = link
        .stretch
        .iter()
        .map(|&(c, _)| coordinate(model, c).name.clone().into())
        .collect();
    let term = |term: &Term| match *term {
        Term::Spring(e) | Term::Damper(e) | Term::Inerter(e) | Term::Force(e) => e,
    };
    let rates = link.law.inner.iter().map(|inner| inner.rate);
    Link {
        name: link.name.clone().into(),
        axis: link.direction.0.clone().into(),
        ends,
        parameters: parameters_of(model, link.law.terms.iter().map(term).chain(rates)),
    }
}

fn mass(model: &Checked, c: &Coordinate) -> Option<Mass> {
    let CoordinateKind::Mass(inertia) = c.kind else {
        return None;
    };
    Some(Mass {
        location: c.name.clone().into(),
        axis: c.direction.0.clone().into(),
        angle: c.angle,
        parameters: parameters_of(model, [inertia]),
    })
}

/// Positions of the parameters on which expressions depend.
fn parameters_of(model: &Checked, of: impl IntoIterator<Item = Expr>) -> Cow<'static, [u16]> {
    let place = |symbol| match symbol {
        Symbol::Parameter(place) => Some(place),
        _ => None,
    };
    model.graph.symbols(of).into_iter().filter_map(place).collect()
}

fn contact(model: &Checked, vectors: &Vectors, tyre: &RollingTyre) -> ContactAbout {
    let place = |symbol| vectors.state(symbol).map(|place| place as u16);
    let axis = |&c: &CoordinateId| {
        Some(ContactAxis {
            axis: coordinate(model, c).direction.0.clone().into(),
            position: place(Symbol::Position(c))?,
            velocity: place(Symbol::Velocity(c))?,
        })
    };
    ContactAbout {
        link: tyre.link.0,
        axes: tyre.wheel.iter().filter_map(axis).collect(),
    }
}

fn layout(response: &Response) -> ResponseLayout {
    ResponseLayout {
        outputs: response.outputs.iter().map(|&(y, _)| y).collect(),
        jacobian: response.jacobian.iter().map(|&(place, p, _)| (place, p)).collect(),
    }
}
