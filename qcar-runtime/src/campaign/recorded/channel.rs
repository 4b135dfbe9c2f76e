//! A channel as its mapping reads it.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use qcar_signals::resample::reach;
use qcar_signals::samples::Samples;
use qcar_signals::signal::{Recording, Signal, TimeBase};

use super::super::contents::ChannelMapping;
use super::even::{self, Even};
use super::files::problem;
use super::uneven::resampled;
use super::values::Scaling;
use super::window::{Span, clock};
use crate::error::{InputError, Place, Problem};

/// A channel in SI. Values are computed on request, since a recording may be much longer than a run.
pub(super) struct Channel<'a> {
    pub mapping: &'a ChannelMapping,
    signal: &'a Signal,
    base: TimeBase,
    /// Samples of the file; samples at uneven times are resampled.
    samples: Cow<'a, Samples>,
    scaling: Scaling,
    /// Sample rate, Hz.
    pub rate: f64,
    /// Shortest and longest step of uneven samples, s.
    pub uneven: Option<(f64, f64)>,
}

impl<'a> Channel<'a> {
    /// The channel that a mapping selects. Without times in the file it has the declared rate.
    pub fn mapped(
        file: &Path,
        recording: &'a Recording,
        mapping: &'a ChannelMapping,
        declared: Option<f64>,
    ) -> Result<Channel<'a>, InputError> {
        let signal = recording.find(&mapping.source).map_err(|fault| {
            let problem = problem(file, &fault);
            let expected = format!("{}, as `source` of `{}` says", problem.expected, mapping.name);
            InputError::from(Problem { expected, ..problem })
        })?;
        let known = clock(&signal.time, declared);
        let rated = known.and_then(|base| Some((even::rate(&base, signal.samples.len(), declared)?, base)));
        let Some((rate, base)) = rated else {
            let (expected, remedy) = ("the times of the samples", "state the `sample_rate` of the run");
            let place = Place::Channel(signal.full_name(), None);
            return Err(Problem::new(file, place, "no times", expected, remedy).into());
        };
        let scaling = Scaling::of(file, signal, &base, mapping)?;
        let (base, samples, uneven) = match resampled(&base, &signal.samples, rate) {
            Some(even) => (even.base, Cow::Owned(even.values.into()), Some(even.steps)),
            None => (base, Cow::Borrowed(&signal.samples), None),
        };
        Ok(Channel {
            mapping,
            signal,
            base,
            samples,
            scaling,
            rate,
            uneven,
        })
    }

    /// A column of a table without times ends at its last value.
    pub fn up_to_its_last_value(mut self) -> Self {
        if self.signal.time == TimeBase::Unknown {
            let last = self.signal.samples.iter().rposition(|value| value.is_finite());
            let filled: Vec<f64> = self.signal.samples.range(0..last.map_or(0, |last| last + 1)).collect();
            self.samples = Cow::Owned(filled.into());
        }
        self
    }

    /// The values of these samples, in SI.
    pub fn values(&self, of: Range<usize>) -> Vec<f64> {
        self.samples
            .range(of)
            .map(|sample| self.scaling.value(sample))
            .collect()
    }

    /// Its samples in the window, with the samples around it that a filter to `rate` needs.
    pub fn even(&self, file: &Path, rate: f64, span: Span) -> Result<Even, InputError> {
        let margin = (reach(self.rate, rate) * self.rate).ceil() + 1.0;
        let margin = margin.min(self.samples.len() as f64) as usize;
        let even = Even::new(&self.samples, &self.base, self.rate, span.ends(), margin).map_err(|broken| {
            let place = Place::Channel(self.signal.full_name(), broken.at);
            Problem::new(file, place, broken.found, broken.expected, broken.remedy)
        })?;
        let mut scaled = self
            .samples
            .range(even.samples.clone())
            .map(|sample| self.scaling.value(sample));
        if scaled.all(f64::is_finite) {
            return Ok(even);
        }
        let (expected, remedy) = ("finite values", "correct the `scale` or `unit` of the channel");
        Err(Problem::new(file, self.place(), "infinite values after scaling", expected, remedy).into())
    }

    /// Name for error messages.
    pub fn place(&self) -> Place {
        Place::Channel(self.signal.full_name(), None)
    }
}
