//! The programs that judge, where they are there.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex, OnceLock};

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

/// A Python that runs a statement, for which it needs packages. Many tests ask for the same, and a package can take
/// seconds to import, so that each statement is run once.
pub fn python_that(runs: &str, packages: &str, unchecked: &str) -> Option<PathBuf> {
    static ASKED: Mutex<BTreeMap<String, Arc<OnceLock<Option<PathBuf>>>>> = Mutex::new(BTreeMap::new());
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/python/bin/python");
    let can = |python: &PathBuf| {
        Command::new(python)
            .args(["-c", runs])
            .output()
            .is_ok_and(|ran| ran.status.success())
    };
    let asked = Arc::clone(ASKED.lock().unwrap().entry(runs.to_owned()).or_default());
    let found = asked
        .get_or_init(|| [own, "python3".into()].into_iter().find(can))
        .clone();
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
