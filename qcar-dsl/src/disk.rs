//! Model files from disk. The compiler itself takes texts; only this file reads files.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use crate::compile::compile_wanted;
use crate::derive::response::Wanted;
use crate::diagnostic::Report;
use crate::program::schedule::Compiled;
use crate::source::Source;

/// A model file compiled, and what was read for it.
pub struct FromDisk {
    /// The model, or every mistake in its files.
    pub compiled: Result<Compiled, Report>,
    /// What was read, the model file first. A door has it watched.
    pub read: Vec<Read>,
}

/// A file that was read.
#[derive(Clone, Debug)]
pub struct Read {
    /// The path as the model writes it.
    pub written: String,
    /// Its text; its name is the path relative to the folder of the door.
    pub source: Source,
}

/// Compiles a model file of a folder, such as a package.
///
/// # Errors
/// The reason why the file itself cannot be read.
pub fn compile_file(folder: &Path, path: &str) -> Result<FromDisk, String> {
    compile_file_wanted(folder, path, Wanted::Jacobian)
}

/// The same with what is wanted of the responses.
///
/// # Errors
/// As [`compile_file`].
pub fn compile_file_wanted(folder: &Path, path: &str, wanted: Wanted) -> Result<FromDisk, String> {
    let files = Files::new(folder);
    let source = files.read(PathBuf::from(path), path)?;
    let compiled = compile_wanted(source, &|asking, written| files.load(asking, written), wanted);
    Ok(FromDisk {
        compiled,
        read: files.finish(),
    })
}

/// The files of a folder, as a loader of the compiler.
pub struct Files {
    folder: PathBuf,
    read: RefCell<Vec<Read>>,
}

impl Files {
    /// Of a folder; what is loaded may lie outside it.
    pub fn new(folder: &Path) -> Files {
        Files {
            folder: folder.to_path_buf(),
            read: RefCell::default(),
        }
    }

    /// A file that another names, relative to that one.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub fn load(&self, asking: &str, written: &str) -> Result<Source, String> {
        let beside = Path::new(asking).parent().unwrap_or(Path::new(""));
        self.read(beside.join(written), written)
    }

    /// What was read, in order.
    pub fn finish(self) -> Vec<Read> {
        self.read.into_inner()
    }

    fn read(&self, path: PathBuf, written: &str) -> Result<Source, String> {
        let text = text(&self.folder.join(&path))?;
        let source = Source {
            name: path.display().to_string(),
            text,
        };
        self.read.borrow_mut().push(Read {
            written: written.to_string(),
            source: source.clone(),
        });
        Ok(source)
    }
}

/// Bytes of the longest model file.
const MOST: u64 = 4 << 20;

/// The text of a file, which is neither a pipe nor a device, since these might never end.
fn text(path: &Path) -> Result<String, String> {
    let about = std::fs::metadata(path).map_err(|error| error.to_string())?;
    match (about.is_file(), about.len()) {
        (false, _) if about.is_dir() => Err("a folder".into()),
        (false, _) => Err("a pipe or device".into()),
        (true, length) if length > MOST => Err(format!("{length} bytes, more than any model has")),
        (true, _) => std::fs::read_to_string(path).map_err(|error| error.to_string()),
    }
}
