//! The programs that judge, where they are there.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs `qcar`, which must succeed.
pub fn qcar(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "qcar {}\n{said}", arguments.join(" "));
    String::from_utf8(output.stdout).unwrap()
}

/// A Python that has a package: that of `.ci/run`, or the system's; else a word, so that nobody takes this for a check.
pub fn python_with(package: &str, unchecked: &str) -> Option<PathBuf> {
    python_that(&format!("import {package}"), package, unchecked)
}

/// A Python that runs a statement, for which it needs packages.
pub fn python_that(runs: &str, packages: &str, unchecked: &str) -> Option<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/python/bin/python");
    let can = |python: &PathBuf| {
        Command::new(python)
            .args(["-c", runs])
            .output()
            .is_ok_and(|ran| ran.status.success())
    };
    let found = [own, "python3".into()].into_iter().find(can);
    if found.is_none() {
        say(&format!(
            "not checked: {unchecked}, since Python or one of its packages is absent (pip install {packages})"
        ));
    }
    found
}

/// Past the capture of the test's output.
pub fn say(word: &str) {
    let mut out = std::io::stderr();
    writeln!(out, "{word}").unwrap();
}

/// Runs a program, which must succeed.
pub fn run(program: &Path, arguments: &[&str], folder: &Path) -> String {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let (out, said) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(
        output.status.success(),
        "{} {}\n{out}{said}",
        program.display(),
        arguments.join(" ")
    );
    out.into_owned()
}
