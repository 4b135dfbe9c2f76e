//! Runs whose files are no plain tables: channels found by name, in SI, at one rate, cut to their window.

use std::path::Path;

use qcar_signals::resample::{Grid, reach, resample};
use qcar_signals::signal::{Recording, Signal, TimeBase};

use super::contents::{Campaign, Run, Tap, Test};
use super::findings::{self, Finding};
use crate::error::{Place, Problem};
use even::{Broken, Even};
use files::problem;
use window::{Span, clock};

// Samples that come evenly.
mod even;
// Each file read once.
mod files;
// Values in SI.
mod values;
// When a run begins and ends.
mod window;

pub(super) use files::Files;

/// What was read of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Recorded {
    /// The run's name.
    pub run: String,
    /// Time of the first sample, s.
    pub start: f64,
    /// Hz.
    pub rate: f64,
    /// Name and samples (SI) of each sensor or column, all of one length.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Taps that the file has no channel for.
    pub missing: Vec<Missing>,
    /// What the samples show to be odd, before they were resampled.
    pub findings: Vec<Finding>,
}

impl Recorded {
    /// Whether it has a sensor or column.
    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(own, _)| own == name)
    }

    /// A column of a curve, which none lacks.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let column = self.columns.iter().find(|(own, _)| own == name);
        column.expect("a curve without this column was refused").1.clone()
    }

    /// The times of the samples, s.
    pub fn times(&self) -> Vec<f64> {
        let count = self.columns.first().map_or(0, |(_, samples)| samples.len());
        (0..count).map(|at| self.start + at as f64 / self.rate).collect()
    }
}

/// A tap that a file has no channel for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Missing {
    pub name: String,
    pub problem: Problem,
}

/// A channel with its values in SI.
struct Channel<'a> {
    tap: &'a Tap,
    signal: &'a Signal,
    base: TimeBase,
    values: Vec<f64>,
    rate: f64,
}

impl Campaign {
    /// What was read of a run, `None` where its file is a plain table.
    pub(super) fn recorded(&self, run: &Run) -> Option<&Recorded> {
        self.recorded.iter().find(|recorded| recorded.run == run.name)
    }

    /// The taps of a run: the sensors, or the columns of a curve.
    fn taps_of<'a>(&'a self, run: &'a Run) -> Vec<&'a Tap> {
        let taps = match run.test.sample_rate() {
            Some(_) => &self.taps,
            None => &run.columns,
        };
        taps.iter().filter(|tap| !run.without.contains(&tap.name)).collect()
    }
}

/// The highest rate among the channels of a file that `taps` mean, Hz.
pub(super) fn highest_rate(files: &Files, file: &Path, taps: &[&Tap]) -> Result<f64, Problem> {
    let recording = files.get(file)?;
    let found = taps.iter().filter(|tap| recording.has(&tap.source));
    let signals: Vec<&Signal> = found
        .map(|tap| recording.find(&tap.source).map_err(|fault| problem(file, &fault)))
        .collect::<Result<_, _>>()?;
    let rates = signals
        .iter()
        .filter_map(|signal| even::rate(&signal.time, signal.samples.len(), None));
    rates.reduce(f64::max).ok_or_else(|| {
        let found = match signals.first() {
            Some(_) => "channels without times".to_string(),
            None => "none of the channels that the campaign names".into(),
        };
        let remedy = "state `sample_rate`, and correct the `source` of the channels";
        Problem::new(file, Place::File, found, "channels with a sample rate", remedy)
    })
}

/// Reads a run.
pub(super) fn record(campaign: &Campaign, files: &Files, run: &Run) -> Result<Recorded, Vec<Problem>> {
    let file = campaign.folder.join(&run.file);
    let recording = files.get(&file).map_err(|problem| vec![problem])?;
    // A quasi-static curve needs no times.
    let declared = run.test.sample_rate().or(match run.test {
        Test::Bounce | Test::Longitudinal => Some(1.0),
        _ => None,
    });
    let span = Span::of(&file, &recording, &run.window, declared).map_err(|problem| vec![problem])?;
    let (mut channels, mut missing, mut problems) = (Vec::new(), Vec::new(), Vec::new());
    for tap in campaign.taps_of(run) {
        match channel(&file, &recording, tap, declared) {
            Ok(channel) => channels.push(channel),
            Err(problem) if recording.has(&tap.source) => problems.push(problem),
            Err(problem) => missing.push(Missing {
                name: tap.name.clone(),
                problem,
            }),
        }
    }
    if channels.is_empty() || run.test.sample_rate().is_none() {
        problems.extend(missing.iter().map(|missing| missing.problem.clone()));
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let highest = channels.iter().map(|channel| channel.rate).fold(0.0, f64::max);
    let rate = run.test.sample_rate().unwrap_or(highest);
    let even = evened(&file, &channels, span, rate)?;
    let grid = common(&file, &channels, &even, rate).map_err(|problem| vec![problem])?;
    let both = || channels.iter().zip(&even);
    Ok(Recorded {
        run: run.name.clone(),
        start: grid.start - span.zero.unwrap_or(0.0),
        rate: grid.rate,
        columns: both()
            .map(|(channel, even)| (channel.tap.name.clone(), taken(even, grid)))
            .collect(),
        missing,
        findings: both().flat_map(|(channel, even)| channel.findings(run, even)).collect(),
    })
}

fn channel<'a>(
    file: &Path,
    recording: &'a Recording,
    tap: &'a Tap,
    declared: Option<f64>,
) -> Result<Channel<'a>, Problem> {
    let signal = recording.find(&tap.source).map_err(|fault| {
        let problem = problem(file, &fault);
        let expected = format!("{}, as `source` of `{}` says", problem.expected, tap.name);
        Problem { expected, ..problem }
    })?;
    let known = clock(&signal.time, declared);
    let rated = known.and_then(|base| Some((even::rate(&base, signal.samples.len(), declared)?, base)));
    let Some((rate, base)) = rated else {
        let remedy = "state the `sample_rate` of the run";
        let place = Place::Channel(signal.full_name(), None);
        return Err(Problem::new(
            file,
            place,
            "no times",
            "when the samples were taken",
            remedy,
        ));
    };
    Ok(Channel {
        tap,
        signal,
        values: values::values(file, signal, &base, tap)?,
        base,
        rate,
    })
}

/// The samples of each channel in the window.
fn evened<'a>(file: &Path, channels: &'a [Channel<'_>], span: Span, rate: f64) -> Result<Vec<Even<'a>>, Vec<Problem>> {
    let even = channels
        .iter()
        .map(|channel| channel.even(rate, span).map_err(|broken| channel.problem(file, broken)));
    let (even, broken): (Vec<_>, Vec<_>) = even.partition(Result::is_ok);
    match broken.is_empty() {
        true => Ok(even.into_iter().flatten().collect()),
        false => Err(broken.into_iter().filter_map(Result::err).collect()),
    }
}

impl Channel<'_> {
    fn even(&self, rate: f64, span: Span) -> Result<Even<'_>, Broken> {
        let margin = (reach(self.rate, rate) * self.rate).ceil() as usize + 1;
        Even::new(&self.values, &self.base, self.rate, span.ends(), margin)
    }

    /// What the samples in the window show to be odd. Curves dwell and creep as they should.
    fn findings(&self, run: &Run, even: &Even<'_>) -> Vec<Finding> {
        if run.test.sample_rate().is_none() {
            return Vec::new();
        }
        let inside = Grid {
            start: even.start(),
            ..even.grid
        };
        let samples = &even.samples[even.inside.clone()];
        findings::of_samples(run, (&self.tap.name, self.tap.si), samples, inside)
    }

    fn problem(&self, file: &Path, broken: Broken) -> Problem {
        let place = Place::Channel(self.signal.full_name(), broken.at);
        Problem::new(file, place, broken.found, broken.expected, broken.remedy)
    }
}

/// The instants that all channels cover, on samples of the first one that has the rate.
fn common(file: &Path, channels: &[Channel<'_>], even: &[Even<'_>], rate: f64) -> Result<Grid, Problem> {
    let start = even.iter().map(Even::start).fold(f64::NEG_INFINITY, f64::max);
    let end = even.iter().map(Even::end).fold(f64::INFINITY, f64::min);
    let first = even.iter().map(Even::start).fold(f64::INFINITY, f64::min);
    let last = even.iter().map(Even::end).fold(f64::NEG_INFINITY, f64::max);
    // Channels of several rates begin and end within a sample or two of each other.
    let apart = 2.0 / channels.iter().map(|channel| channel.rate).fold(rate, f64::min);
    if start - first > apart || last - end > apart {
        let at = even.iter().position(|even| even.end() == end && last - end > apart);
        let at = at
            .or_else(|| even.iter().position(|even| even.start() == start))
            .unwrap_or(0);
        let found = format!("samples from {} to {} s", even[at].start(), even[at].end());
        let expected = format!("{first} to {last} s as in other channels");
        let remedy = "give the run a `from` and `to` that all channels cover, or leave this one out with `without`";
        let place = Place::Channel(channels[at].signal.full_name(), None);
        return Err(Problem::new(file, place, found, expected, remedy));
    }
    let anchor = channels
        .iter()
        .position(|channel| channel.rate == rate)
        .map(|at| even[at].start());
    let anchor = anchor.unwrap_or(start);
    let start = anchor + ((start - anchor) * rate - 1e-3).ceil().max(0.0) / rate;
    let count = ((end - start) * rate + 1e-3).floor() as usize + 1;
    Ok(Grid { start, rate, count })
}

/// The samples at the instants of the grid: as they are where they were taken then, else through the filter.
fn taken(even: &Even<'_>, grid: Grid) -> Vec<f64> {
    let as_they_are = even.sample_at(grid.start).filter(|_| even.grid.rate == grid.rate);
    match as_they_are.and_then(|first| even.samples.get(first..first + grid.count)) {
        Some(samples) => samples.to_vec(),
        None => resample(even.samples, even.grid, grid),
    }
}
