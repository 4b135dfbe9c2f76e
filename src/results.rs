//! Folders of results: a verb replaces only what it has written itself, for the same model and data.

use std::path::{Path, PathBuf};

use qcar_runtime::error::{InputError, Place, Problem};
use serde_json::Value;

use crate::files::is_in_use;

/// The files of a verb in a folder. One of them, the record, is JSON that names what they are results of. It is written
/// first, so that the same command may be repeated after an interruption.
pub struct Results {
    /// Name of the record.
    pub record: &'static str,
    /// JSON pointers of the two names in the record.
    pub names: [&'static str; 2],
    /// Words between both, such as `fitted to`.
    pub between: &'static str,
    /// Names of the other files, as far as they are the same for all models and data.
    pub files: &'static [&'static str],
}

impl Results {
    /// Checks that nothing is replaced but results of the same names. `more` are paths of files whose names depend on
    /// model or data.
    ///
    /// # Errors
    /// Fails if the record has other names, or if there is no record and one of the files exists.
    pub fn check(
        &self,
        folder: &Path,
        names: [&str; 2],
        more: impl IntoIterator<Item = PathBuf>,
    ) -> Result<(), InputError> {
        let record = folder.join(self.record);
        let expected = format!("a new folder, or results of {}", self.joined(names));
        if is_in_use(&record) {
            let there = names_in(&record, self.names);
            let there = there.each_ref().map(String::as_str);
            if there == names {
                return Ok(());
            }
            let (found, remedy) = (
                format!("results of {}", self.joined(there)),
                "choose another folder, or remove them",
            );
            return Err(Problem::new(record, Place::File, found, expected, remedy).into());
        }
        let own = self.files.iter().map(|name| folder.join(name));
        match own.chain(more).find(|file| is_in_use(file)) {
            None => Ok(()),
            Some(file) => {
                let found = format!("a file of another origin, for there is no {}", record.display());
                let remedy = "choose another folder, or move the file away";
                Err(Problem::new(file, Place::File, found, expected, remedy).into())
            }
        }
    }

    fn joined(&self, [first, second]: [&str; 2]) -> String {
        format!("{first} {} {second}", self.between)
    }
}

/// The names that a record gives at these places.
fn names_in(record: &Path, places: [&str; 2]) -> [String; 2] {
    let bytes = std::fs::read(record).unwrap_or_default();
    let json: Value = serde_json::from_slice(&bytes).unwrap_or_default();
    places.map(|place| {
        let name = json.pointer(place).and_then(Value::as_str);
        name.unwrap_or("something else").into()
    })
}
