//! What is known of the states of a model at some samples of a record.

use crate::campaign::Quantity;
use crate::model::{State, StateKind};
use crate::transmissibility::Point;

/// What sensors saw at one sample of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Restart {
    /// Number of the sample.
    pub sample: usize,
    /// Sensors of position and velocity with their values, SI.
    pub seen: Vec<(Point, f64)>,
}

/// How far a model may be, when a record begins, from where sensors saw it or, where none did, from rest: standard
/// deviations, SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// Of what a sensor of position or velocity saw.
    pub seen: Vec<(Point, f64)>,
    /// Of other positions, velocities and forces, as far as the record tells how large they become; zero where it does not.
    pub unseen: [f64; 3],
}

impl Spread {
    /// Of a state of the model; `None` where nothing is known of its size. Angles are taken on a lever of a metre.
    pub fn sigma(&self, state: &State) -> Option<f64> {
        let seen = self
            .seen
            .iter()
            .find(|(point, _)| is_seen(state, point))
            .map(|(_, sigma)| *sigma);
        let [position, velocity, force] = self.unseen;
        let unseen = match &*state.unit {
            "m" | "rad" | "1" if state.kind != StateKind::Inner => position,
            "m" => position,
            "m/s" | "rad/s" | "1/s" => velocity,
            "N" => force,
            _ => 0.0,
        };
        seen.or(Some(unseen)).filter(|sigma| *sigma > 0.0)
    }
}

/// True where a sensor shows a state itself.
pub fn is_seen(state: &State, point: &Point) -> bool {
    let kind = match point.quantity {
        Quantity::Displacement => StateKind::Position,
        Quantity::Velocity => StateKind::Velocity,
        Quantity::Acceleration | Quantity::Force => return false,
    };
    point.end.is_none() && state.kind == kind && state.location == point.location && state.axis == point.axis.name()
}
