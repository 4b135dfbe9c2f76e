//! Records over time: measurement, residuals before and after, and the travel of a force.

use qcar_runtime::campaign::{Quantity, Role};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::observe::{Kind, Series, Stimulus};
use qcar_runtime::discover::posterior::Explanation;
use qcar_runtime::mean::{deviation, rms};
use qcar_runtime::transmissibility::Point;
use serde::Serialize;

use super::gather::Study;
use crate::report::rounded::curve;

/// A sensor in a record.
#[derive(Serialize)]
pub struct Replayed {
    run: String,
    role: &'static str,
    /// The sensor.
    channel: String,
    quantity: &'static str,
    unit: &'static str,
    /// Times, s.
    time: Vec<f64>,
    measured: Vec<f64>,
    before: Vec<f64>,
    after: Option<Vec<f64>>,
    /// NRMS: RMS of the residual over RMS of the measured signal without its mean.
    nrms_before: f64,
    nrms_after: Option<f64>,
    /// Prescribed travel, for a force.
    travel: Option<Travel>,
}

/// A prescribed motion at the times of a record.
#[derive(Serialize)]
struct Travel {
    /// Travel, m, or an angle, rad.
    displacement: Vec<f64>,
    /// Speed, m/s or rad/s.
    velocity: Vec<f64>,
    /// Their units.
    units: TravelUnits,
}

/// Units of a prescribed motion.
#[derive(Serialize)]
struct TravelUnits {
    displacement: &'static str,
    velocity: &'static str,
}

/// The records of a study.
pub fn records(of: &Study) -> Vec<Replayed> {
    let (evidence, discovery) = (&of.answer.evidence, &of.answer.discovery);
    let extended = !discovery.findings.is_empty();
    let series = evidence.series.iter().enumerate();
    let timed = series.filter(|(_, series)| series.kind == Kind::Time);
    let replayed = timed.map(|(place, series)| {
        let run = &evidence.runs[series.run];
        let model = |of: &Explanation| modelled(of, place, series);
        let measured: Vec<f64> = series.value.iter().map(|value| value.re).collect();
        let before = model(&discovery.before);
        let after = extended.then(|| model(&discovery.after));
        Replayed {
            run: run.name.clone(),
            role: if run.role == Role::Fit { "fit" } else { "held_out" },
            channel: format!("{} {}", series.sensor.place(), series.sensor.axis.name()),
            quantity: series.sensor.quantity.name(),
            unit: series.sensor.unit(),
            time: curve(series.at.iter().copied()),
            nrms_before: nrms(&measured, &before),
            nrms_after: after.as_ref().map(|after| nrms(&measured, after)),
            measured: curve(measured),
            before: curve(before),
            after: after.map(curve),
            travel: travel(evidence, series),
        }
    });
    replayed.collect()
}

/// Modelled values, from the residuals.
fn modelled(of: &Explanation, place: usize, series: &Series) -> Vec<f64> {
    let left = of.misfit.residuals[place].iter().zip(&series.sigma);
    let modelled = series
        .value
        .iter()
        .zip(left)
        .map(|(value, (residual, sigma))| value.re - residual * sigma);
    modelled.collect()
}

fn nrms(measured: &[f64], modelled: &[f64]) -> f64 {
    rms(measured.iter().zip(modelled).map(|(a, b)| a - b)) / deviation(measured)
}

/// The prescribed travel of a force; `None` without any.
fn travel(evidence: &Evidence, series: &Series) -> Option<Travel> {
    let Stimulus::History { inputs, rate, .. } = &evidence.runs[series.run].stimulus else {
        return None;
    };
    let input = |(point, _): &&(Point, Vec<f64>)| moves(point, series);
    let (point, samples) = inputs.signals.iter().find(input)?;
    let place = |time: f64| ((time - inputs.start) * rate).round() as usize;
    let slope = |at: usize| {
        let (low, high) = (at.saturating_sub(1), (at + 1).min(samples.len() - 1));
        (samples[high] - samples[low]) * rate / (high - low) as f64
    };
    Some(Travel {
        displacement: curve(series.at.iter().map(|&time| samples[place(time)])),
        velocity: curve(series.at.iter().map(|&time| slope(place(time)))),
        units: TravelUnits {
            displacement: point.unit(),
            velocity: Quantity::Velocity.unit_of(point.turns),
        },
    })
}

/// True if an input is the travel for the abscissa of a force.
fn moves(input: &Point, series: &Series) -> bool {
    input.quantity == Quantity::Displacement
        && series.sensor.quantity == Quantity::Force
        && input.axis == series.sensor.axis
}
