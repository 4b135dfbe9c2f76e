//! What is missing is named, and nothing is invented, on campaigns that a second simulator makes.

use std::path::Path;
use std::process::Command;

use qcar_blind::hidden::Hidden;
use qcar_blind::{Order, make};
use serde_json::Value;

/// Runs `qcar discover` on a campaign.
fn discover(campaign: &Path, out: Option<&Path>) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_qcar"));
    command.arg("discover").arg(campaign).args(["--format", "json"]);
    if let Some(out) = out {
        command.arg("--out").arg(out);
    }
    let output = command.output().expect("qcar runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn what_is_left_of_a_clean_campaign_is_noise() {
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_a_rig");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "none");
    assert_eq!(answer["effects"], Value::Array(Vec::new()));
    assert_eq!(answer["places"], Value::Array(Vec::new()));
}

/// Published for the drive: Fc 20.39 N (Janot, Gautier and Brunot 2019). The damper's friction is not known, but its loops
/// are some 400 N wide where it hardly moves.
#[test]
fn dry_friction_is_named_in_measurements_of_real_hardware() {
    for (name, least, most) in [("emps", 20.0, 21.0), ("mr_damper", 150.0, 400.0)] {
        let campaign = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("models/campaigns")
            .join(name);
        let answer = discover(&campaign, None);
        assert_eq!(answer["verdict"], "found", "{answer}");
        assert_eq!(answer["effects"][0]["name"], "coulomb_friction");
        assert_eq!(answer["effects"].as_array().map(Vec::len), Some(1));
        let found = answer["effects"][0]["parameters"]["f_coulomb"]
            .as_f64()
            .expect("a number");
        assert!((least..=most).contains(&found), "{name}: {found} N");
    }
}

/// With the damper bolted to the body nothing is left to move on the K&C rig.
#[test]
fn a_top_mount_that_the_model_lacks_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let truth = [("m_tm", 5.0), ("k_tm", 450e3), ("c_tm", 700.0)];
    let order = Order {
        cleats: false,
        effects: vec![Hidden::new("top_mount", "damper", &truth)],
        ..Order::clean("c", 23)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "top_mount");
    assert_eq!(answer["effects"][0]["at"], "damper");
    let of_ceiling = answer["effects"][0]["evidence"]["of_ceiling"].as_f64();
    assert!(of_ceiling.is_some_and(|share| share > 0.8), "{answer}");
    // Bolted on, the damper stands where the spring does.
    let best = &answer["places"][0];
    assert!(best["at"] == "damper" || best["at"] == "spring", "{best}");
    assert!(best["explains"].as_f64().is_some_and(|share| share > 0.8), "{best}");
    for (name, value) in truth {
        let found = answer["effects"][0]["parameters"][name].as_f64().expect("a number");
        assert!((found / value - 1.0).abs() < 0.15, "{name} is {found}, not {value}");
    }
}

/// Its law has a kink where the damper turns, at which no step of a search is sure to help.
#[test]
fn a_damper_that_is_harder_in_rebound_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    let order = Order {
        cleats: false,
        effects: vec![Hidden::new(
            "asymmetric_damper",
            "damper",
            &[("rebound_over_compression", 1.6)],
        )],
        ..Order::clean("c", 24)
    };
    make(order, &campaign).expect("a campaign");
    let answer = discover(&campaign, None);
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "asymmetric_damper");
    assert_eq!(answer["effects"][0]["at"], "damper");
    let found = answer["effects"][0]["parameters"]["rebound_over_compression"]
        .as_f64()
        .expect("a number");
    assert!((found / 1.6 - 1.0).abs() < 0.05, "{found}");
}

/// A fit of a model that brings its effect along, which the campaign knows nothing of.
#[test]
fn a_model_that_has_the_effect_already_lacks_nothing() {
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_c_study");
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("patched.axle");
    let patch = ["patch", "axle_c", "suspended_mass", "--at", "body", "--out"];
    let patched = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(patch)
        .arg(&model)
        .output();
    assert!(patched.expect("qcar runs").status.success());
    let output = Command::new(env!("CARGO_BIN_EXE_qcar"))
        .arg("discover")
        .arg(&campaign)
        .arg("--model")
        .arg(&model)
        .args(["--format", "json"])
        .output()
        .expect("qcar runs");
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(answer["verdict"], "none", "{answer}");
}

#[test]
fn a_powertrain_without_a_sensor_is_found_and_the_model_with_it_compiles() {
    let folder = tempfile::tempdir().expect("a folder");
    let (campaign, out) = (folder.path().join("campaign"), folder.path().join("out"));
    let truth = [
        ("m_pwt", 70.0),
        ("k_pwt_z", 280e3),
        ("c_pwt_z", 500.0),
        ("k_pwt_x", 3e5),
        ("c_pwt_x", 400.0),
    ];
    let hidden = Hidden::new("suspended_mass", "body", &truth);
    let order = Order {
        cleats: false,
        effects: vec![hidden],
        ..Order::clean("c", 22)
    };
    make(order, &campaign).expect("a campaign");

    let answer = discover(&campaign, Some(&out));
    assert_eq!(answer["verdict"], "found", "{answer}");
    assert_eq!(answer["effects"][0]["name"], "suspended_mass");
    assert_eq!(answer["effects"][0]["at"], "body");
    for (name, value) in &truth[..3] {
        let found = answer["effects"][0]["parameters"][name].as_f64().expect("a number");
        assert!((found / value - 1.0).abs() < 0.15, "{name} is {found}, not {value}");
    }
    let gap = |role: &str, when: &str| answer["gap"][role][when].as_f64().expect("a number");
    assert!(
        gap("held_out", "before") > 10.0 && gap("held_out", "after") < 1.5,
        "{answer}"
    );
    let model = answer["model_file"].as_str().expect("a file");
    qcar::catalogue::compiled(model).unwrap_or_else(|failure| panic!("{failure:?}"));
}
