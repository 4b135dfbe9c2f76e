//! `static ABOUT`: the description of a generated model.

use qcar_model::{
    About, Channel, Clock, ContactAxis, Entry, Excitation, Input, InputKind, Link, Mass, Output, Parameter,
    ResponseLayout, Signal, SignalKind, State, StateKind,
};

use crate::back::straight::{entry_name, parameter_jacobian_names, sensitivity_names};
use crate::model::{Default, Quantity};

/// The static and the arrays that it borrows.
pub fn about(about: &About) -> String {
    [
        format!(
            "/// Names, units, sizes and sparsity.
pub static ABOUT: interface::About = interface::About {{
    name: Borrowed({:?}),
    doc: Borrowed({:?}),
    parameters: Borrowed(&ABOUT_PARAMETERS),
    states: Borrowed(&ABOUT_STATES),
    inputs: Borrowed(&ABOUT_INPUTS),
    outputs: Borrowed(&ABOUT_OUTPUTS),
    excitations: Borrowed(&ABOUT_EXCITATIONS),
    channels: Borrowed(&ABOUT_CHANNELS),
    links: Borrowed(&ABOUT_LINKS),
    masses: Borrowed(&ABOUT_MASSES),
    contact: {},
    constants: CONSTANTS,
    linear: {},
    matrices: Borrowed(&MATRICES),
    sensitivities: Borrowed(&SENSITIVITIES),
    parameter_jacobian: Borrowed(&PARAMETER_JACOBIAN),
    responses: Borrowed(&ABOUT_RESPONSES),
}};
",
            about.name,
            about.doc,
            contact(about),
            about.linear
        ),
        parameters(about),
        states(about),
        inputs(about),
        outputs(about),
        excitations(about),
        channels(about),
        links(about),
        masses(about),
        responses(about),
        matrices(about),
        sensitivities(about),
        parameter_jacobian(about),
    ]
    .join("\n")
}

/// A private array, with one item in each line.
fn array(name: &str, kind: &str, items: Vec<String>) -> String {
    table(
        "",
        name,
        &format!("interface::{kind}"),
        items.iter().map(|item| format!("interface::{kind} {item},")).collect(),
    )
}

/// An array, with one item in each line; the items include their commas.
fn table(front: &str, name: &str, kind: &str, items: Vec<String>) -> String {
    let lines: String = items.iter().map(|item| format!("    {item}\n")).collect();
    format!("{front}static {name}: [{kind}; {}] = [\n{lines}];\n", items.len())
}

fn text(text: &str) -> String {
    format!("Borrowed({text:?})")
}

fn parameters(about: &About) -> String {
    let item = |p: &Parameter| {
        let default = match p.default {
            Default::None => "interface::Default::None".to_string(),
            Default::Value(value) => format!("interface::Default::Value({value:?})"),
            Default::Same(other) => format!("interface::Default::Same({other})"),
        };
        let clock = match p.clock {
            None => "None",
            Some(Clock::Seconds) => "Some(interface::Clock::Seconds)",
            Some(Clock::PartOfRun) => "Some(interface::Clock::PartOfRun)",
        };
        format!(
            "{{ name: {}, unit: {}, doc: {}, default: {default}, range: {:?}, known: {}, clock: {clock} }}",
            text(&p.name),
            text(&p.unit),
            text(&p.doc),
            p.range,
            p.known
        )
    };
    array(
        "ABOUT_PARAMETERS",
        "Parameter",
        about.parameters.iter().map(item).collect(),
    )
}

fn states(about: &About) -> String {
    let item = |s: &State| {
        let kind = match s.kind {
            StateKind::Position => "Position",
            StateKind::Velocity => "Velocity",
            StateKind::Inner => "Inner",
        };
        format!(
            "{{ name: {}, unit: {}, location: {}, axis: {}, kind: interface::StateKind::{kind} }}",
            text(&s.name),
            text(&s.unit),
            text(&s.location),
            text(&s.axis)
        )
    };
    array("ABOUT_STATES", "State", about.states.iter().map(item).collect())
}

fn inputs(about: &About) -> String {
    let item = |i: &Input| {
        let kind = match i.kind {
            InputKind::Motion(excitation, derivative) => format!("Motion({excitation}, {})", quantity(derivative)),
            InputKind::Force(excitation) => format!("Force({excitation})"),
            InputKind::Gravity => "Gravity".into(),
        };
        format!(
            "{{ name: {}, unit: {}, axis: {}, kind: interface::InputKind::{kind} }}",
            text(&i.name),
            text(&i.unit),
            text(&i.axis)
        )
    };
    array("ABOUT_INPUTS", "Input", about.inputs.iter().map(item).collect())
}

fn outputs(about: &About) -> String {
    let item = |o: &Output| {
        let (name, unit) = (text(&o.name), text(&o.unit));
        format!("{{ name: {name}, unit: {unit}, signal: {} }}", signal(&o.signal))
    };
    array("ABOUT_OUTPUTS", "Output", about.outputs.iter().map(item).collect())
}

fn excitations(about: &About) -> String {
    let item = |e: &Excitation| {
        let (name, axis) = (text(&e.name), text(&e.axis));
        format!("{{ name: {name}, axis: {axis}, force: {}, road: {} }}", e.force, e.road)
    };
    array(
        "ABOUT_EXCITATIONS",
        "Excitation",
        about.excitations.iter().map(item).collect(),
    )
}

fn channels(about: &About) -> String {
    let item = |c: &Channel| {
        let (above, below) = (signal(&c.numerator), signal(&c.denominator));
        format!(
            "{{ name: {}, numerator: {above}, denominator: {below} }}",
            text(&c.name)
        )
    };
    array("ABOUT_CHANNELS", "Channel", about.channels.iter().map(item).collect())
}

fn links(about: &About) -> String {
    let item = |l: &Link| {
        let ends = l.ends.iter().map(|end| text(end)).collect::<Vec<_>>().join(", ");
        format!(
            "{{ name: {}, axis: {}, ends: Borrowed(&[{ends}]), parameters: Borrowed(&{:?}) }}",
            text(&l.name),
            text(&l.axis),
            l.parameters
        )
    };
    array("ABOUT_LINKS", "Link", about.links.iter().map(item).collect())
}

fn masses(about: &About) -> String {
    let item = |m: &Mass| {
        let (location, axis) = (text(&m.location), text(&m.axis));
        format!(
            "{{ location: {location}, axis: {axis}, angle: {}, parameters: Borrowed(&{:?}) }}",
            m.angle, m.parameters
        )
    };
    array("ABOUT_MASSES", "Mass", about.masses.iter().map(item).collect())
}

fn responses(about: &About) -> String {
    let item = |r: &ResponseLayout| {
        let jacobian = r
            .jacobian
            .iter()
            .map(|pair| format!("{pair:?}"))
            .collect::<Vec<_>>()
            .join(", ");
        format!(
            "{{ outputs: Borrowed(&{:?}), jacobian: Borrowed(&[{jacobian}]) }}",
            r.outputs
        )
    };
    array(
        "ABOUT_RESPONSES",
        "ResponseLayout",
        about.responses.iter().map(item).collect(),
    )
}

fn contact(about: &About) -> String {
    let Some(contact) = &about.contact else {
        return "None".into();
    };
    let axis = |a: &ContactAxis| {
        let (position, velocity) = (a.position, a.velocity);
        format!(
            "interface::ContactAxis {{ axis: {}, position: {position}, velocity: {velocity} }}",
            text(&a.axis)
        )
    };
    let axes = contact.axes.iter().map(axis).collect::<Vec<_>>().join(", ");
    format!(
        "Some(interface::ContactAbout {{ link: {}, axes: Borrowed(&[{axes}]) }})",
        contact.link
    )
}

fn matrices(about: &About) -> String {
    let item = |entry: &Entry| format!("{}, // {}", at(entry), entry_name(about, entry));
    let documentation = "/// The nonzeros of A, B, C and D.\npub ";
    table(
        documentation,
        "MATRICES",
        "Entry",
        about.matrices.iter().map(item).collect(),
    )
}

fn sensitivities(about: &About) -> String {
    let names = sensitivity_names(about);
    let item = |(entry, parameter): &(Entry, u16)| format!("({}, {parameter}),", at(entry));
    let items = about
        .sensitivities
        .iter()
        .map(item)
        .zip(names)
        .map(|(item, name)| format!("{item} // {name}"));
    let documentation = "/// The nonzeros of the parameter Jacobians of A, B, C and D, with the parameter.\npub ";
    table(documentation, "SENSITIVITIES", "(Entry, u16)", items.collect())
}

fn parameter_jacobian(about: &About) -> String {
    let names = parameter_jacobian_names(about);
    let items = about
        .parameter_jacobian
        .iter()
        .zip(names)
        .map(|(entry, name)| format!("{entry:?}, // {name}"));
    let documentation = "/// The nonzeros of ∂f/∂p and ∂h/∂p: true for an output, row, parameter.\npub ";
    table(documentation, "PARAMETER_JACOBIAN", "(bool, u16, u16)", items.collect())
}

fn at(entry: &Entry) -> String {
    format!("Entry::at(Matrix::{:?}, {}, {})", entry.matrix, entry.row, entry.column)
}

fn signal(signal: &Signal) -> String {
    let kind = match signal.kind {
        SignalKind::Motion(derivative) => format!("Motion({})", quantity(derivative)),
        SignalKind::Force => "Force".into(),
        SignalKind::Stretch => "Stretch".into(),
    };
    let (location, axis) = (text(&signal.location), text(&signal.axis));
    format!("interface::Signal {{ location: {location}, axis: {axis}, kind: interface::SignalKind::{kind} }}")
}

fn quantity(quantity: Quantity) -> String {
    format!("interface::Quantity::{quantity:?}")
}
