//! Checked access to the bytes of a file: an access beyond its end is an error with its place, never a panic.

use crate::error::{Fault, Place, Read};

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    Little,
    Big,
}

/// A run of bytes, from a file or unpacked from it.
#[derive(Clone, Copy)]
pub(crate) struct Bytes<'a> {
    pub(crate) data: &'a [u8],
    pub(crate) order: Order,
    /// Where `data` begins in the file; where it was packed, the place of the packed block.
    pub(crate) origin: Origin,
}

/// Where a run of bytes comes from.
#[derive(Clone, Copy)]
pub(crate) enum Origin {
    At(u64),
    PackedAt(u64),
}

impl<'a> Bytes<'a> {
    /// The bytes of a file.
    pub(crate) fn of_file(data: &'a [u8], order: Order) -> Self {
        Bytes {
            data,
            order,
            origin: Origin::At(0),
        }
    }

    pub(crate) fn len(&self) -> u64 {
        self.data.len() as u64
    }

    /// The place of a byte, for a message.
    pub(crate) fn place(&self, at: u64) -> Place {
        match self.origin {
            Origin::At(origin) => Place::Byte(origin.saturating_add(at)),
            Origin::PackedAt(origin) => Place::Byte(origin),
        }
    }

    /// `count` bytes from `at` on, which hold `what`.
    pub(crate) fn take(&self, at: u64, count: u64, what: &str) -> Read<&'a [u8]> {
        let end = at.checked_add(count).filter(|&end| end <= self.len());
        match end {
            Some(end) => Ok(&self.data[at as usize..end as usize]),
            None => {
                let there = self.len().saturating_sub(at);
                let expected = format!("{count} bytes of {what}");
                Err(Fault::cut_off(
                    self.place(at),
                    format!("{there} bytes to the end"),
                    expected,
                ))
            }
        }
    }

    /// The same as a run of bytes that knows its place.
    pub(crate) fn part(&self, at: u64, count: u64, what: &str) -> Read<Bytes<'a>> {
        let data = self.take(at, count, what)?;
        let origin = match self.origin {
            Origin::At(origin) => Origin::At(origin + at),
            packed => packed,
        };
        Ok(Bytes { data, origin, ..*self })
    }

    fn array<const N: usize>(&self, at: u64, what: &str) -> Read<[u8; N]> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(at, N as u64, what)?);
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

/// How a number is stored.
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
    /// Bytes of one.
    pub(crate) fn size(self) -> usize {
        match self {
            Number::U8 | Number::I8 => 1,
            Number::U16 | Number::I16 => 2,
            Number::U32 | Number::I32 | Number::F32 => 4,
            Number::U64 | Number::I64 | Number::F64 => 8,
        }
    }

    /// The numbers that begin every `stride` bytes of `data`, as many as are whole. `data` begins with the first of them.
    pub(crate) fn strided(self, data: &[u8], stride: usize, order: Order) -> Vec<f64> {
        macro_rules! each {
            ($kind:ty) => {{
                let chunks = data.chunks_exact(stride.max(self.size()));
                let last = chunks.remainder();
                let last = last.get(..self.size()).into_iter();
                let numbers = chunks
                    .chain(last)
                    .map(|chunk| chunk.first_chunk().copied().unwrap_or_default());
                match order {
                    Order::Little => numbers
                        .map(|bytes| <$kind>::from_le_bytes(bytes) as f64)
                        .collect(),
                    Order::Big => numbers
                        .map(|bytes| <$kind>::from_be_bytes(bytes) as f64)
                        .collect(),
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

    /// The numbers that lie one after the other in `data`.
    pub(crate) fn all(self, data: &[u8], order: Order) -> Vec<f64> {
        self.strided(data, self.size(), order)
    }
}

/// Text of unknown coding: UTF-8 where it is that, else Windows-1252, of which Latin-1 is a part.
pub(crate) fn text(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&byte| windows_1252(byte)).collect(),
    }
}

/// The same, up to the first zero and without white space around it.
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
