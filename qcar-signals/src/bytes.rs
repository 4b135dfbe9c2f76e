//! Checked access to the bytes of a file: an access beyond its end is an error with its position, never a panic.

use std::borrow::Cow;
use std::io;

use crate::content::Content;
use crate::error::{Fault, Place, Read};

/// Byte order of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    Little,
    Big,
}

/// A range of bytes of a file, or of unpacked bytes.
#[derive(Clone, Copy)]
pub(crate) struct Bytes<'a> {
    content: &'a Content<'a>,
    /// Start of the range in the content.
    start: u64,
    length: u64,
    pub(crate) order: Order,
    /// Position in the file of the packed block from which the content was unpacked.
    packed_at: Option<u64>,
}

/// Bytes of one piece of a long range, so that they stay in the cache.
const PIECE: u64 = 1 << 18;

impl<'a> Bytes<'a> {
    /// All bytes of a file.
    pub(crate) fn of_file(content: &'a Content<'a>, order: Order) -> Self {
        Bytes {
            content,
            start: 0,
            length: content.length(),
            order,
            packed_at: None,
        }
    }

    /// All bytes of the unpacked block of the file at `at`.
    pub(crate) fn unpacked(content: &'a Content<'a>, order: Order, at: u64) -> Self {
        Bytes {
            packed_at: Some(at),
            ..Bytes::of_file(content, order)
        }
    }

    /// The same with another byte order of numbers.
    pub(crate) fn in_order(self, order: Order) -> Self {
        Bytes { order, ..self }
    }

    pub(crate) fn len(&self) -> u64 {
        self.length
    }

    /// The position of a byte, for a message.
    pub(crate) fn place(&self, at: u64) -> Place {
        Place::Byte(self.packed_at.unwrap_or(self.start.saturating_add(at)))
    }

    /// Checks that `count` bytes from `at` on exist; `what` is their meaning, for the message.
    fn check(&self, at: u64, count: u64, what: &str) -> Read<()> {
        if at.checked_add(count).is_some_and(|end| end <= self.length) {
            return Ok(());
        }
        let there = self.length.saturating_sub(at);
        let found = format!("{there} bytes to the end");
        Err(Fault::cut_off(
            self.place(at),
            found,
            format!("{count} bytes of {what}"),
        ))
    }

    fn unreadable(&self, at: u64, what: &str) -> impl FnOnce(io::Error) -> Box<Fault> {
        let (place, what) = (self.place(at), what.to_string());
        move |error| {
            let remedy = "check the disk or the network, and try again";
            Fault::new(place, format!("an error of the system: {error}"), what, remedy)
        }
    }

    /// `count` bytes from `at` on; `what` is their meaning.
    pub(crate) fn take(&self, at: u64, count: u64, what: &str) -> Read<Cow<'a, [u8]>> {
        self.check(at, count, what)?;
        self.content
            .take(self.start + at, count)
            .map_err(self.unreadable(at, what))
    }

    /// All of them.
    pub(crate) fn all(&self, what: &str) -> Read<Cow<'a, [u8]>> {
        self.take(0, self.length, what)
    }

    /// Passes `count` bytes from `at` on to a function, piece by piece, each of a whole number of `unit` bytes.
    pub(crate) fn pieces(&self, at: u64, count: u64, unit: u64, what: &str, mut show: impl FnMut(&[u8])) -> Read<()> {
        self.check(at, count, what)?;
        let unit = unit.max(1);
        let size = (PIECE / unit).max(1) * unit;
        let mut done = 0;
        while done < count {
            let own = size.min(count - done);
            self.content
                .show(self.start + at + done, own, &mut show)
                .map_err(self.unreadable(at + done, what))?;
            done += own;
        }
        Ok(())
    }

    /// The same as a range with its position.
    pub(crate) fn part(&self, at: u64, count: u64, what: &str) -> Read<Bytes<'a>> {
        self.check(at, count, what)?;
        Ok(Bytes {
            start: self.start + at,
            length: count,
            ..*self
        })
    }

    /// True if the range begins with these bytes.
    pub(crate) fn starts_with(&self, beginning: &[u8]) -> bool {
        let own = self.take(0, self.length.min(beginning.len() as u64), "a beginning");
        own.is_ok_and(|own| *own == *beginning)
    }

    fn array<const N: usize>(&self, at: u64, what: &str) -> Read<[u8; N]> {
        self.check(at, N as u64, what)?;
        let mut array = [0; N];
        self.content
            .show(self.start + at, N as u64, |own| array.copy_from_slice(own))
            .map_err(self.unreadable(at, what))?;
        if self.order == Order::Big {
            array.reverse();
        }
        Ok(array)
    }

    pub(crate) fn u8(&self, at: u64, what: &str) -> Read<u8> {
        Ok(u8::from_le_bytes(self.array(at, what)?))
    }

    pub(crate) fn u16(&self, at: u64, what: &str) -> Read<u16> {
        Ok(u16::from_le_bytes(self.array(at, what)?))
    }

    pub(crate) fn u32(&self, at: u64, what: &str) -> Read<u32> {
        Ok(u32::from_le_bytes(self.array(at, what)?))
    }

    pub(crate) fn u64(&self, at: u64, what: &str) -> Read<u64> {
        Ok(u64::from_le_bytes(self.array(at, what)?))
    }

    pub(crate) fn f64(&self, at: u64, what: &str) -> Read<f64> {
        Ok(f64::from_le_bytes(self.array(at, what)?))
    }
}

/// Storage type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Number {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl Number {
    /// Bytes of a number.
    pub(crate) fn size(self) -> usize {
        match self {
            Number::U8 | Number::I8 => 1,
            Number::U16 | Number::I16 => 2,
            Number::U32 | Number::I32 | Number::F32 => 4,
            Number::U64 | Number::I64 | Number::F64 => 8,
        }
    }

    /// Appends the numbers that begin every `stride` bytes of `data`, as many as are complete. The first begins at the
    /// start of `data`.
    pub(crate) fn extend(self, into: &mut Vec<f64>, data: &[u8], stride: usize, order: Order) {
        macro_rules! each {
            ($kind:ty) => {{
                let numbers = heads(data, stride);
                match order {
                    Order::Little => into.extend(numbers.map(|bytes| <$kind>::from_le_bytes(bytes) as f64)),
                    Order::Big => into.extend(numbers.map(|bytes| <$kind>::from_be_bytes(bytes) as f64)),
                }
            }};
        }
        match self {
            Number::U8 => each!(u8),
            Number::I8 => each!(i8),
            Number::U16 => each!(u16),
            Number::I16 => each!(i16),
            Number::U32 => each!(u32),
            Number::I32 => each!(i32),
            Number::U64 => each!(u64),
            Number::I64 => each!(i64),
            Number::F32 => each!(f32),
            Number::F64 => each!(f64),
        }
    }

    /// The same as a new vector.
    pub(crate) fn strided(self, data: &[u8], stride: usize, order: Order) -> Vec<f64> {
        let mut all = Vec::with_capacity(data.len() / stride.max(self.size()) + 1);
        self.extend(&mut all, data, stride, order);
        all
    }

    /// The contiguous numbers in `data`.
    pub(crate) fn all(self, data: &[u8], order: Order) -> Vec<f64> {
        self.strided(data, self.size(), order)
    }

    /// The same for a range of bytes, which is never completely in memory beside the numbers.
    pub(crate) fn all_of(self, bytes: &Bytes, what: &str) -> Read<Vec<f64>> {
        let mut all = Vec::with_capacity(bytes.len() as usize / self.size());
        bytes.pieces(0, bytes.len(), self.size() as u64, what, |piece| {
            self.extend(&mut all, piece, self.size(), bytes.order);
        })?;
        Ok(all)
    }
}

/// The first `N` bytes of every `stride` bytes of `data`, as many as are complete.
pub(crate) fn heads<const N: usize>(data: &[u8], stride: usize) -> impl Iterator<Item = [u8; N]> {
    let chunks = data.chunks_exact(stride.max(N).max(1));
    let last = chunks.remainder().get(..N).into_iter();
    chunks
        .chain(last)
        .map(|chunk| chunk.first_chunk().copied().unwrap_or([0; N]))
}

/// Text of unknown encoding: UTF-8 if valid, otherwise Windows-1252, which includes Latin-1.
pub(crate) fn text(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => bytes.iter().map(|&byte| windows_1252(byte)).collect(),
    }
}

/// The same, up to the first zero and trimmed.
pub(crate) fn field(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    text(&bytes[..end]).trim().into()
}

fn windows_1252(byte: u8) -> char {
    const HIGH: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}', '‘',
        '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
    ];
    match byte {
        0x80..=0x9f => HIGH[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}
