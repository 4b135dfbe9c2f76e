//! Runs whose files are no plain tables: finds channels by name, converts to SI, resamples to one rate, and cuts the
//! window.

use std::path::Path;

use super::contents::{Campaign, ChannelMapping, Run};
use super::reading::{MissingChannel, RunData};
use crate::error::{InputError, Place, Problem};
use channel::Channel;
use together::Together;
use window::Span;

// Measured files, each read once.
mod files;
// Samples at uneven times.
mod uneven;
// Samples at a constant rate.
mod even;
// The beginning and end of a run.
mod window;
// Conversion to SI.
mod values;
// A sensor's samples from the channel of its mapping.
mod channel;
// All channels of a run at one rate.
mod together;

pub(super) use files::{BESIDE_MANIFEST, Files, problem, recording};

impl Campaign {
    /// Data of a run; `None` if its file is a plain table.
    pub(super) fn recorded(&self, run: &Run) -> Option<&RunData> {
        self.recorded.iter().find(|recorded| recorded.run == run.name)
    }

    /// The mappings of a run: the sensors, or the columns of a curve.
    fn mappings_of<'a>(&'a self, run: &'a Run) -> Vec<&'a ChannelMapping> {
        let mappings = match run.test.sample_rate() {
            Some(_) => &self.mappings,
            None => &run.columns,
        };
        mappings
            .iter()
            .filter(|mapping| !run.without.contains(&mapping.name))
            .collect()
    }

    /// The channels of its file that a run needs.
    fn sources(&self, run: &Run) -> Vec<String> {
        let mappings = self.mappings_of(run).into_iter().map(|mapping| mapping.source.clone());
        let trigger = run.window.trigger.iter().map(|trigger| trigger.channel.clone());
        mappings.chain(trigger).collect()
    }
}

/// Highest sample rate of the channels that `mappings` select in a file, Hz.
pub(super) fn highest_rate(files: &Files, file: &Path, mappings: &[&ChannelMapping]) -> Result<f64, InputError> {
    let sources: Vec<String> = mappings.iter().map(|mapping| mapping.source.clone()).collect();
    let recording = files.with(file, &sources)?;
    let (mut highest, mut is_any) = (0.0_f64, false);
    for mapping in mappings.iter().filter(|mapping| recording.has(&mapping.source)) {
        let signal = recording.find(&mapping.source);
        let signal = signal.map_err(|fault| InputError::from(problem(file, &fault)))?;
        highest = highest.max(even::rate(&signal.time, signal.samples.len(), None).unwrap_or(0.0));
        is_any = true;
    }
    if highest > 0.0 {
        return Ok(highest);
    }
    let (found, remedy) = match is_any {
        true => (
            "channels without times",
            "state `sample_rate`, and correct the `source` of the channels",
        ),
        false if mappings.is_empty() => (
            "no `[[channel]]` for it in the campaign",
            "add one with its `source` for each sensor; `qcar inspect` lists the channels of the file",
        ),
        false => (
            "none of the channels that the campaign names",
            "state `sample_rate`, and correct the `source` of the channels",
        ),
    };
    Err(Problem::new(file, Place::File, found, "channels with a sample rate", remedy).into())
}

/// The problem of a run for which the campaign declares no channel.
fn undeclared(campaign: &Campaign, run: &Run) -> Problem {
    let found = format!("none for the run `{}`", run.name);
    let remedy = format!(
        "add one with its `source`; `qcar inspect {}` lists the channels of the file",
        run.file
    );
    let place = Place::Name("channel".into());
    Problem::new(
        campaign.manifest(),
        place,
        found,
        "a `[[channel]]` for each sensor",
        remedy,
    )
}

/// Reads a run.
pub(super) fn record(campaign: &Campaign, files: &Files, run: &Run) -> Result<RunData, InputError> {
    let file = campaign.folder.join(&run.file);
    let recording = files.with(&file, &campaign.sources(run))?;
    // A slow curve needs no times.
    let declared = run.test.sample_rate().or(run.test.is_curve().then_some(1.0));
    let span = Span::of(&file, &recording, &run.window, declared)?;
    let (mut channels, mut missing, mut problems) = (Vec::new(), Vec::new(), Vec::new());
    for mapping in campaign.mappings_of(run) {
        match Channel::mapped(&file, &recording, mapping, declared) {
            Ok(channel) if run.test.is_curve() => channels.push(channel.up_to_its_last_value()),
            Ok(channel) => channels.push(channel),
            Err(error) if recording.has(&mapping.source) => problems.extend(error.problems),
            Err(error) => missing.extend(error.problems.into_iter().map(|problem| MissingChannel {
                name: mapping.name.clone(),
                problem,
            })),
        }
    }
    if channels.is_empty() || run.test.sample_rate().is_none() {
        problems.extend(missing.iter().map(|missing| missing.problem.clone()));
    }
    if channels.is_empty() && problems.is_empty() {
        problems.push(undeclared(campaign, run));
    }
    InputError::unless_empty(problems, Some(()))?;
    let together = Together::new(&file, &channels, span, run.test.sample_rate())?;
    Ok(RunData {
        run: run.name.clone(),
        start: together.grid.start - span.zero.unwrap_or(0.0),
        rate: together.grid.rate,
        columns: together.columns(),
        missing,
        findings: together.findings(run),
    })
}
