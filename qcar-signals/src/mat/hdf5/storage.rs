//! The bytes of a dataset, in one run or in chunks.

use std::borrow::Cow;
use std::io::Read as _;

use flate2::read::ZlibDecoder;

use crate::bytes::{Bytes, Number, Order};
use crate::error::{Fault, Read};

use super::messages::{Header, Layout};
use super::{Leaf, Reader};

/// Largest ratio of unpacked to packed size.
const LARGEST_RATIO: u64 = 1100;
const DEFLATE: u16 = 1;
const SHUFFLE: u16 = 2;
const CHECKSUM: u16 = 3;

/// True if all filters of a dataset are known.
pub(super) fn is_unpacked(header: &Header) -> bool {
    let known = [DEFLATE, SHUFFLE, CHECKSUM];
    header.filters.iter().all(|filter| known.contains(filter))
}

impl<'a> Reader<'a> {
    /// The numbers of a dataset.
    pub(super) fn numbers(&mut self, header: &Header<'a>, number: Number) -> Read<Vec<f64>> {
        let order = header.datatype.map_or(Order::Little, |datatype| datatype.order);
        match self.run(header)? {
            Some(run) => number.all_of(&run.in_order(order), "elements of a dataset"),
            None => Ok(number.all(&self.joined(header)?, order)),
        }
    }

    /// The bytes of all elements of a dataset.
    pub(super) fn data(&mut self, header: &Header<'a>) -> Read<Cow<'a, [u8]>> {
        match self.run(header)? {
            Some(run) => run.all("elements of a dataset"),
            None => Ok(Cow::Owned(self.joined(header)?)),
        }
    }

    /// The elements as one run of bytes; `None` if they are in chunks.
    fn run(&mut self, header: &Header<'a>) -> Read<Option<Bytes<'a>>> {
        let declared = declared_size(header);
        let there = match &header.layout {
            Some(Layout::Compact(bytes)) if declared <= bytes.len() => {
                return bytes.part(0, declared, "elements of a dataset").map(Some);
            }
            Some(Layout::Contiguous(at, size)) if declared <= *size => {
                self.first_time(*at)?;
                return self.file.part(*at, declared, "elements of a dataset").map(Some);
            }
            Some(Layout::Chunked(..)) => return Ok(None),
            Some(Layout::Compact(bytes)) => bytes.len(),
            Some(Layout::Contiguous(_, size)) => *size,
            None => 0,
        };
        Err(self.short(header, there))
    }

    fn short(&self, header: &Header, there: u64) -> Box<Fault> {
        let found = format!("a dataset of {:?} elements with {there} bytes", header.dimensions);
        Fault::damaged(self.file.place(0), found, format!("{} bytes", declared_size(header)))
    }

    /// A dataset from its chunks, unpacked one by one.
    fn joined(&mut self, header: &Header<'a>) -> Read<Vec<u8>> {
        let Some(Layout::Chunked(tree, chunk)) = &header.layout else {
            return Ok(Vec::new());
        };
        let element = element(header);
        let size = self.size_of_chunk(*tree, chunk, header)?;
        let leaves = self.leaves(*tree, 1, chunk.len() as u64)?;
        let (declared, there) = (declared_size(header), size.saturating_mul(leaves.len() as u64));
        if declared > there {
            return Err(self.short(header, there));
        }
        self.budget.count(declared, &self.file.place(*tree))?;
        for leaf in &leaves {
            self.first_time(leaf.child)?;
            let there = self.file.part(leaf.child, leaf.size.into(), "a chunk")?.len();
            if size > LARGEST_RATIO * there {
                let found = format!("a chunk of {there} bytes");
                let expected = format!("what gives {size} bytes");
                return Err(Fault::damaged(self.file.place(leaf.child), found, expected));
            }
        }
        let mut joined = vec![0; declared as usize];
        for leaf in leaves {
            let bytes = self.chunk(&leaf, header, element, size)?;
            if bytes.len() as u64 != size {
                let found = format!("a chunk of {} bytes", bytes.len());
                let expected = format!("{size} bytes");
                return Err(Fault::damaged(self.file.place(leaf.child), found, expected));
            }
            place(&bytes, &leaf.offsets, chunk, &header.dimensions, element, &mut joined);
        }
        Ok(joined)
    }

    /// Size of a chunk, bytes; its dimensions must fit the dataset.
    fn size_of_chunk(&self, tree: u64, chunk: &[u32], header: &Header) -> Read<u64> {
        let fits = chunk.split_last().is_some_and(|(last, sizes)| {
            u64::from(*last) == element(header) && sizes.len() == header.dimensions.len() && !sizes.contains(&0)
        });
        let size = chunk.iter().try_fold(1_u64, |all, &size| all.checked_mul(size.into()));
        size.filter(|_| fits).ok_or_else(|| {
            let found = format!("chunks of {chunk:?} for a dataset of {:?}", header.dimensions);
            Fault::damaged(self.file.place(tree), found, "chunks with as many dimensions")
        })
    }

    /// A chunk through its filters, the last one first.
    fn chunk(&self, leaf: &Leaf, header: &Header, element: u64, size: u64) -> Read<Vec<u8>> {
        let mut bytes = self.file.take(leaf.child, leaf.size.into(), "a chunk")?.into_owned();
        for (at, filter) in header.filters.iter().enumerate().rev() {
            if leaf.skipped >> at.min(31) & 1 != 0 {
                continue;
            }
            bytes = match *filter {
                DEFLATE => {
                    let mut unpacked = Vec::new();
                    // A checksum may still follow.
                    let outcome = ZlibDecoder::new(&bytes[..]).take(size + 4).read_to_end(&mut unpacked);
                    outcome.map_err(|error| {
                        let found = format!("packed data that end with: {error}");
                        Fault::damaged(self.file.place(leaf.child), found, "a whole chunk")
                    })?;
                    unpacked
                }
                SHUFFLE => unshuffled(&bytes, element as usize),
                // The other known one is a checksum.
                _ => bytes[..bytes.len().saturating_sub(4)].to_vec(),
            };
        }
        Ok(bytes)
    }
}

/// Elements from shuffled bytes: all first bytes, then all second ones and so on.
fn unshuffled(bytes: &[u8], element: usize) -> Vec<u8> {
    let count = bytes.len().checked_div(element).unwrap_or(0);
    let mut elements = bytes.to_vec();
    if count > 0 {
        for (place, values) in bytes[..count * element].chunks_exact(count).enumerate() {
            for (at, &value) in values.iter().enumerate() {
                elements[at * element + place] = value;
            }
        }
    }
    elements
}

/// Bytes of an element.
fn element(header: &Header) -> u64 {
    header.datatype.map_or(1, |datatype| u64::from(datatype.size))
}

/// Bytes of all elements.
fn declared_size(header: &Header) -> u64 {
    let sizes = header.dimensions.iter();
    let all = sizes.copied().try_fold(element(header), u64::checked_mul);
    all.unwrap_or(u64::MAX)
}

/// Copies a chunk, which may extend beyond the end, to its position in a dataset.
fn place(bytes: &[u8], offsets: &[u64], chunk: &[u32], dimensions: &[u64], element: u64, joined: &mut [u8]) {
    let sizes: Vec<u64> = chunk[..dimensions.len()].iter().map(|&size| u64::from(size)).collect();
    let row = sizes.last().copied().unwrap_or(1);
    for (index, part) in bytes.chunks_exact((row * element) as usize).enumerate() {
        if let Some((at, length)) = row_at(index as u64, offsets, &sizes, dimensions) {
            let (at, length) = ((at * element) as usize, (length * element) as usize);
            joined[at..at + length].copy_from_slice(&part[..length]);
        }
    }
}

/// The element of a dataset at which a row of a chunk begins, and the number of elements of the row inside the dataset.
fn row_at(mut index: u64, offsets: &[u64], sizes: &[u64], dimensions: &[u64]) -> Option<(u64, u64)> {
    let Some(last) = dimensions.len().checked_sub(1) else {
        return Some((0, 1));
    };
    let mut at = 0;
    let mut stride = 1;
    let mut length = 0;
    for dimension in (0..=last).rev() {
        let mut place = *offsets.get(dimension)?;
        if dimension < last {
            place = place.checked_add(index % sizes[dimension])?;
            index /= sizes[dimension];
        } else {
            length = sizes[dimension].min(dimensions[dimension].checked_sub(place)?);
        }
        if place >= dimensions[dimension] {
            return None;
        }
        at += place * stride;
        stride *= dimensions[dimension];
    }
    Some((at, length))
}
