//! Units of signals and of their ratios.

use crate::model::{About, Channel, Input, InputKind, Quantity, Signal, SignalKind};

/// The unit of a channel, such as `(m/s^2)/N`; `1` for signals of one kind.
pub fn unit(about: &About, channel: &Channel) -> String {
    let [above, below] = [&channel.numerator, &channel.denominator].map(|signal| unit_of(about, signal));
    // An angular over a linear acceleration is an angle over a length.
    let rates = |unit: &str| unit.split_once('/').map(|(_, rates)| rates.to_string());
    let [above, below] = match (rates(&above), rates(&below)) {
        (Some(a), Some(b)) if a == b => [above, below].map(|unit| unit.trim_end_matches(&format!("/{a}")).to_string()),
        _ => [above, below],
    };
    let grouped = |unit: String| {
        if unit.contains(['/', ' ']) {
            format!("({unit})")
        } else {
            unit
        }
    };
    match (above, below) {
        (above, below) if above == below => "1".to_string(),
        (above, below) if below == "1" => above,
        (above, below) => format!("{}/{}", grouped(above), grouped(below)),
    }
}

/// Unit of a signal: that of its output or input, or the unit that follows from another derivative of the same motion.
fn unit_of(about: &About, signal: &Signal) -> String {
    let here = |other: &Signal| other.location == signal.location && other.axis == signal.axis;
    let outputs = about.outputs.iter().filter(|output| here(&output.signal));
    let inputs = about
        .inputs
        .iter()
        .filter(|input| driven(about, input).as_ref().is_some_and(here));
    let known = outputs.map(|output| (output.signal.kind, &output.unit));
    let known = known.chain(inputs.filter_map(|input| Some((driven(about, input)?.kind, &input.unit))));
    let known: Vec<_> = known.collect();
    if let Some((_, unit)) = known.iter().find(|(kind, _)| *kind == signal.kind) {
        return unit.to_string();
    }
    let turns = known.iter().any(|(_, unit)| !unit.starts_with('m'));
    let unit = match (signal.kind, turns) {
        (SignalKind::Motion(Quantity::Position), false) => "m",
        (SignalKind::Motion(Quantity::Velocity), false) => "m/s",
        (SignalKind::Motion(Quantity::Acceleration), false) => "m/s^2",
        (SignalKind::Motion(Quantity::Position), true) => "rad",
        (SignalKind::Motion(Quantity::Velocity), true) => "rad/s",
        (SignalKind::Motion(Quantity::Acceleration), true) => "rad/s^2",
        _ => "1",
    };
    unit.to_string()
}

/// The signal of an input.
fn driven(about: &About, input: &Input) -> Option<Signal> {
    let (place, kind) = match input.kind {
        InputKind::Motion(place, quantity) => (place, SignalKind::Motion(quantity)),
        InputKind::Force(place) => (place, SignalKind::Force),
        InputKind::Gravity => return None,
    };
    let excitation = about.excitations.get(usize::from(place))?;
    Some(Signal {
        location: excitation.name.clone(),
        axis: excitation.axis.clone(),
        kind,
    })
}
