//! Flat models of Modelica, parsed by pymoca and solved by CasADi: the derivatives and outputs of the interpreter.

use std::collections::BTreeMap;
use std::fs;

use qcar::{catalogue, parameters};
use serde_json::{Value, json};

use crate::fmu::BENDS;
use crate::programs::{python_with, qcar, run};

#[test]
fn casadi_finds_the_derivatives_of_the_interpreter() {
    let Some(python) = python_with("pymoca, casadi", "exported models of Modelica") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    fs::write(path("bends.axle"), BENDS).unwrap();
    let bends = path("bends.axle");
    for (name, file, given) in [
        ("axle_d", "axle_d", &["--params", "tests/data/axle_d.toml"][..]),
        ("bends", &bends, &[]),
    ] {
        let out = path(&format!("{name}.mo"));
        qcar(&[&["export", file, "--as", "modelica", "--out", &out], given].concat());
        let model = catalogue::load(file).unwrap();
        let about = model.about();
        let params = given.get(1).map(std::path::Path::new);
        let values = parameters::resolve(about, params, &[]).unwrap();
        let point = |size: f64, count: usize| (1..=count).map(|k| size * (k as f64).sin()).collect::<Vec<f64>>();
        let (x, u) = (point(0.02, about.states.len()), point(0.03, about.inputs.len()));
        let states = about
            .states
            .iter()
            .map(|own| own.name.to_string())
            .zip(x.iter().copied());
        let inputs = about
            .inputs
            .iter()
            .map(|own| own.name.to_string())
            .zip(u.iter().copied());
        let given: BTreeMap<String, f64> = states.chain(inputs).collect();
        fs::write(path("point.json"), json!(given).to_string()).unwrap();
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/modelica.py");
        let folder_name = folder.path().to_str().unwrap();
        run(
            &python,
            &[script, folder_name, name, &path("point.json"), &path("result.json")],
            folder.path(),
        );
        let found: Value = serde_json::from_str(&fs::read_to_string(path("result.json")).unwrap()).unwrap();

        let mut constants = vec![0.0; about.constants];
        let (mut dx, mut y) = (vec![0.0; x.len()], vec![0.0; about.outputs.len()]);
        model.prepare(values.as_slice(), &mut constants);
        model.derivative(&constants, &x, &u, &mut dx);
        model.outputs(&constants, &x, &u, &mut y);
        let parameters = about.parameters.iter().map(|own| &own.name).zip(values.as_slice());
        let derivatives = about.states.iter().map(|own| &own.name).zip(&dx);
        let outputs = about.outputs.iter().map(|own| &own.name).zip(&y);
        let of = |kind: &str, name: &str| found[kind][name].as_f64().unwrap();
        for (kind, name, own, found) in parameters
            .map(|(name, own)| ("parameter", name, own, of("parameters", name)))
            .chain(derivatives.map(|(name, own)| ("derivative", name, own, of("derivatives", name))))
            .chain(outputs.map(|(name, own)| ("output", name, own, of("outputs", name))))
        {
            // Newton's method ends where steps are of rounding; sums of large forces lose some digits.
            let allowed = 1e-10 * own.abs().max(1e-3);
            assert!(
                (own - found).abs() <= allowed,
                "{kind} {name}: {own} here, {found} there"
            );
        }
    }
}
