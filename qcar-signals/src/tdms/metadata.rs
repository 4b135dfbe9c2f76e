//! The list of objects of a segment: path, index of the raw data, properties.

use std::collections::HashMap;

use crate::bytes::{Bytes, Number, text};
use crate::error::{Fault, Place, Read};

/// An object as a segment describes it.
pub(super) struct SegmentObject {
    pub(super) path: String,
    pub(super) index: Option<Index>,
    pub(super) properties: HashMap<String, Property>,
}

/// Arrangement of the raw data of an object in each chunk of a segment.
#[derive(Clone)]
pub(super) struct Index {
    /// Number of values in a chunk.
    pub(super) count: u64,
    pub(super) layout: Layout,
}

#[derive(Clone)]
pub(super) enum Layout {
    Plain(Number),
    /// Time stamps.
    Stamps,
    /// Data other than numbers, with their size in a chunk, bytes.
    Unread {
        bytes: u64,
        why: String,
    },
    /// Several objects in common buffers, of these widths.
    Daqmx {
        scalers: Vec<Scaler>,
        widths: Vec<u32>,
    },
}

/// Position of a DAQmx value.
#[derive(Clone)]
pub(super) struct Scaler {
    pub(super) id: u32,
    pub(super) number: Number,
    pub(super) buffer: u32,
    /// Position in each row of the buffer.
    pub(super) byte: u32,
}

/// The description of an object, without its data.
#[derive(Clone, Debug)]
pub(super) enum Property {
    Number(f64),
    Text(String),
}

/// By name.
#[derive(Default)]
pub(super) struct Properties(HashMap<String, Property>);

impl Properties {
    pub(super) fn extend(&mut self, further: HashMap<String, Property>) {
        self.0.extend(further);
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        match self.0.get(name)? {
            Property::Number(number) => Some(*number),
            Property::Text(_) => None,
        }
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        match self.0.get(name)? {
            Property::Text(text) => Some(text),
            Property::Number(_) => None,
        }
    }
}

/// Type of a time stamp.
const TIME: u32 = 0x44;
/// Bytes of a time stamp.
pub(super) const STAMP: u64 = 16;

/// Largest number of bytes that values use, relative to those of a row.
const MOST_USES: u64 = 16;

impl Index {
    /// Bytes of a value.
    pub(super) fn size(&self) -> Option<u64> {
        match &self.layout {
            Layout::Plain(number) => Some(number.size() as u64),
            Layout::Stamps => Some(STAMP),
            _ => None,
        }
    }
}

/// Bytes of a chunk.
pub(super) fn chunk(used: &[(usize, Index)]) -> Option<u64> {
    let own = |index: &Index| match &index.layout {
        Layout::Plain(number) => index.count.checked_mul(number.size() as u64),
        Layout::Stamps => index.count.checked_mul(STAMP),
        Layout::Unread { bytes, .. } => Some(*bytes),
        Layout::Daqmx { .. } => Some(0),
    };
    let plain = used
        .iter()
        .try_fold(0_u64, |all, (_, index)| all.checked_add(own(index)?))?;
    let rows = rows_of_buffers(used);
    let bytes_used = |index: &Index| match &index.layout {
        Layout::Daqmx { scalers, .. } => scalers.iter().map(|scaler| scaler.number.size() as u64).sum(),
        _ => 0,
    };
    let bytes_used: u64 = used.iter().map(|(_, index)| bytes_used(index)).sum();
    let widths: u64 = rows.iter().map(|(_, width)| *width).sum();
    if bytes_used > MOST_USES * widths {
        return None;
    }
    rows.iter()
        .try_fold(plain, |all, (rows, width)| all.checked_add(rows.checked_mul(*width)?))
}

/// Rows and width of each DAQmx buffer: it has as many rows as the object with the most values in it.
fn rows_of_buffers(used: &[(usize, Index)]) -> Vec<(u64, u64)> {
    let mut buffers: Vec<(u64, u64)> = Vec::new();
    for (_, index) in used {
        let Layout::Daqmx { scalers, widths } = &index.layout else {
            continue;
        };
        for (at, &width) in widths.iter().enumerate() {
            if buffers.len() <= at {
                buffers.push((0, width.into()));
            }
            if scalers.iter().any(|scaler| scaler.buffer as usize == at) {
                buffers[at].0 = buffers[at].0.max(index.count);
            }
        }
    }
    buffers
}

/// The bytes of a DAQmx buffer within a chunk, and its width.
pub(super) fn buffer<'a>(used: &[(usize, Index)], chunk: &Bytes<'a>, number: u32) -> Read<Option<(Bytes<'a>, u64)>> {
    let mut at = 0;
    for (index, (rows, width)) in rows_of_buffers(used).into_iter().enumerate() {
        let size = rows * width;
        if index == number as usize {
            let buffer = chunk.part(at, size, "a buffer of DAQmx")?;
            return Ok(Some((buffer, width)).filter(|_| width > 0));
        }
        at += size;
    }
    Ok(None)
}

/// Reads an object from byte `at` on and moves `at` past it. `known` gives the index it had before.
pub(super) fn object(from: &Bytes, at: &mut u64, known: &dyn Fn(&str) -> Option<Index>) -> Read<SegmentObject> {
    let path = string(from, at)?;
    let start = *at;
    let kind = step_u32(from, at)?;
    let index = match kind {
        u32::MAX => None,
        0 => Some(known(&path).ok_or_else(|| {
            Fault::damaged(from.place(start), "data described as before", "a description before").of(&path)
        })?),
        0x1269 | 0x126a => Some(daqmx(from, at, kind == 0x126a)?),
        _ => Some(plain(from, at)?),
    };
    let mut properties = HashMap::new();
    for _ in 0..step_u32(from, at)? {
        let name = string(from, at)?;
        let value = property(from, at)?;
        properties.extend(value.map(|value| (name, value)));
    }
    Ok(SegmentObject {
        path,
        index,
        properties,
    })
}

fn step_u32(from: &Bytes, at: &mut u64) -> Read<u32> {
    let value = from.u32(*at, "an object")?;
    *at += 4;
    Ok(value)
}

fn string(from: &Bytes, at: &mut u64) -> Read<String> {
    let length = u64::from(step_u32(from, at)?);
    let bytes = from.take(*at, length, "a text")?;
    *at += length;
    Ok(text(&bytes).into())
}

/// Type 4, dimension 4, number of values 8, and of texts their bytes 8.
fn plain(from: &Bytes, at: &mut u64) -> Read<Index> {
    let (kind, count) = (step_u32(from, at)?, from.u64(*at + 4, "a number of values")?);
    *at += 12;
    let unread = |bytes: Option<u64>, why: &str| Layout::Unread {
        bytes: bytes.unwrap_or(u64::MAX),
        why: why.into(),
    };
    let layout = match (number(kind), kind) {
        (Some(number), _) => Layout::Plain(number),
        (None, 0x20) => {
            let bytes = from.u64(*at, "the size of texts")?;
            *at += 8;
            unread(Some(bytes), "texts")
        }
        (None, TIME) => Layout::Stamps,
        (None, 0x0008_000c) => unread(count.checked_mul(8), "complex numbers"),
        (None, 0x0010_000d) => unread(count.checked_mul(16), "complex numbers"),
        _ => {
            let remedy = "export the channel as a number";
            let found = format!("data of type {kind:#x}");
            return Err(Fault::new(
                from.place(*at - 16),
                found,
                "whole or floating-point numbers",
                remedy,
            ));
        }
    };
    Ok(Index { count, layout })
}

/// The types of numbers.
fn number(kind: u32) -> Option<Number> {
    Some(match kind {
        1 => Number::I8,
        2 => Number::I16,
        3 => Number::I32,
        4 => Number::I64,
        5 | 0x21 => Number::U8,
        6 => Number::U16,
        7 => Number::U32,
        8 => Number::U64,
        9 | 0x19 => Number::F32,
        10 | 0x1a => Number::F64,
        _ => return None,
    })
}

/// Type 4, dimension 4, number of values 8, number of scalers 4, scalers (type 4, buffer 4, byte 4, format 4, id 4; of
/// digital lines the format takes 1), number of widths 4, widths of 4 each.
fn daqmx(from: &Bytes, at: &mut u64, digital: bool) -> Read<Index> {
    let start = *at;
    let count = from.u64(*at + 8, "a number of values")?;
    *at += 16;
    let scalers = daqmx_scalers(from, at, digital)?;
    let mut widths = Vec::new();
    for _ in 0..step_u32(from, at)? {
        widths.push(step_u32(from, at)?);
    }
    let inside = |scaler: &Scaler| {
        let width = widths.get(scaler.buffer as usize).copied().unwrap_or(0);
        u64::from(scaler.byte) + scaler.number.size() as u64 <= width.into()
    };
    if !scalers.iter().all(inside) {
        let found = "a value outside the rows of its buffer";
        return Err(Fault::damaged(from.place(start), found, "a value in a row"));
    }
    Ok(Index {
        count,
        layout: Layout::Daqmx { scalers, widths },
    })
}

fn daqmx_scalers(from: &Bytes, at: &mut u64, digital: bool) -> Read<Vec<Scaler>> {
    let place = from.place(*at - 16);
    let mut scalers = Vec::new();
    for _ in 0..step_u32(from, at)? {
        let (kind, buffer, byte) = (step_u32(from, at)?, step_u32(from, at)?, step_u32(from, at)?);
        *at += if digital { 1 } else { 4 };
        let id = step_u32(from, at)?;
        let number = daqmx_number(kind).filter(|_| !digital);
        scalers.push(Scaler {
            id,
            number: number.ok_or_else(|| unread_daqmx(place.clone(), kind, digital))?,
            buffer,
            byte,
        });
    }
    Ok(scalers)
}

fn unread_daqmx(place: Place, kind: u32, digital: bool) -> Box<Fault> {
    let found = if digital {
        "digital lines of DAQmx".into()
    } else {
        format!("DAQmx data of type {kind}")
    };
    let expected = "DAQmx data of whole or floating-point numbers";
    Fault::new(place, found, expected, "export the file without them")
}

fn daqmx_number(kind: u32) -> Option<Number> {
    Some(match kind {
        0 => Number::U8,
        1 => Number::I8,
        2 => Number::U16,
        3 => Number::I16,
        4 => Number::U32,
        5 => Number::I32,
        6 => Number::U64,
        7 => Number::I64,
        8 => Number::F32,
        9 => Number::F64,
        _ => return None,
    })
}

/// A property; nothing for a time.
fn property(from: &Bytes, at: &mut u64) -> Read<Option<Property>> {
    let kind = step_u32(from, at)?;
    if kind == 0x20 {
        return Ok(Some(Property::Text(string(from, at)?)));
    }
    let number = number(kind);
    let size = match kind {
        TIME => STAMP,
        _ => number.map_or(0, |number| number.size() as u64),
    };
    if size == 0 {
        let found = format!("a property of type {kind:#x}");
        return Err(Fault::damaged(from.place(*at), found, "a number, a text or a time"));
    }
    let bytes = from.take(*at, size, "a property")?;
    *at += size;
    Ok(number
        .and_then(|number| number.all(&bytes, from.order).first().copied())
        .map(Property::Number))
}
