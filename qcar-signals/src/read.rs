//! The door: which format a file is, by its content, and its channels.

use std::fs;
use std::io::Read as _;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::error::{Fault, Place, Read, ReadError};
use crate::signal::Recording;
use crate::{crg, csv, excel, mat, mdf, rpc, tdms, uff};

/// What a file begins with that gzip packed.
const GZIP: &[u8] = b"\x1f\x8b";

/// Reads a file of any format that this crate knows. The content decides which it is, not the file's ending.
///
/// Memory: the file, and eight bytes for each sample; of a packed file also what it unpacks to, which is at most about a
/// thousand times what is packed. Claimed sizes are checked against the bytes that are there before memory is taken for them.
///
/// # Errors
/// A file that cannot be opened, is of no known format, was cut off or is damaged, with the place in it.
pub fn read(file: &Path) -> Result<Recording, ReadError> {
    let outcome = fs::read(file).map_err(|error| {
        let remedy = "correct the path, or put the file there";
        Fault::new(Place::File, error.to_string(), "a readable file", remedy)
    });
    outcome.and_then(|bytes| recognise(&bytes)).map_err(|fault| ReadError {
        file: file.into(),
        fault,
    })
}

/// The same for the content of a file, which gzip may have packed.
///
/// # Errors
/// As [`read`], without the file.
pub fn recognise(bytes: &[u8]) -> Read<Recording> {
    if !bytes.starts_with(GZIP) {
        return unpacked(bytes);
    }
    let mut whole = Vec::new();
    match MultiGzDecoder::new(bytes).read_to_end(&mut whole) {
        Ok(_) => unpacked(&whole),
        Err(error) => Err(Fault::cut_off(
            Place::Byte(bytes.len() as u64),
            format!("packed data that end with: {error}"),
            "a whole .gz file",
        )),
    }
}

fn unpacked(bytes: &[u8]) -> Read<Recording> {
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
