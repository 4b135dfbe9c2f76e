//! The inputs of a model as they were recorded.

use super::failure::{SimulateError, positive};
use super::wave::Wave;
use crate::model::{About, InputKind, Quantity, SignalKind};

/// What was recorded of an excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<'a> {
    /// Place in [`About::excitations`].
    pub excitation: usize,
    /// What was recorded of it.
    pub kind: SignalKind,
    /// SI, the first at t = 0.
    pub samples: &'a [f64],
}

/// How a record goes on between its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// It holds nothing at half the sample rate and above, and is one period of a signal that goes on for ever: the
    /// sum of its Fourier series. A displacement or force that does not end where it began has that on a straight line.
    BandLimited,
    /// A force that stays as it is until the next sample.
    Held,
}

/// Recorded inputs, at any time.
#[derive(Clone, Debug)]
pub struct Recorded {
    rate: f64,
    samples: usize,
    waves: Vec<Wave>,
    /// For each input of the model its wave, and which derivative of it is wanted.
    sources: Vec<Option<(usize, usize)>>,
    /// The axes along which a road was recorded, each with its wave.
    roads: Vec<(String, usize)>,
}

impl Recorded {
    /// Prepares records of one length and sample rate (Hz) for a model. What was not recorded rests at zero.
    ///
    /// A motion that was recorded as a velocity or acceleration is integrated without its mean, from height zero on.
    ///
    /// # Errors
    /// No record, or records that are empty, of unlike length, not finite, or of another kind than their excitation; a
    /// motion that is held.
    pub fn new(about: &About, records: &[Record<'_>], rate: f64, between: Between) -> Result<Self, SimulateError> {
        let samples = records.first().map_or(0, |record| record.samples.len());
        positive("the sample rate", rate, "Hz")?;
        positive("the number of samples", samples as f64, "")?;
        records
            .iter()
            .try_for_each(|record| check(about, record, samples, between))?;
        let wave = |record: &Record<'_>| match (between, record.kind) {
            (Between::Held, _) => Wave::Held {
                rate,
                samples: record.samples.to_vec(),
            },
            (Between::BandLimited, SignalKind::Motion(quantity)) => {
                Wave::band_limited(record.samples, rate, order(quantity) as i32)
            }
            (Between::BandLimited, _) => Wave::band_limited(record.samples, rate, 0),
        };
        let roads = records.iter().enumerate().filter_map(|(wave, record)| {
            let excitation = &about.excitations[record.excitation];
            excitation.road.then(|| (excitation.axis.to_string(), wave))
        });
        Ok(Self {
            rate,
            samples,
            waves: records.iter().map(wave).collect(),
            sources: sources(about, records),
            roads: roads.collect(),
        })
    }

    /// Hz.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Writes the model's inputs at time `t` (s), on a leg that began at `leg` (s), where the last jump was.
    pub(super) fn at(&self, t: f64, leg: f64, inputs: &mut [f64]) {
        for (input, source) in inputs.iter_mut().zip(&self.sources) {
            *input = source.map_or(0.0, |(wave, order)| self.waves[wave].at(t, leg)[order]);
        }
    }

    /// Height and velocity of the road along `axis` at time `t` (s), where one was recorded.
    pub(super) fn road(&self, axis: &str, t: f64) -> Option<[f64; 2]> {
        let (_, wave) = self.roads.iter().find(|road| road.0 == axis)?;
        let [height, velocity, _] = self.waves[*wave].at(t, t);
        Some([height, velocity])
    }

    /// The times at which an input jumps, s.
    pub(super) fn jumps(&self) -> Vec<f64> {
        let held = self.waves.iter().any(|wave| matches!(wave, Wave::Held { .. }));
        let last = if held { self.samples } else { 1 };
        (1..last).map(|sample| sample as f64 / self.rate).collect()
    }
}

fn sources(about: &About, records: &[Record<'_>]) -> Vec<Option<(usize, usize)>> {
    let wave = |excitation: u16| records.iter().position(|r| r.excitation == usize::from(excitation));
    let source = |kind| match kind {
        InputKind::Motion(excitation, quantity) => Some((wave(excitation)?, order(quantity))),
        InputKind::Force(excitation) => Some((wave(excitation)?, 0)),
        InputKind::Gravity => None,
    };
    about.inputs.iter().map(|input| source(input.kind)).collect()
}

fn order(quantity: Quantity) -> usize {
    match quantity {
        Quantity::Position => 0,
        Quantity::Velocity => 1,
        Quantity::Acceleration => 2,
    }
}

fn check(about: &About, record: &Record<'_>, samples: usize, between: Between) -> Result<(), SimulateError> {
    let Some(excitation) = about.excitations.get(record.excitation) else {
        return Err(SimulateError::NoSuchExcitation {
            model: about.name.to_string(),
            excitation: record.excitation,
            count: about.excitations.len(),
        });
    };
    let name = excitation.name.to_string();
    match record.kind {
        SignalKind::Motion(_) if excitation.force => return Err(SimulateError::ForceByMotion { name }),
        SignalKind::Motion(_) if between == Between::Held => return Err(SimulateError::HeldMotion { name }),
        SignalKind::Force | SignalKind::Stretch if !excitation.force => {
            return Err(SimulateError::MotionByForce { name });
        }
        _ => {}
    }
    if record.samples.len() != samples {
        return Err(SimulateError::Count {
            name: "a record",
            found: record.samples.len(),
            expected: samples,
        });
    }
    match record.samples.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(sample) => Err(SimulateError::NotFinite {
            name,
            sample,
            value: record.samples[sample],
        }),
    }
}
