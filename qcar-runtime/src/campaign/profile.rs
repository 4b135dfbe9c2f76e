//! Profiles of roads: plain tables, corners in a workbook, and measured files with a channel of distances.

use std::path::{Path, PathBuf};

use qcar_signals::si::{Si, in_si};
use qcar_signals::signal::{Recording, Signal};

use super::contents::{Campaign, Profile, Road};
use super::curve::{increasing, read};
use super::manifest::ROAD;
use super::recorded::{problem, recording};
use crate::error::{InputError, Place, Problem};

/// A road profile as sampled. It goes on flat beyond its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadSamples {
    /// Where it was read, to be named in errors.
    pub file: PathBuf,
    /// m, increasing.
    pub x: Vec<f64>,
    /// m.
    pub z: Vec<f64>,
    /// Of the segment to the right of each point.
    pub slope: Vec<f64>,
}

impl Campaign {
    /// Reads a road profile.
    ///
    /// # Errors
    /// Where its file holds anything but finite numbers, or `x` does not increase.
    pub fn road(&self, road: &Road) -> Result<RoadSamples, InputError> {
        let file = self.folder.join(&road.file);
        match &road.profile {
            Profile::Corners(corners) => between(file, &road.name, corners),
            Profile::Measured(source) => RoadSamples::measured(&file, source.as_deref()),
            Profile::Table => {
                let mut table = read(&file, ROAD)?;
                let x = increasing(&mut table, "x")?;
                Ok(RoadSamples {
                    x,
                    z: table.take("z"),
                    slope: table.take("slope"),
                    file,
                })
            }
        }
    }
}

/// A road of straight pieces; two corners above each other are a step.
fn between(file: PathBuf, name: &str, corners: &[[f64; 2]]) -> Result<RoadSamples, InputError> {
    let backward = corners.windows(2).find(|pair| pair[1][0] < pair[0][0]);
    let third = corners.windows(3).find(|three| three[0][0] == three[2][0]);
    if let Some(pair) = backward.or(third) {
        let place = Place::Name(format!("{name} x"));
        let found = format!("{} m after {} m", pair[1][0], pair[0][0]);
        let expected = "a larger value, or the same value twice for a step";
        return Err(Problem::new(file, place, found, expected, "sort the rows, or correct the value").into());
    }
    let (mut x, mut z, mut slope) = (Vec::new(), Vec::new(), Vec::new());
    for (at, corner) in corners.iter().enumerate() {
        let next = corners.get(at + 1).copied().unwrap_or([f64::INFINITY, corner[1]]);
        // The foot of a step is where the slope of the piece before it leads.
        if next[0] > corner[0] {
            x.push(corner[0]);
            z.push(corner[1]);
            slope.push((next[1] - corner[1]) / (next[0] - corner[0]));
        }
    }
    Ok(RoadSamples { file, x, z, slope })
}

/// What a channel of distances along a road is called, in small letters.
const DISTANCES: [&str; 11] = [
    "x", "u", "s", "distance", "dist", "station", "chainage", "odometer", "position", "weg", "strecke",
];
/// What one of slopes is called, whose samples are those of the segment to their right.
const SLOPE: &str = "slope";
/// Powers of kilogram, metre and second of a length.
const LENGTH: [i32; 3] = [0, 1, 0];

impl RoadSamples {
    /// The profile in a measured file of any format: a channel of distances such as `x`, `u` or `distance`, and one of heights,
    /// which `source` names (a pattern, or `group/name`) where the file has several. Numbers without a unit are m. A channel `slope`
    /// beside them says where the road steps; without, it goes straight from sample to sample.
    ///
    /// # Errors
    /// A file that cannot be read, channels that are not there, of another quantity or of unlike length, samples without a
    /// value, distances that do not increase.
    pub fn measured(file: &Path, source: Option<&str>) -> Result<Self, InputError> {
        let recording = recording(file)?;
        let distances = distances(file, &recording)?;
        let heights = heights(file, &recording, distances, source)?;
        let (x, z) = (metres(file, distances)?, metres(file, heights)?);
        if x.len() != z.len() {
            let found = format!("{} heights over {} distances", z.len(), x.len());
            let remedy = "choose a channel that was sampled with the distances";
            return Err(Problem::new(file, of(heights), found, "one height for each distance", remedy).into());
        }
        if let Some(at) = x.windows(2).position(|pair| pair[1] <= pair[0]) {
            let found = format!("{} m after {} m at sample {}", x[at + 1], x[at], at + 2);
            let remedy = "sort the samples, and remove those at which the vehicle stood";
            return Err(Problem::new(file, of(distances), found, "distances that increase", remedy).into());
        }
        let stated = recording
            .signals
            .iter()
            .find(|signal| is_called(signal, &[SLOPE]) && signal.samples.len() == x.len());
        let chord = |pair: (&[f64], &[f64])| (pair.1[1] - pair.1[0]) / (pair.0[1] - pair.0[0]);
        let chords = || x.windows(2).zip(z.windows(2)).map(chord).chain([0.0]).collect();
        let slope = stated.map_or_else(chords, |signal| signal.samples.clone());
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

/// A length, also where no unit is stated.
fn length(signal: &Signal) -> Option<Si> {
    let stated = match signal.unit.as_str() {
        "" => "m",
        unit => unit,
    };
    in_si(stated).filter(|si| si.dimension == LENGTH)
}

fn distances<'a>(file: &Path, recording: &'a Recording) -> Result<&'a Signal, InputError> {
    let mut signals = recording.signals.iter();
    signals
        .find(|signal| is_called(signal, &DISTANCES) && length(signal).is_some())
        .ok_or_else(|| {
            let expected = format!("a length called {}", DISTANCES.join(", "));
            let (place, remedy) = (Place::File, "rename the channel of distances, or add one");
            Problem::new(file, place, "no channel of distances along the road", expected, remedy).into()
        })
}

fn heights<'a>(
    file: &Path,
    recording: &'a Recording,
    distances: &Signal,
    source: Option<&str>,
) -> Result<&'a Signal, InputError> {
    if let Some(source) = source {
        return recording.find(source).map_err(|fault| problem(file, &fault).into());
    }
    let is_height =
        |signal: &&Signal| !is_called(signal, &DISTANCES) && !is_called(signal, &[SLOPE]) && length(signal).is_some();
    let heights: Vec<&Signal> = recording.signals.iter().filter(is_height).collect();
    let heights: Vec<&Signal> = match heights.iter().find(|signal| is_called(signal, &["z"])) {
        Some(height) => vec![*height],
        None => heights,
    };
    match heights[..] {
        [height] => Ok(height),
        [] => {
            let remedy = "name the channel of heights `z`, in m or mm";
            Err(Problem::new(
                file,
                of(distances),
                "no heights over it",
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
                "choose one: `{}` behind a `#` on the command line, or `source` in a campaign",
                first.full_name()
            );
            Err(Problem::new(file, Place::File, found, "the one that the tyre rolls over", remedy).into())
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
    let value = |value: &f64| value * si.multiply / si.divide;
    Ok(signal.samples.iter().map(value).collect())
}
