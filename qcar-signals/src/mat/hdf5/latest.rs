//! Newer versions of HDF5 with superblocks 2 and 3, as h5py writes with `libver="latest"`. The crate hdf5-pure reads
//! them.

use std::cell::Cell;
use std::panic::catch_unwind;

use hdf5_pure::{AttrValue, ChunkIndex, DType, Dataset, Error, File, FormatError, Group, Object};

use crate::bytes::Bytes;
use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::limit::of_unpacked;

use super::super::value::{Array, Fields, Value, Variable, is_read, of_fields};
use super::DEEPEST;

/// All variables of a file. What stands before its superblock is needed too, since addresses count from the start.
pub(super) fn variables(file: &Bytes, wanted: &Wanted) -> Read<Vec<Variable>> {
    let bytes = file.all("HDF5")?.into_owned();
    let reader = |what: &str| {
        let remedy = "save the file with MATLAB (-v7 or -v7.3), or with the earliest version of HDF5 allowed";
        Fault::new(file.place(0), what, "HDF5 that can be read", remedy)
    };
    // A damaged file reaches no unsafe code of the crate, but the crate may panic.
    let caught = catch_unwind(|| {
        let left = Cell::new(of_unpacked(bytes.len() as u64));
        let root = File::from_bytes(bytes)?.root();
        Walk { left, wanted }.variables(&root)
    });
    match caught {
        Ok(Ok(variables)) => Ok(variables),
        Ok(Err(error)) => Err(reader(&format!("what its reader refuses: {error}"))),
        Err(_) => Err(reader("what its reader cannot cope with")),
    }
}

/// Smallest number of bytes that an object is counted as.
const OBJECT: u64 = 1024;

/// A traversal of all objects.
struct Walk<'a> {
    /// Bytes that may still be read, since links may lead to the same objects again and again.
    left: Cell<u64>,
    wanted: &'a Wanted<'a>,
}

impl Walk<'_> {
    fn variables(&self, root: &Group) -> Result<Vec<Variable>, Error> {
        let mut variables = Vec::new();
        for name in root.datasets()?.into_iter().filter(|name| !name.starts_with('#')) {
            let value = self.dataset(&root.dataset(&name)?, Some(&name), DEEPEST)?;
            variables.push((name, value));
        }
        for name in root.groups()?.into_iter().filter(|name| !name.starts_with('#')) {
            let value = self.group(&root.group(&name)?, DEEPEST)?;
            variables.push((name, value));
        }
        variables.sort_by(|a, b| a.0.cmp(&b.0));
        let variable = |(name, value): (String, Value)| Variable {
            place: Place::Item(name.clone()),
            name,
            value,
        };
        Ok(variables.into_iter().map(variable).collect())
    }

    /// Returns true if this many bytes may still be read, and then counts them as read.
    fn may_take(&self, bytes: Option<u64>) -> bool {
        let left = bytes.and_then(|bytes| self.left.get().checked_sub(bytes.max(OBJECT)));
        self.left.set(left.unwrap_or(self.left.get()));
        left.is_some()
    }

    /// A group as a structure or a structure array.
    fn group(&self, group: &Group, depth: usize) -> Result<Value, Error> {
        let mut fields = Fields::new();
        if depth == 0 || !self.may_take(Some(OBJECT)) {
            return Ok(Value::Other("groups within groups without end"));
        }
        for name in group.datasets()? {
            let value = self.dataset(&group.dataset(&name)?, None, depth - 1)?;
            fields.push((name, value));
        }
        for name in group.groups()? {
            let value = self.group(&group.group(&name)?, depth - 1)?;
            fields.push((name, value));
        }
        Ok(of_fields(fields))
    }

    /// The value of a dataset; `variable` is its name if it is a variable.
    fn dataset(&self, dataset: &Dataset, variable: Option<&str>, depth: usize) -> Result<Value, Error> {
        match dataset.chunk_index() {
            Ok(Some(ChunkIndex::BTreeV2)) => {
                return Ok(Value::Other(
                    "data that may grow in several directions, whose chunks are not found",
                ));
            }
            Err(Error::Format(FormatError::InvalidLayoutVersion(_))) => {
                return Ok(Value::Other("data laid out as HDF5 2.0 began to, which is not known"));
            }
            index => index?,
        };
        let attributes = dataset.attrs()?;
        let class = match attributes.get("MATLAB_class") {
            Some(AttrValue::String(class) | AttrValue::AsciiString(class)) => class.as_str(),
            _ => "",
        };
        match dataset.dtype()? {
            DType::ObjectReference if depth > 0 && !attributes.contains_key("MATLAB_empty") => {
                let value = |object: &Object| match object {
                    Object::Group(group) => self.group(group, depth - 1),
                    Object::Dataset(dataset) => self.dataset(dataset, None, depth - 1),
                    _ => Ok(Value::Other("neither group nor data")),
                };
                let cells = dataset.dereference()?.iter().map(value).collect::<Result<_, _>>();
                return Ok(Value::Cells(cells?));
            }
            DType::ObjectReference => return Ok(Value::Cells(Vec::new())),
            DType::F32 | DType::F64 | DType::I8 | DType::I16 | DType::I32 | DType::I64 => {}
            DType::U8 | DType::U16 | DType::U32 | DType::U64 => {}
            _ => return Ok(Value::Other("data that are no real numbers")),
        }
        // HDF5 counts its dimensions from the other end.
        let mut dimensions = dataset.shape()?;
        dimensions.reverse();
        let sizes = dimensions.iter().copied();
        let declared = sizes.chain([dataset.element_size()?]).try_fold(1, u64::checked_mul);
        if !self.may_take(declared) {
            return Ok(Value::Other(
                "more data than a file of this size may give; QCAR_MAX_MIB sets another limit",
            ));
        }
        if attributes.contains_key("MATLAB_empty") {
            return Ok(Value::Numbers(Array::unread(vec![0])));
        }
        if class == "char" {
            return Ok(Value::Text(String::from_utf16_lossy(&dataset.read_u16()?)));
        }
        if variable.is_some_and(|name| !is_read(name, &dimensions, self.wanted)) {
            return Ok(Value::Numbers(Array::unread(dimensions)));
        }
        let numbers = dataset.read_f64()?;
        Ok(Value::Numbers(Array { dimensions, numbers }))
    }
}
