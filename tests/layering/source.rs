//! Source files as the invariants read them.

use std::fs;
use std::path::{Path, PathBuf};

pub fn read(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// All Rust files below a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
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

/// The text without comments and without unit tests, which may name anything.
pub fn code(text: &str) -> String {
    const TEST: &str = "#[cfg(test)]";
    let lines = text.lines();
    let mut code: String = lines
        .map(|line| line.split("//").next().unwrap_or("").to_string() + "\n")
        .collect();
    while let Some(start) = code.find(TEST) {
        let end = start + TEST.len() + end_of_item(&code[start + TEST.len()..]);
        code.replace_range(start..end, "");
    }
    code
}

/// Where an item ends: at its semicolon, or with its last brace.
fn end_of_item(text: &str) -> usize {
    let mut depth = 0;
    for (at, letter) in text.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 1 => return at + 1,
            '}' => depth -= 1,
            ';' if depth == 0 => return at + 1,
            _ => {}
        }
    }
    text.len()
}
