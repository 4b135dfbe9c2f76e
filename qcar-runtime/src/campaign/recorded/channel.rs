//! What a tap makes of a channel.

use std::path::Path;

use qcar_signals::resample::reach;
use qcar_signals::signal::{Recording, Signal, TimeBase};

use super::super::contents::Tap;
use super::even::{self, Even};
use super::files::problem;
use super::uneven::laid;
use super::values::values;
use super::window::{Span, clock};
use crate::error::{InputError, Place, Problem};

/// A channel with its values in SI.
pub(super) struct Channel<'a> {
    pub tap: &'a Tap,
    signal: &'a Signal,
    base: TimeBase,
    values: Vec<f64>,
    /// Hz.
    pub rate: f64,
    /// The shortest and the longest step of samples that came unevenly, s.
    pub uneven: Option<(f64, f64)>,
}

impl<'a> Channel<'a> {
    /// The channel that a tap means. One whose times the file does not say has the declared rate.
    pub fn tapped(
        file: &Path,
        recording: &'a Recording,
        tap: &'a Tap,
        declared: Option<f64>,
    ) -> Result<Channel<'a>, InputError> {
        let signal = recording.find(&tap.source).map_err(|fault| {
            let problem = problem(file, &fault);
            let expected = format!("{}, as `source` of `{}` says", problem.expected, tap.name);
            InputError::from(Problem { expected, ..problem })
        })?;
        let known = clock(&signal.time, declared);
        let rated = known.and_then(|base| Some((even::rate(&base, signal.samples.len(), declared)?, base)));
        let Some((rate, base)) = rated else {
            let (expected, remedy) = ("when the samples were taken", "state the `sample_rate` of the run");
            let place = Place::Channel(signal.full_name(), None);
            return Err(Problem::new(file, place, "no times", expected, remedy).into());
        };
        let values = values(file, signal, &base, tap)?;
        let (base, values, uneven) = match laid(&base, &values, rate) {
            Some(laid) => (laid.base, laid.values, Some(laid.steps)),
            None => (base, values, None),
        };
        Ok(Channel {
            tap,
            signal,
            base,
            values,
            rate,
            uneven,
        })
    }

    /// A column of a table without times is as long as it is filled.
    pub fn up_to_its_last_value(mut self) -> Self {
        if self.signal.time == TimeBase::Unknown {
            let last = self.values.iter().rposition(|value| value.is_finite());
            self.values.truncate(last.map_or(0, |last| last + 1));
        }
        self
    }

    /// Its samples in the window, with what a filter to `rate` looks at beside it.
    pub fn even(&self, file: &Path, rate: f64, span: Span) -> Result<Even<'_>, InputError> {
        let margin = (reach(self.rate, rate) * self.rate).ceil() + 1.0;
        let margin = margin.min(self.values.len() as f64) as usize;
        Even::new(&self.values, &self.base, self.rate, span.ends(), margin).map_err(|broken| {
            let place = Place::Channel(self.signal.full_name(), broken.at);
            Problem::new(file, place, broken.found, broken.expected, broken.remedy).into()
        })
    }

    /// To be named in errors.
    pub fn place(&self) -> Place {
        Place::Channel(self.signal.full_name(), None)
    }
}
