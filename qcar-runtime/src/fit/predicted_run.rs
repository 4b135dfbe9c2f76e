//! A run as the fitted model predicts it: with another sensor, another excitation, once more, or beyond its band.
//!
//! An added sensor is assumed to have the noise of sensors of its kind in the same run, or else their relative noise.
//! The model's misfit is assumed to be the same for all channels.

use super::channels::{across_links, is_excitation};
use super::observation::{Level, Observation};
use super::record::{Record, between};
use crate::model::{Channel, Model, Quantity, Signal, SignalKind};
use crate::random::SplitMix;
use crate::response::parameters::Values;
use crate::response::ratio::Ratios;
use nalgebra::Complex;

/// A run as the fitted model predicts it.
pub(super) struct PredictedRun<'a, M: ?Sized> {
    model: &'a M,
    values: &'a Values,
    /// The level of the run, without its observations.
    pub level: Level,
    pub source: Signal,
    pub frequency: Vec<f64>,
    pub records: Vec<Record>,
    /// Relative variance of the model's misfit, without noise.
    misfit: f64,
}

impl<'a, M: Model + ?Sized> PredictedRun<'a, M> {
    /// `None` for a run without a ratio to its excitation.
    pub fn new(model: &'a M, values: &'a Values, level: &Level) -> Option<Self> {
        let excitation = &model.about().excitations[level.excitation];
        let from_source = |own: &&Observation| is_excitation(excitation, &own.channel.denominator);
        let observed: Vec<&Observation> = level.observations.iter().filter(from_source).collect();
        let record = |own: &&Observation| Record {
            signal: own.channel.numerator.clone(),
            value: own.value.clone(),
            variance: own.relative_variance.clone(),
            differences: own.differences.clone(),
            sensors: own.sensors.0,
        };
        let mut run = Self {
            model,
            values,
            level: Level {
                observations: Vec::new(),
                ..level.clone()
            },
            source: observed.first()?.channel.denominator.clone(),
            frequency: observed.first()?.frequency.clone(),
            records: observed.iter().map(record).collect(),
            misfit: 0.0,
        };
        run.misfit = run.misfit_variance();
        Some(run)
    }

    /// A run with another excitation, in which sensors record these signals; `None` if none of them responds.
    pub fn driven(&self, excitation: usize, signals: Vec<Signal>) -> Option<Level> {
        let own = &self.model.about().excitations[excitation];
        let kind = if own.force {
            SignalKind::Force
        } else {
            SignalKind::Motion(Quantity::Acceleration)
        };
        let run = PredictedRun {
            level: Level {
                name: own.name.to_string(),
                excitation,
                ..self.level.clone()
            },
            source: Signal {
                location: own.name.clone(),
                axis: own.axis.clone(),
                kind,
            },
            frequency: self.frequency.clone(),
            records: Vec::new(),
            ..*self
        };
        let records = signals.into_iter().filter_map(|signal| {
            let value = run.response(&signal, &run.frequency)?;
            Some(run.expected(signal, value, self.mean_variance(), self.misfit))
        });
        let records: Vec<Record> = records.collect();
        (!records.is_empty()).then(|| run.assembled(&records, &run.frequency))
    }

    /// Mean square of the logarithmic residuals over lines and places, less the variance of noise.
    fn misfit_variance(&self) -> f64 {
        let lines = self.records.iter().flat_map(|record| {
            let model = self.response(&record.signal, &self.frequency).unwrap_or_default();
            let pairs = record.value.iter().zip(model);
            let apart = pairs.map(|(measured, model)| (measured / model).ln().norm_sqr());
            apart
                .zip(&record.variance)
                .map(|(apart, variance)| apart - variance)
                .collect::<Vec<_>>()
        });
        let (sum, count) = lines.fold((0.0, 0_usize), |(sum, count), own| (sum + own, count + 1));
        (sum / count.max(1) as f64).max(0.0)
    }

    fn response(&self, signal: &Signal, frequency: &[f64]) -> Option<Vec<Complex<f64>>> {
        let excitation = self.level.excitation;
        let found = Ratios::new(self.model, self.values).ratio(excitation, [signal, &self.source], frequency);
        found.ok().map(|found| found.value)
    }

    /// Mean relative variance of the records at each line.
    fn mean_variance(&self) -> Vec<f64> {
        let mean =
            |line: usize| self.records.iter().map(|own| own.variance[line]).sum::<f64>() / self.records.len() as f64;
        (0..self.frequency.len()).map(mean).collect()
    }

    /// The record of another sensor; `None` if the model lacks its signal or the run already has it.
    pub fn sensor(&self, signal: &Signal) -> Option<Record> {
        let same = |own: &Signal| own.location == signal.location && quantity(own.kind) == quantity(signal.kind);
        let is_known = same(&self.source) || self.records.iter().any(|own| same(&own.signal));
        if is_known || signal.axis != self.source.axis {
            return None;
        }
        let value = self.response(signal, &self.frequency)?;
        let variance = self.variance_of(signal, &value);
        Some(self.expected(signal.clone(), value, variance, self.misfit))
    }

    /// The level with an additional record.
    pub fn beside(&self, record: &Record) -> Level {
        let records: Vec<Record> = self.records.iter().chain([record]).cloned().collect();
        self.assembled(&records, &self.frequency)
    }

    /// A level with the ratio of one record to the excitation as its only observation.
    pub fn alone(&self, record: &Record) -> Level {
        let channel = Channel {
            name: format!("{}_to_{}", self.source.location, record.signal.location).into(),
            numerator: record.signal.clone(),
            denominator: self.source.clone(),
        };
        Level {
            observations: vec![between(&channel, [Some(record), None], &self.frequency)],
            ..self.level.clone()
        }
    }

    /// Relative variance of a sensor that has the noise of other sensors of its kind.
    fn variance_of(&self, signal: &Signal, value: &[Complex<f64>]) -> Vec<f64> {
        let alike: Vec<&Record> = self
            .records
            .iter()
            .filter(|own| own.signal.kind == signal.kind)
            .collect();
        if alike.is_empty() {
            return self.mean_variance();
        }
        let noise = |line: usize| {
            let squares = alike.iter().map(|own| own.variance[line] * own.value[line].norm_sqr());
            squares.sum::<f64>() / alike.len() as f64
        };
        value
            .iter()
            .enumerate()
            .map(|(line, value)| noise(line) / value.norm_sqr())
            .collect()
    }

    /// A record with an error of the size of noise and misfit.
    fn expected(&self, signal: Signal, value: Vec<Complex<f64>>, variance: Vec<f64>, misfit: f64) -> Record {
        let mut random = SplitMix::new(seed(&signal));
        let mut sign = || if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        let off = value.iter().zip(&variance).map(|(value, variance)| {
            let size = (0.5 * (variance + misfit)).sqrt();
            disturbed(*value, Complex::new(sign() * size, sign() * size))
        });
        Record {
            value: off.collect(),
            variance,
            differences: Vec::new(),
            sensors: self.records.iter().map(|own| own.sensors).max().unwrap_or(1),
            signal,
        }
    }

    /// The run repeated with noise scaled by this factor; the model's misfit stays the same.
    pub fn again(&self, noise: f64) -> Level {
        let again = |own: &Record| {
            let model = self
                .response(&own.signal, &self.frequency)
                .unwrap_or_else(|| own.value.clone());
            let variance: Vec<f64> = own.variance.iter().map(|variance| noise * variance).collect();
            let mut record = self.expected(own.signal.clone(), model.clone(), variance, 0.0);
            for (line, value) in record.value.iter_mut().enumerate() {
                let share = (self.misfit / (self.misfit + own.variance[line]).max(f64::MIN_POSITIVE)).sqrt();
                *value *= ((own.value[line] / model[line]).ln() * share).exp();
            }
            Record {
                differences: own.differences.clone(),
                sensors: own.sensors,
                ..record
            }
        };
        self.assembled(&self.records.iter().map(again).collect::<Vec<_>>(), &self.frequency)
    }

    /// Two more levels: the run from the end of its band to twice its end, and from half its start to its start.
    pub fn wider(&self) -> Vec<(String, Level)> {
        let (Some(&first), Some(&last)) = (self.frequency.first(), self.frequency.last()) else {
            return Vec::new();
        };
        let name = &self.level.name;
        let up = (format!("{name} up to {:.0} Hz", 2.0 * last), last, 2.0 * last);
        let down = (format!("{name} from {:.2} Hz on", 0.5 * first), 0.5 * first, first);
        let level = |(what, from, to): (String, f64, f64)| {
            let share = (to / from).ln() / (last / first).ln();
            let lines = (share * self.frequency.len() as f64).ceil() as usize;
            let part = |line: usize| (line as f64 + 0.5) / lines as f64;
            let frequency: Vec<f64> = (0..lines).map(|line| from * (to / from).powf(part(line))).collect();
            let records: Option<Vec<Record>> = self
                .records
                .iter()
                .map(|own| self.extended(own, &frequency, from))
                .collect();
            Some((what, self.assembled(&records?, &frequency)))
        };
        [up, down].into_iter().filter_map(level).collect()
    }

    /// A record at other frequencies, with the noise at the nearest end of its band.
    fn extended(&self, own: &Record, frequency: &[f64], from: f64) -> Option<Record> {
        /// Number of lines at an end of the band whose noise is used beyond it.
        const NEAR: usize = 10;
        let count = own.value.len();
        let lines = if from < self.frequency[0] {
            0..NEAR.min(count)
        } else {
            count.saturating_sub(NEAR)..count
        };
        let noise = |line: usize| own.variance[line] * own.value[line].norm_sqr();
        let noise = lines.clone().map(noise).sum::<f64>() / lines.len() as f64;
        let value = self.response(&own.signal, frequency)?;
        let variance = value.iter().map(|value| noise / value.norm_sqr()).collect();
        Some(Record {
            sensors: own.sensors,
            ..self.expected(own.signal.clone(), value, variance, self.misfit)
        })
    }

    /// The channels that a fit would use of these records.
    pub fn assembled(&self, records: &[Record], frequency: &[f64]) -> Level {
        let signals: Vec<Signal> = [&self.source]
            .into_iter()
            .chain(records.iter().map(|own| &own.signal))
            .cloned()
            .collect();
        let about = self.model.about();
        let channels = across_links(about, &about.excitations[self.level.excitation], &signals);
        let find = |signal: &Signal| records.iter().find(|own| own.signal == *signal);
        let observation = |channel: &Channel, fitted: bool| {
            let own = between(
                channel,
                [find(&channel.numerator), find(&channel.denominator)],
                frequency,
            );
            Observation { fitted, ..own }
        };
        let fitted = channels.fitted.iter().map(|channel| observation(channel, true));
        let compared = channels.compared.iter().map(|channel| observation(channel, false));
        Level {
            observations: fitted.chain(compared).collect(),
            ..self.level.clone()
        }
    }
}

/// The kind of sensor that records a signal; all derivatives of a motion count as one.
pub(super) fn quantity(kind: SignalKind) -> &'static str {
    match kind {
        SignalKind::Motion(_) => "acceleration",
        SignalKind::Force => "force",
        SignalKind::Stretch => "stretch",
    }
}

/// A seed that depends only on the name of a signal.
fn seed(signal: &Signal) -> u64 {
    let name = signal.location.bytes().chain(signal.axis.bytes());
    name.fold(14_695_981_039_346_656_037, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(1_099_511_628_211)
    })
}

/// A value with a relative error. The error adds to the value, since at the end of a long chain the noise of a sensor may
/// be a million times the signal.
fn disturbed(value: Complex<f64>, relative_error: Complex<f64>) -> Complex<f64> {
    value * (1.0 + relative_error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_that_drowns_the_signal_gives_a_number() {
        let found = disturbed(Complex::new(1e-9, 0.0), Complex::new(1e6, -1e6));
        assert!((found - Complex::new(1e-3, -1e-3)).norm() < 1e-8, "{found}");
    }
}
