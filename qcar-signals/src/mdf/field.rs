//! Position of the values of a channel in the records of its group.

use crate::bytes::{Number, Order};

use super::Piece;

/// Position of the values of a channel in a record.
pub(super) enum Field {
    /// The value is the number of the record, from 0.
    Index,
    /// Bits of the record.
    Bits {
        /// Position of the first byte with a bit of the value.
        byte: usize,
        /// Position of the lowest bit in the least significant byte.
        bit: u32,
        /// Number of bits.
        count: u32,
        kind: Kind,
        order: Order,
        /// Marks invalid values.
        invalid: Invalid,
    },
}

/// The type of the value.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Unsigned,
    Signed,
    Float,
}

/// The invalid values of a channel.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Invalid {
    None,
    All,
    /// Those of records in which this bit is set.
    Where {
        byte: usize,
        mask: u8,
    },
}

impl Field {
    /// Number of bits of a record that it uses; 8 if it uses none.
    pub(super) fn bits(&self) -> usize {
        match self {
            Field::Index => 8,
            Field::Bits { count, .. } => *count as usize,
        }
    }

    /// Checks that the field lies within a record.
    ///
    /// # Errors
    /// Fails with the reason why it cannot be read.
    pub(super) fn checked(self, record: usize) -> Result<Field, String> {
        let Field::Bits {
            byte,
            bit,
            count,
            kind,
            invalid,
            ..
        } = &self
        else {
            return Ok(self);
        };
        let end = (*byte as u64) + u64::from(bit + count).div_ceil(8);
        if *count == 0 || *count > 64 || end > record as u64 {
            return Err(format!(
                "{count} bits from byte {byte} on, in records of {record} bytes"
            ));
        }
        if *kind == Kind::Float && (*bit != 0 || !matches!(count, 16 | 32 | 64)) {
            return Err(format!("a floating-point number of {count} bits"));
        }
        match invalid {
            Invalid::Where { byte, .. } if *byte >= record => Err("an invalidation bit outside its record".into()),
            _ => Ok(self),
        }
    }

    /// Adds the stored values of some records; NaN for an invalid one.
    pub(super) fn values(&self, records: &Piece, into: &mut Vec<f64>) {
        let Field::Bits {
            byte,
            bit,
            count,
            kind,
            order,
            invalid,
        } = *self
        else {
            into.extend((records.first..).take(records.count).map(|at| at as f64));
            return;
        };
        let own = || {
            records
                .bytes
                .chunks_exact(records.stride)
                .map(|record| &record[records.before..])
        };
        let known = into.len();
        match number(kind, bit, count) {
            Some(number) => {
                let from = &records.bytes[records.before + byte..];
                number.extend(into, from, records.stride, order);
            }
            None => {
                let size = (bit + count).div_ceil(8) as usize;
                into.extend(own().map(|record| value(&record[byte..byte + size], bit, count, kind, order)));
            }
        }
        let values = &mut into[known..];
        match invalid {
            Invalid::None => {}
            Invalid::All => values.fill(f64::NAN),
            Invalid::Where { byte, mask } => {
                for (value, record) in values.iter_mut().zip(own()) {
                    if record[byte] & mask != 0 {
                        *value = f64::NAN;
                    }
                }
            }
        }
    }
}

/// The storage type, if the value fills whole bytes.
fn number(kind: Kind, bit: u32, count: u32) -> Option<Number> {
    if bit != 0 {
        return None;
    }
    match (kind, count) {
        (Kind::Unsigned, 8) => Some(Number::U8),
        (Kind::Unsigned, 16) => Some(Number::U16),
        (Kind::Unsigned, 32) => Some(Number::U32),
        (Kind::Unsigned, 64) => Some(Number::U64),
        (Kind::Signed, 8) => Some(Number::I8),
        (Kind::Signed, 16) => Some(Number::I16),
        (Kind::Signed, 32) => Some(Number::I32),
        (Kind::Signed, 64) => Some(Number::I64),
        (Kind::Float, 32) => Some(Number::F32),
        (Kind::Float, 64) => Some(Number::F64),
        _ => None,
    }
}

/// A value of any number of bits, up to 64.
fn value(field: &[u8], bit: u32, count: u32, kind: Kind, order: Order) -> f64 {
    let join = |all: u128, &byte: &u8| all << 8 | u128::from(byte);
    let all = match order {
        Order::Big => field.iter().fold(0, join),
        Order::Little => field.iter().rev().fold(0, join),
    };
    let bits = (all >> bit) & ((1 << count) - 1);
    match kind {
        Kind::Unsigned => bits as f64,
        Kind::Signed => {
            let unused = 128 - count;
            ((bits as i128) << unused >> unused) as f64
        }
        Kind::Float => half(bits as u16),
    }
}

/// A number of IEEE 754 binary16.
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    sign * match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::{Kind, Order, half, value};

    #[test]
    fn values_of_any_range_of_bits_are_extracted() {
        assert_eq!(
            value(&[0xab, 0xcd], 4, 8, Kind::Unsigned, Order::Little),
            f64::from(0xda)
        );
        assert_eq!(value(&[0xab, 0xcd], 4, 8, Kind::Unsigned, Order::Big), f64::from(0xbc));
        assert_eq!(value(&[0xff, 0x0f], 0, 12, Kind::Signed, Order::Little), -1.0);
        assert_eq!(value(&[0xff, 0x07], 0, 12, Kind::Signed, Order::Little), 2047.0);
    }

    #[test]
    fn half_precision_is_that_of_ieee_754() {
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x0001, 5.960464477539063e-8),
            (0x7bff, 65504.0),
        ] {
            assert_eq!(half(bits), value);
        }
    }
}
