//! Model files from disk. The compiler itself takes texts; only this file reads files.

use std::cell::RefCell;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::compile::compile_wanted;
use crate::derive::response::Wanted;
use crate::diagnostic::Report;
use crate::program::schedule::Compiled;
use crate::source::Source;

/// The result of compiling a model file, with the files that were read.
pub struct CompiledFile {
    /// The model, or every mistake in its files.
    pub compiled: Result<Compiled, Report>,
    /// The files that were read, the model file first. A build script or macro makes Cargo watch them.
    pub read: Vec<LoadedFile>,
}

/// A file that was read.
#[derive(Clone, Debug)]
pub struct LoadedFile {
    /// The path as the model writes it.
    pub written: String,
    /// Its text; its name is the path relative to the folder.
    pub source: Source,
}

/// Compiles a model file in a folder, such as that of a package.
///
/// # Errors
/// Fails with the reason why the model file itself cannot be read.
pub fn compile_file(folder: &Path, path: &str) -> Result<CompiledFile, String> {
    compile_file_wanted(folder, path, Wanted::Jacobian)
}

/// The same with the wanted responses only.
///
/// # Errors
/// Fails as [`compile_file`] does.
pub fn compile_file_wanted(folder: &Path, path: &str, wanted: Wanted) -> Result<CompiledFile, String> {
    let files = Files::new(folder);
    let source = files.read(PathBuf::from(path), path)?;
    let compiled = compile_wanted(source, &|asking, written| files.load(asking, written), wanted);
    Ok(CompiledFile {
        compiled,
        read: files.finish(),
    })
}

/// The files of a folder, as a loader of the compiler.
pub struct Files {
    folder: PathBuf,
    read: RefCell<Vec<LoadedFile>>,
}

impl Files {
    /// The files of a folder; loaded files may be outside it.
    pub fn new(folder: &Path) -> Files {
        Files {
            folder: folder.to_path_buf(),
            read: RefCell::default(),
        }
    }

    /// Loads a file that another file names, relative to that one.
    ///
    /// # Errors
    /// Fails with the reason why it cannot be read.
    pub fn load(&self, asking: &str, written: &str) -> Result<Source, String> {
        let beside = Path::new(asking).parent().unwrap_or(Path::new(""));
        self.read(beside.join(written), written)
    }

    /// The files that were read, in order.
    pub fn finish(self) -> Vec<LoadedFile> {
        self.read.into_inner()
    }

    fn read(&self, path: PathBuf, written: &str) -> Result<Source, String> {
        let text = text(&self.folder.join(&path))?;
        let source = Source {
            name: path.display().to_string(),
            text,
        };
        self.read.borrow_mut().push(LoadedFile {
            written: written.to_string(),
            source: source.clone(),
        });
        Ok(source)
    }
}

/// Size of the longest model file, bytes.
const MOST: u64 = 4 << 20;

/// The text of a regular file; pipes and devices are refused, since they might never end.
fn text(path: &Path) -> Result<String, String> {
    let about = std::fs::metadata(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => "no such file".to_string(),
        _ => error.to_string(),
    })?;
    match (about.is_file(), about.len()) {
        (false, _) if about.is_dir() => Err("a folder".into()),
        (false, _) => Err("a pipe or device".into()),
        (true, length) if length > MOST => Err(format!("{length} bytes, more than any model has")),
        (true, _) => std::fs::read_to_string(path).map_err(|error| error.to_string()),
    }
}
