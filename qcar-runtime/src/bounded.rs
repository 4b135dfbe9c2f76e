//! Reads files up to a limit, so that no file can fill the memory, even when unpacked.

use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read};
use std::path::Path;

use qcar_signals::content::Content;
use qcar_signals::limit::{VARIABLE, given, of_unpacked};
use qcar_signals::read::{is_packed, unpacked};

use crate::error::{InputError, Place, Problem};

/// Largest size of a text, bytes, unless [`VARIABLE`] sets another.
const MOST: u64 = 256 << 20;

/// Largest size of a measured file that is not packed, whose size is limited by its disk.
const MOST_PLAIN: u64 = 4 << 30;

/// Opens a regular file: not a folder, a device or a pipe, which might never end.
///
/// # Errors
/// Fails with the error of the system, or if it is no regular file.
pub fn open(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path).map_err(in_words)?.file_type();
    if kind.is_file() {
        File::open(path).map_err(in_words)
    } else if kind.is_dir() {
        Err(io::Error::new(ErrorKind::IsADirectory, "a folder"))
    } else {
        Err(io::Error::new(ErrorKind::InvalidInput, "a pipe or device"))
    }
}

/// The common errors of the system in words for a message.
fn in_words(error: io::Error) -> io::Error {
    let words = match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => "no such file",
        ErrorKind::PermissionDenied => "a file without permission to read it",
        _ => return error,
    };
    io::Error::new(error.kind(), words)
}

/// The content of a file other than a measured file, with an error of [`ErrorKind::FileTooLarge`] beyond the limit.
fn limited(inner: impl Read) -> impl Read {
    let left = given().unwrap_or(MOST);
    Limited { inner, left }
}

/// The same for a file that is packed.
fn limited_unpacked(file: File) -> io::Result<impl Read> {
    let left = of_unpacked(file.metadata()?.len());
    let inner = unpacked(BufReader::new(file));
    Ok(Limited { inner, left })
}

/// The content of a measured file, unpacked if it is compressed by gzip; otherwise it stays on the disk until it is
/// read.
///
/// # Errors
/// Fails as [`open`] does, beyond 4 GiB or what a packed file may give (unless another limit is set), or without enough
/// memory.
fn measured(path: &Path) -> io::Result<Content<'static>> {
    let file = open(path)?;
    if file.metadata()?.len() > given().unwrap_or(MOST_PLAIN) {
        return Err(too_large());
    }
    let content = Content::of_file(file)?;
    if !is_packed(&content.beginning()?) {
        return Ok(content);
    }
    let mut whole = Vec::new();
    limited_unpacked(open(path)?)?.read_to_end(&mut whole)?;
    Ok(Content::of_bytes(whole))
}

/// Remedy for an error of [`measured`]: raise the limit, or `else_do`.
fn remedy<'a>(error: &io::Error, else_do: &'a str) -> &'a str {
    match error.kind() {
        ErrorKind::FileTooLarge => "if the file is the right one, raise the limit",
        ErrorKind::OutOfMemory => "close other programs, or split the file",
        _ => else_do,
    }
}

/// The same for a reader of measured files, with its errors; `wrong_path` is the remedy for a wrong path.
///
/// # Errors
/// Fails if the file cannot be read.
pub fn measured_file(path: &Path, wrong_path: &str) -> Result<Content<'static>, InputError> {
    measured(path).map_err(|error| {
        let remedy = remedy(&error, wrong_path);
        Problem::new(path, Place::File, error.to_string(), "a readable file", remedy).into()
    })
}

/// A text file.
///
/// # Errors
/// Fails as [`open`] does, beyond the limit, or with [`ErrorKind::InvalidData`] if the bytes are not UTF-8.
pub fn text(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    limited(open(path)?).read_to_end(&mut bytes)?;
    String::from_utf8(bytes).map_err(|error| {
        let place = error.utf8_error().valid_up_to();
        let (before, wrong) = error.as_bytes().split_at(place);
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        let column = 1 + before.iter().rev().take_while(|byte| **byte != b'\n').count();
        let message = format!(
            "the byte 0x{:02X} in line {line} at byte {column}, which is not UTF-8",
            wrong[0]
        );
        io::Error::new(ErrorKind::InvalidData, message)
    })
}

/// A table that is read row by row, unpacked if its name ends in `.gz`.
///
/// # Errors
/// Fails as [`open`] does; the reader fails beyond the limit.
pub fn table(path: &Path) -> io::Result<Box<dyn Read>> {
    let file = open(path)?;
    Ok(match path.extension().is_some_and(|end| end == "gz") {
        true => Box::new(limited_unpacked(file)?),
        false => Box::new(limited(BufReader::new(file))),
    })
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
    let message = format!("more bytes than the limit allows; set {VARIABLE} to a larger number of MiB");
    io::Error::new(ErrorKind::FileTooLarge, message)
}
