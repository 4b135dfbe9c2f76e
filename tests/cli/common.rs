//! What the tests of the command line share: running it as a user would.

use std::fs;
use std::path::Path;
use std::process::Command;

/// What a command printed, and how it ended.
pub struct Ran {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

/// Runs `qcar` with these arguments in the root of the repository.
pub fn qcar(arguments: &[&str]) -> Ran {
    qcar_in(Path::new(env!("CARGO_MANIFEST_DIR")), arguments)
}

/// Runs `qcar` with these arguments in a folder.
pub fn qcar_in(folder: &Path, arguments: &[&str]) -> Ran {
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ran {
        status: output.status.code().unwrap(),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    }
}

/// Runs the words of a line as arguments of `qcar` in a folder.
pub fn run_line(folder: &Path, line: &str) -> Ran {
    qcar_in(folder, &line.split_whitespace().collect::<Vec<_>>())
}

/// Copies a folder with all that is in it.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        match entry.file_type().unwrap().is_dir() {
            true => copy(&entry.path(), &target),
            false => drop(fs::copy(entry.path(), target).unwrap()),
        }
    }
}

/// A folder that looks like the repository to those who only read its models, and can be written to.
pub fn repository() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    std::os::unix::fs::symlink(models, folder.path().join("models")).unwrap();
    folder
}

/// Runs `qcar`, which must succeed, and gives its standard output.
pub fn succeeds(arguments: &[&str]) -> String {
    let ran = qcar(arguments);
    assert_eq!(
        ran.status,
        0,
        "qcar {}\n{}{}",
        arguments.join(" "),
        ran.stdout,
        ran.stderr
    );
    ran.stdout
}
