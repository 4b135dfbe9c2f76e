//! Shipped models, and models that use every operation of the language.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use qcar_dsl::disk::compile_file;
use qcar_dsl::schedule::Compiled;

use super::comparison::{At, Comparison};

fn files() -> Vec<PathBuf> {
    let folders = ["../models/axles", "../models/tests/zoo"];
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let files = files.map(|file| file.unwrap().path());
    files
        .filter(|file| file.extension().is_some_and(|extension| extension == "axle"))
        .collect()
}

pub fn compiled(file: &Path) -> Compiled {
    let from_disk = compile_file(Path::new(""), file.to_str().unwrap()).unwrap();
    from_disk
        .compiled
        .unwrap_or_else(|report| panic!("{}: {report}", file.display()))
}

#[test]
fn every_model_has_the_bits_of_the_interpreter() {
    let files = files();
    assert!(files.len() > 20, "the test sees {} models", files.len());
    for file in files {
        let both = Comparison::new(&compiled(&file));
        let numbers = || prop::collection::vec(-1.0..1.0f64, 256);
        let config = ProptestConfig {
            failure_persistence: None,
            ..ProptestConfig::with_cases(12)
        };
        proptest!(config, |(numbers in numbers())| both.compare(&At(&numbers)));
    }
}
