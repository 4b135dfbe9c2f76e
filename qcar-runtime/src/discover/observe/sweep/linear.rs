//! Predicts sweeps by a linear model: the first harmonic is the frequency response, and there are no others.

use nalgebra::Complex;

use super::excitation;
use crate::discover::observe::{Evidence, Free, Kind, PredictError, Prediction, Stimulus, signal_of};
use crate::model::Model;
use crate::response::parameters::Values;
use crate::response::ratio::Ratios;

pub fn sweep(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let about = model.about();
    let Stimulus::Sweep { reference, .. } = &evidence.runs[run].stimulus else {
        return Ok(Vec::new());
    };
    let excitation = excitation(model, evidence, run, reference)?;
    let below = signal_of(about, reference);
    let mut ratios = match free {
        [] => Ratios::new(model, values),
        _ => Ratios::with_derivatives(model, values),
    };
    let mut predictions = Vec::new();
    for (place, series) in evidence
        .series
        .iter()
        .enumerate()
        .filter(|(_, series)| series.run == run)
    {
        if series.kind != Kind::Harmonic(1) {
            predictions.push(zero_response(place, series.at.len(), free.len()));
            continue;
        }
        let above = signal_of(about, &series.sensor);
        let ratio = ratios.ratio(excitation, [&above, &below], &series.at)?;
        let slope = |free: &Free| {
            let found = ratio.jacobian.iter().find(|(leader, _)| *leader == free.parameter);
            found.map_or_else(|| vec![Complex::ZERO; series.at.len()], |(_, slope)| slope.clone())
        };
        predictions.push(Prediction {
            series: place,
            slopes: free.iter().map(slope).collect(),
            value: ratio.value,
            delay: None,
            by_drive: Vec::new(),
            by_initial_states: Vec::new(),
        });
    }
    Ok(predictions)
}

fn zero_response(series: usize, values: usize, free: usize) -> Prediction {
    let zero = vec![Complex::ZERO; values];
    Prediction {
        series,
        slopes: vec![zero.clone(); free],
        value: zero,
        delay: None,
        by_drive: Vec::new(),
        by_initial_states: Vec::new(),
    }
}
