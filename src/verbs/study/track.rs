//! Cleat runs: measured and simulated traces, and the errors of the whole set.

use std::collections::BTreeMap;

use qcar_runtime::campaign::{Role, RoleNames, Test};
use qcar_runtime::compare::{Histogram, Windows};
use qcar_runtime::model::About;
use qcar_runtime::simulate::{Cleat, Ride};
use serde::Serialize;

use super::gather::{self, Study};
use crate::report::rounded::curve;
use crate::verbs::simulate::CleatResults;
use crate::verbs::simulate::comparison::{Compared, Pair, alignment, pairs};

/// All runs.
#[derive(Serialize)]
pub struct Track<'a> {
    runs: Vec<Run>,
    /// Parameters of the baseline that are still at their start values.
    at_start: &'a [String],
    /// Errors by `mass_axis`.
    histograms: BTreeMap<String, Errors>,
}

/// A run over a cleat.
#[derive(Serialize)]
struct Run {
    file: String,
    role: &'static str,
    /// Speed, m/s.
    speed: f64,
    cleat: String,
    /// Times after the impact of the wheel, s.
    time: Vec<f64>,
    traces: Vec<Trace>,
}

/// An acceleration in m/s²; all records are aligned at the peak of the wheel.
#[derive(Serialize)]
struct Trace {
    mass: String,
    axis: String,
    measured: Vec<f64>,
    before: Vec<f64>,
    after: Option<Vec<f64>>,
    locked: Vec<f64>,
    vertical: Vec<f64>,
}

/// Histogram of relative errors.
#[derive(Serialize)]
struct Errors {
    peak: BeforeAfter,
    after_shake: BeforeAfter,
}

#[derive(Serialize)]
struct BeforeAfter {
    before: Histogram,
    after: Option<Histogram>,
}

/// Width of a bin, relative.
const BIN: f64 = 0.05;

/// Time before the impact that is shown, s.
const RUN_IN: f64 = 0.05;

/// The cleat runs of a study.
pub fn track(of: &Study) -> Option<Track<'_>> {
    let track = of.track.as_ref()?;
    let models = Models {
        named: &of.fitted.campaign.roles,
        before: of.fitted.model.about(),
        best: of
            .after
            .as_ref()
            .map_or(of.fitted.model.about(), |after| after.model.about()),
    };
    let runs = track.cleats.iter().enumerate();
    Some(Track {
        runs: runs
            .filter_map(|(place, cleat)| run(&models, track, place, cleat))
            .collect(),
        at_start: &track.at_start,
        histograms: histograms(
            &track.before.compared,
            track.after.as_ref().map(|driven| &driven.compared),
        ),
    })
}

/// The signals of the outputs, and the mass that the campaign calls the wheel.
struct Models<'a> {
    named: &'a RoleNames,
    before: &'a About,
    best: &'a About,
}

fn run(models: &Models, track: &gather::Track, place: usize, cleat: &Cleat) -> Option<Run> {
    let of = |about, driven: &'_ CleatResults| Aligned::new(about, models.named, cleat, &driven.rides[place]);
    let before = of(models.before, &track.before)?;
    let after = track.after.as_ref().and_then(|driven| of(models.best, driven));
    let (locked, vertical) = (of(models.best, &track.locked)?, of(models.best, &track.vertical)?);
    let traces = before.traces.iter().map(|(key, (measured, simulated))| Trace {
        mass: key.0.clone(),
        axis: key.1.clone(),
        measured: measured.clone(),
        before: simulated.clone(),
        after: after.as_ref().map(|after| after.simulated(key)),
        locked: locked.simulated(key),
        vertical: vertical.simulated(key),
    });
    let Test::Cleat { speed, cleat: name, .. } = &cleat.run.test else {
        return None;
    };
    Some(Run {
        file: cleat.run.name.clone(),
        role: if cleat.run.role == Role::Fit { "fit" } else { "held_out" },
        speed: *speed,
        cleat: name.clone(),
        time: before.time.clone(),
        traces: traces.collect(),
    })
}

/// A mass and an axis.
type Key = (String, String);

/// The records of a run over the shown time.
struct Aligned {
    time: Vec<f64>,
    /// Measured and simulated accelerations.
    traces: BTreeMap<Key, (Vec<f64>, Vec<f64>)>,
}

impl Aligned {
    fn new(about: &About, named: &RoleNames, cleat: &Cleat, ride: &Ride) -> Option<Self> {
        let pairs = pairs(about, cleat, ride);
        let alignment = alignment(about, named, &pairs).ok()??;
        let (rate, windows) = (cleat.measured.sample_rate, Windows::default());
        let samples = |seconds: f64| (seconds * rate).round() as usize;
        let from = alignment.onset.saturating_sub(samples(RUN_IN));
        let to = (alignment.onset + samples(windows.impact + windows.after_shake)).min(cleat.measured.len());
        let second = |sample: usize| (sample as f64 - alignment.onset as f64) / rate;
        let traces = pairs.iter().map(|pair| {
            let simulated = (from..to).map(|sample| at(pair.simulated, sample as isize + alignment.delay));
            (
                key(pair),
                (curve(pair.measured[from..to].iter().copied()), curve(simulated)),
            )
        });
        Some(Aligned {
            time: curve((from..to).map(second)),
            traces: traces.collect(),
        })
    }

    fn simulated(&self, key: &Key) -> Vec<f64> {
        self.traces
            .get(key)
            .map_or(Vec::new(), |(_, simulated)| simulated.clone())
    }
}

fn key(pair: &Pair) -> Key {
    (pair.mass.to_string(), pair.axis.name().to_string())
}

/// A sample; NaN beyond the ends.
fn at(record: &[f64], sample: isize) -> f64 {
    let place = usize::try_from(sample).ok();
    place.and_then(|place| record.get(place)).copied().unwrap_or(f64::NAN)
}

fn histograms(before: &Compared, after: Option<&Compared>) -> BTreeMap<String, Errors> {
    let names = before.summary.keys().cloned();
    names.map(|name| (name.clone(), errors(&name, before, after))).collect()
}

fn errors(name: &str, before: &Compared, after: Option<&Compared>) -> Errors {
    let of = |compared: &Compared, error: fn(&crate::verbs::simulate::comparison::Difference) -> f64| {
        let own = compared
            .runs
            .iter()
            .filter(|d| format!("{}_{}", d.mass, d.axis) == name);
        Histogram::new(&own.map(error).collect::<Vec<_>>(), BIN)
    };
    let both = |error| BeforeAfter {
        before: of(before, error),
        after: after.map(|after| of(after, error)),
    };
    Errors {
        peak: both(|d| d.peak_error),
        after_shake: both(|d| d.after_shake_error),
    }
}
