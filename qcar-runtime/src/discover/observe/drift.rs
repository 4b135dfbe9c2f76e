//! Runs with a slowly changing parameter, such as a fading damper. The model is evaluated for several times of the run,
//! each with the parameter fixed at its value at that time. Predictions between these times are interpolated. A
//! parameter that changes within one oscillation needs a state in the model instead.

use nalgebra::Complex;

use super::run::line_at;
use super::{Delay, Evidence, Kind, PredictError, Prediction, Run, Series, Stimulus};

/// Smallest distance between these times, s: three periods of a body mode at 1 Hz, the slowest mode of an axle.
const SPACING: f64 = 3.0;
/// Largest number of these times, a choice: a prediction takes this many times as long. Predictions are taken as linear
/// between two of them.
const MOST_TIMES: usize = 6;

/// Prediction of a run, interpolated from predictions `at` a part of the run (0 to 1) and the length of the run (s).
///
/// # Errors
/// Fails where `at` fails.
pub fn through(
    evidence: &Evidence,
    run: usize,
    at: impl Fn(f64, f64) -> Result<Vec<Prediction>, PredictError>,
) -> Result<Vec<Prediction>, PredictError> {
    let length = length(&evidence.runs[run].stimulus);
    let last = ((length / SPACING).ceil() as usize).min(MOST_TIMES - 1);
    let mut predictions = Vec::new();
    for k in 0..=last {
        predictions.push(at(k as f64 / last.max(1) as f64, length)?);
    }
    let read = |place: usize| {
        let of_times: Vec<&Prediction> = predictions.iter().map(|own| &own[place]).collect();
        let series = &evidence.series[of_times[0].series];
        let moments = moments(series, &evidence.runs[run]).into_iter();
        let weights: Vec<(usize, f64)> = moments.map(|moment| between(last, moment / length)).collect();
        blended(&of_times, &weights)
    };
    Ok((0..predictions[0].len()).map(read).collect())
}

impl Evidence {
    /// Duration of the longest run, s.
    pub fn longest(&self) -> f64 {
        let runs = self.runs.iter();
        runs.map(|run| length(&run.stimulus)).fold(0.0, f64::max)
    }
}

/// Duration of the motion, s; 0 for tests whose values have no time.
fn length(stimulus: &Stimulus) -> f64 {
    match stimulus {
        Stimulus::Sweep { time, .. } => time.iter().copied().fold(0.0, f64::max),
        Stimulus::History { inputs, .. } => inputs.whole.end - inputs.whole.start,
        Stimulus::Cleat(passage) => passage.duration,
        Stimulus::Travel { .. } | Stimulus::Sine { .. } | Stimulus::Dynamometer { .. } => 0.0,
    }
}

/// Time of each value of a series, s after the beginning of the run.
fn moments(series: &Series, run: &Run) -> Vec<f64> {
    let swept = |at: &f64| match &run.stimulus {
        Stimulus::Sweep { frequency, time, .. } => time[line_at(frequency, *at)],
        _ => 0.0,
    };
    let start = match &run.stimulus {
        Stimulus::History { inputs, .. } => inputs.whole.start,
        _ => 0.0,
    };
    match series.kind {
        Kind::Harmonic(_) => series.at.iter().map(swept).collect(),
        Kind::Time | Kind::Passage => series.at.iter().map(|at| at - start).collect(),
        Kind::Travel | Kind::Width | Kind::Speed | Kind::Cycle(_) => vec![0.0; series.at.len()],
    }
}

/// Step of a run divided into `last` steps that contains a position (0 to 1 over the run), and the position in this
/// step (0 to 1).
fn between(last: usize, part: f64) -> (usize, f64) {
    if last == 0 {
        return (0, 0.0);
    }
    let place = part.clamp(0.0, 1.0) * last as f64;
    let earlier = (place as usize).min(last - 1);
    (earlier, place - earlier as f64)
}

/// Linear interpolation of predictions at successive times.
fn blended(of_times: &[&Prediction], weights: &[(usize, f64)]) -> Prediction {
    let blend = |part: &dyn Fn(&Prediction) -> Vec<Complex<f64>>| -> Vec<Complex<f64>> {
        let parts: Vec<Vec<Complex<f64>>> = of_times.iter().map(|own| part(own)).collect();
        let value = |(k, &(earlier, weight)): (usize, &(usize, f64))| {
            let later = (earlier + 1).min(parts.len() - 1);
            parts[earlier][k] * (1.0 - weight) + parts[later][k] * weight
        };
        weights.iter().enumerate().map(value).collect()
    };
    let first = of_times[0];
    let delay = first.delay.as_ref().map(|own| Delay {
        slope: blend(&|p| p.delay.as_ref().map_or_else(Vec::new, |own| own.slope.clone())),
        shares: own.shares.clone(),
    });
    Prediction {
        series: first.series,
        value: blend(&|p| p.value.clone()),
        slopes: (0..first.slopes.len())
            .map(|k| blend(&|p| p.slopes[k].clone()))
            .collect(),
        delay,
        by_drive: (0..first.by_drive.len())
            .map(|k| blend(&|p| p.by_drive[k].clone()))
            .collect(),
        by_initial_states: (0..first.by_initial_states.len())
            .map(|k| {
                (
                    first.by_initial_states[k].0.clone(),
                    blend(&|p| p.by_initial_states[k].1.clone()),
                )
            })
            .collect(),
    }
}
