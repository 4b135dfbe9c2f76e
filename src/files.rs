//! Text files to read and to write.

use std::fs;
use std::path::Path;

use qcar_runtime::error::{InputError, Place, Problem};

/// Reads a text file, or says why it cannot.
///
/// # Errors
/// A file that is missing, a folder, or not UTF-8.
pub fn read_text(file: &Path) -> Result<String, InputError> {
    fs::read_to_string(file).map_err(|error| {
        let remedy = "correct the path, or put the file there";
        Problem::new(file, Place::File, error.to_string(), "a readable text file", remedy).into()
    })
}

/// Writes a file whole under another name, then renames it, so that nothing half-written looks complete.
///
/// # Errors
/// A folder that cannot be made or written to.
pub fn put(folder: &Path, name: &str, content: &str) -> Result<(), InputError> {
    let (path, unfinished) = (folder.join(name), folder.join(format!("{name}.part")));
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&unfinished, content));
    written.and_then(|()| fs::rename(&unfinished, &path)).map_err(|error| {
        let remedy = "choose another folder, or make room there";
        Problem::new(path, Place::File, error.to_string(), "a place to write to", remedy).into()
    })
}
