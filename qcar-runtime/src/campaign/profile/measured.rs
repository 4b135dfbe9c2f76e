//! The channels of a measured file that are a road profile.

use std::path::Path;

use qcar_signals::si::{Si, in_si};
use qcar_signals::signal::{Recording, Signal};

use super::super::recorded::{problem, recording};
use super::{RoadSamples, chords};
use crate::error::{InputError, Place, Problem};
use crate::shown::shown;

/// Names of a channel of distances along a road, in lower case.
const DISTANCES: [&str; 11] = [
    "x", "u", "s", "distance", "dist", "station", "chainage", "odometer", "position", "weg", "strecke",
];
/// Names of a channel of slopes; a sample is the slope of the segment to its right.
const SLOPE: &str = "slope";
/// Exponents of kilogram, metre and second of a length.
const LENGTH: [i32; 3] = [0, 1, 0];
const PER_CENT: f64 = 0.01;

impl RoadSamples {
    /// The profile in a measured file of any format: a channel of distances such as `x`, `u` or `distance`, and one of
    /// heights, selected by `source` (a pattern, or `group/name`) if the file has several. Numbers without a unit are
    /// m. A channel `slope` (1, m/m or %) states steps of the default heights; without it the road is straight between
    /// samples.
    ///
    /// # Errors
    /// Fails if the file cannot be read, if a channel is missing, ambiguous, of another quantity or another length, if
    /// samples have no value, or if distances do not increase.
    pub fn measured(file: &Path, source: Option<&str>) -> Result<Self, InputError> {
        Self::of(
            file,
            &recording(file, "correct the path, or put the file there")?,
            source,
        )
    }

    /// The profile in the contents of a file.
    pub(super) fn of(file: &Path, recording: &Recording, source: Option<&str>) -> Result<Self, InputError> {
        let distances = distances(file, recording)?;
        let heights = heights(file, recording, distances, source)?;
        let (x, z) = (metres(file, distances)?, metres(file, heights)?);
        if x.len() != z.len() {
            let found = format!("{} heights over {} distances", z.len(), x.len());
            let remedy = "choose a channel with the same samples as the distances";
            return Err(Problem::new(file, of(heights), found, "one height for each distance", remedy).into());
        }
        if let Some(at) = x.windows(2).position(|pair| pair[1] <= pair[0]) {
            let found = format!(
                "{} after {} at sample {}",
                shown(x[at + 1], "m"),
                shown(x[at], "m"),
                at + 2
            );
            let remedy = "sort the samples, and remove those at standstill";
            return Err(Problem::new(file, of(distances), found, "distances that increase", remedy).into());
        }
        let stated = match is_default(recording, heights) {
            true => slopes(file, recording, x.len())?,
            false => None,
        };
        let slope = stated.unwrap_or_else(|| chords(&x, &z));
        let file = file.into();
        Ok(RoadSamples { file, x, z, slope })
    }
}

fn is_called(signal: &Signal, names: &[&str]) -> bool {
    names.contains(&signal.name.to_lowercase().as_str())
}

fn of(signal: &Signal) -> Place {
    Place::Channel(signal.full_name(), None)
}

/// True for a length, or for numbers without a unit.
fn length(signal: &Signal) -> Option<Si> {
    let stated = match signal.unit.as_str() {
        "" => "m",
        unit => unit,
    };
    in_si(stated).filter(|si| si.dimension == LENGTH)
}

fn distances<'a>(file: &Path, recording: &'a Recording) -> Result<&'a Signal, InputError> {
    let signals = recording.signals.iter();
    let candidates: Vec<&Signal> = signals
        .filter(|signal| is_called(signal, &DISTANCES) && length(signal).is_some())
        .collect();
    let expected = || format!("a length called {}", DISTANCES.join(", "));
    match candidates[..] {
        [distances] => Ok(distances),
        [] => {
            let (found, remedy) = (
                "no channel of distances along the road",
                "rename the channel of distances, or add one",
            );
            Err(Problem::new(file, Place::File, found, expected(), remedy).into())
        }
        ref several => {
            let found = format!("several channels of distances: {}", listed(several));
            let remedy = "remove or rename all but the distance along the road";
            Err(Problem::new(file, Place::File, found, format!("one of them: {}", expected()), remedy).into())
        }
    }
}

fn listed(signals: &[&Signal]) -> String {
    let names: Vec<String> = signals
        .iter()
        .map(|signal| format!("`{}`", signal.full_name()))
        .collect();
    names.join(", ")
}

/// Possible channels of heights: `z` alone if it exists, otherwise all other lengths.
fn candidates(recording: &Recording) -> Vec<&Signal> {
    let is_height =
        |signal: &&Signal| !is_called(signal, &DISTANCES) && !is_called(signal, &[SLOPE]) && length(signal).is_some();
    let heights: Vec<&Signal> = recording.signals.iter().filter(is_height).collect();
    match heights.iter().find(|signal| is_called(signal, &["z"])) {
        Some(height) => vec![*height],
        None => heights,
    }
}

/// True if these are the default heights.
fn is_default(recording: &Recording, heights: &Signal) -> bool {
    matches!(candidates(recording)[..], [only] if std::ptr::eq(only, heights))
}

/// The slopes in the file; `None` without any.
fn slopes(file: &Path, recording: &Recording, distances: usize) -> Result<Option<Vec<f64>>, InputError> {
    let mut named = recording.signals.iter().filter(|signal| is_called(signal, &[SLOPE]));
    let Some(signal) = named.next() else {
        return Ok(None);
    };
    let refuse = |found: String, expected: &str, remedy: &str| {
        Err(Problem::new(file, of(signal), found, expected, remedy).into())
    };
    if let Some(other) = named.next() {
        let found = format!("another such channel, `{}`", other.full_name());
        return refuse(found, "one channel of slopes", "rename or remove one");
    }
    let scale = match signal.unit.as_str() {
        "" | "1" | "m/m" => 1.0,
        "%" => PER_CENT,
        unit => {
            let remedy = "give the slope as a ratio, or rename the channel if it is not the slope of the road";
            return refuse(format!("the unit `{unit}`"), "1, m/m or %", remedy);
        }
    };
    if signal.samples.len() != distances {
        let found = format!("{} slopes over {distances} distances", signal.samples.len());
        return refuse(found, "one slope for each distance", "rename or remove the channel");
    }
    if let Some(at) = signal.samples.iter().position(|value| !value.is_finite()) {
        let found = format!("no value at sample {} of {distances}", at + 1);
        return refuse(found, "a value in every sample", "fill the gap, or remove the channel");
    }
    Ok(Some(signal.samples.iter().map(|value| scale * value).collect()))
}

fn heights<'a>(
    file: &Path,
    recording: &'a Recording,
    distances: &Signal,
    source: Option<&str>,
) -> Result<&'a Signal, InputError> {
    if let Some(source) = source {
        let chosen = recording.find(source).map_err(|fault| problem(file, &fault))?;
        if std::ptr::eq(chosen, distances) {
            let (found, remedy) = ("the distances along the road", "choose the channel of heights");
            return Err(Problem::new(file, of(chosen), found, "a channel of heights", remedy).into());
        }
        return Ok(chosen);
    }
    let heights = candidates(recording);
    match heights[..] {
        [height] => Ok(height),
        [] => {
            let remedy = "name the channel of heights `z`, in m or mm";
            Err(Problem::new(
                file,
                of(distances),
                "no channel of heights in this file",
                "a channel of heights",
                remedy,
            )
            .into())
        }
        [first, .., last] => {
            let found = format!(
                "{} channels of heights, from `{}` to `{}`",
                heights.len(),
                first.full_name(),
                last.full_name()
            );
            let remedy = format!(
                "choose one: `{}` after a `#` on the command line, or `source` in a campaign",
                first.full_name()
            );
            Err(Problem::new(file, Place::File, found, "exactly one, on which the tyre rolls", remedy).into())
        }
    }
}

/// The samples in m.
fn metres(file: &Path, signal: &Signal) -> Result<Vec<f64>, InputError> {
    let wrong = |found: String, expected: &str, remedy: &str| Problem::new(file, of(signal), found, expected, remedy);
    let Some(si) = length(signal) else {
        let found = format!("the unit `{}`", signal.unit);
        return Err(wrong(found, "a length such as m or mm", "choose a channel of lengths").into());
    };
    if let Some(at) = signal.samples.iter().position(|value| !value.is_finite()) {
        let found = format!("no value at sample {} of {}", at + 1, signal.samples.len());
        return Err(wrong(
            found,
            "a value in every sample",
            "choose another channel, or fill the gap",
        )
        .into());
    }
    let value = |value: f64| value * si.multiply / si.divide;
    Ok(signal.samples.iter().map(value).collect())
}
