//! The entry point: the format of a file, recognised by its content, and its channels.

use std::fs::File;
use std::io;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::bytes::{Bytes, Order};
use crate::content::Content;
use crate::error::{Fault, Place, Read, ReadError};
use crate::find::Wanted;
use crate::signal::Recording;
use crate::{crg, csv, excel, mat, mdf, rpc, tdms, uff};

/// What a file begins with that gzip packed.
const GZIP: &[u8] = b"\x1f\x8b";

/// Reads a file of any format that this crate knows, which gzip may have packed. The content decides which it is, not the
/// file's ending.
///
/// Memory: eight bytes for each sample, two for each of RPC III; of a file that is packed or text also what it unpacks to, which
/// is at most about a thousand times what is packed. Claimed sizes are checked against the bytes that are there before memory is
/// taken for them.
///
/// # Errors
/// A file that cannot be opened, is of no known format, was cut off, is damaged or packed twice, with the place in it.
pub fn read(file: &Path) -> Result<Recording, ReadError> {
    let opened = File::open(file).and_then(Content::of_file);
    let recognised = opened.map_err(|error| unreadable(&error)).and_then(|content| {
        let beginning = content.beginning().map_err(|error| unreadable(&error))?;
        if !is_packed(&beginning) {
            return channels(&content, &Wanted::All);
        }
        let packed = content.take(0, content.length()).map_err(|error| unreadable(&error))?;
        channels(
            &Content::of_bytes(whole(unpacked(&packed[..]), packed.len())?),
            &Wanted::All,
        )
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
    channels(&Content::of_bytes(bytes), &Wanted::All)
}

/// The same with the samples of the wanted channels alone, where the format lets the others be left out; all channels are listed.
/// Memory as in [`read`], for these samples and the times of them.
///
/// # Errors
/// As [`recognise`]; what is wrong with samples that are not wanted may go unseen.
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

/// A file of a format that is read from the first byte to the last.
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
