//! The blocks of MDF 4: id 4, reserved 4, length 8, number of links 8, links of 8 each, data.

use crate::bytes::{Bytes, Order, text};
use crate::error::{Fault, Place, Read};
use crate::limit::Budget;

/// Bytes before the links.
const HEAD: u64 = 24;
/// Largest size of a name or unit, with its XML, bytes.
const LONGEST_TEXT: u64 = 65_536;

/// A file as blocks.
pub(super) struct File<'a> {
    pub(super) bytes: Bytes<'a>,
    pub(super) budget: Budget,
}

/// A block, whose size was checked against the file.
#[derive(Clone)]
pub(super) struct Block<'a> {
    pub(super) at: u64,
    pub(super) id: [u8; 4],
    pub(super) links: Vec<u64>,
    pub(super) data: Bytes<'a>,
}

impl<'a> File<'a> {
    /// The block of a link; `what` describes the expected block.
    pub(super) fn block(&self, at: u64, what: &str) -> Read<Block<'a>> {
        if at >= self.bytes.len() {
            let found = format!(
                "a link to {what} at byte {at}, beyond the end of the file ({} bytes)",
                self.bytes.len()
            );
            return Err(Fault::cut_off(Place::Byte(at), found, what));
        }
        let head = self.bytes.part(at, HEAD, what)?;
        let mut id = [0; 4];
        id.copy_from_slice(&head.take(0, 4, what)?);
        let (length, count) = (head.u64(8, "a length")?, head.u64(16, "a number of links")?);
        let data_at = count
            .checked_mul(8)
            .and_then(|links| links.checked_add(HEAD))
            .filter(|&at| at <= length);
        let Some(data_at) = data_at.filter(|_| id.starts_with(b"##")) else {
            let found = format!("a block `{}` of {length} bytes with {count} links", text(&id));
            return Err(Fault::damaged(Place::Byte(at), found, what));
        };
        let whole = self.bytes.part(at, length, &format!("{what} (`{}`)", text(&id)))?;
        let links = whole.part(HEAD, data_at - HEAD, "links")?;
        let links = links.all("links")?;
        let links = links.chunks_exact(8).filter_map(|link| link.first_chunk());
        Ok(Block {
            at,
            id,
            links: links.map(|link| u64::from_le_bytes(*link)).collect(),
            data: whole.part(data_at, length - data_at, "data of a block")?,
        })
    }

    /// The same; it must have this id.
    pub(super) fn named(&self, at: u64, id: &[u8; 4], what: &str) -> Read<Block<'a>> {
        let block = self.block(at, what)?;
        if block.id == *id {
            return Ok(block);
        }
        let (found, expected) = (
            format!("a block `{}`", text(&block.id)),
            format!("{what} (`{}`)", text(id)),
        );
        Err(Fault::damaged(block.place(), found, expected))
    }

    /// The text of a link; empty without a link. In XML, the text between `<TX>` and `</TX>`.
    pub(super) fn text(&self, at: u64) -> Read<String> {
        if at == 0 {
            return Ok(String::new());
        }
        let block = self.block(at, "a text")?;
        if block.data.len() > LONGEST_TEXT {
            let found = format!("a text of {} bytes", block.data.len());
            return Err(Fault::damaged(
                block.place(),
                found,
                format!("a name or a unit of at most {LONGEST_TEXT} bytes"),
            ));
        }
        let text = crate::bytes::field(&block.data.all("a text")?);
        if block.id != *b"##MD" {
            return Ok(text);
        }
        let inner = text.split_once("<TX>").and_then(|(_, rest)| rest.split_once("</TX>"));
        let inner = inner.map_or("", |(inner, _)| inner).trim();
        let entities = [
            ("&lt;", "<"),
            ("&gt;", ">"),
            ("&quot;", "\""),
            ("&apos;", "'"),
            ("&amp;", "&"),
        ];
        Ok(entities
            .iter()
            .fold(inner.to_string(), |text, (entity, own)| text.replace(entity, own)))
    }
}

impl Block<'_> {
    /// A link; 0 if there is none.
    pub(super) fn link(&self, index: usize) -> u64 {
        self.links.get(index).copied().unwrap_or(0)
    }

    pub(super) fn place(&self) -> Place {
        Place::Byte(self.at)
    }

    /// Numbers of double precision from a byte of the data on.
    pub(super) fn doubles(&self, at: u64, count: u64) -> Read<Vec<f64>> {
        let bytes = self.data.take(at, count.saturating_mul(8), "values")?;
        Ok(crate::bytes::Number::F64.all(&bytes, Order::Little))
    }
}
