//! Exported models as a user asks for them: what is written, what is refused, what stays as it is.

use std::fs;
use std::path::Path;

use crate::common::{Ran, qcar, refused, repository, run_line, succeeds};
use crate::document::{blocks, commands};

/// Every kind, with the end of its file.
const KINDS: [(&str, &str); 8] = [
    ("c", "c"),
    ("fmu", "fmu"),
    ("matlab", "m"),
    ("mat", "mat"),
    ("modelica", "mo"),
    ("json", "json"),
    ("csv", "csv"),
    ("latex", "tex"),
];

fn export(model: &str, kind: &str, out: &Path, more: &[&str]) -> Ran {
    qcar(&[&["export", model, "--as", kind, "--out", out.to_str().unwrap()], more].concat())
}

#[test]
fn every_kind_writes_its_files_and_says_which() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, end) in KINDS {
        let out = folder.path().join(format!("own.{end}"));
        let ran = export("quarter_car", kind, &out, &[]);
        assert_eq!(ran.status, 0, "{kind}\n{}", ran.stderr);
        assert!(
            ran.stdout
                .starts_with(&format!("quarter_car written to {}", out.display()))
        );
        assert!(fs::metadata(&out).unwrap().len() > 0, "{kind}");
    }
    assert!(folder.path().join("own.h").exists());
    let names = fs::read_dir(folder.path()).unwrap();
    assert_eq!(names.count(), KINDS.len() + 1, "something else was left behind");
}

#[test]
fn what_other_verbs_print_is_what_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let written = |kind: &str, end: &str| {
        let out = folder.path().join(format!("own.{end}"));
        export("quarter_car", kind, &out, &["--set", "k_tire=2e5"]);
        fs::read_to_string(out).unwrap()
    };
    let printed = succeeds(&["matrices", "quarter_car", "--set", "k_tire=2e5", "--format", "json"]);
    assert_eq!(written("json", "json"), printed);
    assert_eq!(
        written("latex", "tex"),
        succeeds(&["show", "quarter_car", "--stage", "latex"])
    );
    let matrices: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let csv = written("csv", "csv");
    let line = |row: usize, column: usize| {
        let name = |list: &str, key: &str, at: usize| matrices[list][at][key].as_str().unwrap().to_string();
        let (row_name, column_name) = (name("states", "name", row), name("inputs", "variable", column));
        let value = matrices["B"][row][column].as_f64().unwrap();
        format!("B,{row_name},{column_name},{value:?}\n")
    };
    assert!(csv.contains(&line(0, 0)) && csv.contains(&line(3, 1)), "{csv}");
}

#[test]
fn the_same_model_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, end) in KINDS {
        let twice = ["one", "other"].map(|name| {
            let folder = folder.path().join(name);
            let out = folder.join(format!("own.{end}"));
            assert_eq!(export("quarter_car", kind, &out, &[]).status, 0);
            fs::read(out).unwrap()
        });
        assert!(twice[0] == twice[1], "{kind}");
    }
}

#[test]
fn without_a_compiler_a_unit_has_its_sources_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("own.fmu");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(["export", "quarter_car", "--as", "fmu", "--out", out.to_str().unwrap()])
        .env("PATH", folder.path())
        .env_remove("CC")
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success());
    assert!(said.contains("no library: no C compiler was found"), "{said}");
    let bytes = fs::read(&out).unwrap();
    let holds = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
    assert!(holds("modelDescription.xml") && holds("sources/quarter_car.c") && !holds("binaries/"));
}

#[test]
fn files_that_are_there_stay_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, end) in KINDS {
        let out = folder.path().join(format!("own.{end}"));
        fs::write(&out, "mine").unwrap();
        let ran = export("quarter_car", kind, &out, &[]);
        refused(&ran, &["`--out`", "exists already", "choose another name"]);
        assert_eq!(fs::read_to_string(&out).unwrap(), "mine", "{kind}");
    }
    // The header alone is there: the source is not written either.
    let header = folder.path().join("half.h");
    fs::write(&header, "mine").unwrap();
    refused(
        &export("quarter_car", "c", &folder.path().join("half.c"), &[]),
        &["half.h", "exists already"],
    );
    assert!(!folder.path().join("half.c").exists());
}

#[test]
fn what_cannot_be_written_is_said_before_anything_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let wrong_end = export("quarter_car", "fmu", &path("own.zip"), &[]);
    refused(&wrong_end, &["own.zip", "ends in .fmu", "write --out", "own.fmu"]);
    fs::write(path("file"), "").unwrap();
    let in_a_file = export("quarter_car", "csv", &path("file/own.csv"), &[]);
    refused(&in_a_file, &["own.csv", "a writable place"]);
    let keyword = export("quarter_car", "matlab", &path("end.m"), &[]);
    refused(&keyword, &["`end.m`", "no keyword", "quarter_car.m"]);
    refused(
        &export("quarter_car", "simulink", &path("own.slx"), &[]),
        &["simulink", "fmu", "matlab"],
    );
    refused(
        &export("no_such", "c", &path("own.c"), &[]),
        &["`no_such`", "choose among"],
    );
    let road = ["--road", "C@80km/h"];
    refused(
        &export("quarter_car", "c", &path("own.c"), &road),
        &["--road", "--as fmu"],
    );
    refused(
        &export("quarter_car", "fmu", &path("own.fmu"), &road),
        &["--road", "r_tire, static_tire_def and static_tire_load", "--params"],
    );
    let rig = ["--params", "models/campaigns/axle_a_rig", "--road", "C@80km/h:600s"];
    refused(
        &export("axle_a", "fmu", &path("own.fmu"), &rig),
        &["444446 points", "at most 200000", ":20s"],
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn parameters_are_read_with_care() {
    let folder = tempfile::tempdir().unwrap();
    let (out, params) = (folder.path().join("own.c"), folder.path().join("own.toml"));
    let with = |content: &str| {
        fs::write(&params, content).unwrap();
        export("quarter_car", "c", &out, &["--params", params.to_str().unwrap()])
    };
    refused(
        &with("[parameters]\nk_tyre = 2e5\n"),
        &["own.toml", "line 2", "did you mean `k_tire`?"],
    );
    refused(&with("[parameters]\nm_wheel = -1\n"), &["m_wheel"]);
    refused(&export("axle_d", "c", &out, &[]), &["m_corner", "--params"]);
    assert!(!out.exists());
}

#[test]
fn the_commands_of_the_page_run() {
    let folder = repository();
    let blocks = blocks("docs/export.md");
    let commands: Vec<&str> = blocks.iter().flat_map(commands).collect();
    assert!(commands.len() >= KINDS.len(), "{commands:?}");
    for command in commands {
        let ran = run_line(folder.path(), command);
        assert_eq!(ran.status, 0, "qcar {command}\n{}", ran.stderr);
    }
}
