//! Channels, each with its own time base: the result of reading any format.

use std::sync::Arc;

use crate::error::{Fault, Place, Read};
use crate::samples::Samples;

/// All that a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The format and its version, such as `MDF 4.10`.
    pub format: String,
    /// The channels, in the order of the file.
    pub signals: Vec<Signal>,
    /// Single values beside them.
    pub scalars: Vec<Scalar>,
    /// What is in the file and not here, and why.
    pub passed_over: Vec<PassedOver>,
}

/// A channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// The name that the file gives.
    pub name: String,
    /// The unit as the file writes it; empty where it gives none.
    pub unit: String,
    /// When the samples were taken.
    pub time: TimeBase,
    /// Physical values in `unit`. None where the channel was not [`Wanted`](crate::find::Wanted); then its time may be unknown, too.
    pub samples: Samples,
    /// Texts that stand for values of a channel of states, such as gears.
    pub labels: Vec<(f64, String)>,
    /// Where in the file it comes from.
    pub source: Source,
}

/// Where a channel comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The group, sheet or variable; empty in a format that has none.
    pub group: String,
    /// Its place in the file.
    pub place: Place,
}

/// When the samples of a channel were taken, in seconds.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeBase {
    /// Evenly: the first sample at `start`, then one every `step`.
    Even {
        /// Time of the first sample, s.
        start: f64,
        /// From sample to sample, s.
        step: f64,
    },
    /// At these times, finite and never falling; as many as there are samples.
    Times(Arc<[f64]>),
    /// The file does not say.
    Unknown,
}

/// A single value.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalar {
    /// The name that the file gives.
    pub name: String,
    /// The unit as the file writes it.
    pub unit: String,
    /// What it is.
    pub value: Value,
    /// Its place in the file.
    pub place: Place,
}

/// What a single value is.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A text, which may look like a number.
    Text(String),
    /// An empty cell.
    Empty,
    /// A formula whose result was never computed.
    Formula(String),
}

/// What a file has and a recording has not.
#[derive(Clone, Debug, PartialEq)]
pub struct PassedOver {
    /// The channel or part of the file.
    pub name: String,
    /// Its place in the file.
    pub place: Place,
    /// Why.
    pub why: String,
}

impl Recording {
    pub(crate) fn new(format: impl Into<String>) -> Self {
        Recording {
            format: format.into(),
            signals: Vec::new(),
            scalars: Vec::new(),
            passed_over: Vec::new(),
        }
    }

    pub(crate) fn pass_over(&mut self, name: impl Into<String>, place: Place, why: impl Into<String>) {
        self.passed_over.push(PassedOver {
            name: name.into(),
            place,
            why: why.into(),
        });
    }

    /// The channel of this name, which may be written as `group/name`.
    ///
    /// # Errors
    /// No such channel, or several: then the error names the groups that have it.
    pub fn signal(&self, name: &str) -> Result<&Signal, Box<Fault>> {
        let named: Vec<&Signal> = self.signals.iter().filter(|signal| signal.is_called(name)).collect();
        match named.as_slice() {
            [signal] => Ok(signal),
            [] => {
                let passed = self.passed_over.iter().find(|passed| passed.name == name);
                let found = passed.map_or("no channel of this name".into(), |passed| passed.why.clone());
                let remedy = "choose one of the channels that `qcar inspect` lists";
                Err(Fault::new(Place::File, found, "a channel with samples", remedy).of(name))
            }
            several => {
                let places: Vec<String> = several.iter().map(|signal| signal.qualified()).collect();
                let found = format!("{} channels: {}", several.len(), places.join(", "));
                let remedy = "write the name with its group, `group/name`";
                Err(Fault::new(Place::File, found, "one channel of this name", remedy).of(name))
            }
        }
    }
}

impl Signal {
    pub(crate) fn is_called(&self, name: &str) -> bool {
        is_called(name, &self.source.group, &self.name)
    }

    /// `group/name`, or the name where there is no group.
    pub fn full_name(&self) -> String {
        full_name(&self.source.group, &self.name)
    }

    /// The same with the place in the file.
    fn qualified(&self) -> String {
        format!("`{}` at {}", self.full_name(), self.source.place)
    }
}

/// Whether `text` is the name of a channel or `group/name`.
pub(crate) fn is_called(text: &str, group: &str, name: &str) -> bool {
    let with_group = text.strip_suffix(name).and_then(|before| before.strip_suffix('/'));
    name == text || with_group.is_some_and(|before| before == group && !group.is_empty())
}

/// `group/name`, or the name where there is no group.
pub(crate) fn full_name(group: &str, name: &str) -> String {
    match group {
        "" => name.into(),
        group => format!("{group}/{name}"),
    }
}

impl TimeBase {
    /// A time base of these times.
    ///
    /// # Errors
    /// The first time that is not finite or earlier than the one before: its index, and what is wrong.
    pub(crate) fn from_times(times: Vec<f64>) -> Result<Self, (usize, String)> {
        for (at, &time) in times.iter().enumerate() {
            let before = if at == 0 { f64::NEG_INFINITY } else { times[at - 1] };
            if !time.is_finite() {
                return Err((at, "no time".into()));
            }
            if time < before {
                return Err((at, format!("the time {time} s after {before} s")));
            }
        }
        Ok(TimeBase::Times(times.into()))
    }

    /// Time of the first sample, s.
    pub fn start(&self) -> Option<f64> {
        match self {
            TimeBase::Even { start, .. } => Some(*start),
            TimeBase::Times(times) => times.first().copied(),
            TimeBase::Unknown => None,
        }
    }

    /// Samples a second, where they come evenly: every step within 1 % of the mean step.
    pub fn rate(&self) -> Option<f64> {
        match self {
            TimeBase::Even { step, .. } => Some(1.0 / step),
            TimeBase::Times(times) => {
                let (&first, &last) = (times.first()?, times.last()?);
                let mean = (last - first) / (times.len() - 1) as f64;
                let even = times
                    .windows(2)
                    .all(|two| (two[1] - two[0] - mean).abs() <= 0.01 * mean);
                (even && mean > 0.0).then_some(1.0 / mean)
            }
            TimeBase::Unknown => None,
        }
    }
}

/// An even time base.
///
/// # Errors
/// A step that is not a positive number, or a start that is not a number.
pub(crate) fn evenly(start: f64, step: f64, place: Place) -> Read<TimeBase> {
    if step.is_finite() && step > 0.0 && start.is_finite() {
        return Ok(TimeBase::Even { start, step });
    }
    let found = format!("a start of {start} s and a step of {step} s");
    Err(Fault::damaged(place, found, "a finite start and a positive step"))
}
