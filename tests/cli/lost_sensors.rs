//! Campaigns that do not fit their model: every verb says so, `check` first of all.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::common::{copy, qcar, refused, run_line, succeeds};
use crate::records::{campaign, parameter, pushed};

/// A copy of the campaign in the repository whose file `file` has been through `change`.
fn changed(file: &str, change: impl Fn(String) -> String) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/campaigns/axle_a_rig");
    copy(&shipped, folder.path());
    let file = folder.path().join(file);
    let text = fs::read_to_string(&file).unwrap();
    let new = change(text.clone());
    assert_ne!(new, text);
    fs::write(&file, new).unwrap();
    folder
}

fn misplaced() -> TempDir {
    changed("campaign.toml", |text| {
        text.replace("location = \"wheel\"", "location = \"whel\"")
    })
}

#[test]
fn a_misspelt_place_of_a_cleat_run_is_no_missing_output() {
    let folder = misplaced();
    let said = succeeds(&["simulate", folder.path().to_str().unwrap(), "--format", "json"]);
    assert!(
        said.contains("model `axle_a` has no `whel` along z; did you mean `wheel`?"),
        "{said}"
    );
    assert!(!said.contains("output whel"), "{said}");
    assert!(
        said.contains(
            "model `axle_a` gives no acceleration of `whel` along z, so that sensor is left out; did you mean `wheel`?"
        ),
        "{said}"
    );
}

/// Two masses, of which only the upper one is an output.
const HALF_SHOWN: &str = "axle half_shown {\n    \"A mass on a mass\"\n    param k: N/m = 800 in 1..1e4;\n    \
    direction z {\n        mass body = 1 kg; mass upper = 1 kg; force f on body;\n        \
    link spring: body { spring k; damper 3 N s/m; }\n        \
    link top: upper - body { spring 700 N/m; damper 3 N s/m; }\n        output upper.acceleration;\n    }\n}\n";

#[test]
fn a_mass_without_an_output_is_no_missing_mass() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    fs::write(folder.path().join("half_shown.axle"), HALF_SHOWN).unwrap();
    let parameters = parameter("k", 800.0, "N/m", "range = [1.0, 2000.0]\n");
    campaign(
        folder.path(),
        "./half_shown.axle",
        &parameters,
        "band_limited = false",
        &[&pushed()],
    );
    let said = [
        "model `half_shown` gives no displacement of `body` along z",
        "add `output body.position;` to the model",
    ];
    for verb in ["fit", "discover"] {
        refused(&qcar(&[verb, path]), &said);
    }
    let checked = qcar(&["check", path]);
    assert!(
        checked.status == 1 && said.iter().all(|said| checked.stdout.contains(said)),
        "{}",
        checked.stdout
    );
}

#[test]
fn a_recorded_input_that_the_model_lacks_is_named_by_a_replay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    let parameters = parameter("k_body", 800.0, "N/m", "range = [1.0, 2000.0]\n");
    campaign(
        folder.path(),
        "one_mass",
        &parameters,
        "band_limited = false",
        &[&pushed()],
    );
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("location = \"f\"", "location = \"push\"")).unwrap();
    let said = succeeds(&["simulate", path]);
    assert!(
        said.contains("model `one_mass` gives no force of `push` along z, so that sensor is left out"),
        "{said}"
    );
    let checked = succeeds(&["check", path]);
    assert!(checked.contains("ok, with warnings"), "{checked}");
    assert!(
        checked.contains("channel `push`: model `one_mass` gives no force of `push` along z"),
        "{checked}"
    );
}

#[test]
fn a_check_of_a_campaign_refuses_what_its_other_verbs_refuse() {
    let check = |from: &str, to: &str, said: &[&str]| {
        let folder = changed("campaign.toml", |text| text.replace(from, to));
        refused(&qcar(&["check", folder.path().to_str().unwrap()]), said);
    };
    check(
        "model = \"axle_a\"",
        "model = \"axle_q\"",
        &["campaign.toml", "`axle_q`", "`axle_a`"],
    );
    check(
        "m_corner",
        "m_korner",
        &["campaign.toml", "vehicle.m_korner", "did you mean `m_corner`?"],
    );
    check(
        "[parameters.k_tire]",
        "[parameters.k_tyre]",
        &["parameters.k_tyre", "did you mean `k_tire`?"],
    );
    check(
        "r_tire = ",
        "r_tire = -",
        &[
            "campaign.toml",
            "`vehicle.r_tire`: found -0.35",
            "correct the value or its unit",
        ],
    );
    let checked = qcar(&["check", misplaced().path().to_str().unwrap()]);
    assert_eq!(checked.status, 1, "{}", checked.stderr);
    let checked = checked.stdout;
    assert!(checked.contains(": cannot be fitted"), "{checked}");
    assert!(checked.contains("gives no acceleration of `whel` along z"), "{checked}");
    assert!(checked.contains("did you mean `wheel`?"), "{checked}");
}

/// A body that heaves and pitches.
const TURNING: &str = "axle turning {\n    \"A body that turns\"\n    param m: kg = 2 in 1..10;\n    param j: kg m^2 = 1 in 0.1..10;\n    \
    param k: N/m = 800 in 1..1e4;\n    direction z {\n        road pad;\n        mass body = m; inertia pitch = j;\n        \
    link front: body + 1.3 m*pitch - pad { spring k; damper 3 N s/m; }\n        \
    link rear: body - 1.1 m*pitch { spring 700 N/m; damper 3 N s/m; }\n    }\n}\n";

/// A mass that turns has an angular acceleration, which no accelerometer measures.
#[test]
fn an_angle_is_no_displacement() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    fs::write(folder.path().join("turning.axle"), TURNING).unwrap();
    let file = folder.path().join("turning.axle");
    succeeds(&[
        "new",
        "campaign",
        "fresh",
        "--dir",
        path,
        "--model",
        file.to_str().unwrap(),
    ]);
    let fresh = fs::read_to_string(folder.path().join("fresh/campaign.toml")).unwrap();
    assert!(
        fresh.contains("body_left_z") && !fresh.contains("pitch_left_z"),
        "{fresh}"
    );
    let parameters = parameter("k", 800.0, "N/m", "range = [1.0, 2000.0]\n");
    campaign(
        folder.path(),
        "./turning.axle",
        &parameters,
        "band_limited = false",
        &[&pushed()],
    );
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let text = text.replace("location = \"body\"", "location = \"pitch\"");
    let text = text.replace(
        "quantity = \"displacement\"\nunit = \"m\"",
        "quantity = \"acceleration\"\nunit = \"m/s^2\"",
    );
    fs::write(&manifest, text).unwrap();
    for verb in ["check", "simulate", "fit", "discover"] {
        let said = [
            "campaign.toml, `channel z`",
            "`pitch` in m/s^2",
            "one in rad/s^2",
            "write `unit = \"rad/s^2\"`",
            "remove the channel",
        ];
        refused(&qcar(&[verb, path]), &said);
    }
}

#[test]
fn a_true_value_that_the_model_lacks_is_not_passed_over() {
    let folder = changed("truth.toml", |text| text.replace("k_tm", "k_tmm"));
    let said = ["truth.toml, line", "parameters.k_tmm", "did you mean `k_tm`?"];
    refused(&qcar(&["score", folder.path().to_str().unwrap()]), &said);
}

/// By its unit, by its name, or because the model says so; a unit of a translation counts for more than a name.
#[test]
fn an_imported_angle_is_no_sensor() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("turning.axle"), TURNING).unwrap();
    let angles = [
        ("body_acc_z", "deg/s^2", "its unit is that of an angle"),
        ("body_left_z", "rad", "its unit is that of an angle"),
        ("body_right_z", "°/s", "its unit is that of an angle"),
        ("wheel_z", "mrad", "its unit is that of an angle"),
        ("body_yaw_z", "V", "its name means an angle"),
        ("Aufbau Winkel z", "", "its name means an angle"),
        ("pitch_acc_z", "m/s^2", "is an angle in the model"),
        ("pitch_z", "V", "is an angle in the model"),
    ];
    let sensors = [
        ("pad_z", "m/s^2"),
        ("body_roll_centre_z", "m/s^2"),
        ("pitch_rate", "deg/s"),
    ];
    let channels = angles.iter().map(|(name, unit, _)| (*name, *unit)).chain(sensors);
    let headings: Vec<String> = channels
        .map(|(name, unit)| format!("{name} [{unit}]").replace(" []", ""))
        .collect();
    let row = |sample: usize| format!("{}{}\n", sample as f64 / 100.0, ",0.5".repeat(headings.len()));
    let table: String = (0..100).map(row).collect();
    let file = folder.path().join("turns.csv");
    fs::write(file, format!("time [s],{}\n{table}", headings.join(","))).unwrap();
    let ran = run_line(folder.path(), "import turns.csv --out rig --model turning.axle");
    assert_eq!(ran.status, 0, "{}", ran.stderr);
    let text = fs::read_to_string(folder.path().join("rig/campaign.toml")).unwrap();
    for (name, _, why) in angles {
        let told = ran
            .stdout
            .lines()
            .find(|line| line.starts_with(&format!("{name}: no sensor, ")));
        assert!(told.is_some_and(|line| line.contains(why)), "{name}: {}", ran.stdout);
        assert!(text.contains(&format!("# {name:?}: ")), "{text}");
    }
    let known: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("location = "))
        .collect();
    assert_eq!(known, ["\"pad\"", "\"body\"", "\"pitch\""]);
    assert!(
        text.contains("quantity = \"velocity\"\nsource = \"pitch_rate\"\nunit = \"deg/s\"\n"),
        "{text}"
    );
    assert!(text.contains("# location = \"pad\" # of pad, body\n"), "{text}");
}
