//! RPC III, the format of MTS for drive and response files: parameters of 32 and 96 characters in blocks of 512 bytes, then
//! groups of frames.
//!
//! A group holds all samples of the first channel, then all of the second and so on (demultiplexed), or, where `TIME_TYPE`
//! begins with `MULT`, the first samples of all channels, then the second ones (multiplexed). The last group is stored in full
//! however many of its frames count.

use std::collections::HashMap;

use crate::bytes::{Bytes, Number, Order, field};
use crate::error::{Fault, Place, Read};
use crate::signal::{Recording, Signal, Source, evenly};

const BLOCK: u64 = 512;
/// Of a parameter and its name.
const PARAMETER: usize = 128;
const NAME: usize = 32;

/// Whether a file begins as one of RPC III.
pub(crate) fn is_rpc(bytes: &[u8]) -> bool {
    bytes.len() >= PARAMETER && field(&bytes[..NAME]) == "FORMAT"
}

/// Reads a file whose first parameter is `FORMAT`.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    let header = Header::read(bytes)?;
    let shape = Shape::of(&header)?;
    let number = shape.number;
    let data = Bytes::of_file(bytes, Order::Little);
    let data = data.part(header.end, data.len() - header.end, "samples")?;
    let group = shape.check(&data)?;
    let size = number.size();
    let mut recording = Recording::new("RPC III");
    for channel in 0..shape.channels {
        let name = header.text(&format!("DESC.CHAN_{}", channel + 1));
        let name = name.map_or_else(|| format!("channel {}", channel + 1), unquoted);
        let own = |group: &[u8]| match shape.multiplexed {
            true => number.strided(&group[channel * size..], shape.channels * size, shape.order),
            false => {
                let length = shape.points_of_group * size;
                number.all(&group[channel * length..(channel + 1) * length], shape.order)
            }
        };
        let scale = header.scale(channel, number).map_err(|fault| fault.of(&name))?;
        let mut samples = Vec::with_capacity(shape.groups() * shape.points_of_group);
        for group in data.data.chunks_exact(group).take(shape.groups()) {
            samples.extend(own(group).into_iter().map(|sample| sample * scale));
        }
        samples.truncate(shape.samples);
        let unit = header.text(&format!("UNITS.CHAN_{}", channel + 1));
        recording.signals.push(Signal {
            name,
            unit: unit.map_or_else(String::new, unquoted),
            time: evenly(0.0, shape.step, Place::Item("DELTA_T".into()))?,
            samples,
            labels: Vec::new(),
            source: Source {
                group: String::new(),
                place: Place::Item(format!("channel {}", channel + 1)),
            },
        });
    }
    Ok(recording)
}

fn unquoted(text: &str) -> String {
    text.trim_matches('"').trim().into()
}

/// The parameters.
struct Header {
    parameters: HashMap<String, String>,
    end: u64,
}

impl Header {
    /// The number of blocks of the header is the second parameter.
    fn read(bytes: &[u8]) -> Read<Header> {
        let file = Bytes::of_file(bytes, Order::Little);
        let first = file.take(0, BLOCK, "the first block of the header")?;
        let mut header = Header {
            parameters: parameters(first),
            end: 0,
        };
        header.end = header.whole::<u64>("NUM_HEADER_BLOCKS")?.saturating_mul(BLOCK);
        header.parameters = parameters(file.take(0, header.end, "the header")?);
        Ok(header)
    }

    fn text(&self, name: &str) -> Option<&str> {
        self.parameters
            .get(name)
            .map(String::as_str)
            .filter(|text| !text.is_empty())
    }

    fn number<T: std::str::FromStr>(&self, name: &str, expected: &str) -> Read<T> {
        let text = self.text(name).unwrap_or("");
        text.parse().map_err(|_| {
            let found = if text.is_empty() {
                "nothing".into()
            } else {
                format!("`{text}`")
            };
            Fault::damaged(Place::Item(name.into()), found, expected)
        })
    }

    fn whole<T: std::str::FromStr>(&self, name: &str) -> Read<T> {
        self.number(name, "a whole number")
    }

    /// Units in a step of a channel. Stored floating-point numbers are physical values.
    fn scale(&self, channel: usize, number: Number) -> Read<f64> {
        let name = format!("SCALE.CHAN_{}", channel + 1);
        if number == Number::I16 {
            return self.number(&name, "a number");
        }
        match self.text(&name).map_or(Ok(1.0), |_| self.number(&name, "a number"))? {
            1.0 => Ok(1.0),
            scale => {
                let remedy = "export the file with short integers, or with a scale of 1";
                let found = format!("a scale of {scale} beside floating-point numbers");
                Err(Fault::new(Place::Item(name), found, "a scale of 1", remedy))
            }
        }
    }
}

fn parameters(header: &[u8]) -> HashMap<String, String> {
    let entries = header
        .chunks_exact(PARAMETER)
        .map(|entry| (field(&entry[..NAME]), field(&entry[NAME..])));
    entries.filter(|(name, _)| !name.is_empty()).collect()
}

/// How the samples lie.
struct Shape {
    channels: usize,
    frames: usize,
    points_of_frame: usize,
    points_of_group: usize,
    /// Of a channel.
    samples: usize,
    step: f64,
    number: Number,
    order: Order,
    multiplexed: bool,
}

impl Shape {
    fn of(header: &Header) -> Read<Shape> {
        let number = match header.text("DATA_TYPE") {
            None | Some("SHORT_INTEGER") => Number::I16,
            Some("FLOATING_POINT") => Number::F32,
            Some(other) => {
                let expected = "SHORT_INTEGER or FLOATING_POINT";
                return Err(Fault::damaged(
                    Place::Item("DATA_TYPE".into()),
                    format!("`{other}`"),
                    expected,
                ));
            }
        };
        let order = match header.text("FORMAT") {
            Some("BINARY" | "BINARY_IEEE_LITTLE_END") => Order::Little,
            Some("BINARY_IEEE_BIG_END") => Order::Big,
            other => {
                let found = format!("`{}`", other.unwrap_or(""));
                let remedy = "export the file as BINARY_IEEE_LITTLE_END";
                return Err(Fault::new(
                    Place::Item("FORMAT".into()),
                    found,
                    "a binary IEEE format",
                    remedy,
                ));
            }
        };
        let (frames, points_of_frame): (usize, usize) = (header.whole("FRAMES")?, header.whole("PTS_PER_FRAME")?);
        let all = frames.saturating_mul(points_of_frame);
        let samples = match header.text("SAMPLES") {
            Some(_) => header.whole::<usize>("SAMPLES")?.min(all),
            None => all,
        };
        Ok(Shape {
            channels: header.whole("CHANNELS")?,
            frames,
            points_of_frame,
            points_of_group: header.whole("PTS_PER_GROUP")?,
            samples,
            step: header.number("DELTA_T", "a time in seconds")?,
            number,
            order,
            multiplexed: header.text("TIME_TYPE").is_some_and(|kind| kind.starts_with("MULT")),
        })
    }

    fn groups(&self) -> usize {
        let points = self.frames.saturating_mul(self.points_of_frame);
        points
            .checked_div(self.points_of_group)
            .map_or(0, |_| points.div_ceil(self.points_of_group))
    }

    /// Bytes of a group, once all groups are known to be there.
    fn check(&self, data: &Bytes) -> Read<usize> {
        let Shape {
            channels,
            frames,
            points_of_frame,
            points_of_group,
            ..
        } = self;
        let sizes = [*channels, *points_of_group, self.number.size()];
        let group = sizes
            .iter()
            .try_fold(1_usize, |all, &size| all.checked_mul(size))
            .unwrap_or(usize::MAX);
        let groups = self.groups();
        let promised = group.saturating_mul(groups);
        if promised == 0 {
            let found = format!("{frames} frames of {points_of_frame} samples, {channels} channels");
            return Err(Fault::damaged(Place::File, found, "at least one sample of one channel"));
        }
        if promised as u64 <= data.len() {
            return Ok(group);
        }
        let whole = data.data.len() / group;
        let found = format!(
            "{} bytes of samples, in which {whole} groups are whole: the first {} samples of each channel",
            data.len(),
            whole * points_of_group
        );
        let expected =
            format!("{groups} groups ({frames} frames of {points_of_frame}, {channels} channels, {promised} bytes)");
        Err(Fault::cut_off(data.place(data.len()), found, expected))
    }
}
