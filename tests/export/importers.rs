//! Exported units in importers that share no code with FMPy nor with one another: they load them, and move as qcar's
//! own integrator moves the model that it interprets.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::fmu::{BENDS, Between, STUDY, Subject, with_friction};
use crate::programs::{python_that, qcar, run};

/// An importer, the Python packages that bring it, how to see that they are there, and which units it runs.
struct Importer {
    name: &'static str,
    packages: &'static str,
    present: &'static str,
    fmi: &'static [&'static str],
    /// Which inputs its outputs at a sample are of.
    between: Between,
}

const IMPORTERS: [Importer; 4] = [
    Importer {
        name: "libcosim",
        packages: "libcosimpy",
        present: "import libcosimpy",
        fmi: &["2"],
        between: Between::Before,
    },
    Importer {
        name: "ecos",
        packages: "ecospy tbb",
        // Only the script says where its library finds that of the other.
        present: "from importlib.metadata import version; version('ecospy'), version('tbb')",
        fmi: &["2", "3"],
        between: Between::Before,
    },
    Importer {
        name: "fmi_library",
        packages: "libcosimpy scipy",
        present: "import libcosimpy, scipy",
        fmi: &["2"],
        between: Between::After,
    },
    Importer {
        name: "fmuloader",
        packages: "fmuloader scipy",
        present: "import fmuloader, scipy",
        fmi: &["3"],
        between: Between::After,
    },
];

#[test]
fn a_linear_axle_moves_in_other_importers_as_here() {
    compare("axle_d", Some("tests/data/axle_d.toml"), None);
}

#[test]
#[ignore = "further importers of what FMPy runs; .ci/run runs it"]
fn a_parameter_that_is_changed_in_other_importers_is_that_of_the_model() {
    compare("axle_d", Some("tests/data/axle_d.toml"), Some(("k_tire", 230e3)));
}

#[test]
#[ignore = "further importers of what FMPy runs; .ci/run runs it"]
fn an_axle_with_friction_moves_in_other_importers_as_here() {
    let folder = tempfile::tempdir().unwrap();
    compare(with_friction(folder.path()).to_str().unwrap(), Some(STUDY), None);
}

#[test]
#[ignore = "further importers of what FMPy runs; .ci/run runs it"]
fn laws_that_bend_move_in_other_importers_as_here() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("bends.axle");
    fs::write(&model, BENDS).unwrap();
    compare(model.to_str().unwrap(), None, None);
}

fn compare(model: &str, params: Option<&str>, changed: Option<(&str, f64)>) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let given: Vec<&str> = params.into_iter().flat_map(|file| ["--params", file]).collect();
    for fmi in ["2", "3"] {
        let unit = path(&format!("unit{fmi}.fmu"));
        let export = ["export", model, "--as", "fmu", "--fmi", fmi, "--out", &unit];
        qcar(&[&export[..], &given].concat());
    }
    let subject = Subject::new(model, params, changed);
    fs::write(path("input.csv"), subject.input_file()).unwrap();
    for importer in &IMPORTERS {
        let own = subject.ride(importer.between);
        for fmi in importer.fmi {
            let Some(found) = moved(importer, folder.path(), fmi, changed) else {
                continue;
            };
            let what = format!("{} of FMI {fmi}", importer.name);
            assert_eq!(found["complaints"], Value::Array(Vec::new()), "{what}");
            subject.check_ride(&own, &found["outputs"], &what);
        }
    }
}

/// What an importer makes of a unit of the folder, if it is there.
fn moved(importer: &Importer, folder: &Path, fmi: &str, changed: Option<(&str, f64)>) -> Option<Value> {
    let python = python_that(
        importer.present,
        importer.packages,
        &format!("units in {}", importer.name),
    )?;
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/importers.py");
    let unit = folder.join(format!("unit{fmi}.fmu"));
    let (unit, result) = (unit.to_str()?, folder.join("result.json"));
    let changed = changed.map(|(name, value)| [name.to_string(), value.to_string()]);
    let mut arguments = vec![script, importer.name, unit, "input.csv", result.to_str()?];
    arguments.extend(changed.iter().flatten().map(String::as_str));
    run(&python, &arguments, folder);
    let found = serde_json::from_str(&fs::read_to_string(&result).unwrap());
    fs::remove_file(&result).unwrap();
    Some(found.unwrap())
}
