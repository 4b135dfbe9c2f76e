//! Two sides beside each other, as a user compares them.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{self, copy, qcar, qcar_in, succeeds};

const AXLE: &str = "models/campaigns/axle_a_rig";
const STUDY: &str = "models/campaigns/axle_c_study";

fn compared(arguments: &[&str]) -> Value {
    let line = [&["compare"], arguments, &["--format", "json"]].concat();
    serde_json::from_str(&succeeds(&line)).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance * expected.abs().max(1e-9), "{found} for {expected}");
}

fn named<'a>(list: &'a Value, key: &str, name: &str) -> &'a Value {
    let mut all = list.as_array().unwrap().iter();
    all.find(|own| own[key] == name)
        .unwrap_or_else(|| panic!("no {name} in {list}"))
}

/// A folder with files of parameters, and their paths.
fn files<const N: usize>(texts: [&str; N]) -> (tempfile::TempDir, [String; N]) {
    let folder = tempfile::tempdir().unwrap();
    let mut place = 0;
    let paths = texts.map(|text| {
        place += 1;
        let path = folder.path().join(format!("{place}.toml"));
        fs::write(&path, format!("[parameters]\n{text}")).unwrap();
        path.display().to_string()
    });
    (folder, paths)
}

/// A mass on a spring and a damper: all that is compared has a closed form.
#[test]
fn an_oscillator_moves_as_its_formula_says() {
    let (_folder, [a, b]) = files([
        "m_body = 2.0\nk_body = 800.0\nc_body = 4.0\n",
        "m_body = 2.0\nk_body = 1800.0\nc_body = 12.0\n",
    ]);
    let found = compared(&[&a, &b, "--model", "one_mass"]);
    let spring = named(&found["parameters"], "name", "k_body");
    close(number(&spring["difference"]), 1000.0, 1e-12);
    close(number(&spring["relative"]), 1.25, 1e-12);
    assert_eq!(
        (&spring["moved"], &spring["standard_errors"]),
        (&true.into(), &Value::Null)
    );
    assert_eq!(named(&found["parameters"], "name", "m_body")["moved"], false);
    let mode = &found["modes"][0];
    for (side, k, c) in [("a", 800.0_f64, 4.0), ("b", 1800.0, 12.0)] {
        let omega = (k / 2.0_f64).sqrt();
        close(number(&mode[side]["frequency"]), omega / TAU, 1e-4);
        close(number(&mode[side]["damping"]), c / (2.0 * 2.0 * omega), 1e-4);
    }
    let said = found["notices"].to_string();
    assert!(
        said.contains("no common channel") && said.contains("no tyre that can roll"),
        "{said}"
    );
}

#[test]
fn what_no_rig_run_has_seen_is_told_of_both_campaigns() {
    let said = compared(&[AXLE, STUDY])["notices"].to_string();
    for (campaign, names) in [(AXLE, "c_wheel_x, k_pwt_x, c_pwt_x"), (STUDY, "c_wheel_x")] {
        let told = format!("{campaign}: no rig run determines {names}, which have start values.");
        assert!(said.contains(&told), "{told} is not in {said}");
    }
}

#[test]
fn the_same_twice_differs_in_nothing() {
    let found = compared(&["axle_c", "axle_c", "--params", STUDY]);
    let moved = |own: &Value| own["moved"] == true;
    assert!(!found["parameters"].as_array().unwrap().iter().any(moved));
    assert_eq!(found["changes"], serde_json::json!({}));
    for own in found["transmissibility"].as_array().unwrap() {
        assert_eq!(number(&own["change"]["magnitude"]), 0.0);
    }
    let runs = found["cleat"]["runs"].as_array().unwrap();
    assert_eq!(runs.len() % 12, 0, "20, 30 and 40 km/h over four heights");
    assert!(runs.iter().all(|own| number(&own["peak"]["change"]) == 0.0));
}

/// The largest change of a channel is that between the responses that `qcar frf` prints.
#[test]
fn transmissibilities_differ_by_what_their_responses_do() {
    let lines = ["--frequencies", "1:30:40"];
    let found = compared(&[&["axle_c", "axle_c_rigid_tm", "--params", STUDY], &lines[..]].concat());
    let response = |model: &str, params: &str| -> Vec<f64> {
        let line = [
            "frf",
            model,
            "--params",
            params,
            "--channels",
            "pad_to_body",
            "--format",
            "json",
        ];
        let printed: Value = serde_json::from_str(&succeeds(&[&line[..], &lines].concat())).unwrap();
        let channel = &printed["channels"]["pad_to_body"];
        let part = |name: &str| channel[name].as_array().unwrap().iter().map(number).collect::<Vec<_>>();
        part("re")
            .iter()
            .zip(part("im"))
            .map(|(re, im)| 20.0 * re.hypot(im).log10())
            .collect()
    };
    let (_folder, [rigid]) = files([&without_the_mount()]);
    let (a, b) = (response("axle_c", STUDY), response("axle_c_rigid_tm", &rigid));
    let largest = a
        .iter()
        .zip(&b)
        .map(|(a, b)| b - a)
        .max_by(|x, y| x.abs().total_cmp(&y.abs()))
        .unwrap();
    let own = named(&found["transmissibility"], "channel", "pad_to_body");
    close(number(&own["change"]["magnitude"]), largest, 1e-4);
}

/// A spring whose rate does not grow is nonlinear in its file alone: in the sweep of a campaign it answers as the
/// linear one does, but for the straight lines between the places where it is known.
#[test]
fn a_nonlinear_model_without_its_effect_answers_as_the_linear_one() {
    let folder = tempfile::tempdir().unwrap();
    let [campaign, patched] = ["rig", "patched.axle"].map(|name| folder.path().join(name).display().to_string());
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE), Path::new(&campaign));
    let (manifest, truth) = (format!("{campaign}/campaign.toml"), format!("{campaign}/truth.toml"));
    let text = fs::read_to_string(&manifest).unwrap();
    let is_kept = |part: &&str| {
        !["sweep_050", "sweep_100", "v20_h30", "v30_h20"]
            .iter()
            .any(|name| part.contains(name))
    };
    let kept: Vec<&str> = text.split("[[run]]").filter(is_kept).collect();
    fs::write(&manifest, kept.join("[[run]]")).unwrap();
    succeeds(&[
        "patch",
        "axle_a",
        "progressive_spring",
        "--at",
        "spring",
        "--params",
        AXLE,
        "--out",
        &patched,
    ]);
    let found = compared(&[
        "axle_a",
        &patched,
        "--params",
        &truth,
        "--campaign",
        &campaign,
        "--set",
        "rate_increase_at_40mm=0",
    ]);
    let channels = found["transmissibility"].as_array().unwrap();
    assert_eq!(channels.len(), 5);
    for own in channels {
        assert!(number(&own["change"]["rms"]) < 0.2, "{own}");
    }
    for own in found["cleat"]["runs"].as_array().unwrap() {
        assert!(number(&own["peak"]["change"]).abs() < 1e-3, "{own}");
    }
    assert!(found["notices"].to_string().contains("nonlinear"));
}

/// The values of the campaign that a model without a top mount has.
fn without_the_mount() -> String {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(STUDY).join("campaign.toml")).unwrap();
    let campaign: toml::Table = text.parse().unwrap();
    let facts = campaign["vehicle"].as_table().unwrap().iter().filter(|(name, _)| {
        [
            "m_corner",
            "m_half_vehicle",
            "m_wheel_other_axle",
            "static_tire_load",
            "static_tire_def",
        ]
        .contains(&name.as_str())
    });
    let values = campaign["parameters"].as_table().unwrap().iter();
    let values = values
        .filter(|(name, _)| !name.ends_with("_tm"))
        .map(|(name, own)| (name, &own["value"]));
    facts
        .chain(values)
        .map(|(name, value)| format!("{name} = {value}\n"))
        .collect()
}

/// The peaks of each side are those that `qcar simulate` finds with its values, and the measured ones the same.
#[test]
fn peaks_over_the_cleat_are_those_of_the_simulation() {
    let truth = format!("{AXLE}/truth.toml");
    let found = compared(&[&format!("{AXLE}/campaign.toml"), &truth, "--campaign", AXLE]);
    let alone: Value =
        serde_json::from_str(&succeeds(&["simulate", AXLE, "--params", &truth, "--format", "json"])).unwrap();
    let runs = found["cleat"]["runs"].as_array().unwrap();
    for own in alone["runs"].as_array().unwrap() {
        let same = |other: &&Value| ["run", "mass", "axis"].iter().all(|key| other[*key] == own[*key]);
        let beside = runs.iter().find(same).unwrap_or_else(|| panic!("no {own}"));
        close(number(&beside["peak"]["b"]), number(&own["simulated_peak"]), 1e-9);
        close(
            number(&beside["peak"]["measured"][0]),
            number(&own["measured_peak"]),
            1e-9,
        );
        close(
            number(&beside["after_shake"]["b"]),
            number(&own["simulated_after_shake"]),
            0.02,
        );
    }
}

#[test]
fn fits_are_compared_in_units_of_their_errors() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| folder.path().join(name).display().to_string());
    succeeds(&["fit", AXLE, "--starts", "1", "--out", &a]);
    succeeds(&["fit", AXLE, "--starts", "1", "--fix", "k_tm,c_tm", "--out", &b]);
    let found = compared(&[&a, &b]);
    assert_eq!(
        (&found["kind"], &found["a"]["model"]),
        (&"parameters".into(), &"axle_a".into())
    );
    let fit =
        |out: &str| -> Value { serde_json::from_str(&fs::read_to_string(format!("{out}/fit.json")).unwrap()).unwrap() };
    let (first, second) = (fit(&a), fit(&b));
    let own = |of: &Value, key: &str| number(&of["parameters"]["k_tire"][key]);
    let combined = (own(&first, "stderr").powi(2) + own(&second, "stderr").powi(2)).sqrt();
    let expected = (own(&second, "value") - own(&first, "value")) / combined;
    close(
        number(&named(&found["parameters"], "name", "k_tire")["standard_errors"]),
        expected,
        1e-9,
    );
    assert_eq!(
        named(&found["parameters"], "name", "k_tm")["standard_errors"],
        Value::Null
    );
}

#[test]
fn campaigns_are_compared_as_they_were_measured() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let found = compared(&[AXLE, STUDY, "--out", &out]);
    let bounce = &found["kc"][0];
    let gradient = |campaign: &str| -> f64 {
        let printed: Value = serde_json::from_str(&succeeds(&["kc", campaign, "--format", "json"])).unwrap();
        number(&printed[0]["value"])
    };
    close(
        number(&bounce["relative"]),
        gradient(STUDY) / gradient(AXLE) - 1.0,
        1e-9,
    );
    // Half of the second campaign hangs on a mass that its model does not have.
    let own = named(&found["transmissibility"], "channel", "pad_to_body");
    assert!(number(&own["fit"][0]) > 99.0 && number(&own["fit"][1]) < 85.0, "{own}");
    assert!(number(&own["measured"]["rms"]) > 1.0, "{own}");
    // The mean of the coherence is that of the lines in the table.
    let table = fs::read_to_string(folder.path().join("transmissibility.csv")).unwrap();
    let cells = |line: &str| line.split(',').map(String::from).collect::<Vec<_>>();
    let head = cells(table.lines().next().unwrap());
    let [run, a, b] =
        ["run", "coherence_a", "coherence_b"].map(|name| head.iter().position(|own| own == name).unwrap());
    let rows = table.lines().map(cells);
    let rows: Vec<_> = rows
        .filter(|row| row[run] == own["run"].as_str().unwrap() && row[run + 1] == "pad_to_body")
        .collect();
    for (column, place) in [(a, 0), (b, 1)] {
        let lines: Vec<f64> = rows.iter().filter_map(|row| row[column].parse().ok()).collect();
        let mean = lines.iter().sum::<f64>() / lines.len() as f64;
        close(number(&own["coherence"][place]), mean, 1e-3);
        assert!(
            lines.len() > 100 && lines.iter().all(|share| (0.0..=1.0).contains(share)),
            "{lines:?}"
        );
    }
    assert!(number(&found["cleat"]["measured"]["body_z"]["after_shake"]["median"]) > 1.0);
    for file in [
        "report.html",
        "compare.json",
        "parameters.csv",
        "transmissibility.csv",
        "cleat.csv",
    ] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
    let kept: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("compare.json")).unwrap()).unwrap();
    assert_eq!(kept, found);
}

#[test]
fn what_cannot_be_compared_is_refused_with_a_remedy() {
    let (folder, [a, b]) = files(["k_tire = 2e5\n", "k_tyre = 2e5\n"]);
    let empty = folder.path().display().to_string();
    let note = folder.path().join("notes.txt");
    fs::write(&note, "").unwrap();
    let json = folder.path().join("a.json");
    fs::write(&json, "{\"name\": 1}").unwrap();
    let (note, json) = (note.to_str().unwrap(), json.to_str().unwrap());
    let refused = |arguments: &[&str], said: &[&str]| {
        common::refused(&qcar(&[&["compare"], arguments].concat()), said);
    };
    refused(&["axle_a", AXLE], &["is a model", "is a campaign", "two of one kind"]);
    refused(&["axle_q", "axle_a"], &["`axle_q`, which does not exist", "`A`"]);
    refused(&["axle_a", &empty], &["without campaign.toml or fit.json", "`B`"]);
    refused(&["axle_a", note], &["notes.txt", "ending"]);
    refused(&[&a, &a], &["no model", "--model NAME"]);
    refused(
        &[&a, &b, "--model", "quarter_car"],
        &["2.toml", "did you mean `k_tire`?"],
    );
    refused(&[&a, json, "--model", "quarter_car"], &["a.json", "`qcar fit --out`"]);
    refused(
        &["axle_a", "axle_b", "--model", "axle_c"],
        &["--model", "compare parameter files"],
    );
    refused(&["axle_a", "axle_c"], &["`m_wheel`", "no value"]);
    refused(&[AXLE, STUDY, "--params", &a], &["--params", "leave --params out"]);
    refused(
        &["axle_a", "axle_c", "--params", AXLE, "--set", "k_moon=1"],
        &["k_moon"],
    );
}

#[test]
fn a_folder_called_like_a_model_is_no_guess() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("axle_a")).unwrap();
    fs::write(folder.path().join("axle_a/campaign.toml"), "").unwrap();
    let ran = qcar_in(folder.path(), &["compare", "axle_a", "axle_a"]);
    assert_eq!(ran.status, 2);
    assert!(ran.stderr.contains("write ./axle_a"), "{}", ran.stderr);
}
