//! The part of Thrift's compact protocol that Parquet needs: a structure is a list of fields with ascending numbers.
//! <https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>.

/// A value of a field.
pub(super) enum Value {
    /// A number of 32 bits.
    Int(i32),
    /// A number of 64 bits.
    Long(u64),
    /// A text in UTF-8.
    Text(String),
    /// Numbered fields, in ascending order.
    Struct(Vec<(i16, Value)>),
    /// Values of one kind.
    List(Vec<Value>),
}

impl Value {
    /// The number of a kind in the protocol.
    fn kind(&self) -> u8 {
        match self {
            Value::Int(_) => 5,
            Value::Long(_) => 6,
            Value::Text(_) => 8,
            Value::List(_) => 9,
            Value::Struct(_) => 12,
        }
    }

    /// Appends its bytes.
    pub fn write(&self, out: &mut Vec<u8>) {
        match self {
            Value::Int(number) => varint(zigzag(i64::from(*number)), out),
            Value::Long(number) => varint(zigzag(*number as i64), out),
            Value::Text(text) => {
                varint(text.len() as u64, out);
                out.extend(text.as_bytes());
            }
            Value::Struct(fields) => structure(fields, out),
            Value::List(items) => list(items, out),
        }
    }
}

fn structure(fields: &[(i16, Value)], out: &mut Vec<u8>) {
    let mut last = 0;
    for (number, value) in fields {
        // Numbers of consecutive fields in Parquet differ by less than 16.
        out.push(((number - last) as u8) << 4 | value.kind());
        value.write(out);
        last = *number;
    }
    out.push(0);
}

fn list(items: &[Value], out: &mut Vec<u8>) {
    let kind = items.first().map_or(0, Value::kind);
    match items.len() {
        few @ 0..15 => out.push((few as u8) << 4 | kind),
        many => {
            out.push(0xf0 | kind);
            varint(many as u64, out);
        }
    }
    items.iter().for_each(|item| item.write(out));
}

/// Maps small positive and negative numbers to small unsigned ones.
fn zigzag(number: i64) -> u64 {
    (number << 1 ^ number >> 63) as u64
}

/// Seven bits in each byte, the lowest first.
fn varint(mut number: u64, out: &mut Vec<u8>) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}
