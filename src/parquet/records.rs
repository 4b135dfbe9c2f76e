//! The metadata of Parquet's pages and of the whole file, field by field as `parquet.thrift` numbers them.

use super::thrift::Value::{self, Int, List, Long, Struct, Text};
use super::{GROUP, Shape, chunk_length};

/// A type: IEEE 754 of 64 bits.
const DOUBLE: i32 = 5;
/// An encoding: one number after another.
const PLAIN: i32 = 0;
/// An encoding: of levels, of which a column without gaps has none.
const RLE: i32 = 3;
/// A repetition: every row has a value.
const REQUIRED: i32 = 0;
/// A codec.
const UNCOMPRESSED: i32 = 0;

/// The header of a page of `count` numbers.
pub(super) fn page_header(rows: u64) -> Vec<u8> {
    let size = (rows * 8) as i32;
    let data = Struct(vec![
        (1, Int(rows as i32)),
        (2, Int(PLAIN)),
        (3, Int(RLE)),
        (4, Int(RLE)),
    ]);
    bytes(&Struct(vec![(1, Int(0)), (2, Int(size)), (3, Int(size)), (5, data)]))
}

/// The metadata at the end of a file with `rows` rows.
pub(super) fn of_file(shape: &Shape, rows: u64) -> Vec<u8> {
    let root = Struct(vec![(4, text("schema")), (5, Int(shape.columns.len() as i32))]);
    let column = |name: &String| Struct(vec![(1, Int(DOUBLE)), (3, Int(REQUIRED)), (4, text(name))]);
    let schema = std::iter::once(root).chain(shape.columns.iter().map(column));
    let groups = (0..rows.div_ceil(GROUP)).map(|group| row_group(shape, group, GROUP.min(rows - group * GROUP)));
    let (key, value) = &shape.about;
    let about = Struct(vec![(1, text(key)), (2, text(value))]);
    bytes(&Struct(vec![
        (1, Int(1)),
        (2, List(schema.collect())),
        (3, Long(rows)),
        (4, List(groups.collect())),
        (5, List(vec![about])),
        (6, text(concat!("qcar ", env!("CARGO_PKG_VERSION")))),
    ]))
}

fn row_group(shape: &Shape, group: u64, rows: u64) -> Value {
    let chunk = |(place, name): (usize, &String)| {
        let offset = shape.length(group) + place as u64 * chunk_length(rows);
        Struct(vec![(2, Long(offset)), (3, chunk(name, offset, rows))])
    };
    let chunks = shape.columns.iter().enumerate().map(chunk);
    Struct(vec![
        (1, List(chunks.collect())),
        (2, Long(shape.group_length(rows))),
        (3, Long(rows)),
    ])
}

fn chunk(name: &str, offset: u64, rows: u64) -> Value {
    let size = chunk_length(rows);
    Struct(vec![
        (1, Int(DOUBLE)),
        (2, List(vec![Int(PLAIN)])),
        (3, List(vec![text(name)])),
        (4, Int(UNCOMPRESSED)),
        (5, Long(rows)),
        (6, Long(size)),
        (7, Long(size)),
        (9, Long(offset)),
    ])
}

fn text(of: &str) -> Value {
    Text(of.into())
}

fn bytes(of: &Value) -> Vec<u8> {
    let mut out = Vec::new();
    of.write(&mut out);
    out
}
