//! Files that are read no further than a limit, so that no file can fill the memory, whatever it unpacks to.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Bytes of a text or of an unpacked table that are read, unless [`VARIABLE`] says otherwise.
const MOST: u64 = 256 << 20;

/// The environment variable with another limit, in MiB.
const VARIABLE: &str = "QCAR_MAX_MIB";

/// Opens a file that is neither a folder nor a device nor a pipe, which might never end.
///
/// # Errors
/// What the system says, and anything but a regular file.
pub fn open(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_file() {
        File::open(path)
    } else if kind.is_dir() {
        Err(io::Error::new(ErrorKind::IsADirectory, "a folder"))
    } else {
        Err(io::Error::new(ErrorKind::InvalidInput, "a pipe or device"))
    }
}

/// What comes from `inner`, with an error of [`ErrorKind::FileTooLarge`] where that goes beyond the limit.
pub fn limited<R: Read>(inner: R) -> impl Read {
    let given = std::env::var(VARIABLE).ok().and_then(|text| text.parse::<u64>().ok());
    Limited {
        inner,
        left: given.map_or(MOST, |mebibytes| mebibytes.saturating_mul(1 << 20)),
    }
}

/// A text file.
///
/// # Errors
/// As [`open`] and [`limited`], and bytes that are not UTF-8.
pub fn text(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    limited(open(path)?).read_to_string(&mut text)?;
    Ok(text)
}

struct Limited<R> {
    inner: R,
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(buffer)?;
        let too_large = || {
            let said = format!("more bytes than the limit allows; set {VARIABLE} to a larger number of MiB");
            io::Error::new(ErrorKind::FileTooLarge, said)
        };
        self.left = self.left.checked_sub(read as u64).ok_or_else(too_large)?;
        Ok(read)
    }
}
