//! Ctrl-C: finished files stay, no file is left half-written, and the user learns which files are finished.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::files;
use crate::progress;

/// What shells report of a program that Ctrl-C has ended: 128 and the number of the signal.
const EXIT_STATUS: i32 = 130;

/// What is known by now: whole parts of the answer, and sentences on the way to it.
static KNOWN: Mutex<(String, String)> = Mutex::new((String::new(), String::new()));

/// A folder, a name in it, and the text.
type Unwritten = (PathBuf, String, String);

/// What is written if the work is stopped now.
static LEFT: Mutex<Vec<Unwritten>> = Mutex::new(Vec::new());

/// Keeps a whole part of the answer: it goes to standard output if the rest is never known.
pub fn keep(part: &str) {
    known().0.push_str(part);
}

/// Notes what is known on the way to an answer, for the user who does not wait for it.
pub fn note(sentence: &str) {
    known().1.push_str(&format!("so far: {sentence}\n"));
}

/// Keeps files that are to be written if the rest is never known, in place of those that were kept before.
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

/// From here on, Ctrl-C ends the program in order.
pub fn listen() {
    // Where a system gives no handler, Ctrl-C ends the program as ever.
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
    // No other file is begun while this is held.
    let written = files::close();
    let doing = progress::clear().map_or(String::new(), |what| format!(" at {what}"));
    let known = known();
    let (parts, sentences) = (known.0.as_bytes(), &known.1);
    // Whoever has stopped reading has what was wanted.
    let _ = std::io::stdout().write_all(parts);
    eprint!(
        "interrupted{doing}; {}\n{sentences}{}",
        inventory(&written),
        unwritten.concat()
    );
    process::exit(EXIT_STATUS);
}

fn inventory(written: &[PathBuf]) -> String {
    let names: Vec<String> = written.iter().map(|file| file.display().to_string()).collect();
    match names.as_slice() {
        [] => "no file was written".into(),
        names => format!("complete: {}", names.join(", ")),
    }
}
