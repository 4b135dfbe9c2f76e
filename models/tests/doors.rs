//! Inline text, a file and the folder of shipped models give the same bytes.

use std::path::Path;

use qcar_dsl::disk::compile_file;
use qcar_dsl::rust::module;

/// The door of inline text.
mod inline {
    qcar_derive::axle! {
        // Thesis table 4.4.
        axle axle_c from "families/corner.axle" {
            "Strut on the upright, nothing else suspended"
        }
    }
}

/// The door of a file.
mod file {
    qcar_derive::axle_file!("axles/axle_c.axle");
}

#[test]
fn three_doors_give_the_same_code() {
    assert_eq!(inline::axle_c::FINGERPRINT, models::axle_c::FINGERPRINT);
    assert_eq!(file::axle_c::FINGERPRINT, models::axle_c::FINGERPRINT);
    let text = generated("axle_c");
    assert!(text.contains(&format!("FINGERPRINT: u64 = {:#018x};", models::axle_c::FINGERPRINT)));
}

#[test]
fn the_folder_is_compiled_byte_for_byte() {
    let built = include_str!(concat!(env!("OUT_DIR"), "/models.rs"));
    for shipped in models::all() {
        assert!(
            built.contains(&generated(shipped.name)),
            "{} is not what the compiler prints",
            shipped.name
        );
    }
}

#[test]
fn every_file_of_the_folder_is_a_model() {
    let folder = std::fs::read_dir("axles").expect("tests run in their package");
    let mut files: Vec<String> = folder
        .map(|entry| entry.unwrap().path().display().to_string())
        .collect();
    files.sort();
    let shipped: Vec<&str> = models::all().iter().map(|shipped| shipped.file).collect();
    assert_eq!(shipped, files);
}

#[test]
fn the_parameters_of_a_generated_model_are_an_array_and_back() {
    use models::quarter_car::{PARAMETERS, Parameters};
    let values: [f64; PARAMETERS] = std::array::from_fn(|place| place as f64);
    assert_eq!(Parameters::from_array(values).to_array(), values);
    assert_eq!(Parameters::NAMES[0], models::quarter_car::ABOUT.parameters[0].name);
}

fn generated(name: &str) -> String {
    let from_disk = compile_file(Path::new(""), &format!("axles/{name}.axle")).expect("a shipped model can be read");
    module(&from_disk.compiled.expect("a shipped model compiles"))
}
