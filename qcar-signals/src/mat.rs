//! MAT-files of MATLAB: version 4, versions 5 to 7, and 7.3, which is HDF5.

// Values that all versions share.
mod value;
// Version 4.
mod v4;
// Versions 5 to 7.
mod v5;
// Version 7.3.
mod hdf5;
// Writing of version 5.
pub mod write;
// From variables to channels, for the layouts that programs write.
mod layout;

use crate::bytes::{Bytes, field};
use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::signal::Recording;

/// Position of the version and the byte order in the header of version 5.
const VERSION: usize = 124;
/// Bytes of a header; in a file of version 7.3 HDF5 begins at byte 512.
pub(crate) const HEADER: usize = 128;

/// True if a file begins as a MAT-file of version 4, or with the header of a later one.
pub(crate) fn is_mat(bytes: &[u8]) -> bool {
    let has_header = bytes.len() >= HEADER && matches!(&bytes[VERSION + 2..HEADER], b"IM" | b"MI");
    has_header && bytes[..4] != [0; 4] || v4::begins(bytes)
}

/// True for HDF5 without the header of MATLAB; 512 bytes of anything else may stand before it.
pub(crate) fn is_hdf5(bytes: &[u8]) -> bool {
    let begins = |at: usize| bytes.get(at..).is_some_and(|rest| rest.starts_with(hdf5::SIGNATURE));
    begins(0) || begins(512)
}

/// Reads a file that begins as a MAT-file, or is HDF5.
pub(crate) fn read(file: Bytes, wanted: &Wanted) -> Read<Recording> {
    if let Some(at) = hdf5::superblock(&file) {
        let name = if at == 0 { "HDF5" } else { "MAT 7.3" };
        return layout::recording(name, hdf5::variables(&file, at, wanted)?, wanted);
    }
    let beginning = file.take(0, file.len().min(HEADER as u64), "a variable")?;
    if v4::begins(&beginning) {
        return layout::recording("MAT 4", v4::variables(&file, wanted)?, wanted);
    }
    match field(&file.take(0, VERSION as u64, "the header")?) {
        text if text.contains("7.3") => Err(Fault::cut_off(
            Place::Byte(file.len()),
            "a header of version 7.3 without HDF5 data",
            "the data after the header",
        )),
        _ => layout::recording("MAT 5", v5::variables(file, wanted)?, wanted),
    }
}
