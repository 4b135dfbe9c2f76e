//! Variables of a MAT-file, independent of the version of the file.

use crate::error::{Fault, Place, whole_before};
use crate::find::Wanted;
use crate::units::is_time;

/// A variable with its name.
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) place: Place,
}

/// A fault in the variable after these, which names them.
pub(super) fn among(before: &[Variable], mut fault: Box<Fault>) -> Box<Fault> {
    let names: Vec<&str> = before.iter().map(|variable| variable.name.as_str()).collect();
    if !names.is_empty() {
        let whole = whole_before(names.len(), "variable");
        fault.found += &format!("{whole}: {}", names.join(", "));
    }
    fault
}

/// The value of a variable. Arrays are stored column by column.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Numbers(Array),
    Text(String),
    /// Elements of a structure array, each with its fields.
    Structs(Vec<Fields>),
    Cells(Vec<Value>),
    /// Anything else, with a description.
    Other(&'static str),
}

/// An array of real numbers.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub(super) dimensions: Vec<u64>,
    /// Empty if it was not read.
    pub(super) numbers: Vec<f64>,
}

/// True if the numbers of a variable are read: for a wanted channel, a variable that may be its times, and a single
/// value.
pub(super) fn is_read(variable: &str, dimensions: &[u64], wanted: &Wanted) -> bool {
    let single = dimensions.iter().all(|&size| size == 1);
    single || is_time(variable) || wanted.has("", variable) || wanted.may_begin(&format!("{variable}["))
}

pub(super) type Fields = Vec<(String, Value)>;

/// A group of HDF5 as a structure. If every field is a list of references, it is a structure array with as many
/// elements.
pub(super) fn of_fields(fields: Fields) -> Value {
    if fields.is_empty() || fields.iter().any(|(_, value)| !matches!(value, Value::Cells(_))) {
        return Value::Structs(vec![fields]);
    }
    let mut elements = 1;
    let mut lists: Vec<(String, std::vec::IntoIter<Value>)> = Vec::new();
    for (name, value) in fields {
        if let Value::Cells(cells) = value {
            elements = elements.max(cells.len());
            lists.push((name, cells.into_iter()));
        }
    }
    let element = |_| {
        let fields = lists.iter_mut();
        fields
            .filter_map(|(name, list)| Some((name.clone(), list.next()?)))
            .collect()
    };
    Value::Structs((0..elements).map(element).collect())
}

impl Value {
    /// The value at a path of fields, through structures of one element.
    pub(super) fn at(&self, path: &[&str]) -> Option<&Value> {
        let Some((first, rest)) = path.split_first() else {
            return Some(self);
        };
        match self {
            Value::Structs(elements) => match elements.as_slice() {
                [fields] => fields.iter().find(|(name, _)| name == first)?.1.at(rest),
                _ => None,
            },
            Value::Cells(cells) if cells.len() == 1 => cells[0].at(path),
            _ => None,
        }
    }

    /// Removes a field of a structure of one element and returns it.
    pub(super) fn take(&mut self, name: &str) -> Option<Value> {
        let Value::Structs(elements) = self else { return None };
        let field = elements.iter_mut().flatten().find(|(own, _)| own == name);
        field.map(|(_, value)| std::mem::replace(value, Value::Other("taken")))
    }

    /// The elements of a structure array, each as a structure of its own.
    pub(super) fn into_elements(self) -> Vec<Value> {
        match self {
            Value::Structs(elements) => elements
                .into_iter()
                .map(|fields| Value::Structs(vec![fields]))
                .collect(),
            Value::Cells(cells) => cells,
            _ => Vec::new(),
        }
    }

    /// The numbers at a path.
    pub(super) fn numbers(&self, path: &[&str]) -> Option<&[f64]> {
        match self.at(path)? {
            Value::Numbers(array) => Some(&array.numbers),
            _ => None,
        }
    }

    /// The single number at a path.
    pub(super) fn number(&self, path: &[&str]) -> Option<f64> {
        match self.numbers(path)? {
            [number] => Some(*number),
            _ => None,
        }
    }

    /// The text at a path.
    pub(super) fn text(&self, path: &[&str]) -> Option<&str> {
        match self.at(path)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl Array {
    /// An array whose numbers are not read.
    pub(super) fn unread(dimensions: Vec<u64>) -> Self {
        Array {
            dimensions,
            numbers: Vec::new(),
        }
    }

    /// Number of elements, whether they were read or not.
    pub(super) fn len(&self) -> usize {
        let all = self
            .dimensions
            .iter()
            .try_fold(1_u64, |all, &size| all.checked_mul(size));
        all.map_or(usize::MAX, |all| all as usize)
    }

    pub(super) fn is_vector(&self) -> bool {
        self.dimensions.iter().filter(|&&size| size != 1).count() <= 1
    }
}
