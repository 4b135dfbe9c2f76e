//! Missing dynamic stiffness κ at every place of a model.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::lines::{Direction, Lines};
use super::missing_stiffness::{MissingStiffness, Place};
use crate::campaign::Role;
use crate::discover::observe::{Evidence, Free, PredictError, predict};
use crate::discover::posterior::Refit;
use crate::model::Model;
use crate::response::parameters::Values;

/// Finite change of a parameter that determines `H(s,F)`, relative to its value. In a linear model any change gives the
/// same `H(s,F)`. This one exceeds the tolerance of a harmonic balance by far.
const FINITE: f64 = 0.3;

/// κ at every place of the model, the best explanation first.
///
/// Uses the fitted runs alone. Refit the base model with some tolerance first ([`Evidence::with_tolerance`]): a wrong
/// model that is fitted closely distributes its error over all its parameters.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn stiffness_map(
    model: &dyn Model,
    refit: &Refit,
    evidence: &Evidence,
) -> Result<Vec<MissingStiffness>, PredictError> {
    let places = places(model, &refit.values);
    let base = predict(model, &refit.values, &places, evidence, Role::Fit)?;
    let lines = Lines::new(refit, evidence, &base);
    let mut map = Vec::new();
    for (column, free) in places.iter().enumerate() {
        let mut values = refit.values.clone();
        let change = FINITE * values.as_slice()[free.parameter];
        values.set(free.parameter, values.as_slice()[free.parameter] + change);
        let changed = Lines::new(refit, evidence, &predict(model, &values, &[], evidence, Role::Fit)?);
        let unit = Unit::of(&model.about().parameters[free.parameter].unit);
        let compliance = lines.compliance(column, &changed, change);
        let direction = Direction::Slope(column);
        let of = |f: f64| unit.stiffness(f);
        map.push(lines.missing_stiffness(Place::Parameter(free.parameter), &direction, &compliance, of));
    }
    for sensor in lines.sensors() {
        let direction = Direction::Sensor(sensor.clone());
        map.push(lines.missing_stiffness(Place::Sensor(sensor), &direction, &lines.rigid(), |_| Complex::ONE));
    }
    // A place that no channel sees explains nothing.
    map.retain(|kappa| kappa.ceiling > 0.0);
    map.sort_by(|a, b| b.ceiling.total_cmp(&a.ceiling));
    Ok(map)
}

/// Nonzero parameters with the unit of a stiffness, a damping or a mass. Of tied parameters only the leader counts.
fn places(model: &dyn Model, values: &Values) -> Vec<Free> {
    let about = model.about();
    let wanted = |&k: &usize| {
        Unit::of(&about.parameters[k].unit) != Unit::Other && values.leader(k) == k && values.as_slice()[k] != 0.0
    };
    let free = |parameter| Free {
        parameter,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };
    (0..about.parameters.len()).filter(wanted).map(free).collect()
}

/// Conversion of a parameter to a dynamic stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    Stiffness,
    Damping,
    Mass,
    Other,
}

impl Unit {
    fn of(unit: &str) -> Self {
        match unit {
            "N/m" => Unit::Stiffness,
            "N s/m" | "N*s/m" | "N/(m/s)" => Unit::Damping,
            "kg" => Unit::Mass,
            _ => Unit::Other,
        }
    }

    fn stiffness(self, f: f64) -> Complex<f64> {
        let rate = Complex::new(0.0, TAU * f);
        match self {
            Unit::Damping => rate,
            Unit::Mass => rate * rate,
            Unit::Stiffness | Unit::Other => Complex::ONE,
        }
    }
}
