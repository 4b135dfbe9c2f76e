//! Stages to [`About`]: names for what stands at each place of the vectors.

use crate::check::Checked;
use crate::derive::about::{
    About, Channel, Clock, Contact, ContactAxis, Excitation, Input, InputKind, Link, Mass, Output, Parameter,
    ResponseLayout, Signal, SignalKind, Source, State, StateKind,
};
use crate::derive::linear::Linear;
use crate::derive::motion::{Motion, RollingTyre};
use crate::derive::response::{Response, sources};
use crate::expr::{CoordinateId, Expr, LinkId, Symbol};
use crate::model::{self, Coordinate, CoordinateKind, Quantity, Term};
use crate::units::Unit;

/// Describes a model whose stages are done.
pub fn describe(
    model: &Checked,
    motion: &Motion,
    tyre: Option<&RollingTyre>,
    linear: &Linear,
    responses: &[Response],
    constants: usize,
) -> About {
    let sources = sources(model);
    About {
        name: model.name.clone(),
        doc: model.doc.clone(),
        parameters: model.parameters.iter().map(parameter).collect(),
        states: motion
            .states
            .iter()
            .filter_map(|&symbol| state(model, symbol))
            .collect(),
        inputs: motion
            .inputs
            .iter()
            .filter_map(|&symbol| input(model, &sources, symbol))
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
        contact: tyre.map(|tyre| contact(model, motion, tyre)),
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

/// The unit of a coordinate's position (m, or rad, which is 1), divided by s as often as `rates` says.
fn unit(coordinate: &Coordinate, rates: i16) -> Unit {
    Unit {
        sixths: [0, if coordinate.angle { 0 } else { 6 }, -6 * rates],
    }
}

fn parameter(p: &model::Parameter) -> Parameter {
    Parameter {
        name: p.name.clone(),
        unit: p.unit_name.clone(),
        doc: p.doc.clone(),
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

/// `z_wheel`, `vz_wheel`, `az_wheel`, with their units.
fn motion(c: &Coordinate, quantity: Quantity) -> (String, Unit) {
    let (rate, rates) = match quantity {
        Quantity::Position => ("", 0),
        Quantity::Velocity => ("v", 1),
        Quantity::Acceleration => ("a", 2),
    };
    (format!("{rate}{}_{}", c.direction.0, c.name), unit(c, rates))
}

/// The motion of a coordinate that a symbol is.
fn moving(symbol: Symbol) -> Option<(CoordinateId, Quantity)> {
    match symbol {
        Symbol::Position(c) => Some((c, Quantity::Position)),
        Symbol::Velocity(c) => Some((c, Quantity::Velocity)),
        Symbol::Acceleration(c) => Some((c, Quantity::Acceleration)),
        _ => None,
    }
}

fn state(model: &Checked, symbol: Symbol) -> Option<State> {
    if let Symbol::Inner(LinkId(l), i) = symbol {
        let link = &model.links[l as usize];
        let inner = &link.law.inner[i as usize];
        let name = format!("{}_{}_{}", link.direction.0, link.name, inner.name);
        let (location, axis) = (link.name.clone(), link.direction.0.clone());
        return Some(State {
            symbol,
            name,
            unit: inner.unit,
            location,
            axis,
            kind: StateKind::Inner,
        });
    }
    if let Symbol::Offset(c) = symbol {
        let c = coordinate(model, c);
        let name = format!("{}_{}_offset", c.direction.0, c.name);
        let (location, axis) = (c.name.clone(), c.direction.0.clone());
        return Some(State {
            symbol,
            name,
            unit: unit(c, 0),
            location,
            axis,
            kind: StateKind::Position,
        });
    }
    let (c, quantity) = moving(symbol)?;
    let kind = if quantity == Quantity::Position {
        StateKind::Position
    } else {
        StateKind::Velocity
    };
    let c = coordinate(model, c);
    let (name, unit) = motion(c, quantity);
    Some(State {
        symbol,
        name,
        unit,
        location: c.name.clone(),
        axis: c.direction.0.clone(),
        kind,
    })
}

fn input(model: &Checked, sources: &[Source], symbol: Symbol) -> Option<Input> {
    let place = |source| {
        sources
            .iter()
            .position(|&other| other == source)
            .map(|place| place as u16)
    };
    let (name, unit, direction, kind) = match symbol {
        Symbol::Force(i) => {
            let force = &model.forces[i as usize];
            (
                force.name.clone(),
                force.unit,
                &force.direction,
                InputKind::Force(place(Source::Force(i))?),
            )
        }
        Symbol::Gravity(i) => {
            let gravity = &model.gravities[i as usize];
            (
                gravity.name.clone(),
                Unit { sixths: [0, 6, -12] },
                &gravity.direction,
                InputKind::Gravity,
            )
        }
        _ => {
            let (c, quantity) = moving(symbol)?;
            let (name, unit) = motion(coordinate(model, c), quantity);
            let kind = InputKind::Motion(place(Source::Motion(c))?, quantity);
            (name, unit, &coordinate(model, c).direction, kind)
        }
    };
    Some(Input {
        symbol,
        name,
        unit,
        axis: direction.0.clone(),
        kind,
    })
}

fn output(model: &Checked, output: &model::Output) -> Output {
    Output {
        name: output.name.clone(),
        unit: output.unit,
        signal: signal(model, &output.signal),
    }
}

fn signal(model: &Checked, signal: &model::Signal) -> Signal {
    let of_link = |LinkId(l), kind| {
        let link = &model.links[l as usize];
        Signal {
            location: link.name.clone(),
            axis: link.direction.0.clone(),
            kind,
        }
    };
    match *signal {
        model::Signal::LinkForce(l) => of_link(l, SignalKind::Force),
        model::Signal::LinkStretch(l) => of_link(l, SignalKind::Stretch),
        model::Signal::Point(place, quantity) => {
            let point = &model.points[usize::from(place)];
            Signal {
                location: point.name.clone(),
                axis: point.direction.0.clone(),
                kind: SignalKind::Motion(quantity),
            }
        }
        model::Signal::Motion(c, quantity) => {
            let c = coordinate(model, c);
            Signal {
                location: c.name.clone(),
                axis: c.direction.0.clone(),
                kind: SignalKind::Motion(quantity),
            }
        }
    }
}

fn reference(model: &Checked, reference: &model::Reference) -> Signal {
    match reference {
        model::Reference::Signal(of) => signal(model, of),
        model::Reference::Force(place) => {
            let force = excitation(model, Source::Force(*place));
            Signal {
                location: force.name,
                axis: force.axis,
                kind: SignalKind::Force,
            }
        }
    }
}

fn excitation(model: &Checked, source: Source) -> Excitation {
    match source {
        Source::Motion(c) => {
            let c = coordinate(model, c);
            let road = c.kind == CoordinateKind::Road;
            Excitation {
                name: c.name.clone(),
                axis: c.direction.0.clone(),
                source,
                road,
            }
        }
        Source::Force(i) => {
            let force = &model.forces[i as usize];
            let axis = force.direction.0.clone();
            Excitation {
                name: force.name.clone(),
                axis,
                source,
                road: false,
            }
        }
    }
}

fn channel(model: &Checked, channel: &model::Channel) -> Channel {
    Channel {
        name: channel.name.clone(),
        numerator: signal(model, &channel.numerator),
        denominator: reference(model, &channel.denominator),
    }
}

fn link(model: &Checked, link: &model::Link) -> Link {
    let ends = link
        .stretch
        .iter()
        .map(|&(c, _)| coordinate(model, c).name.clone())
        .collect();
    let term = |term: &Term| match *term {
        Term::Spring(e) | Term::Damper(e) | Term::Inerter(e) | Term::Force(e) => e,
    };
    let rates = link.law.inner.iter().map(|inner| inner.rate);
    Link {
        name: link.name.clone(),
        axis: link.direction.0.clone(),
        ends,
        parameters: parameters_of(model, link.law.terms.iter().map(term).chain(rates)),
    }
}

fn mass(model: &Checked, c: &Coordinate) -> Option<Mass> {
    let CoordinateKind::Mass(inertia) = c.kind else {
        return None;
    };
    Some(Mass {
        location: c.name.clone(),
        axis: c.direction.0.clone(),
        angle: c.angle,
        parameters: parameters_of(model, [inertia]),
    })
}

/// The places of the parameters on which expressions depend.
fn parameters_of(model: &Checked, of: impl IntoIterator<Item = Expr>) -> Vec<u16> {
    let place = |symbol| match symbol {
        Symbol::Parameter(place) => Some(place),
        _ => None,
    };
    model.graph.symbols(of).into_iter().filter_map(place).collect()
}

fn contact(model: &Checked, motion: &Motion, tyre: &RollingTyre) -> Contact {
    let place = |symbol| {
        motion
            .states
            .iter()
            .position(|&state| state == symbol)
            .map(|place| place as u16)
    };
    let axis = |&c: &CoordinateId| {
        let axis = coordinate(model, c).direction.0.clone();
        let (position, velocity) = (place(Symbol::Position(c))?, place(Symbol::Velocity(c))?);
        Some(ContactAxis {
            axis,
            position,
            velocity,
        })
    };
    Contact {
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
