//! Bad input: exit status 2, nothing on standard output, and a message that says where and what to do.

use std::fs;
use std::path::Path;

use crate::common::qcar;

/// Runs in the repository with `FILE` standing for a file of this content.
fn refused(content: &str, arguments: &[&str], said: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("given.toml");
    fs::write(&file, content).unwrap();
    let file = file.to_str().unwrap();
    let arguments: Vec<&str> = arguments
        .iter()
        .map(|argument| if *argument == "FILE" { file } else { argument })
        .collect();
    let ran = qcar(&arguments);
    assert_eq!(
        (ran.status, ran.stdout.as_str()),
        (2, ""),
        "{arguments:?}\n{}",
        ran.stderr
    );
    assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
    for fragment in said {
        assert!(
            ran.stderr.contains(fragment),
            "expected `{fragment}` in\n{}",
            ran.stderr
        );
    }
}

fn params(content: &str, said: &[&str]) {
    refused(content, &["matrices", "quarter_car", "--params", "FILE"], said);
}

#[test]
fn parameter_files_are_read_with_care() {
    params("", &["given.toml", "no [parameters]", "[parameters]"]);
    params("[parameters\n", &["given.toml", "line 1"]);
    params(
        "[parameters]\nk_tyre = 2e5\n",
        &["line 2, column 1", "parameters.k_tyre", "did you mean `k_tire`?"],
    );
    params("[parameters]\nk_tire = \"2e5\"\n", &["line 2", "string", "a number"]);
    params("[parameters]\nk_tire = inf\n", &["line 2", "a number"]);
    params(
        "[parameters.k_tire]\nvalue = 200\nunit = \"N/mm\"\n",
        &["line 1", "N/mm", "N/m"],
    );
    params("[parameters.k_tire]\nunit = \"N/m\"\n", &["no `value`"]);
    params("parameters = 3\n", &["a table"]);
    params("[paramters]\nk_tire = 2e5\n", &["`paramters`", "[parameters]"]);
}

#[test]
fn all_problems_of_a_file_come_together() {
    params(
        "[parameters]\nk_tyre = 2e5\nfriction = 3.0\n",
        &["parameters.k_tyre", "parameters.friction"],
    );
}

#[test]
fn flags_are_read_with_care() {
    let matrices = |rest: &[&str], said: &[&str]| refused("", &[&["matrices", "quarter_car"], rest].concat(), said);
    matrices(&["--set", "k_tire"], &["name=value"]);
    matrices(&["--set", "k_tire=stiff"], &["a number"]);
    matrices(&["--set", "k_tyre=2e5"], &["did you mean `k_tire`?"]);
    matrices(&["--axis", "y"], &["`y`", "--axis"]);
    matrices(&["--params", "nowhere.toml"], &["nowhere.toml", "a readable text file"]);
    let frf = |rest: &[&str], said: &[&str]| refused("", &[&["frf", "quarter_car"], rest].concat(), said);
    frf(&["--frequencies", "30:0.5:300"], &["above the first"]);
    frf(&["--frequencies", "0:30:300"], &["above 0 Hz"]);
    frf(&["--frequencies", "1:30"], &["FROM:TO:LINES"]);
    frf(&["--channels", "pad_to_moon"], &["`pad_to_moon`", "`pad_to_body`"]);
}

#[test]
fn parameters_without_a_value_are_all_named() {
    refused(
        "",
        &["matrices", "axle_c"],
        &["`m_wheel`", "`k_tire`", "--params", "--set"],
    );
    let content = "[parameters]\nk_tire = 2e5\n";
    refused(
        content,
        &["matrices", "axle_c", "--params", "FILE"],
        &["given.toml", "`m_wheel`: found no value", "`k_wheel_z`: found no value"],
    );
}

#[test]
fn models_are_found_or_missed_by_name() {
    refused("", &["matrices", "axle_q"], &["`axle_q`", "`axle_a`"]);
    refused("", &["matrices", "nowhere/my.axle"], &["nowhere/my.axle"]);
    refused("not a model", &["matrices", "FILE"], &["given.toml"]);
    refused("", &["show", "axle_q", "--stage", "model"], &["`axle_q`"]);
}

#[test]
fn campaigns_are_read_with_care() {
    refused("", &["fit", "nowhere"], &["nowhere", "campaign.toml"]);
    assert!(!Path::new("nowhere").exists());
}
