//! Known states of a model at some samples of a record.

use crate::campaign::Quantity;
use crate::model::{State, StateKind};
use crate::transmissibility::Point;

/// Sensor readings at one sample of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Restart {
    /// Number of the sample.
    pub sample: usize,
    /// Sensors of position and velocity with their values, SI.
    pub readings: Vec<(Point, f64)>,
}

/// Standard deviations of the initial states of a record, SI: about the sensor reading, or about rest without a sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// Of states that a sensor of position or velocity measures.
    pub measured: Vec<(Point, f64)>,
    /// Of other positions, velocities and forces, from their size in the record; zero if it is unknown.
    pub unmeasured: [f64; 3],
}

impl Spread {
    /// Standard deviation of a state of the model; `None` if its size is unknown. An angle counts as the motion at the
    /// end of a lever of one metre.
    pub fn sigma(&self, state: &State) -> Option<f64> {
        let measured = self
            .measured
            .iter()
            .find(|(point, _)| measures(state, point))
            .map(|(_, sigma)| *sigma);
        let [position, velocity, force] = self.unmeasured;
        let unmeasured = match &*state.unit {
            "m" | "rad" | "1" if state.kind != StateKind::Inner => position,
            "m" => position,
            "m/s" | "rad/s" | "1/s" => velocity,
            "N" => force,
            _ => 0.0,
        };
        measured.or(Some(unmeasured)).filter(|sigma| *sigma > 0.0)
    }
}

/// True if a sensor measures the state itself.
pub fn measures(state: &State, point: &Point) -> bool {
    let kind = match point.quantity {
        Quantity::Displacement => StateKind::Position,
        Quantity::Velocity => StateKind::Velocity,
        Quantity::Acceleration | Quantity::Force => return false,
    };
    point.side.is_none() && state.kind == kind && state.location == point.location && state.axis == point.axis.name()
}
