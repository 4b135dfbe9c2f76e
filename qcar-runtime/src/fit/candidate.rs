//! What else could be measured: levels with a sensor, a run, more drive or a wider band added, as the fitted model expects them.
//!
//! An added sensor is as noisy as those of its kind in the same run; one of another kind has their relative noise. What the model
//! misses of the channels that there are, it is taken to miss of the others, too.

use super::channels::{across_links, is_excitation};
use super::observation::{Difference, Level, Observation, Pair};
use crate::campaign::Role;
use crate::model::{About, Channel, Model, Quantity, Signal, SignalKind};
use crate::random::SplitMix;
use crate::response::parameters::Values;
use crate::response::ratio::ratio;
use nalgebra::Complex;
use serde::Serialize;

/// What is added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A sensor, in every fitted run along its axis.
    Sensor,
    /// A run with another excitation.
    Run,
    /// The same run once more.
    Repeat,
    /// The same run once more with twice the drive.
    Level,
    /// The same run beyond an end of its band.
    Band,
}

impl Kind {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::Run => "run",
            Self::Repeat => "repeat",
            Self::Level => "level",
            Self::Band => "band",
        }
    }
}

/// Levels to which something was added.
pub(super) struct Candidate {
    pub kind: Kind,
    /// In words.
    pub what: String,
    /// All that would be fitted.
    pub levels: Vec<Level>,
    /// What is new of it: of a sensor, its ratio to the excitation.
    pub added: Vec<Level>,
}

/// What a run says of a place, or would say: its motion over that of the excitation.
#[derive(Clone)]
struct Record {
    signal: Signal,
    value: Vec<Complex<f64>>,
    /// Relative, by noise.
    variance: Vec<f64>,
    differences: Vec<Difference>,
    sensors: usize,
}

/// A run as the model sees it.
struct Run<'a, M: ?Sized> {
    model: &'a M,
    values: &'a Values,
    level: &'a Level,
    source: Signal,
    frequency: Vec<f64>,
    records: Vec<Record>,
    /// The relative variance of what the model misses beside noise.
    misfit: f64,
}

/// All that could be added to the fitted levels.
pub(super) fn candidates<M: Model + ?Sized>(model: &M, values: &Values, levels: &[Level]) -> Vec<Candidate> {
    let fitted: Vec<&Level> = levels.iter().filter(|level| level.role == Role::Fit).collect();
    let runs: Vec<Run<'_, M>> = fitted
        .iter()
        .filter_map(|level| Run::new(model, values, level))
        .collect();
    let with = |kind: Kind, what: String, level: Level| Candidate {
        kind,
        what,
        levels: fitted.iter().copied().chain([&level]).cloned().collect(),
        added: vec![level],
    };
    let mut found = sensors(model.about(), &runs, &fitted);
    let driven = excitations(model, &runs).into_iter();
    found.extend(driven.map(|(what, level)| with(Kind::Run, what, level)));
    for run in &runs {
        let again = [
            (Kind::Repeat, "once more", 1.0),
            (Kind::Level, "once more at twice its level", 0.25),
        ];
        let name = &run.level.name;
        found.extend(again.map(|(kind, words, noise)| with(kind, format!("{name} {words}"), run.again(noise))));
        found.extend(
            run.wider()
                .into_iter()
                .map(|(what, level)| with(Kind::Band, what, level)),
        );
    }
    found
}

/// A candidate for each output that no fitted run along its axis records.
fn sensors<M: Model + ?Sized>(about: &About, runs: &[Run<'_, M>], fitted: &[&Level]) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    for output in about.outputs.iter() {
        let signal = match output.signal.kind {
            SignalKind::Motion(_) => Signal {
                kind: SignalKind::Motion(Quantity::Acceleration),
                ..output.signal.clone()
            },
            _ => output.signal.clone(),
        };
        let with: Vec<(&Run<'_, M>, Record)> = runs
            .iter()
            .filter_map(|run| Some((run, run.sensor(&signal)?)))
            .collect();
        let what = format!("{} of {} along {}", quantity(signal.kind), signal.location, signal.axis);
        if with.is_empty() || found.iter().any(|other| other.what == what) {
            continue;
        }
        let mut levels: Vec<Level> = fitted.iter().map(|level| (*level).clone()).collect();
        for (run, record) in &with {
            let records: Vec<Record> = run.records.iter().chain([record]).cloned().collect();
            levels[run.place(fitted)] = run.assembled(&records, &run.frequency);
        }
        found.push(Candidate {
            kind: Kind::Sensor,
            what,
            levels,
            added: with.iter().map(|(run, record)| run.alone(record)).collect(),
        });
    }
    found
}

fn quantity(kind: SignalKind) -> &'static str {
    match kind {
        SignalKind::Motion(_) => "acceleration",
        SignalKind::Force => "force",
        SignalKind::Stretch => "stretch",
    }
}

/// A run for each excitation that drives no fitted run, with sensors where these have them along its axis, else at every mass.
fn excitations<M: Model + ?Sized>(model: &M, runs: &[Run<'_, M>]) -> Vec<(String, Level)> {
    let about = model.about();
    let unused = (0..about.excitations.len()).filter(|own| runs.iter().all(|run| run.level.excitation != *own));
    let Some(like) = runs.first() else {
        return Vec::new();
    };
    let level = |excitation: usize| {
        let own = &about.excitations[excitation];
        let kind = if own.force {
            SignalKind::Force
        } else {
            SignalKind::Motion(Quantity::Acceleration)
        };
        let level = Level {
            name: own.name.to_string(),
            excitation,
            ..like.level.clone()
        };
        let run = Run {
            source: Signal {
                location: own.name.clone(),
                axis: own.axis.clone(),
                kind,
            },
            level: &level,
            frequency: like.frequency.clone(),
            records: Vec::new(),
            ..*like
        };
        let variance = like.usual_variance();
        let records = places(about, runs, &own.axis).into_iter().filter_map(|signal| {
            let value = run.response(&signal, &run.frequency)?;
            Some(run.expected(signal, value, variance.clone()))
        });
        let records: Vec<Record> = records.collect();
        (!records.is_empty()).then(|| {
            (
                format!("a run driven by {}", own.name),
                run.assembled(&records, &run.frequency),
            )
        })
    };
    unused.filter_map(level).collect()
}

/// Where accelerations along an axis are measured, else all that the model has.
fn places<M: ?Sized>(about: &About, runs: &[Run<'_, M>], axis: &str) -> Vec<Signal> {
    let records = runs.iter().flat_map(|run| &run.records).map(|record| &record.signal);
    let outputs = about.outputs.iter().map(|output| &output.signal);
    let mut found: Vec<Signal> = Vec::new();
    for signal in records.filter(|signal| signal.axis == axis) {
        if !found.contains(signal) {
            found.push(signal.clone());
        }
    }
    let accelerates =
        |signal: &&Signal| signal.axis == axis && signal.kind == SignalKind::Motion(Quantity::Acceleration);
    match found.is_empty() {
        true => outputs.filter(accelerates).cloned().collect(),
        false => found,
    }
}

impl<'a, M: Model + ?Sized> Run<'a, M> {
    /// None of a run that relates nothing to its excitation.
    fn new(model: &'a M, values: &'a Values, level: &'a Level) -> Option<Self> {
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
            level,
            source: observed.first()?.channel.denominator.clone(),
            frequency: observed.first()?.frequency.clone(),
            records: observed.iter().map(record).collect(),
            misfit: 0.0,
        };
        run.misfit = run.missed();
        Some(run)
    }

    fn place(&self, fitted: &[&Level]) -> usize {
        let own = fitted.iter().position(|level| std::ptr::eq(*level, self.level));
        own.expect("runs are made of these levels")
    }

    /// The mean square, over lines and places, of what is missed of logarithms, less what noise explains.
    fn missed(&self) -> f64 {
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
        let found = ratio(self.model, self.values, excitation, signal, &self.source, frequency);
        found.ok().map(|found| found.value)
    }

    /// Line by line the mean relative variance of the records.
    fn usual_variance(&self) -> Vec<f64> {
        let mean =
            |line: usize| self.records.iter().map(|own| own.variance[line]).sum::<f64>() / self.records.len() as f64;
        (0..self.frequency.len()).map(mean).collect()
    }

    /// What another sensor would record; none where the model has no such signal, or the run has it.
    fn sensor(&self, signal: &Signal) -> Option<Record> {
        let same = |own: &Signal| own.location == signal.location && quantity(own.kind) == quantity(signal.kind);
        let is_known = same(&self.source) || self.records.iter().any(|own| same(&own.signal));
        if is_known || signal.axis != self.source.axis {
            return None;
        }
        let value = self.response(signal, &self.frequency)?;
        let variance = self.variance_of(signal, &value);
        Some(self.expected(signal.clone(), value, variance))
    }

    /// A level of the ratio of one record to the excitation.
    fn alone(&self, record: &Record) -> Level {
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

    /// The relative variance of a sensor whose noise is that of the sensors of its kind.
    fn variance_of(&self, signal: &Signal, value: &[Complex<f64>]) -> Vec<f64> {
        let alike: Vec<&Record> = self
            .records
            .iter()
            .filter(|own| own.signal.kind == signal.kind)
            .collect();
        if alike.is_empty() {
            return self.usual_variance();
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

    /// A record that is off by as much as noise and misfit make likely, to one side or the other.
    fn expected(&self, signal: Signal, value: Vec<Complex<f64>>, variance: Vec<f64>) -> Record {
        let mut random = SplitMix::new(seed(&signal));
        let mut sign = || if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        let off = value.iter().zip(&variance).map(|(value, variance)| {
            let size = (0.5 * (variance + self.misfit)).sqrt();
            value * Complex::new(sign() * size, sign() * size).exp()
        });
        Record {
            value: off.collect(),
            variance,
            differences: Vec::new(),
            sensors: self.records.iter().map(|own| own.sensors).max().unwrap_or(1),
            signal,
        }
    }

    /// The run once more, with so much of its noise: what the model misses it misses again.
    fn again(&self, noise: f64) -> Level {
        let again = |own: &Record| {
            let model = self
                .response(&own.signal, &self.frequency)
                .unwrap_or_else(|| own.value.clone());
            let variance: Vec<f64> = own.variance.iter().map(|variance| noise * variance).collect();
            let fresh = Run {
                misfit: 0.0,
                records: Vec::new(),
                frequency: Vec::new(),
                source: self.source.clone(),
                ..*self
            };
            let mut record = fresh.expected(own.signal.clone(), model.clone(), variance);
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

    /// The run up to twice the end of its band, and from half its start on, as further levels.
    fn wider(&self) -> Vec<(String, Level)> {
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
                .map(|own| self.beyond(own, &frequency, from))
                .collect();
            Some((what, self.assembled(&records?, &frequency)))
        };
        [up, down].into_iter().filter_map(level).collect()
    }

    /// A record of a place on other lines, with the noise that it has at the end of its band.
    fn beyond(&self, own: &Record, frequency: &[f64], from: f64) -> Option<Record> {
        /// Lines at an end whose noise is that beyond it.
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
            ..self.expected(own.signal.clone(), value, variance)
        })
    }

    /// The channels that a fit would take of these records.
    fn assembled(&self, records: &[Record], frequency: &[f64]) -> Level {
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

/// The ratio of two records, of which none is the excitation itself.
fn between(channel: &Channel, [far, near]: [Option<&Record>; 2], frequency: &[f64]) -> Observation {
    let value = |of: Option<&Record>, line: usize| of.map_or(Complex::from(1.0), |own| own.value[line]);
    let variance = |of: Option<&Record>, line: usize| of.map_or(0.0, |own| own.variance[line]);
    let sensors = |of: Option<&Record>| of.map_or(1, |own| own.sensors);
    let lines = || 0..frequency.len();
    let relative_variance: Vec<f64> = lines().map(|line| variance(far, line) + variance(near, line)).collect();
    Observation {
        channel: channel.clone(),
        fitted: true,
        frequency: frequency.to_vec(),
        value: lines().map(|line| value(far, line) / value(near, line)).collect(),
        coherence: relative_variance
            .iter()
            .map(|variance| 1.0 / (1.0 + variance))
            .collect(),
        relative_variance,
        band: (frequency[0], frequency[frequency.len() - 1]),
        sensors: (sensors(far), sensors(near)),
        differences: [Pair::LeftRight, Pair::FrontRear]
            .into_iter()
            .filter_map(|pair| apart(pair, far, near))
            .collect(),
    }
}

/// What two symmetric sensors say apart from each other of a ratio.
fn apart(pair: Pair, far: Option<&Record>, near: Option<&Record>) -> Option<Difference> {
    let half = |of: Option<&Record>| {
        let own = of?.differences.iter().find(|own| own.pair == pair);
        own.map(|own| own.half.clone())
    };
    let half = match (half(far), half(near)) {
        (Some(far), Some(near)) => far.iter().zip(near).map(|(far, near)| far - near).collect(),
        (Some(far), None) => far,
        (None, Some(near)) => near.iter().map(|near| -near).collect(),
        (None, None) => return None,
    };
    Some(Difference { pair, half })
}

/// Of the signs of a place, always the same.
fn seed(signal: &Signal) -> u64 {
    let name = signal.location.bytes().chain(signal.axis.bytes());
    name.fold(14_695_981_039_346_656_037, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(1_099_511_628_211)
    })
}
