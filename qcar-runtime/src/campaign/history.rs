//! Time histories: uniformly sampled channels of a run.

use std::path::{Path, PathBuf};

use super::contents::{Campaign, Channel, Run, Test};
use super::reading::RunData;
use super::steps;
use super::table::{self, Table};
use crate::error::{InputError, Place, Problem};
use crate::shown::six_digits;

/// A recorded run.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// Its file, for error messages.
    pub file: PathBuf,
    /// The test.
    pub test: Test,
    /// Time of the first sample, s.
    pub start: f64,
    /// Sample rate, Hz.
    pub sample_rate: f64,
    /// Channels with their samples, SI, all of one length of at least 2, in the order of the campaign.
    pub signals: Vec<(Channel, Vec<f64>)>,
}

impl History {
    /// The samples of a channel; `None` if the run did not record it.
    pub fn signal(&self, channel: &str) -> Option<&[f64]> {
        self.signals
            .iter()
            .find(|(recorded, _)| recorded.name == channel)
            .map(|(_, samples)| samples.as_slice())
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.signals.first().map_or(0, |(_, samples)| samples.len())
    }

    /// True without any sample, which [`Campaign::history`] never returns.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Campaign {
    /// Reads the time history of a sweep, cleat run or any other time history.
    ///
    /// # Errors
    /// Fails if `run` is a curve or has no channel, if its file has values that are not finite numbers, or if its time
    /// does not increase by the declared sample interval.
    pub fn history(&self, run: &Run) -> Result<History, InputError> {
        let file = self.folder.join(&run.file);
        if let Some(recorded) = self.recorded(run) {
            return self.recorded_history(run, recorded);
        }
        let Some(sample_rate) = run.test.sample_rate() else {
            return Err(no_history(&file));
        };
        let mut table = table::read(&file)?;
        let names: Vec<_> = self.channels.iter().map(|channel| channel.name.as_str()).collect();
        InputError::unless_empty(table::check_names(&file, &table.names, &["time"], &names), Some(()))?;
        let time = table.take("time");
        check_time(&table, &time, sample_rate)?;
        let recorded = self
            .channels
            .iter()
            .filter(|channel| table.names.contains(&channel.name));
        let recorded: Vec<_> = recorded.cloned().collect();
        let signals: Vec<_> = recorded.into_iter().map(|c| (c.clone(), table.take(&c.name))).collect();
        if signals.is_empty() {
            let remedy = "export the channels too";
            return Err(Problem::new(
                file,
                Place::Line(1),
                "no channel",
                "`time` and at least one channel",
                remedy,
            )
            .into());
        }
        Ok(History {
            file,
            test: run.test.clone(),
            start: time[0],
            sample_rate,
            signals,
        })
    }

    fn recorded_history(&self, run: &Run, recorded: &RunData) -> Result<History, InputError> {
        let file = self.folder.join(&run.file);
        if run.test.sample_rate().is_none() {
            return Err(no_history(&file));
        }
        let signals = recorded.columns.iter().filter_map(|(name, samples)| {
            let channel = self.channel(name)?;
            Some((channel.clone(), samples.clone()))
        });
        Ok(History {
            file,
            test: run.test.clone(),
            start: recorded.start,
            sample_rate: recorded.rate,
            signals: signals.collect(),
        })
    }
}

fn no_history(file: &Path) -> InputError {
    let remedy = "correct the `kind` of the run";
    Problem::new(file, Place::File, "a curve", "a time history", remedy).into()
}

/// Checks the times: every step is positive, the mean step is one sample interval, and no step is half or twice as
/// long.
fn check_time(table: &Table, time: &[f64], sample_rate: f64) -> Result<(), InputError> {
    let at = |row: usize, found: String, expected: String, remedy: &str| {
        Err(Problem::new(&table.file, table.cell(row, "time"), found, expected, remedy).into())
    };
    let (last, dt) = (time.len() - 1, 1.0 / sample_rate);
    if last == 0 {
        return at(
            0,
            "a single sample".into(),
            "at least two".into(),
            "export the whole record",
        );
    }
    let intervals: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(row) = intervals.iter().position(|&step| step <= 0.0) {
        let found = format!("{} s after {} s", time[row + 1], time[row]);
        return at(
            row + 1,
            found,
            "time that increases".into(),
            "sort the record, or remove duplicate samples",
        );
    }
    let (typical, mean) = (steps::median(&intervals), (time[last] - time[0]) / last as f64);
    // Printed times are rounded, which changes the median, and a gap changes the mean.
    if ![typical, mean].iter().any(|&step| steps::is_near(step, sample_rate)) {
        let (found, expected) = (
            format!("steps of {} s", six_digits(typical)),
            format!("steps of {} s by `sample_rate = {sample_rate}`", six_digits(dt)),
        );
        return at(
            1,
            found,
            expected,
            "correct `sample_rate` in campaign.toml, or the unit of time (s)",
        );
    }
    if let Some(row) = intervals.iter().position(|&step| !steps::is_one(step, sample_rate)) {
        let found = format!("a step of {} s", six_digits(intervals[row]));
        let remedy = "a gap cannot be filled: export the record again, or cut it before the gap";
        return at(row + 1, found, format!("a step of {} s", six_digits(dt)), remedy);
    }
    let measured = 1.0 / mean;
    if !steps::agree(measured, sample_rate, last) {
        let (found, expected) = (
            format!("{} samples a second", six_digits(measured)),
            format!("`sample_rate = {sample_rate}`"),
        );
        return at(last, found, expected, "correct `sample_rate` in campaign.toml");
    }
    Ok(())
}
