//! A campaign whose runs are files of rigs and other programs.

#[path = "../support/counting.rs"]
mod counting;
// What samples show to be wrong.
mod findings;
// The same fit from every format.
mod formats;
// A campaign begun with files.
mod import;
// How much of a long recording is in memory.
mod memory;
// What is refused, and how.
mod refused;
// Times that are stored and uneven.
mod stamps;
// Parts of a recording, and channels of several rates.
mod windows;
// What is written and read again.
mod writers;

use std::fs;
use std::path::Path;
use std::process::Command;

use qcar_runtime::campaign::Campaign;
use qcar_runtime::error::InputError;
use tempfile::TempDir;

/// What stands before the channels of a small campaign.
const HEAD: &str = "format = 1\nname = \"small\"\nmodel = \"quarter_car\"\n\n[vehicle]\nm_corner = 400.0\n\n";

/// A channel of the pad or the body on the left side, with further keys.
fn channel(location: &str, keys: &str) -> String {
    format!(
        "[[channel]]\nname = \"{location}_left_z\"\nlocation = \"{location}\"\nside = \"left\"\naxis = \"z\"\n\
         quantity = \"acceleration\"\n{keys}\n\n"
    )
}

/// A time history of this file, with further keys.
fn history(file: &str, keys: &str) -> String {
    format!("[[run]]\nkind = \"time_history\"\nfile = \"{file}\"\nrole = \"fit\"\nband_limited = true\n{keys}\n\n")
}

/// A folder with a campaign of these sections and this file.
fn folder(sections: &str, file: (&str, &[u8])) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("campaign.toml"), HEAD.to_string() + sections).unwrap();
    fs::write(folder.path().join(file.0), file.1).unwrap();
    folder
}

fn open(folder: &Path) -> Result<Campaign, InputError> {
    Campaign::open(folder)
}

/// Exit status and all that was printed.
fn qcar(folder: &Path, line: &str) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
    let output = command
        .args(line.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap(), String::from_utf8(text).unwrap())
}
