//! Writes MAT-files of version 7.3: HDF5 as MATLAB reads it, not compressed.

use hdf5_pure::mat::{MatBuilder, MatError, Options};

use super::Array;
use super::names::names;

/// A file with these variables, named as in [`v5`](super::v5). A structure array with a length other than one becomes a
/// cell array of structures.
///
/// # Errors
/// Fails as [`v5`](super::v5) does, or with an error of the HDF5 writer; no [`Array`] is known to cause one.
pub fn v73(variables: &[(String, Array)]) -> Result<Vec<u8>, String> {
    let names = names(variables.iter().map(|(name, _)| &**name))?;
    let mut file = MatBuilder::new(Options::default());
    let written = names
        .iter()
        .zip(variables)
        .try_for_each(|(name, (_, array))| put(&mut file, name, array));
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
        Array::Structs(fields, elements) => match &elements[..] {
            [only] => {
                let names = names(fields.iter().map(|name| &**name)).map_err(MatError::Custom)?;
                out.struct_(name, |out| {
                    let mut fields = names.iter().zip(only);
                    fields.try_for_each(|(name, value)| put(out.builder(), name, value))
                })
            }
            several => {
                let structure = |own: &Vec<Array>| Array::Structs(fields.clone(), vec![own.clone()]);
                return put(out, name, &Array::Cells(several.iter().map(structure).collect()));
            }
        },
    }
    .map(drop)
}
