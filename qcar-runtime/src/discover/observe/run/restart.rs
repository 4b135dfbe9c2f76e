//! Known states of a model at some samples of a record.

use crate::campaign::Quantity;
use crate::matrices::dynamics;
use crate::model::{Model, State, StateKind};
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
    /// Of other positions, velocities, accelerations and forces, from their size in the record; zero if it is unknown.
    pub unmeasured: [f64; 4],
    /// Of the zero of each sensor and each recorded force, which changes from run to run.
    pub zeros: Vec<(Point, f64)>,
}

/// Name of the zero of a sensor among the initial states of a record.
pub fn zero_of(sensor: &Point) -> String {
    format!(
        "zero of {} {} {}",
        sensor.place(),
        sensor.axis.name(),
        sensor.quantity.name()
    )
}

impl Spread {
    /// Standard deviation of each state of a model, for a value of each parameter; `None` if its size is unknown. An
    /// angle counts as the motion at the end of a lever of one metre. Without a sensor of forces, the force of a law is as
    /// large as causes the accelerations of the record.
    fn sigmas(&self, model: &dyn Model, p: &[f64]) -> Vec<Option<f64>> {
        let a = dynamics(model, p);
        let states = &model.about().states;
        let moves = |row: &usize| states[*row].kind == StateKind::Velocity;
        let by_force = |force: usize| {
            (0..states.len())
                .filter(moves)
                .map(|row| a[(row, force)].abs())
                .fold(0.0, f64::max)
        };
        let sigma = |(place, state): (usize, &State)| self.sigma(state, by_force(place));
        states.iter().enumerate().map(sigma).collect()
    }

    /// What is unknown of a record: the states of a model whose size is known, for a value of each parameter, and the zeros
    /// of the sensors. Each with its name and standard deviation.
    pub fn unknown(&self, model: &dyn Model, p: &[f64]) -> Vec<(String, f64)> {
        let states = model.about().states.iter().zip(self.sigmas(model, p));
        let states = states.filter_map(|(state, sigma)| Some((state.name.to_string(), sigma?)));
        let zeros = self.zeros.iter().map(|(sensor, sigma)| (zero_of(sensor), *sigma));
        states.chain(zeros).collect()
    }

    /// Standard deviation of a state that causes this acceleration, in m/s^2 per unit.
    fn sigma(&self, state: &State, acceleration: f64) -> Option<f64> {
        let measured = self
            .measured
            .iter()
            .find(|(point, _)| measures(state, point))
            .map(|(_, sigma)| *sigma);
        let [position, velocity, of_motion, force] = self.unmeasured;
        let unmeasured = match &*state.unit {
            "m" | "rad" | "1" if state.kind != StateKind::Inner => position,
            "m" => position,
            "m/s" | "rad/s" | "1/s" => velocity,
            "N" if force > 0.0 => force,
            "N" if acceleration > 0.0 => of_motion / acceleration,
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
