//! Refused models: rustc marks the wrong token, and all mistakes are reported together.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder in which `axle_file!` searches for models.
const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/refused");

#[test]
fn mistakes_are_shown_where_they_are() {
    let (library, out) = (built_last(), tempfile::tempdir().unwrap());
    for case in cases() {
        let rustc = Command::new(std::env::var_os("RUSTC").unwrap_or("rustc".into()))
            .args([
                "--edition=2024",
                "--emit=metadata",
                "--diagnostic-width=140",
                "--extern",
            ])
            .arg(format!("qcar_derive={}", library.display()))
            .arg("--out-dir")
            .arg(out.path())
            .arg(format!("{case}.rs"))
            .current_dir(CASES)
            .env("CARGO_MANIFEST_DIR", CASES)
            .output()
            .unwrap();
        assert!(!rustc.status.success(), "{case} is accepted");
        insta::assert_snapshot!(case, String::from_utf8(rustc.stderr).unwrap());
    }
}

/// Programs that each use a macro with mistakes.
fn cases() -> Vec<String> {
    let files = fs::read_dir(CASES).unwrap().map(|file| file.unwrap().path());
    let programs = files.filter(|file| file.extension().is_some_and(|own| own == "rs"));
    let mut names: Vec<String> = programs
        .map(|file| file.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// The library of the macro, beside this test. Cargo has just updated one, so the newest one, even with other features,
/// is built from the present sources.
fn built_last() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let beside = fs::read_dir(test.parent().unwrap()).unwrap();
    let is_library = |file: &Path| {
        let name = file.file_stem().unwrap().to_string_lossy();
        name.strip_prefix(std::env::consts::DLL_PREFIX)
            .is_some_and(|name| name.starts_with("qcar_derive-"))
            && file
                .extension()
                .is_some_and(|own| own == std::env::consts::DLL_EXTENSION)
    };
    let libraries = beside.map(|file| file.unwrap().path()).filter(|file| is_library(file));
    libraries
        .max_by_key(|file| fs::metadata(file).unwrap().modified().unwrap())
        .expect("cargo builds the macro before its test")
}
