//! Simulated runs as MDF and MAT, in asammdf, SciPy, h5py and our own readers: the table that is written as CSV.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use qcar_signals::read::read;
use qcar_signals::signal::TimeBase;
use serde_json::Value;

use crate::programs::{python_with, qcar, run};

/// A campaign with runs over cleats, and one with time histories, and the name of a run.
const RUNS: [(&str, &str); 2] = [
    ("models/campaigns/axle_a_rig", "v20_h30"),
    ("models/campaigns/silverbox", "multisine_1"),
];

/// Of each channel its unit, times and samples.
type Channels = BTreeMap<String, (String, Vec<f64>, Vec<f64>)>;

/// Kinds of files beside CSV, each with its ending.
const KINDS: [(&str, &str); 3] = [("mdf", "mf4"), ("mat", "mat"), ("mat73", "mat")];

/// Simulates a campaign and gives the folder with a folder of runs for each kind.
fn simulated(campaign: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["csv"].into_iter().chain(KINDS.map(|(kind, _)| kind)) {
        let out = folder.path().join(kind);
        qcar(&["simulate", campaign, "--out", out.to_str().unwrap(), "--as", kind]);
    }
    folder
}

/// The columns of the CSV, which has no units.
fn table(file: &Path) -> (Vec<f64>, BTreeMap<String, Vec<f64>>) {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let column = |at: usize| rows.iter().map(|row| row[at]).collect();
    let channels = names
        .iter()
        .enumerate()
        .skip(1)
        .map(|(at, name)| (name.to_string(), column(at)));
    (column(0), channels.collect())
}

fn agree(found: &Channels, file: &Path, what: &str) {
    let (time, columns) = table(file);
    let headed: BTreeMap<String, _> = found
        .iter()
        .map(|(name, own)| (format!("{name} [{}]", own.0), own))
        .collect();
    assert_eq!(
        headed.keys().collect::<Vec<_>>(),
        columns.keys().collect::<Vec<_>>(),
        "{what}"
    );
    for (name, samples) in &columns {
        let (_, own_time, own) = &headed[name];
        assert_eq!(own.len(), samples.len(), "{what}, {name}");
        // The JSON between the programs is read to the last bit but one.
        assert!(
            own.iter()
                .zip(samples)
                .all(|(a, b)| (a - b).abs() <= f64::EPSILON * b.abs()),
            "{what}, {name}"
        );
        assert!(
            own_time.iter().zip(&time).all(|(a, b)| (a - b).abs() < 1e-12),
            "{what}, times of {name}"
        );
    }
}

#[test]
fn our_own_readers_read_what_is_written() {
    for (campaign, name) in RUNS {
        let folder = simulated(campaign);
        let table = folder.path().join(format!("csv/{name}.csv"));
        for (kind, end) in KINDS {
            let file = folder.path().join(format!("{kind}/{name}.{end}"));
            let recording = read(&file).unwrap_or_else(|error| panic!("{error}"));
            let channel = |signal: &qcar_signals::signal::Signal| {
                let times = match &signal.time {
                    TimeBase::Even { start, step } => {
                        (0..signal.samples.len()).map(|at| start + at as f64 * step).collect()
                    }
                    TimeBase::Times(times) => times.to_vec(),
                    TimeBase::Uneven { .. } | TimeBase::Unknown => Vec::new(),
                };
                (
                    signal.name.clone(),
                    (signal.unit.clone(), times, signal.samples.to_vec()),
                )
            };
            agree(&recording.signals.iter().map(channel).collect(), &table, kind);
            assert!(qcar(&["inspect", file.to_str().unwrap()]).contains("m/s^2") || name == "multisine_1");
        }
    }
}

#[test]
fn asammdf_scipy_and_h5py_read_what_is_written() {
    let Some(python) = python_with("asammdf, scipy, h5py", "simulated runs as MDF and MAT") else {
        return;
    };
    for (campaign, name) in RUNS {
        let folder = simulated(campaign);
        let path = |kind: &str, end: &str| format!("{}/{kind}/{name}.{end}", folder.path().display());
        let result = format!("{}/read.json", folder.path().display());
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/histories.py");
        let [mdf, mat, mat73] = KINDS.map(|(kind, end)| path(kind, end));
        run(&python, &[script, &mdf, &mat, &mat73, &result], folder.path());
        let answer: Value = serde_json::from_str(&fs::read_to_string(&result).unwrap()).unwrap();
        assert_eq!(
            (answer["version"].as_str(), answer["groups"].as_u64()),
            (Some("4.10"), Some(1))
        );
        assert_eq!(answer["name"], name);
        for (kind, _) in KINDS {
            let channels: Channels = serde_json::from_value(answer[kind].clone()).unwrap();
            agree(&channels, Path::new(&path("csv", "csv")), kind);
        }
    }
}
