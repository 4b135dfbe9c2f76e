//! C99: a source file and a header.

use qcar_dsl::c::{Sources, sources};

use super::{File, Subject};

/// `stem.c` and `stem.h`.
pub fn files(subject: Subject, stem: &str) -> Vec<File> {
    let Sources { header, source } = sources(subject.compiled, subject.values, stem);
    [("c", source), ("h", header)]
        .map(|(extension, text)| File {
            name: format!("{stem}.{extension}"),
            content: text.into_bytes(),
        })
        .into()
}
