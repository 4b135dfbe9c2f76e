//! Channels, each with its own time base: the result of reading any format.

use std::collections::HashSet;
use std::sync::Arc;

use crate::error::{Fault, Place, Read};
use crate::samples::Samples;

/// Contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The format and its version, such as `MDF 4.10`.
    pub format: String,
    /// The channels, in the order of the file.
    pub signals: Vec<Signal>,
    /// Single values beside them.
    pub scalars: Vec<Scalar>,
    /// Parts of the file that were left out, with reasons.
    pub passed_over: Vec<PassedOver>,
}

/// A channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Name in the file.
    pub name: String,
    /// Unit as in the file; empty without one.
    pub unit: String,
    /// Times of the samples.
    pub time: TimeBase,
    /// Physical values in `unit`; empty if the channel was not [`Wanted`](crate::find::Wanted), whose time may then be
    /// unknown too.
    pub samples: Samples,
    /// Texts for the values of a channel of states, such as gears.
    pub labels: Vec<(f64, String)>,
    /// Source in the file.
    pub source: Source,
}

/// Source of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Group, sheet or variable; empty in a format without them.
    pub group: String,
    /// Position in the file.
    pub place: Place,
}

/// Times of the samples of a channel, s.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeBase {
    /// Evenly spaced: the first sample at `start`, then one every `step`.
    Even {
        /// Time of the first sample, s.
        start: f64,
        /// Sample interval, s.
        step: f64,
    },
    /// These times, finite and never decreasing; one for each sample.
    Times(Arc<Vec<f64>>),
    /// Unevenly spaced, and not kept: only if summaries were [`Wanted`](crate::find::Wanted).
    Uneven {
        /// Time of the first sample, s.
        start: f64,
        /// Mean sample interval, s; 0 if there is only one sample.
        mean_step: f64,
    },
    /// Not in the file.
    Unknown,
}

/// A single value.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalar {
    /// Name in the file.
    pub name: String,
    /// Unit as in the file.
    pub unit: String,
    /// The value.
    pub value: Value,
    /// Position in the file.
    pub place: Place,
}

/// Type of a single value.
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

/// A part of a file that was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct PassedOver {
    /// The channel or part.
    pub name: String,
    /// Position in the file.
    pub place: Place,
    /// Reason.
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
    /// Fails if there is no such channel, or if several groups have it; the error names them.
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
                let groups: HashSet<&str> = several.iter().map(|signal| signal.source.group.as_str()).collect();
                let remedy = match groups.len() == several.len() {
                    true => "write the name with its group, `group/name`",
                    false => "give them different names in the file, or export it again without one of them",
                };
                Err(Fault::new(Place::File, found, "one channel of this name", remedy).of(name))
            }
        }
    }
}

impl Signal {
    pub(crate) fn is_called(&self, name: &str) -> bool {
        is_called(name, &self.source.group, &self.name)
    }

    /// `group/name`, or the name without a group.
    pub fn full_name(&self) -> String {
        full_name(&self.source.group, &self.name)
    }

    /// The same with the position in the file.
    fn qualified(&self) -> String {
        format!("`{}` at {}", self.full_name(), self.source.place)
    }
}

/// True if `text` is the name of a channel or `group/name`.
pub(crate) fn is_called(text: &str, group: &str, name: &str) -> bool {
    let with_group = text.strip_suffix(name).and_then(|before| before.strip_suffix('/'));
    name == text || with_group.is_some_and(|before| before == group && !group.is_empty())
}

/// `group/name`, or the name without a group.
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
    /// Fails at the first time that is not finite or earlier than the one before, with its position and the fault.
    pub(crate) fn from_times(times: Vec<f64>) -> Result<Self, (usize, String)> {
        Steps::of(&times).checked()?;
        Ok(TimeBase::Times(Arc::new(times)))
    }

    /// Time of the first sample, s.
    pub fn start(&self) -> Option<f64> {
        match self {
            TimeBase::Even { start, .. } => Some(*start),
            TimeBase::Times(times) => times.first().copied(),
            TimeBase::Uneven { start, .. } => Some(*start),
            TimeBase::Unknown => None,
        }
    }

    /// Samples per second on average, evenly spaced or not.
    pub fn mean_rate(&self) -> Option<f64> {
        let step = match self {
            TimeBase::Even { step, .. } => *step,
            TimeBase::Times(times) => Steps::of(times).mean_step(),
            TimeBase::Uneven { mean_step, .. } => *mean_step,
            TimeBase::Unknown => return None,
        };
        (step > 0.0).then(|| 1.0 / step)
    }

    /// Samples per second, if they are evenly spaced: every step within 1 % of the mean step.
    pub fn rate(&self) -> Option<f64> {
        match self {
            TimeBase::Even { step, .. } => Some(1.0 / step),
            TimeBase::Times(times) => Steps::of(times).even().map(|step| 1.0 / step),
            TimeBase::Uneven { .. } | TimeBase::Unknown => None,
        }
    }
}

/// Times of samples that pass by in pieces, s: of them, only the range of their steps is kept.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steps {
    count: usize,
    first: f64,
    last: f64,
    /// Shortest and longest step.
    range: Option<(f64, f64)>,
    /// Position of the first time that is not finite or earlier than the one before, and the fault.
    fault: Option<(usize, String)>,
}

impl Steps {
    fn of(times: &[f64]) -> Self {
        let mut steps = Steps::default();
        steps.add(times);
        steps
    }

    /// Adds the next times.
    pub(crate) fn add(&mut self, times: &[f64]) {
        for &time in times {
            if self.fault.is_some() {
                return;
            }
            self.fault = self.fault_of(time).map(|fault| (self.count, fault));
            if self.count == 0 {
                self.first = time;
            } else {
                let step = time - self.last;
                let (least, most) = self.range.unwrap_or((step, step));
                self.range = Some((least.min(step), most.max(step)));
            }
            self.last = time;
            self.count += 1;
        }
    }

    fn fault_of(&self, time: f64) -> Option<String> {
        if !time.is_finite() {
            return Some("a time that is no finite number".into());
        }
        (self.count > 0 && time < self.last).then(|| format!("the time {time} s after {} s", self.last))
    }

    fn checked(self) -> Result<Self, (usize, String)> {
        match self.fault {
            Some(fault) => Err(fault),
            None => Ok(self),
        }
    }

    /// The mean step; 0 for a single time.
    fn mean_step(&self) -> f64 {
        match self.count {
            0 | 1 => 0.0,
            count => (self.last - self.first) / (count - 1) as f64,
        }
    }

    /// The mean step if every step is within 1 % of it.
    fn even(&self) -> Option<f64> {
        let (least, most) = self.range?;
        let mean = self.mean_step();
        (mean > 0.0 && most - mean <= 0.01 * mean && mean - least <= 0.01 * mean).then_some(mean)
    }

    /// What is known of the times.
    ///
    /// # Errors
    /// Fails as [`TimeBase::from_times`] does.
    pub(crate) fn time_base(self) -> Result<TimeBase, (usize, String)> {
        let own = self.checked()?;
        Ok(match (own.count, own.even()) {
            (0, _) => TimeBase::Unknown,
            (_, Some(step)) => TimeBase::Even { start: own.first, step },
            (_, None) => TimeBase::Uneven {
                start: own.first,
                mean_step: own.mean_step(),
            },
        })
    }
}

/// An even time base.
///
/// # Errors
/// Fails if the step is not a positive number, or the start is NaN.
pub(crate) fn evenly(start: f64, step: f64, place: Place) -> Read<TimeBase> {
    if step.is_finite() && step > 0.0 && start.is_finite() {
        return Ok(TimeBase::Even { start, step });
    }
    let found = format!("a start of {start} s and a step of {step} s");
    Err(Fault::damaged(place, found, "a finite start and a positive step"))
}

#[cfg(test)]
mod tests {
    use super::{Steps, TimeBase};

    /// As the definition of an even time base says, of all times at once.
    fn rate(times: &[f64]) -> Option<f64> {
        let mean = (times.last()? - times.first()?) / (times.len() - 1) as f64;
        let even = times
            .windows(2)
            .all(|two| (two[1] - two[0] - mean).abs() <= 0.01 * mean);
        (even && mean > 0.0).then_some(1.0 / mean)
    }

    #[test]
    fn streamed_times_give_the_time_base_of_stored_ones() {
        let even: Vec<f64> = (0..100).map(|at| 0.5 + f64::from(at) * 1e-3).collect();
        let mut jittered = even.clone();
        jittered[50] += 0.9e-5;
        let mut gap = even.clone();
        gap[99] += 1e-3;
        for times in [even, jittered, gap, vec![1.0, 1.0], vec![3.0], vec![]] {
            let mut steps = Steps::default();
            times.chunks(7).for_each(|piece| steps.add(piece));
            let passed = steps.time_base().unwrap();
            let kept = TimeBase::from_times(times.clone()).unwrap();
            assert_eq!(passed.start(), times.first().copied());
            assert_eq!((passed.rate(), kept.rate()), (rate(&times), rate(&times)));
            assert_eq!(passed.mean_rate(), kept.mean_rate());
        }
        for (times, at, found) in [
            ([0.0, 1.0, 0.5], 2, "the time 0.5 s after 1 s"),
            ([0.0, f64::NAN, 0.5], 1, "a time that is no finite number"),
        ] {
            let mut steps = Steps::default();
            times.iter().for_each(|time| steps.add(&[*time]));
            assert_eq!(steps.time_base(), Err((at, found.into())));
            assert_eq!(TimeBase::from_times(times.to_vec()), Err((at, found.into())));
        }
    }
}
