//! Object headers of version 1: version 1, reserved 1, messages 2, references 4, bytes 4, fill 4, then messages of type
//! 2, size 2, flags 1, fill 3 and data.

use crate::bytes::{Bytes, Number, Order, field};
use crate::error::{Fault, Read};

use super::too_new;

/// Bytes before the data of a message.
const HEAD: u64 = 8;

/// The description of an object.
#[derive(Default)]
pub(super) struct Header<'a> {
    /// Tree and heap of a group.
    pub(super) symbol_table: Option<(u64, u64)>,
    pub(super) dimensions: Vec<u64>,
    pub(super) datatype: Option<Datatype>,
    pub(super) layout: Option<Layout<'a>>,
    /// Ids of the filters, in the order of writing.
    pub(super) filters: Vec<u16>,
    pub(super) matlab_class: String,
    /// True if MATLAB stores the dimensions of an empty array in place of its elements.
    pub(super) is_empty: bool,
}

/// The type of an element.
#[derive(Clone, Copy)]
pub(super) struct Datatype {
    pub(super) class: Class,
    pub(super) order: Order,
    /// Size, bytes.
    pub(super) size: u32,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Class {
    Number(Number),
    /// The address of another object.
    Reference,
    Other,
}

/// Position of the elements.
pub(super) enum Layout<'a> {
    /// In the header.
    Compact(Bytes<'a>),
    /// At an address, with their largest size in bytes.
    Contiguous(u64, u64),
    /// In chunks of these dimensions, which a tree lists; the last dimension is the size of an element.
    Chunked(u64, Vec<u32>),
}

impl<'a> Header<'a> {
    pub(super) fn read(file: &Bytes<'a>, at: u64) -> Read<Header<'a>> {
        let head = file.part(at, 16, "an object header")?;
        let version = head.u8(0, "an object header")?;
        if version != 1 {
            let found = format!(
                "an object header of version {}",
                if version == b'O' { 2 } else { version }
            );
            return Err(too_new(file, at, found));
        }
        let mut header = Header::default();
        let mut parts = vec![(at + 16, u64::from(head.u32(8, "the size of a header")?))];
        let mut messages = u32::from(head.u16(2, "a number of messages")?);
        while let Some((start, length)) = parts.pop() {
            let part = file.part(start, length, "messages")?;
            let mut at = 0;
            while at + HEAD <= part.len() && messages > 0 {
                let size = u64::from(part.u16(at + 2, "the size of a message")?);
                let message = part.part(at + HEAD, size, "a message")?;
                match part.u16(at, "the type of a message")? {
                    0x10 => parts.push((message.u64(0, "a continuation")?, message.u64(8, "a continuation")?)),
                    kind => header.add(kind, &message)?,
                }
                messages -= 1;
                at += HEAD + size;
            }
        }
        Ok(header)
    }

    fn add(&mut self, kind: u16, message: &Bytes<'a>) -> Read<()> {
        match kind {
            0x01 => self.dimensions = dimensions(message)?,
            0x03 => self.datatype = Some(Datatype::read(message)?),
            0x08 => self.layout = Some(Layout::read(message)?),
            0x0b => self.filters = filters(message)?,
            0x0c => self.add_attribute(message)?,
            0x11 => self.symbol_table = Some((message.u64(0, "a group")?, message.u64(8, "a group")?)),
            _ => {}
        }
        Ok(())
    }

    /// Attribute: version 1, reserved 1, sizes of name, type and space of 2 each, then these, which fill up eight bytes
    /// in version 1, and the data. Version 3 has one byte more.
    fn add_attribute(&mut self, message: &Bytes) -> Read<()> {
        let version = message.u8(0, "an attribute")?;
        let filled = |size: u16| {
            if version == 1 {
                u64::from(size).next_multiple_of(8)
            } else {
                size.into()
            }
        };
        let name_at = if version == 3 { 9 } else { 8 };
        let name_size = message.u16(2, "an attribute")?;
        let before =
            name_at + filled(name_size) + filled(message.u16(4, "a type")?) + filled(message.u16(6, "a space")?);
        let name = field(&message.take(name_at, name_size.into(), "the name of an attribute")?);
        let rest = message.len().saturating_sub(before);
        let data = message.take(before.min(message.len()), rest, "an attribute")?;
        match name.as_str() {
            "MATLAB_class" => self.matlab_class = field(&data),
            "MATLAB_empty" => self.is_empty = data.iter().any(|&byte| byte != 0),
            _ => {}
        }
        Ok(())
    }
}

/// Version 1, dimensions 1, flags 1, then fill 5 (version 1) or kind 1 (version 2), and the dimensions.
fn dimensions(message: &Bytes) -> Read<Vec<u64>> {
    let start = if message.u8(0, "a space")? == 1 { 8 } else { 4 };
    let count = u64::from(message.u8(1, "a space")?);
    (0..count)
        .map(|at| message.u64(start + 8 * at, "a dimension"))
        .collect()
}

impl Datatype {
    /// Class and version 1, bits 3, size 4.
    fn read(message: &Bytes) -> Read<Datatype> {
        let (class, bits) = (message.u8(0, "a type")? & 0x0f, message.u8(1, "a type")?);
        let size = message.u32(4, "a type")?;
        let class = match (class, bits & 8 != 0, size) {
            (0, false, 1) => Class::Number(Number::U8),
            (0, true, 1) => Class::Number(Number::I8),
            (0, false, 2) => Class::Number(Number::U16),
            (0, true, 2) => Class::Number(Number::I16),
            (0, false, 4) => Class::Number(Number::U32),
            (0, true, 4) => Class::Number(Number::I32),
            (0, false, 8) => Class::Number(Number::U64),
            (0, true, 8) => Class::Number(Number::I64),
            (1, _, 4) => Class::Number(Number::F32),
            (1, _, 8) => Class::Number(Number::F64),
            (7, _, 8) => Class::Reference,
            _ => Class::Other,
        };
        let order = if bits & 1 == 0 { Order::Little } else { Order::Big };
        Ok(Datatype { class, order, size })
    }
}

impl<'a> Layout<'a> {
    /// Version 3: version 1, class 1, then what the class says. Versions 1 and 2: version 1, dimensions 1, class 1,
    /// fill 5, an address 8 unless the class is compact, dimensions of 4 each, of compact data their size 4.
    fn read(message: &Bytes<'a>) -> Read<Layout<'a>> {
        let (version, class) = (message.u8(0, "a layout")?, message.u8(1, "a layout")?);
        if matches!(version, 1 | 2) {
            let (count, class) = (u64::from(class), message.u8(2, "a layout")?);
            let sizes = |start: u64| {
                (0..count)
                    .map(|at| message.u32(start + 4 * at, "a dimension"))
                    .collect::<Read<_>>()
            };
            return match class {
                0 => {
                    let size = message.u32(8 + 4 * count, "a layout")?;
                    Ok(Layout::Compact(message.part(
                        12 + 4 * count,
                        size.into(),
                        "elements",
                    )?))
                }
                1 => Ok(Layout::Contiguous(message.u64(8, "a layout")?, u64::MAX)),
                _ => Ok(Layout::Chunked(message.u64(8, "a layout")?, sizes(16)?)),
            };
        }
        match (version, class) {
            (3, 0) => {
                let size = message.u16(2, "a layout")?;
                Ok(Layout::Compact(message.part(4, size.into(), "elements")?))
            }
            (3, 1) => Ok(Layout::Contiguous(
                message.u64(2, "a layout")?,
                message.u64(10, "a layout")?,
            )),
            (3, 2) => {
                let count = u64::from(message.u8(2, "a layout")?);
                let sizes = (0..count).map(|at| message.u32(11 + 4 * at, "the size of a chunk"));
                Ok(Layout::Chunked(
                    message.u64(3, "a layout")?,
                    sizes.collect::<Read<_>>()?,
                ))
            }
            _ => {
                let found = format!("a layout of version {version} and class {class}");
                let remedy = "save the file with MATLAB (-v7 or -v7.3)";
                Err(Fault::new(
                    message.place(0),
                    found,
                    "a layout of version 1 to 3",
                    remedy,
                ))
            }
        }
    }
}

/// Version 1, filters 1, in version 1 fill 6; each filter: id 2, length of its name 2 (missing in version 2 for filters
/// with a number of HDF5), flags 2, values 2, name, values of 4 each and in version 1 a fill to eight bytes.
fn filters(message: &Bytes) -> Read<Vec<u16>> {
    let (version, count) = (message.u8(0, "filters")?, message.u8(1, "filters")?);
    let mut at = if version == 1 { 8 } else { 2 };
    let mut ids = Vec::new();
    for _ in 0..count {
        let id = message.u16(at, "a filter")?;
        let named = version == 1 || id >= 256;
        let name = if named {
            u64::from(message.u16(at + 2, "a filter")?)
        } else {
            0
        };
        let values_at = if named { at + 6 } else { at + 4 };
        let values = u64::from(message.u16(values_at, "a filter")?);
        let filled = if version == 1 {
            values.next_multiple_of(2)
        } else {
            values
        };
        at = values_at + 2 + if version == 1 { name.next_multiple_of(8) } else { name } + 4 * filled;
        ids.push(id);
    }
    Ok(ids)
}
