//! Cleat runs of the campaign in the repository, simulated as a user does.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{copy, qcar, succeeds};

const AXLE: &str = "models/campaigns/axle_a_rig";
const TRUTH: &str = "models/campaigns/axle_a_rig/truth.toml";

fn simulated(arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(
        &[&["simulate", AXLE], arguments, &["--format", "json"]].concat(),
    ))
    .unwrap()
}

fn size(of: &Value, mass_axis: &str, metric: &str, which: &str) -> f64 {
    of["summary"][mass_axis][metric][which].as_f64().unwrap()
}

#[test]
fn the_true_parameters_give_the_measured_cleat_runs() {
    let rides = simulated(&["--params", TRUTH]);
    assert!(size(&rides, "body_z", "peak", "median") < 0.05);
    assert!(size(&rides, "body_z", "peak", "worst") < 0.15);
    assert_eq!(rides["at_start"], serde_json::json!([]));
    assert!(size(&rides, "body_z", "after_shake", "median") < 0.08);
}

#[test]
fn a_fit_to_the_rig_predicts_the_cleat() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    succeeds(&["fit", AXLE, "--out", out]);
    let rides = simulated(&["--params", &format!("{out}/parameters.toml")]);
    assert!(size(&rides, "body_z", "peak", "median") < 0.1);
    assert!(size(&rides, "body_z", "after_shake", "median") < 0.1);
    assert_eq!(
        rides["at_start"],
        serde_json::json!(["c_wheel_x", "k_pwt_x", "c_pwt_x"])
    );
}

#[test]
fn the_variants_differ_as_the_thesis_found() {
    let error = |variant| {
        size(
            &simulated(&["--params", TRUTH, "--variant", variant]),
            "wheel_z",
            "peak",
            "median",
        )
    };
    let (complete, locked, vertical) = (error("complete"), error("locked"), error("vertical"));
    assert!((locked - complete).abs() < 0.1, "{complete} {locked}");
    assert!(vertical > 3.0 * locked.max(0.1), "{locked} {vertical}");
}

/// The largest accelerations along an axis in the written time histories of a run, column by column.
fn largest(folder: &Path, run: &str, axis: &str) -> Vec<f64> {
    let text = fs::read_to_string(folder.join(run)).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let is_wanted = |name: &&str| name.starts_with(axis) && name.ends_with("_acceleration [m/s^2]");
    let columns = head.split(',').enumerate().filter(|(_, name)| is_wanted(name));
    let value = |row: &str, column: usize| row.split(',').nth(column).unwrap().parse::<f64>().unwrap().abs();
    columns
        .map(|(column, _)| rows.lines().map(|row| value(row, column)).fold(0.0, f64::max))
        .collect()
}

#[test]
fn what_is_locked_does_not_accelerate() {
    let folder = tempfile::tempdir().unwrap();
    let ride = |variant| {
        let out = folder.path().join(variant);
        succeeds(&["simulate", AXLE, "--variant", variant, "--out", out.to_str().unwrap()]);
        ["x_", "z_"].map(|axis| largest(&out, "v30_h30.csv", axis))
    };
    let [along, up] = ride("complete");
    assert!(
        along.len() > 2 && along.iter().chain(&up).all(|most| *most > 0.5),
        "{along:?} {up:?}"
    );
    for variant in ["locked", "vertical"] {
        let [locked, up] = ride(variant);
        assert_eq!(locked, vec![0.0; along.len()], "{variant}");
        assert!(up.iter().all(|most| *most > 0.5), "{variant} {up:?}");
    }
}

#[test]
fn time_histories_are_written_run_by_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("rides");
    let csv = succeeds(&["simulate", AXLE, "--out", out.to_str().unwrap(), "--format", "csv"]);
    assert!(csv.starts_with("run,role,mass,axis,measured_peak"));
    let file = fs::read_to_string(out.join("v30_h30.csv")).unwrap();
    let columns = file.lines().next().unwrap().split(',').count();
    assert!(file.starts_with("time [s],z_body_acceleration [m/s^2],"));
    assert!(file.lines().all(|line| line.split(',').count() == columns));
    // Of three sweeps a figure each too, and the errors of all.
    assert_eq!(fs::read_dir(&out).unwrap().count(), 3 + 2 * 3 + 1);
}

#[test]
fn what_cannot_roll_is_refused() {
    let cases: [(&[&str], &str); 3] = [
        (&["--set", "k_tire=-5e5"], "static"),
        (&["--model", "nowhere.axle"], "nowhere.axle"),
        (&["--params", "nowhere.toml"], "nowhere.toml"),
    ];
    for (wish, said) in cases {
        let ran = qcar(&[&["simulate", AXLE], wish].concat());
        assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{wish:?}\n{}", ran.stderr);
        assert!(
            ran.stderr.contains(said) && !ran.stderr.contains("panicked"),
            "{wish:?}\n{}",
            ran.stderr
        );
    }
}

/// A spring that pushes by 500 N and gives in by 100 N at most lifts the body off for good.
#[test]
fn a_model_that_cannot_stand_is_refused_once() {
    let text = succeeds(&["patch", "axle_a", "inerter", "--at", "damper"]);
    let spring = "spring k_wheel_z;";
    assert!(text.contains(spring));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("lifted.axle");
    fs::write(
        &file,
        text.replacen(spring, "force = 500 N + 100 N*tanh(k_wheel_z*s/100 N);", 1),
    )
    .unwrap();
    let ran = qcar(&["simulate", AXLE, "--model", file.to_str().unwrap()]);
    assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{}", ran.stderr);
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    for said in [
        "v20_h30.csv.gz: this run cannot be simulated: model",
        "has no static equilibrium",
        "d(vz_body)/dt",
        "check k_tire",
    ] {
        assert!(ran.stderr.contains(said), "expected `{said}` in\n{}", ran.stderr);
    }
}

/// What `qcar simulate` says of the campaign with `from` replaced by `to` and its higher cleat by a road of these
/// points.
fn refused(from: &str, to: &str, road: &[[f64; 2]]) -> String {
    let folder = tempfile::tempdir().unwrap();
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join(AXLE), folder.path());
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    assert!(text.contains(from));
    fs::write(&manifest, text.replace(from, to)).unwrap();
    let next = road.iter().skip(1).chain(road.last());
    let slope = |[x, z]: &[f64; 2], [next_x, next_z]: &[f64; 2]| (next_z - z) / (next_x - x).max(1e-9);
    let row = |(here, next): (&[f64; 2], _)| format!("{},{},{}\n", here[0], here[1], slope(here, next));
    let rows: String = road.iter().zip(next).map(row).collect();
    fs::write(folder.path().join("road/given.csv"), format!("x,z,slope\n{rows}")).unwrap();
    let ran = qcar(&["simulate", folder.path().to_str().unwrap(), "--params", TRUTH]);
    assert_eq!((ran.status, ran.stdout.as_str()), (2, ""), "{to}\n{}", ran.stderr);
    ran.stderr
}

#[test]
fn a_campaign_that_cannot_be_driven_says_what_to_correct() {
    let road = |points: &[[f64; 2]]| refused("road/cleat_30.csv.gz", "road/given.csv", points);
    let rough: Vec<[f64; 2]> = (0..3000)
        .map(|i| [0.01 * f64::from(i), 0.01 * f64::from(i % 2)])
        .collect();
    for (stderr, said) in [
        (road(&[[0.0, 0.0], [1.0, 0.0]]), "lengthen the road"),
        (road(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]), "given.csv"),
        (road(&rough), "sample the profile finer"),
        (refused("speed = 5.5555556", "speed = 0.0", &[]), "speed"),
        (
            refused("static_tire_def = 0.02361", "static_tire_def = 0.4", &[]),
            "static_tire_def",
        ),
    ] {
        assert!(
            stderr.contains(said) && !stderr.contains("panicked"),
            "{said}: {stderr}"
        );
    }
}

/// What is odd about a campaign is said by every verb that rests on it.
#[test]
fn what_is_odd_about_the_campaign_is_said_with_the_result() {
    let folder = tempfile::tempdir().unwrap();
    copy(Path::new(AXLE), folder.path());
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let spare = "[[channel]]\nname = \"spare\"\nlocation = \"body\"\nside = \"left\"\naxis = \"z\"\nquantity = \"velocity\"\nunit = \"m/s\"\n\n";
    fs::write(&manifest, text.replacen("[[run]]", &format!("{spare}[[run]]"), 1)).unwrap();
    for verb in ["simulate", "kc"] {
        let said = succeeds(&[verb, folder.path().to_str().unwrap()]);
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            said.contains("note: ") && said.contains("no run records the channel `spare`"),
            "{verb}: {said}"
        );
    }
}
