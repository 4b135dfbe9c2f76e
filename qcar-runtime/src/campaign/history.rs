//! Time histories: uniformly sampled channels of a run.

use std::path::PathBuf;

use super::contents::{Campaign, Channel, Run, Test};
use super::table::{self, Table};
use crate::error::{InputError, Place, Problem};

/// What a run has recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// Where it was read, to be named in errors.
    pub file: PathBuf,
    /// The test that it recorded.
    pub test: Test,
    /// Time of the first sample, s.
    pub start: f64,
    /// Hz.
    pub sample_rate: f64,
    /// The recorded channels with their samples, SI, all of one length of at least 2; in the order of the campaign.
    pub signals: Vec<(Channel, Vec<f64>)>,
}

impl History {
    /// The samples of a channel, `None` where the run did not record it.
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
    /// Where `run` is a curve, records no channel, holds anything but finite numbers, or where its time does not go on
    /// in steps of the declared sample rate.
    pub fn history(&self, run: &Run) -> Result<History, InputError> {
        let file = self.folder.join(&run.file);
        let Some(sample_rate) = run.test.sample_rate() else {
            let remedy = "ask for its curve, or correct the `kind` of the run";
            return Err(Problem::new(file, Place::File, "a curve", "a time history", remedy).into());
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
}

/// Largest relative difference between the declared sample rate and that of the whole record. Below it, the phase error
/// of a transmissibility is nil, since all channels share the clock, and frequencies are that exact.
const RATE_TOLERANCE: f64 = 1e-3;

/// Time must grow in every step, the steps must be one sample long as a rule, and none may be half or twice as long.
/// Printed times are rounded, so that a single step is only right to that extent.
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
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(row) = steps.iter().position(|&step| step <= 0.0) {
        let found = format!("{} s after {} s", time[row + 1], time[row]);
        return at(
            row + 1,
            found,
            "time that increases".into(),
            "sort the record, or remove what is recorded twice",
        );
    }
    let typical = median(&steps);
    if !(0.5..=1.5).contains(&(typical / dt)) {
        let (found, expected) = (
            format!("steps of {typical} s"),
            format!("steps of {dt} s by `sample_rate = {sample_rate}`"),
        );
        return at(
            1,
            found,
            expected,
            "correct `sample_rate` in campaign.toml, or the unit of time (s)",
        );
    }
    if let Some(row) = steps.iter().position(|&step| !(0.5..=1.5).contains(&(step / dt))) {
        let found = format!("a step of {} s", steps[row]);
        let remedy = "a gap cannot be guessed: export the record again, or cut it before the gap";
        return at(row + 1, found, format!("a step of {dt} s"), remedy);
    }
    let measured = last as f64 / (time[last] - time[0]);
    let rounding = 0.5 / last as f64;
    if (measured / sample_rate - 1.0).abs() > RATE_TOLERANCE + rounding {
        let (found, expected) = (
            format!("{measured} samples a second"),
            format!("`sample_rate = {sample_rate}`"),
        );
        return at(last, found, expected, "correct `sample_rate` in campaign.toml");
    }
    Ok(())
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let (_, median, _) = sorted.select_nth_unstable_by(values.len() / 2, f64::total_cmp);
    *median
}
