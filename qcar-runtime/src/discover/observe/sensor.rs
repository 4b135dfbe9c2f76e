//! Sensors as signals of a model.

use crate::campaign::{History, Quantity, Side};
use crate::model::{About, Signal};
use crate::response::signal::output_of;
use crate::spelling::nearest;
use crate::transmissibility::{Point, points};

/// The signal of the model that a sensor measures.
///
/// A displacement sensor on a link measures its stretch. A sensor at an end of a place is at the point of that name,
/// such as `sf_front`, if the model has one. Any other sensor is at the point with the suffix `_sensor`, such as
/// `sf_sensor`, if the model has one. Otherwise it is at the place itself.
pub fn signal_of(about: &About, point: &Point) -> Signal {
    Signal {
        location: location_of(about, point).into(),
        axis: point.axis.name().to_owned().into(),
        kind: point.kind(about),
    }
}

fn location_of(about: &About, point: &Point) -> String {
    let own = format!("{}_{}", point.location, point.side.map_or("sensor", Side::name));
    let is_it = |signal: &Signal| signal.location == own && signal.axis == point.axis.name();
    if about.outputs.iter().any(|output| is_it(&output.signal)) {
        own
    } else {
        point.location.clone()
    }
}

/// Sensors of a run. An excitation is the mean of all sensors of a place; responses are separate for each end of a
/// place.
pub fn sensors(about: &About, history: &History) -> Vec<Point> {
    let ends = |point: Point| match excitation_of(about, &point) {
        Some(_) => vec![point],
        None => point.ends(history),
    };
    points(history).into_iter().flat_map(ends).collect()
}

/// Order of the time derivative of a motion that a sensor measures; 0 for a force.
pub fn order_of(point: &Point) -> i32 {
    match point.quantity {
        Quantity::Acceleration => 2,
        Quantity::Velocity => 1,
        Quantity::Displacement | Quantity::Force => 0,
    }
}

/// Position of the excitation that a sensor measures; `None` if it measures a response.
pub fn excitation_of(about: &About, point: &Point) -> Option<usize> {
    about.excitations.iter().position(|excitation| {
        let force = point.quantity == Quantity::Force;
        excitation.name == point.location && excitation.axis == point.axis.name() && excitation.force == force
    })
}

/// True if the model has the place of the sensor.
pub fn is_known(about: &About, point: &Point) -> bool {
    excitation_of(about, point).is_some() || output_of(about, &signal_of(about, point)).is_ok()
}

/// A place of the model on the axis of the sensor that is spelt like its own, but is another.
pub fn nearest_place<'a>(about: &'a About, point: &Point) -> Option<&'a str> {
    let excitations = about.excitations.iter().map(|own| (&own.name, &own.axis));
    let outputs = about.outputs.iter().map(|own| (&own.signal.location, &own.signal.axis));
    let all = excitations.chain(outputs);
    let along = all
        .filter(|(_, axis)| **axis == *point.axis.name())
        .map(|(name, _)| &**name);
    nearest(&point.location, along).filter(|nearest| *nearest != point.location)
}

/// What a model does not give for a sensor, and the remedy.
pub fn missing(about: &About, point: &Point) -> [String; 2] {
    let (location, model) = (&point.location, &about.name);
    let (quantity, axis) = (point.quantity.name(), point.axis.name());
    let remedy = match nearest_place(about, point) {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None => format!(
            "if it should, add `output {location}.{};` to the model",
            point.kind(about).word()
        ),
    };
    let what = format!("model `{model}` gives no {quantity} of `{location}` along {axis}");
    [what, remedy]
}

/// True if the sensor measures a motion that drives the model.
pub fn is_motion(about: &About, point: &Point) -> bool {
    excitation_of(about, point).is_some_and(|place| !about.excitations[place].force)
}
