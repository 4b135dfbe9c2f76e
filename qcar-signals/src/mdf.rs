//! MDF, the format of ASAM for measured data: version 4 and version 3.
//!
//! Source: ASAM MDF 4.1 and 3.3 as described in public; the layout of each block stands where it is read.

mod conversion;
// Where values lie in a record.
mod field;
// The blocks of version 4.
mod block;
// Unpacked.
mod packed;
// Groups and channels.
mod v4;
// Version 3.
mod v3;
// Version 4, written.
pub mod write;

use std::collections::HashSet;

use crate::bytes::Bytes;
use crate::error::{Fault, Place, Read};
use crate::signal::{Recording, Signal, Source, TimeBase, evenly};

use conversion::Conversion;
use field::Field;

/// What an MDF file begins with.
pub(crate) const MAGIC: &[u8] = b"MDF     ";
/// What one begins with that its writer never closed.
pub(crate) const UNFINISHED: &[u8] = b"UnFinMF ";

/// Reads a file that begins with one of the two.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    if bytes.starts_with(UNFINISHED) {
        let remedy = "finish it in the program that recorded it, or export it again";
        return Err(Fault::new(
            Place::Byte(0),
            "a file that its writer did not finish",
            "a finished MDF file",
            remedy,
        ));
    }
    let head = Bytes::of_file(bytes, crate::bytes::Order::Little);
    let version = crate::bytes::field(head.take(8, 8, "the version")?);
    match version.split('.').next() {
        Some("4") => v4::read(head, &version),
        Some("3") => v3::read(head, &version),
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

/// The blocks of a chain that were visited: a chain that comes back to one of them never ends.
#[derive(Default)]
struct Visited(HashSet<u64>);

impl Visited {
    fn first_time(&mut self, at: u64) -> Read<()> {
        if self.0.insert(at) {
            return Ok(());
        }
        let found = "a link to a block that was read before";
        Err(Fault::damaged(Place::Byte(at), found, "links that lead on"))
    }
}

/// What a channel is in its group.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// Values.
    Values,
    /// The times of the group.
    Time,
}

/// A channel, with all that is needed to take its values out of records.
struct Channel {
    name: String,
    unit: String,
    role: Role,
    /// Where its values lie, or why they are passed over.
    field: Result<Field, String>,
    conversion: Result<Conversion, String>,
    place: Place,
}

/// Records of a group, one after the other.
struct Records<'a> {
    bytes: &'a [u8],
    /// From record to record, bytes.
    stride: usize,
    /// Bytes of the id before each record.
    before: usize,
    /// The number of the first, from 0.
    first: usize,
    count: usize,
}

/// Bytes of the records that are read channel by channel: block size, so that records stay in the cache.
const BLOCK: usize = 1 << 18;

impl<'a> Records<'a> {
    /// The records that a group promises, if they are there.
    fn checked(bytes: &'a [u8], before: usize, stride: usize, promised: u64, group: &str, place: &Place) -> Read<Self> {
        let there = bytes.len().checked_div(stride).unwrap_or(0);
        if promised > there as u64 {
            let found = format!("{there} whole records of {stride} bytes");
            let expected = format!("{promised} records, as the group `{group}` promises");
            return Err(Fault::cut_off(place.clone(), found, expected));
        }
        let count = promised as usize;
        Ok(Records {
            bytes: &bytes[..count * stride],
            stride,
            before,
            first: 0,
            count,
        })
    }

    /// The same in parts, one after the other.
    fn parts(&self) -> impl Iterator<Item = Records<'a>> {
        let most = (BLOCK / self.stride.max(1)).max(1);
        let firsts = (0..self.count).step_by(most);
        firsts.map(move |first| {
            let count = most.min(self.count - first);
            Records {
                bytes: &self.bytes[first * self.stride..(first + count) * self.stride],
                first: self.first + first,
                count,
                ..*self
            }
        })
    }

    /// The stored values of several fields.
    fn columns(&self, fields: &[&Field]) -> Vec<Vec<f64>> {
        let mut columns: Vec<Vec<f64>> = fields.iter().map(|_| Vec::with_capacity(self.count)).collect();
        for part in self.parts() {
            for (column, field) in columns.iter_mut().zip(fields) {
                column.extend(field.values(&part));
            }
        }
        columns
    }
}

/// How often the bits of a record may be taken for channels, all in all. Parts of a value may be channels of their own, but
/// a small file shall not become a large one.
const MOST_USES: usize = 16;

/// Adds the channels of a group to a recording.
fn add_group(recording: &mut Recording, group: &str, channels: Vec<Channel>, records: &Records) -> Read<()> {
    let used: usize = channels
        .iter()
        .filter_map(|channel| Some(channel.field.as_ref().ok()?.bits()))
        .sum();
    if let Some(first) = channels
        .first()
        .filter(|_| used > MOST_USES * 8 * records.stride && records.count > 0)
    {
        let found = format!(
            "channels of the group `{group}` with {used} bits in records of {} bytes",
            records.stride
        );
        return Err(Fault::damaged(
            first.place.clone(),
            found,
            "channels that lie beside each other",
        ));
    }
    let mut time = TimeBase::Unknown;
    for master in channels.iter().filter(|channel| channel.role == Role::Time) {
        match times(master, records) {
            Ok(base) => time = base,
            Err(why) => {
                let all = channels.iter().filter(|channel| channel.role == Role::Values);
                for channel in all {
                    recording.pass_over(&channel.name, master.place.clone(), format!("its times: {why}"));
                }
                return Ok(());
            }
        }
    }
    let (mut known, mut fields) = (Vec::new(), Vec::new());
    for channel in channels.iter().filter(|channel| channel.role == Role::Values) {
        match (&channel.field, &channel.conversion) {
            (Ok(field), Ok(conversion)) => {
                known.push((channel, conversion));
                fields.push(field);
            }
            (Err(why), _) | (_, Err(why)) => recording.pass_over(&channel.name, channel.place.clone(), why),
        }
    }
    for ((channel, conversion), samples) in known.into_iter().zip(records.columns(&fields)) {
        let (samples, labels) = conversion.apply(samples);
        recording.signals.push(Signal {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            time: time.clone(),
            samples,
            labels,
            source: Source {
                group: group.into(),
                place: channel.place.clone(),
            },
        });
    }
    Ok(())
}

/// The times of a group in seconds, or why it has none.
fn times(master: &Channel, records: &Records) -> Result<TimeBase, String> {
    let (field, conversion) = match (&master.field, &master.conversion) {
        (Ok(field), Ok(conversion)) => (field, conversion),
        (Err(why), _) | (_, Err(why)) => return Err(why.clone()),
    };
    if let (Field::Index, Conversion::Linear { offset, factor }) = (field, conversion) {
        return evenly(*offset, *factor, master.place.clone()).map_err(|fault| fault.found);
    }
    let raw = field.values(records);
    let (times, _) = conversion.apply(raw);
    TimeBase::from_times(times).map_err(|(at, found)| format!("{found} in sample {}", at + 1))
}
