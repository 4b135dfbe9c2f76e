//! Start and end of a run in its recording.

use std::path::Path;

use qcar_signals::signal::{Recording, TimeBase};

use super::super::contents::{Trigger, Window};
use super::even::time;
use super::files::problem;
use crate::error::{InputError, Place, Problem};

/// A window on the clock of the recording, s.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Span {
    pub from: Option<f64>,
    pub to: Option<f64>,
    /// Zero of the run's own time; `None` for the clock of the recording.
    pub zero: Option<f64>,
}

impl Span {
    /// The window in this recording.
    pub fn of(file: &Path, recording: &Recording, window: &Window, declared: Option<f64>) -> Result<Span, InputError> {
        let Some(trigger) = &window.trigger else {
            let (from, to) = (window.from, window.to);
            return Ok(Span { from, to, zero: from });
        };
        let met = moment(file, recording, trigger, declared)?;
        let from = met + window.from.unwrap_or(0.0);
        Ok(Span {
            from: Some(from),
            to: window.to.map(|to| met + to),
            zero: Some(from),
        })
    }

    /// Both ends, for the selection of samples.
    pub fn ends(self) -> (Option<f64>, Option<f64>) {
        (self.from, self.to)
    }
}

/// Time of the first sample above the threshold after one that is not.
fn moment(file: &Path, recording: &Recording, trigger: &Trigger, declared: Option<f64>) -> Result<f64, InputError> {
    let signal = recording
        .find(&trigger.channel)
        .map_err(|fault| InputError::from(problem(file, &fault)))?;
    let base = clock(&signal.time, declared);
    let above = |value: f64| value > trigger.above;
    let rises = |(one, next): (f64, f64)| one.is_finite() && next.is_finite() && !above(one) && above(next);
    let mut pairs = signal.samples.iter().zip(signal.samples.iter().skip(1));
    let met = base.as_ref().zip(pairs.position(rises));
    met.map(|(base, before)| time(base, before + 1)).ok_or_else(|| {
        let valid = || signal.samples.iter().filter(|value| value.is_finite());
        let (low, high) = (
            valid().fold(f64::INFINITY, f64::min),
            valid().fold(f64::NEG_INFINITY, f64::max),
        );
        let (unit, limit) = (&signal.unit, trigger.above);
        let found = match base {
            Some(_) => format!("values from {low} to {high} {unit} that never rise above {limit}"),
            None => "no times".into(),
        };
        let (expected, remedy) = (
            "a sample that triggers the run",
            "correct `trigger` of the run, or give `from` and `to`",
        );
        let place = Place::Channel(signal.full_name(), None);
        Problem::new(file, place, found, expected, remedy).into()
    })
}

/// Times of the samples; without times in the file, from zero at the declared rate.
pub(super) fn clock(base: &TimeBase, declared: Option<f64>) -> Option<TimeBase> {
    match base {
        TimeBase::Unknown => declared.map(|rate| TimeBase::Even {
            start: 0.0,
            step: 1.0 / rate,
        }),
        known => Some(known.clone()),
    }
}
