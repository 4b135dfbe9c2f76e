//! Campaigns of a rig whose sweeps are made here: what a fit, a discovery and a study say when something is wrong with
//! them.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{Ran, copy, run_line, sweep};

/// A campaign of two sweeps and a K&C curve of the same spring, for a model whose wheel is called `hub`.
const MANIFEST: &str = r#"
format = 1
name = "rig"
model = "hub.axle"

[vehicle]
m_corner = 315

[[channel]]
name = "pad_z"
location = "PAD"
side = "centre"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[channel]]
name = "rear_pad_z"
location = "REAR"
side = "centre"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[channel]]
name = "body_z"
location = "body"
side = "left"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[channel]]
name = "body_right_z"
location = "body"
side = "right"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[channel]]
name = "hub_z"
location = "HUB"
side = "left"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[channel]]
name = "hub_right_z"
location = "HUB"
side = "right"
axis = "z"
quantity = "acceleration"
unit = "m/s^2"

[[run]]
kind = "sweep"
file = "fast.csv"
role = "fit"
peak_velocity = 0.1
start_frequency = 0.5
end_frequency = 30.0
spacing = "logarithmic"
sample_rate = 1000.0

[[run]]
kind = "bounce"
file = "kc/bounce.csv"
role = "fit"
"#;

/// The spring of the K&C curve in `tests/data/trials`, N/m.
const SPRING: f64 = 31e3;

/// The campaign with these words in its manifest.
fn rig(words: [(&str, &str); 4]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let trials = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/trials");
    copy(Path::new(trials), folder.path());
    let mut text = MANIFEST.to_string();
    for (word, name) in words {
        assert!(text.contains(word), "{word}");
        text = text.replace(word, name);
    }
    fs::write(folder.path().join("campaign.toml"), text).unwrap();
    let header = "time,pad_z,rear_pad_z,body_z,body_right_z,hub_z,hub_right_z";
    fs::write(folder.path().join("fast.csv"), sweep(0.1, header, [SPRING, 0.0])).unwrap();
    folder
}

/// For `hub.axle`, whose pad has a sensor on each side.
fn sound() -> tempfile::TempDir {
    rig([
        ("PAD\"\nside = \"centre", "pad\"\nside = \"left"),
        ("REAR\"\nside = \"centre", "pad\"\nside = \"right"),
        ("HUB", "hub"),
        ("name = \"rig\"", "name = \"one_tyre\""),
    ])
}

#[track_caller]
fn ended(ran: &Ran, status: i32, said: &[&str]) {
    let all = format!("{}{}", ran.stdout, ran.stderr);
    assert!(
        ran.status == status && !all.contains("panicked"),
        "{}: {all}",
        ran.status
    );
    said.iter()
        .for_each(|fragment| assert!(all.contains(fragment), "expected `{fragment}` in\n{all}"));
}

/// The fitted sweep calls for no effect, and the held-out one is of an axle with another spring. No other sweep of this
/// campaign shows it, so the verdict cannot be that nothing is missing.
#[test]
fn residuals_of_held_out_runs_are_not_called_noise() {
    let folder = sound();
    let header = "time,pad_z,rear_pad_z,body_z,body_right_z,hub_z,hub_right_z";
    fs::write(folder.path().join("other.csv"), sweep(0.1, header, [1.3 * SPRING, 0.0])).unwrap();
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let fitted = text.split("[[run]]").nth(1).unwrap();
    let held_out = fitted
        .replace("fast.csv", "other.csv")
        .replace("\"fit\"", "\"held_out\"");
    fs::write(&manifest, format!("{text}\n[[run]]{held_out}")).unwrap();
    let ran = run_line(folder.path(), "discover .");
    let said = "something is missing that no effect of the catalogue explains: only the held-out runs show it, with residuals of";
    ended(&ran, 0, &[said, "standard deviations"]);
}

#[test]
fn a_fit_that_ends_at_all_bounds_is_a_finding() {
    let folder = sound();
    let sound = run_line(folder.path(), "fit . --starts 1");
    ended(&sound, 0, &["converged"]);
    assert!(!sound.stdout.contains("at a bound of its range"), "{}", sound.stdout);
    let manifest = folder.path().join("campaign.toml");
    let mut text = fs::read_to_string(&manifest).unwrap();
    for (name, unit, value, range, fit) in [
        ("m_wheel", "kg", 45.0, [20.0, 80.0], false),
        ("c", "N s/m", 1300.0, [100.0, 1e4], false),
        ("k", "N/m", 1.6 * SPRING, [1.5 * SPRING, 3.0 * SPRING], true),
        ("k_tire", "N/m", 1.1e5, [1e5, 1.2e5], true),
    ] {
        text += &format!(
            "\n[parameters.{name}]\nvalue = {value:.1}\nunit = \"{unit}\"\nrange = {range:.1?}\nfit = {fit}\n"
        );
    }
    fs::write(&manifest, text).unwrap();
    ended(
        &run_line(folder.path(), "fit . --starts 1"),
        1,
        &[
            "every fitted parameter ends at a bound of its range (k, k_tire)",
            "check the sensors' units",
        ],
    );
}

#[test]
fn results_of_another_fit_are_not_written_over() {
    let folder = sound();
    ended(&run_line(folder.path(), "fit . --starts 1 --out results"), 0, &[]);
    ended(&run_line(folder.path(), "fit . --starts 1 --out results"), 0, &[]);
    let kept = fs::read(folder.path().join("results/fit.json")).unwrap();
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("one_tyre", "another")).unwrap();
    ended(
        &run_line(folder.path(), "fit . --starts 1 --out results"),
        2,
        &[
            "results of mine fitted to one_tyre",
            "results of mine fitted to another",
            "choose another folder",
        ],
    );
    assert_eq!(fs::read(folder.path().join("results/fit.json")).unwrap(), kept);
}

#[test]
fn two_roads_that_move_in_one_sweep_are_refused() {
    let folder = rig([
        ("PAD", "pad_f"),
        ("REAR", "pad_r"),
        ("HUB", "wheel_f"),
        ("model = \"hub.axle\"", "model = \"two_tyres.axle\""),
    ]);
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("m_corner = 315", "m_body = 620")).unwrap();
    ended(
        &run_line(folder.path(), "fit . --starts 1"),
        2,
        &[
            "fast.csv",
            "several moving roads: `pad_f`, `pad_r`",
            "move one at a time",
        ],
    );
    ended(
        &run_line(folder.path(), "discover ."),
        2,
        &["fast.csv", "sensors at several pads", "pad_f", "pad_r"],
    );
}

/// With body and wheel held, nothing of the model is free.
#[test]
fn a_curve_of_a_model_in_which_nothing_yields_is_evidence() {
    let folder = sound();
    let found = run_line(folder.path(), "discover . --format json");
    ended(&found, 0, &[]);
    let answer: Value = serde_json::from_str(&found.stdout).unwrap();
    assert!(answer["verdict"].is_string(), "{answer}");
    assert!(!answer["notices"].to_string().contains("left out"), "{answer}");
    let study = run_line(folder.path(), "study . --out study --format json");
    ended(&study, 0, &[]);
    let [printed, written] = [
        study.stdout,
        fs::read_to_string(folder.path().join("study/study.json")).unwrap(),
    ]
    .map(|text| serde_json::from_str::<Value>(&text).unwrap());
    assert_eq!(printed, written);
    let gradients = fs::read_to_string(folder.path().join("study/kc/gradients.json")).unwrap();
    let gradients: Value = serde_json::from_str(&gradients).unwrap();
    assert_eq!(gradients[0]["parameter"], "k", "{gradients}");
}
