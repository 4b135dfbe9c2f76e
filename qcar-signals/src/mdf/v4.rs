//! Groups and channels of MDF 4.

use std::collections::HashMap;

use crate::bytes::{Bytes, Order};
use crate::content::Content;
use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::limit::Budget;
use crate::signal::Recording;

use super::block::{Block, File};
use super::conversion::Conversion;
use super::data::Data;
use super::field::{Field, Invalid, Kind};
use super::{Channel, Records, Role, Visited, add_group};

/// Position of the header block.
const HEADER: u64 = 64;

/// Reads a file of version 4.
pub(super) fn read(bytes: Bytes, version: &str, wanted: &Wanted) -> Read<Recording> {
    let file = File {
        bytes,
        budget: Budget::of_file(bytes.len()),
    };
    let mut recording = Recording::new(format!("MDF {version}"));
    let mut visited = Visited::default();
    let mut at = file.named(HEADER, b"##HD", "the header")?.link(0);
    let mut what = "the first data group";
    while at != 0 {
        let group = file.named(at, b"##DG", what)?;
        visited.first_time(at)?;
        add_data_group(&mut recording, &file, &group, &mut visited, wanted)?;
        (at, what) = (group.link(0), "the next data group");
    }
    Ok(recording)
}

/// A channel group: the id of its records, and its channels.
struct Group {
    id: u64,
    name: String,
    place: Place,
    cycles: u64,
    /// Bytes of a record without its id.
    length: usize,
    variable_length: bool,
    channels: Vec<Channel>,
}

fn add_data_group(
    recording: &mut Recording,
    file: &File,
    data_group: &Block,
    visited: &mut Visited,
    wanted: &Wanted,
) -> Read<()> {
    let id_size = usize::from(data_group.data.u8(0, "the size of record ids")?);
    let mut groups = Vec::new();
    let mut at = data_group.link(1);
    while at != 0 {
        let block = file.named(at, b"##CG", "a channel group")?;
        visited.first_time(at)?;
        groups.push(group(file, &block, visited)?);
        at = block.link(0);
    }
    let data = Data::listed(file, data_group.link(2))?;
    match groups.as_slice() {
        [only] if !only.variable_length => groups.remove(0).add_to(recording, &data, id_size, wanted),
        _ => {
            // Unsorted records are sorted in memory, so they are not summarised in one pass.
            let wanted = match wanted {
                Wanted::Summaries => &Wanted::These(&[]),
                of_some => of_some,
            };
            for group in groups.iter_mut().filter(|group| !group.is_wanted(wanted)) {
                group.cycles = 0;
            }
            let mut sorted = sorted(&groups, &data, id_size, &data_group.place())?;
            for group in groups.into_iter().filter(|group| !group.variable_length) {
                let own = Content::of_bytes(sorted.remove(&group.id).unwrap_or_default());
                let own = Data::plain(Bytes::of_file(&own, Order::Little));
                group.add_to(recording, &own, 0, wanted)?;
            }
            Ok(())
        }
    }
}

impl Group {
    fn is_wanted(&self, wanted: &Wanted) -> bool {
        self.channels
            .iter()
            .any(|channel| wanted.has(&self.name, &channel.name))
    }

    /// Adds the channels. Their records are in `data`, each after an id of `before` bytes.
    fn add_to(self, recording: &mut Recording, data: &Data, before: usize, wanted: &Wanted) -> Read<()> {
        let stride = before + self.length;
        let records = Records::checked(data, before, stride, self.cycles, &self.name, &self.place)?;
        add_group(recording, &self.name, self.channels, &records, wanted)
    }
}

/// The records of several groups from unsorted data: an id, then the record.
fn sorted(groups: &[Group], data: &Data, id_size: usize, place: &Place) -> Read<HashMap<u64, Vec<u8>>> {
    let read = groups.iter().filter(|group| !group.variable_length && group.cycles > 0);
    let mut sorting = Sorting {
        own: read.map(|group| (group.id, Vec::new())).collect(),
        groups: groups.iter().map(|group| (group.id, group)).collect(),
        id_size,
        place,
        at: 0,
        pending: Vec::new(),
        needed: 0,
        outcome: Ok(()),
    };
    data.pieces(data.len(), 1, |piece| sorting.add(piece))?;
    sorting.outcome?;
    match sorting.pending.is_empty() {
        true => Ok(sorting.own),
        false => Err(half_a_record(place, sorting.at)),
    }
}

fn half_a_record(place: &Place, at: u64) -> Box<Fault> {
    let found = format!("half a record at byte {at} of the data");
    Fault::cut_off(place.clone(), found, "whole records")
}

/// Sorts records into their groups.
struct Sorting<'a> {
    own: HashMap<u64, Vec<u8>>,
    groups: HashMap<u64, &'a Group>,
    id_size: usize,
    place: &'a Place,
    /// The byte of the data at which `pending` begins.
    at: u64,
    /// Bytes of records that are not sorted yet.
    pending: Vec<u8>,
    /// Smallest size of the first of these records, bytes.
    needed: usize,
    outcome: Read<()>,
}

impl Sorting<'_> {
    fn add(&mut self, piece: &[u8]) {
        if self.outcome.is_err() {
            return;
        }
        self.pending.extend_from_slice(piece);
        let mut sorted = 0;
        while sorted < self.pending.len() && self.needed <= self.pending.len() - sorted {
            match self.sort(sorted) {
                Ok(Ok(length)) => (sorted, self.needed) = (sorted + length, 0),
                Ok(Err(needed)) => self.needed = needed,
                Err(fault) => {
                    self.outcome = Err(fault);
                    return;
                }
            }
        }
        self.pending.drain(..sorted);
        self.at += sorted as u64;
    }

    /// Sorts the record that begins at a byte of `pending`. Returns its size, or its smallest size if it is not
    /// complete.
    fn sort(&mut self, from: usize) -> Read<Result<usize, usize>> {
        let (at, bytes) = (self.at + from as u64, &self.pending[from..]);
        let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |all, &byte| all << 8 | u64::from(byte));
        if !(1..=8).contains(&self.id_size) {
            return Err(half_a_record(self.place, at));
        }
        let Some((id, after)) = bytes.split_at_checked(self.id_size) else {
            return Ok(Err(self.id_size));
        };
        let id = number(id);
        let Some(group) = self.groups.get(&id) else {
            let found = format!("a record with id {id} at byte {at} of the data");
            let expected = "an id of one of the channel groups";
            return Err(Fault::damaged(self.place.clone(), found, expected));
        };
        let length = match (group.variable_length, after.get(..4)) {
            (false, _) => group.length,
            (true, Some(length)) => 4 + number(length) as usize,
            (true, None) => 4,
        };
        let whole = self.id_size + length;
        match after.get(..length) {
            Some(record) => {
                if let Some(records) = self.own.get_mut(&id) {
                    records.extend_from_slice(record);
                }
                Ok(Ok(whole))
            }
            None => Ok(Err(whole)),
        }
    }
}

/// Channel group: links next, first channel, name, source, reduction, comment; data: record id 8, cycles 8, flags 2,
/// separator 2, reserved 4, data bytes 4, invalidation bytes 4.
fn group(file: &File, block: &Block, visited: &mut Visited) -> Read<Group> {
    let data = block.data;
    let (data_bytes, invalid_bytes) = (
        data.u32(24, "the size of a record")?,
        data.u32(28, "invalidation bytes")?,
    );
    let mut group = Group {
        id: data.u64(0, "a record id")?,
        name: visited.group(&group_name(file, block)?),
        place: block.place(),
        cycles: data.u64(8, "a number of records")?,
        length: data_bytes as usize + invalid_bytes as usize,
        variable_length: data.u16(16, "flags of a channel group")? & 1 != 0,
        channels: Vec::new(),
    };
    let record = Record {
        data_bytes: data_bytes as usize,
        length: group.length,
    };
    add_channels(file, block.link(1), &record, visited, &mut group.channels)?;
    Ok(group)
}

/// The name of its acquisition, or else its comment, which may be of any length and is left out if it is too long.
fn group_name(file: &File, block: &Block) -> Read<String> {
    let name = file.text(block.link(2))?;
    Ok(match name.is_empty() {
        true => file.text(block.link(5)).unwrap_or_default(),
        false => name,
    })
}

struct Record {
    data_bytes: usize,
    length: usize,
}

/// Adds the channels of a list, and those of which a channel is composed.
fn add_channels(file: &File, first: u64, record: &Record, visited: &mut Visited, all: &mut Vec<Channel>) -> Read<()> {
    let mut lists = vec![first];
    while let Some(mut at) = lists.pop() {
        while at != 0 {
            let block = file.named(at, b"##CN", "a channel")?;
            visited.first_time(at)?;
            let composed = match block.link(1) {
                0 => None,
                parts => Some(file.block(parts, "what a channel is composed of")?),
            };
            match composed {
                Some(part) if part.id == *b"##CN" => lists.push(part.at),
                composed => all.push(channel(file, &block, record, composed.is_some())?),
            }
            at = block.link(0);
        }
    }
    Ok(())
}

/// Channel: links next, composition, name, source, conversion, data, unit, comment; data: type 1, kind of time 1, data
/// type 1, bit 1, byte 4, bits 4, flags 4, invalidation bit 4.
fn channel(file: &File, block: &Block, record: &Record, is_array: bool) -> Read<Channel> {
    let data = block.data;
    let name = file.text(block.link(2))?;
    let (kind, sync) = (data.u8(0, "a channel's type")?, data.u8(1, "a channel's kind of time")?);
    let conversion_block = match block.link(4) {
        0 => None,
        at => Some(
            file.named(at, b"##CC", "a conversion")
                .map_err(|fault| fault.of(&name))?,
        ),
    };
    let mut unit = file.text(block.link(6))?;
    if let Some(conversion) = conversion_block.as_ref().filter(|_| unit.is_empty()) {
        unit = file.text(conversion.link(1))?;
    }
    let conversion = conversion_block.map_or(Ok(Ok(Conversion::NONE)), |block| conversion(file, &block));
    let field = match kind {
        _ if is_array => Err("an array in each sample".into()),
        0 | 2 | 4 => field(data, record)?,
        1 => Err("values of variable length".into()),
        3 | 6 => Ok(Field::Index),
        _ => Err(format!("a channel of type {kind}")),
    };
    Ok(Channel {
        role: match (kind, sync) {
            (2 | 3, 1) => Role::Time,
            _ => Role::Values,
        },
        conversion: conversion.map_err(|fault| fault.of(&name))?,
        name,
        unit,
        field,
        place: block.place(),
    })
}

/// Position of the values of a channel, or why they are left out.
fn field(data: Bytes, record: &Record) -> Read<Result<Field, String>> {
    let what = "a channel";
    let (kind, order) = match data.u8(2, what)? {
        0 => (Kind::Unsigned, Order::Little),
        1 => (Kind::Unsigned, Order::Big),
        2 => (Kind::Signed, Order::Little),
        3 => (Kind::Signed, Order::Big),
        4 => (Kind::Float, Order::Little),
        5 => (Kind::Float, Order::Big),
        6..=9 => return Ok(Err("text".into())),
        10 => return Ok(Err(format!("{} bytes a sample, not a number", data.u32(8, what)? / 8))),
        15 | 16 => return Ok(Err("complex numbers".into())),
        other => return Ok(Err(format!("data of type {other}, not numbers"))),
    };
    let flags = data.u32(12, what)?;
    let invalid_bit = data.u32(16, what)?;
    let invalid = match flags {
        _ if flags & 1 != 0 => Invalid::All,
        _ if flags & 2 != 0 => Invalid::Where {
            byte: record.data_bytes + invalid_bit as usize / 8,
            mask: 1 << (invalid_bit % 8),
        },
        _ => Invalid::None,
    };
    let field = Field::Bits {
        byte: data.u32(4, what)? as usize,
        bit: u32::from(data.u8(3, what)?.min(63)),
        count: data.u32(8, what)?.min(65),
        kind,
        order,
        invalid,
    };
    Ok(field.checked(record.length))
}

/// Conversion: links name, unit, comment, inverse, references; data: type 1, precision 1, flags 2, number of references
/// 2, number of values 2, range 16, values. The inner error is the reason why the channel is left out.
fn conversion(file: &File, block: &Block) -> Read<Result<Conversion, String>> {
    let kind = block.data.u8(0, "a conversion")?;
    let count = block.data.u16(6, "a conversion")?;
    let values = block.doubles(24, count.into())?;
    let pairs = || values.chunks_exact(2).map(|two| (two[0], two[1])).collect::<Vec<_>>();
    let rising = || values.chunks_exact(2).is_sorted_by(|low, high| low[0] < high[0]);
    Ok(match (kind, values.as_slice()) {
        (0, _) => Ok(Conversion::NONE),
        (1, &[offset, factor, ..]) => Ok(Conversion::Linear { offset, factor }),
        (2, &[a, b, c, d, e, f, ..]) => Ok(Conversion::Rational([a, b, c, d, e, f])),
        (3, _) => Err("a conversion by a formula".into()),
        (4 | 5, [_, _, ..]) if rising() => Ok(Conversion::Table {
            pairs: pairs(),
            interpolated: kind == 4,
        }),
        (4 | 5, _) => Err("a conversion table that does not rise".into()),
        (6, _) => Ok(Conversion::Ranges {
            ranges: values
                .chunks_exact(3)
                .map(|three| (three[0], three[1], three[2]))
                .collect(),
            otherwise: *values.chunks_exact(3).remainder().first().unwrap_or(&f64::NAN),
        }),
        (7, _) => labels(file, block, &values).map(Conversion::Labels).map(Ok)?,
        (8..=10, _) => Err("a conversion by texts of ranges or of texts".into()),
        (_, values) => Err(format!("a conversion of type {kind} with {} values", values.len())),
    })
}

/// The texts of values; a value with a further conversion instead of a text is left out.
fn labels(file: &File, block: &Block, values: &[f64]) -> Read<Vec<(f64, String)>> {
    let mut labels = Vec::new();
    for (&value, &at) in values.iter().zip(block.links.iter().skip(4)) {
        if at != 0 && file.block(at, "the text of a value")?.id == *b"##TX" {
            labels.push((value, file.text(at)?));
        }
    }
    Ok(labels)
}
