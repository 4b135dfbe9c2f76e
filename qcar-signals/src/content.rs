//! The bytes of a file, in memory or on the disk, from which they are read on request.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// Size of a page: bytes that are read at once if few are requested.
const PAGE: u64 = 1 << 16;
/// Number of pages that are kept, since the next request is often near.
const PAGES: usize = 64;

/// Content of a file.
pub struct Content<'a>(Where<'a>);

enum Where<'a> {
    Memory(Cow<'a, [u8]>),
    Disk(Disk),
}

struct Disk {
    file: File,
    length: u64,
    pages: RefCell<HashMap<u64, Box<[u8]>>>,
    /// Buffer for ranges longer than a page.
    buffer: RefCell<Vec<u8>>,
}

impl<'a> Content<'a> {
    /// Content in memory.
    pub fn of_bytes(bytes: impl Into<Cow<'a, [u8]>>) -> Self {
        Content(Where::Memory(bytes.into()))
    }

    /// Content of an open file, of which at most a few megabytes are in memory.
    ///
    /// # Errors
    /// Fails with the error of the system if the length of the file is unknown.
    pub fn of_file(file: File) -> io::Result<Content<'static>> {
        let length = file.metadata()?.len();
        Ok(Content(Where::Disk(Disk {
            file,
            length,
            pages: RefCell::default(),
            buffer: RefCell::default(),
        })))
    }

    /// Number of bytes.
    pub fn length(&self) -> u64 {
        match &self.0 {
            Where::Memory(bytes) => bytes.len() as u64,
            Where::Disk(disk) => disk.length,
        }
    }

    /// The first bytes, at most a page.
    ///
    /// # Errors
    /// Fails with the error of the system.
    pub fn beginning(&self) -> io::Result<Cow<'_, [u8]>> {
        self.take(0, self.length().min(PAGE))
    }

    /// Bytes of a range inside the file.
    pub(crate) fn take(&self, at: u64, count: u64) -> io::Result<Cow<'_, [u8]>> {
        match &self.0 {
            Where::Memory(bytes) => Ok(Cow::Borrowed(within(bytes, at, count)?)),
            Where::Disk(disk) if count <= PAGE => disk.near(at, count, <[u8]>::to_vec).map(Cow::Owned),
            Where::Disk(disk) => {
                let mut own = vec![0; count as usize];
                disk.read(at, &mut own)?;
                Ok(Cow::Owned(own))
            }
        }
    }

    /// The same, passed to a function without unnecessary copies.
    pub(crate) fn show<T>(&self, at: u64, count: u64, to: impl FnOnce(&[u8]) -> T) -> io::Result<T> {
        match &self.0 {
            Where::Memory(bytes) => Ok(to(within(bytes, at, count)?)),
            Where::Disk(disk) if count <= PAGE => disk.near(at, count, to),
            Where::Disk(disk) => {
                let mut buffer = disk.buffer.take();
                buffer.resize(count as usize, 0);
                disk.read(at, &mut buffer)?;
                let shown = to(&buffer);
                disk.buffer.replace(buffer);
                Ok(shown)
            }
        }
    }
}

fn within(bytes: &[u8], at: u64, count: u64) -> io::Result<&[u8]> {
    let end = at.saturating_add(count).min(bytes.len() as u64);
    let own = bytes.get(at as usize..end as usize);
    own.filter(|own| own.len() as u64 == count)
        .ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
}

impl Disk {
    fn read(&self, at: u64, into: &mut [u8]) -> io::Result<()> {
        let mut file = &self.file;
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(into)
    }

    /// Bytes of a page, or of two adjacent pages.
    fn near<T>(&self, at: u64, count: u64, to: impl FnOnce(&[u8]) -> T) -> io::Result<T> {
        let (first, from) = (at / PAGE, (at % PAGE) as usize);
        let end = from + count as usize;
        let page = self.page(first)?;
        if end <= page.len() {
            let shown = to(&page[from..end]);
            self.keep(first, page);
            return Ok(shown);
        }
        let mut both = page[from.min(page.len())..].to_vec();
        self.keep(first, page);
        let next = self.page(first + 1)?;
        let rest = next.get(..count as usize - both.len());
        both.extend_from_slice(rest.ok_or(io::ErrorKind::UnexpectedEof)?);
        self.keep(first + 1, next);
        Ok(to(&both))
    }

    /// A page, from those in memory if possible.
    fn page(&self, number: u64) -> io::Result<Box<[u8]>> {
        let known = self.pages.borrow_mut().remove(&number);
        if let Some(page) = known {
            return Ok(page);
        }
        let start = number.saturating_mul(PAGE);
        let mut page = vec![0; self.length.saturating_sub(start).min(PAGE) as usize];
        self.read(start, &mut page)?;
        Ok(page.into())
    }

    fn keep(&self, number: u64, page: Box<[u8]>) {
        let mut pages = self.pages.borrow_mut();
        if pages.len() >= PAGES {
            pages.clear();
        }
        pages.insert(number, page);
    }
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};

    use super::{Content, PAGE};

    #[test]
    fn a_range_of_a_file_on_disk_is_that_in_memory() {
        let bytes: Vec<u8> = (0..3 * PAGE + 100).map(|at| (at * at % 251) as u8).collect();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bytes");
        fs::write(&path, &bytes).unwrap();
        let disk = Content::of_file(File::open(path).unwrap()).unwrap();
        let memory = Content::of_bytes(&bytes);
        assert_eq!(disk.length(), memory.length());
        for at in [0, 1, PAGE - 1, PAGE, 2 * PAGE + 7, 3 * PAGE, 3 * PAGE + 99] {
            for count in [0, 1, 8, 99, 100, PAGE - 1, PAGE, PAGE + 1, 2 * PAGE, 3 * PAGE + 100] {
                let taken = |content: &Content<'_>| content.take(at, count).map(|own| own.into_owned()).ok();
                let shown = |content: &Content<'_>| content.show(at, count, <[u8]>::to_vec).ok();
                assert_eq!(taken(&disk), taken(&memory), "{count} bytes at {at}");
                assert_eq!(shown(&disk), shown(&memory), "{count} bytes at {at}");
                assert_eq!(taken(&memory).is_some(), at + count <= memory.length());
            }
        }
    }
}
