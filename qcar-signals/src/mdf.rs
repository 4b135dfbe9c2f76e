//! MDF, the format of ASAM for measured data: version 4 and version 3.
//!
//! Source: public descriptions of ASAM MDF 4.1 and 3.3. The layout of each block is described at the function that
//! reads it.

mod conversion;
// The position of a value in a record.
mod field;
// The blocks of version 4.
mod block;
// Compressed blocks.
mod packed;
// Records, read in pieces.
mod data;
// Groups and channels of version 4.
mod v4;
// Version 3.
mod v3;
// Writing of version 4.
pub mod write;

use std::collections::HashSet;

use crate::bytes::Bytes;
use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::samples::Samples;
use crate::signal::{Recording, Signal, Source, Steps, TimeBase, evenly};
use crate::summary::Summary;

use conversion::Conversion;
use data::Data;
use field::Field;

/// The first bytes of an MDF file.
pub(crate) const MAGIC: &[u8] = b"MDF     ";
/// The first bytes of a file that its writer did not close.
pub(crate) const UNFINISHED: &[u8] = b"UnFinMF ";

/// Reads a file that begins with one of the two.
pub(crate) fn read(file: Bytes, wanted: &Wanted) -> Read<Recording> {
    if file.starts_with(UNFINISHED) {
        let remedy = "finish it in the program that recorded it, or export it again";
        return Err(Fault::new(
            Place::Byte(0),
            "a file that its writer did not finish",
            "a finished MDF file",
            remedy,
        ));
    }
    let version = crate::bytes::field(&file.take(8, 8, "the version")?);
    match version.split('.').next() {
        Some("4") => v4::read(file, &version, wanted),
        Some("3") => v3::read(file, &version, wanted),
        _ => {
            let remedy = "export it as MDF 4";
            Err(Fault::new(
                Place::Byte(8),
                format!("MDF version `{version}`"),
                "version 3 or 4",
                remedy,
            ))
        }
    }
}

/// What was read of a file so far.
#[derive(Default)]
struct Visited {
    /// The blocks of a chain; a chain that returns to one of them would never end.
    blocks: HashSet<u64>,
    /// The names of groups, each of which is there once.
    groups: HashSet<String>,
}

impl Visited {
    fn first_time(&mut self, at: u64) -> Read<()> {
        if self.blocks.insert(at) {
            return Ok(());
        }
        let found = "a link to a block that was read before";
        Err(Fault::damaged(Place::Byte(at), found, "links without a loop"))
    }

    /// The name of the next group, by which channels of one name are told apart: the first line of the name that the
    /// file gives it, with its number if there is none or another group has it.
    fn group(&mut self, given: &str) -> String {
        let given = given.lines().next().unwrap_or("").trim();
        let number = self.groups.len() + 1;
        let name = match given {
            "" => format!("group {number}"),
            _ if self.groups.contains(given) => format!("{given} (group {number})"),
            _ => given.into(),
        };
        self.groups.insert(name.clone());
        name
    }
}

/// Role of a channel in its group.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// Values.
    Values,
    /// The times of the group.
    Time,
}

/// A channel, with everything that is needed to extract its values from records.
struct Channel {
    name: String,
    unit: String,
    role: Role,
    /// Position of its values, or why they are left out.
    field: Result<Field, String>,
    conversion: Result<Conversion, String>,
    place: Place,
}

/// Result of reading the stored values of a channel.
enum Column<'c> {
    /// The stored values.
    Kept(Vec<f64>),
    /// A summary of the physical values, with a buffer for those of a piece.
    Summarised(&'c Conversion, Summary, Vec<f64>),
    /// Times that are not kept, with the same buffer.
    Passing(&'c Conversion, Steps, Vec<f64>),
}

impl Column<'_> {
    fn add(&mut self, field: &Field, piece: &Piece) {
        match self {
            Column::Kept(values) => field.values(piece, values),
            Column::Summarised(conversion, summary, values) => {
                values.clear();
                field.values(piece, values);
                conversion.apply(values);
                summary.add(values.iter().copied());
            }
            Column::Passing(conversion, steps, values) => {
                values.clear();
                field.values(piece, values);
                conversion.apply(values);
                steps.add(values);
            }
        }
    }
}

/// Records of a group, one after another.
struct Records<'a> {
    data: &'a Data<'a>,
    /// Distance from record to record, bytes.
    stride: usize,
    /// Bytes of the id before each record.
    before: usize,
    count: usize,
}

/// Some records, in memory.
struct Piece<'a> {
    bytes: &'a [u8],
    stride: usize,
    before: usize,
    /// The number of the first record, from 0.
    first: usize,
    count: usize,
}

impl<'a> Records<'a> {
    /// The declared records of a group; fails if the file does not contain them.
    fn checked(
        data: &'a Data<'a>,
        before: usize,
        stride: usize,
        declared: u64,
        group: &str,
        place: &Place,
    ) -> Read<Self> {
        let there = data.len().checked_div(stride as u64).unwrap_or(0);
        if declared > there {
            let found = format!("{there} whole records of {stride} bytes");
            let expected = format!("{declared} records, as the group `{group}` declares");
            return Err(Fault::cut_off(place.clone(), found, expected));
        }
        Ok(Records {
            data,
            stride,
            before,
            count: declared as usize,
        })
    }

    /// A column that stores its values.
    fn kept<'c>(&self) -> Column<'c> {
        Column::Kept(Vec::with_capacity(if self.data.is_there() { self.count } else { 0 }))
    }

    /// A column that summarises its values.
    fn summarised<'c>(&self, conversion: &'c Conversion) -> Column<'c> {
        Column::Summarised(conversion, Summary::new(self.count), Vec::new())
    }

    /// Fills columns with the values of their fields. The records are read once in pieces, and each piece is processed
    /// channel by channel while it is in the cache.
    fn fill(&self, columns: &mut [(&Field, Column)]) -> Read<()> {
        if columns.is_empty() || self.count == 0 {
            return Ok(());
        }
        let mut first = 0;
        self.data
            .pieces((self.count * self.stride) as u64, self.stride, |bytes| {
                let piece = Piece {
                    bytes,
                    stride: self.stride,
                    before: self.before,
                    first,
                    count: bytes.len() / self.stride,
                };
                for (field, column) in &mut *columns {
                    column.add(field, &piece);
                }
                first += piece.count;
            })
    }
}

/// Largest number of bits of all channels, relative to those of a record. Parts of a value may be further channels, but
/// a small file must not need a large memory.
const MOST_USES: usize = 16;

/// Adds the channels of a group to a recording.
fn add_group(
    recording: &mut Recording,
    group: &str,
    channels: Vec<Channel>,
    records: &Records,
    wanted: &Wanted,
) -> Read<()> {
    check_overlap(group, &channels, records)?;
    let Columns { samples, times } = read_columns(group, &channels, records, wanted)?;
    match time_base(&channels, times) {
        Ok(time) => add_signals(recording, group, channels.into_iter().zip(samples), &time),
        Err((place, why)) => {
            for channel in channels.iter().filter(|channel| channel.role == Role::Values) {
                recording.pass_over(
                    &channel.name,
                    place.clone(),
                    format!("its times must never decrease, but it has {why}"),
                );
            }
        }
    }
    Ok(())
}

/// # Errors
/// Channels with more bits in total than [`MOST_USES`] times those of a record.
fn check_overlap(group: &str, channels: &[Channel], records: &Records) -> Read<()> {
    let used: usize = channels
        .iter()
        .filter_map(|channel| Some(channel.field.as_ref().ok()?.bits()))
        .sum();
    let Some(first) = channels
        .first()
        .filter(|_| used > MOST_USES * 8 * records.stride && records.count > 0)
    else {
        return Ok(());
    };
    let found = format!(
        "channels of the group `{group}` with {used} bits in records of {} bytes",
        records.stride
    );
    Err(Fault::damaged(
        first.place.clone(),
        found,
        "channels that do not overlap",
    ))
}

/// What was read of a channel of times.
enum Times {
    /// The stored values.
    Stored(Vec<f64>),
    /// The range of their steps.
    Passed(Steps),
}

/// The values of a group's channels.
struct Columns {
    /// Samples of each channel.
    samples: Vec<Samples>,
    /// Of each channel of times; `None` if no channel of the group is wanted.
    times: Option<Vec<Times>>,
}

/// Reads the wanted channels of a group.
fn read_columns(group: &str, channels: &[Channel], records: &Records, wanted: &Wanted) -> Read<Columns> {
    let summarise = matches!(wanted, Wanted::Summaries);
    let is_wanted = |channel: &Channel| channel.role == Role::Values && (summarise || wanted.has(group, &channel.name));
    let is_any = channels.iter().any(is_wanted);
    let is_read =
        |channel: &Channel| is_wanted(channel) || (is_any && channel.role == Role::Time && !channel.is_even());
    // Pairs of the index of a channel and its values.
    let (mut places, mut columns) = (Vec::new(), Vec::new());
    for (place, channel) in channels.iter().enumerate().filter(|(_, channel)| is_read(channel)) {
        if let (Ok(field), Ok(conversion)) = (&channel.field, &channel.conversion) {
            let column = match (summarise, channel.role) {
                (true, Role::Values) => records.summarised(conversion),
                (true, Role::Time) => Column::Passing(conversion, Steps::default(), Vec::new()),
                (false, _) => records.kept(),
            };
            places.push(place);
            columns.push((field, column));
        }
    }
    records.fill(&mut columns)?;
    let mut samples: Vec<Samples> = channels.iter().map(|_| Samples::default()).collect();
    let mut times: Vec<Times> = channels.iter().map(|_| Times::Stored(Vec::new())).collect();
    for (place, (_, column)) in places.into_iter().zip(columns) {
        let channel = &channels[place];
        match (column, &channel.conversion) {
            (Column::Summarised(_, summary, _), _) => samples[place] = Samples::summarised(summary),
            (Column::Kept(values), Ok(conversion)) if channel.role == Role::Values => {
                let mut values = values;
                conversion.apply(&mut values);
                samples[place] = values.into();
            }
            (Column::Kept(values), _) => times[place] = Times::Stored(values),
            (Column::Passing(_, steps, _), _) => times[place] = Times::Passed(steps),
        }
    }
    Ok(Columns {
        samples,
        times: is_any.then_some(times),
    })
}

/// The time base of a group from its channel of times; unknown if no channel is wanted. Fails with the place of the
/// channel of times and the reason.
fn time_base(channels: &[Channel], read: Option<Vec<Times>>) -> Result<TimeBase, (Place, String)> {
    let mut time = TimeBase::Unknown;
    for (master, read) in channels.iter().zip(read.unwrap_or_default()) {
        if master.role == Role::Time {
            time = times(master, read).map_err(|why| (master.place.clone(), why))?;
        }
    }
    Ok(time)
}

/// Adds the channels of values with their samples to a recording, and the reasons why others cannot be read.
fn add_signals(
    recording: &mut Recording,
    group: &str,
    channels: impl Iterator<Item = (Channel, Samples)>,
    time: &TimeBase,
) {
    for (channel, samples) in channels {
        match (channel.role, &channel.field, &channel.conversion) {
            (Role::Time, ..) => {}
            (Role::Values, Ok(_), Ok(conversion)) => {
                recording.signals.push(Signal {
                    time: time.clone(),
                    samples,
                    labels: conversion.labels(),
                    source: Source {
                        group: group.into(),
                        place: channel.place,
                    },
                    name: channel.name,
                    unit: channel.unit,
                });
            }
            (Role::Values, Err(why), _) | (Role::Values, _, Err(why)) => {
                recording.pass_over(&channel.name, channel.place.clone(), why);
            }
        }
    }
}

impl Channel {
    /// True if its values follow from the number of the record instead of its content.
    fn is_even(&self) -> bool {
        matches!(
            (&self.field, &self.conversion),
            (Ok(Field::Index), Ok(Conversion::Linear { .. }))
        )
    }
}

/// The times of a group in seconds, or why it has none.
fn times(master: &Channel, read: Times) -> Result<TimeBase, String> {
    let (field, conversion) = match (&master.field, &master.conversion) {
        (Ok(field), Ok(conversion)) => (field, conversion),
        (Err(why), _) | (_, Err(why)) => return Err(why.clone()),
    };
    if let (Field::Index, Conversion::Linear { offset, factor }) = (field, conversion) {
        return evenly(*offset, *factor, master.place.clone()).map_err(|fault| fault.found);
    }
    let base = match read {
        Times::Stored(mut stored) => {
            conversion.apply(&mut stored);
            TimeBase::from_times(stored)
        }
        Times::Passed(steps) => steps.time_base(),
    };
    base.map_err(|(at, found)| format!("{found} in sample {}", at + 1))
}

#[cfg(test)]
mod tests {
    use super::Visited;

    #[test]
    fn each_group_has_a_name_of_its_own() {
        let mut visited = Visited::default();
        let given = ["CAN", "", "CAN", " rig\nby hand", "CAN"];
        let names = given.map(|given| visited.group(given));
        assert_eq!(names, ["CAN", "group 2", "CAN (group 3)", "rig", "CAN (group 5)"]);
    }
}
