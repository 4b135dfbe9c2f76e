//! The part of HDF5 that MATLAB uses for version 7.3: groups of symbol tables, object headers of version 1, data in one
//! piece or in chunks, compressed by Deflate or not.
//!
//! Source: "HDF5 File Format Specification" 2.0 of The HDF Group. Files of superblock versions 2 and 3 are read by the
//! crate that also writes version 7.3.

// Messages of an object header.
mod messages;
// The stored bytes of a dataset.
mod storage;
// Superblock versions 2 and 3.
mod latest;

use std::collections::HashSet;

use crate::bytes::{Bytes, Number, Order, field, text};
use crate::error::{Fault, Read};
use crate::find::Wanted;
use crate::limit::Budget;

use super::value::{Array, Fields, Value, Variable, is_read, of_fields};

use messages::{Class, Header, Layout};

pub(super) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// An address that is not there.
const UNDEFINED: u64 = u64::MAX;
/// Largest depth of nested groups.
const DEEPEST: usize = 16;

/// The position of the superblock; `None` if there is none at a position that HDF5 allows.
pub(super) fn superblock(file: &Bytes) -> Option<u64> {
    let places = std::iter::once(0).chain((9..24).map(|power| 1 << power));
    let mut places = places.take_while(|&at| at < file.len());
    let stands_at = |at: u64| {
        file.part(at, file.len() - at, "a superblock")
            .is_ok_and(|rest| rest.starts_with(SIGNATURE))
    };
    places.find(|&at| stands_at(at))
}

/// All variables of a file whose superblock is at byte `at`.
pub(super) fn variables(whole: &Bytes, at: u64, wanted: &Wanted) -> Read<Vec<Variable>> {
    let file = whole.part(at, whole.len() - at, "HDF5")?;
    let version = file.u8(8, "the superblock")?;
    check_end(whole, &file, version)?;
    if matches!(version, 2 | 3) {
        return latest::variables(whole, wanted);
    }
    let sizes = (file.u8(13, "the superblock")?, file.u8(14, "the superblock")?);
    if version > 1 || sizes != (8, 8) {
        let found = format!("a superblock of version {version}");
        return Err(too_new(&file, 8, found));
    }
    let root = file.u64(if version == 0 { 64 } else { 68 }, "the root group")?;
    let mut reader = Reader {
        file,
        visited: HashSet::new(),
        budget: Budget::of_file(file.len()),
    };
    let header = Header::read(&file, root)?;
    let mut variables = Vec::new();
    for (name, address) in reader.members(&header)? {
        // Names for internal use of MATLAB begin with #.
        if !name.starts_with('#') {
            let value = reader
                .variable(&name, address, wanted)
                .map_err(|fault| fault.of(&name))?;
            variables.push(Variable {
                name,
                value,
                place: file.place(address),
            });
        }
    }
    Ok(variables)
}

/// Refuses a file that ends before the end that its superblock states; it counts from the beginning of the file.
fn check_end(whole: &Bytes, file: &Bytes, version: u8) -> Read<()> {
    let end = match version {
        0 => file.u64(40, "the superblock")?,
        1 => file.u64(44, "the superblock")?,
        2 | 3 => file.u64(28, "the superblock")?,
        _ => return Ok(()),
    };
    if end <= whole.len() || end == UNDEFINED {
        return Ok(());
    }
    let found = format!("{} bytes", whole.len());
    Err(Fault::cut_off(
        file.place(0),
        found,
        format!("{end} bytes, as the superblock states"),
    ))
}

fn too_new(file: &Bytes, at: u64, found: impl Into<String>) -> Box<Fault> {
    let remedy = "save the file with MATLAB (-v7 or -v7.3), or with the earliest version of HDF5 allowed";
    Fault::new(file.place(at), found, "HDF5 as MATLAB writes it", remedy)
}

struct Reader<'a> {
    file: Bytes<'a>,
    /// Positions of objects, nodes and data that were read; none is read twice.
    visited: HashSet<u64>,
    budget: Budget,
}

impl<'a> Reader<'a> {
    fn first_time(&mut self, at: u64) -> Read<()> {
        if self.visited.insert(at) {
            return Ok(());
        }
        let found = "a link to something that was read before";
        Err(Fault::damaged(self.file.place(at), found, "links without a loop"))
    }

    /// The value of a variable.
    fn variable(&mut self, name: &str, address: u64, wanted: &Wanted) -> Read<Value> {
        let header = Header::read(&self.file, address)?;
        if let Some(value) = without_data(&header) {
            return Ok(value);
        }
        let numbers = matches!(header.datatype.map(|datatype| datatype.class), Some(Class::Number(_)));
        let skipped = numbers && header.matlab_class != "char" && !is_read(name, &header.dimensions, wanted);
        if skipped {
            return Ok(Value::Numbers(Array::unread(header.dimensions)));
        }
        self.value(address, DEEPEST)
    }

    /// The value of the object at an address.
    fn value(&mut self, address: u64, depth: usize) -> Read<Value> {
        self.first_time(address)?;
        let header = Header::read(&self.file, address)?;
        if header.symbol_table.is_some() {
            return match depth {
                0 => Err(Fault::damaged(
                    self.file.place(address),
                    "groups within groups without end",
                    "a value",
                )),
                _ => self.structure(&header, depth - 1),
            };
        }
        let Some(class) = header.datatype.map(|datatype| datatype.class) else {
            return Ok(Value::Other("an object without data"));
        };
        let number = match class {
            Class::Reference => return Ok(Value::Cells(self.cells(&header, depth)?)),
            Class::Number(number) => number,
            Class::Other => return Ok(Value::Other("data that are no real numbers")),
        };
        if let Some(value) = without_data(&header) {
            return Ok(value);
        }
        let numbers = self.numbers(&header, number)?;
        if header.matlab_class == "char" {
            let units: Vec<u16> = numbers.iter().map(|&unit| unit as u16).collect();
            return Ok(Value::Text(String::from_utf16_lossy(&units)));
        }
        // HDF5 has its dimensions in the opposite order.
        let mut dimensions = header.dimensions;
        dimensions.reverse();
        Ok(Value::Numbers(Array { dimensions, numbers }))
    }

    /// A group as a structure or a structure array.
    fn structure(&mut self, header: &Header<'a>, depth: usize) -> Read<Value> {
        let mut fields = Fields::new();
        for (name, address) in self.members(header)? {
            let value = self.value(address, depth).map_err(|fault| fault.of(&name))?;
            fields.push((name, value));
        }
        Ok(of_fields(fields))
    }

    fn cells(&mut self, header: &Header<'a>, depth: usize) -> Read<Vec<Value>> {
        if depth == 0 || header.is_empty {
            return Ok(Vec::new());
        }
        let bytes = self.data(header)?;
        let addresses = bytes.chunks_exact(8).filter_map(|address| address.first_chunk());
        addresses
            .map(|&address| self.value(u64::from_le_bytes(address), depth - 1))
            .collect()
    }

    /// Names and addresses of the members of a group, in the order of their names.
    fn members(&mut self, header: &Header) -> Read<Vec<(String, u64)>> {
        let Some((tree, heap)) = header.symbol_table else {
            return Err(too_new(&self.file, 0, "a group that is no symbol table"));
        };
        let heap = self.file.part(heap, 32, "a heap of names")?;
        let size = heap.u64(8, "the size of names")?;
        let names = self.file.take(heap.u64(24, "the place of names")?, size, "names")?;
        let mut members = Vec::new();
        for node in self.leaves(tree, 0, 0)? {
            let head = self.file.part(node.child, 8, "symbols")?;
            if !head.starts_with(b"SNOD") {
                return Err(Fault::damaged(
                    head.place(0),
                    format!("`{}`", text(&head.take(0, 4, "a signature")?)),
                    "symbols (`SNOD`)",
                ));
            }
            let count = u64::from(head.u16(6, "a number of symbols")?);
            let symbols = self.file.part(node.child + 8, 40 * count, "symbols")?;
            for at in (0..count).map(|index| 40 * index) {
                let name = names.get(symbols.u64(at, "a name")? as usize..).unwrap_or(&[]);
                let name = field(&name[..name.len().min(LONGEST_NAME)]);
                members.push((name, symbols.u64(at + 8, "an address")?));
            }
        }
        Ok(members)
    }

    /// The leaves of a tree: `TREE`, kind 1, level 1, entries 2, neighbours 8 each, then keys and children in turn.
    fn leaves(&mut self, root: u64, kind: u8, dimensions: u64) -> Read<Vec<Leaf>> {
        let key = if kind == 0 { 8 } else { 8 + 8 * dimensions };
        let mut nodes = vec![root];
        let mut leaves = Vec::new();
        while let Some(at) = nodes.pop() {
            self.first_time(at)?;
            let head = self.file.part(at, 24, "a tree")?;
            if !head.starts_with(b"TREE") || head.u8(4, "the kind of a tree")? != kind {
                return Err(Fault::damaged(
                    head.place(0),
                    format!("`{}`", text(&head.take(0, 4, "a signature")?)),
                    "a tree (`TREE`)",
                ));
            }
            let count = u64::from(head.u16(6, "a number of entries")?);
            let entries = self.file.part(at + 24, count * (key + 8), "entries of a tree")?;
            let mut children = Vec::new();
            for entry in (0..count).map(|index| index * (key + 8)) {
                let numbers = Number::U64.all(&entries.take(entry, key, "a key")?, Order::Little);
                let child = entries.u64(entry + key, "an address")?;
                let size = entries.u32(entry, "the size of a chunk")?;
                let skipped = if kind == 0 {
                    0
                } else {
                    entries.u32(entry + 4, "a filter mask")?
                };
                let offsets = numbers.iter().skip(1).map(|&offset| offset as u64).collect();
                children.push(Leaf {
                    size,
                    skipped,
                    offsets,
                    child,
                });
            }
            match head.u8(5, "the level of a tree")? {
                0 => leaves.extend(children),
                _ => nodes.extend(children.iter().rev().map(|leaf| leaf.child)),
            }
        }
        Ok(leaves)
    }
}

/// The value of a dataset whose elements are not read: it has none, was never written, or is packed in an unknown way.
fn without_data(header: &Header) -> Option<Value> {
    let numbers = matches!(header.datatype?.class, Class::Number(_));
    let unwritten = matches!(
        header.layout,
        Some(Layout::Contiguous(UNDEFINED, _) | Layout::Chunked(UNDEFINED, _))
    );
    if numbers && (header.is_empty || header.dimensions.contains(&0)) {
        return Some(Value::Numbers(Array::unread(vec![0])));
    }
    match storage::is_unpacked(header) {
        _ if numbers && unwritten => Some(Value::Other("data that were never written")),
        false => Some(Value::Other("data packed by another filter than Deflate")),
        true => None,
    }
}

/// Largest length of a name, bytes.
const LONGEST_NAME: usize = 1024;

/// An entry of a tree: a node of symbols, or a chunk of data with its size in bytes, the mask of skipped filters and
/// its position in the dataset.
struct Leaf {
    size: u32,
    skipped: u32,
    offsets: Vec<u64>,
    child: u64,
}
