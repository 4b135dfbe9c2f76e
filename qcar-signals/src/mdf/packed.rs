//! Data blocks of MDF 4: plain, in lists, deflated, and transposed before that.

use std::borrow::Cow;
use std::io::Read as _;

use flate2::read::ZlibDecoder;

use crate::error::{Fault, Read};

use super::Visited;
use super::block::{Block, File};

/// Blocks within blocks: a header list, a list, a packed block.
const DEEPEST: usize = 4;

/// All bytes of a data block and of what it lists, in their order.
pub(super) fn data<'a>(file: &File<'a>, at: u64) -> Read<Cow<'a, [u8]>> {
    if at == 0 {
        return Ok(Cow::Borrowed(&[]));
    }
    let block = file.block(at, "a data block")?;
    if matches!(&block.id, b"##DT" | b"##SD") {
        return Ok(Cow::Borrowed(block.data.data));
    }
    let mut all = Vec::new();
    gather(file, &block, DEEPEST, &mut Visited::default(), &mut all)?;
    Ok(Cow::Owned(all))
}

fn gather(file: &File, block: &Block, depth: usize, visited: &mut Visited, all: &mut Vec<u8>) -> Read<()> {
    visited.first_time(block.at)?;
    match &block.id {
        b"##DT" | b"##SD" => all.extend_from_slice(block.data.data),
        b"##DZ" => all.append(&mut unpacked(block)?),
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

/// What a packed block holds: original id 2, way of packing 1, reserved 1, parameter 4, unpacked length 8, length 8, data.
fn unpacked(block: &Block) -> Read<Vec<u8>> {
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
    let mut bytes = Vec::new();
    let outcome = ZlibDecoder::new(packed.data).take(length).read_to_end(&mut bytes);
    if outcome.is_err() || bytes.len() as u64 != length {
        let found = format!("packed data of {} bytes that give {} bytes", packed.len(), bytes.len());
        return Err(Fault::damaged(block.place(), found, format!("{length} bytes")));
    }
    Ok(if way == 1 {
        transposed_back(&bytes, parameter)
    } else {
        bytes
    })
}

/// Records of `width` bytes from their transpose: all first bytes, all second ones and so on. What does not fill a record
/// stands after it as it was.
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
