//! Exported units before the FMU Manipulation Toolbox, which shares nothing with FMPy: schema and rules of both
//! versions.

use std::fs;

use serde_json::Value;

use crate::fmu::BENDS;
use crate::programs::{python_with, qcar, run};

#[test]
fn another_tool_finds_nothing_against_the_standard() {
    let Some(python) = python_with("fmu_manipulation_toolbox", "units by a second tool") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    fs::write(path("bends.axle"), BENDS).unwrap();
    let (linear, rig) = ("tests/data/axle_d.toml", "models/campaigns/axle_a_rig");
    let bends = path("bends.axle");
    let subjects: [&[&str]; 3] = [
        &["axle_d", "--params", linear],
        &[&bends],
        &["axle_a", "--params", rig, "--road", "C@60km/h:2s"],
    ];
    let mut arguments = vec![
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/conformity.py").to_string(),
        path("result.json"),
    ];
    for (number, subject) in subjects.into_iter().enumerate() {
        for fmi in ["2", "3"] {
            let unit = path(&format!("unit{number}_{fmi}.fmu"));
            let out = ["--as", "fmu", "--fmi", fmi, "--out", &unit];
            qcar(&[&["export"], subject, &out[..]].concat());
            arguments.push(unit);
        }
    }
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    run(&python, &arguments, folder.path());
    let answer: Value = serde_json::from_str(&fs::read_to_string(path("result.json")).unwrap()).unwrap();
    let units = answer["units"].as_array().unwrap();
    assert_eq!(units.len(), 6);
    for unit in units {
        let said = unit["said"].as_str().unwrap();
        assert_eq!(unit["status"], 0, "{said}");
        assert!(
            said.contains("compliant with FMI") && said.contains("No semantic error"),
            "{said}"
        );
    }
    // It would have found something.
    let broken = &answer["broken"];
    assert!(broken["status"] != 0, "{broken}");
    assert!(
        broken["said"].as_str().unwrap().contains("valueReference 0 is used by"),
        "{broken}"
    );
}
