//! Candidate measurements: levels with a sensor, a run, a higher level or a wider band added.

use super::observation::Level;
use super::predicted_run::{PredictedRun, quantity};
use super::record::Record;
use crate::campaign::Role;
use crate::model::{About, Model, Quantity, Signal, SignalKind};
use crate::response::parameters::Values;
use serde::Serialize;

/// The kind of an additional measurement.
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
    /// A link alone, its forces over its speed.
    Dynamometer,
}

impl Kind {
    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::Run => "run",
            Self::Repeat => "repeat",
            Self::Level => "level",
            Self::Band => "band",
            Self::Dynamometer => "dynamometer",
        }
    }
}

/// Levels with a measurement added.
pub(super) struct Candidate {
    pub kind: Kind,
    /// Description.
    pub what: String,
    /// All levels that would be fitted.
    pub levels: Vec<Level>,
    /// The additional information: for a sensor, its ratio to the excitation.
    pub added: Vec<Level>,
}

/// All measurements that could be added to the fitted levels.
pub(super) fn candidates<M: Model + ?Sized>(model: &M, values: &Values, levels: &[Level]) -> Vec<Candidate> {
    let fitted: Vec<&Level> = levels.iter().filter(|level| level.role == Role::Fit).collect();
    let runs: Vec<PredictedRun<'_, M>> = fitted
        .iter()
        .filter_map(|level| PredictedRun::new(model, values, level))
        .collect();
    let with = |kind: Kind, what: String, level: Level| Candidate {
        kind,
        what,
        levels: fitted.iter().copied().chain([&level]).cloned().collect(),
        added: vec![level],
    };
    let mut found = sensors(model.about(), &runs, &fitted);
    let driven = excitations(model.about(), &runs).into_iter();
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
fn sensors<M: Model + ?Sized>(about: &About, runs: &[PredictedRun<'_, M>], fitted: &[&Level]) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    for output in about.outputs.iter() {
        let signal = match output.signal.kind {
            SignalKind::Motion(_) => Signal {
                kind: SignalKind::Motion(Quantity::Acceleration),
                ..output.signal.clone()
            },
            _ => output.signal.clone(),
        };
        let with: Vec<(&PredictedRun<'_, M>, Record)> = runs
            .iter()
            .filter_map(|run| Some((run, run.sensor(&signal)?)))
            .collect();
        let what = format!("{} of {} along {}", quantity(signal.kind), signal.location, signal.axis);
        if with.is_empty() || found.iter().any(|other| other.what == what) {
            continue;
        }
        let level = |own: &&Level| {
            let new = with.iter().find(|(run, _)| run.level.name == own.name);
            new.map_or_else(|| (*own).clone(), |(run, record)| run.beside(record))
        };
        found.push(Candidate {
            kind: Kind::Sensor,
            what,
            levels: fitted.iter().map(level).collect(),
            added: with.iter().map(|(run, record)| run.alone(record)).collect(),
        });
    }
    found
}

/// A run for each excitation that no fitted run uses, with the sensors of the fitted runs along its axis, or else one
/// at every mass.
fn excitations<M: Model + ?Sized>(about: &About, runs: &[PredictedRun<'_, M>]) -> Vec<(String, Level)> {
    let unused = (0..about.excitations.len()).filter(|own| runs.iter().all(|run| run.level.excitation != *own));
    let driven = |excitation: usize| {
        let own = &about.excitations[excitation];
        let level = runs.first()?.driven(excitation, places(about, runs, &own.axis))?;
        Some((format!("a run driven by {}", own.name), level))
    };
    unused.filter_map(driven).collect()
}

/// The measured accelerations along an axis, or else all that the model has.
fn places<M: ?Sized>(about: &About, runs: &[PredictedRun<'_, M>], axis: &str) -> Vec<Signal> {
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
