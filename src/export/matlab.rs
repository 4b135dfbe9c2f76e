//! MATLAB: a function that computes the matrices, and a file with the matrices.

use qcar_dsl::matlab::{function, is_name};
use qcar_runtime::error::InputError;
use qcar_signals::mat::write::{Array, v5, v73};

use super::{File, Subject};
use crate::failure::flag;
use crate::state_space::StateSpace;

/// `stem.m`, with the name of its function.
///
/// # Errors
/// Fails if MATLAB cannot call the name.
pub fn program(subject: Subject, stem: &str) -> Result<File, InputError> {
    if !is_name(stem) {
        let expected = "letters, digits and `_`, a letter first, no keyword, at most 63";
        let remedy = format!("write a name such as --out {}.m", subject.compiled.about.name);
        return Err(flag("--out", format!("`{stem}.m`"), expected, &remedy).into());
    }
    Ok(File {
        name: format!("{stem}.m"),
        content: function(subject.compiled, subject.values, stem).into_bytes(),
    })
}

/// A MAT-file of version 5 with `variables`.
///
/// # Errors
/// Fails if two parameters have the same name in MATLAB.
pub fn data(subject: Subject, of: &StateSpace) -> Result<Vec<u8>, String> {
    v5(&format!("{} by qcar", of.model), &variables(subject, of))
}

/// The same in version 7.3.
///
/// # Errors
/// Fails as [`data`] does, and with the error of the HDF5 writer.
pub fn data_in_hdf5(subject: Subject, of: &StateSpace) -> Result<Vec<u8>, String> {
    v73(&variables(subject, of))
}

/// The matrices, the names and units of their rows and columns, and the values of the parameters.
fn variables(subject: Subject, of: &StateSpace) -> [(String, Array); 7] {
    let parameters = &subject.compiled.about.parameters;
    let value = parameters.iter().zip(subject.values);
    let values = value.map(|(own, &value)| (own.name.to_string(), Array::number(value)));
    let matrix = |name: &str, columns: usize| (name.to_string(), Array::rows(&of.matrices[name], columns));
    let (states, inputs) = (of.states.len(), of.inputs.len());
    [
        matrix("A", states),
        matrix("B", inputs),
        matrix("C", states),
        matrix("D", inputs),
        ("names".into(), names(subject, of)),
        ("p".into(), Array::fields(values.collect())),
        ("linear".into(), Array::number(f64::from(u8::from(of.linear)))),
    ]
}

/// Names as in the function of [`program`].
fn names(subject: Subject, of: &StateSpace) -> Array {
    let parameters = &subject.compiled.about.parameters;
    let lists: [(&str, Vec<&str>); 8] = [
        ("states", of.states.iter().map(|own| &*own.name).collect()),
        ("inputs", of.inputs.iter().map(|own| &*own.variable).collect()),
        ("outputs", of.outputs.iter().map(|own| &*own.name).collect()),
        ("parameters", parameters.iter().map(|own| &*own.name).collect()),
        ("state_units", of.states.iter().map(|own| &*own.unit).collect()),
        ("input_units", of.inputs.iter().map(|own| &*own.unit).collect()),
        ("output_units", of.outputs.iter().map(|own| &*own.unit).collect()),
        ("parameter_units", parameters.iter().map(|own| &*own.unit).collect()),
    ];
    Array::fields(
        lists
            .map(|(name, texts)| (name.to_string(), Array::texts(texts)))
            .into(),
    )
}
