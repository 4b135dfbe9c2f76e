//! A model with an effect is a file like any other: it has the same bytes every time, and it compiles.

use std::path::Path;

use qcar_derive::axle_file;
use qcar_dsl::disk::compile_file;
use qcar_dsl::patch::Patch;
use qcar_dsl::rust::module;
use qcar_dsl::source::Source;
use qcar_runtime::model::Model;

axle_file!("tests/zoo/axle_b_with_coulomb_friction.axle");
axle_file!("tests/zoo/axle_c_with_suspended_mass.axle");
axle_file!("tests/zoo/axle_c_with_tire_dynamic_stiffness.axle");

const FILE: &str = "tests/zoo/axle_b_with_coulomb_friction.axle";

fn patched(model: &str, effect: &str, place: &str) -> qcar_dsl::patch::Patched {
    let model = compile_file(Path::new(""), model).unwrap().compiled.unwrap().model;
    let shipped = models::effects().iter().find(|shipped| shipped.name == effect).unwrap();
    let source = Source {
        name: shipped.file.into(),
        text: shipped.text.into(),
    };
    Patch::read(source).unwrap().apply(&model, place, &|_| None).unwrap()
}

#[test]
fn a_patch_writes_the_same_file_every_time() {
    let kept = std::fs::read_to_string(FILE).unwrap();
    let patched = patched("axles/axle_b.axle", "coulomb_friction", "damper");
    assert_eq!(patched.text("Evidence: none yet."), kept);
}

#[test]
fn rustc_compiles_a_patched_file_as_any_other() {
    let compiled = [
        (
            "axle_b_with_coulomb_friction",
            axle_b_with_coulomb_friction::FINGERPRINT,
        ),
        ("axle_c_with_suspended_mass", axle_c_with_suspended_mass::FINGERPRINT),
        (
            "axle_c_with_tire_dynamic_stiffness",
            axle_c_with_tire_dynamic_stiffness::FINGERPRINT,
        ),
    ];
    for (name, fingerprint) in compiled {
        let file = format!("tests/zoo/{name}.axle");
        let generated = module(&compile_file(Path::new(""), &file).unwrap().compiled.unwrap());
        let fingerprint = format!("FINGERPRINT: u64 = {fingerprint:#018x};");
        assert!(generated.contains(&fingerprint), "{name}");
    }
    let about = axle_b_with_coulomb_friction::AxleBWithCoulombFriction.about();
    assert!(about.states.iter().any(|state| state.name == "z_damper_f_dry"));
}

#[test]
fn a_second_effect_goes_on_top_of_the_first() {
    let first = patched(FILE, "tire_dynamic_stiffness", "tire");
    assert_eq!(
        first.model.name,
        "axle_b_with_coulomb_friction_and_tire_dynamic_stiffness"
    );
    assert!(first.model.text().contains("f_dry") && first.model.text().contains("f_relax"));
}
