//! Files to read and to write.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fs, process};

use qcar_runtime::bounded;
use qcar_runtime::error::{InputError, Place, Problem};

use crate::failure::{Failure, flag};

/// Reads a text file.
///
/// # Errors
/// Fails if the file is missing, a folder, or not UTF-8.
pub fn read_text(file: &Path) -> Result<String, InputError> {
    bounded::text(file).map_err(|error| {
        let remedy = match error.kind() {
            ErrorKind::InvalidData => "save the file as UTF-8",
            _ => "correct the path, or put the file there",
        };
        Problem::new(file, Place::File, error.to_string(), "a readable text file", remedy).into()
    })
}

/// Value of a flag for a folder of results. It is tested before the work starts, and the test leaves no file.
///
/// # Errors
/// Fails with the error of the system if a file in the folder, or the folder itself, cannot be created.
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

/// True if something has that name, be it a link to nothing.
pub fn is_in_use(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

/// Checks that the file of the flag `--out` replaces no other.
///
/// # Errors
/// Fails if the name is in use.
pub fn must_be_free(path: &Path) -> Result<(), Failure> {
    if !is_in_use(path) {
        return Ok(());
    }
    let found = format!("{}, which exists already", path.display());
    let remedy = "choose another name, or move the file away";
    Err(flag("--out", found, "a name that is not in use", remedy).into())
}

/// Completed files in the order of writing. The lock is held while a file is written.
static WRITTEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Writes a file under a temporary name, then renames it, so that no incomplete file looks complete.
///
/// # Errors
/// Fails if the folder cannot be created or written to.
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
            // Removes the incomplete file. If that fails too, the temporary name shows that it is incomplete.
            let _ = fs::remove_file(&unfinished);
            let remedy = "choose another folder, or free some space there";
            Err(Problem::new(path, Place::File, error.to_string(), "a writable place", remedy).into())
        }
    }
}

/// Writes files and folders that are new. If that fails, removes what was begun, so that the same command can be
/// repeated.
///
/// # Errors
/// Fails as `write` does.
pub fn write_new<T, E>(paths: &[&Path], write: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let result = write();
    if result.is_err() {
        let mut written = close();
        for path in paths {
            // Whatever cannot be removed is named by the error when the command is repeated.
            let _ = if path.is_dir() {
                fs::remove_dir_all(path)
            } else {
                fs::remove_file(path)
            };
            written.retain(|own| !own.starts_with(path));
        }
    }
    result
}

/// Gives a complete file its final name.
///
/// # Errors
/// Fails with the error of the system.
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

/// Waits for the file that is being written. While the guard is held, no other file is started.
pub fn close() -> MutexGuard<'static, Vec<PathBuf>> {
    WRITTEN.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::{put, write_new};

    /// The second file cannot be written, because a folder has its name.
    #[test]
    fn what_was_begun_is_removed_if_the_rest_fails() {
        let place = tempfile::tempdir().expect("a folder");
        let [first, folder] = ["first", "folder"].map(|name| place.path().join(name));
        let occupied = place.path().join("second");
        fs::create_dir(&occupied).expect("a folder");
        let write = || {
            put(place.path(), "first", "1")?;
            put(&folder, "inside", "2")?;
            put(place.path(), "second", "3")
        };
        assert!(write_new(&[&first, &folder], write).is_err());
        let left = fs::read_dir(place.path()).expect("it is there");
        let left: Vec<_> = left.map(|entry| entry.expect("it is there").path()).collect();
        assert_eq!(left, [occupied]);
        assert!(write_new::<(), ()>(&[Path::new("nowhere")], || Err(())).is_err());
    }
}
