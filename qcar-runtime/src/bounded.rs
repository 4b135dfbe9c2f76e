//! Files that are read no further than a limit, so that no file can fill the memory, whatever it unpacks to.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use qcar_signals::read::packed;

/// Bytes of a text or of an unpacked file that are read, unless [`VARIABLE`] says otherwise.
const MOST: u64 = 256 << 20;

/// The same of a measured file that is not packed, and so cannot become larger than its disk.
const MOST_PLAIN: u64 = 4 << 30;

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
    let left = limit().unwrap_or(MOST);
    Limited { inner, left }
}

/// The limit that the user has set, bytes.
fn limit() -> Option<u64> {
    let given = std::env::var(VARIABLE).ok()?.parse::<u64>().ok()?;
    Some(given.saturating_mul(1 << 20))
}

/// The content of a measured file, which gzip may have packed.
///
/// # Errors
/// As [`open`]; more than 4 GiB, or more than 256 MiB unpacked, unless another limit is set; too little memory.
pub fn measured(path: &Path) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let size = file.metadata()?.len();
    let left = limit().unwrap_or(MOST_PLAIN);
    if size > left {
        return Err(too_large());
    }
    // All of its place at once: a vector that grows takes up to twice as much.
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(size as usize)?;
    file.take(left.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > left {
        return Err(too_large());
    }
    let Some(content) = packed(&bytes) else {
        return Ok(bytes);
    };
    let mut whole = Vec::new();
    limited(content).read_to_end(&mut whole)?;
    Ok(whole)
}

/// What to do about an error of [`measured`]: raise the limit, or what `else_do` says.
pub fn remedy<'a>(error: &io::Error, else_do: &'a str) -> &'a str {
    match error.kind() {
        ErrorKind::FileTooLarge => "if the file is what it should be, raise the limit",
        ErrorKind::OutOfMemory => "close other programs, or split the file",
        _ => else_do,
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
        self.left = self.left.checked_sub(read as u64).ok_or_else(too_large)?;
        Ok(read)
    }
}

fn too_large() -> io::Error {
    let said = format!("more bytes than the limit allows; set {VARIABLE} to a larger number of MiB");
    io::Error::new(ErrorKind::FileTooLarge, said)
}
