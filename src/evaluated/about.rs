//! What the compiler knows of a model, in the words of the runtime.

use std::borrow::Cow;

use qcar_dsl::about as dsl;
use qcar_dsl::model;
use qcar_runtime::model as runtime;

/// Translates name by name; the places are the same on both sides.
pub(super) fn about(about: &dsl::About) -> runtime::About {
    runtime::About {
        name: text(&about.name),
        doc: text(&about.doc),
        parameters: list(&about.parameters, parameter),
        states: list(&about.states, state),
        inputs: list(&about.inputs, input),
        outputs: list(&about.outputs, output),
        excitations: list(&about.excitations, excitation),
        channels: list(&about.channels, channel),
        links: list(&about.links, link),
        masses: list(&about.masses, mass),
        contact: about.contact.as_ref().map(contact),
        constants: about.constants,
        linear: about.linear,
        matrices: list(&about.matrices, entry),
        sensitivities: list(&about.sensitivities, |(at, parameter)| (entry(at), *parameter)),
        parameter_jacobian: Cow::Owned(about.parameter_jacobian.clone()),
        responses: list(&about.responses, response),
    }
}

fn text(of: &str) -> Cow<'static, str> {
    Cow::Owned(of.into())
}

fn list<T, U: Clone>(of: &[T], translate: impl FnMut(&T) -> U) -> Cow<'static, [U]> {
    Cow::Owned(of.iter().map(translate).collect())
}

fn parameter(of: &dsl::Parameter) -> runtime::Parameter {
    runtime::Parameter {
        name: text(&of.name),
        unit: text(&of.unit.to_string()),
        doc: text(&of.doc),
        default: match of.default {
            model::Default::None => runtime::Default::None,
            model::Default::Value(value) => runtime::Default::Value(value),
            model::Default::Same(other) => runtime::Default::Same(other),
        },
        range: of.range,
        known: of.known,
        clock: of.clock.map(|clock| match clock {
            dsl::Clock::Seconds => runtime::Clock::Seconds,
            dsl::Clock::PartOfRun => runtime::Clock::PartOfRun,
        }),
    }
}

fn state(of: &dsl::State) -> runtime::State {
    let [name, unit, location, axis] = [&of.name, &of.unit.to_string(), &of.location, &of.axis].map(|t| text(t));
    let kind = match of.kind {
        dsl::StateKind::Position => runtime::StateKind::Position,
        dsl::StateKind::Velocity => runtime::StateKind::Velocity,
        dsl::StateKind::Inner => runtime::StateKind::Inner,
    };
    runtime::State {
        name,
        unit,
        location,
        axis,
        kind,
    }
}

fn input(of: &dsl::Input) -> runtime::Input {
    let [name, unit, axis] = [&of.name, &of.unit.to_string(), &of.axis].map(|t| text(t));
    let kind = match of.kind {
        dsl::InputKind::Motion(at, of) => runtime::InputKind::Motion(at, quantity(of)),
        dsl::InputKind::Force(at) => runtime::InputKind::Force(at),
        dsl::InputKind::Gravity => runtime::InputKind::Gravity,
    };
    runtime::Input { name, unit, axis, kind }
}

fn quantity(of: model::Quantity) -> runtime::Quantity {
    match of {
        model::Quantity::Position => runtime::Quantity::Position,
        model::Quantity::Velocity => runtime::Quantity::Velocity,
        model::Quantity::Acceleration => runtime::Quantity::Acceleration,
    }
}

fn signal(of: &dsl::Signal) -> runtime::Signal {
    runtime::Signal {
        location: text(&of.location),
        axis: text(&of.axis),
        kind: match of.kind {
            dsl::SignalKind::Motion(of) => runtime::SignalKind::Motion(quantity(of)),
            dsl::SignalKind::Force => runtime::SignalKind::Force,
            dsl::SignalKind::Stretch => runtime::SignalKind::Stretch,
        },
    }
}

fn output(of: &dsl::Output) -> runtime::Output {
    runtime::Output {
        name: text(&of.name),
        unit: text(&of.unit.to_string()),
        signal: signal(&of.signal),
    }
}

fn excitation(of: &dsl::Excitation) -> runtime::Excitation {
    let force = matches!(of.source, dsl::Source::Force(_));
    runtime::Excitation {
        name: text(&of.name),
        axis: text(&of.axis),
        force,
        road: of.road,
    }
}

fn channel(of: &dsl::Channel) -> runtime::Channel {
    let (numerator, denominator) = (signal(&of.numerator), signal(&of.denominator));
    runtime::Channel {
        name: text(&of.name),
        numerator,
        denominator,
    }
}

fn link(of: &dsl::Link) -> runtime::Link {
    runtime::Link {
        name: text(&of.name),
        axis: text(&of.axis),
        ends: list(&of.ends, |end| text(end)),
        parameters: Cow::Owned(of.parameters.clone()),
    }
}

fn mass(of: &dsl::Mass) -> runtime::Mass {
    runtime::Mass {
        location: text(&of.location),
        axis: text(&of.axis),
        angle: of.angle,
        parameters: Cow::Owned(of.parameters.clone()),
    }
}

fn contact(of: &dsl::Contact) -> runtime::ContactAbout {
    let axis = |of: &dsl::ContactAxis| runtime::ContactAxis {
        axis: text(&of.axis),
        position: of.position,
        velocity: of.velocity,
    };
    runtime::ContactAbout {
        link: of.link,
        axes: list(&of.axes, axis),
    }
}

fn entry(of: &dsl::Entry) -> runtime::Entry {
    let matrix = match of.matrix {
        dsl::Matrix::A => runtime::Matrix::A,
        dsl::Matrix::B => runtime::Matrix::B,
        dsl::Matrix::C => runtime::Matrix::C,
        dsl::Matrix::D => runtime::Matrix::D,
    };
    runtime::Entry {
        matrix,
        row: of.row,
        column: of.column,
    }
}

fn response(of: &dsl::ResponseLayout) -> runtime::ResponseLayout {
    runtime::ResponseLayout {
        outputs: Cow::Owned(of.outputs.clone()),
        jacobian: Cow::Owned(of.jacobian.clone()),
    }
}
