//! The prediction of a model for the sweeps of a campaign: the ratios of its signals over frequency.

use std::collections::BTreeMap;

use nalgebra::Complex;
use qcar_runtime::discover::observe::{Evidence, Kind, Stimulus, predict};
use qcar_runtime::model::{Channel, Model};
use qcar_runtime::progress::{self, OnProgress};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::ratio::Ratios;

/// A model with values. A nonlinear model is evaluated at the level of each run, at the lines of its data.
pub enum LevelResponses<'a> {
    /// A model that counts as linear.
    Linear(Box<Ratios<'a, dyn Model + 'a>>),
    /// Responses of a nonlinear model.
    Nonlinear(BTreeMap<Key, Response>),
}

/// A run and a location.
type Key = (String, String);
/// Frequencies, Hz, and the first harmonic over the pad.
type Response = (Vec<f64>, Vec<Complex<f64>>);

/// Progress text.
pub fn swept_by(campaign: &str, model: &dyn Model) -> String {
    format!("{campaign}: {} in sweep", model.about().name)
}

impl<'a> LevelResponses<'a> {
    /// A model for small motions about rest, for any run.
    pub fn at_rest(model: &'a dyn Model, values: &'a Values) -> Self {
        LevelResponses::Linear(Box::new(Ratios::new(model, values)))
    }

    /// A model in the sweeps of a campaign.
    pub fn new(model: &'a dyn Model, values: &'a Values, evidence: &Evidence, on_progress: OnProgress<'_>) -> Self {
        if model.about().linear {
            return LevelResponses::at_rest(model, values);
        }
        let is_sweep = |run: &usize| matches!(evidence.runs[*run].stimulus, Stimulus::Sweep { .. });
        let sweeps = (0..evidence.runs.len()).filter(is_sweep);
        let sweeps: Vec<Evidence> = sweeps.map(|run| evidence.only(|own| own == run)).collect();
        let responses = progress::map(&sweeps, on_progress, |sweep| responses(model, values, sweep));
        LevelResponses::Nonlinear(responses.into_iter().flatten().collect())
    }

    /// A channel in a run with an excitation, at these frequencies (Hz); `None` if the model lacks it.
    pub fn ratio(
        &mut self,
        run: &str,
        excitation: usize,
        of: &Channel,
        frequency: &[f64],
    ) -> Option<Vec<Complex<f64>>> {
        let Channel {
            numerator, denominator, ..
        } = of;
        let responses = match self {
            LevelResponses::Linear(ratios) => {
                let ratio = ratios.ratio(excitation, [numerator, denominator], frequency);
                return ratio.ok().map(|ratio| ratio.value);
            }
            LevelResponses::Nonlinear(responses) => responses,
        };
        let response = |location: &str| responses.get(&(run.to_string(), location.to_string()));
        let (lines, above) = response(&numerator.location)?;
        // The pad is the reference of all responses.
        let ratio = match response(&denominator.location) {
            None => above.clone(),
            Some((_, below)) => above.iter().zip(below).map(|(above, below)| above / below).collect(),
        };
        Some(frequency.iter().map(|&f| between(lines, &ratio, f)).collect())
    }
}

/// Responses of a model in one sweep.
fn responses(model: &dyn Model, values: &Values, sweep: &Evidence) -> BTreeMap<Key, Response> {
    let run = &sweep.runs[0];
    let predictions = predict(model, values, &[], sweep, run.role).unwrap_or_default();
    let mut first: BTreeMap<Key, Response> = BTreeMap::new();
    for prediction in predictions {
        let series = &sweep.series[prediction.series];
        if series.kind != Kind::Harmonic(1) {
            continue;
        }
        let value = prediction.value;
        let key = (run.name.clone(), series.sensor.location.clone());
        // The motion of a place is the mean of its ends.
        let mean = |(_, of_front): &mut Response| {
            let both = of_front.iter_mut().zip(&value);
            both.for_each(|(front, rear)| *front = (*front + rear) * 0.5);
        };
        first
            .entry(key)
            .and_modify(mean)
            .or_insert_with(|| (series.at.clone(), value.clone()));
    }
    first
}

/// Linear interpolation between two neighbours; NaN outside.
pub fn between(at: &[f64], values: &[Complex<f64>], wanted: f64) -> Complex<f64> {
    let right = at.partition_point(|&f| f < wanted);
    match (right.checked_sub(1), at.get(right)) {
        (_, Some(&f)) if f == wanted => values[right],
        (Some(left), Some(&f)) => {
            let share = (wanted - at[left]) / (f - at[left]);
            values[left] * (1.0 - share) + values[right] * share
        }
        _ => Complex::new(f64::NAN, f64::NAN),
    }
}
