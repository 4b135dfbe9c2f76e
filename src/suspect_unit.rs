//! Units that the samples of a channel contradict; the engineer decides.

use qcar_runtime::statics::GRAVITY;
use qcar_signals::si::{in_si, is_known};

/// A body at rest has an acceleration of 1 g if gravity is not subtracted: tolerance of the mean, relative to 1 g.
const ABOUT_ONE: f64 = 0.05;
/// Largest plausible suspension travel, m.
const TRAVEL: f64 = 1.0;

/// Statistics of a channel, in its unit.
pub(crate) struct Statistics {
    pub mean: f64,
    pub min: f64,
    pub max: f64,
}

/// Why a unit is probably wrong, from the statistics of its samples; `None` if it may be right.
pub(crate) fn suspicion(unit: &str, does: Option<Statistics>) -> Option<String> {
    if unit.is_empty() {
        return None;
    }
    if !is_known(unit) {
        return Some(format!(
            "`{unit}` is no unit that is known; give its channel `unit` and `scale`"
        ));
    }
    let si = in_si(unit)?;
    let is_plain = si.multiply == si.divide;
    let Statistics {
        mean,
        min: low,
        max: high,
    } = does?;
    let swings = low < 0.0 && high > 0.0;
    match si.dimension {
        [0, 1, -2] if is_plain && (mean.abs() - 1.0).abs() < ABOUT_ONE && high > low => Some(format!(
            "a mean of {mean:.2} {unit} is that of a sensor at rest in g; if it is, give `unit = \"g\"`"
        )),
        [0, 1, 0] if is_plain && swings && high.max(-low) > TRAVEL => Some(format!(
            "{low:.3} to {high:.3} {unit} is more than a part of a car travels; if it is mm, give `unit = \"mm\"`"
        )),
        [1, 1, -2] if unit == "kp" => Some("`kp` is an old name of kgf, and taken for 9.80665 N".into()),
        _ => None,
    }
}

/// A sentence on an acceleration in this unit whose mean is that of gravity; `None` for any other signal.
pub(crate) fn gravity(unit: &str, does: &Statistics) -> Option<String> {
    let si = in_si(unit).filter(|si| si.dimension == [0, 1, -2])?;
    let mean = does.mean * si.multiply / si.divide;
    let is_gravity = (mean.abs() / GRAVITY - 1.0).abs() < ABOUT_ONE && does.max > does.min;
    is_gravity.then(|| {
        let mean = does.mean;
        format!(
            "a mean of {mean:.3} {unit} is that of gravity, which is no motion of the model; subtract it, as `offset` or \
             `zero = \"start\"` of a channel with a `source` do"
        )
    })
}
