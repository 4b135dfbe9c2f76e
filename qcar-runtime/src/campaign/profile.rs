//! Profiles of roads: plain tables, corners in a workbook, and measured files with a channel of distances.

use std::path::PathBuf;

use super::contents::{Campaign, Profile, Road};
use super::curve::{increasing, read};
use super::manifest::{ROAD, SLOPE};
use super::recorded::{BESIDE_MANIFEST, recording};
use crate::error::{InputError, Place, Problem};
use crate::shown::shown;

// The channels of distance and height in a measured file.
mod measured;

/// A sampled road profile, level beyond its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadSamples {
    /// Its file, for error messages.
    pub file: PathBuf,
    /// Distance, m, increasing.
    pub x: Vec<f64>,
    /// Height, m.
    pub z: Vec<f64>,
    /// Slope of the segment to the right of each point.
    pub slope: Vec<f64>,
}

impl Campaign {
    /// Reads a road profile.
    ///
    /// # Errors
    /// Fails if its file has values that are not finite numbers, or if `x` does not increase.
    pub fn road(&self, road: &Road) -> Result<RoadSamples, InputError> {
        let file = self.folder.join(&road.file);
        match &road.profile {
            Profile::Corners(corners) => between(file, &road.name, corners),
            Profile::Measured(source) => {
                let recording = recording(&file, BESIDE_MANIFEST)?;
                RoadSamples::of(&file, &recording, source.as_deref())
            }
            Profile::Table => {
                let mut table = read(&file, ROAD, SLOPE)?;
                let x = increasing(&mut table, "x")?;
                let z = table.take("z");
                let is_stated = table.names.iter().any(|name| SLOPE.contains(&name.as_str()));
                let slope = match is_stated {
                    true => table.take("slope"),
                    false => chords(&x, &z),
                };
                Ok(RoadSamples { file, x, z, slope })
            }
        }
    }
}

/// A road of straight pieces; two corners at the same distance are a step.
fn between(file: PathBuf, name: &str, corners: &[[f64; 2]]) -> Result<RoadSamples, InputError> {
    let backward = corners.windows(2).find(|pair| pair[1][0] < pair[0][0]);
    let third = corners.windows(3).find(|three| three[0][0] == three[2][0]);
    if let Some(pair) = backward.or(third) {
        let place = Place::Name(format!("{name} x"));
        let found = format!("{} after {}", shown(pair[1][0], "m"), shown(pair[0][0], "m"));
        let expected = "a larger value, or the same value twice for a step";
        return Err(Problem::new(file, place, found, expected, "sort the rows, or correct the value").into());
    }
    let (mut x, mut z, mut slope) = (Vec::new(), Vec::new(), Vec::new());
    for (at, corner) in corners.iter().enumerate() {
        let next = corners.get(at + 1).copied().unwrap_or([f64::INFINITY, corner[1]]);
        // The lower end of a step follows from the slope of the piece before it.
        if next[0] > corner[0] {
            x.push(corner[0]);
            z.push(corner[1]);
            slope.push((next[1] - corner[1]) / (next[0] - corner[0]));
        }
    }
    Ok(RoadSamples { file, x, z, slope })
}

/// Slopes of the straight pieces between samples; level after the last one.
fn chords(x: &[f64], z: &[f64]) -> Vec<f64> {
    let chord = |(x, z): (&[f64], &[f64])| (z[1] - z[0]) / (x[1] - x[0]);
    x.windows(2).zip(z.windows(2)).map(chord).chain([0.0]).collect()
}
