//! The module list of each crate is the data's path, the crates keep apart, and the engine knows no axle by name.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const CRATES: [&str; 4] = [".", "qcar-dsl", "qcar-runtime", "qcar-signals"];

#[test]
fn a_file_uses_only_what_is_declared_above_it() {
    let mut offences = Vec::new();
    for root in CRATES {
        let order = modules(&read(&Path::new(root).join("src/lib.rs")));
        for (at, module) in order.iter().enumerate() {
            for file in files_of(&Path::new(root).join("src"), module) {
                let used = used_modules(&read(&file), &order);
                let below = used.into_iter().filter(|name| !order[..=at].contains(name));
                offences.extend(below.map(|name| format!("{} uses `{name}`, declared below it", file.display())));
            }
        }
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn compiler_and_runtime_do_not_know_each_other() {
    assert!(!read(Path::new("qcar-dsl/Cargo.toml")).contains("qcar-runtime"));
    assert!(!read(Path::new("qcar-runtime/Cargo.toml")).contains("qcar-dsl"));
}

#[test]
fn readers_of_files_know_nothing_else_of_the_workspace() {
    let manifest = read(Path::new("qcar-signals/Cargo.toml"));
    let others = ["qcar-dsl", "qcar-runtime", "qcar-derive", "models"];
    assert!(others.iter().all(|name| !manifest.contains(name)));
}

#[test]
fn the_engine_names_no_axle_and_no_effect() {
    let names = ["models/axles", "models/effects"]
        .iter()
        .flat_map(|folder| stems(Path::new(folder)));
    let mut names: BTreeSet<String> = names.collect();
    assert!(
        names.contains("axle_a") && names.contains("bump_stop"),
        "the test looks in the wrong place"
    );
    // A term of the language, after which the effect that adds one is called.
    names.remove("inerter");
    let mut offences = Vec::new();
    for file in ["qcar-dsl/src", "qcar-runtime/src", "qcar-signals/src"]
        .iter()
        .flat_map(|root| rust_files(Path::new(root)))
    {
        let words = words_of_code(&read(&file));
        offences.extend(
            names
                .intersection(&words)
                .map(|name| format!("{} names `{name}`", file.display())),
        );
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

fn read(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// The names of the `mod` lines, in their order.
fn modules(lib: &str) -> Vec<String> {
    let declared = lib
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ").or(line.strip_prefix("mod ")));
    declared.map(|rest| rest.trim_end_matches(';').to_string()).collect()
}

/// All files below `module/`, and `module.rs`.
fn files_of(source: &Path, module: &str) -> Vec<PathBuf> {
    let own = source.join(format!("{module}.rs"));
    let mut files = rust_files(&source.join(module));
    files.extend(own.exists().then_some(own));
    assert!(!files.is_empty(), "the test looks in the wrong place for `{module}`");
    files
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn stems(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| Some(entry.path().file_stem()?.to_str()?.to_string()))
        .collect()
}

/// The modules of the crate that follow `crate::` in code.
fn used_modules(text: &str, order: &[String]) -> BTreeSet<String> {
    let code = code(text);
    let after = code
        .match_indices("crate::")
        .map(|(at, found)| &code[at + found.len()..]);
    let names = after.flat_map(|rest| match rest.strip_prefix('{') {
        Some(list) => list
            .split('}')
            .next()
            .unwrap_or("")
            .split(',')
            .map(first_word)
            .collect(),
        None => vec![first_word(rest)],
    });
    names.filter(|name| order.contains(name)).collect()
}

fn first_word(text: &str) -> String {
    text.trim_start()
        .chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_')
        .collect()
}

/// The text without comments and without unit tests, which may name anything.
fn code(text: &str) -> String {
    let before_tests = text.split("#[cfg(test)]").next().unwrap_or(text);
    before_tests
        .lines()
        .map(|line| line.split("//").next().unwrap_or("").to_string() + "\n")
        .collect()
}

/// Identifiers and texts of one word; a longer text is a message or an example, which decides nothing.
fn words_of_code(text: &str) -> BTreeSet<String> {
    let code = code(text).replace("\\\"", "'").replace("'\"'", "' '");
    let parts = code.split('"').enumerate();
    let deciding = parts.filter(|(place, part)| place % 2 == 0 || !part.contains(' '));
    let deciding: Vec<&str> = deciding.map(|(_, part)| part).collect();
    deciding
        .join(" ")
        .split(|c: char| !c.is_alphanumeric() && c != '_')
        .map(String::from)
        .collect()
}
