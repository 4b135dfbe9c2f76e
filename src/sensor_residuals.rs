//! The residual of each sensor, in percent of its signal.

use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::observe::Kind;
use qcar_runtime::discover::posterior::{Explanation, SensorShare};
use qcar_runtime::transmissibility::Point;
use serde::Serialize;

/// Residual of one sensor in one kind of run.
#[derive(Serialize)]
pub(crate) struct SensorResidual {
    /// The sensor.
    pub channel: String,
    /// What it measures.
    pub quantity: &'static str,
    /// Kind of its values.
    pub kind: &'static str,
    /// RMS of the residual over RMS of the measured signal, percent, before.
    pub before_percent: f64,
    /// The same after.
    pub after_percent: f64,
}

/// RMS of the residual over its standard deviation; `null` without such a run.
#[derive(Serialize)]
pub(crate) struct BeforeAfter {
    before: Option<f64>,
    after: Option<f64>,
}

impl BeforeAfter {
    pub(crate) fn new(before: f64, after: f64) -> Self {
        let finite = |value: f64| value.is_finite().then_some(value);
        BeforeAfter {
            before: finite(before),
            after: finite(after),
        }
    }
}

/// Residuals of every sensor in every kind of run, on the runs that judge a model, and on fitted ones of other kinds.
/// Higher harmonics are left out, because they are small, and so are sensors that show nothing but noise.
pub(crate) fn left(evidence: &Evidence, [before, after]: [&Explanation; 2]) -> Vec<SensorResidual> {
    let [before, after] = [before, after].map(|of| of.misfit.judged_sensor_shares(evidence));
    let left = |(before, after): (SensorShare, SensorShare)| SensorResidual {
        channel: channel(before.sensor),
        quantity: before.sensor.quantity.name(),
        kind: word(before.kind),
        before_percent: 100.0 * before.missed(),
        after_percent: 100.0 * after.missed(),
    };
    let pairs = before.into_iter().zip(after);
    let shown = pairs.filter(|(before, after)| !(before.is_noise() && after.is_noise()));
    shown.map(left).collect()
}

/// Name of the kind of run.
fn word(kind: Kind) -> &'static str {
    match kind {
        Kind::Harmonic(_) => "sweep",
        Kind::Time => "record",
        Kind::Passage => "cleat",
        Kind::Travel => "kc_force",
        Kind::Width => "kc_hysteresis",
        Kind::Speed => "dynamometer",
        Kind::Cycle(_) => "kc_sine",
    }
}

/// Runs of a kind in a sentence.
pub(crate) fn runs(kind: Kind) -> &'static str {
    match kind {
        Kind::Harmonic(_) => "sweeps",
        Kind::Time => "records",
        Kind::Passage => "cleat runs",
        Kind::Travel => "K&C curves",
        Kind::Width => "the hysteresis of K&C curves",
        Kind::Speed => "dynamometer runs",
        Kind::Cycle(_) => "K&C sines",
    }
}

/// Name of a sensor in tables and JSON.
pub(crate) fn channel(sensor: &Point) -> String {
    format!("{}_{}", sensor.place().replace(' ', "_"), sensor.axis.name())
}
