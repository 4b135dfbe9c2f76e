//! MAT-files of version 7.3, written: HDF5 as MATLAB reads it. Nothing is packed.

use hdf5_pure::mat::{InvalidNamePolicy, MatBuilder, MatError, Options};

use super::Array;

/// A file with these variables. A structure array of another length than one becomes a cell array of structures.
///
/// A name that MATLAB cannot take for one of a variable or field is changed into one that it can.
///
/// # Errors
/// What the writer of HDF5 says, which nothing that an [`Array`] may hold is known to bring about.
pub fn v73(variables: &[(String, Array)]) -> Result<Vec<u8>, String> {
    let mut options = Options::default();
    options.invalid_name_policy = InvalidNamePolicy::Sanitize;
    let mut file = MatBuilder::new(options);
    let written = variables
        .iter()
        .try_for_each(|(name, array)| put(&mut file, name, array));
    written.and_then(|()| file.finish()).map_err(|error| error.to_string())
}

fn put(out: &mut MatBuilder, name: &str, array: &Array) -> Result<(), MatError> {
    match array {
        Array::Numbers(size, numbers) => out.write_f64(name, size, numbers),
        Array::Text(text) => out.write_char(name, text),
        Array::Cells(cells) => out.cell(name, &array.shape().1, |out| {
            let mut cells = cells.iter();
            cells.try_for_each(|cell| out.push_with(|out| put(out, "", cell)).map(drop))
        }),
        Array::Structs(names, elements) => match &elements[..] {
            [only] => out.struct_(name, |out| {
                let mut fields = names.iter().zip(only);
                fields.try_for_each(|(name, value)| put(out.builder(), name, value))
            }),
            several => {
                let structure = |own: &Vec<Array>| Array::Structs(names.clone(), vec![own.clone()]);
                return put(out, name, &Array::Cells(several.iter().map(structure).collect()));
            }
        },
    }
    .map(drop)
}
