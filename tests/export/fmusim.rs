//! Exported units in fmusim, the FMI project's own importer (modelica/Reference-FMUs). It checks the model description
//! against the schema and the rules of the standard, then calls the unit in the order of the standard.
//!
//! It is the program in `FMUSIM`, or `fmusim` on the PATH.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::fmu::{BENDS, Between, RATE, SAMPLES, STUDY, Subject, with_friction};
use crate::programs::{qcar, say};

#[test]
fn a_linear_axle_moves_in_fmusim_as_here() {
    compare("axle_d", Some("tests/data/axle_d.toml"), None);
}

#[test]
fn a_parameter_that_is_changed_in_fmusim_is_that_of_the_model() {
    compare("axle_d", Some("tests/data/axle_d.toml"), Some(("k_tire", 230e3)));
}

#[test]
fn an_axle_with_friction_moves_in_fmusim_as_here() {
    let folder = tempfile::tempdir().unwrap();
    compare(with_friction(folder.path()).to_str().unwrap(), Some(STUDY), None);
}

#[test]
fn laws_that_bend_move_in_fmusim_as_here() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("bends.axle");
    fs::write(&model, BENDS).unwrap();
    compare(model.to_str().unwrap(), None, None);
}

#[test]
fn a_rolling_tyre_runs_in_fmusim() {
    let Some(fmusim) = fmusim() else { return };
    let folder = tempfile::tempdir().unwrap();
    let road = ["--params", "models/campaigns/axle_a_rig", "--road", "C@60km/h:2s"];
    for fmi in ["2", "3"] {
        let unit = export(folder.path(), "axle_a", &road, fmi);
        for kind in ["me", "cs"] {
            let outputs = simulate(&fmusim, folder.path(), &unit, kind, &[]);
            let force = &outputs["force_tire_z"];
            assert_eq!(force.len(), SAMPLES, "{kind} of FMI {fmi}");
            assert!(
                force.values().any(|value| *value != force[&0]),
                "{kind} of FMI {fmi} stands"
            );
        }
    }
}

/// Against the schema, and against a rule that the schema does not have.
#[test]
fn fmusim_refuses_what_is_against_the_standard() {
    let Some(fmusim) = fmusim() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (fmi, structure) in [("2", "<Outputs>"), ("3", "<ModelStructure>")] {
        let unit = export(folder.path(), "quarter_car", &[], fmi);
        let refuses = |change: &dyn Fn(&str) -> String, expected: &str| {
            let changed = rewritten(&unit, change);
            let out = run(
                &fmusim,
                folder.path(),
                &["--interface-type", "cs", changed.to_str().unwrap()],
            );
            let said = all_said(&out);
            assert!(!out.status.success() && said.contains(expected), "FMI {fmi}: {said}");
        };
        refuses(&|text| text.replacen("modelName=", "modelNome=", 1), "modelNome");
        let without_an_output = |text: &str| {
            let from = text.find(structure).unwrap() + structure.len();
            let end = from + text[from..].find("/>").unwrap() + 2;
            [&text[..from], &text[end..]].concat()
        };
        refuses(&without_an_output, "must match the number of outputs");
    }
}

/// Co-Simulation along the inputs of [`Subject`], held from sample to sample; Model Exchange after a step of the inputs
/// at its start, since the integrator of fmusim steps past the time of an input and interpolates.
fn compare(model: &str, params: Option<&str>, changed: Option<(&str, f64)>) {
    let Some(fmusim) = fmusim() else { return };
    let folder = tempfile::tempdir().unwrap();
    let given: Vec<&str> = params.into_iter().flat_map(|file| ["--params", file]).collect();
    let subject = Subject::new(model, params, changed);
    let value = changed.map(|(name, value)| [name.to_string(), value.to_string()]);
    let mut arguments: Vec<&str> = Vec::new();
    if let Some([name, value]) = &value {
        arguments.extend(["--start-value", name, value]);
    }
    let stairs = folder.path().join("stairs.csv");
    fs::write(&stairs, stairs_of(&subject)).unwrap();
    let levels: Vec<String> = subject.inputs().iter().map(|name| level(name).to_string()).collect();
    let steps = subject.inputs().iter().map(|name| vec![level(name); SAMPLES]).collect();
    let (bump, step) = (subject.ride(Between::Before), subject.ride_of(steps, Between::After));
    for fmi in ["2", "3"] {
        let unit = export(folder.path(), model, &given, fmi);
        let along = [&arguments[..], &["--input-file", stairs.to_str().unwrap()]].concat();
        let found = simulate(&fmusim, folder.path(), &unit, "cs", &along);
        check(&subject, &bump, &found, SAMPLES, &format!("Co-Simulation of FMI {fmi}"));
        let mut after = arguments.clone();
        for (name, level) in subject.inputs().into_iter().zip(&levels) {
            after.extend(["--start-value", name, level]);
        }
        let found = simulate(&fmusim, folder.path(), &unit, "me", &after);
        // A sample within 1e-5 s of an event of the unit is moved to the event.
        check(
            &subject,
            &step,
            &found,
            SAMPLES - 10,
            &format!("Model Exchange of FMI {fmi}"),
        );
    }
}

/// What an input is from the start on.
fn level(name: &str) -> f64 {
    match name {
        _ if name.starts_with("f_") => 100.0,
        _ if name.starts_with('v') || name.starts_with('a') || name == "g" => 0.0,
        _ => 5e-3,
    }
}

/// At each sample what was before it, then what is from it on, at the times that fmusim computes.
fn stairs_of(subject: &Subject) -> String {
    let samples = subject.samples();
    let line = |k: usize, sample: usize| {
        let values: Vec<String> = samples.iter().map(|row| format!("{:?}", row[sample])).collect();
        format!("{:?},{}\n", k as f64 * (1.0 / RATE), values.join(","))
    };
    let stairs = (1..SAMPLES).flat_map(|k| [line(k, k - 1), line(k, k)]);
    let lines: String = [line(0, 0)].into_iter().chain(stairs).collect();
    format!("time,{}\n{lines}", subject.inputs().join(","))
}

/// Each output by the number of the sample.
type Outputs = BTreeMap<String, BTreeMap<usize, f64>>;

fn check(subject: &Subject, own: &[Vec<f64>], found: &Outputs, least: usize, kind: &str) {
    let at: Vec<usize> = found.values().next().unwrap().keys().copied().collect();
    assert!(at.len() >= least, "{kind}: {} samples", at.len());
    let own: Vec<Vec<f64>> = own.iter().map(|row| at.iter().map(|k| row[*k]).collect()).collect();
    let other = found
        .iter()
        .map(|(name, row)| (name.clone(), row.values().copied().collect::<Value>()));
    subject.check_ride(&own, &other.collect::<Value>(), &format!("fmusim, {kind}"));
}

fn export(folder: &Path, model: &str, given: &[&str], fmi: &str) -> PathBuf {
    let unit = folder.join(format!("unit{fmi}.fmu"));
    let out = ["--as", "fmu", "--fmi", fmi, "--out", unit.to_str().unwrap()];
    qcar(&[&["export", model], given, &out[..]].concat());
    unit
}

/// A copy with another model description.
fn rewritten(unit: &Path, change: &dyn Fn(&str) -> String) -> PathBuf {
    let copy = unit.with_extension("changed.fmu");
    let mut own = zip::ZipArchive::new(File::open(unit).unwrap()).unwrap();
    let mut other = zip::ZipWriter::new(File::create(&copy).unwrap());
    for place in 0..own.len() {
        let mut entry = own.by_index(place).unwrap();
        let name = entry.name().unwrap().into_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        if name == "modelDescription.xml" {
            content = change(std::str::from_utf8(&content).unwrap()).into_bytes();
        }
        other
            .start_file(name, zip::write::SimpleFileOptions::default())
            .unwrap();
        other.write_all(&content).unwrap();
    }
    other.finish().unwrap();
    copy
}

/// The outputs of a unit at the samples.
fn simulate(fmusim: &Path, folder: &Path, unit: &Path, kind: &str, more: &[&str]) -> Outputs {
    let (interval, stop) = ((1.0 / RATE).to_string(), ((SAMPLES - 1) as f64 / RATE).to_string());
    let way = ["--interface-type", kind, "--solver", "cvode", "--tolerance", "1e-11"];
    let times = [
        "--stop-time",
        &stop,
        "--output-interval",
        &interval,
        "--output-file",
        "out.csv",
    ];
    let out = run(
        fmusim,
        folder,
        &[&way, &times, more, &[unit.to_str().unwrap()]].concat(),
    );
    let said = all_said(&out);
    assert!(out.status.success(), "{kind}: {said}");
    for complaint in ["[Warning]", "[Error]", "[Fatal]", "[Discard]"] {
        assert!(!said.contains(complaint), "{kind}: {said}");
    }
    let table = fs::read_to_string(folder.join("out.csv")).unwrap();
    let mut lines = table.lines();
    let names: Vec<&str> = lines
        .next()
        .unwrap()
        .split(',')
        .map(|name| name.trim_matches('"'))
        .collect();
    let mut outputs = Outputs::new();
    for line in lines {
        let values: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
        let sample = (values[0] * RATE).round();
        if (values[0] - sample / RATE).abs() < 1e-12 {
            for (name, value) in names.iter().zip(&values).skip(1) {
                outputs
                    .entry(name.to_string())
                    .or_default()
                    .insert(sample as usize, *value);
            }
        }
    }
    outputs
}

fn run(fmusim: &Path, folder: &Path, arguments: &[&str]) -> Output {
    Command::new(fmusim)
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn all_said(out: &Output) -> String {
    String::from_utf8_lossy(&[&out.stdout[..], &out.stderr].concat()).into_owned()
}

/// The program, where it is there.
fn fmusim() -> Option<PathBuf> {
    let program = std::env::var_os("FMUSIM").map_or("fmusim".into(), PathBuf::from);
    let found = Command::new(&program).arg("--help").output().is_ok();
    if !found {
        say("not checked: exported units in fmusim, since it is neither in FMUSIM nor on the PATH (docs/export.md)");
    }
    found.then_some(program)
}
