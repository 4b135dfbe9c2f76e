//! Files to read and to write.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fs, process};

use qcar_runtime::bounded;
use qcar_runtime::error::{InputError, Place, Problem};

/// Reads a text file, or says why it cannot.
///
/// # Errors
/// A file that is missing, a folder, or not UTF-8.
pub fn read_text(file: &Path) -> Result<String, InputError> {
    bounded::text(file).map_err(|error| {
        let remedy = "correct the path, or put the file there";
        Problem::new(file, Place::File, error.to_string(), "a readable text file", remedy).into()
    })
}

/// The value of a flag that names a folder for results: refused before the work for it is begun where nothing can be
/// written. Nothing stays there.
///
/// # Errors
/// What the system says of a file in the folder, or in the one in which it is to be made.
pub fn folder_for_results(name: &str) -> Result<PathBuf, String> {
    let folder = PathBuf::from(name);
    let existing = folder.ancestors().find(|own| own.exists()).unwrap_or(Path::new("."));
    let probe = existing.join(format!("qcar-{}.part", process::id()));
    match fs::write(&probe, "").and_then(|()| fs::remove_file(&probe)) {
        Ok(()) => Ok(folder),
        Err(error) => Err(format!(
            "found {}: {error}, expected a writable place; choose another folder, or free some space there",
            existing.display()
        )),
    }
}

/// The files that stand complete, in the order in which they were written; held while one is being written.
static WRITTEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Writes a file whole under another name, then renames it, so that no half-written file seems complete.
///
/// # Errors
/// A folder that cannot be made or written to.
pub fn put(folder: &Path, name: &str, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), InputError> {
    let (path, unfinished) = (folder.join(name), folder.join(format!("{name}.part")));
    let mut written = close();
    let put = fs::create_dir_all(folder)
        .and_then(|()| fs::write(&unfinished, content))
        .and_then(|()| fs::rename(&unfinished, &path));
    match put {
        Ok(()) => {
            written.push(path);
            Ok(())
        }
        Err(error) => {
            // Of no use to anybody; where even that fails, its name says what it is.
            let _ = fs::remove_file(&unfinished);
            let remedy = "choose another folder, or free some space there";
            Err(Problem::new(path, Place::File, error.to_string(), "a writable place", remedy).into())
        }
    }
}

/// Gives a complete file its final name.
///
/// # Errors
/// What the system says.
pub fn finish(unfinished: &Path, path: &Path) -> Result<(), InputError> {
    let mut written = close();
    fs::rename(unfinished, path).map_err(|error| {
        let remedy = "move the existing file away, and repeat the command";
        Problem::new(
            path,
            Place::File,
            error.to_string(),
            "a name for the finished file",
            remedy,
        )
    })?;
    written.push(path.into());
    Ok(())
}

/// Waits for the file that is being written. As long as the list of complete files is held, no other is begun.
pub fn close() -> MutexGuard<'static, Vec<PathBuf>> {
    WRITTEN.lock().unwrap_or_else(PoisonError::into_inner)
}
