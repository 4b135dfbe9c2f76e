//! From where a model sets out when it is driven by a record, and where it is set right on the way.
//!
//! The place of a mass that nothing holds remembers every force that ever acted on it: the smallest error of a force
//! ends as a drift. A fit lives on that, since nothing tells the parameters better. A run that judges does not: there
//! such a mass is put back to where its sensor saw it at the beginning of each of [`WINDOWS`] windows, and within a
//! window the model is on its own (multiple shooting: Bock, H. G., Plitt, K. J., IFAC world congress, 1984).

use crate::campaign::{Quantity, Role};
use crate::model::{About, Matrix, StateKind};
use crate::transmissibility::Point;

/// What sensors saw at one sample of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Restart {
    /// Number of the sample.
    pub sample: usize,
    /// Sensors of position and velocity with their values, SI.
    pub seen: Vec<(Point, f64)>,
}

/// Windows of a record.
const WINDOWS: usize = 20;

/// Where a model begins that is driven by a record with these responses, and where it is set right.
pub(super) fn restarts(about: &About, role: Role, responses: &[(Point, Vec<f64>)], rate: f64) -> Vec<Restart> {
    let moving =
        |(point, _): &&(Point, Vec<f64>)| matches!(point.quantity, Quantity::Displacement | Quantity::Velocity);
    let seen = responses.iter().filter(moving).map(|(point, y)| (point.clone(), y[0]));
    let start = Restart {
        sample: 0,
        seen: seen.collect(),
    };
    let drifting = |(point, _): &&(Point, Vec<f64>)| role == Role::HeldOut && drifts(about, point);
    let drifting: Vec<_> = responses.iter().filter(drifting).collect();
    let length = drifting.first().map_or(0, |(_, y)| y.len());
    let window = length.div_ceil(WINDOWS);
    let later = (1..WINDOWS).map(|k| k * window).take_while(|&sample| sample < length);
    let again = later.map(|sample| Restart {
        sample,
        seen: drifting
            .iter()
            .flat_map(|(point, y)| at_sample(point, y, sample, rate))
            .collect(),
    });
    std::iter::once(start).chain(again).collect()
}

/// True of the position of a mass on which nothing depends: no link holds it.
fn drifts(about: &About, point: &Point) -> bool {
    let here = |state: &crate::model::State| {
        state.kind == StateKind::Position && state.location == point.location && state.axis == point.axis.name()
    };
    let Some(state) = about.states.iter().position(here) else {
        return false;
    };
    let matters = |entry: &crate::model::Entry| entry.matrix == Matrix::A && usize::from(entry.column) == state;
    point.quantity == Quantity::Displacement && !about.matrices.iter().any(matters)
}

/// Position and velocity there; this is the slope of the straight line through the samples around.
fn at_sample(point: &Point, y: &[f64], sample: usize, rate: f64) -> [(Point, f64); 2] {
    const AROUND: usize = 5;
    let around = AROUND.min(y.len() - 1 - sample).min(sample);
    let (mut slope, mut weight) = (0.0, f64::MIN_POSITIVE);
    for k in 1..=around {
        slope += k as f64 * (y[sample + k] - y[sample - k]);
        weight += 2.0 * (k * k) as f64;
    }
    let velocity = Point {
        quantity: Quantity::Velocity,
        ..point.clone()
    };
    [(point.clone(), y[sample]), (velocity, slope / weight * rate)]
}
