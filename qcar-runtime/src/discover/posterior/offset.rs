//! Removes sensor offsets that are confounded with a parameter of the model.

use nalgebra::DVector;

use crate::campaign::Role;
use crate::discover::noise::Nuisance;
use crate::discover::observe::{Evidence, Free, PredictError, Prediction, Run, Stimulus, predict_sides};
use crate::model::Model;
use crate::response::parameters::Values;

/// Largest share of the power of a derivative outside its mean, for a derivative that counts as constant.
const CONSTANT: f64 = 1e-5;
/// Share of a power that counts as rounding error.
const ROUNDING: f64 = 1e-9;

/// Removes the offset of each sensor whose reading a free parameter shifts by a constant, up to changes of the initial
/// states.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn remove_confounded(
    mut nuisance: Nuisance,
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
) -> Result<Nuisance, PredictError> {
    let is_record = |run: &Run| run.role == Role::Fit && matches!(run.stimulus, Stimulus::History { .. });
    let conditions = nuisance.conditions(evidence, &vec![0.0; nuisance.count()]);
    let predictions = predict_sides(model, [values, values], &conditions, free, evidence, &is_record)?;
    nuisance.without_offset.clear();
    for prediction in &predictions {
        let sensor = &evidence.series[prediction.series].sensor;
        let is_known = nuisance.without_offset.iter().any(|(known, _)| known == sensor);
        if let Some(owner) = owner(model, free, prediction).filter(|_| !is_known) {
            nuisance.without_offset.push((sensor.clone(), owner));
        }
    }
    Ok(nuisance)
}

/// Name of the parameter, or of the initial state, that shifts a prediction by a constant; `None` if there is none. An
/// initial state does so if no force acts against it. The zero of a run is no state of the model.
fn owner(model: &dyn Model, free: &[Free], prediction: &Prediction) -> Option<String> {
    let real = |slope: &[nalgebra::Complex<f64>]| DVector::from_iterator(slope.len(), slope.iter().map(|s| s.re));
    let constant = DVector::from_element(prediction.value.len(), 1.0);
    let mut of_states: Vec<DVector<f64>> = Vec::new();
    let is_state = |name: &str| model.about().states.iter().any(|state| state.name == name);
    for (state, slope) in prediction.by_initial_states.iter().filter(|(name, _)| is_state(name)) {
        let column = real(slope);
        if is_multiple(&column, &constant) {
            return Some(state.clone());
        }
        let own = without(&column, &of_states);
        if own.norm_squared() > ROUNDING * column.norm_squared() {
            of_states.push(own.normalize());
        }
    }
    let constant = without(&constant, &of_states);
    let moves = |(free, slope): (&Free, &Vec<nalgebra::Complex<f64>>)| {
        let column = real(slope);
        let own = without(&column, &of_states);
        let is_independent = own.norm_squared() > ROUNDING * column.norm_squared();
        let name = &model.about().parameters[free.parameter].name;
        (is_independent && is_multiple(&own, &constant)).then(|| name.to_string())
    };
    free.iter().zip(&prediction.slopes).find_map(moves)
}

/// The part of a column that is orthogonal to orthonormal others.
fn without(column: &DVector<f64>, others: &[DVector<f64>]) -> DVector<f64> {
    others.iter().fold(column.clone(), |left, other| {
        let share = left.dot(other);
        left - other * share
    })
}

/// True if the columns are parallel and not zero.
fn is_multiple(one: &DVector<f64>, other: &DVector<f64>) -> bool {
    let powers = one.norm_squared() * other.norm_squared();
    powers > 0.0 && one.dot(other).powi(2) > (1.0 - CONSTANT) * powers
}
