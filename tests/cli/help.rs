//! Help is written for those who try it: every example runs, and every shell completes.

use std::process::Command;

use crate::common::{Ran, repository, run_line, succeeds};
use crate::document::{blocks, commands};
use crate::studied::{self, Studied};

/// What `qcar --help` lists.
pub fn verbs() -> Vec<String> {
    let help = succeeds(&["--help"]);
    let listed = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = listed.lines().filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(String::from).collect()
}

/// The lines below `Example:` or `Examples:`.
fn examples(help: &str) -> Vec<String> {
    let after = help.split("Example").nth(1).unwrap_or("");
    let lines = after.lines().filter_map(|line| line.trim().strip_prefix("qcar "));
    lines.map(String::from).collect()
}

#[test]
fn every_example_runs() {
    let folder = repository();
    let verbs = verbs();
    assert!(verbs.len() >= 14, "{verbs:?}");
    let slow = ["discover", "study"];
    let blocks = blocks("README.md");
    let readme: Vec<&str> = blocks.iter().flat_map(commands).collect();
    for verb in verbs.iter().filter(|verb| !slow.contains(&verb.as_str())) {
        let examples = examples(&succeeds(&[verb, "--help"]));
        assert!(!examples.is_empty(), "{verb} has no example");
        for example in examples {
            if example == studied::TARGETS {
                Studied::targets();
                continue;
            }
            // The test of the README runs it.
            if readme.contains(&example.as_str()) {
                continue;
            }
            let Ran { status, stderr, .. } = run_line(folder.path(), &example);
            assert_eq!(status, 0, "qcar {example}\n{stderr}");
        }
    }
}

#[test]
fn every_verb_is_completed_in_every_shell() {
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let script = succeeds(&["completions", shell]);
        assert!(script.contains("QCAR_COMPLETE"), "{shell} does not ask qcar");
    }
    for verb in verbs() {
        let asked = Command::new(env!("CARGO_BIN_EXE_qcar"))
            .args(["--", "qcar", &verb])
            .envs([("QCAR_COMPLETE", "bash"), ("_CLAP_COMPLETE_INDEX", "1")])
            .output()
            .unwrap();
        let offered = String::from_utf8(asked.stdout).unwrap();
        assert!(offered.lines().any(|own| own.trim() == verb), "{verb}: {offered}");
    }
}
