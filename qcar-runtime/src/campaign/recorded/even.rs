//! Samples at a constant rate, without gaps.

use std::ops::Range;

use qcar_signals::resample::Grid;
use qcar_signals::samples::Samples;
use qcar_signals::signal::TimeBase;

use super::super::steps;
use super::uneven::Pace;

/// Relative distance from a whole number of hertz within which a rate is rounded to it.
const WHOLE: f64 = 1e-6;
/// Tolerance of a time at the ends of the window, in samples.
const SLACK: f64 = 1e-3;

/// A part of a channel without gaps.
pub(super) struct Even {
    /// Samples in the window, and those around it that a filter may need.
    pub samples: Range<usize>,
    /// Their times.
    pub grid: Grid,
    /// Positions of those in the window, counted from the first.
    pub inside: Range<usize>,
}

/// Reasons why a window has no even samples.
pub(super) struct UnevenWindow {
    /// Time of the fault, s, if it is at one instant.
    pub at: Option<f64>,
    pub found: String,
    pub expected: String,
    pub remedy: &'static str,
}

/// Time of a sample, s; without times it is the number of the sample.
pub(super) fn time(base: &TimeBase, at: usize) -> f64 {
    match base {
        TimeBase::Even { start, step } => start + at as f64 * step,
        TimeBase::Times(times) => times[at],
        TimeBase::Uneven { .. } | TimeBase::Unknown => at as f64,
    }
}

/// Samples per second: the declared rate if the times agree with it, otherwise theirs; `None` for less than two
/// samples.
pub(super) fn rate(base: &TimeBase, count: usize, declared: Option<f64>) -> Option<f64> {
    let own = match base {
        TimeBase::Even { step, .. } => 1.0 / step,
        TimeBase::Times(times) if times.len() > 1 => {
            Pace::of(times).map_or_else(|| usual_rate(times), |pace| pace.rate)
        }
        TimeBase::Times(_) | TimeBase::Uneven { .. } | TimeBase::Unknown => return declared,
    };
    let declared = declared.filter(|declared| steps::agree(own, *declared, count.max(2) - 1));
    let whole = Some(own.round()).filter(|whole| (own - whole).abs() < WHOLE * whole);
    declared
        .or(whole)
        .or(Some(own))
        .filter(|rate| rate.is_finite() && *rate > 0.0)
}

/// Mean rate of the steps that are one sample long.
fn usual_rate(times: &[f64]) -> f64 {
    if steps::all_alike(times) {
        let sum: f64 = times.windows(2).map(|two| two[1] - two[0]).sum();
        return (times.len() - 1) as f64 / sum;
    }
    let steps: Vec<f64> = times.windows(2).map(|two| two[1] - two[0]).collect();
    let typical = 1.0 / steps::median(&steps);
    let ones: Vec<f64> = steps.into_iter().filter(|step| steps::is_one(*step, typical)).collect();
    ones.len() as f64 / ones.iter().sum::<f64>()
}

impl Even {
    /// Samples from `from` to `to` (s; `None` for the whole channel), with up to `margin` more on each side.
    pub fn new(
        samples: &Samples,
        base: &TimeBase,
        rate: f64,
        (from, to): (Option<f64>, Option<f64>),
        margin: usize,
    ) -> Result<Even, UnevenWindow> {
        let range = inside(samples.len(), base, rate, (from, to))?;
        let broken = |at: usize| is_gap(base, at, rate) || !samples.at(at).is_finite();
        if let Some(at) = range
            .clone()
            .find(|&at| !samples.at(at).is_finite() || (at > range.start && broken(at)))
        {
            return Err(at_break(samples, base, at, rate));
        }
        let (first, last) = (range.start, range.end - 1);
        let before = (first.saturating_sub(margin)..first).rev();
        let before = before
            .take_while(|&at| samples.at(at).is_finite() && !is_gap(base, at + 1, rate))
            .count();
        let after = (last + 1..samples.len().min(last + 1 + margin))
            .take_while(|&at| !broken(at))
            .count();
        let grid = Grid {
            start: time(base, first) - before as f64 / rate,
            rate,
            count: before + range.len() + after,
        };
        Ok(Even {
            samples: first - before..last + after + 1,
            grid,
            inside: before..before + range.len(),
        })
    }

    /// Time of the first sample in the window, s.
    pub fn start(&self) -> f64 {
        self.grid.time(self.inside.start)
    }

    /// Time of the last sample in the window, s.
    pub fn end(&self) -> f64 {
        self.grid.time(self.inside.end - 1)
    }

    /// Times of the samples in the window.
    pub fn in_window(&self) -> Grid {
        Grid {
            start: self.start(),
            rate: self.grid.rate,
            count: self.inside.len(),
        }
    }

    /// Position of the sample at a time; `None` if there is none.
    pub fn sample_at(&self, instant: f64) -> Option<usize> {
        let place = (instant - self.grid.start) * self.grid.rate;
        ((place - place.round()).abs() <= SLACK).then_some(place.round() as usize)
    }
}

/// Positions of the samples in the window; at least two.
fn inside(
    count: usize,
    base: &TimeBase,
    rate: f64,
    (from, to): (Option<f64>, Option<f64>),
) -> Result<Range<usize>, UnevenWindow> {
    if count < 2 {
        return Err(UnevenWindow {
            at: None,
            found: format!("{count} samples"),
            expected: "at least two".into(),
            remedy: "export the whole record",
        });
    }
    let (start, end, slack) = (time(base, 0), time(base, count - 1), SLACK / rate);
    let (first_time, last_time) = (from.unwrap_or(start), to.unwrap_or(end));
    let before = |limit: f64| {
        let (mut low, mut high) = (0, count);
        while low < high {
            let middle = usize::midpoint(low, high);
            (low, high) = if time(base, middle) < limit {
                (middle + 1, high)
            } else {
                (low, middle)
            };
        }
        low
    };
    let range = before(first_time - slack)..before(last_time + slack);
    let covered = first_time > start - 1.0 / rate && last_time < end + 1.0 / rate;
    if covered && range.len() >= 2 {
        return Ok(range);
    }
    Err(UnevenWindow {
        at: None,
        found: format!("a window from {first_time} to {last_time} s"),
        expected: format!("a window within the recording, from {start} to {end} s"),
        remedy: "correct `from`, `to` or the trigger of the run",
    })
}

/// True if the step before a sample is not one sample long.
fn is_gap(base: &TimeBase, at: usize, rate: f64) -> bool {
    matches!(base, TimeBase::Times(_)) && !steps::is_one(time(base, at) - time(base, at - 1), rate)
}

fn at_break(samples: &Samples, base: &TimeBase, at: usize, rate: f64) -> UnevenWindow {
    let lost = samples
        .range(at..samples.len())
        .take_while(|value| !value.is_finite())
        .count();
    let found = match lost {
        0 => format!("a step of {} s", time(base, at) - time(base, at - 1)),
        1 => "a sample without a value".into(),
        lost => format!("{lost} samples without values"),
    };
    let expected = match lost {
        0 => format!("steps of {} s", 1.0 / rate),
        _ => "a value for every sample of the run".into(),
    };
    UnevenWindow {
        at: Some(time(base, at)),
        found,
        expected,
        remedy: "a missing sample cannot be filled in: choose `from` and `to` outside of it, leave the channel out with `without`, or \
                 export the record again",
    }
}
