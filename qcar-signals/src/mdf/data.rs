//! The records of a data group, from one or several blocks. They are read in pieces, so that they are never in memory
//! all at once.

use crate::bytes::{Bytes, Order};
use crate::content::Content;
use crate::error::{Fault, Read};

use super::Visited;
use super::block::{Block, File};
use super::packed::Packed;

/// Largest depth of nested blocks: a header list, a list, a packed block.
const DEEPEST: usize = 4;

/// Bytes in several parts, one after another.
#[derive(Default)]
pub(super) struct Data<'a> {
    parts: Vec<Part<'a>>,
    length: u64,
}

enum Part<'a> {
    Plain(Bytes<'a>),
    Packed(Packed<'a>),
}

impl<'a> Data<'a> {
    /// One part, as it is in the file.
    pub(super) fn plain(bytes: Bytes<'a>) -> Self {
        let mut data = Data::default();
        data.add(Part::Plain(bytes));
        data
    }

    /// All bytes of a data block of MDF 4 and of the blocks that it lists, in their order.
    pub(super) fn listed(file: &File<'a>, at: u64) -> Read<Self> {
        let mut data = Data::default();
        if at != 0 {
            let block = file.block(at, "a data block")?;
            gather(file, &block, DEEPEST, &mut Visited::default(), &mut data)?;
        }
        Ok(data)
    }

    fn add(&mut self, part: Part<'a>) {
        let length = match &part {
            Part::Plain(bytes) => bytes.len(),
            Part::Packed(packed) => packed.length,
        };
        self.length = self.length.saturating_add(length);
        self.parts.push(part);
    }

    /// Total number of bytes; for packed parts, the declared unpacked size.
    pub(super) fn len(&self) -> u64 {
        self.length
    }

    /// True if all of these bytes are in the file, so that memory may be allocated for them.
    pub(super) fn is_there(&self) -> bool {
        self.parts.iter().all(|part| matches!(part, Part::Plain(_)))
    }

    /// Passes the first `count` bytes to a function, in pieces of a whole number of `unit` bytes except the last.
    pub(super) fn pieces(&self, count: u64, unit: usize, mut show: impl FnMut(&[u8])) -> Read<()> {
        let mut pieces = Pieces {
            left: count,
            unit,
            rest: Vec::new(),
            show: &mut show,
        };
        for part in &self.parts {
            match part {
                _ if pieces.left == 0 => break,
                Part::Plain(bytes) => pieces.add(bytes)?,
                Part::Packed(packed) => {
                    let unpacked = Content::of_bytes(packed.unpacked()?);
                    pieces.add(&Bytes::of_file(&unpacked, Order::Little))?;
                }
            }
        }
        let rest = pieces.rest;
        if !rest.is_empty() {
            show(&rest);
        }
        Ok(())
    }
}

fn gather<'a>(file: &File<'a>, block: &Block<'a>, depth: usize, visited: &mut Visited, all: &mut Data<'a>) -> Read<()> {
    visited.first_time(block.at)?;
    match &block.id {
        b"##DT" | b"##SD" => all.add(Part::Plain(block.data)),
        b"##DZ" => {
            let packed = Packed::of(block)?;
            file.budget.count(packed.length, &block.place())?;
            all.add(Part::Packed(packed));
        }
        b"##HL" if depth > 0 => gather(
            file,
            &file.block(block.link(0), "a list of data")?,
            depth - 1,
            visited,
            all,
        )?,
        b"##DL" if depth > 0 => {
            let mut list = block.clone();
            loop {
                for &part in list.links.iter().skip(1).filter(|&&part| part != 0) {
                    gather(file, &file.block(part, "a data block")?, depth - 1, visited, all)?;
                }
                if list.link(0) == 0 {
                    break;
                }
                list = file.named(list.link(0), b"##DL", "the next list of data")?;
                visited.first_time(list.at)?;
            }
        }
        other => {
            let found = format!("a block `{}`", crate::bytes::text(other));
            let remedy = "export the recording with data in rows (##DT, ##DZ, ##DL)";
            return Err(Fault::new(block.place(), found, "a block of records", remedy));
        }
    }
    Ok(())
}

/// Divides parts into pieces of another size.
struct Pieces<'s> {
    /// Number of bytes that remain.
    left: u64,
    unit: usize,
    /// The beginning of a piece whose end is in the next part.
    rest: Vec<u8>,
    show: &'s mut dyn FnMut(&[u8]),
}

impl Pieces<'_> {
    fn add(&mut self, part: &Bytes) -> Read<()> {
        let (count, unit) = (part.len().min(self.left), self.unit as u64);
        self.left -= count;
        let lacking = match self.rest.len() as u64 {
            0 => 0,
            there => (unit - there).min(count),
        };
        self.rest.extend_from_slice(&part.take(0, lacking, "records")?);
        if self.rest.len() == self.unit {
            (self.show)(&self.rest);
            self.rest.clear();
        }
        let whole = (count - lacking) / unit * unit;
        part.pieces(lacking, whole, unit, "records", &mut self.show)?;
        let after = lacking + whole;
        self.rest
            .extend_from_slice(&part.take(after, count - after, "records")?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Bytes, Content, Data, Order, Part};

    #[test]
    fn records_across_several_parts_are_joined() {
        let bytes: Vec<u8> = (0..100).collect();
        for cuts in [&[][..], &[50], &[1, 2, 3], &[10, 10, 11, 97], &[99]] {
            let ends = cuts.iter().copied().chain([100]);
            let begins = [0].into_iter().chain(cuts.iter().copied());
            let contents: Vec<Content<'_>> = begins
                .zip(ends)
                .map(|(from, to)| Content::of_bytes(&bytes[from..to]))
                .collect();
            let mut data = Data::default();
            for content in &contents {
                data.add(Part::Plain(Bytes::of_file(content, Order::Little)));
            }
            for (unit, count) in [(1, 100), (7, 98), (7, 100), (30, 90), (100, 100), (30, 0)] {
                let mut shown = Vec::new();
                data.pieces(count, unit, |piece| {
                    assert!(piece.len() % unit == 0 || shown.len() + piece.len() == count as usize);
                    shown.extend_from_slice(piece);
                })
                .unwrap();
                assert_eq!(shown, bytes[..count as usize], "{cuts:?} {unit}");
            }
        }
    }
}
