//! MAT-files of versions 5 to 7: elements of a tag (type 4, bytes 4, or both in four bytes for a small element) and
//! data padded to eight bytes; variables may be packed.
//!
//! Source: "MAT-File Format" of The MathWorks.

use std::io::Read as _;

use flate2::read::ZlibDecoder;

use crate::bytes::{Bytes, Number, Order, field, text};
use crate::content::Content;
use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::limit::Budget;

use super::HEADER;
use super::value::{Array, Fields, Value, Variable, among, is_read};

const PACKED: u32 = 15;
const MATRIX: u32 = 14;
/// Number of packed bytes that contain the name of a variable.
const MOST_OF_A_HEAD: u64 = 4096;
/// Largest depth of nested structures.
const DEEPEST: usize = 32;

/// All variables of a file.
pub(super) fn variables(file: Bytes, wanted: &Wanted) -> Read<Vec<Variable>> {
    let order = if *file.take(HEADER as u64 - 2, 2, "the byte order")? == *b"IM" {
        Order::Little
    } else {
        Order::Big
    };
    let file = file.in_order(order);
    let budget = Budget::of_file(file.len());
    let mut variables: Vec<Variable> = Vec::new();
    let mut at = HEADER as u64;
    while at < file.len() {
        let element = element(&file, at).map_err(|fault| {
            let fault = among(&variables, fault);
            match name_of_packed(&file, at) {
                Some(name) => fault.of(&name),
                None => fault,
            }
        })?;
        let place = Place::Byte(at);
        let unpacked;
        let variable = if element.kind == PACKED {
            unpacked = Content::of_bytes(unpack(&element, &place, &budget)?);
            self::element(&Bytes::unpacked(&unpacked, order, at), 0)?
        } else {
            element
        };
        if variable.kind == MATRIX {
            let (name, value) = matrix(&variable.data, DEEPEST, wanted)?;
            variables.push(Variable { name, value, place });
        }
        at = element.next;
    }
    Ok(variables)
}

/// The content of a packed element.
fn unpack(element: &Element, place: &Place, budget: &Budget) -> Read<Vec<u8>> {
    let packed = element.data.all("packed data")?;
    budget.unpack(ZlibDecoder::new(&*packed), place, |error| {
        let found = format!("packed data that end with: {error}");
        Fault::damaged(place.clone(), found, "whole packed data")
    })
}

/// The name of a variable, from the beginning of its packed data.
fn name_of_packed(file: &Bytes, at: u64) -> Option<String> {
    let there = file.len().checked_sub(at + 8)?;
    let packed = file.take(at + 8, there.min(MOST_OF_A_HEAD), "packed data").ok()?;
    let mut begin = [0; 256];
    let mut length = 0;
    let mut decoder = ZlibDecoder::new(&*packed);
    while let Ok(more @ 1..) = decoder.read(&mut begin[length..]) {
        length += more;
    }
    let content = Content::of_bytes(&begin[..length]);
    let bytes = Bytes::unpacked(&content, file.order, at);
    // After the tag of the matrix, its flags and its dimensions.
    let dimensions = element(&bytes, 24).ok()?;
    let name = element(&bytes, dimensions.next).ok()?;
    Some(field(&name.data.all("a name").ok()?))
}

/// An element of a file.
#[derive(Clone, Copy)]
struct Element<'a> {
    kind: u32,
    data: Bytes<'a>,
    next: u64,
}

fn element<'a>(from: &Bytes<'a>, at: u64) -> Read<Element<'a>> {
    let tag = from.u32(at, "a tag")?;
    if tag >> 16 != 0 {
        let data = from.part(at + 4, (tag >> 16).into(), "a small element")?;
        return Ok(Element {
            kind: tag & 0xffff,
            data,
            next: at + 8,
        });
    }
    let length = u64::from(from.u32(at + 4, "a tag")?);
    let data = from.part(at + 8, length, "an element")?;
    let filled = if tag == PACKED {
        length
    } else {
        length.next_multiple_of(8)
    };
    Ok(Element {
        kind: tag,
        data,
        next: at + 8 + filled,
    })
}

/// Elements of a matrix: flags, dimensions, name, then elements that depend on its class.
fn matrix(data: &Bytes, depth: usize, wanted: &Wanted) -> Read<(String, Value)> {
    if data.len() == 0 {
        return Ok((String::new(), Value::Other("nothing")));
    }
    let flags = element(data, 0)?;
    let class = flags.data.u32(0, "flags")?;
    let dimensions = element(data, flags.next)?;
    let name_element = element(data, dimensions.next)?;
    let name = field(&name_element.data.all("a name")?);
    let dimensions: Vec<u64> = Number::I32
        .all(&dimensions.data.all("dimensions")?, data.order)
        .into_iter()
        .map(|d| d as u64)
        .collect();
    let at = name_element.next;
    let complex = class & 0x0800 != 0;
    let value = match class & 0xff {
        1 => cells(data, at, depth).map(Value::Cells),
        2 => structs(data, at, depth).map(Value::Structs),
        4 => element(data, at).and_then(|element| Ok(Value::Text(characters(&element)?))),
        6..=15 if complex => Ok(Value::Other("complex numbers")),
        6..=15 if depth == DEEPEST && !is_read(&name, &dimensions, wanted) => {
            Ok(Value::Numbers(Array::unread(dimensions)))
        }
        6..=15 => numbers(data, at, dimensions).map(Value::Numbers),
        3 => Ok(Value::Other("an object")),
        5 => Ok(Value::Other("a sparse matrix")),
        _ => Ok(Value::Other("a function or an object")),
    };
    Ok((
        name.clone(),
        value.map_err(|fault| if name.is_empty() { fault } else { fault.of(&name) })?,
    ))
}

fn numbers(data: &Bytes, at: u64, dimensions: Vec<u64>) -> Read<Array> {
    let element = element(data, at)?;
    let number = match element.kind {
        1 => Number::I8,
        2 => Number::U8,
        3 => Number::I16,
        4 => Number::U16,
        5 => Number::I32,
        6 => Number::U32,
        7 => Number::F32,
        9 => Number::F64,
        12 => Number::I64,
        13 => Number::U64,
        kind => {
            return Err(Fault::damaged(
                data.place(at),
                format!("data of type {kind}"),
                "numbers",
            ));
        }
    };
    let numbers = number.all_of(&element.data, "numbers")?;
    let declared = dimensions.iter().try_fold(1_u64, |all, &size| all.checked_mul(size));
    if declared != Some(numbers.len() as u64) {
        let sizes: Vec<String> = dimensions.iter().map(u64::to_string).collect();
        let found = format!("{} numbers", numbers.len());
        return Err(Fault::damaged(
            data.place(at),
            found,
            format!("an array of {}", sizes.join(" x ")),
        ));
    }
    Ok(Array { dimensions, numbers })
}

fn characters(element: &Element) -> Read<String> {
    let bytes = element.data.all("a text")?;
    Ok(match element.kind {
        4 | 17 => {
            let units = Number::U16.all(&bytes, element.data.order);
            let units: Vec<u16> = units.into_iter().map(|unit| unit as u16).collect();
            String::from_utf16_lossy(&units)
        }
        _ => text(&bytes).into(),
    })
}

fn cells(data: &Bytes, mut at: u64, depth: usize) -> Read<Vec<Value>> {
    let mut cells = Vec::new();
    while at < data.len() {
        let (value, next) = nested(data, at, depth)?;
        cells.push(value);
        at = next;
    }
    Ok(cells)
}

/// The value of an element within another, and the position of the next one.
fn nested(data: &Bytes, at: u64, depth: usize) -> Read<(Value, u64)> {
    let element = element(data, at)?;
    if element.kind != MATRIX || depth == 0 {
        let found = format!("data of type {} within {} others", element.kind, DEEPEST - depth);
        return Err(Fault::damaged(data.place(at), found, "an array"));
    }
    Ok((matrix(&element.data, depth - 1, &Wanted::All)?.1, element.next))
}

/// Length of a field's name, names, and the fields of each element.
fn structs(data: &Bytes, at: u64, depth: usize) -> Read<Vec<Fields>> {
    let length = element(data, at)?;
    let width = length.data.u32(0, "the length of names")? as usize;
    let names_element = element(data, length.next)?;
    let names = names_element.data.all("the names of fields")?;
    let names: Vec<String> = names.chunks_exact(width.max(1)).map(field).collect();
    let mut elements = Vec::new();
    let mut at = names_element.next;
    while at < data.len() && !names.is_empty() {
        let mut fields = Fields::new();
        for name in &names {
            let (value, next) = nested(data, at, depth).map_err(|fault| fault.of(name))?;
            fields.push((name.clone(), value));
            at = next;
        }
        elements.push(fields);
    }
    Ok(elements)
}
