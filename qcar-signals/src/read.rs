//! Entry point: recognises the format of a file by its content, and reads its channels.

use std::fs::File;
use std::io;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::bytes::{Bytes, Order};
use crate::content::Content;
use crate::error::{Fault, Place, Read, ReadError};
use crate::find::Wanted;
use crate::limit::Budget;
use crate::signal::Recording;
use crate::{crg, csv, excel, mat, mdf, rpc, tdms, uff};

/// First bytes of a file compressed by gzip.
const GZIP: &[u8] = b"\x1f\x8b";

/// Reads a file of any format of this crate, also compressed by gzip. The content determines the format, not the name.
///
/// Memory: eight bytes for each sample, two for RPC III; for a packed or text file also its unpacked size, up to the
/// limit of [`limit::of_unpacked`](crate::limit::of_unpacked). Declared sizes are checked against the existing bytes
/// before memory is allocated.
///
/// # Errors
/// Fails if the file cannot be opened, has an unknown format, is cut off, damaged, packed twice or unpacks to
/// more than the limit, with the position.
pub fn read(file: &Path) -> Result<Recording, ReadError> {
    let opened = File::open(file).and_then(Content::of_file);
    let recognised = opened.map_err(|error| unreadable(&error)).and_then(|content| {
        let beginning = content.beginning().map_err(|error| unreadable(&error))?;
        if !is_packed(&beginning) {
            return channels(&content, &Wanted::All);
        }
        let packed = content.take(0, content.length()).map_err(|error| unreadable(&error))?;
        channels(&Content::of_bytes(whole(&packed)?), &Wanted::All)
    });
    recognised.map_err(|fault| ReadError {
        file: file.into(),
        fault,
    })
}

fn unreadable(error: &io::Error) -> Box<Fault> {
    let remedy = "correct the path, or put the file there";
    Fault::new(Place::File, error.to_string(), "a readable file", remedy)
}

/// True for content compressed by gzip, from its first bytes.
pub fn is_packed(beginning: &[u8]) -> bool {
    beginning.starts_with(GZIP)
}

/// Unpacks gzip while reading; errors are those of `packed`, and of data that are cut off or damaged.
pub fn unpacked<R: io::Read>(packed: R) -> impl io::Read {
    MultiGzDecoder::new(packed)
}

fn whole(packed: &[u8]) -> Read<Vec<u8>> {
    let length = packed.len() as u64;
    Budget::of_file(length).unpack(unpacked(packed), &Place::File, |error| {
        Fault::cut_off(
            Place::Byte(length),
            format!("packed data that end with: {error}"),
            "a whole .gz file",
        )
    })
}

/// The same for the content of a file, unpacked.
///
/// # Errors
/// Fails as [`read`] does, without the name of the file.
pub fn recognise(bytes: &[u8]) -> Read<Recording> {
    channels(&Content::of_bytes(bytes), &Wanted::All)
}

/// The same with the samples of the wanted channels only, if the format allows skipping the others; all channels are
/// listed. Memory as in [`read`], for these samples and their times.
///
/// # Errors
/// Fails as [`recognise`] does; faults in samples that are not wanted may not be detected.
pub fn channels(content: &Content, wanted: &Wanted) -> Read<Recording> {
    let beginning = content.beginning().map_err(|error| unreadable(&error))?;
    let file = Bytes::of_file(content, Order::Little);
    if is_packed(&beginning) {
        let remedy = "unpack the file once with gzip";
        return Err(Fault::new(
            Place::File,
            "packed data within packed data",
            "a measured file, packed once at most",
            remedy,
        ));
    }
    if beginning.is_empty() {
        let remedy = "copy it again from where it was recorded";
        return Err(Fault::new(Place::File, "an empty file", "a measured file", remedy));
    }
    if beginning.starts_with(mdf::MAGIC) || beginning.starts_with(mdf::UNFINISHED) {
        return mdf::read(file, wanted);
    }
    if beginning.starts_with(tdms::MAGIC) {
        return tdms::read(file, wanted);
    }
    if mat::is_mat(&beginning) || mat::is_hdf5(&beginning) {
        return mat::read(file, wanted);
    }
    if rpc::is_rpc(&beginning) {
        return rpc::read(file, wanted);
    }
    in_memory(&file.all("the file")?)
}

/// A file of a format that is read as a whole.
fn in_memory(bytes: &[u8]) -> Read<Recording> {
    if bytes.starts_with(excel::MAGIC) {
        return excel::read(bytes);
    }
    if bytes.starts_with(excel::OLD_MAGIC) {
        return Err(excel::refuse_old());
    }
    if uff::is_uff(bytes) {
        return uff::read(bytes);
    }
    if crg::is_crg(bytes) {
        return crg::read(bytes);
    }
    csv::read(bytes)
}
