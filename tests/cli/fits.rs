//! Fits of the campaigns in the repository, as a user runs them.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{copy, qcar, succeeds};

const AXLE: &str = "models/campaigns/axle_a_rig";

fn fitted(arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(&[&["fit"], arguments, &["--format", "json"]].concat())).unwrap()
}

#[test]
fn the_simulated_axle_is_found_again() {
    let report = succeeds(&["score", AXLE]);
    assert!(report.matches(" well\n").count() >= 6, "{report}");
}

#[test]
fn what_is_kept_stays_and_says_so() {
    let fit = fitted(&[AXLE, "--fix", "k_tire,m_wheel", "--starts", "2"]);
    for (name, kept) in [("k_tire", 187000.0), ("m_wheel", 42.2)] {
        let parameter = &fit["parameters"][name];
        assert_eq!(
            (&parameter["fitted"], &parameter["value"]),
            (&Value::Bool(false), &kept.into())
        );
        assert_eq!(parameter["stderr"], Value::Null);
    }
    assert_eq!(fit["starts"], 2);
    assert_eq!(fit["parameters"]["k_wheel_x"]["why_no_stderr"]["reason"], "not_seen");
}

#[test]
fn another_model_can_be_fitted_by_its_file() {
    let fit = fitted(&[
        AXLE,
        "--model",
        "models/axles/axle_a.axle",
        "--channels",
        "pad_to_wheel,pad_to_body",
    ]);
    assert_eq!(fit["model"], "axle_a");
    let in_cost = |channel: &&Value| channel["fitted"] == true;
    let names = fit["channels"]
        .as_array()
        .unwrap()
        .iter()
        .filter(in_cost)
        .map(|channel| channel["name"].as_str().unwrap());
    assert!(
        names.clone().count() > 0
            && names
                .into_iter()
                .all(|name| ["pad_to_wheel", "pad_to_body"].contains(&name))
    );
}

#[test]
fn results_are_written_whole_and_can_be_used_again() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("deep/results");
    let out = out.to_str().unwrap();
    for _ in 0..2 {
        succeeds(&["fit", AXLE, "--out", out]);
    }
    let mut names: Vec<_> = fs::read_dir(out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "fit.json",
            "parameters.toml",
            "transmissibility.csv",
            "transmissibility.svg"
        ]
    );
    succeeds(&["frf", "axle_a", "--params", &format!("{out}/parameters.toml")]);
}

#[test]
fn curves_give_start_values() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = folder.path().join("campaign");
    copy(Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE).as_path(), &campaign);
    let before = fs::read_to_string(campaign.join("campaign.toml")).unwrap();
    let json: Value = serde_json::from_str(&succeeds(&["kc", campaign.to_str().unwrap(), "--format", "json"])).unwrap();
    for (parameter, truth) in [("k_wheel_z", 35500.0), ("c_wheel_z", 1992.0), ("k_wheel_x", 471000.0)] {
        let found = json
            .as_array()
            .unwrap()
            .iter()
            .find(|gradient| gradient["parameter"] == parameter)
            .unwrap();
        assert!((found["value"].as_f64().unwrap() / truth - 1.0).abs() < 0.01, "{found}");
    }
    succeeds(&["kc", campaign.to_str().unwrap(), "--write"]);
    let after = fs::read_to_string(campaign.join("campaign.toml")).unwrap();
    let changed = before
        .lines()
        .zip(after.lines())
        .filter(|(before, after)| before != after)
        .count();
    assert_eq!((changed, before.lines().count()), (3, after.lines().count()));
    succeeds(&["kc", campaign.to_str().unwrap()]);
}

#[test]
fn wishes_that_cannot_be_met_are_refused() {
    let cases: [(&[&str], &[&str]); 5] = [
        (&["--fix", "k_tyre"], &["--fix", "`k_tyre`", "`k_tire`"]),
        (&["--free", "r_tire"], &["--free", "`r_tire`"]),
        (&["--channels", "pad_to_roof"], &["pad_to_roof"]),
        (&["--model", "quarter_car"], &["quarter_car", "k_tm"]),
        (&["--starts", "0"], &["--starts"]),
    ];
    for (wish, said) in cases {
        let ran = qcar(&[&["fit", AXLE], wish].concat());
        assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{wish:?}");
        assert!(
            said.iter().all(|fragment| ran.stderr.contains(fragment)),
            "{wish:?}\n{}",
            ran.stderr
        );
    }
}
