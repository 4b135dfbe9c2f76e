//! The module lists of each crate are the data's path, the crates keep apart, the engine knows no axle by name, each
//! crate can be packed, and what a page for engineers names is there.

// Source files.
mod source;
// What they name.
mod paths;
// The lists that they make.
mod modules;
// What is in a crate that is packed.
mod packages;
// What pages for engineers name.
mod documents;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use modules::Modules;
use source::{code, read, rust_files};

const CRATES: [&str; 10] = [
    ".",
    "qcar-derive",
    "qcar-dsl",
    "qcar-machine",
    "qcar-model",
    "qcar-python",
    "qcar-runtime",
    "qcar-signals",
    "models",
    "tests/blind",
];

#[test]
fn a_file_uses_only_what_is_declared_above_it() {
    let (mut files, mut offences) = (0, Vec::new());
    for root in CRATES {
        let root = Path::new(root).join("src/lib.rs");
        let modules = Modules::of(&root, &|file| fs::read_to_string(file).ok());
        files += modules.len();
        let below = modules.offences().into_iter();
        offences.extend(below.map(|(file, name)| format!("{} uses `{name}`, declared below it", file.display())));
    }
    assert!(files > 350, "the test sees {files} files: it looks in the wrong place");
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

/// Through lists, parents and names that a `use` brought elsewhere; not in comments and tests.
#[test]
fn a_use_of_what_is_declared_below_is_seen() {
    let files = [
        (
            "src/lib.rs",
            "mod early;\npub mod middle;\nmod late;\npub use late::{Late, third::Third};",
        ),
        (
            "src/early.rs",
            "mod own;\n// crate::late\nuse crate::{Third, middle::Fine};\n#[cfg(test)]\nmod tests {\n    use crate::late;\n}",
        ),
        ("src/early/own.rs", "use super::super::middle::last;"),
        (
            "src/middle/mod.rs",
            "mod first;\nmod last;\nuse last::Last;\nuse crate::early;",
        ),
        (
            "src/middle/first.rs",
            "fn first(_: super::Last, _: crate::early::Early) {}",
        ),
        ("src/middle/last.rs", "use super::{First, first::{self, other}};"),
        ("src/late.rs", "pub mod third;\nuse crate::{early, middle};"),
        ("src/late/third.rs", "use super::Late;"),
    ];
    let text = |file: &Path| {
        let found = files.iter().find(|(name, _)| Path::new(name) == file);
        found.map(|(_, text)| text.to_string())
    };
    let offences = Modules::of(Path::new("src/lib.rs"), &text).offences();
    let named: Vec<(&str, &str)> = offences
        .iter()
        .map(|(file, name)| (file.to_str().unwrap(), &**name))
        .collect();
    let expected = [
        ("src/early/own.rs", "middle::last"),
        ("src/early.rs", "late::third"),
        ("src/early.rs", "middle"),
        ("src/middle/first.rs", "middle::last"),
    ];
    assert_eq!(named, expected);
}

#[test]
fn compiler_and_runtime_do_not_know_each_other() {
    for compiler in ["qcar-dsl/Cargo.toml", "qcar-machine/Cargo.toml"] {
        assert!(!read(Path::new(compiler)).contains("qcar-runtime"));
    }
    assert!(!read(Path::new("qcar-runtime/Cargo.toml")).contains("qcar-dsl"));
}

#[test]
fn what_both_know_knows_nothing() {
    let manifest = read(Path::new("qcar-model/Cargo.toml"));
    assert!(!manifest.contains("dependencies"), "{manifest}");
}

#[test]
fn readers_of_files_know_nothing_else_of_the_workspace() {
    let manifest = read(Path::new("qcar-signals/Cargo.toml"));
    let others = ["qcar-model", "qcar-dsl", "qcar-runtime", "qcar-derive", "models"];
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
    let roots = ["qcar-model", "qcar-dsl", "qcar-machine", "qcar-runtime", "qcar-signals"].iter();
    for file in roots.flat_map(|root| rust_files(&Path::new(root).join("src"))) {
        let words = words_of_code(&read(&file));
        offences.extend(
            names
                .intersection(&words)
                .map(|name| format!("{} names `{name}`", file.display())),
        );
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

/// Where all tests of a crate are one program, a file that its list lacks would never run.
#[test]
fn every_file_of_tests_is_in_its_list() {
    for folder in [
        "models/tests",
        "qcar-dsl/tests",
        "qcar-machine/tests",
        "qcar-runtime/tests",
        "tests/blind/tests",
    ] {
        let list = read(&Path::new(folder).join("all.rs"));
        let files = rust_files(Path::new(folder)).into_iter();
        let files = files.filter(|file| file.parent() == Some(Path::new(folder)));
        let names: Vec<String> = files
            .map(|file| file.file_stem().unwrap().to_string_lossy().into())
            .collect();
        assert!(names.len() > 3, "the test looks in the wrong place");
        for name in names.iter().filter(|name| *name != "all") {
            assert!(list.contains(&format!("mod {name};")), "{folder}/all.rs lacks {name}");
        }
    }
}

fn stems(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| Some(entry.path().file_stem()?.to_str()?.to_string()))
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
