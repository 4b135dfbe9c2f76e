//! Uneven samples, such as messages of a bus, resampled by linear interpolation.

use qcar_signals::samples::Samples;
use qcar_signals::signal::TimeBase;

use super::super::steps;

/// Share of steps of unusual length above which a channel counts as uneven; below it, it is a record with gaps.
const SHARE: f64 = 0.05;
/// Number of usual steps without a sample that count as a gap, which is not interpolated.
const GAP: f64 = 10.0;

/// Steps of an uneven channel without gaps.
pub(super) struct Pace {
    /// Mean number of steps per second.
    pub rate: f64,
    /// Shortest and longest step, s.
    pub steps: (f64, f64),
    /// Step length above which there is a gap, s.
    gap: f64,
}

impl Pace {
    /// Steps of these times; `None` if they are even.
    pub fn of(times: &[f64]) -> Option<Pace> {
        if steps::all_alike(times) {
            return None;
        }
        let steps: Vec<f64> = times.windows(2).map(|two| two[1] - two[0]).collect();
        let usual = steps::median(steps.get(..).filter(|steps| !steps.is_empty())?);
        let others = steps.iter().filter(|step| !steps::is_one(**step, 1.0 / usual)).count();
        let inner: Vec<f64> = steps.iter().copied().filter(|step| *step <= GAP * usual).collect();
        let rate = inner.len() as f64 / inner.iter().sum::<f64>();
        (rate.is_finite() && others as f64 > SHARE * steps.len() as f64).then(|| Pace {
            rate,
            steps: (
                inner.iter().copied().fold(f64::INFINITY, f64::min),
                inner.iter().copied().fold(0.0, f64::max),
            ),
            gap: GAP * usual,
        })
    }
}

/// An uneven channel, resampled.
pub(super) struct Resampled {
    pub base: TimeBase,
    /// Values in the unit of the file; NaN in a gap.
    pub values: Vec<f64>,
    /// Shortest and longest step without gaps, s.
    pub steps: (f64, f64),
}

/// Values of an uneven channel at `rate`, Hz; `None` for an even channel or one without times.
pub(super) fn resampled(base: &TimeBase, values: &Samples, rate: f64) -> Option<Resampled> {
    let TimeBase::Times(times) = base else { return None };
    let pace = Pace::of(times)?;
    let (&start, &end) = (times.first()?, times.last()?);
    let count = ((end - start) * rate + 1e-3).floor() as usize + 1;
    // If there are many more times than samples, most are in gaps and would only fill the memory.
    (count as f64 <= GAP * times.len() as f64).then_some(())?;
    let mut after = 1;
    let at = |k: usize| {
        let instant = start + k as f64 / rate;
        while after + 1 < times.len() && times[after] < instant {
            after += 1;
        }
        let (from, to) = (times[after - 1], times[after]);
        let share = if to > from {
            ((instant - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            1.0
        };
        match to - from > pace.gap {
            true => f64::NAN,
            false => values.at(after - 1) + share * (values.at(after) - values.at(after - 1)),
        }
    };
    Some(Resampled {
        values: (0..count).map(at).collect(),
        base: TimeBase::Even {
            start,
            step: 1.0 / rate,
        },
        steps: pace.steps,
    })
}
