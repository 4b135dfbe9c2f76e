//! Ctrl-C: what is done stays, nothing is left half-written, and the user is told which is which.

use std::path::PathBuf;
use std::process;

use crate::files;
use crate::progress;

/// What shells report of a program that Ctrl-C has ended: 128 and the number of the signal.
const EXIT_STATUS: i32 = 130;

/// From here on, Ctrl-C ends the program in order.
pub fn listen() {
    // Where a system gives no handler, Ctrl-C ends the program as ever.
    let _ = ctrlc::set_handler(end);
}

fn end() {
    // No other file is begun while this is held.
    let written = files::close();
    let doing = progress::clear().map_or(String::new(), |what| format!(" at {what}"));
    eprintln!("interrupted{doing}; {}", inventory(&written));
    process::exit(EXIT_STATUS);
}

fn inventory(written: &[PathBuf]) -> String {
    let names: Vec<String> = written.iter().map(|file| file.display().to_string()).collect();
    match names.as_slice() {
        [] => "no file was written".into(),
        names => format!("complete: {}", names.join(", ")),
    }
}
