//! The channels of a run at one rate, over the same time.

use std::path::Path;

use qcar_signals::resample::{Grid, resample};

use super::super::contents::Run;
use super::super::finding::Finding;
use super::super::samples::of_samples;
use super::channel::Channel;
use super::even::Even;
use super::window::Span;
use crate::error::{InputError, Place, Problem};

/// A rate above this multiple of the highest rate of the channels is an error, and would only fill the memory.
const MOST: f64 = 10.0;

/// The channels of a run, and the times to which they are resampled.
pub(super) struct Together<'a> {
    channels: &'a [Channel<'a>],
    even: Vec<Even>,
    pub grid: Grid,
}

impl<'a> Together<'a> {
    /// Resamples to `rate`, or to the highest rate of the channels.
    pub fn new(file: &Path, channels: &'a [Channel<'a>], span: Span, rate: Option<f64>) -> Result<Self, InputError> {
        let highest = channels.iter().map(|channel| channel.rate).fold(0.0, f64::max);
        let rate = rate.unwrap_or(highest);
        if rate > MOST * highest {
            let expected = format!("at most {MOST} times the highest rate of its channels, {highest} Hz");
            let found = format!("`sample_rate = {rate}` for the run");
            return Err(Problem::new(file, Place::File, found, expected, "correct it, or leave it out").into());
        }
        let (mut even, mut problems) = (Vec::new(), Vec::new());
        for channel in channels {
            match channel.even(file, rate, span) {
                Ok(own) => even.push(own),
                Err(error) => problems.extend(error.problems),
            }
        }
        InputError::unless_empty(problems, Some(()))?;
        let grid = grid(file, channels, &even, rate)?;
        Ok(Together { channels, even, grid })
    }

    /// Names and samples; all have one length.
    pub fn columns(&self) -> Vec<(String, Vec<f64>)> {
        let both = self.channels.iter().zip(&self.even);
        both.map(|(channel, even)| (channel.mapping.name.clone(), on_grid(channel, even, self.grid)))
            .collect()
    }

    /// Flaws of the samples in the window. Curves may dwell and creep.
    pub fn findings(&self, run: &Run) -> Vec<Finding> {
        if run.test.sample_rate().is_none() {
            return Vec::new();
        }
        let both = self.channels.iter().zip(&self.even);
        let of = |(channel, even): (&Channel, &Even)| {
            let (values, grid) = (channel.values(even.samples.clone()), even.in_window());
            let values = &values[even.inside.clone()];
            let mut found = of_samples(run, (&channel.mapping.name, channel.mapping.si), values, grid);
            found.extend(channel.uneven.map(|(least, most)| Finding {
                run: run.name.clone(),
                channel: channel.mapping.name.clone(),
                span: (grid.start, grid.end()),
                what: format!(
                    "samples are uneven, {:.3} to {:.3} ms apart, so values are interpolated linearly",
                    1e3 * least,
                    1e3 * most
                ),
                fatal: false,
            }));
            found
        };
        both.flat_map(of).collect()
    }
}

/// Times that all channels cover, at the samples of the first channel with this rate.
fn grid(file: &Path, channels: &[Channel<'_>], even: &[Even], rate: f64) -> Result<Grid, InputError> {
    let latest = |of: fn(&Even) -> f64| even.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    let earliest = |of: fn(&Even) -> f64| even.iter().map(of).fold(f64::INFINITY, f64::min);
    let (start, end) = (latest(|even| even.start()), earliest(|even| even.end()));
    let (first, last) = (earliest(|even| even.start()), latest(|even| even.end()));
    // Channels of different rates begin and end within a sample or two of each other.
    let apart = 2.0 / channels.iter().map(|channel| channel.rate).fold(rate, f64::min);
    let ends_early = even.iter().position(|even| last - even.end() > apart);
    let begins_late = even.iter().position(|even| even.start() - first > apart);
    if let Some(at) = ends_early.or(begins_late) {
        let found = format!("samples from {} to {} s", even[at].start(), even[at].end());
        let expected = format!("{first} to {last} s as in other channels");
        let remedy = "give the run a `from` and `to` that all channels cover, or leave this one out with `without`";
        return Err(Problem::new(file, channels[at].place(), found, expected, remedy).into());
    }
    let anchor = channels.iter().position(|channel| channel.rate == rate);
    let anchor = anchor.map_or(start, |at| even[at].start());
    let start = anchor + ((start - anchor) * rate - 1e-3).ceil().max(0.0) / rate;
    let count = ((end - start) * rate + 1e-3).floor() as usize + 1;
    if count < 2 {
        let found = format!("{} s that all channels cover", end - start);
        let expected = format!("two samples at {rate} Hz at least");
        return Err(Problem::new(file, channels[0].place(), found, expected, "choose a longer window").into());
    }
    Ok(Grid { start, rate, count })
}

/// Values at these times: unchanged if they were sampled there, otherwise filtered.
fn on_grid(channel: &Channel<'_>, even: &Even, grid: Grid) -> Vec<f64> {
    let values = channel.values(even.samples.clone());
    let as_they_are = even.sample_at(grid.start).filter(|_| even.grid.rate == grid.rate);
    match as_they_are.and_then(|first| values.get(first..first + grid.count)) {
        Some(values) => values.to_vec(),
        None => resample(&values, even.grid, grid),
    }
}
