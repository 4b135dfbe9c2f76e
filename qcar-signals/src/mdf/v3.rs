//! Groups and channels of MDF 3. Blocks: id 2, size 2, then what each function lists, with its offsets.

use crate::bytes::{Bytes, Order, field};
use crate::content::Content;
use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::signal::Recording;

use super::conversion::Conversion;
use super::data::Data;
use super::field::{Field, Invalid, Kind};
use super::{Channel, Records, Role, Visited, add_group};

/// Position of the header block.
const HEADER: u32 = 64;

/// Reads a file of version 3. Its byte 24 is 0 if numbers begin with their least significant byte.
pub(super) fn read(bytes: Bytes, version: &str, wanted: &Wanted) -> Read<Recording> {
    let order = match bytes.u16(24, "the byte order")? {
        0 => Order::Little,
        _ => Order::Big,
    };
    let file = bytes.in_order(order);
    let mut recording = Recording::new(format!("MDF {version}"));
    let mut visited = Visited::default();
    let mut at = block(&file, HEADER, b"HD", "the header")?.u32(4, "the first data group")?;
    while at != 0 {
        visited.first_time(at.into())?;
        let group = block(&file, at, b"DG", "a data group")?;
        add_data_group(&mut recording, &file, &group, &mut visited, wanted)?;
        at = group.u32(4, "the next data group")?;
    }
    Ok(recording)
}

/// The block of a link, which must have this id.
fn block<'a>(file: &Bytes<'a>, at: u32, id: &[u8; 2], what: &str) -> Read<Bytes<'a>> {
    let at = u64::from(at);
    if at >= file.len() {
        let found = format!(
            "a link to {what} at byte {at}, beyond the end of the file ({} bytes)",
            file.len()
        );
        return Err(Fault::cut_off(Place::Byte(at), found, what));
    }
    let head = file.part(at, 4, what)?;
    let found = head.take(0, 2, what)?;
    if *found != *id {
        let (found, expected) = (crate::bytes::text(&found), crate::bytes::text(id));
        let found = format!("a block `{found}`");
        return Err(Fault::damaged(Place::Byte(at), found, format!("{what} (`{expected}`)")));
    }
    file.part(at, head.u16(2, "a size")?.into(), what)
}

struct Group {
    id: u16,
    name: String,
    place: Place,
    records: u32,
    length: usize,
    channels: Vec<Channel>,
}

/// Data group: next 4, first channel group 8, trigger 12, data 16, number of groups 20, number of ids around a record
/// 22.
fn add_data_group(
    recording: &mut Recording,
    file: &Bytes,
    data_group: &Bytes,
    visited: &mut Visited,
    wanted: &Wanted,
) -> Read<()> {
    let ids = data_group.u16(22, "the number of record ids")?.min(2);
    let (before, around) = (usize::from(ids.min(1)), usize::from(ids));
    let mut groups = Vec::new();
    let mut at = data_group.u32(8, "the first channel group")?;
    while at != 0 {
        visited.first_time(at.into())?;
        let block = block(file, at, b"CG", "a channel group")?;
        groups.push(group(file, &block, at, visited)?);
        at = block.u32(4, "the next channel group")?;
    }
    let start = data_group.u32(16, "the place of the data")?;
    if groups.iter().all(|group| group.records == 0) {
        return Ok(());
    }
    let declared = groups
        .iter()
        .map(|group| u64::from(group.records) * (group.length + around) as u64);
    let declared = declared.fold(0, u64::saturating_add);
    let data = file.part(start.into(), declared, "records")?;
    match groups.as_slice() {
        [_] => groups
            .remove(0)
            .add_to(recording, &Data::plain(data), [before, around], wanted),
        _ => {
            let sorted = sorted(&groups, &data.all("records")?, around, start)?;
            for (group, own) in groups.into_iter().zip(sorted) {
                let own = Content::of_bytes(own);
                let own = Data::plain(Bytes::of_file(&own, file.order));
                group.add_to(recording, &own, [0, 0], wanted)?;
            }
            Ok(())
        }
    }
}

impl Group {
    /// Adds the channels. Their records have an id of `before` bytes in front, and ids of `around` bytes in total.
    fn add_to(self, recording: &mut Recording, data: &Data, [before, around]: [usize; 2], wanted: &Wanted) -> Read<()> {
        let stride = self.length + around;
        let records = Records::checked(data, before, stride, self.records.into(), &self.name, &self.place)?;
        add_group(recording, &self.name, self.channels, &records, wanted)
    }
}

/// The records of each group from unsorted data: an id, the record, and possibly the id again.
fn sorted(groups: &[Group], data: &[u8], around: usize, start: u32) -> Read<Vec<Vec<u8>>> {
    let mut own = vec![Vec::new(); groups.len()];
    let mut rest = data;
    while !rest.is_empty() {
        let place = Place::Byte(u64::from(start) + (data.len() - rest.len()) as u64);
        let index = groups
            .iter()
            .position(|group| u16::from(rest[0]) == group.id && around > 0);
        let Some(index) = index else {
            let found = format!("a record with id {}", rest[0]);
            return Err(Fault::damaged(place, found, "an id of one of the channel groups"));
        };
        let length = groups[index].length;
        let Some((record, next)) = rest.split_at_checked(length + around) else {
            return Err(Fault::damaged(
                place,
                format!("{} bytes", rest.len()),
                format!("a record of {length} bytes"),
            ));
        };
        own[index].extend_from_slice(&record[1..=length]);
        rest = next;
    }
    Ok(own)
}

/// Channel group: next 4, first channel 8, comment 12, record id 16, number of channels 18, size of a record 20,
/// records 22.
fn group(file: &Bytes, block: &Bytes, at: u32, visited: &mut Visited) -> Read<Group> {
    let comment = block.u32(12, "a comment")?;
    let name = if comment == 0 {
        String::new()
    } else {
        text(file, comment)?
    };
    let mut group = Group {
        id: block.u16(16, "a record id")?,
        name: visited.group(&name),
        place: Place::Byte(at.into()),
        records: block.u32(22, "a number of records")?,
        length: block.u16(20, "the size of a record")?.into(),
        channels: Vec::new(),
    };
    let mut at = block.u32(8, "the first channel")?;
    while at != 0 {
        visited.first_time(at.into())?;
        let block = self::block(file, at, b"CN", "a channel")?;
        group.channels.push(channel(file, &block, at, group.length)?);
        at = block.u32(4, "the next channel")?;
    }
    Ok(group)
}

fn text(file: &Bytes, at: u32) -> Read<String> {
    let block = block(file, at, b"TX", "a text")?;
    Ok(field(block.all("a text")?.get(4..).unwrap_or(&[])))
}

/// Channel: next 4, conversion 8, comment 20, type 24, short name 26 to 57, first bit 186, bits 188, data type 190,
/// long name 218, further bytes before the value 226.
fn channel(file: &Bytes, block: &Bytes, at: u32, record: usize) -> Read<Channel> {
    let what = "a channel";
    let long_name = if block.len() >= 222 { block.u32(218, what)? } else { 0 };
    let name = match long_name {
        0 => field(&block.take(26, 32, "a name")?),
        at => text(file, at)?,
    };
    let further = if block.len() >= 228 { block.u16(226, what)? } else { 0 };
    let (unit, conversion) = match block.u32(8, what)? {
        0 => (String::new(), Ok(Conversion::NONE)),
        at => conversion(file, at).map_err(|fault| fault.of(&name))?,
    };
    let is_time = block.u16(24, what)? == 1;
    Ok(Channel {
        name,
        unit,
        role: if is_time { Role::Time } else { Role::Values },
        field: bits(block, usize::from(further), file.order)?.and_then(|field| field.checked(record)),
        conversion,
        place: Place::Byte(at.into()),
    })
}

fn bits(block: &Bytes, further: usize, own: Order) -> Read<Result<Field, String>> {
    let (first, count) = (block.u16(186, "the first bit")?, block.u16(188, "a number of bits")?);
    let (kind, order) = match block.u16(190, "a type of data")? {
        0 => (Kind::Unsigned, own),
        1 => (Kind::Signed, own),
        2 | 3 => (Kind::Float, own),
        9 => (Kind::Unsigned, Order::Big),
        10 => (Kind::Signed, Order::Big),
        11 | 12 => (Kind::Float, Order::Big),
        13 => (Kind::Unsigned, Order::Little),
        14 => (Kind::Signed, Order::Little),
        15 | 16 => (Kind::Float, Order::Little),
        7 => return Ok(Err("text".into())),
        8 => return Ok(Err(format!("{} bytes a sample, not a number", count / 8))),
        other => return Ok(Err(format!("data of type {other}, not numbers"))),
    };
    Ok(Ok(Field::Bits {
        byte: further + usize::from(first / 8),
        bit: u32::from(first % 8),
        count: count.into(),
        kind,
        order,
        invalid: Invalid::None,
    }))
}

/// Unit and conversion; the inner error is the reason why the channel is left out. Conversion: unit 22 to 41, type 42,
/// size 44, parameters 46.
fn conversion(file: &Bytes, at: u32) -> Read<(String, Result<Conversion, String>)> {
    let block = block(file, at, b"CC", "a conversion")?;
    let unit = field(&block.take(22, 20, "a unit")?);
    let (kind, size) = (block.u16(42, "a conversion")?, block.u16(44, "a conversion")?);
    let doubles = |from: u64, count: u64| -> Read<Vec<f64>> {
        let values = (0..count).map(|at| block.f64(from + 8 * at, "a parameter of a conversion"));
        values.collect()
    };
    let conversion = match kind {
        0 => {
            let values = doubles(46, 2)?;
            Ok(Conversion::Linear {
                offset: values[0],
                factor: values[1],
            })
        }
        1 | 2 => {
            let values = doubles(46, 2 * u64::from(size))?;
            let pairs: Vec<(f64, f64)> = values.chunks_exact(2).map(|two| (two[0], two[1])).collect();
            let rises = pairs.is_sorted_by(|low, high| low.0 < high.0) && !pairs.is_empty();
            rises
                .then_some(Conversion::Table {
                    pairs,
                    interpolated: kind == 1,
                })
                .ok_or("a conversion table that does not rise".into())
        }
        6 | 9 => {
            let values = doubles(46, 6)?;
            let six = [values[0], values[1], values[2], values[3], values[4], values[5]];
            Ok(if kind == 6 {
                Conversion::Polynomial(six)
            } else {
                Conversion::Rational(six)
            })
        }
        11 => {
            let entries = (0..u64::from(size)).map(|at| {
                let entry = block.part(46 + 40 * at, 40, "the text of a value")?;
                Ok((entry.f64(0, "a value")?, field(&entry.take(8, 32, "a text")?)))
            });
            Ok(Conversion::Labels(entries.collect::<Read<_>>()?))
        }
        65_535 => Ok(Conversion::NONE),
        other => Err(format!("a conversion of type {other}")),
    };
    Ok((unit, conversion))
}
