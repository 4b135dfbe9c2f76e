//! Writes MAT-files: version 5 for MATLAB, Octave and SciPy, version 7.3 for MATLAB and programs for HDF5. Nothing is
//! packed.
//!
//! Source of version 5: "MAT-File Format" of The MathWorks.

mod names;
mod v73;

pub use v73::v73;

use super::{HEADER, VERSION};
use names::names;

const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;

/// The longest name of a variable or field, in bytes.
pub const LONGEST_NAME: usize = 63;

/// The value of a variable to be written.
#[derive(Clone, Debug, PartialEq)]
pub enum Array {
    /// Rows and columns, and as many numbers, column by column.
    Numbers([usize; 2], Vec<f64>),
    /// A text.
    Text(String),
    /// A cell array, one row.
    Cells(Vec<Array>),
    /// A structure array, one row: the names of the fields, and for each element its fields.
    Structs(Vec<String>, Vec<Vec<Array>>),
}

impl Array {
    /// A number.
    pub fn number(number: f64) -> Array {
        Array::column(vec![number])
    }

    /// A column of numbers.
    pub fn column(numbers: Vec<f64>) -> Array {
        Array::Numbers([numbers.len(), 1], numbers)
    }

    /// A matrix from its rows, each of `columns` numbers.
    pub fn rows(rows: &[Vec<f64>], columns: usize) -> Array {
        let numbers = (0..columns).flat_map(|column| rows.iter().map(move |row| row[column]));
        Array::Numbers([rows.len(), columns], numbers.collect())
    }

    /// Texts as a cell array.
    pub fn texts<'a>(texts: impl IntoIterator<Item = &'a str>) -> Array {
        Array::Cells(texts.into_iter().map(|text| Array::Text(text.into())).collect())
    }

    /// One structure.
    pub fn fields(fields: Vec<(String, Array)>) -> Array {
        let (names, values) = fields.into_iter().unzip();
        Array::Structs(names, vec![values])
    }

    /// The number of the class, and the dimensions.
    fn shape(&self) -> (u32, [usize; 2]) {
        match self {
            Array::Cells(cells) => (1, [usize::from(!cells.is_empty()), cells.len()]),
            Array::Structs(_, elements) => (2, [1, elements.len()]),
            Array::Text(text) => (4, [usize::from(!text.is_empty()), text.encode_utf16().count()]),
            Array::Numbers(size, _) => (6, *size),
        }
    }
}

/// A file with these variables; `description` is the line of at most 116 characters in its header.
///
/// Names of variables and fields that are not valid in MATLAB are changed: characters other than ASCII letters, digits
/// and `_` become `_`, `x` is prefixed if the name does not begin with a letter, `_` is appended to a keyword, and a
/// name longer than [`LONGEST_NAME`] is cut.
///
/// # Errors
/// Fails if two variables, or two fields of a structure, would get the same name.
pub fn v5(description: &str, variables: &[(String, Array)]) -> Result<Vec<u8>, String> {
    let mut file = vec![b' '; VERSION];
    for (to, from) in file
        .iter_mut()
        .zip(format!("MATLAB 5.0 MAT-file, {description}").bytes().take(116))
    {
        *to = if from.is_ascii_graphic() { from } else { b' ' };
    }
    // No subsystem data.
    file[116..].fill(0);
    file.extend([0x00, 0x01, b'I', b'M']);
    assert_eq!(file.len(), HEADER);
    let names = names(variables.iter().map(|(name, _)| &**name))?;
    for (name, (_, array)) in names.iter().zip(variables) {
        file.extend(matrix(name, array)?);
    }
    Ok(file)
}

fn matrix(name: &str, array: &Array) -> Result<Vec<u8>, String> {
    let (class, dimensions) = array.shape();
    let mut content = element(UINT32, &bytes(&[class, 0], |number| number.to_le_bytes()));
    content.extend(element(INT32, &bytes(&dimensions, |&size| (size as i32).to_le_bytes())));
    content.extend(element(INT8, name.as_bytes()));
    match array {
        Array::Numbers(_, numbers) => content.extend(element(DOUBLE, &bytes(numbers, |number| number.to_le_bytes()))),
        Array::Text(text) => {
            let letters: Vec<u16> = text.encode_utf16().collect();
            content.extend(element(UINT16, &bytes(&letters, |letter| letter.to_le_bytes())));
        }
        Array::Cells(cells) => content.extend(unnamed(cells)?),
        Array::Structs(names, elements) => {
            content.extend(element(INT32, &(LONGEST_NAME as i32 + 1).to_le_bytes()));
            content.extend(element(INT8, &field_names(names)?));
            content.extend(unnamed(elements.iter().flatten())?);
        }
    }
    let mut all = bytes(&[MATRIX, content.len() as u32], |number| number.to_le_bytes());
    all.extend(content);
    Ok(all)
}

/// Elements of a cell array or structure, one after another.
fn unnamed<'a>(arrays: impl IntoIterator<Item = &'a Array>) -> Result<Vec<u8>, String> {
    let matrices = arrays.into_iter().map(|array| matrix("", array));
    Ok(matrices.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Names padded with zeros, at least one for each.
fn field_names(fields: &[String]) -> Result<Vec<u8>, String> {
    let fixed = |name: &String| {
        let mut fixed = [0; LONGEST_NAME + 1];
        fixed[..name.len()].copy_from_slice(name.as_bytes());
        fixed
    };
    let names = names(fields.iter().map(|name| &**name))?;
    Ok(names.iter().flat_map(fixed).collect())
}

/// A tag and data padded to eight bytes; up to four bytes are stored in the tag.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let length = data.len() as u32;
    let small = !data.is_empty() && data.len() <= 4;
    let mut element = match small {
        true => bytes(&[kind | length << 16], |number| number.to_le_bytes()),
        false => bytes(&[kind, length], |number| number.to_le_bytes()),
    };
    element.extend(data);
    element.resize(element.len().next_multiple_of(8), 0);
    element
}

fn bytes<T, const N: usize>(numbers: &[T], of: impl Fn(&T) -> [u8; N]) -> Vec<u8> {
    numbers.iter().flat_map(of).collect()
}
