//! The catalogue of effects, patches and differences as a user runs them.

use crate::common::{qcar, succeeds};
use serde_json::Value;

#[test]
fn a_patched_file_is_a_model_that_differs_in_the_effect_alone() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("patched.axle");
    let path = file.to_str().unwrap();
    succeeds(&["patch", "axle_c", "suspended_mass", "--at", "body", "--out", path]);
    assert_eq!(succeeds(&["check", path]), format!("{path}: ok\n"));
    insta::assert_snapshot!(succeeds(&["diff", "axle_c", path]));
    let json: Value = serde_json::from_str(&succeeds(&["diff", "axle_c", path, "--format", "json"])).unwrap();
    let new = json["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .map(|change| change["name"].as_str().unwrap());
    assert_eq!(
        new.collect::<Vec<_>>(),
        ["m_pwt", "k_pwt_z", "c_pwt_z", "k_pwt_x", "c_pwt_x"]
    );
    assert!(
        json["parameters"]
            .as_array()
            .unwrap()
            .iter()
            .all(|change| change["before"].is_null())
    );
}

/// A patched model without its gain would look like one that has it.
#[test]
fn an_error_of_a_sensor_says_that_no_equation_contains_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gain.axle");
    let note = "an error of a sensor changes what is measured, not the equations of motion: correct the channel in the \
                campaign";
    let place = ["patch", "axle_c", "sensor_gain", "--at", "body"];
    let said = succeeds(&[&place[..], &["--out", file.to_str().unwrap()]].concat());
    assert!(said.contains(&format!("note: {note}")), "{said}");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains(&format!("// {note}\n")), "{text}");
    let friction = succeeds(&["patch", "axle_c", "coulomb_friction", "--at", "damper"]);
    assert!(!friction.contains("error of a sensor"), "{friction}");
}

#[test]
fn starts_follow_the_parameters_of_the_campaign() {
    let campaign = "models/campaigns/axle_a_rig";
    let with = |flags: &[&str]| {
        let always = [
            "patch",
            "axle_a",
            "bushing_relaxation",
            "--at",
            "top_mount",
            "--params",
            campaign,
        ];
        succeeds(&[&always, flags].concat())
    };
    assert!(with(&["--set", "k_tm=4e5"]).contains("param k_maxwell: N/m = 200000 in 4000..8000000"));
    assert_ne!(with(&[]), with(&["--set", "k_tm=4e5"]));
}

#[test]
fn a_model_has_no_difference_from_itself() {
    assert_eq!(
        succeeds(&["diff", "axle_d", "models/axles/axle_d.axle"]),
        "no difference\n"
    );
}

#[test]
fn the_catalogue_says_where_each_effect_applies() {
    let places = succeeds(&["effects", "axle_d"]);
    let line = |effect: &str| places.lines().find(|line| line.starts_with(effect)).map(str::to_string);
    assert!(line("subframe_pitch").unwrap().ends_with("subframe"));
    assert!(line("suspended_mass").is_none(), "axle_d has its powertrain");
    let catalogue = succeeds(&["effects"]);
    assert_eq!(catalogue.lines().count(), 1 + models::effects().len());
}

#[test]
fn an_effect_says_what_each_parameter_is_to_it() {
    let play = succeeds(&["effects", "free_play"]);
    let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    let rows: Vec<String> = play.lines().map(words).collect();
    for begin in [
        "gap centred strength, vanishes at 0 m 0.05*l.travel_scale",
        "gap lost_motion shape m",
        "k_joint lost_motion N/m",
    ] {
        assert!(
            rows.iter().any(|row| row.starts_with(begin)),
            "{begin} is not in\n{play}"
        );
    }
    let by_path = succeeds(&["effects", "models/effects/series_compliance.axle", "--format", "json"]);
    let json: Value = serde_json::from_str(&by_path).unwrap();
    assert_eq!(json["parameters"][0]["vanishes_at"], "infinity");
}

#[test]
fn what_cannot_be_patched_says_what_to_write() {
    let cases = [
        (
            ["patch", "axle_c", "coulomb_friction", "--at", "strut"],
            "write `damper`",
        ),
        (["patch", "axle_c", "friction", "--at", "damper"], "choose among"),
        (["patch", "axle_a", "suspended_mass", "--at", "body"], "already"),
        (
            ["patch", "axle_c", "no/such.axle", "--at", "damper"],
            "correct the path",
        ),
    ];
    for (arguments, remedy) in cases {
        let ran = qcar(&arguments);
        assert_eq!(ran.status, 2, "{arguments:?}");
        assert!(ran.stderr.contains(remedy), "{}", ran.stderr);
    }
}
