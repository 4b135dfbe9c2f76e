//! Campaigns whose values contradict each other, most often by a factor of 1000: `check` says what the other verbs refuse,
//! and every verb that uses doubtful vehicle data warns.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::common::{self, Ran, copy, qcar};

const SHIPPED: &str = "models/campaigns/axle_a_rig";

/// A copy of the shipped campaign in which `old` of campaign.toml has become `new`.
fn with(old: &str, new: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join(SHIPPED), folder.path());
    let manifest = folder.path().join("campaign.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    assert!(text.contains(old), "{old}");
    fs::write(&manifest, text.replacen(old, new, 1)).unwrap();
    folder
}

fn run(verb: &str, campaign: &TempDir) -> Ran {
    qcar(&[verb, campaign.path().to_str().unwrap()])
}

/// `check` ends with status 1 and these words, and `verb` refuses with those after the name of the file.
fn found(campaign: &TempDir, verb: &str, verdict: &str, said: &str) {
    let checked = run("check", campaign);
    let words = checked.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(checked.status, 1, "{}{}", checked.stdout, checked.stderr);
    assert!(words.contains(&format!(": {verdict} run kind")), "{words}");
    assert!(words.contains(said), "expected `{said}` in {words}");
    common::refused(&run(verb, campaign), &[said]);
}

#[test]
fn check_finds_what_a_fit_refuses() {
    let unfit = |old: &str, new: &str, said: &str| found(&with(old, new), "fit", "cannot be fitted", said);
    unfit(
        "peak_velocity = 0.025",
        "peak_velocity = 25",
        "expected one near `peak_velocity = 25`",
    );
    unfit(
        "location = \"wheel\"",
        "location = \"hub\"",
        "found `hub` along z, expected a place of model `axle_a`",
    );
    unfit(
        "spacing = \"logarithmic\"",
        "spacing = \"linear\"",
        "write `spacing = \"logarithmic\"`",
    );
    unfit(
        "end_frequency = 30.0",
        "end_frequency = 60.0",
        "expected a sweep to `end_frequency = 60`",
    );
}

/// A fit of a nonlinear model takes the frequencies from the record, so these are no more than warnings.
#[test]
fn check_names_a_sweep_that_is_not_as_stated_for_a_nonlinear_model_too() {
    let checked = |old: &str, new: &str| {
        let campaign = with(old, new);
        let nonlinear = campaign.path().join("nonlinear.axle").display().to_string();
        let patched = qcar(&[
            "patch",
            "axle_a",
            "progressive_spring",
            "--at",
            "spring",
            "--out",
            &nonlinear,
        ]);
        assert_eq!(patched.status, 0, "{}", patched.stderr);
        let manifest = campaign.path().join("campaign.toml");
        let text = fs::read_to_string(&manifest).unwrap();
        fs::write(
            &manifest,
            text.replacen("model = \"axle_a\"", "model = \"nonlinear.axle\"", 1),
        )
        .unwrap();
        let checked = run("check", &campaign);
        checked.stdout.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    for (old, new, said) in [
        (
            "spacing = \"logarithmic\"",
            "spacing = \"linear\"",
            "write `spacing = \"logarithmic\"`",
        ),
        (
            "end_frequency = 30.0",
            "end_frequency = 60.0",
            "expected a sweep to `end_frequency = 60`",
        ),
    ] {
        let words = checked(old, new);
        assert!(words.contains(said), "expected `{said}` in {words}");
    }
    let words = checked("spacing", "spacing");
    assert!(
        !words.contains("expected a sweep") && !words.contains("write `spacing"),
        "{words}"
    );
}

#[test]
fn check_finds_what_kc_refuses() {
    let unusable = |old: &str, new: &str, said: &str| {
        found(&with(old, new), "kc", "has runs that cannot be used", said);
    };
    unusable("amplitude = 0.02", "amplitude = 20", "an amplitude of 0.0");
    unusable(
        "peak_velocity = 0.125",
        "peak_velocity = 12.5",
        "a peak velocity of 0.12",
    );
}

#[test]
fn vehicle_data_that_contradict_each_other_are_noticed() {
    let impossible = with("r_tire = 0.35", "r_tire = 350");
    for verb in ["check", "simulate", "fit"] {
        let said = [
            "`vehicle.r_tire`: found 350, expected the radius of an unloaded tyre, from 0.01 to 2.5 m",
            "\"350 mm\"",
        ];
        common::refused(&run(verb, &impossible), &said);
    }
    let doubtful = with("static_tire_load = 4815.7", "static_tire_load = 4.8157");
    for verb in ["check", "simulate", "kc"] {
        let ran = run(verb, &doubtful);
        let words = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(ran.status, 0, "{}", ran.stderr);
        for said in [
            "static_tire_load = 4.8157 N is 0.001 times the weight of m_corner = 490.9 kg",
            "static_tire_load over static_tire_def is 203.96",
            "times `k_tire`",
        ] {
            assert!(words.contains(said), "{verb}: expected `{said}` in {words}");
        }
    }
}

#[test]
fn a_sound_campaign_is_given_by_its_file_too() {
    let file = format!("{SHIPPED}/campaign.toml");
    for name in [SHIPPED, &*file] {
        let ran = qcar(&["check", name]);
        assert_eq!(ran.status, 0, "{}{}", ran.stdout, ran.stderr);
        assert!(ran.stdout.starts_with(&format!("{name}: ok\n")), "{}", ran.stdout);
    }
    assert_eq!(qcar(&["kc", &file]).status, 0);
}
