//! MAT-files of version 4: for each variable a head (type 4, rows 4, columns 4, imaginary part 4, length of the name 4),
//! its name, which ends with a zero, and its numbers, column by column.
//!
//! Source: "MAT-File Format" of The MathWorks, "Level 4 MAT-File Format".

use crate::bytes::{Bytes, Number, Order, field};
use crate::error::{Fault, Read};
use crate::find::Wanted;

use super::value::{Array, Value, Variable, among, is_read};

/// Bytes before the name.
const HEAD: u64 = 20;
/// Largest length of a name with its zero, bytes.
const LONGEST_NAME: u64 = 64;

/// What stands before the name of a variable.
struct Head {
    order: Order,
    number: Number,
    kind: Kind,
    rows: u64,
    columns: u64,
    is_complex: bool,
    name_length: u64,
}

enum Kind {
    Numbers,
    /// Codes of characters.
    Text,
    Sparse,
}

/// True if a file begins with the head and the name of a variable. The format has no other mark.
pub(super) fn begins(bytes: &[u8]) -> bool {
    let Some((head, rest)) = bytes
        .split_first_chunk()
        .and_then(|(head, rest)| Some((of(head)?, rest)))
    else {
        return false;
    };
    match rest.get(..head.name_length as usize) {
        Some([name @ .., 0]) => {
            let is_usual = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
            name.first().is_some_and(u8::is_ascii_alphabetic) && name.iter().all(is_usual)
        }
        _ => false,
    }
}

/// The type is 1000 for numbers in big-endian order, plus ten times the storage type, plus the kind.
fn of(head: &[u8; HEAD as usize]) -> Option<Head> {
    let words: Vec<[u8; 4]> = head
        .chunks_exact(4)
        .filter_map(|word| word.first_chunk().copied())
        .collect();
    let (little, big) = (u32::from_le_bytes(words[0]), u32::from_be_bytes(words[0]));
    let (order, code) = match (little, big) {
        (0..1000, _) => (Order::Little, little),
        (_, 1000..2000) => (Order::Big, big - 1000),
        _ => return None,
    };
    let word = |at: usize| match order {
        Order::Little => u32::from_le_bytes(words[at]),
        Order::Big => u32::from_be_bytes(words[at]),
    };
    let number = match code / 10 {
        0 => Number::F64,
        1 => Number::F32,
        2 => Number::I32,
        3 => Number::I16,
        4 => Number::U16,
        5 => Number::U8,
        _ => return None,
    };
    let kind = match code % 10 {
        0 => Kind::Numbers,
        1 => Kind::Text,
        2 => Kind::Sparse,
        _ => return None,
    };
    let head = Head {
        order,
        number,
        kind,
        rows: word(1).into(),
        columns: word(2).into(),
        is_complex: word(3) == 1,
        name_length: word(4).into(),
    };
    (word(3) <= 1 && (2..=LONGEST_NAME).contains(&head.name_length)).then_some(head)
}

/// All variables of a file.
pub(super) fn variables(file: &Bytes, wanted: &Wanted) -> Read<Vec<Variable>> {
    let mut variables: Vec<Variable> = Vec::new();
    let mut at = 0;
    while at < file.len() {
        let (variable, next) = variable(file, at, wanted).map_err(|fault| among(&variables, fault))?;
        variables.push(variable);
        at = next;
    }
    Ok(variables)
}

/// The variable at a byte, and the position of the next one.
fn variable(file: &Bytes, at: u64, wanted: &Wanted) -> Read<(Variable, u64)> {
    let bytes = file.take(at, HEAD, "the head of a variable")?;
    let head = bytes.first_chunk().and_then(of);
    let head = head.ok_or_else(|| Fault::damaged(file.place(at), "something else", "the head of a variable"))?;
    let name = field(&file.take(at + HEAD, head.name_length, "a name")?);
    let parts = if head.is_complex { 2 } else { 1 };
    let size = [head.rows, head.columns, parts, head.number.size() as u64]
        .into_iter()
        .try_fold(1_u64, u64::checked_mul);
    let begin = at + HEAD + head.name_length;
    let data = file
        .in_order(head.order)
        .part(begin, size.unwrap_or(u64::MAX), "numbers");
    let data = data.map_err(|fault| fault.of(&name))?;
    let variable = Variable {
        value: value(&head, &name, &data, wanted)?,
        name,
        place: file.place(at),
    };
    Ok((variable, begin + data.len()))
}

fn value(head: &Head, name: &str, data: &Bytes, wanted: &Wanted) -> Read<Value> {
    let dimensions = vec![head.rows, head.columns];
    Ok(match head.kind {
        Kind::Sparse => Value::Other("a sparse matrix"),
        _ if head.is_complex => Value::Other("complex numbers"),
        Kind::Text if head.rows == 1 => {
            let codes = head.number.all_of(data, "a text")?;
            let character = |code: f64| char::from_u32(code as u32).unwrap_or(char::REPLACEMENT_CHARACTER);
            Value::Text(codes.into_iter().map(character).collect())
        }
        Kind::Text => Value::Other("a text of several lines"),
        Kind::Numbers if !is_read(name, &dimensions, wanted) => Value::Numbers(Array::unread(dimensions)),
        Kind::Numbers => Value::Numbers(Array {
            dimensions,
            numbers: head.number.all_of(data, "numbers")?,
        }),
    })
}
