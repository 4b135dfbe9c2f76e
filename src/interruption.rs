//! Ctrl-C: complete files stay, incomplete ones are removed, and the user learns which files are complete.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::files;
use crate::progress;
use crate::terminal::to_error;

/// Exit status that shells report after Ctrl-C: 128 plus the number of the signal.
const EXIT_STATUS: i32 = 130;

/// Interim results: complete parts of the answer, and sentences.
static KNOWN: Mutex<(String, String)> = Mutex::new((String::new(), String::new()));

/// Folder, name and text of a file.
type Unwritten = (PathBuf, String, String);

/// Files that are written if the work is stopped now.
static LEFT: Mutex<Vec<Unwritten>> = Mutex::new(Vec::new());

/// Stores a complete part of the answer, which goes to standard output if the work is stopped.
pub fn keep(part: &str) {
    known().0.push_str(part);
}

/// Stores a sentence on an interim result, for the message after a stop, unless it is the last one.
pub fn note(sentence: &str) {
    let line = format!("so far: {sentence}\n");
    let mut known = known();
    if !known.1.ends_with(&line) {
        known.1.push_str(&line);
    }
}

/// Stores files that are written if the work is stopped, instead of those stored before.
pub fn leave(folder: &Path, files: Vec<(String, String)>) {
    *left() = files
        .into_iter()
        .map(|(name, text)| (folder.into(), name, text))
        .collect();
}

fn left() -> MutexGuard<'static, Vec<Unwritten>> {
    LEFT.lock().unwrap_or_else(PoisonError::into_inner)
}

fn known() -> MutexGuard<'static, (String, String)> {
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Installs the handler of Ctrl-C.
pub fn listen() {
    // On a system without handlers, Ctrl-C ends the program at once.
    let _ = ctrlc::set_handler(end);
}

#[expect(
    clippy::disallowed_methods,
    reason = "complete files are here, and no other was started"
)]
fn end() {
    let unwritten: Vec<String> = left()
        .iter()
        .filter_map(|(folder, name, text)| files::put(folder, name, text).err())
        .map(|error| format!("{error}\n"))
        .collect();
    // No other file is started while this lock is held.
    let written = files::close();
    let doing = progress::clear().map_or(String::new(), |what| format!(" at {what}"));
    let known = known();
    let (parts, sentences) = (known.0.as_bytes(), &known.1);
    // A reader that has closed the pipe needs no more output.
    let _ = std::io::stdout().write_all(parts);
    to_error(&format!(
        "interrupted{doing}; {}\n{sentences}{}",
        inventory(&written),
        unwritten.concat()
    ));
    process::exit(EXIT_STATUS);
}

fn inventory(written: &[PathBuf]) -> String {
    let names: Vec<String> = written.iter().map(|file| file.display().to_string()).collect();
    match names.as_slice() {
        [] => "no file was written".into(),
        names => format!("complete: {}", names.join(", ")),
    }
}
