//! MAT-files in SciPy and h5py, and functions in GNU Octave: the matrices that `qcar matrices` prints.

use std::fs;
use std::path::Path;
use std::process::Command;

use qcar::{catalogue, parameters};
use qcar_runtime::model::Matrix;
use serde_json::Value;

use crate::programs::{python_with, qcar, run, say};

const PARAMS: &str = "tests/data/axle_d.toml";
/// A model without states: matrices without rows and columns.
const MASSLESS: &str = "damper_dyno";

fn printed(model: &str, given: &[&str]) -> Value {
    let arguments = [&["matrices", model, "--format", "json"], given].concat();
    serde_json::from_str(&qcar(&arguments)).unwrap()
}

#[test]
fn scipy_reads_the_matrices_that_are_printed() {
    if let Some(python) = python_with("scipy", "exported MAT-files") {
        reads_what_is_printed(&python, "mat", "matlab.py");
    }
}

#[test]
fn h5py_reads_the_matrices_that_are_printed() {
    if let Some(python) = python_with("h5py", "exported MAT-files of version 7.3") {
        reads_what_is_printed(&python, "mat73", "mat73.py");
    }
}

/// What a script finds in an exported file is what `qcar matrices` prints.
fn reads_what_is_printed(python: &Path, kind: &str, script: &str) {
    let script = format!("{}/tests/export/{script}", env!("CARGO_MANIFEST_DIR"));
    for (model, given) in [("axle_d", &["--params", PARAMS][..]), (MASSLESS, &[])] {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
        let (file, result) = (path("model.mat"), path("result.json"));
        qcar(&[&["export", model, "--as", kind, "--out", &file], given].concat());
        run(python, &[&script, &file, &result], folder.path());
        let read: Value = serde_json::from_str(&fs::read_to_string(&result).unwrap()).unwrap();
        let printed = printed(model, given);
        for matrix in ["A", "B", "C", "D"] {
            assert_eq!(read[matrix], printed[matrix], "{model}, {matrix}");
        }
        assert_eq!(read["p"], printed["values"], "{model}");
        let sizes = |matrix: &str| read["shapes"][matrix].clone();
        let count = |what: &str| printed[what].as_array().unwrap().len();
        assert_eq!(
            sizes("B"),
            serde_json::json!([count("states"), count("inputs")]),
            "{model}"
        );
        assert_eq!(
            sizes("C"),
            serde_json::json!([count("outputs"), count("states")]),
            "{model}"
        );
        let texts = |list: &str, key: &str| -> Vec<Value> {
            let entries = printed[list].as_array().unwrap().iter();
            entries.map(|entry| entry[key].clone()).collect()
        };
        assert_eq!(read["names"]["states"], Value::from(texts("states", "name")));
        assert_eq!(read["names"]["inputs"], Value::from(texts("inputs", "variable")));
        assert_eq!(read["names"]["output_units"], Value::from(texts("outputs", "unit")));
    }
}

#[test]
fn octave_computes_the_matrices_that_are_printed() {
    let octave = Path::new("octave-cli");
    if Command::new(octave).arg("--version").output().is_err() {
        say("not checked: exported functions of MATLAB, since GNU Octave is absent (apt-get install octave)");
        return;
    }
    let changed = &["--set", "k_tire=230000", "--params", PARAMS][..];
    for (model, given, call) in [
        ("axle_d", &["--params", PARAMS][..], "model(struct('k_tire', 230000))"),
        (MASSLESS, &[], "model()"),
    ] {
        let (matrices, states) = computed(octave, model, given, call);
        let expected = printed(model, if call.contains("k_tire") { changed } else { given });
        for (own, matrix) in matrices.iter().zip(["A", "B", "C", "D"]) {
            let rows: Vec<Vec<f64>> = serde_json::from_value(expected[matrix].clone()).unwrap();
            agree(own, &rows.concat(), &format!("{model}, {matrix}"));
        }
        assert_eq!(states.len(), expected["states"].as_array().unwrap().len(), "{model}");
    }
}

/// All of the language, linearised where nothing is at rest, against the interpreter.
#[test]
fn octave_linearises_every_law_as_the_interpreter_does() {
    let octave = Path::new("octave-cli");
    if Command::new(octave).arg("--version").output().is_err() {
        return;
    }
    let file = "models/tests/zoo/laws.axle";
    let model = catalogue::load(file).unwrap();
    let about = model.about();
    let point = |size: f64, count: usize| (1..=count).map(|k| size * (k as f64).sin()).collect::<Vec<f64>>();
    let (x, u) = (point(0.02, about.states.len()), point(0.03, about.inputs.len()));
    let values = parameters::resolve(about, None, &[]).unwrap();
    let mut nonzeros = vec![0.0; about.matrices.len()];
    model.matrices(values.as_slice(), &x, &u, &mut nonzeros);
    let (matrices, _) = computed(octave, file, &[], &format!("model([], {x:?}, {u:?})"));
    let shapes = [Matrix::A, Matrix::B, Matrix::C, Matrix::D];
    for (own, matrix) in matrices.iter().zip(shapes) {
        let columns = if matches!(matrix, Matrix::A | Matrix::C) {
            x.len()
        } else {
            u.len()
        };
        let mut expected = vec![0.0; own.len()];
        for (entry, value) in about
            .matrices
            .iter()
            .zip(&nonzeros)
            .filter(|(entry, _)| entry.matrix == matrix)
        {
            expected[usize::from(entry.row) * columns + usize::from(entry.column)] = *value;
        }
        agree(own, &expected, &format!("{matrix:?}"));
    }
}

/// A, B, C and D row after row, and the names of the states, as Octave has them.
fn computed(octave: &Path, model: &str, given: &[&str], call: &str) -> (Vec<Vec<f64>>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.m");
    qcar(
        &[
            &["export", model, "--as", "matlab", "--out", file.to_str().unwrap()],
            given,
        ]
        .concat(),
    );
    let program = format!(
        "[A, B, C, D, names] = {call}; M = {{A, B, C, D}}; for k = 1:4, printf('%.17g ', M{{k}}'); printf('\\n'); end;
         printf('%s ', names.states{{:}}); printf('\\n');"
    );
    let out = run(octave, &["--quiet", "--eval", &program], folder.path());
    let lines: Vec<Vec<&str>> = out.lines().map(|line| line.split_whitespace().collect()).collect();
    let numbers = lines[..4]
        .iter()
        .map(|words| words.iter().map(|word| word.parse().unwrap()).collect());
    (
        numbers.collect(),
        lines[4].iter().map(|word| word.to_string()).collect(),
    )
}

/// The same operations, but for what functions and powers of another library round otherwise.
fn agree(own: &[f64], expected: &[f64], what: &str) {
    assert_eq!(own.len(), expected.len(), "{what}");
    for (a, b) in own.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-13 * b.abs(), "{what}: {a} and {b}");
    }
}

#[test]
fn octave_refuses_a_parameter_that_the_model_has_not() {
    let octave = Path::new("octave-cli");
    if Command::new(octave).arg("--version").output().is_err() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.m");
    qcar(&[
        "export",
        "quarter_car",
        "--as",
        "matlab",
        "--out",
        file.to_str().unwrap(),
    ]);
    let output = Command::new(octave)
        .args(["--quiet", "--eval", "model(struct('k_tyre', 1))"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(!output.status.success());
    assert!(String::from_utf8_lossy(&output.stderr).contains("quarter_car has no parameter k_tyre"));
}
