//! The door: which format a file is, by its content, and its channels.

use std::fs;
use std::io;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::error::{Fault, Place, Read, ReadError};
use crate::signal::Recording;
use crate::{crg, csv, excel, mat, mdf, rpc, tdms, uff};

/// What a file begins with that gzip packed.
const GZIP: &[u8] = b"\x1f\x8b";

/// Reads a file of any format that this crate knows, which gzip may have packed. The content decides which it is, not the
/// file's ending.
///
/// Memory: the file, and eight bytes for each sample; of a packed file also what it unpacks to, which is at most about a
/// thousand times what is packed. Claimed sizes are checked against the bytes that are there before memory is taken for them.
///
/// # Errors
/// A file that cannot be opened, is of no known format, was cut off, is damaged or packed twice, with the place in it.
pub fn read(file: &Path) -> Result<Recording, ReadError> {
    let outcome = fs::read(file).map_err(|error| {
        let remedy = "correct the path, or put the file there";
        Fault::new(Place::File, error.to_string(), "a readable file", remedy)
    });
    let recognised = outcome.and_then(|bytes| match is_packed(&bytes) {
        false => recognise(&bytes),
        true => recognise(&whole(unpacked(&bytes[..]), bytes.len())?),
    });
    recognised.map_err(|fault| ReadError {
        file: file.into(),
        fault,
    })
}

/// True of what gzip has packed, by its first bytes.
pub fn is_packed(beginning: &[u8]) -> bool {
    beginning.starts_with(GZIP)
}

/// What gzip has packed, unpacked as it is read; errors of reading are those of `packed`, and of data that are cut off or damaged.
pub fn unpacked<R: io::Read>(packed: R) -> impl io::Read {
    MultiGzDecoder::new(packed)
}

fn whole(mut content: impl io::Read, packed: usize) -> Read<Vec<u8>> {
    let mut whole = Vec::new();
    match content.read_to_end(&mut whole) {
        Ok(_) => Ok(whole),
        Err(error) => Err(Fault::cut_off(
            Place::Byte(packed as u64),
            format!("packed data that end with: {error}"),
            "a whole .gz file",
        )),
    }
}

/// The same for the content of a file, unpacked.
///
/// # Errors
/// As [`read`], without the file.
pub fn recognise(bytes: &[u8]) -> Read<Recording> {
    if is_packed(bytes) {
        let remedy = "unpack the file once with gzip";
        return Err(Fault::new(
            Place::File,
            "packed data within packed data",
            "a measured file, packed once at most",
            remedy,
        ));
    }
    if bytes.is_empty() {
        let remedy = "copy it again from where it was recorded";
        return Err(Fault::new(Place::File, "an empty file", "a measured file", remedy));
    }
    if bytes.starts_with(mdf::MAGIC) || bytes.starts_with(mdf::UNFINISHED) {
        return mdf::read(bytes);
    }
    if bytes.starts_with(tdms::MAGIC) {
        return tdms::read(bytes);
    }
    if bytes.starts_with(excel::MAGIC) {
        return excel::read(bytes);
    }
    if bytes.starts_with(excel::OLD_MAGIC) {
        return Err(excel::refuse_old());
    }
    if mat::is_mat(bytes) || mat::is_hdf5(bytes) {
        return mat::read(bytes);
    }
    if rpc::is_rpc(bytes) {
        return rpc::read(bytes);
    }
    if uff::is_uff(bytes) {
        return uff::read(bytes);
    }
    if crg::is_crg(bytes) {
        return crg::read(bytes);
    }
    csv::read(bytes)
}
