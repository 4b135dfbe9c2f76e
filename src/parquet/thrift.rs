//! Thrift's compact protocol, as far as Parquet needs it: a structure is a list of fields with rising numbers.
//! <https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>.

/// A value of a field.
pub(super) enum Value {
    /// Of 32 bits.
    Int(i32),
    /// Of 64 bits.
    Long(u64),
    /// UTF-8.
    Text(String),
    /// Numbered fields, in rising order.
    Struct(Vec<(i16, Value)>),
    /// Of one kind.
    List(Vec<Value>),
}

impl Value {
    /// The number by which the protocol knows a kind.
    fn kind(&self) -> u8 {
        match self {
            Value::Int(_) => 5,
            Value::Long(_) => 6,
            Value::Text(_) => 8,
            Value::List(_) => 9,
            Value::Struct(_) => 12,
        }
    }

    /// Its bytes, after others.
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
        // Fields of what Parquet writes are never 16 apart.
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

/// Small numbers of either sign become small ones without.
fn zigzag(number: i64) -> u64 {
    (number << 1 ^ number >> 63) as u64
}

/// Seven bits a byte, the lowest first.
fn varint(mut number: u64, out: &mut Vec<u8>) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}
