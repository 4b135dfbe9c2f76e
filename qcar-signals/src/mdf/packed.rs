//! Packed data blocks of MDF 4: compressed by Deflate, possibly after a transposition.

use std::io::Read as _;

use flate2::read::ZlibDecoder;

use crate::bytes::Bytes;
use crate::error::{Fault, Place, Read};

use super::block::Block;

/// Largest ratio of unpacked to packed size.
const LARGEST_RATIO: u64 = 1100;

/// A packed block that is not unpacked yet.
pub(super) struct Packed<'a> {
    place: Place,
    packed: Bytes<'a>,
    /// Bytes of the records before they were packed.
    pub(super) length: u64,
    /// Bytes of a row if the data were transposed before packing.
    transposed: Option<usize>,
}

impl<'a> Packed<'a> {
    /// Original id 2, way of packing 1, reserved 1, parameter 4, unpacked length 8, length 8, data.
    pub(super) fn of(block: &Block<'a>) -> Read<Self> {
        let data = block.data;
        let way = data.u8(2, "the way of packing")?;
        let parameter = data.u32(4, "the parameter of packing")? as usize;
        let length = data.u64(8, "the unpacked length")?;
        let packed = data.part(24, data.u64(16, "the packed length")?, "packed data")?;
        if way > 1 {
            let remedy = "export the recording packed with Deflate, or not packed";
            return Err(Fault::new(
                block.place(),
                format!("packing of kind {way}"),
                "kind 0 or 1 (Deflate)",
                remedy,
            ));
        }
        let own = Packed {
            place: block.place(),
            packed,
            length,
            transposed: (way == 1).then_some(parameter),
        };
        match length > LARGEST_RATIO.saturating_mul(packed.len()) {
            true => Err(own.damaged("can give less than that")),
            false => Ok(own),
        }
    }

    fn damaged(&self, outcome: &str) -> Box<Fault> {
        let found = format!("packed data of {} bytes that {outcome}", self.packed.len());
        Fault::damaged(self.place.clone(), found, format!("{} bytes", self.length))
    }

    /// The unpacked data.
    pub(super) fn unpacked(&self) -> Read<Vec<u8>> {
        let packed = self.packed.all("packed data")?;
        let mut bytes = Vec::new();
        let outcome = ZlibDecoder::new(&*packed).take(self.length).read_to_end(&mut bytes);
        if outcome.is_err() || bytes.len() as u64 != self.length {
            return Err(self.damaged(&format!("give {} bytes", bytes.len())));
        }
        Ok(match self.transposed {
            Some(width) => transposed_back(&bytes, width),
            None => bytes,
        })
    }
}

/// Records of `width` bytes from their transpose: all first bytes, all second ones and so on. Bytes after the last
/// whole record are not transposed.
fn transposed_back(bytes: &[u8], width: usize) -> Vec<u8> {
    let records = bytes.len().checked_div(width).unwrap_or(0);
    let mut rows = bytes.to_vec();
    if records > 1 {
        for (column, values) in bytes[..records * width].chunks_exact(records).enumerate() {
            for (row, &value) in values.iter().enumerate() {
                rows[row * width + column] = value;
            }
        }
    }
    rows
}
