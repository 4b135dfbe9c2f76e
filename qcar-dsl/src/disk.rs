//! Model files from disk, for the doors. The compiler itself takes texts; nothing but this file reads one.

use std::cell::RefCell;
use std::path::Path;

use crate::compile::compile;
use crate::diagnostic::Report;
use crate::schedule::Compiled;
use crate::source::Source;

/// A model file compiled, and what was read for it.
pub struct FromDisk {
    /// The model, or every mistake in its files.
    pub compiled: Result<Compiled, Report>,
    /// The model file, then each family file: the path as the model writes it, and the text. A door has them watched.
    pub read: Vec<(String, Source)>,
}

/// Compiles a model file.
///
/// # Errors
/// The reason why the file itself cannot be read.
pub fn compile_file(path: &str) -> Result<FromDisk, String> {
    let source = read(Path::new(path))?;
    let files = Files::default();
    files.0.borrow_mut().push((path.to_string(), source.clone()));
    let compiled = compile(source, &|asking, written| files.load(asking, written));
    Ok(FromDisk {
        compiled,
        read: files.0.into_inner(),
    })
}

/// The files that were read, in order.
#[derive(Default)]
pub struct Files(pub RefCell<Vec<(String, Source)>>);

impl Files {
    /// A file that another names, relative to that one.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub fn load(&self, asking: &str, written: &str) -> Result<Source, String> {
        let beside = Path::new(asking).parent().unwrap_or(Path::new(""));
        let source = read(&beside.join(written))?;
        self.0.borrow_mut().push((written.to_string(), source.clone()));
        Ok(source)
    }
}

fn read(path: &Path) -> Result<Source, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    Ok(Source {
        name: path.display().to_string(),
        text,
    })
}
