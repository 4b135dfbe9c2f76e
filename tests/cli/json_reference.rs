//! The reference of JSON: each verb prints the keys that it lists, and no other.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::succeeds;
use crate::studied::Studied;

const AXLE: &str = "models/campaigns/axle_a_rig";

/// The keys in the first column of the table below `## qcar VERB`.
fn documented(verb: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/json.md")).unwrap();
    let part = text.split(&format!("## qcar {verb}\n")).nth(1).unwrap();
    let part = part.split("\n## ").next().unwrap();
    let cells = part
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('|').next());
    let keys = cells.flat_map(|cell| cell.split(',').map(|key| key.trim().trim_matches('`').to_string()));
    keys.collect()
}

fn printed(of: &Value) -> BTreeSet<String> {
    of.as_object().unwrap().keys().cloned().collect()
}

fn agree(verb: &str, result: &Value) {
    assert_eq!(documented(verb), printed(result), "qcar {verb}");
}

fn result(line: &str) -> Value {
    let words: Vec<&str> = line.split_whitespace().chain(["--format", "json"]).collect();
    serde_json::from_str(&succeeds(&words)).unwrap()
}

fn written(of: &Studied, file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(of.folder.join(file)).unwrap()).unwrap()
}

#[test]
fn verbs_print_the_keys_that_are_documented() {
    agree("inspect", &result(&format!("inspect {AXLE}/rig/sweep_025.csv.gz")));
    agree("matrices", &result("matrices quarter_car"));
    agree("modes", &result("modes quarter_car"));
    agree("fit", &result(&format!("fit {AXLE} --starts 1")));
    agree("plan", &result(&format!("plan {AXLE}")));
    agree("kc", &result(&format!("kc {AXLE}"))[0]);
    agree("effects", &result("effects coulomb_friction"));
    agree("simulate", &result(&format!("simulate {AXLE}")));
    agree("simulate --road", &result(&format!("simulate {AXLE} --road C@60km/h")));
    agree(
        "compare",
        &result(&format!("compare axle_a axle_a --params {AXLE} --set m_wheel=40")),
    );
    agree(
        "sensitivity",
        &result(&format!("sensitivity axle_a --campaign {AXLE} --metrics body_x.peak")),
    );
    agree("target", &written(&Studied::targets(), "target.json"));
    let response = result("frf quarter_car --frequencies 1:2:2");
    agree("frf", &response["channels"]["pad_to_body"]);
}

#[test]
fn a_study_holds_the_results_of_the_verbs() {
    let study = written(&Studied::new("axle_c_study"), "study.json");
    agree("study", &study);
    agree("discover", &study["discover"]);
    agree("fit", &study["fit"]);
    agree("kc", &study["kc"][0]);
    for (name, driven) in study["simulate"].as_object().unwrap() {
        assert!(printed(driven).is_subset(&documented("simulate")), "{name}");
    }
}
