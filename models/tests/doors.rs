//! Inline text, a file and the folder of shipped models give the same bytes.

use std::collections::BTreeMap;
use std::path::Path;

use qcar_dsl::disk::compile_file;
use qcar_dsl::rust::module;
use qcar_runtime::response::parameters::Values;

/// The model as inline text.
mod inline {
    qcar_derive::axle! {
        // Thesis table 4.4.
        axle axle_c from "families/corner.axle" {
            "Strut on the upright, nothing else suspended"
        }
    }
}

/// The model as a file.
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

/// The matrices as the workbench builds them from the model's description.
#[test]
fn the_default_of_parameters_is_that_of_the_model() {
    use models::quarter_car::{ABOUT, Parameters};
    let resolved = Values::resolve(&ABOUT, &BTreeMap::new(), &BTreeMap::new()).unwrap();
    assert_eq!(Parameters::default().to_array().as_slice(), resolved.as_slice());
}

/// Compares each with a difference quotient of the matrices, whose error is about 1e-9 of the largest entry.
#[test]
fn derivatives_by_name_are_limits_of_differences() {
    use models::quarter_car::{PARAMETERS, Parameters, jacobians, state_space};
    let p = Parameters::default();
    let slopes = jacobians(&p);
    for place in 0..PARAMETERS {
        let moved = |sign: f64| {
            let mut values = p.to_array();
            values[place] *= 1.0 + sign * 1e-4;
            state_space(&Parameters::from_array(values))
        };
        let (more, less, step) = (moved(1.0), moved(-1.0), 2e-4 * p.to_array()[place]);
        let name = Parameters::NAMES[place];
        let close = |own: &[f64], more: &[f64], less: &[f64]| {
            for ((own, more), less) in own.iter().zip(more).zip(less) {
                let difference = (more - less) / step;
                let size = difference.abs().max(1e-6 * more.abs() / step);
                assert!(
                    (own - difference).abs() <= 1e-6 * size,
                    "{name}: {own} is not {difference}"
                );
            }
        };
        close(slopes.a[name].as_slice(), more.a.as_slice(), less.a.as_slice());
        close(slopes.b[name].as_slice(), more.b.as_slice(), less.b.as_slice());
        close(slopes.c[name].as_slice(), more.c.as_slice(), less.c.as_slice());
        close(slopes.d[name].as_slice(), more.d.as_slice(), less.d.as_slice());
    }
    assert!(slopes.a.get("k_tyre").is_none());
    assert_eq!(
        slopes.a.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        Parameters::NAMES
    );
}

fn generated(name: &str) -> String {
    let from_disk = compile_file(Path::new(""), &format!("axles/{name}.axle")).expect("a shipped model can be read");
    module(&from_disk.compiled.expect("a shipped model compiles"))
}
