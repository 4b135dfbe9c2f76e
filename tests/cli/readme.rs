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

/// The block of the README that shows what a study prints, against what it prints: words alike, numbers within a percent.
#[test]
fn the_summary_of_the_readme_is_that_of_the_study() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let shown = readme
        .split("```\n")
        .find(|block| block.starts_with("axle_c_study:"))
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let printed = succeeds(&["study", "models/campaigns/axle_c_study", "--out", out]).replace(out, "results");
    let (shown, printed): (Vec<&str>, Vec<&str>) = (words(shown), words(&printed));
    assert_eq!(shown.len(), printed.len(), "{printed:?}");
    for (shown, printed) in shown.into_iter().zip(printed) {
        assert!(alike(shown, printed), "the README says {shown}, the study {printed}");
    }
}

fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().map(|word| word.trim_end_matches(',')).collect()
}

fn alike(shown: &str, printed: &str) -> bool {
    match (shown.parse::<f64>(), printed.parse::<f64>()) {
        (Ok(shown), Ok(printed)) => (shown - printed).abs() <= 0.051 + 0.01 * printed.abs(),
        _ => shown == printed,
    }
}
