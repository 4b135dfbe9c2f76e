//! What recipes and the glossary name is there.

use std::collections::BTreeSet;
use std::path::Path;

use crate::source::{read, rust_files};

/// Pages for those who change the code, with paths from the root of the repository.
const PAGES: [&str; 1] = ["CONTRIBUTING.md"];

/// What stands in backticks, outside of blocks.
fn quoted(page: &str) -> Vec<String> {
    let text = read(Path::new(page));
    let outside = text.split("```").step_by(2).collect::<String>();
    outside.split('`').skip(1).step_by(2).map(String::from).collect()
}

/// A path of this repository; one with a NAME in it is yet to be written.
fn is_path(word: &str) -> bool {
    let plain = |c: char| c.is_alphanumeric() || "/._-".contains(c);
    word.contains('/') && word.chars().all(plain) && !word.contains("NAME")
}

/// The name of a test: a sentence.
fn is_test(word: &str) -> bool {
    word.matches('_').count() >= 3 && word.chars().all(|c| c.is_ascii_lowercase() || c == '_')
}

#[test]
fn files_that_are_named_are_there() {
    for page in PAGES {
        let paths: Vec<String> = quoted(page).into_iter().filter(|word| is_path(word)).collect();
        assert!(paths.len() > 30, "{page}: the test sees {paths:?}");
        for path in paths {
            assert!(Path::new(&path).exists(), "{page} names {path}, which is not there");
        }
    }
}

#[test]
fn words_of_the_code_in_the_glossary_are_there() {
    let text = read(Path::new("ARCHITECTURE.md"));
    let glossary = text.split("## Glossary").nth(1).unwrap();
    let folders = [
        "qcar-model/src",
        "qcar-dsl/src",
        "qcar-runtime/src",
        "src",
        "tests/blind/src",
        "models/src",
    ];
    let files: Vec<_> = folders
        .iter()
        .flat_map(|folder| rust_files(Path::new(folder)))
        .collect();
    let texts = files.iter().map(|file| format!("{} {}", file.display(), read(file)));
    let texts = texts.collect::<String>();
    let words = |text: &str| -> BTreeSet<String> {
        let letter = |c: char| c.is_alphanumeric() || c == '_';
        text.split(|c| !letter(c)).map(String::from).collect()
    };
    let known = words(&texts);
    let mut named = BTreeSet::new();
    for row in glossary.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = row.split('|').collect();
        assert_eq!(cells.len(), 5, "{row}");
        named.extend(cells[3].split('`').skip(1).step_by(2).flat_map(words));
    }
    assert!(named.len() > 40, "the test sees {named:?}");
    let unknown: Vec<&String> = named.difference(&known).collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn tests_that_are_named_are_there() {
    let folders = ["tests", "models/tests", "qcar-dsl/tests", "qcar-signals/tests"];
    let files = folders.iter().flat_map(|folder| rust_files(Path::new(folder)));
    let texts = files.map(|file| read(&file)).collect::<String>();
    let functions = texts.split("fn ").skip(1);
    let known: BTreeSet<&str> = functions.filter_map(|rest| Some(rest.split_once('(')?.0)).collect();
    for page in PAGES {
        let tests: Vec<String> = quoted(page).into_iter().filter(|word| is_test(word)).collect();
        assert!(tests.len() > 10, "{page}: the test sees {tests:?}");
        for test in tests {
            assert!(
                known.contains(&*test),
                "{page} names the test {test}, which is not there"
            );
        }
    }
}
