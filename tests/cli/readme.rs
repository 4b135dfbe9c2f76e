//! The README's commands work as printed.

use std::fs;
use std::path::Path;

use crate::common::{repository, run_line, succeeds};

/// What stands in the README for the installed program.
const FROM_SOURCE: &str = "cargo run --release -- ";

#[test]
fn the_commands_of_the_readme_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let folder = repository();
    let commands = commands(&readme);
    assert!(commands.len() >= 5, "{commands:?}");
    for command in commands {
        let ran = run_line(folder.path(), &command);
        assert_eq!(ran.status, 0, "qcar {command}\n{}", ran.stderr);
    }
}

/// The arguments of each `qcar` in the README's shell blocks, in their order.
fn commands(readme: &str) -> Vec<String> {
    let blocks = readme
        .split("```sh\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap_or(""));
    let lines = blocks.flat_map(str::lines);
    lines
        .filter_map(|line| line.strip_prefix(FROM_SOURCE).or(line.strip_prefix("qcar ")))
        .map(String::from)
        .collect()
}

#[test]
fn the_figures_of_the_readme_are_those_of_the_fit() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let fit = succeeds(&["fit", "models/campaigns/axle_a_rig", "--format", "json"]);
    let fit: serde_json::Value = serde_json::from_str(&fit).unwrap();
    let rows: Vec<Vec<&str>> = readme.lines().map(|line| line.split_whitespace().collect()).collect();
    let mut found = 0;
    for (name, parameter) in fit["parameters"].as_object().unwrap() {
        let Some(row) = rows.iter().find(|row| row.first() == Some(&name.as_str())) else {
            continue;
        };
        let printed: f64 = row[row.len() - 3].parse().unwrap();
        let value = parameter["value"].as_f64().unwrap();
        assert!(
            (printed / value - 1.0).abs() < 1e-3,
            "{name} is {value}, the README says {printed}"
        );
        found += 1;
    }
    assert_eq!(found, 10);
}
