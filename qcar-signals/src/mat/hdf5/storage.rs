//! The bytes of a dataset, from wherever they lie.

use std::borrow::Cow;
use std::io::Read as _;

use flate2::read::ZlibDecoder;

use crate::error::{Fault, Read};

use super::messages::{Header, Layout};
use super::{Leaf, Reader, too_new};

const DEFLATE: u16 = 1;
const SHUFFLE: u16 = 2;
const CHECKSUM: u16 = 3;

impl<'a> Reader<'a> {
    /// All elements of a dataset and its dimensions.
    pub(super) fn data(&mut self, header: &Header<'a>) -> Read<(Cow<'a, [u8]>, Vec<u64>)> {
        let element = header.datatype.map_or(1, |datatype| u64::from(datatype.size));
        let dimensions = header.dimensions.clone();
        let promised = dimensions
            .iter()
            .try_fold(element, |all, &size| all.checked_mul(size))
            .unwrap_or(u64::MAX);
        let (there, bytes) = match &header.layout {
            Some(Layout::Compact(bytes)) => (bytes.len() as u64, Cow::Borrowed(*bytes)),
            Some(Layout::Contiguous(at, size)) if promised <= *size => {
                self.first_time(*at)?;
                (
                    promised,
                    Cow::Borrowed(self.file.take(*at, promised, "elements of a dataset")?),
                )
            }
            Some(Layout::Contiguous(_, size)) => (*size, Cow::Borrowed(&[][..])),
            Some(Layout::Chunked(tree, chunk)) => {
                let chunks = self.chunks(*tree, chunk, header, element)?;
                let there = chunks.iter().map(|(_, bytes)| bytes.len() as u64).sum();
                let joined = if promised <= there {
                    join(&chunks, chunk, &dimensions, element)
                } else {
                    Vec::new()
                };
                (there, Cow::Owned(joined))
            }
            None => (0, Cow::Borrowed(&[][..])),
        };
        if promised > there {
            let found = format!("a dataset of {dimensions:?} elements with {there} bytes");
            return Err(Fault::damaged(self.file.place(0), found, format!("{promised} bytes")));
        }
        Ok((bytes, dimensions))
    }

    /// The chunks of a dataset, unpacked, with where they begin.
    fn chunks(&mut self, tree: u64, chunk: &[u32], header: &Header, element: u64) -> Read<Vec<(Vec<u64>, Vec<u8>)>> {
        let fits = chunk.split_last().is_some_and(|(last, sizes)| {
            u64::from(*last) == element && sizes.len() == header.dimensions.len() && !sizes.contains(&0)
        });
        let size = chunk.iter().try_fold(1_u64, |all, &size| all.checked_mul(size.into()));
        let Some(size) = size.filter(|_| fits) else {
            let found = format!("chunks of {chunk:?} for a dataset of {:?}", header.dimensions);
            return Err(Fault::damaged(
                self.file.place(tree),
                found,
                "chunks with as many dimensions",
            ));
        };
        let leaves = self.leaves(tree, 1, chunk.len() as u64)?;
        let mut chunks = Vec::new();
        for leaf in leaves {
            self.first_time(leaf.child)?;
            let bytes = self.chunk(&leaf, header, element, size)?;
            if bytes.len() as u64 != size {
                let found = format!("a chunk of {} bytes", bytes.len());
                return Err(Fault::damaged(
                    self.file.place(leaf.child),
                    found,
                    format!("{size} bytes"),
                ));
            }
            chunks.push((leaf.offsets, bytes));
        }
        Ok(chunks)
    }

    /// A chunk through its filters, the last one first.
    fn chunk(&self, leaf: &Leaf, header: &Header, element: u64, size: u64) -> Read<Vec<u8>> {
        let mut bytes = self.file.take(leaf.child, leaf.size.into(), "a chunk")?.to_vec();
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
                CHECKSUM => bytes[..bytes.len().saturating_sub(4)].to_vec(),
                other => {
                    return Err(too_new(
                        &self.file,
                        leaf.child,
                        format!("data packed by filter {other}"),
                    ));
                }
            };
        }
        Ok(bytes)
    }
}

/// Elements from all first bytes, then all second ones and so on.
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

/// A dataset from its chunks, each of which may stand out over its end.
fn join(chunks: &[(Vec<u64>, Vec<u8>)], chunk: &[u32], dimensions: &[u64], element: u64) -> Vec<u8> {
    let all = dimensions.iter().product::<u64>() * element;
    let mut joined = vec![0; all as usize];
    let sizes: Vec<u64> = chunk[..dimensions.len()].iter().map(|&size| u64::from(size)).collect();
    let row = sizes.last().copied().unwrap_or(1);
    for (offsets, bytes) in chunks {
        for (index, part) in bytes.chunks_exact((row * element) as usize).enumerate() {
            let Some((at, length)) = row_at(index as u64, offsets, &sizes, dimensions) else {
                continue;
            };
            let (at, length) = ((at * element) as usize, (length * element) as usize);
            joined[at..at + length].copy_from_slice(&part[..length]);
        }
    }
    joined
}

/// The element of a dataset at which a row of a chunk begins, and how many of the row lie within it.
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
