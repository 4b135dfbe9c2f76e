//! Values outside the ranges of a model are noted by every verb that takes values.

use std::fs;

use crate::common::qcar;
use crate::records;

/// A sentence on standard output, or on standard error where the output is a table or a model for other programs.
#[test]
fn every_verb_notes_values_outside_the_ranges_of_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let values = path("values.toml");
    fs::write(&values, "[parameters]\nk_tire = \"1 N/mm\"\n").unwrap();
    let note = "k_tire = 1000 N/m is outside 50000 to 1000000 N/m, the plausible range of model quarter_car";
    let set = ["--set", "k_tire=1000"];
    let params = ["--params", &values];
    let (patched, exported, sets) = (path("new.axle"), path("new.csv"), path("sets.csv"));
    let patch = ["patch", "quarter_car", "suspended_mass", "--at", "body"];
    let export = ["export", "quarter_car", "--as", "csv", "--out", &exported];
    let explore = "explore quarter_car --vary m_wheel=-1%..1% --count 2 --metrics modes --out";
    let explore: Vec<&str> = explore.split(' ').chain([&*sets]).collect();
    let cases: [(&[&str], &[&str], bool); 10] = [
        (&["frf", "quarter_car"], &set, true),
        (&["frf", "quarter_car", "--format", "json"], &params, true),
        (&["frf", "quarter_car", "--format", "csv"], &set, false),
        (&["matrices", "quarter_car"], &params, true),
        (&["matrices", "quarter_car", "--format", "json"], &set, true),
        (&patch, &set, false),
        (&[&patch[..], &["--out", &patched]].concat(), &params, true),
        (&export, &params, true),
        (&explore, &params, true),
        (&["sensitivity", "quarter_car", "--format", "csv"], &set, false),
    ];
    for (line, given, on_output) in cases {
        let ran = qcar(&[line, given].concat());
        let noted = [&ran.stdout, &ran.stderr].map(|text| text.matches(note).count());
        assert_eq!(
            (ran.status, noted),
            (0, [on_output, !on_output].map(usize::from)),
            "{line:?}"
        );
    }
}

/// The mass is known and no other value can make up for it.
#[test]
fn every_verb_notes_values_of_a_campaign_outside_the_ranges_of_its_model() {
    let folder = tempfile::tempdir().unwrap();
    let model = fs::read_to_string("models/axles/one_mass.axle").unwrap();
    fs::write(
        folder.path().join("narrow.axle"),
        model.replace("1e-9..1e6", "0.5..1.5"),
    )
    .unwrap();
    let known = records::parameter("m_body", 2.0, "kg", "").replace("true", "false");
    let estimated = records::parameter("k_body", 700.0, "N/m", "");
    let runs = records::pushed();
    records::campaign(
        folder.path(),
        "./narrow.axle",
        &(known + &estimated),
        "band_limited = false",
        &[&runs],
    );
    fs::write(
        folder.path().join("truth.toml"),
        "effects = []\n[parameters]\nk_body = 800.0\n",
    )
    .unwrap();
    let path = folder.path().to_str().unwrap();
    let note = "m_body = 2 kg is outside 0.5 to 1.5 kg, the plausible range of model one_mass";
    for verb in ["check", "simulate", "fit", "plan", "discover", "score"] {
        let ran = qcar(&[verb, path]);
        assert_eq!(
            ran.stdout.matches(note).count(),
            1,
            "{verb}: {}{}",
            ran.stdout,
            ran.stderr
        );
    }
}
