//! The variables of an FMU: parameters, inputs, states, their derivatives, outputs, kinks and time, in the order of the
//! value references.

use std::collections::HashSet;
use std::ops::Range;

use qcar_dsl::about::{About, InputKind};
use qcar_dsl::c::motion_kinks;
use qcar_dsl::model::Quantity;
use qcar_dsl::schedule::Compiled;
use qcar_dsl::units::Unit;

use super::tyre::{self, Fact, OnTyre};
use crate::export::Subject;

/// Kind of a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    Parameter,
    /// A parameter that is fixed after initialisation.
    Fixed,
    Input,
    State,
    /// Derivative of the state at this position.
    Derivative(usize),
    Output,
    /// An indicator whose sign gives the side of a law's kink.
    Kink,
    Time,
}

/// A variable.
pub struct Variable {
    pub name: String,
    pub role: Role,
    pub description: String,
    /// Name and description of its unit.
    pub unit: (String, Unit),
    /// Start value, if it has one.
    pub start: Option<f64>,
}

impl Variable {
    /// Typical size of a state on a rough road, to which the tolerance of a small state is relative.
    pub fn nominal(&self) -> Option<f64> {
        (self.role == Role::State).then(|| nominal(self.unit.1))
    }
}

/// All variables; the position of a variable is its value reference.
pub struct Variables {
    pub all: Vec<Variable>,
    parameters: usize,
    inputs: usize,
    states: usize,
    outputs: usize,
    /// Number of kinks.
    pub kinks: usize,
    /// True if the model rolls on its tyre.
    pub rolls: bool,
}

impl Variables {
    /// The variables of a model.
    pub fn of(subject: Subject, tyre: Option<&OnTyre>) -> Self {
        let (compiled, about) = (subject.compiled, &subject.compiled.about);
        let kinks = motion_kinks(subject.compiled).outputs.len();
        let facts = tyre.map_or_else(Vec::new, |tyre| tyre.own_facts(about));
        let contact = if tyre.is_some() { &tyre::OUTPUTS[..] } else { &[] };
        let (parameters, outputs) = (
            about.parameters.len() + facts.len(),
            about.outputs.len() + contact.len(),
        );
        let mut all: Vec<Variable> = self::parameters(subject)
            .chain(facts.into_iter().map(fact))
            .chain(inputs(compiled, tyre.is_some()))
            .chain(states(compiled, tyre))
            .collect();
        all.extend(
            derivatives(compiled)
                .chain(self::outputs(compiled))
                .chain(contact.iter().copied().map(force))
                .chain((1..=kinks).map(kink))
                .chain([time()]),
        );
        make_distinct(&mut all);
        Variables {
            all,
            parameters,
            inputs: about.inputs.len(),
            states: about.states.len(),
            outputs,
            kinks,
            rolls: tyre.is_some(),
        }
    }

    /// The value reference of the first input.
    pub fn first_input(&self) -> usize {
        self.parameters
    }

    /// The value reference of the first state.
    pub fn first_state(&self) -> usize {
        self.first_input() + self.inputs
    }

    /// The value reference of the first derivative.
    pub fn first_derivative(&self) -> usize {
        self.first_state() + self.states
    }

    /// The value reference of the first output.
    pub fn first_output(&self) -> usize {
        self.first_derivative() + self.states
    }

    /// The value references of all inputs and states.
    pub fn moving(&self) -> Range<usize> {
        self.first_input()..self.first_derivative()
    }

    /// The value reference of the first kink.
    pub fn first_kink(&self) -> usize {
        self.first_output() + self.outputs
    }
}

/// Typical sizes: a centimetre, a decimetre per second, a hundred newtons.
fn nominal(unit: Unit) -> f64 {
    let speed = Unit::METER.per(Unit::SECOND);
    match unit {
        _ if unit == Unit::METER => 1e-2,
        _ if unit == speed => 0.1,
        _ if unit == Unit::NEWTON => 1e2,
        _ => 1.0,
    }
}

fn parameters(subject: Subject) -> impl Iterator<Item = Variable> {
    let declared = &subject.compiled.model.parameters;
    declared.iter().zip(subject.values).map(|(own, &value)| Variable {
        name: own.name.clone(),
        role: Role::Parameter,
        description: own.doc.clone(),
        unit: (own.unit_name.clone(), own.unit),
        start: Some(value),
    })
}

fn fact(own: Fact) -> Variable {
    Variable {
        name: own.name.into(),
        role: Role::Fixed,
        description: own.doc.into(),
        unit: (own.unit.0.into(), own.unit.1),
        start: Some(own.value),
    }
}

fn inputs(compiled: &Compiled, rolls: bool) -> impl Iterator<Item = Variable> {
    let inputs = compiled.about.inputs.iter().zip(&compiled.vectors.inputs);
    inputs.map(move |(input, own)| Variable {
        name: input.name.to_string(),
        role: Role::Input,
        description: meaning(&compiled.about, input.kind, rolls),
        unit: (input.unit.to_string(), own.unit),
        start: Some(0.0),
    })
}

/// Description of an input for the user of the unit.
fn meaning(about: &About, kind: InputKind, rolls: bool) -> String {
    let excitation = |place: u16| &about.excitations[usize::from(place)];
    match kind {
        InputKind::Gravity => "Acceleration of gravity; 0 because states are relative to rest under gravity".into(),
        InputKind::Force(place) => format!("Force {}", excitation(place).name),
        InputKind::Motion(place, quantity) => {
            let (name, road) = (&excitation(place).name, excitation(place).road);
            let what = match (road, rolls) {
                (true, false) => "Effective road height under",
                (true, true) => "Height by which all of the profile is lifted,",
                (false, _) => "Position of",
            };
            match quantity {
                Quantity::Position => format!("{what} {name}"),
                Quantity::Velocity => format!("First derivative of the position of {name} by time: connect both"),
                Quantity::Acceleration => format!("Second derivative of the position of {name} by time: connect all"),
            }
        }
    }
}

fn states<'a>(compiled: &'a Compiled, tyre: Option<&'a OnTyre>) -> impl Iterator<Item = Variable> + 'a {
    let states = compiled.about.states.iter().zip(&compiled.vectors.states).enumerate();
    states.map(move |(place, (state, own))| Variable {
        name: state.name.to_string(),
        role: Role::State,
        description: format!("State of {} along {}", state.location, state.axis),
        unit: (state.unit.to_string(), own.unit),
        start: Some(tyre.map_or(0.0, |tyre| tyre.rest[place])),
    })
}

fn derivatives(compiled: &Compiled) -> impl Iterator<Item = Variable> {
    let states = compiled.about.states.iter().zip(&compiled.vectors.states);
    states.enumerate().map(|(place, (state, own))| {
        let unit = own.unit.per(Unit::SECOND);
        Variable {
            name: format!("der_{}", state.name),
            role: Role::Derivative(place),
            description: format!("Derivative of {} by time", state.name),
            unit: (unit.to_string(), unit),
            start: None,
        }
    })
}

fn outputs(compiled: &Compiled) -> impl Iterator<Item = Variable> {
    let outputs = compiled.about.outputs.iter().zip(&compiled.vectors.outputs);
    outputs.map(|(output, &unit)| Variable {
        name: output.name.to_string(),
        role: Role::Output,
        description: format!("Signal of {} along {}", output.signal.location, output.signal.axis),
        unit: (output.unit.to_string(), unit),
        start: None,
    })
}

/// Signals of the contact of a rolling tyre.
fn force((name, doc): (&str, &str)) -> Variable {
    Variable {
        name: name.into(),
        role: Role::Output,
        description: doc.into(),
        unit: ("N".into(), Unit::NEWTON),
        start: None,
    }
}

fn kink(number: usize) -> Variable {
    Variable {
        name: format!("kink_{number}"),
        role: Role::Kink,
        description: "Changes its sign at a kink or jump of a law".into(),
        unit: ("1".into(), Unit::ONE),
        start: None,
    }
}

fn time() -> Variable {
    Variable {
        name: "time".into(),
        role: Role::Time,
        description: "Time".into(),
        unit: ("s".into(), Unit::SECOND),
        start: None,
    }
}

/// Makes names unique: a repeated name gets a `_`.
fn make_distinct(variables: &mut [Variable]) {
    let mut used = HashSet::new();
    for variable in variables {
        while !used.insert(variable.name.clone()) {
            variable.name.push('_');
        }
    }
}
