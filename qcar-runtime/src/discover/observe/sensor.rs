//! Sensors in the words of a model.

use crate::campaign::{History, Quantity};
use crate::model::{About, Signal, SignalKind};
use crate::response::signal::output_of;
use crate::transmissibility::{End, Point, points};

/// What a sensor measures, in the model's words.
///
/// On a link a displacement is its stretch. A sensor at an end of a place stands at the point of this name, `sf_front`, where
/// the model has one, any other sensor at `sf_sensor`, and at the place itself where it has not.
pub fn signal_of(about: &About, point: &Point) -> Signal {
    let link = about
        .links
        .iter()
        .any(|link| link.name == point.location && link.axis == point.axis.name());
    let kind = match point.quantity {
        Quantity::Force => SignalKind::Force,
        Quantity::Displacement if link => SignalKind::Stretch,
        Quantity::Displacement => SignalKind::Motion(crate::model::Quantity::Position),
        Quantity::Velocity => SignalKind::Motion(crate::model::Quantity::Velocity),
        Quantity::Acceleration => SignalKind::Motion(crate::model::Quantity::Acceleration),
    };
    Signal {
        location: location_of(about, point).into(),
        axis: point.axis.name().into(),
        kind,
    }
}

fn location_of(about: &About, point: &Point) -> String {
    let own = format!("{}_{}", point.location, point.end.map_or("sensor", End::name));
    let is_it = |signal: &Signal| signal.location == own && signal.axis == point.axis.name();
    if about.outputs.iter().any(|output| is_it(&output.signal)) {
        own
    } else {
        point.location.clone()
    }
}

/// The sensors of a run: what drives a model as the mean of all sensors of a place, and what answers by the ends of the place.
pub fn sensors(about: &About, history: &History) -> Vec<Point> {
    let ends = |point: Point| match excitation_of(about, &point) {
        Some(_) => vec![point],
        None => point.ends(history),
    };
    points(history).into_iter().flat_map(ends).collect()
}

/// How many times a motion has been differentiated where a sensor measures it.
pub fn order_of(point: &Point) -> i32 {
    match point.quantity {
        Quantity::Acceleration => 2,
        Quantity::Velocity => 1,
        Quantity::Displacement | Quantity::Force => 0,
    }
}

/// The excitation of the model that a sensor measures, if it measures one.
pub fn excitation_of(about: &About, point: &Point) -> Option<usize> {
    about.excitations.iter().position(|excitation| {
        let force = point.quantity == Quantity::Force;
        excitation.name == point.location && excitation.axis == point.axis.name() && excitation.force == force
    })
}

/// True of a sensor at a place that the model has.
pub fn is_known(about: &About, point: &Point) -> bool {
    excitation_of(about, point).is_some() || output_of(about, &signal_of(about, point)).is_ok()
}

/// True of a sensor at a motion that drives the model.
pub fn is_motion(about: &About, point: &Point) -> bool {
    excitation_of(about, point).is_some_and(|place| !about.excitations[place].force)
}
