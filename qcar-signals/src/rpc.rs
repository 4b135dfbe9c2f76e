//! RPC III, the format of MTS for drive and response files: parameters of 32 and 96 characters in blocks of 512 bytes,
//! then groups of frames.
//!
//! A group contains all samples of the first channel, then all of the second and so on (demultiplexed). If `TIME_TYPE`
//! begins with `MULT`, it contains the first samples of all channels, then the second ones (multiplexed). The last
//! group is stored in full, even if only some of its frames are valid.

use std::collections::HashMap;

use crate::bytes::{Bytes, Order, field, heads};
use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::samples::Samples;
use crate::signal::{Recording, Signal, Source, evenly};
use crate::summary::Summary;

const BLOCK: u64 = 512;
/// Bytes of a parameter and of its name.
const PARAMETER: usize = 128;
const NAME: usize = 32;

/// True if a file begins like RPC III.
pub(crate) fn is_rpc(bytes: &[u8]) -> bool {
    bytes.len() >= PARAMETER && field(&bytes[..NAME]) == "FORMAT"
}

/// Reads a file whose first parameter is `FORMAT`.
pub(crate) fn read(file: Bytes, wanted: &Wanted) -> Read<Recording> {
    let header = Header::read(&file)?;
    let shape = Shape::of(&header)?;
    let data = file.part(header.end, file.len() - header.end, "samples")?;
    shape.check(&data)?;
    let mut recording = Recording::new("RPC III");
    let mut columns = Vec::new();
    for channel in 0..shape.channels {
        let name = header.text(&format!("DESC.CHAN_{}", channel + 1));
        let name = name.map_or_else(|| format!("channel {}", channel + 1), unquoted);
        let scale = header.scale(channel, shape.kind).map_err(|fault| fault.of(&name))?;
        let unit = header.text(&format!("UNITS.CHAN_{}", channel + 1));
        if matches!(wanted, Wanted::Summaries) {
            columns.push(Column::summarised(channel, &shape, scale));
        } else if wanted.has("", &name) {
            columns.push(Column::new(channel, &shape, scale));
        }
        recording.signals.push(Signal {
            name,
            unit: unit.map_or_else(String::new, unquoted),
            time: evenly(0.0, shape.step, Place::Item("DELTA_T".into()))?,
            samples: Samples::default(),
            labels: Vec::new(),
            source: Source {
                group: String::new(),
                place: Place::Item(format!("channel {}", channel + 1)),
            },
        });
    }
    shape.fill(&data, &mut columns)?;
    for column in columns {
        let channel = column.channel;
        recording.signals[channel].samples = column.samples(shape.samples);
    }
    Ok(recording)
}

/// The samples of a channel that are read so far.
struct Column {
    channel: usize,
    read: Samplewise,
}

enum Samplewise {
    /// Stored samples, with the factor to physical values.
    Shorts(Vec<i16>, f64),
    Singles(Vec<f32>),
    /// A summary, with kind and factor of the samples and their remaining number.
    Summarised {
        summary: Summary,
        kind: Kind,
        scale: f64,
        left: usize,
    },
}

impl Column {
    fn new(channel: usize, shape: &Shape, scale: f64) -> Self {
        let count = shape.groups() * shape.points_of_group;
        let read = match shape.kind {
            Kind::Short => Samplewise::Shorts(Vec::with_capacity(count), scale),
            Kind::Single => Samplewise::Singles(Vec::with_capacity(count)),
        };
        Column { channel, read }
    }

    fn summarised(channel: usize, shape: &Shape, scale: f64) -> Self {
        let read = Samplewise::Summarised {
            summary: Summary::new(shape.samples),
            kind: shape.kind,
            scale,
            left: shape.samples,
        };
        Column { channel, read }
    }

    /// Adds the samples that begin every `stride` bytes of `data`.
    fn add(&mut self, data: &[u8], stride: usize, order: Order) {
        match &mut self.read {
            Samplewise::Shorts(own, _) => add_shorts(own, data, stride, order),
            Samplewise::Singles(own) => add_singles(own, data, stride, order),
            Samplewise::Summarised {
                summary,
                kind: Kind::Short,
                scale,
                left,
            } => {
                let mut own = Vec::new();
                add_shorts(&mut own, data, stride, order);
                own.truncate(*left);
                *left -= own.len();
                summary.add(own.iter().map(|&stored| f64::from(stored) * *scale));
            }
            Samplewise::Summarised { summary, left, .. } => {
                let mut own = Vec::new();
                add_singles(&mut own, data, stride, order);
                own.truncate(*left);
                *left -= own.len();
                summary.add(own.iter().map(|&stored| stored.into()));
            }
        }
    }

    /// The first `count` samples.
    fn samples(self, count: usize) -> Samples {
        match self.read {
            Samplewise::Summarised { summary, .. } => Samples::summarised(summary),
            Samplewise::Shorts(mut own, scale) => {
                own.truncate(count);
                Samples::shorts(own, scale)
            }
            Samplewise::Singles(mut own) => {
                own.truncate(count);
                Samples::singles(own)
            }
        }
    }
}

fn add_shorts(to: &mut Vec<i16>, data: &[u8], stride: usize, order: Order) {
    match order {
        Order::Little => to.extend(heads(data, stride).map(i16::from_le_bytes)),
        Order::Big => to.extend(heads(data, stride).map(i16::from_be_bytes)),
    }
}

fn add_singles(to: &mut Vec<f32>, data: &[u8], stride: usize, order: Order) {
    match order {
        Order::Little => to.extend(heads(data, stride).map(f32::from_le_bytes)),
        Order::Big => to.extend(heads(data, stride).map(f32::from_be_bytes)),
    }
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
    fn read(file: &Bytes) -> Read<Header> {
        let first = file.take(0, BLOCK, "the first block of the header")?;
        let mut header = Header {
            parameters: parameters(&first),
            end: 0,
        };
        header.end = header.whole::<u64>("NUM_HEADER_BLOCKS")?.saturating_mul(BLOCK);
        header.parameters = parameters(&file.take(0, header.end, "the header")?);
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

    /// Physical value of one step of a channel. Stored floating-point numbers are physical values.
    fn scale(&self, channel: usize, kind: Kind) -> Read<f64> {
        let name = format!("SCALE.CHAN_{}", channel + 1);
        if kind == Kind::Short {
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

/// Storage type of a sample.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// A number of steps of the channel's scale.
    Short,
    Single,
}

impl Kind {
    /// Size, bytes.
    fn size(self) -> usize {
        match self {
            Kind::Short => 2,
            Kind::Single => 4,
        }
    }
}

/// Arrangement of the samples.
struct Shape {
    channels: usize,
    frames: usize,
    points_of_frame: usize,
    points_of_group: usize,
    /// Number of samples of a channel.
    samples: usize,
    step: f64,
    kind: Kind,
    order: Order,
    multiplexed: bool,
}

impl Shape {
    fn of(header: &Header) -> Read<Shape> {
        let kind = match header.text("DATA_TYPE") {
            None | Some("SHORT_INTEGER") => Kind::Short,
            Some("FLOATING_POINT") => Kind::Single,
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
            kind,
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

    /// Checks that the file contains all groups.
    fn check(&self, data: &Bytes) -> Read<()> {
        let Shape {
            channels,
            frames,
            points_of_frame,
            points_of_group,
            ..
        } = self;
        let sizes = [*channels, *points_of_group, self.kind.size()];
        let group = sizes
            .iter()
            .try_fold(1_usize, |all, &size| all.checked_mul(size))
            .unwrap_or(usize::MAX);
        let groups = self.groups();
        let declared = group.saturating_mul(groups);
        if declared == 0 {
            let found = format!("{frames} frames of {points_of_frame} samples, {channels} channels");
            return Err(Fault::damaged(Place::File, found, "at least one sample of one channel"));
        }
        if declared as u64 <= data.len() {
            return Ok(());
        }
        let whole = data.len() as usize / group;
        let kept = match whole {
            0 => "less than a group".into(),
            1 => format!("in which 1 group is whole: the first {points_of_group} samples of each channel"),
            _ => format!(
                "in which {whole} groups are whole: the first {} samples of each channel",
                whole * points_of_group
            ),
        };
        let found = format!("{} bytes of samples, {kept}", data.len());
        let expected =
            format!("{groups} groups ({frames} frames of {points_of_frame}, {channels} channels, {declared} bytes)");
        Err(Fault::cut_off(data.place(data.len()), found, expected))
    }

    /// Reads the samples of channels, group by group.
    fn fill(&self, data: &Bytes, columns: &mut [Column]) -> Read<()> {
        let size = self.kind.size();
        let (row, part) = (self.channels * size, self.points_of_group * size);
        let group = (row * self.points_of_group) as u64;
        if self.multiplexed && !columns.is_empty() {
            return data.pieces(0, self.groups() as u64 * group, row as u64, "samples", |rows| {
                for column in &mut *columns {
                    column.add(&rows[column.channel * size..], row, self.order);
                }
            });
        }
        for at in (0..self.groups() as u64).map(|number| number * group) {
            for column in &mut *columns {
                let from = at + (column.channel * part) as u64;
                data.pieces(from, part as u64, size as u64, "samples", |own| {
                    column.add(own, size, self.order);
                })?;
            }
        }
        Ok(())
    }
}
